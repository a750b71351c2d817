//! The reasons why a press in time has no answer.

use crate::limit::EndsBy;
use crate::solid::disc::DiscEnd;
use crate::solid::{Failure, SolidError};
use core::fmt;

/// Reasons why a press in time has no answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HistoryError {
    /// The wall is inflated at rest.
    Inflated,
    /// The fluid's circuit is compliant.
    Compliant,
    /// The object has friction, so a state would depend on all states before it.
    Friction,
    /// The object is not valid for this wall.
    Object(SolidError),
    /// The law has no stiffness; shear modulus in pascals.
    NoStiffness(f64),
    /// The requested time is not after the previous instant.
    NotAfter {
        /// The requested time, seconds.
        asked: f64,
        /// The instant before, seconds.
        before: f64,
    },
    /// The wall reaches its base.
    Ends {
        /// Time, seconds.
        time: f64,
        /// Indentation, metres.
        indentation: f64,
        /// The end of the press.
        by: EndsBy,
    },
    /// The actuator has no state at the next pressure.
    Actuator {
        /// Time, seconds.
        time: f64,
        /// Pressure of the state before, pascals.
        pressure: f64,
        /// Why there is no state after it.
        by: DiscEnd,
    },
    /// The end of an interval was not reached.
    TooManySteps {
        /// Time, seconds.
        time: f64,
        /// Indentation there, metres.
        indentation: f64,
        /// Force there, newtons.
        force: f64,
        /// Number of steps that were tried.
        steps: u32,
    },
    /// A state was not found.
    Unsolved {
        /// Time, seconds.
        time: f64,
        /// Indentation of the state before, metres.
        indentation: f64,
        /// The failure of the solver.
        failure: Failure,
    },
}

impl fmt::Display for HistoryError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Inflated => write!(
                f,
                "a press in time is for a wall that rests unstretched: leave [rest] and calibration.pole_stretch out"
            ),
            Self::Compliant => write!(
                f,
                "a press in time is for a rigid circuit: set fluid.compliance_mm3_per_kpa (or that of [calibration]) to 0"
            ),
            Self::Friction => write!(
                f,
                "a press in time is without friction: leave object.friction out, or set it to 0"
            ),
            Self::Object(error) => error.fmt(f),
            Self::NoStiffness(modulus) => {
                write!(f, "the law's shear modulus is {modulus} Pa: it has to be above 0")
            }
            Self::NotAfter { asked, before } => write!(
                f,
                "time_s = {asked} is not after the row before, {before}: rows have to follow in time"
            ),
            Self::Ends {
                time,
                indentation,
                by,
            } => write!(
                f,
                "the press ends at {:.6} mm ({}) at time_s = {time:.6}: press less deep",
                1e3 * indentation,
                by.word()
            ),
            Self::Actuator { time, pressure, by } => write!(
                f,
                "the actuator's states end at {:.6} kPa ({}) at time_s = {time:.6}: press less deep, or take a thicker, smaller or \
                 stiffer disc",
                pressure / 1e3,
                by.word()
            ),
            Self::TooManySteps {
                time,
                indentation,
                force,
                steps,
            } => write!(
                f,
                "{steps} steps of one row led to {:.6} mm and {force:.6} N at time_s = {time:.6} and no further: press less deep or with \
                 less force, or give more rows",
                1e3 * indentation
            ),
            Self::Unsolved {
                time,
                indentation,
                failure,
            } => write!(
                f,
                "no state was found after time_s = {time:.6}, at {:.6} mm ({failure}): press less deep or more slowly",
                1e3 * indentation
            ),
        }
    }
}

impl core::error::Error for HistoryError {}
