//! The generator: a press curve and the accuracy wanted of it -> integer tables and their certificate.
//!
//! [`from_design_file`] does every step: design file -> full model -> tables, with every input checked. Tables that do not meet the
//! design's accuracy are never returned.

mod bounds;
mod candidate;
mod certify;
mod design;
mod emit;
pub mod feedback;
pub mod minimax;
pub mod object;
mod owned;
mod quantise;
mod search;
mod shape;
mod tally;
mod truth;

use crate::curve::{Contact, Curve};
use crate::design_file::Accuracy;
use candidate::Work;
use feedback::{CertifiedFeedback, FeedbackCurve};
use object::{ObjectTables, SolvedObjects};
use truth::Truth;

pub use certify::Certificate;
pub use design::{
    AccuracyLimit, DesignState, GenerateError, Generated, InTime, Solved, from_design, from_design_file,
    from_design_or_worse, solve,
};
pub use owned::OwnedTables;
pub use tally::{Errors, Spread};

/// Version of the tables' layout and of the generator; counts up when either changes the integers.
pub const TABLE_VERSION: u32 = 6;

/// Bytes above which a finer unit is tried too.
const MANY: usize = 192;
/// An input count is not finer than this part of what the transducer tells apart: averaging a thousand of its
/// samples gains a factor of 32, and the count stays four times finer than that.
const COUNTS_PER_RESOLUTION: f64 = 128.0;
/// Inputs up to the end of the press at least, however coarse the transducer: with fewer, the segments of first contact hold too
/// few, and the tables grow.
const MIN_INPUTS: f64 = 131_072.0;
/// Half an input count moves an output by at most this part of its tolerance.
const UNIT_SHARE: f64 = 0.125;
/// Sums of the last input stay below this, so that those of the segments below, which may be half as large again, fit a word.
const ROOM: f64 = 1.4e9;
/// The last input as a multiple of the end of the press, at most.
const MAX_BEYOND: f64 = 1.0 + 1.0 / 64.0;
/// Fraction bits of a pascal at most.
const MAX_FRACTION_BITS: u32 = 16;

/// Tables and their certificate.
#[derive(Clone, Debug, PartialEq)]
pub struct Certified {
    /// The tables.
    pub tables: OwnedTables,
    /// Their proven properties over every input.
    pub certificate: Certificate,
    /// Tables of other objects; `None` where the design has no `[object]`.
    pub object: Option<ObjectTables>,
    /// Tables of the feedback actuator's force; `None` where the design has none that presses.
    pub feedback: Option<CertifiedFeedback>,
    /// Segmentations looked at before these tables were found to be the smallest.
    pub tried: usize,
    /// Half of the transducer's resolution, in percent of reading of force and indentation, where it is smallest. The accuracy
    /// limit of tables is at least the smaller of the two, whatever accuracy is required.
    pub resolvable_percent: [f64; 2],
}

