//! Pressure -> pressure rise over the zero, and where that zero may come from.
//!
//! A zero taken on a pressed fingertip reads every later press too low, so there are two ways to one, both gated:
//!
//! - **At start-up**, when a person or the supply started the chip: a window must be quiet and its mean within
//!   [`Gates::near`] of the reference (the stored calibration, else the design's rest pressure). Else the reference
//!   itself serves after [`PATIENCE`], and every reading says "zero unverified". A still press that lifts the
//!   pressure by less than `near` cannot be told from a transducer's drift; that bound is all it can hide.
//! - **On command**: refused while touched, restless, or beyond [`Gates::far`] of the reference; undone by one more
//!   command.
//!
//! After a reset that nobody saw coming the hand may be holding something: nothing is measured, the zero from
//! before the reset serves, or else the reference, unverified.
//!
//! # Absolute transducers
//!
//! They have the air in their zero, 60 to 108 kPa of it ([`AIR`](model_tables::constants::AIR)), and a press cannot be
//! told from denser air. So no single zero is to be expected, neither the design's nor a stored one: any within
//! [`Gates::expected`] may be, and only someone who says that nothing presses verifies it.
//!
//! | | gauge | absolute |
//! |---|---|---|
//! | start by a person or the supply | a quiet window near the reference: verified | a verified zero that is kept; else a quiet window within the bounds: unverified |
//! | none within [`PATIENCE`] | the reference, unverified | no zero: [`Fault::Zeroing`] until one comes, or a command |
//! | a reset nobody saw coming, a zero is kept | it serves as it was | it serves as it was: the air has not moved meanwhile |
//! | the same, none is kept | the reference, unverified | no zero: [`Fault::Zeroing`] until a command; the tip may be pressed |
//! | command over a verified zero | refused from a touch up | the same, until the zero is aged: denser air reads as a touch |
//! | command over another zero, or none | a stored zero objects beyond `near` | nothing stored objects: the air moved |

pub mod gates;

use crate::signal::tare::gates::Gates;
use crate::signal::zero::{StartUp, Zero};
use crate::status::{Fault, Warnings};
use crate::units::{Microseconds, Pressure, saturate};
use model_tables::units::PressureRise;

/// How long a window is, microseconds: longer than any hum, shorter than patience.
pub const WINDOW: u64 = 256_000;

/// How long a good window is waited for, microseconds.
pub const PATIENCE: u64 = 2_000_000;

/// Why a zero was not taken, or not undone.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum TareRefusal {
    /// The fingertip is touched, or may be.
    Touched,
    /// No window was quiet.
    Restless,
    /// Further from the reference than any transducer drifts.
    OutOfBounds,
    /// There are no readings.
    NoReading,
    /// Another tare is under way.
    Busy,
    /// There is nothing to undo.
    NothingToUndo,
}

/// The tare stage.
#[derive(Clone, Debug)]
pub struct Tare {
    gates: Gates,
    zero: Option<Zero>,
    /// The lowest of the verified zeros since start-up, its drift included: commands do not creep up a light press by
    /// taking one untouched-looking zero after the other.
    anchor: Pressure,
    /// What the last command replaced.
    previous: Option<Zero>,
    measuring: Option<Measuring>,
    answer: Option<Result<(), TareRefusal>>,
    moved: bool,
}

#[derive(Clone, Debug)]
struct Measuring {
    /// Someone says that nothing presses, and waits for an answer.
    commanded: bool,
    /// A start whose [`PATIENCE`] ended without a zero: it goes on for want of one, gives way to a command and resumes
    /// where that fails.
    overdue: bool,
    /// The zero that serves has aged: its rise may be the air's.
    aged: bool,
    since: Option<Microseconds>,
    /// Why the last window was no good.
    objection: TareRefusal,
    window: Window,
}

/// Samples so far: at most 2^32 of at most 2^31.
#[derive(Clone, Debug)]
struct Window {
    since: Option<Microseconds>,
    samples: u32,
    sum: i64,
    lowest: Pressure,
    highest: Pressure,
}

impl Window {
    const EMPTY: Self = Self {
        since: None,
        samples: 0,
        sum: 0,
        lowest: Pressure(i32::MAX),
        highest: Pressure(i32::MIN),
    };

