//! Pressure -> pressure rise above the zero: the first zero, commanded zeros, and their change with time and quiet windows.
//!
//! | | gauge | absolute |
//! |---|---|---|
//! | start by a person or the supply | a quiet window near the reference: verified | a verified zero that is kept; else a quiet window that can be: unverified |
//! | none within [`PATIENCE`] | the reference, unverified | no zero: [`Fault::Zeroing`] until one comes, or a command |
//! | a supply that sags or an unrequested reset, a zero is kept | it stays in use | it stays in use: the air pressure has not changed meanwhile |
//! | the same, none is kept | the reference, unverified | no zero: [`Fault::Zeroing`] until a command; the tip may be pressed |
//! | command | refused as touched over an ok zero if the new zero would not be ok; else taken, and verified if its bound allows | the same; the possible change of the air pressure is in the bound |

use crate::signal::zero::interval::Interval;
use crate::signal::zero::limits::Limits;
use crate::signal::zero::tare::{Measuring, PATIENCE, Replaced, TareRefusal};
use crate::signal::zero::window::{self, Part, Seen, Window};
use crate::signal::zero::{StartUp, Zero};
use crate::status::{Fault, Warnings};
use crate::units::{Microseconds, Pressure};
use model_tables::units::PressureRise;

/// Length of a window, microseconds.
pub const WINDOW: u64 = window::LENGTH;

/// The zero of one fingertip.
#[derive(Clone, Debug)]
pub struct Estimator {
    limits: Limits,
    interval: Interval,
    /// Whether there is a zero.
    zeroed: bool,
    window: Window,
    /// When the last window ended, or the zero was taken.
    looked: Option<Microseconds>,
    measuring: Option<Measuring>,
    replaced: Option<Replaced>,
    answer: Option<Result<(), TareRefusal>>,
    moved: bool,
    /// How far the pressure swings to either side, faster than any press: counts, >= 0.
    swing: i32,
    /// Bound from interval and swing, updated at the last part of a window.
    bound: i32,
    above: i32,
    warnings: Warnings,
}

impl Estimator {
    /// An estimator without any pressure yet.
    pub fn new(limits: Limits, start_up: StartUp) -> Self {
        let (reference, highest) = (limits.expected[0], limits.expected[1].0);
        let measured = start_up == StartUp::Measured;
        let known = match (limits.absolute, measured) {
            (true, _) => highest.saturating_add(limits.far),
            (false, true) if !limits.stored => highest.saturating_add(limits.near),
            (false, _) => highest,
        };
        let interval = match start_up {
            StartUp::Kept(zero) if zero.verified => Interval::kept(zero),
            StartUp::Kept(Zero { pressure, .. }) => {
                Interval::unverified(pressure, pressure.0.saturating_add(limits.margin), &limits)
            }
            StartUp::Measured | StartUp::Stored => {
                Interval::unverified(reference, known.saturating_add(limits.margin), &limits)
            }
        };
        let zeroed = !(measured || limits.absolute && start_up == StartUp::Stored);
        let mut estimator = Self {
            limits,
            interval,
            zeroed,
            window: Window::EMPTY,
            looked: None,
            measuring: measured.then_some(Measuring::NEW),
            replaced: None,
            answer: None,
            moved: zeroed,
            swing: 0,
            bound: 0,
            above: 0,
            warnings: Warnings::NONE,
        };
        estimator.judge_bound();
        estimator
    }

    /// The zero in use; `None` before the first one.
    pub const fn zero(&self) -> Option<Zero> {
        if !self.zeroed {
            return None;
        }
        Some(Zero {
            pressure: self.interval.value(),
            bound: self.bound,
            verified: self.interval.verified,
        })
    }

    /// Largest distance of the true zero from the zero in use, counts, >= 0.
    #[inline]
    pub const fn bound(&self) -> i32 {
        self.bound
    }

    /// Largest distance of the true zero above the zero in use, beyond the margin of a quiet window, counts, >= 0. This part of
    /// a rise is no evidence of a touch.
    #[inline]
    pub const fn above(&self) -> i32 {
        self.above
    }

    /// Whether readings over this zero are ok.
    #[inline]
    pub const fn is_ok(&self) -> bool {
        self.interval.verified && self.bound <= self.limits.bound
    }

    /// The zero to be stored: an ok zero, or a commanded zero, which the user confirms by saving it. `None` if there is neither.
    pub fn to_store(&self) -> Option<Zero> {
        let vouched = !self.interval.verified && self.replaced.is_some();
        self.zero().filter(|_| self.is_ok() || vouched)
    }

    /// The lowest expected zero.
    pub const fn lowest(&self) -> Pressure {
        self.limits.expected[0]
    }

