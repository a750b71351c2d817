//! Why the membrane gives no answer, in words.

use crate::limit::{Limit, refuse_cup, refuse_cylinder, refuse_indentation, refuse_unsolved};
use crate::material::stability::Margin;
use crate::membrane::adapt::Unsolved;
use crate::membrane::rest::RestQuantity;
use core::fmt;

/// Why the membrane gives no answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MembraneError {
    /// A rest state of this pressure, radius or height does not exist; SI units.
    NoRestState {
        /// Which quantity was given.
        quantity: RestQuantity,
        /// Its value.
        asked: f64,
        /// The least value any rest state has.
        least: f64,
        /// The greatest value.
        greatest: f64,
    },
    /// Inflation ends before this pole stretch, because the law loses its stability.
    LawUnstable {
        /// The pole stretch asked for.
        asked: f64,
        /// Where it loses it, and how.
        margin: Margin,
    },
    /// A membrane that nothing stretches has no shape to press.
    Unstretched,
    /// The rest state does not hold: it would go on inflating by itself.
    Unheld {
        /// Compliance of the fluid path, cubic metres per pascal.
        compliance: f64,
        /// The compliance below which it holds, if any does.
        largest: Option<f64>,
    },
    /// What touches has no axial symmetry.
    NotAxisymmetric,
    /// The membrane presses onto frictionless plates, balls and cups alone.
    ObjectNotForMembrane,
    /// A cup does not touch the pole first.
    CupTooTight {
        /// Its radius, metres.
        radius: f64,
        /// The least that touches the pole first, metres.
        least: f64,
    },
    /// The rest state was not found.
    RestUnsolved {
        /// What failed.
        failure: Unsolved,
    },
    /// The indentation lies beyond the end of the press.
    BeyondLimit {
        /// The indentation asked for, metres.
        asked: f64,
        /// The end.
        limit: Limit,
    },
    /// An indentation is a length >= 0.
    NotAnIndentation {
        /// What was asked for, metres.
        asked: f64,
    },
    /// The state was not found.
    PressUnsolved {
        /// The indentation asked for, metres.
        asked: f64,
        /// The largest indentation reached on the way, metres.
        reached: f64,
        /// What failed.
        failure: Unsolved,
    },
}

impl fmt::Display for MembraneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NoRestState {
                quantity,
                asked,
                least,
                greatest,
            } => {
                let (what, unit, factor) = match quantity {
                    RestQuantity::PoleStretch => {
                        return write!(
                            f,
                            "inflation does not lead to a pole stretch of {asked}: it stretches the pole to \
                             {greatest:.6}, and then the equator bulges instead; ask for less"
                        );
                    }
                    RestQuantity::Pressure => ("pressure", "kPa", 1e-3),
                    RestQuantity::EquatorRadius => ("equator radius", "mm", 1e3),
                    RestQuantity::Height => ("height", "mm", 1e3),
                };
                write!(
                    f,
                    "no rest state has a {what} of {} {unit}: inflation reaches {:.6} to {:.6} {unit}; ask for a \
                     value in between, or give the rest state by pole_stretch",
                    asked * factor,
                    least * factor,
                    greatest * factor
                )
            }
            Self::LawUnstable { asked, margin } => write!(
                f,
                "no rest state has a pole stretch of {asked}: on the way there the law loses its stability at stretches of \
                 {:.4} along and {:.4} around ({}); ask for less, or fit the law up to such stretches",
                margin.meridional_stretch, margin.hoop_stretch, margin.mode
            ),
            Self::Unstretched => write!(
                f,
                "an unstretched membrane has no rest state: give one in [rest], or set model.kind to \"solid\""
            ),
            Self::Unheld { compliance, largest } => match largest {
                Some(largest) => write!(
                    f,
                    "the rest state does not hold: its pressure falls as it is inflated, so that with a compliance of \
                     {:.6} mm3/kPa it goes on inflating by itself; at less than {:.6} mm3/kPa it holds",
                    compliance * 1e12,
                    largest * 1e12
                ),
                None => f.write_str(
                    "the rest state does not hold: even at a fixed volume of fluid its pole bulges by itself; ask for a \
                     smaller pole stretch",
                ),
            },
            Self::NotAxisymmetric => refuse_cylinder(f),
            Self::ObjectNotForMembrane => f.write_str(
                "the membrane presses onto a frictionless plate, ball or cup: set model.kind to \"solid\" for another \
                 [object], or leave its friction and shape out",
            ),
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
            } => refuse_unsolved(f, asked, reached, &failure),
        }
    }
}

impl core::error::Error for MembraneError {}

impl MembraneError {
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
