//! The generator: a press curve and the accuracy wanted of it -> integer tables and their certificate.
//!
//! [`from_design_file`] goes the whole way: design file -> full model -> tables, every input checked. Tables
//! that do not meet the design's accuracy are never returned.

mod certify;
mod design;
mod emit;
mod fit;
mod owned;
mod search;
mod segmentation;
mod truth;

use crate::curve::Curve;
use crate::design_file::Accuracy;
use std::ops::RangeInclusive;
use truth::Truth;

pub use certify::{Certificate, Errors, Spread};
pub use design::{GenerateError, Generated, State, from_design, from_design_file};
pub use owned::OwnedTables;

/// Version of the tables' layout and of the generator; counts up when either changes the integers.
pub const TABLE_VERSION: u32 = 1;

/// An input count is not finer than this part of what the transducer tells apart: averaging a thousand of its
/// samples gains a factor of 32, and the count stays four times finer than that.
const COUNTS_PER_RESOLUTION: f64 = 128.0;
/// Half an input count moves an output by at most this part of its tolerance.
const UNIT_SHARE: f64 = 0.125;
/// Fraction bits of a pascal at most.
const MOST_FRACTION_BITS: u32 = 16;

/// Tables and what holds of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Certified {
    /// The tables.
    pub tables: OwnedTables,
    /// What holds of them on every input.
    pub certificate: Certificate,
    /// Fits made before these tables were found to be the smallest.
    pub tried: usize,
}

/// Why a curve has no tables.
#[derive(Clone, Debug, PartialEq)]
pub enum NoTables {
    /// Even the largest tables tried miss the accuracy.
    Inaccurate {
        /// Their error as a multiple of what is allowed.
        share_of_allowed: f64,
    },
    /// The pressure rise does not fit 31 bits in the unit that the accuracy asks for.
    TooWide {
        /// Counts that would be needed.
        counts: f64,
    },
    /// An output does not fit 32 bits of micronewtons or nanometres with room to compute.
    TooLarge {
        /// The larger output at the end of the press, in its unit.
        output: f64,
    },
}

/// The smallest tables that meet an accuracy, for a press up to the curve's end and a transducer that tells
/// `resolution` pascals apart.
///
/// # Errors
/// [`NoTables`], with the numbers.
///
/// # Panics
/// Never: there is always a unit to try.
pub fn tables(curve: &Curve, accuracy: &Accuracy, resolution: f64) -> Result<Certified, NoTables> {
    let end = curve.end();
    let output = (end.force * 1e6).max(end.indentation * 1e9);
    if output >= f64::from(1 << 28) {
        return Err(NoTables::TooLarge { output });
    }
    let units = fraction_bits(curve, accuracy, resolution);
    let mut failure = None;
    for fraction_bits in units {
        let counts = libm::floor(libm::ldexp(end.pressure_rise, fraction_bits as i32));
        if counts >= f64::from(1 << 30) {
            return Err(failure.unwrap_or(NoTables::TooWide { counts }));
        }
        let truth = Truth::new(curve, fraction_bits, counts as i32);
        match search::smallest(&truth, fraction_bits, accuracy) {
            Ok(found) => {
                return Ok(Certified {
                    tables: found.tables,
                    certificate: found.certificate,
                    tried: found.tried,
                });
            }
            Err(share_of_allowed) => failure = Some(NoTables::Inaccurate { share_of_allowed }),
        }
    }
    Err(failure.expect("there is at least one unit"))
}

/// Values of `k` to try for the input's unit, `2^-k` pascal, the coarsest first: from what the transducer has a
/// use for up to what the tolerance asks where the outputs are steepest. Segments have to hold several counts, so
/// the finer ones are there for tables that would otherwise miss the accuracy in the first counts.
fn fraction_bits(curve: &Curve, accuracy: &Accuracy, resolution: f64) -> RangeInclusive<u32> {
    let end = curve.end();
    let from = accuracy.from_percent_of_full_scale / 100.0;
    let tolerance = |percent: f64, value: f64, full: f64| percent / 100.0 * value.max(from * full);
    let mut wanted = f64::INFINITY;
    let mut before = crate::curve::Contact::default();
    for &point in curve.points() {
        // Secants of the solved states stand for the slope; both outputs grow strictly.
        let rise = point.pressure_rise - before.pressure_rise;
        let force = tolerance(accuracy.force_percent_of_reading, point.force, end.force);
        let indentation = tolerance(
            accuracy.indentation_percent_of_reading,
            point.indentation,
            end.indentation,
        );
        for (step, allowed) in [
            (point.force - before.force, force),
            (point.indentation - before.indentation, indentation),
        ] {
            wanted = wanted.min(2.0 * UNIT_SHARE * allowed * rise / step);
        }
        before = point;
    }
    let bits = |unit: f64| {
        (0..MOST_FRACTION_BITS)
            .find(|&bits| libm::ldexp(1.0, -(bits as i32)) <= unit)
            .unwrap_or(MOST_FRACTION_BITS)
    };
    bits(wanted.max(resolution / COUNTS_PER_RESOLUTION))..=bits(wanted)
}

impl std::fmt::Display for NoTables {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Inaccurate { share_of_allowed } => write!(
                f,
                "the largest tables tried have {share_of_allowed:.3} times the error that [accuracy] allows: \
                 allow more, or cover less with press.max_indentation_mm"
            ),
            Self::TooWide { counts } => write!(
                f,
                "the pressure rise needs {counts:.0} counts of input, over the {} there are: allow more in \
                 [accuracy], or cover less with press.max_indentation_mm",
                1 << 30
            ),
            Self::TooLarge { output } => write!(
                f,
                "an output reaches {output:.0} micronewtons or nanometres, over the {} the tables can hold: \
                 cover less with press.max_indentation_mm",
                1 << 28
            ),
        }
    }
}

impl core::error::Error for NoTables {}

#[cfg(test)]
mod tests;
