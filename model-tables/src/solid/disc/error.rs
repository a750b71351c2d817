//! Reasons why a disc gives no answer, as text.

use super::DiscDesign;
use crate::solid::Failure;
use core::fmt;

/// Cause of the end of a disc's path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DiscEnd {
    /// The pressure has reached its maximum. After it, the disc inflates further under a falling pressure.
    PressureMaximum,
    /// The bulge turns over the frame that clamps it.
    BulgeTouchesFrame,
    /// The material law softens at strains that the disc reaches, and there is no further state in balance.
    MaterialSoftens,
    /// The disc folds onto itself.
    WallFolds,
    /// The next state in balance is on another branch.
    NoFurtherState,
}

impl DiscEnd {
    /// The word used in messages.
    pub fn word(self) -> &'static str {
        match self {
            Self::PressureMaximum => "pressure-maximum",
            Self::BulgeTouchesFrame => "bulge-touches-frame",
            Self::MaterialSoftens => "material-softens",
            Self::WallFolds => "wall-folds",
            Self::NoFurtherState => "no-further-state",
        }
    }
}

/// The end of a disc's path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiscLimit {
    /// Greatest pressure, pascals.
    pub pressure: f64,
    /// Why there is no state above this pressure.
    pub ends_by: DiscEnd,
}

/// Why a disc gives no answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DiscError {
    /// The law has no stiffness in the unstrained state.
    NoStiffness {
        /// The shear modulus, pascals.
        shear_modulus: f64,
    },
    /// A length or a stiffness is out of its range.
    NotADisc {
        /// The given value.
        design: DiscDesign,
    },
    /// The gauge pressure must be a number of at least 0.
    NotAPressure {
        /// The requested pressure, pascals.
        asked: f64,
    },
    /// The disc has no state at this pressure.
    BeyondLimit {
        /// The requested pressure, pascals.
        asked: f64,
        /// The end of the disc's path.
        limit: DiscLimit,
    },
    /// The state was not found.
    Unsolved {
        /// The requested pressure, pascals.
        asked: f64,
        /// The failure of the solver.
        failure: Failure,
    },
}

impl fmt::Display for DiscError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NoStiffness { shear_modulus } => write!(
                f,
                "the actuator's material has no stiffness at rest: its shear modulus is {shear_modulus} Pa; choose constants \
                 that make it positive"
            ),
            Self::NotADisc { design } => write!(
                f,
                "an actuator of diameter {:?} mm and thickness {:?} mm with {} over it is no disc: the thickness must be more than 0 \
                 and less than the diameter, a gap at least 0, a foundation's stiffness more than 0",
                design.diameter * 1e3,
                design.thickness * 1e3,
                design.far_side
            ),
            Self::NotAPressure { asked } => write!(
                f,
                "actuator pressure {} kPa is not possible: it must be a number of at least 0",
                asked / 1e3
            ),
            Self::BeyondLimit { asked, limit } => write!(
                f,
                "actuator pressure {} kPa is beyond the limit of {:.6} kPa, where the disc's states end ({}); ask for less, or \
                 take a thicker, smaller or stiffer disc",
                asked / 1e3,
                limit.pressure / 1e3,
                limit.ends_by.word()
            ),
            Self::Unsolved { asked, failure } => write!(
                f,
                "the actuator's state at {} kPa was not found ({failure})",
                asked / 1e3
            ),
        }
    }
}

impl core::error::Error for DiscError {}

impl DiscError {
    /// Name of what ends.
    pub(crate) fn word(&self) -> &'static str {
        match self {
            Self::BeyondLimit { limit, .. } => limit.ends_by.word(),
            _ => DiscEnd::NoFurtherState.word(),
        }
    }
}
