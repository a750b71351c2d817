//! Why a disc gives no answer, in words.

use super::DiscDesign;
use crate::solid::Failure;
use core::fmt;

/// Cause of the end of a disc's path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DiscEnd {
    /// The pressure has its greatest value: beyond, the disc inflates under less and less.
    PressureMaximum,
    /// The bulge turns over the frame that clamps it.
    BulgeTouchesFrame,
    /// The material law softens at strains that the disc reaches, and nothing more is in balance.
    MaterialSoftens,
    /// The disc folds onto itself.
    WallFolds,
    /// The next state in balance lies elsewhere.
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
    /// Why there is no state beyond it.
    pub ends_by: DiscEnd,
}

/// Why a disc gives no answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DiscError {
    /// The law has no stiffness where nothing is strained.
    NoStiffness {
        /// The shear modulus, pascals.
        shear_modulus: f64,
    },
    /// A length or a stiffness is out of its range.
    NotADisc {
        /// What was given.
        design: DiscDesign,
    },
    /// A gauge pressure is a number of at least 0.
    NotAPressure {
        /// What was asked for, pascals.
        asked: f64,
    },
    /// The disc does not stand the pressure.
    BeyondLimit {
        /// What was asked for, pascals.
        asked: f64,
        /// The end.
        limit: DiscLimit,
    },
    /// The state was not found.
    Unsolved {
        /// What was asked for, pascals.
        asked: f64,
        /// What failed.
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
    /// What ends, in a word.
    pub(crate) fn word(&self) -> &'static str {
        match self {
            Self::BeyondLimit { limit, .. } => limit.ends_by.word(),
            _ => DiscEnd::NoFurtherState.word(),
        }
    }
}