    /// Takes a new reference. Either the zero was stored, which confirms it, or the stored zero is void.
    pub fn refer_to(&mut self, limits: Limits) {
        self.limits = limits;
        if limits.stored && !self.interval.verified {
            self.interval = self.interval.vouched(&limits);
            self.judge_bound();
        }
    }

    /// Takes the next pressure. Returns the level of a quiet window if one ended.
    #[inline]
    pub fn step(&mut self, time: Microseconds, pressure: Pressure) -> Option<Pressure> {
        let part = self.window.add(time, pressure);
        if part.is_some() || self.measuring.is_some() {
            return self.look(time, part);
        }
        None
    }

    /// The rise of a pressure over the zero, saturated at the ends of the word, and its warnings.
    ///
    /// # Errors
    /// [`Fault::Zeroing`] until there is a zero.
    #[inline]
    pub fn rise(&self, pressure: Pressure) -> Result<(PressureRise, Warnings), Fault> {
        if !self.zeroed {
            return Err(Fault::Zeroing);
        }
        let rise = pressure.0.saturating_sub(self.interval.value().0);
        Ok((PressureRise(rise), self.warnings))
    }

    /// This pressure is no evidence for the zero: the present window is discarded.
    #[inline]
    pub fn disregard(&mut self) {
        self.window.disturb();
    }

    /// A gap in the samples: starts a new window. [`PATIENCE`] keeps running.
    pub fn interrupt(&mut self, time: Microseconds) {
        self.window = Window::EMPTY;
        // The zero drifts even if no window ever ends.
        if self.zeroed {
            self.age(time);
            self.judge_bound();
        }
        if let Some(measuring) = &mut self.measuring {
            let since = *measuring.since.get_or_insert(time);
            if measuring.commanded && time.0.saturating_sub(since.0) >= PATIENCE {
                self.give_up();
            }
        }
    }

    /// The host asserts that the fingertip is unloaded: takes a new zero if the limits allow it. The answer comes through
    /// [`Estimator::take_answer`] within [`PATIENCE`] of the next sample.
    ///
    /// # Errors
    /// [`TareRefusal::Busy`].
    pub fn command(&mut self) -> Result<(), TareRefusal> {
        if self.is_busy() {
            return Err(TareRefusal::Busy);
        }
        self.window = Window::EMPTY;
        self.measuring = Some(Measuring {
            commanded: true,
            // The present swing has no influence on whether the zero is ok.
            over_ok: self.zeroed && self.interval.is_ok(&self.limits),
            overdue: self.measuring.is_some(),
            ..Measuring::NEW
        });
        Ok(())
    }

    /// Whether a measurement of a zero is under way that ends within [`PATIENCE`].
    fn is_busy(&self) -> bool {
        self.measuring
            .is_some_and(|measuring| measuring.commanded || !measuring.overdue)
    }

    /// Restores the zero before the last commanded one, and adds the drift since then.
    ///
    /// # Errors
    /// [`TareRefusal::NothingToUndo`], [`TareRefusal::Busy`].
    pub fn undo(&mut self) -> Result<(), TareRefusal> {
        if self.is_busy() {
            return Err(TareRefusal::Busy);
        }
        let replaced = self.replaced.take().filter(|replaced| replaced.zeroed);
        let Replaced { before, by, at, .. } = replaced.ok_or(TareRefusal::NothingToUndo)?;
        let passed = self.looked.map_or(0, |looked| looked.0.saturating_sub(at.0));
        self.interval = before.since(&self.limits, &by, &self.interval, passed);
        self.moved = true;
        self.judge_bound();
        Ok(())
    }

    /// Adds a lasting movement of the zero to its bound, counts, >= 0. An undo does not remove it.
    pub fn widen(&mut self, by: i32) {
        self.interval.widen(by);
        if let Some(replaced) = &mut self.replaced {
            replaced.before.widen(by);
        }
        self.judge_bound();
    }

    /// The host reports that the air pressure changed by `by` counts. The zero moves with it.
    pub fn shift(&mut self, by: i32) {
        self.window.shift(by);
        self.interval.shift(by);
        if let Some(replaced) = &mut self.replaced {
            replaced.before.shift(by);
            replaced.by.shift(by);
        }
    }

    /// Whether another zero was taken since the last call.
    #[inline]
    pub fn take_moved(&mut self) -> bool {
        core::mem::take(&mut self.moved)
    }

    /// The outcome of the last command, returned once. `None` before it is known and after it was taken.
    pub fn take_answer(&mut self) -> Option<Result<(), TareRefusal>> {
        self.answer.take()
    }

