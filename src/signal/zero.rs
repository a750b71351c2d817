//! A zero, and where the first one comes from.

use crate::status::ResetCause;
use crate::units::Pressure;
use model_tables::constants::Quantity;

/// A zero.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Zero {
    /// The pressure that reads as no rise.
    pub pressure: Pressure,
    /// Whether it was measured on a fingertip that nothing pressed.
    pub verified: bool,
}

/// Where the zero comes from at start-up.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum StartUp {
    /// Measured, if the gates let it.
    Measured,
    /// The reference, if there is one.
    Stored,
    /// The zero that served before the reset, and whether it was verified.
    Kept(Zero),
}

impl StartUp {
    /// Someone switched the power on or pressed the button, and can be asked to leave the fingertip alone;
    /// a watchdog asks nobody. `kept` is the zero from before the reset, if it survived. An absolute transducer could not
    /// verify another one, so a verified one serves on whatever the cause.
    pub const fn after(cause: ResetCause, kept: Option<Zero>, quantity: Quantity) -> Self {
        match (cause, kept) {
            (_, Some(zero)) if zero.verified && matches!(quantity, Quantity::Absolute) => Self::Kept(zero),
            (ResetCause::PowerOn | ResetCause::Pin | ResetCause::BrownOut, _) => Self::Measured,
            (_, Some(zero)) => Self::Kept(zero),
            (_, None) => Self::Stored,
        }
    }
}
