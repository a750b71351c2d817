//! Reasons why a design gets no tables.

use crate::constants::BELOW_ZERO_DEVIATIONS;
use crate::curve::CurveFailure;
use crate::design_file::DesignFileError;
use crate::generate::NoTables;
use crate::generate::object::NoObjects;
use crate::model::ModelError;
use crate::model::feedback::LoopError;
use crate::solid::history::HistoryError;
use std::fmt;

/// Why a design has no tables. `Display` is one line that names the design's key, the numbers and the remedy.
#[derive(Clone, Debug, PartialEq)]
pub enum GenerateError {
    /// The design file cannot be used.
    File(DesignFileError),
    /// A section that the tables need is missing.
    MissingSection {
        /// The section.
        section: &'static str,
    },
    /// The wall relaxes, but its convolution is not valid for this design: the key, and the remedy.
    NotConvolved(&'static str),
    /// The design has an actuator disc, but tables with an actuator are not valid for this design: the key, and the remedy.
    NotHaptic(&'static str),
    /// The loop of fingertip and actuator has no solution.
    Loop(LoopError),
    /// The wall relaxes, but the solid finds no press in time to which the chip's rules can be fitted.
    InTime(HistoryError),
    /// `air.reference` is `"part"`: no board has a second transducer.
    SecondTransducer,
    /// The model gives no answer, or ends before `max_indentation_mm`.
    Model(ModelError),
    /// Pressure or force do not grow over the whole press.
    Curve(CurveFailure<ModelError>),
    /// A pressure lies outside the transducer's range.
    OutOfRange {
        /// Which pressure.
        state: DesignState,
        /// The gauge pressure, kilopascals.
        pressure: f64,
        /// Gauge pressures that the transducer reads in any air, kilopascals.
        range: [f64; 2],
        /// The absolute range that those are left of, where `transducer.range_kpa` is one; kilopascals.
        absolute: Option<[f64; 2]>,
    },
    /// The whole press raises the pressure by no more than the noise around zero.
    Unfelt {
        /// The pressure rise, pascals.
        rise: f64,
        /// The limit of noise, pascals.
        least: f64,
        /// The transducer's key that says so, and its value in pascals.
        key: (&'static str, f64),
    },
    /// The membrane differs from the solid by more than `accuracy.model_percent`.
    CoarseMembrane {
        /// By how much, in words.
        error: String,
        /// The allowed difference, percent.
        allowed: f64,
    },
    /// The mesh differs from a finer one by more than `accuracy.model_percent`.
    CoarseMesh {
        /// By how much, in words.
        error: String,
        /// The allowed difference, percent.
        allowed: f64,
    },
    /// The data that the tables are to come from end before `max_indentation_mm`.
    BeyondData {
        /// The requested indentation, millimetres.
        asked: f64,
        /// The largest indentation of the data, millimetres.
        deepest: f64,
    },
    /// There are no tables for objects other than a plate.
    Objects(NoObjects),
    /// No tables meet the accuracy.
    NoTables(NoTables),
}

/// A state whose pressure the transducer must read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DesignState {
    /// At rest.
    Rest,
    /// At `max_indentation_mm`.
    Pressed {
        /// The indentation, millimetres.
        indentation: f64,
    },
}

impl fmt::Display for GenerateError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(error) => error.fmt(f),
            Self::NotConvolved(reason) | Self::NotHaptic(reason) => f.write_str(reason),
            Self::Loop(error) => error.fmt(f),
            Self::InTime(error) => write!(
                f,
                "the chip's rules for a wall with [material.relaxation] are fitted to a press of 1 s, and {error}"
            ),
            Self::SecondTransducer => write!(
                f,
                "`air.reference` is \"part\", and no board reads a second transducer: give \"host\" and send the air with the \
                 command `air`, or \"none\""
            ),
            Self::MissingSection { section } => {
                write!(f, "`[{section}]` is missing: tables cannot be made without it")
            }
            Self::Model(error) => error.fmt(f),
            Self::Curve(error) => error.fmt(f),
            Self::OutOfRange {
                state,
                pressure,
                range: [low, high],
                absolute,
            } => {
                match state {
                    DesignState::Rest => write!(f, "the rest pressure")?,
                    DesignState::Pressed { indentation } => {
                        write!(f, "the pressure at press.max_indentation_mm = {indentation}")?;
                    }
                }
                let (by, side) = if pressure > high {
                    (pressure - high, "above")
                } else {
                    (low - pressure, "below")
                };
                write!(f, " is {pressure:.3} kPa, {by:.3} kPa {side} ")?;
                match absolute {
                    None => write!(f, "transducer.range_kpa = [{low}, {high}]: ")?,
                    Some([start, end]) => write!(
                        f,
                        "the [{low}, {high}] kPa that transducer.range_kpa = [{start}, {end}] absolute leaves in any air: "
                    )?,
                }
                match state {
                    DesignState::Rest => write!(f, "choose another transducer or rest state"),
                    DesignState::Pressed { .. } => {
                        write!(f, "choose another transducer, or press less deep")
                    }
                }
            }
            Self::Unfelt {
                rise,
                least,
                key: (key, value),
            } => write!(
                f,
                "the whole press raises the pressure by {rise:.3} Pa, and up to {least:.3} Pa is noise \
                 ({BELOW_ZERO_DEVIATIONS} times transducer.{key} = {value}): choose a finer transducer, or a design \
                 whose pressure rises more"
            ),
            Self::CoarseMembrane { error, allowed } => write!(
                f,
                "{error}, over accuracy.model_percent = {allowed}: choose model.kind = \"auto\" (model.axes = \"mid\" keeps the \
                 semi-axes of a membrane), or allow more"
            ),
            Self::CoarseMesh { error, allowed } => write!(
                f,
                "{error}, over accuracy.model_percent = {allowed}: give more elements with model.through and model.along, or \
                 allow more"
            ),
            Self::BeyondData { asked, deepest } => write!(
                f,
                "press.max_indentation_mm = {asked} is beyond the data in [calibration], which end at {deepest} mm: \
                 ask for less, or measure deeper"
            ),
            Self::Objects(error) => error.fmt(f),
            Self::NoTables(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for GenerateError {}