    /// Takes a sample; the mean and the spread once the window is full.
    fn add(&mut self, time: Microseconds, pressure: Pressure) -> Option<(Pressure, i32)> {
        let since = *self.since.get_or_insert(time);
        self.samples = self.samples.saturating_add(1);
        self.sum = self.sum.saturating_add(i64::from(pressure.0));
        self.lowest = self.lowest.min(pressure);
        self.highest = self.highest.max(pressure);
        let full = time.0.saturating_sub(since.0) >= WINDOW;
        full.then(|| {
            let samples = i64::from(self.samples);
            let mean = (self.sum + samples / 2).div_euclid(samples);
            let spread = self.highest.0.saturating_sub(self.lowest.0);
            (Pressure(saturate(mean)), spread)
        })
    }
}

impl Measuring {
    /// At start-up.
    const NEW: Self = Self {
        commanded: false,
        overdue: false,
        aged: false,
        since: None,
        objection: TareRefusal::NoReading,
        window: Window::EMPTY,
    };
}

impl Tare {
    /// A tare that has seen nothing yet.
    pub const fn new(gates: Gates, start_up: StartUp) -> Self {
        let zero = match start_up {
            StartUp::Measured => None,
            StartUp::Stored => gates.fallback(),
            StartUp::Kept(zero) => Some(zero),
        };
        Self {
            gates,
            zero,
            anchor: match zero {
                Some(zero) => zero.pressure,
                None => gates.expected[0],
            },
            previous: None,
            measuring: match start_up {
                StartUp::Measured => Some(Measuring::NEW),
                StartUp::Stored | StartUp::Kept(_) => None,
            },
            answer: None,
            moved: zero.is_some(),
        }
    }

    /// The zero that serves, if there is one yet.
    pub const fn zero(&self) -> Option<Zero> {
        self.zero
    }

    /// The lowest zero to be expected.
    pub const fn lowest(&self) -> Pressure {
        self.gates.expected[0]
    }

    /// A new reference: something was stored, or is void. The zero that serves stays.
    pub fn refer_to(&mut self, gates: Gates) {
        self.gates = gates;
    }

    /// The rise of a pressure over the zero and its drift since, held at the ends of the word, and whether the zero
    /// is verified.
    ///
    /// # Errors
    /// [`Fault::Zeroing`] until there is a zero.
    #[inline]
    pub fn step(
        &mut self,
        time: Microseconds,
        pressure: Pressure,
        drift: i32,
    ) -> Result<(PressureRise, Warnings), Fault> {
        if self.measuring.is_some() {
            self.measure(time, pressure, drift);
        }
        let zero = self.zero.ok_or(Fault::Zeroing)?;
        // A new zero is of now: it has not drifted.
        let drift = if self.moved { 0 } else { drift };
        let zeroed = zero.pressure.0.saturating_add(drift);
        Ok((
            PressureRise(pressure.0.saturating_sub(zeroed)),
            Warnings::ZERO_UNVERIFIED.when(!zero.verified),
        ))
    }

    /// A gap in the samples: a window has no gaps. Patience runs on.
    pub fn interrupt(&mut self, time: Microseconds) {
        if let Some(measuring) = &mut self.measuring {
            measuring.window = Window::EMPTY;
            let since = *measuring.since.get_or_insert(time);
            let tired = time.0.saturating_sub(since.0) >= PATIENCE;
            if tired && measuring.commanded {
                self.give_up();
            }
        }
    }

    /// Someone says that nothing presses: takes a new zero if the gates let it. The answer comes through
    /// [`Tare::take_answer`] within [`PATIENCE`] of the next sample. `aged`: the zero that serves could not be followed
    /// for so long that drift may pass for a touch; to an absolute transducer it then tells no touch any more.
    ///
    /// # Errors
    /// [`TareRefusal::Busy`].
    pub fn command(&mut self, aged: bool) -> Result<(), TareRefusal> {
        if self.is_busy() {
            return Err(TareRefusal::Busy);
        }
        self.measuring = Some(Measuring {
            commanded: true,
            overdue: self.measuring.is_some(),
            aged,
            ..Measuring::NEW
        });
        Ok(())
    }

    /// Whether a zero is being measured, which ends within [`PATIENCE`].
    fn is_busy(&self) -> bool {
        self.measuring
            .as_ref()
            .is_some_and(|measuring| measuring.commanded || !measuring.overdue)
    }

