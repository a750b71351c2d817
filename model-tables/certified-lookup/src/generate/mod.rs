//! The generator: a pair of curves and the accuracy wanted of them -> integer tables and the proof that they meet it.
//!
//! [`tables`] looks for the smallest tables that meet the accuracy and proves them over every input. Tables that do not meet it are
//! never returned.

mod bounds;
mod candidate;
mod certify;
mod further;
pub mod minimax;
mod owned;
mod quantise;
mod search;
mod shape;
mod tally;
mod truth;

use crate::layout::MAX_FRACTION_BITS;
use candidate::Work;
use truth::Truth;

pub use certify::{Proof, ProvenBy, prove};
pub use further::{SingleOutput, beside, lowest_segment_end, single_beside};
pub use owned::OwnedTables;
pub use quantise::Coefficients;
pub use tally::{Errors, Spread};

/// Bytes above which a finer unit is tried too.
const MANY: usize = 192;
/// An input count is not finer than this part of what the sensor tells apart: averaging a thousand of its
/// samples gains a factor of 32, and the count stays four times finer than that.
const COUNTS_PER_RESOLUTION: f64 = 128.0;
/// Inputs up to the end at least, however coarse the sensor: with fewer, the lowest segments hold too few, and the tables grow.
const MIN_INPUTS: f64 = 131_072.0;
/// Half an input count moves an output by at most this part of its tolerance.
const UNIT_SHARE: f64 = 0.125;
/// Sums of the last input stay below this, so that those of the segments below, which may be half as large again, fit a word.
const ROOM: f64 = 1.4e9;
/// The last input as a multiple of the end, at most.
const MAX_BEYOND: f64 = 1.0 + 1.0 / 64.0;

/// A place of a pair of curves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CurvePoint {
    /// The input, in its unit, >= 0.
    pub input: f64,
    /// Both outputs, each in the unit of its integer, >= 0.
    pub outputs: [f64; 2],
}

/// Two outputs that grow strictly with one input, both zero where it is zero.
pub trait CurvePair {
    /// Both outputs, each in the unit of its integer, at an input of at least 0.
    fn at(&self, input: f64) -> [f64; 2];

    /// Points in increasing order, from above zero to the last input that the curves answer, so close that their secants show where
    /// the outputs are steep.
    fn points(&self) -> Vec<CurvePoint>;
}

/// What tables must meet on every input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AccuracyGoal {
    /// Largest error of each output, percent of reading, > 0.
    pub percent_of_reading: [f64; 2],
    /// Where that begins, percent of the output at the end, > 0; below it the same error in absolute terms.
    pub from_percent_of_full_scale: f64,
}

/// Tables and their proof.
#[derive(Clone, Debug, PartialEq)]
pub struct ProvenTables {
    /// The tables.
    pub tables: OwnedTables,
    /// Their proven properties over every input.
    pub proof: Proof,
    /// Segmentations looked at before these tables were found to be the smallest.
    pub tried: usize,
    /// Half of the sensor's resolution, in percent of reading of each output, where it is smallest. The accuracy of tables is no
    /// finer than the smaller of the two, whatever is asked.
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
    /// The input does not fit 31 bits in the unit that the accuracy asks for.
    TooWide {
        /// Counts that would be needed.
        counts: f64,
    },
    /// An output does not fit 32 bits of its unit with room to compute.
    TooLarge {
        /// The larger output at the end, in its unit.
        output: f64,
    },
}

/// Percent of reading that half a step of the sensor is worth at its best point: finer tables are waste.
fn resolvable_percent(
    curve: &impl CurvePair,
    end: CurvePoint,
    goal: &AccuracyGoal,
    resolution: f64,
) -> [f64; 2] {
    let from = goal.from_percent_of_full_scale / 100.0;
    let mut best = [f64::INFINITY; 2];
    for pair in curve.points().windows(2) {
        let run = pair[1].input - pair[0].input;
        let (low, high) = (pair[0].outputs, pair[1].outputs);
        for output in 0..2 {
            if high[output] >= from * end.outputs[output] {
                let slope = (high[output] - low[output]) / run;
                let share = slope * 0.5 * resolution / high[output];
                best[output] = best[output].min(100.0 * share);
            }
        }
    }
    best
}

