//! Gauge pressure -> pressure rise over a zero that is taken once, at start-up, or not at all.
//!
//! A zero taken on a pressed fingertip reads every later press too low, so it is gated twice: the window must
//! be quiet, and its mean near the rest pressure the design was solved for. The gate cannot tell a still,
//! light press at power-up from a transducer's offset: what it lets through is bounded by `BAND_PERMILLE` of
//! the transducer's range. When no window passes in [`PATIENCE`], and after a reset that nobody saw coming
//! (the hand may be holding something), the design's rest pressure serves, and every reading says so.

use crate::pressure::{Pressure, saturate};
use crate::report::{Fault, Microseconds, Warnings};
use crate::telemetry::ResetCause;
use model_tables::constants::DesignConstants;
use model_tables::units::PressureRise;

/// Blocks in a window, a power of two: 256 ms. Longer than any hum, shorter than patience.
const WINDOW: u32 = 256;

/// How long a good window is waited for, microseconds.
pub const PATIENCE: u64 = 2_000_000;

/// How far the mean may lie from the design's rest pressure, thousandths of the transducer's range: the offset
/// that NXP allows an MPX5100 (2.5 % of full scale, 0 to 85 degC).
const BAND_PERMILLE: i64 = 25;

/// How far apart the lowest and the highest block of a window may lie, in standard deviations of one sample.
/// White noise of that size spreads over 5.6 of them in 256 draws, over more than 9 once in 10^16 windows.
const QUIET_DEVIATIONS: i64 = 10;

/// What the gates compare with.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Gates {
    /// The rest pressure the design was solved for.
    pub rest: Pressure,
    /// How far from it a zero may lie, counts, >= 0.
    pub band: i32,
    /// How far a quiet window may spread, counts, >= 0.
    pub quiet: i32,
}

impl Gates {
    /// The gates of a design.
    pub const fn of(constants: &DesignConstants, fraction_bits: u32) -> Self {
        let transducer = &constants.transducer;
        let range = transducer.range[1] as i64 - transducer.range[0] as i64;
        let grain = constants.transducer.grain();
        Self {
            rest: Pressure::from_pascals(constants.rest_pressure, fraction_bits),
            band: Pressure::from_millipascals(range * BAND_PERMILLE, fraction_bits).0,
            quiet: Pressure::from_millipascals(grain * QUIET_DEVIATIONS, fraction_bits).0,
        }
    }
}

/// Where the zero comes from.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum StartUp {
    /// Measured, if the gates let it.
    Measured,
    /// The design's rest pressure.
    Stored,
}

impl StartUp {
    /// Someone switched the power on or pressed the button, and can be asked to leave the fingertip alone;
    /// a watchdog asks nobody.
    pub const fn after(cause: ResetCause) -> Self {
        match cause {
            ResetCause::PowerOn | ResetCause::Pin | ResetCause::BrownOut => Self::Measured,
            ResetCause::Unknown | ResetCause::Software | ResetCause::Watchdog | ResetCause::LowPower => {
                Self::Stored
            }
        }
    }
}

/// The tare stage.
#[derive(Clone, Debug)]
pub struct Tare {
    gates: Gates,
    state: State,
}

#[derive(Clone, Debug)]
enum State {
    Measuring {
        since: Option<Microseconds>,
        window: Window,
    },
    Zeroed {
        zero: Pressure,
        warnings: Warnings,
    },
}

/// Blocks so far: 256 of at most 2^31 sum up to at most 2^39.
#[derive(Clone, Debug)]
struct Window {
    blocks: u32,
    sum: i64,
    lowest: Pressure,
    highest: Pressure,
}

impl Window {
    const EMPTY: Self = Self {
        blocks: 0,
        sum: 0,
        lowest: Pressure(i32::MAX),
        highest: Pressure(i32::MIN),
    };

    fn add(&mut self, pressure: Pressure) {
        self.blocks += 1;
        self.sum += i64::from(pressure.0);
        self.lowest = self.lowest.min(pressure);
        self.highest = self.highest.max(pressure);
    }

    /// The mean of a full window that passes the gates.
    fn zero(&self, gates: &Gates) -> Option<Pressure> {
        let mean = saturate((self.sum + i64::from(WINDOW / 2)) >> WINDOW.trailing_zeros());
        let quiet = self.highest.0.saturating_sub(self.lowest.0) <= gates.quiet;
        let near = mean.abs_diff(gates.rest.0) <= gates.band.unsigned_abs();
        (quiet && near).then_some(Pressure(mean))
    }
}

impl Tare {
    /// A tare that has seen nothing yet.
    pub const fn new(gates: Gates, start_up: StartUp) -> Self {
        let state = match start_up {
            StartUp::Measured => State::Measuring {
                since: None,
                window: Window::EMPTY,
            },
            StartUp::Stored => Self::unverified(&gates),
        };
        Self { gates, state }
    }

    const fn unverified(gates: &Gates) -> State {
        State::Zeroed {
            zero: gates.rest,
            warnings: Warnings::ZERO_UNVERIFIED,
        }
    }

    /// The rise of a pressure over the zero, held at the ends of the word, and whether the zero is verified.
    ///
    /// # Errors
    /// [`Fault::Zeroing`] until there is a zero.
    #[inline]
    pub fn step(
        &mut self,
        time: Microseconds,
        pressure: Pressure,
    ) -> Result<(PressureRise, Warnings), Fault> {
        match self.state {
            State::Zeroed { zero, warnings } => {
                Ok((PressureRise(pressure.0.saturating_sub(zero.0)), warnings))
            }
            State::Measuring { .. } => {
                self.measure(time, pressure);
                Err(Fault::Zeroing)
            }
        }
    }

    /// A gap in the blocks: a window has no gaps. Patience runs on.
    pub fn interrupt(&mut self, time: Microseconds) {
        if let State::Measuring { since, window } = &mut self.state {
            *window = Window::EMPTY;
            since.get_or_insert(time);
        }
    }

    #[cold]
    fn measure(&mut self, time: Microseconds, pressure: Pressure) {
        let State::Measuring { since, window } = &mut self.state else {
            return;
        };
        let since = *since.get_or_insert(time);
        window.add(pressure);
        if window.blocks == WINDOW {
            if let Some(zero) = window.zero(&self.gates) {
                self.state = State::Zeroed {
                    zero,
                    warnings: Warnings::NONE,
                };
                return;
            }
            *window = Window::EMPTY;
        }
        if time.0.saturating_sub(since.0) >= PATIENCE {
            self.state = Self::unverified(&self.gates);
        }
    }
}

#[cfg(test)]
mod tests;
