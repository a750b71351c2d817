//! Why the model gives no answer, in words.

use super::Limit;
use crate::material::stability::Margin;
use crate::membrane::adapt::Failure;
use crate::membrane::rest::Quantity;
use core::fmt;

/// Why the model gives no answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ModelError {
    /// A rest state of this pressure, radius or height does not exist; SI units.
    NoRestState {
        /// Which quantity was given.
        quantity: Quantity,
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
    /// A solid rests unstretched, or at a pressure.
    RestNotForSolid,
    /// Inflation of a solid does not reach this pressure; pascals.
    PressureOutOfReach {
        /// What was asked for.
        asked: f64,
        /// The greatest that inflation passes.
        greatest: f64,
    },
    /// The rest state does not hold: it would go on inflating by itself.
    Unheld {
        /// Compliance of the fluid path, cubic metres per pascal.
        compliance: f64,
        /// The compliance below which it holds, if any does.
        largest: Option<f64>,
    },
    /// The rest state was not found.
    RestUnsolved {
        /// What failed.
        failure: Failure,
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
        failure: Failure,
    },
}

impl fmt::Display for ModelError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NoRestState {
                quantity,
                asked,
                least,
                greatest,
            } => {
                let (what, unit, factor) = match quantity {
                    Quantity::PoleStretch => {
                        return write!(
                            f,
                            "inflation does not lead to a pole stretch of {asked}: it stretches the pole to \
                             {greatest:.6}, and then the equator bulges instead; ask for less"
                        );
                    }
                    Quantity::Pressure => ("pressure", "kPa", 1e-3),
                    Quantity::EquatorRadius => ("equator radius", "mm", 1e3),
                    Quantity::Height => ("height", "mm", 1e3),
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
            Self::RestNotForSolid => write!(
                f,
                "a solid rests unstretched or at a pressure: leave [rest] out, or give rest.pressure_kpa"
            ),
            Self::PressureOutOfReach { asked, greatest } => write!(
                f,
                "no rest state has a pressure of {} kPa: inflation reaches {:.6} kPa and softens there; ask for less",
                asked * 1e-3,
                greatest * 1e-3
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
            Self::RestUnsolved { failure } => {
                write!(
                    f,
                    "the rest state was not found ({failure}); ask for a less inflated one"
                )
            }
            Self::BeyondLimit { asked, limit } => write!(
                f,
                "indentation {} mm is beyond the limit of {:.6} mm, where the press ends ({}); ask for less",
                asked * 1e3,
                limit.indentation * 1e3,
                limit.ends_by.word()
            ),
            Self::NotAnIndentation { asked } => {
                write!(
                    f,
                    "indentation {} mm is not possible: it must be a number of at least 0",
                    asked * 1e3
                )
            }
            Self::PressUnsolved {
                asked,
                reached,
                failure,
            } => write!(
                f,
                "the state at indentation {} mm was not found ({failure}); the last one found is at {:.6} mm",
                asked * 1e3,
                reached * 1e3
            ),
        }
    }
}

impl core::error::Error for ModelError {}