/// The smallest tables that meet an accuracy, proven, for inputs up to `end` and a sensor that tells inputs `resolution` apart. The
/// curves may go on beyond the end: the last input is then the next round number.
///
/// # Errors
/// [`NoTables`], with the numbers.
pub fn tables(
    curve: &impl CurvePair,
    end: CurvePoint,
    goal: &AccuracyGoal,
    resolution: f64,
) -> Result<ProvenTables, NoTables> {
    Ok(tables_that(curve, end, goal, resolution, |_, _| Some(()))?.0)
}

/// The same, with a condition of one's own: of tables that meet the accuracy the first for which `accept` has an answer. For
/// instance that further curves have tables of the same layout ([`beside`]). It is given the accuracy that the tables are held to:
/// that of [`attainable`].
///
/// # Errors
/// [`NoTables`], with the numbers.
pub fn tables_that<T>(
    curve: &impl CurvePair,
    end: CurvePoint,
    goal: &AccuracyGoal,
    resolution: f64,
    mut accept: impl FnMut(&OwnedTables, &AccuracyGoal) -> Option<T>,
) -> Result<(ProvenTables, T), NoTables> {
    let resolvable = resolvable_percent(curve, end, goal, resolution);
    let goal = &held_to(goal, resolvable);
    let found = search(curve, end, goal, resolution, |tables, truth| {
        let accepted = accept(tables, goal)?;
        let proof = certify::certify(tables, curve, truth, goal).filter(Proof::holds)?;
        Some((proof, accepted))
    })?;
    let (proof, accepted) = found.accepted;
    let proven = ProvenTables {
        tables: found.tables,
        proof,
        tried: found.tried,
        resolvable_percent: resolvable,
    };
    Ok((proven, accepted))
}

/// The accuracy that [`tables`] holds tables to: no finer than what can be resolved of the output that the sensor tells more of.
/// The other's tables share its segments.
pub fn attainable(
    curve: &impl CurvePair,
    end: CurvePoint,
    goal: &AccuracyGoal,
    resolution: f64,
) -> AccuracyGoal {
    held_to(goal, resolvable_percent(curve, end, goal, resolution))
}

/// The same tables without the proof, which takes most of the time: their errors are known at some dozens of inputs a segment
/// only. For drafts; [`tables`] may find that the next larger ones are needed.
///
/// # Errors
/// [`NoTables`], with the numbers.
pub fn fit(
    curve: &impl CurvePair,
    end: CurvePoint,
    goal: &AccuracyGoal,
    resolution: f64,
) -> Result<OwnedTables, NoTables> {
    let goal = &attainable(curve, end, goal, resolution);
    Ok(search(curve, end, goal, resolution, |_, _| Some(()))?.tables)
}

fn held_to(goal: &AccuracyGoal, resolvable: [f64; 2]) -> AccuracyGoal {
    let floor = resolvable[0].min(resolvable[1]);
    AccuracyGoal {
        percent_of_reading: goal.percent_of_reading.map(|percent| percent.max(floor)),
        ..*goal
    }
}

