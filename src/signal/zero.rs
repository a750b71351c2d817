//! The zero of a fingertip: a value, and a bound of its error. Touch, tare, undo, drift, leak and every 1-sigma come from it.
//!
//! The `estimator` sees the pressure in quiet windows. It keeps the lowest and the highest pressure that the true zero can have
//! (`interval`). The two move apart with the drift of the transducer (`limits`), and together only with evidence. A reading is ok
//! while the bound is at most six noise floors.
//!
//! # What it assumes
//!
//! 1. A press never lowers the pressure. A quiet window below the interval is therefore evidence that the true zero is not higher.
//!    A wall that creeps back from below its rest violates this for a while; the bound then includes it.
//! 2. The zero drifts at most at its stated rate while the fingertip is pressed. Faster drift of an untouched fingertip is visible.
//!    Upwards, it looks like a slow press, and the bound includes both; downwards, it is evidence.
//! 3. The air around an absolute part is within [`AIR`](model_tables::constants::AIR), changes by weather at no more than its
//!    stated rate while the fingertip is pressed, and by a lift only while nothing presses.
//! 4. Who switches on or pushes the button leaves the fingertip alone. If not, a gauge part loses at most
//!    [`Limits::near`](limits::Limits) without a stored zero and six noise floors with one.
//! 5. Who commands a tare leaves the fingertip alone. If not, a gauge part loses at most six noise floors with status ok: a
//!    level further over all that is known is taken, but stays unverified. An absolute part cannot tell a press from denser
//!    air; it finds out at the release.
//! 6. A tared zero that the user saves is correct.
//! 7. Hum grows by at most one noise floor within four parts of a window, 64 ms.
//!
//! The effects that a design states beside drift (the weight of the fluid, hysteresis, creep, temperature) move the zero back and
//! forth. They are in the margin of every observation. Measured surroundings are in `surroundings`.

pub mod estimator;
mod interval;
pub mod limits;
pub mod surroundings;
pub mod tare;
mod window;

use crate::status::ResetCause;
use crate::units::Pressure;
use model_tables::constants::Quantity;

/// A zero.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Zero {
    /// The pressure that is reported as a rise of 0.
    pub pressure: Pressure,
    /// Its largest error, counts, >= 0.
    pub bound: i32,
    /// Whether it was measured on an untouched fingertip.
    pub verified: bool,
}

/// Source of the zero at start-up.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum StartUp {
    /// Measured, if the limits allow it.
    Measured,
    /// The stored reference, if there is one.
    Stored,
    /// The zero from before the reset.
    Kept(Zero),
}

impl StartUp {
    /// Someone switched the power on or pressed the button, and can be asked to leave the fingertip alone; a watchdog
    /// and a supply that sags ask nobody. `kept` is the zero from before the reset, if it survived: then power was never
    /// off for long, whatever the cause says. An absolute transducer
    /// could not verify another one, so a verified one is kept whatever the cause.
    pub const fn after(cause: ResetCause, kept: Option<Zero>, quantity: Quantity) -> Self {
        match (cause, kept) {
            (_, Some(zero)) if zero.verified && matches!(quantity, Quantity::Absolute) => Self::Kept(zero),
            (ResetCause::PowerOn | ResetCause::BrownOut, Some(zero)) if zero.verified => Self::Kept(zero),
            (ResetCause::PowerOn | ResetCause::Pin | ResetCause::BrownOut, _) => Self::Measured,
            (_, Some(zero)) => Self::Kept(zero),
            (_, None) => Self::Stored,
        }
    }
}
