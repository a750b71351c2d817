//! Reasons why the solid gives no answer, as text.

use super::Failure;
use crate::limit::{Limit, refuse_cup, refuse_cylinder, refuse_indentation, refuse_unsolved};
use core::fmt;

/// Why the solid gives no answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SolidError {
    /// A solid must rest unstretched, or at a pressure.
    RestNotForSolid,
    /// The law has no stiffness in the unstrained state: its shear modulus is not positive.
    NoStiffness {
        /// The shear modulus, pascals.
        shear_modulus: f64,
    },
    /// Inflation does not reach this pressure; pascals.
    PressureOutOfReach {
        /// The requested pressure.
        asked: f64,
        /// The largest pressure that inflation reaches.
        greatest: f64,
    },
    /// The object has no axial symmetry.
    NotAxisymmetric,
    /// The cup does not touch the pole first.
    CupTooTight {
        /// Its radius, metres.
        radius: f64,
        /// The smallest radius that touches the pole first, metres.
        least: f64,
    },
    /// The rest state was not found.
    RestUnsolved {
        /// The failure of the solver.
        failure: Failure,
    },
    /// The indentation is beyond the end of the press.
    BeyondLimit {
        /// The requested indentation, metres.
        asked: f64,
        /// The end of the press.
        limit: Limit,
    },
    /// The indentation must be a length >= 0.
    NotAnIndentation {
        /// The requested indentation, metres.
        asked: f64,
    },
    /// The state was not found.
    PressUnsolved {
        /// The requested indentation, metres.
        asked: f64,
        /// The largest indentation reached on the way, metres.
        reached: f64,
        /// The failure of the solver.
        failure: Failure,
    },
}

impl fmt::Display for SolidError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::RestNotForSolid => write!(
                f,
                "a solid rests unstretched or at a pressure: leave [rest] out, or give rest.pressure_kpa"
            ),
            Self::NoStiffness { shear_modulus } => write!(
                f,
                "the material has no stiffness at rest: its shear modulus is {shear_modulus} Pa; choose constants that \
                 make it positive, of a Mooney-Rivlin law c1 + c2 > 0"
            ),
            Self::PressureOutOfReach { asked, greatest } => write!(
                f,
                "no rest state has a pressure of {} kPa: inflation reaches {:.6} kPa and softens there; ask for less",
                asked * 1e-3,
                greatest * 1e-3
            ),
            Self::NotAxisymmetric => refuse_cylinder(f),
            Self::CupTooTight { radius, least } => refuse_cup(f, radius, least),
            Self::RestUnsolved { failure } => {
                write!(
                    f,
                    "the rest state was not found ({failure}); ask for a less inflated one"
                )
            }
            Self::BeyondLimit { asked, limit } => limit.refuse(f, asked),
            Self::NotAnIndentation { asked } => refuse_indentation(f, asked),
            Self::PressUnsolved {
                asked,
                reached,
                failure,
            } => {
                refuse_unsolved(f, asked, reached, &failure)?;
                f.write_str("; more elements along the wall (model.along) may have it")
            }
        }
    }
}

impl core::error::Error for SolidError {}

impl SolidError {
    /// The same with every indentation as `read` has it.
    #[must_use]
    pub fn read_by(self, read: impl Fn(f64) -> f64) -> Self {
        match self {
            Self::BeyondLimit { asked, limit } => Self::BeyondLimit {
                asked: read(asked),
                limit: limit.read_by(read),
            },
            Self::PressUnsolved {
                asked,
                reached,
                failure,
            } => Self::PressUnsolved {
                asked: read(asked),
                reached: read(reached),
                failure,
            },
            other => other,
        }
    }
}