fn search<T>(
    curve: &impl CurvePair,
    end: CurvePoint,
    goal: &AccuracyGoal,
    resolution: f64,
    mut accept: impl FnMut(&OwnedTables, &Truth) -> Option<T>,
) -> Result<search::Found<T>, NoTables> {
    let output = end.outputs[0].max(end.outputs[1]);
    if output >= f64::from(1 << 28) {
        return Err(NoTables::TooLarge { output });
    }
    let [coarsest, finest] = fraction_bits(curve, end, goal, resolution);
    let last = curve.points().last().map_or(end.input, |last| last.input);
    let mut failure = None;
    let mut smallest: Option<search::Found<T>> = None;
    let work = Work::default();
    // Two units at a time: segments of two octaves can lie two ways. Where the first that are exact enough leave the segments of first
    // contact so few inputs that many are needed, the next may do with fewer.
    for first in (coarsest..=finest).step_by(2) {
        let mut truths = Vec::new();
        for fraction_bits in [first, first + 1] {
            let counts = libm::floor(libm::ldexp(end.input, fraction_bits as i32));
            if counts < f64::from(1 << 30) {
                for maximum in last_inputs(last, counts as i32, fraction_bits) {
                    truths.push(Truth::new(curve, end, fraction_bits, maximum));
                }
            } else {
                failure = failure.or(Some(NoTables::TooWide { counts }));
            }
        }
        match search::smallest(&truths, goal, &work, &mut accept) {
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
/// with in one instruction, if they are hardly beyond the end and the curve goes so far; else at that end.
fn last_inputs(last: f64, counts: i32, fraction_bits: u32) -> impl Iterator<Item = i32> {
    let reach = libm::ldexp(last, fraction_bits as i32);
    let reach = reach.min(f64::from(counts) * MAX_BEYOND);
    let within = move |count: i64| (count as f64 <= reach).then_some(count as i32);
    let round = within(shape::immediate(counts)).unwrap_or(counts);
    within(shape::power_of_two(counts)).into_iter().chain([round])
}

/// Values of `k` to try for the input's unit, `2^-k`, the coarsest first: from what the sensor has a use for
/// (and gives the sums room in their word) up to what the tolerance asks where the outputs are steepest.
/// Segments have to hold several counts, so the finer ones are there for tables that would otherwise miss the accuracy in
/// the first counts.
fn fraction_bits(curve: &impl CurvePair, end: CurvePoint, goal: &AccuracyGoal, resolution: f64) -> [u32; 2] {
    let from = goal.from_percent_of_full_scale / 100.0;
    let mut wanted = f64::INFINITY;
    let mut before = CurvePoint::default();
    for point in curve.points() {
        // Secants stand for the slope; both outputs grow strictly.
        let run = point.input - before.input;
        for output in 0..2 {
            let step = point.outputs[output] - before.outputs[output];
            let allowed = goal.percent_of_reading[output] / 100.0
                * point.outputs[output].max(from * end.outputs[output]);
            wanted = wanted.min(2.0 * UNIT_SHARE * allowed * run / step);
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
            let counts = libm::ldexp(end.input, bits as i32);
            let free = (counts as u32).leading_zeros() / 2;
            libm::ldexp(end.outputs[0].max(end.outputs[1]), free as i32) < ROOM
        })
        .unwrap_or(MAX_FRACTION_BITS);
    let use_for = (resolution / COUNTS_PER_RESOLUTION).min(end.input / MIN_INPUTS);
    let coarsest = bits(wanted.max(use_for)).max(roomy);
    // Two more at least, for designs whose highest segment is short: the one below then needs the room.
    [coarsest, bits(wanted).max(coarsest + 3)]
}

impl core::fmt::Display for NoTables {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Inaccurate { share_of_allowed } if *share_of_allowed < 1.0 => write!(
                f,
                "no tables of integers keep within the accuracy, though real coefficients would ({share_of_allowed:.3} times the \
                 error that it allows): allow a little more, take smaller units of the outputs, or end sooner"
            ),
            Self::Inaccurate { share_of_allowed } => write!(
                f,
                "the largest tables tried have {share_of_allowed:.3} times the error that the accuracy allows: allow more, or end \
                 sooner"
            ),
            Self::TooWide { counts } => write!(
                f,
                "the input needs {counts:.0} counts, over the {} there are: allow more error, or end sooner",
                1 << 30
            ),
            Self::TooLarge { output } => write!(
                f,
                "an output reaches {output:.0} of its units, over the {} that the tables can hold: end sooner, or take a larger unit",
                1 << 28
            ),
        }
    }
}

impl core::error::Error for NoTables {}

#[cfg(test)]
mod tests;
