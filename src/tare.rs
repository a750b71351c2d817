//! Gauge pressure -> pressure rise over the zero, and where that zero may come from.
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
//! An absolute transducer has the weather in its zero, so near means nothing for it: it starts with what it
//! measures, within `far` of the reference, and says "zero unverified" until it is told that nothing presses.

use crate::pressure::{Pressure, saturate};
use crate::report::{Fault, Microseconds, Warnings};
use crate::telemetry::ResetCause;
use crate::touch::Thresholds;
use crate::transducer::Quantity;
use model_tables::constants::DesignConstants;
use model_tables::units::PressureRise;

/// How long a window is, microseconds: longer than any hum, shorter than patience.
pub const WINDOW: u64 = 256_000;

/// How long a good window is waited for, microseconds.
pub const PATIENCE: u64 = 2_000_000;

/// How far a zero at start-up may lie from the reference, ten-thousandths of the transducer's range: what the offset of a
/// compensated gauge bridge wanders between one day and another.
const NEAR_PERMYRIAD: i64 = 25;

/// How far any zero may lie from the reference, thousandths of the transducer's range: the offset that NXP allows an
/// MPX5100 (2.5 % of full scale, 0 to 85 degC).
const FAR_PERMILLE: i64 = 25;

/// The same for an absolute transducer, pascals: 3000 m of altitude.
const FAR_ABSOLUTE: i32 = 30_000;

/// How far apart the lowest and the highest sample of a window may lie, in standard deviations of one sample.
/// White noise of that size spreads over 5.6 of them in 256 draws, over more than 9 once in 10^16 windows.
const QUIET_DEVIATIONS: i64 = 10;

/// What a window is compared with.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Gates {
    /// The zero to be expected: stored, or the design's rest pressure.
    pub reference: Pressure,
    /// Whether the reference was stored by someone who saw the fingertip untouched.
    pub stored: bool,
    /// How far from it a zero may lie that nobody vouches for, counts, >= 0.
    pub near: i32,
    /// How far from it any zero may lie, counts, >= 0.
    pub far: i32,
    /// How far a quiet window may spread, counts, >= 0.
    pub quiet: i32,
    /// The rise from which on the fingertip is touched.
    pub touch: PressureRise,
    /// The weather is in the pressure.
    pub absolute: bool,
}

impl Gates {
    /// The gates of a design without a stored calibration.
    pub const fn of(constants: &DesignConstants, fraction_bits: u32) -> Self {
        let transducer = &constants.transducer;
        let range = transducer.range[1] as i64 - transducer.range[0] as i64;
        let grain = transducer.grain();
        let absolute = matches!(Quantity::of(&transducer.kind), Quantity::Absolute);
        let near = range * NEAR_PERMYRIAD / 10;
        Self {
            reference: Pressure::from_pascals(constants.rest_pressure, fraction_bits),
            stored: false,
            near: Pressure::from_millipascals(near, fraction_bits).0,
            far: if absolute {
                Pressure::from_pascals(FAR_ABSOLUTE, fraction_bits).0
            } else {
                Pressure::from_millipascals(range * FAR_PERMILLE, fraction_bits).0
            },
            quiet: Pressure::from_millipascals(grain * QUIET_DEVIATIONS, fraction_bits).0,
            touch: Thresholds::of(constants, fraction_bits).touch,
            absolute,
        }
    }

    /// The same with a stored zero for the reference.
    #[must_use]
    pub const fn with_stored(mut self, zero: Pressure) -> Self {
        self.reference = zero;
        self.stored = true;
        self
    }

    fn within(&self, zero: Pressure, reach: i32) -> bool {
        zero.0.abs_diff(self.reference.0) <= reach.unsigned_abs()
    }
}

/// Where the zero comes from at start-up.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum StartUp {
    /// Measured, if the gates let it.
    Measured,
    /// The reference.
    Stored,
    /// The zero that served before the reset, and whether it was verified.
    Kept(Zero),
}

impl StartUp {
    /// Someone switched the power on or pressed the button, and can be asked to leave the fingertip alone;
    /// a watchdog asks nobody. `kept` is the zero from before the reset, if it survived.
    pub const fn after(cause: ResetCause, kept: Option<Zero>) -> Self {
        match (cause, kept) {
            (ResetCause::PowerOn | ResetCause::Pin | ResetCause::BrownOut, _) => Self::Measured,
            (_, Some(zero)) => Self::Kept(zero),
            (_, None) => Self::Stored,
        }
    }
}