    /// Takes back the last commanded zero.
    ///
    /// # Errors
    /// [`TareRefusal::NothingToUndo`], [`TareRefusal::Busy`].
    pub fn undo(&mut self) -> Result<(), TareRefusal> {
        if self.is_busy() {
            return Err(TareRefusal::Busy);
        }
        let previous = self.previous.take().ok_or(TareRefusal::NothingToUndo)?;
        self.zero = Some(previous);
        self.anchor = self.anchor.min(previous.pressure);
        self.moved = true;
        Ok(())
    }

    /// Whether there is another zero than at the last call.
    #[inline]
    pub fn take_moved(&mut self) -> bool {
        core::mem::take(&mut self.moved)
    }

    /// What came of the last command, once.
    pub fn take_answer(&mut self) -> Option<Result<(), TareRefusal>> {
        self.answer.take()
    }

    #[cold]
    fn measure(&mut self, time: Microseconds, pressure: Pressure, drift: i32) {
        let Some(measuring) = &mut self.measuring else {
            return;
        };
        let since = *measuring.since.get_or_insert(time);
        let (commanded, aged) = (measuring.commanded, measuring.aged);
        if let Some((mean, spread)) = measuring.window.add(time, pressure) {
            measuring.window = Window::EMPTY;
            let judged = if spread > self.gates.quiet {
                Err(TareRefusal::Restless)
            } else {
                self.judge(mean, drift, commanded, aged)
            };
            match judged {
                Ok(zero) => {
                    self.accept(zero, drift, commanded);
                    return;
                }
                Err(objection) => {
                    if let Some(measuring) = &mut self.measuring {
                        measuring.objection = objection;
                    }
                }
            }
        }
        if time.0.saturating_sub(since.0) >= PATIENCE {
            self.give_up();
        }
    }

    /// Whether the mean of a quiet window may be the zero.
    fn judge(&self, mean: Pressure, drift: i32, commanded: bool, aged: bool) -> Result<Zero, TareRefusal> {
        let gates = &self.gates;
        let verified = |verified| Zero {
            pressure: mean,
            verified,
        };
        let judged = match self.zero {
            // Of an absolute transducer the bounds alone object, whoever asks.
            None if gates.absolute => Ok(verified(commanded)),
            // At start-up.
            None if gates.within(mean, gates.near) => Ok(verified(true)),
            None => Err(TareRefusal::Touched),
            // On command, over a zero that tells a touch.
            Some(zero) if zero.verified && !(aged && gates.absolute) => {
                let anchor = i64::from(self.anchor.0) + i64::from(drift);
                if i64::from(mean.0) - anchor > i64::from(gates.touch.0) {
                    Err(TareRefusal::Touched)
                } else {
                    Ok(verified(true))
                }
            }
            // On command, over one that does not: only a stored zero can object.
            Some(_) if gates.stored && !gates.within(mean, gates.near) => Err(TareRefusal::Touched),
            Some(_) => Ok(verified(true)),
        };
        judged.and_then(|zero| {
            if gates.within(mean, gates.far) {
                Ok(zero)
            } else {
                Err(TareRefusal::OutOfBounds)
            }
        })
    }

    fn accept(&mut self, zero: Zero, drift: i32, commanded: bool) {
        let before = self.zero.replace(zero);
        self.anchor = match before {
            Some(before) if before.verified => {
                zero.pressure.min(Pressure(self.anchor.0.saturating_add(drift)))
            }
            _ => zero.pressure,
        };
        self.previous = before.map(|before| Zero {
            pressure: Pressure(before.pressure.0.saturating_add(drift)),
            ..before
        });
        if commanded {
            self.answer = Some(Ok(()));
        }
        self.measuring = None;
        self.moved = true;
    }

    fn give_up(&mut self) {
        let Some(measuring) = self.measuring.take() else {
            return;
        };
        if measuring.commanded {
            self.answer = Some(Err(measuring.objection));
            if measuring.overdue {
                self.measuring = Some(Measuring {
                    overdue: true,
                    ..Measuring::NEW
                });
            }
        } else if let Some(zero) = self.gates.fallback() {
            self.zero = Some(zero);
            self.moved = true;
        } else {
            self.measuring = Some(Measuring {
                overdue: true,
                ..measuring
            });
        }
    }
}

#[cfg(test)]
mod tests;
