//! Methods kept for comparison with the membrane model.
//!
//! What a designer could reach for instead of [`press`](model_tables::membrane::press), each in one file with its source and
//! its weakness: the source paper's nested [`bisection`], [`shooting`] with Newton's method (from its [`unpressed`] state), the closed form for
//! [`light_contact`], and curves through a [`few_states`]. [`approximations`] measures the cheap ones against the full
//! membrane; [`benchmark`] times all of them in one run.
//!
//! Bisection and shooting integrate the plain membrane's equations as [`plain`] writes them, independently of the
//! production method: a state found by both is right.

pub mod approximations;
pub mod benchmark;
pub mod bisection;
pub mod dop853;
pub mod few_states;
pub mod light_contact;
mod matrix;
pub mod plain;
mod runge_kutta;
pub mod shooting;
pub mod unpressed;

use model_tables::membrane::press::MembraneError;
use std::fmt;

/// A pressed state, as the methods for comparison find it; SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MethodState {
    /// How far the plate went down from first touch, metres.
    pub indentation: f64,
    /// Gauge pressure, pascals.
    pub pressure: f64,
    /// Pressure over that of the rest state, pascals.
    pub pressure_rise: f64,
    /// Force on the plate, newtons.
    pub force: f64,
    /// Deformed radius of the contact, metres.
    pub contact_radius: f64,
    /// The contact edge in the meridian's parameter, radians.
    pub contact_parameter: f64,
    /// Stretch of the pole, dimensionless.
    pub pole_stretch: f64,
    /// Some tension is negative: a real membrane would be wrinkled or slack there.
    pub compressed: bool,
}

/// An unknown of the integrating methods.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unknown {
    /// Stretch of the pole.
    PoleStretch,
    /// Pressure.
    Pressure,
    /// The contact edge.
    Contact,
}

/// Why a method for comparison gives no state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MethodFailure {
    /// These methods know the rest state by its pole stretch only.
    RestNotByPoleStretch,
    /// The rest state has hoop wrinkles, which this model does not know.
    RestWrinkled,
    /// An indentation is a finite length >= 0.
    NotAnIndentation {
        /// What was asked for, metres.
        asked: f64,
    },
    /// The indentation is lost in the method's own errors.
    BelowResolution {
        /// What was asked for, metres.
        asked: f64,
        /// The least the method resolves, metres.
        least: f64,
    },
    /// The integration left what a membrane can be, or its step became negligible.
    BlewUp {
        /// Where on the meridian.
        position: f64,
    },
    /// No two values of an unknown with a root between them were found.
    NoBracket {
        /// The unknown.
        unknown: Unknown,
    },
    /// The bisection closed in on a jump.
    Jump {
        /// The unknown.
        unknown: Unknown,
        /// What is left of its equation, relative.
        residual: f64,
    },
    /// The law is not stable at the stretches found: the state is one of several at best.
    LawUnstable,
    /// The state is too far off: its own estimate says so.
    Inaccurate {
        /// Estimate of the force's error, relative.
        estimate: f64,
    },
    /// Newton's method got no further.
    Stalled {
        /// What is left of the equations, relative.
        residual: f64,
        /// Condition of the last matrix: digits beyond its inverse are lost.
        condition: f64,
    },
    /// Newton's matrix is singular.
    Singular,
    /// The contact is wider than the membrane's edge: the bulge would lie below the base plane.
    BeyondLimit {
        /// Contact radius over edge radius.
        ratio: f64,
    },
    /// The indentation lies beyond what the model covers.
    BeyondModel {
        /// What was asked for, metres.
        asked: f64,
        /// The largest it covers, metres.
        largest: f64,
    },
    /// The full membrane, on which the model is built, gave no answer.
    Membrane(MembraneError),
}

impl fmt::Display for MethodFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::RestNotByPoleStretch => {
                write!(
                    f,
                    "the rest state must be given by rest.pole_stretch for this method"
                )
            }
            Self::RestWrinkled => write!(f, "the rest state is wrinkled, which this model does not know"),
            Self::NotAnIndentation { asked } => {
                write!(f, "indentation {} mm is not possible", asked * 1e3)
            }
            Self::BelowResolution { asked, least } => write!(
                f,
                "indentation {:.6} mm is below the {:.6} mm that the method's tolerance resolves",
                asked * 1e3,
                least * 1e3
            ),
            Self::BlewUp { position } => {
                write!(
                    f,
                    "the integration blew up at parameter {position:.4} of the meridian"
                )
            }
            Self::NoBracket { unknown } => write!(f, "no bracket for the {unknown}"),
            Self::Jump { unknown, residual } => {
                write!(
                    f,
                    "bisection of the {unknown} closed in on a jump, {residual:.1e} left"
                )
            }
            Self::LawUnstable => write!(f, "the law is not stable at the stretches found"),
            Self::Inaccurate { estimate } => {
                write!(
                    f,
                    "the force is off by {:.1} %: more steps are needed",
                    estimate * 100.0
                )
            }
            Self::Stalled { residual, condition } => write!(
                f,
                "Newton's method stalled with {residual:.1e} left, condition {condition:.1e}"
            ),
            Self::Singular => write!(f, "Newton's matrix became singular"),
            Self::BeyondLimit { ratio } => {
                write!(
                    f,
                    "beyond the limit: contact radius {ratio:.4} of the edge radius"
                )
            }
            Self::BeyondModel { asked, largest } => write!(
                f,
                "indentation {:.6} mm is beyond the {:.6} mm it covers",
                asked * 1e3,
                largest * 1e3
            ),
            Self::Membrane(error) => error.fmt(f),
        }
    }
}

impl fmt::Display for Unknown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::PoleStretch => "pole stretch",
            Self::Pressure => "pressure",
            Self::Contact => "contact edge",
        })
    }
}

impl core::error::Error for MethodFailure {}

impl From<MembraneError> for MethodFailure {
    fn from(error: MembraneError) -> Self {
        Self::Membrane(error)
    }
}