/// Why a curve has no tables.
#[derive(Clone, Debug, PartialEq)]
pub enum NoTables {
    /// Even the largest tables tried miss the accuracy.
    Inaccurate {
        /// Their error as a multiple of what is allowed; where it is below 1 it is that of real coefficients, which do not
        /// round.
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

/// Percent of reading that half a step of the transducer is worth at its best point: finer tables are waste.
fn resolvable_percent(curve: &Curve, end: Contact, accuracy: &Accuracy, resolution: f64) -> [f64; 2] {
    let from = accuracy.from_percent_of_full_scale / 100.0;
    let mut best = [f64::INFINITY; 2];
    for pair in curve.points().windows(2) {
        let rise = pair[1].pressure_rise - pair[0].pressure_rise;
        let outputs = |point: &Contact| [point.force, point.indentation];
        let (low, high, full) = (outputs(&pair[0]), outputs(&pair[1]), outputs(&end));
        for output in 0..2 {
            if high[output] >= from * full[output] {
                let slope = (high[output] - low[output]) / rise;
                let share = slope * 0.5 * resolution / high[output];
                best[output] = best[output].min(100.0 * share);
            }
        }
    }
    best
}

/// The smallest tables that meet an accuracy, certified, for a press that ends at `end` and a transducer with a resolution of
/// `resolution` pascals. The curve may go on beyond the end: the last input is then the next round number.
///
/// # Errors
/// [`NoTables`], with the numbers.
pub fn tables(
    curve: &Curve,
    end: Contact,
    accuracy: &Accuracy,
    resolution: f64,
) -> Result<Certified, NoTables> {
    tables_with(curve, end, accuracy, resolution, &Beside::default())
}

/// Further curves that get tables of the same layout.
#[derive(Clone, Debug, Default)]
pub struct Beside {
    /// Other objects than the plate; `None`: the plate alone.
    pub objects: Option<SolvedObjects>,
    /// The feedback actuator; `None`: there is none that presses.
    pub feedback: Option<FeedbackCurve>,
}

/// The same, with tables of further curves in the same layout.
///
/// # Errors
/// [`NoTables`], with the numbers.
pub fn tables_with(
    curve: &Curve,
    end: Contact,
    accuracy: &Accuracy,
    resolution: f64,
    beside: &Beside,
) -> Result<Certified, NoTables> {
    let resolvable = resolvable_percent(curve, end, accuracy, resolution);
    let accuracy = &held_to(accuracy, resolvable);
    let found = search(curve, end, accuracy, resolution, |tables, truth| {
        let object = match &beside.objects {
            None => None,
            Some(objects) => Some(objects.tables(tables, end, truth, accuracy)?),
        };
        let feedback = match &beside.feedback {
            None => None,
            Some(feedback) => Some(feedback.tables(tables, truth, end.pressure_rise, accuracy)?),
        };
        let certificate = certify::certify(tables, curve, truth, accuracy).filter(Certificate::holds)?;
        Some((certificate, object, feedback))
    })?;
    let (certificate, object, feedback) = found.accepted;
    Ok(Certified {
        tables: found.tables,
        certificate,
        object,
        feedback,
        tried: found.tried,
        resolvable_percent: resolvable,
    })
}

/// The same tables without the certificate, which takes most of the time: their errors are known at some dozens of inputs a segment
/// only. For drafts; [`tables`] may find that the next larger ones are needed.
///
/// # Errors
/// [`NoTables`], with the numbers.
pub fn fit(
    curve: &Curve,
    end: Contact,
    accuracy: &Accuracy,
    resolution: f64,
) -> Result<OwnedTables, NoTables> {
    let resolvable = resolvable_percent(curve, end, accuracy, resolution);
    let accuracy = &held_to(accuracy, resolvable);
    Ok(search(curve, end, accuracy, resolution, |_, _| Some(()))?.tables)
}

/// The accuracy, no finer than what can be resolved of the output that the transducer tells more of: the other's tables share
/// its segments.
fn held_to(accuracy: &Accuracy, resolvable: [f64; 2]) -> Accuracy {
    let floor = resolvable[0].min(resolvable[1]);
    Accuracy {
        force_percent_of_reading: accuracy.force_percent_of_reading.max(floor),
        indentation_percent_of_reading: accuracy.indentation_percent_of_reading.max(floor),
        ..*accuracy
    }
}

fn search<T>(
    curve: &Curve,
    end: Contact,
    accuracy: &Accuracy,
    resolution: f64,
    mut accept: impl FnMut(&OwnedTables, &Truth) -> Option<T>,
) -> Result<search::Found<T>, NoTables> {
    let output = (end.force * 1e6).max(end.indentation * 1e9);
    if output >= f64::from(1 << 28) {
        return Err(NoTables::TooLarge { output });
    }
    let [coarsest, finest] = fraction_bits(curve, end, accuracy, resolution);
    let mut failure = None;
    let mut smallest: Option<search::Found<T>> = None;
    let work = Work::default();
    // Two units at a time: segments of two octaves can lie two ways. Where the first that are exact enough leave the segments of first
    // contact so few inputs that many are needed, the next may do with fewer.
    for first in (coarsest..=finest).step_by(2) {
        let mut truths = Vec::new();
        for fraction_bits in [first, first + 1] {
            let counts = libm::floor(libm::ldexp(end.pressure_rise, fraction_bits as i32));
            if counts < f64::from(1 << 30) {
                for maximum in last_inputs(curve, counts as i32, fraction_bits) {
                    truths.push(Truth::new(curve, end, fraction_bits, maximum));
                }
            } else {
                failure = failure.or(Some(NoTables::TooWide { counts }));
            }
        }
        match search::smallest(&truths, accuracy, &work, &mut accept) {
            Ok(found) => match smallest {
                Some(before) if before.tables.bytes() <= found.tables.bytes() => return Ok(before),
                None if found.tables.bytes() > MANY => smallest = Some(found),
                _ => return Ok(found),
            },
            Err(share_of_allowed) if share_of_allowed.is_finite() => {
                failure = Some(NoTables::Inaccurate { share_of_allowed });
            }
            Err(_) => {}
        }
    }
    smallest.ok_or(failure.unwrap_or(NoTables::Inaccurate {
        share_of_allowed: f64::INFINITY,
    }))
}

/// Where the tables may end, the cheapest for the chip first: at the next count of `2^n - 1`, and at the next that it compares
/// with in one instruction, if they are hardly beyond the end of the press and the curve goes so far; else at that end.
fn last_inputs(curve: &Curve, counts: i32, fraction_bits: u32) -> impl Iterator<Item = i32> {
    let reach = libm::ldexp(curve.end().pressure_rise, fraction_bits as i32);
    let reach = reach.min(f64::from(counts) * MAX_BEYOND);
    let within = move |count: i64| (count as f64 <= reach).then_some(count as i32);
    let round = within(shape::immediate(counts)).unwrap_or(counts);
    within(shape::power_of_two(counts)).into_iter().chain([round])
}

/// Values of `k` to try for the input's unit, `2^-k` pascal, the coarsest first: from what the transducer has a
/// use for (and gives the force's sums room in their word) up to what the tolerance asks where the outputs are steepest.
/// Segments have to hold several counts, so the finer ones are there for tables that would otherwise miss the accuracy in
/// the first counts.
fn fraction_bits(curve: &Curve, end: Contact, accuracy: &Accuracy, resolution: f64) -> [u32; 2] {
    let from = accuracy.from_percent_of_full_scale / 100.0;
    let tolerance = |percent: f64, value: f64, full: f64| percent / 100.0 * value.max(from * full);
    let mut wanted = f64::INFINITY;
    let mut before = Contact::default();
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
        (0..MAX_FRACTION_BITS)
            .find(|&bits| libm::ldexp(1.0, -(bits as i32)) <= unit)
            .unwrap_or(MAX_FRACTION_BITS)
    };
    // The sums of the highest octave: shifted left by half of the bits that its inputs leave free.
    let roomy = (0..MAX_FRACTION_BITS)
        .find(|&bits| {
            let counts = libm::ldexp(end.pressure_rise, bits as i32);
            let free = (counts as u32).leading_zeros() / 2;
            libm::ldexp((end.force * 1e6).max(end.indentation * 1e9), free as i32) < ROOM
        })
        .unwrap_or(MAX_FRACTION_BITS);
    let use_for = (resolution / COUNTS_PER_RESOLUTION).min(end.pressure_rise / MIN_INPUTS);
    let coarsest = bits(wanted.max(use_for)).max(roomy);
    // Two more at least, for designs whose highest segment is short: the one below then needs the room.
    [coarsest, bits(wanted).max(coarsest + 3)]
}

impl std::fmt::Display for NoTables {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Inaccurate { share_of_allowed } if *share_of_allowed < 1.0 => write!(
                f,
                "no tables of integers keep within [accuracy], though real coefficients would ({share_of_allowed:.3} times \
                 the error that it allows): allow a little more, or cover less with press.max_indentation_mm"
            ),
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