/// A zero.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Zero {
    /// The pressure that reads as no rise.
    pub pressure: Pressure,
    /// Whether it was measured on a fingertip that nothing pressed.
    pub verified: bool,
}

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
    const NEW: Self = Self {
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
            StartUp::Stored => Some(Self::unverified(&gates)),
            StartUp::Kept(zero) => Some(zero),
        };
        Self {
            gates,
            zero,
            anchor: match zero {
                Some(zero) => zero.pressure,
                None => gates.reference,
            },
            previous: None,
            measuring: match zero {
                None => Some(Measuring::NEW),
                Some(_) => None,
            },
            answer: None,
            moved: zero.is_some(),
        }
    }

    const fn unverified(gates: &Gates) -> Zero {
        Zero {
            pressure: gates.reference,
            verified: false,
        }
    }

    /// The zero that serves, if there is one yet.
    pub const fn zero(&self) -> Option<Zero> {
        self.zero
    }

    /// The zero to be expected.
    pub const fn reference(&self) -> Pressure {
        self.gates.reference
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
            if tired && self.zero.is_some() {
                self.give_up();
            }
        }
    }

    /// Someone says that nothing presses: takes a new zero if the gates let it. The answer comes through
    /// [`Tare::take_answer`] within [`PATIENCE`] of the next sample.
    ///
    /// # Errors
    /// [`TareRefusal::Busy`].
    pub fn command(&mut self) -> Result<(), TareRefusal> {
        if self.measuring.is_some() {
            return Err(TareRefusal::Busy);
        }
        self.measuring = Some(Measuring::NEW);
        Ok(())
    }

    /// Takes back the last commanded zero.
    ///
    /// # Errors
    /// [`TareRefusal::NothingToUndo`], [`TareRefusal::Busy`].
    pub fn undo(&mut self) -> Result<(), TareRefusal> {
        if self.measuring.is_some() {
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
        if let Some((mean, spread)) = measuring.window.add(time, pressure) {
            measuring.window = Window::EMPTY;
            let judged = if spread > self.gates.quiet {
                Err(TareRefusal::Restless)
            } else {
                self.judge(mean, drift)
            };
            match judged {
                Ok(zero) => {
                    self.accept(zero, drift);
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
    fn judge(&self, mean: Pressure, drift: i32) -> Result<Zero, TareRefusal> {
        let gates = &self.gates;
        let verified = |verified| Zero {
            pressure: mean,
            verified,
        };
        let judged = match self.zero {
            // At start-up.
            None if gates.absolute => Ok(verified(false)),
            None if gates.within(mean, gates.near) => Ok(verified(true)),
            None => Err(TareRefusal::Touched),
            // On command, over a zero that tells a touch.
            Some(zero) if zero.verified => {
                let anchor = i64::from(self.anchor.0) + i64::from(drift);
                if i64::from(mean.0) - anchor > i64::from(gates.touch.0) {
                    Err(TareRefusal::Touched)
                } else {
                    Ok(verified(true))
                }
            }
            // On command, over one that does not: only a stored zero can object.
            Some(_) if gates.stored && !gates.absolute && !gates.within(mean, gates.near) => {
                Err(TareRefusal::Touched)
            }
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

    fn accept(&mut self, zero: Zero, drift: i32) {
        let before = self.zero.replace(zero);
        self.anchor = match before {
            Some(before) if before.verified => {
                zero.pressure.min(Pressure(self.anchor.0.saturating_add(drift)))
            }
            _ => zero.pressure,
        };
        if let Some(before) = before {
            self.previous = Some(Zero {
                pressure: Pressure(before.pressure.0.saturating_add(drift)),
                ..before
            });
            self.answer = Some(Ok(()));
        }
        self.measuring = None;
        self.moved = true;
    }

    fn give_up(&mut self) {
        let Some(measuring) = self.measuring.take() else {
            return;
        };
        if self.zero.is_some() {
            self.answer = Some(Err(measuring.objection));
        } else {
            self.zero = Some(Self::unverified(&self.gates));
            self.moved = true;
        }
    }
}

#[cfg(test)]
mod tests;