    #[cold]
    fn look(&mut self, time: Microseconds, part: Option<Part>) -> Option<Pressure> {
        if let Some(Part { swing, .. }) = part {
            self.swing(swing);
        }
        let seen = part.and_then(|part| part.window);
        let quiet = seen.filter(|seen| seen.spread <= self.limits.quiet);
        if seen.is_some() && self.zeroed {
            let passed = self.age(time);
            if let Some(Seen { level, .. }) = quiet {
                self.interval.look(&self.limits, level, passed);
            }
            self.judge_bound();
        }
        if let Some(mut measuring) = self.measuring {
            let since = *measuring.since.get_or_insert(time);
            if seen.is_some() {
                measuring.objection = match self.judge(quiet, &measuring) {
                    Ok(zero) => {
                        self.accept(time, zero, measuring.commanded);
                        return quiet.map(|seen| seen.level);
                    }
                    Err(objection) => objection,
                };
            }
            self.measuring = Some(measuring);
            if time.0.saturating_sub(since.0) >= PATIENCE {
                self.give_up();
            }
        }
        quiet.map(|seen| seen.level)
    }

    /// Adds the drift since the last call. Returns the time since then, microseconds.
    // Not inlined: inlining adds 100 bytes to the image.
    #[inline(never)]
    fn age(&mut self, time: Microseconds) -> u64 {
        let looked = self.looked.replace(time).unwrap_or(time);
        let passed = time.0.saturating_sub(looked.0);
        self.interval.drift(&self.limits, passed);
        passed
    }

    /// Whether a window may give the zero.
    fn judge(&self, quiet: Option<Seen>, measuring: &Measuring) -> Result<Interval, TareRefusal> {
        let Seen { level, .. } = quiet.ok_or(TareRefusal::Restless)?;
        let limits = &self.limits;
        let taken = self.interval.taken(limits, level);
        if measuring.over_ok && !taken.verified {
            return Err(TareRefusal::Touched);
        }
        if !limits.allows(level) {
            return Err(TareRefusal::OutOfBounds);
        }
        if measuring.commanded {
            return Ok(taken);
        }
        if limits.absolute {
            let mut unverified = taken;
            unverified.verified = false;
            return Ok(unverified);
        }
        let lowest = limits.expected[0].0.saturating_sub(limits.near);
        if (lowest..=limits.highest_at_start()).contains(&level.0) {
            Ok(taken)
        } else {
            Err(TareRefusal::Touched)
        }
    }

    fn accept(&mut self, time: Microseconds, zero: Interval, commanded: bool) {
        if commanded {
            self.answer = Some(Ok(()));
            self.replaced = Some(Replaced {
                before: self.interval,
                zeroed: self.zeroed,
                by: zero,
                at: time,
            });
        }
        self.interval = zero;
        self.looked = Some(time);
        self.measuring = None;
        self.begin();
    }

    fn give_up(&mut self) {
        let Some(measuring) = self.measuring.take() else {
            return;
        };
        let overdue = Measuring {
            overdue: true,
            ..Measuring::NEW
        };
        if measuring.commanded {
            self.answer = Some(Err(measuring.objection));
            self.measuring = measuring.overdue.then_some(overdue);
        } else if self.limits.absolute {
            self.measuring = Some(overdue);
        } else {
            let reference = self.limits.expected[0];
            let highest = reference.0.saturating_add(self.limits.margin);
            self.interval = Interval::unverified(reference, highest, &self.limits);
            self.begin();
        }
    }

    fn begin(&mut self) {
        self.zeroed = true;
        self.moved = true;
        self.judge_bound();
    }

    /// A swing that noise can explain counts as 0. A part of a window may miss a fifth of the range of a hum. The swing decays
    /// slowly, by half in 0.7 s, because a press can hide a hum for some parts.
    fn swing(&mut self, width: i32) {
        let swing = if width > self.limits.swing {
            (width >> 3).saturating_mul(5)
        } else {
            0
        };
        if self.swing | swing != 0 {
            self.swing = swing.max(self.swing - (self.swing >> 6) - 1);
            self.judge_bound();
        }
    }

    fn judge_bound(&mut self) {
        let verified = self.interval.verified;
        let bound = if verified {
            self.interval.bound(&self.limits)
        } else {
            self.limits.reach()
        };
        self.above = self.interval.above(&self.limits).saturating_add(self.swing);
        self.bound = bound.saturating_add(self.swing);
        let largest = self.limits.bound;
        self.warnings = if !verified {
            Warnings::ZERO_UNVERIFIED
        } else if bound > largest {
            Warnings::ZERO_AGED
        } else {
            Warnings::NOISY.when(self.bound > largest)
        };
    }
}

#[cfg(test)]
mod tests;
