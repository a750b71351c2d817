//! The certificate: every representable input is compared with the curve.
//!
//! Up to [`EVALUATED`] inputs are evaluated one by one. Beyond, [`Tally::bound`] evaluates only the inputs that exact bounds of the
//! sums do not settle; errors, steps and monotonicity are those of all inputs all the same, to the digit.

use super::bounds::{Range, Sum};
use super::owned::OwnedTables;
use super::shape::Segmentation;
use super::tally::{Errors, OutputPart, Tally};
use super::truth::{Piece, Truth};
use super::{AccuracyGoal, CurvePair, CurvePoint};
use crate::layout::{Layout, Outputs};

/// Largest number of inputs that are evaluated one by one: 2^22.
const EVALUATED: i32 = 1 << 22;

/// Proven properties of tables over every input.
#[derive(Clone, Debug, PartialEq)]
pub struct Proof {
    /// Number of inputs for which it holds: all from zero to the maximum.
    pub inputs: u64,
    /// Whether each was evaluated. If not, largest errors, steps and monotonicity come from exact bounds, and evaluation where
    /// they do not settle it; root-mean-square and mean errors from evenly spaced inputs.
    pub every_input_evaluated: bool,
    /// Errors of each output, absolute ones in its unit.
    pub outputs: [Errors; 2],
    /// Error of the comparison itself, relative, caused by the local polynomials that replace the curve.
    pub comparison_error: f64,
}

impl Proof {
    /// Whether the tables can be used: they are accurate, never fall, give zero at zero, and are flagged at both ends. The
    /// comparison itself must be a hundred times finer than the errors that it measures.
    pub fn holds(&self) -> bool {
        let [first, second] = &self.outputs;
        let allowed = first.allowed_percent.min(second.allowed_percent);
        first.holds() && second.holds() && 100.0 * self.comparison_error <= 0.01 * allowed
    }
}

/// How a proof covers every input.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum ProvenBy {
    /// Each is evaluated.
    Evaluation,
    /// Exact bounds, and evaluation where they do not settle it.
    Bounds,
}

/// Proves tables of any origin against a pair of curves, whose full scale is at `end`. `None` when an end is not held and flagged as
/// it must be, or when the first inputs looked at miss the accuracy.
pub fn prove(
    tables: &OwnedTables,
    curve: &impl CurvePair,
    end: CurvePoint,
    goal: &AccuracyGoal,
    by: ProvenBy,
) -> Option<Proof> {
    let Layout {
        fraction_bits,
        maximum,
        ..
    } = tables.layout;
    let truth = Truth::new(curve, end, fraction_bits, maximum);
    certify_by(tables, curve, &truth, goal, by == ProvenBy::Evaluation)
}

/// Certifies tables over every input. `None` when an end is not held and flagged as it must be.
pub(super) fn certify(
    tables: &OwnedTables,
    curve: &impl CurvePair,
    truth: &Truth,
    goal: &AccuracyGoal,
) -> Option<Proof> {
    certify_by(tables, curve, truth, goal, truth.maximum < EVALUATED)
}

/// The same, every input evaluated or as few as the bounds need.
fn certify_by(
    tables: &OwnedTables,
    curve: &impl CurvePair,
    truth: &Truth,
    goal: &AccuracyGoal,
    every: bool,
) -> Option<Proof> {
    if !ends_are_held(tables) {
        return None;
    }
    let segments = Segmentation::of(tables.layout)?;
    let from = truth
        .full_scale
        .map(|full| full * goal.from_percent_of_full_scale / 100.0);
    let mut tallies = [0, 1].map(|output| Tally::new(truth.full_scale[output], from[output]));
    let parts: Vec<Part> = parts(tables, &segments, truth).collect();
    if !every {
        for part in &parts {
            for (output, tally) in tallies.iter_mut().enumerate() {
                tally.sound(&part.of(output));
            }
        }
    }
    // Most of the tables that miss the accuracy show it here.
    if tallies
        .iter()
        .zip(goal.percent_of_reading)
        .any(|(tally, percent)| tally.misses(percent))
    {
        return None;
    }
    let mut flagged = false;
    for part in &parts {
        flagged |= part.is_flagged();
        match part.piece {
            Piece::Polynomial(_) if !(every || part.range.is_short()) => {
                for (output, tally) in tallies.iter_mut().enumerate() {
                    tally.bound(&part.of(output));
                }
            }
            _ => {
                for count in part.range.first..=part.range.last {
                    let read = part.outputs(count).values;
                    let truth = part.piece.at(count);
                    tallies[0].add(read[0], truth[0]);
                    tallies[1].add(read[1], truth[1]);
                }
            }
        }
    }
    let [first, second] = tallies;
    let [of_first, of_second] = goal.percent_of_reading;
    (!flagged).then(|| Proof {
        inputs: truth.maximum as u64 + 1,
        every_input_evaluated: every,
        outputs: [first.finish(of_first), second.finish(of_second)],
        comparison_error: truth.deviation(curve),
    })
}

/// The errors of the first output of tables alone, over every input. `None` where they are soon seen to exceed what is allowed.
pub(super) fn first_errors(tables: &OwnedTables, truth: &Truth, goal: &AccuracyGoal) -> Option<Errors> {
    let segments = Segmentation::of(tables.layout)?;
    let allowed = goal.percent_of_reading[0];
    let full = truth.full_scale[0];
    let mut tally = Tally::new(full, full * goal.from_percent_of_full_scale / 100.0);
    let parts: Vec<Part> = parts(tables, &segments, truth).collect();
    let every = truth.maximum < EVALUATED;
    if !every {
        for part in &parts {
            tally.sound(&part.of(0));
        }
    }
    if tally.misses(allowed) {
        return None;
    }
    for part in &parts {
        match part.piece {
            Piece::Polynomial(_) if !(every || part.range.is_short()) => tally.bound(&part.of(0)),
            _ => {
                for count in part.range.first..=part.range.last {
                    tally.add(part.outputs(count).values[0], part.piece.at(count)[0]);
                }
            }
        }
    }
    Some(tally.finish(allowed))
}

/// Inputs of one segment over which the curve is one piece.
struct Part<'a> {
    range: Range,
    piece: Piece<'a>,
    tables: &'a OwnedTables,
    words: &'a [i32],
    index: usize,
    number: u32,
}

/// The parts of the inputs, upwards.
fn parts<'a>(
    tables: &'a OwnedTables,
    segments: &'a Segmentation,
    truth: &'a Truth,
) -> impl Iterator<Item = Part<'a>> {
    let first_index = segments.layout.first_index;
    truth.pieces().flat_map(move |(range, piece)| {
        segments.spans.iter().filter_map(move |span| {
            let range = Range {
                first: range.first.max(span.start),
                last: range.last.min(span.end - 1),
            };
            let index = (span.number - first_index) as usize;
            (range.first <= range.last).then(|| Part {
                range,
                piece,
                tables,
                words: tables.segment(index),
                index,
                number: span.number,
            })
        })
    })
}

impl<'a> Part<'a> {
    /// The outputs of the chip at a count.
    fn outputs(&self, count: i32) -> Outputs {
        let layout = &self.tables.layout;
        layout.outputs(count, layout.place(count), self.words)
    }

    /// Whether an input within the tables says that it is not; both ends of a range do, if any does.
    fn is_flagged(&self) -> bool {
        [self.range.first, self.range.last]
            .map(|count| self.tables.lookup(count))
            .iter()
            .any(|outputs| outputs.saturated || outputs.negative)
    }

    fn of(&self, output: usize) -> OutputPart<'a> {
        OutputPart {
            range: self.range,
            sum: Sum::of(self.tables, self.index, self.number, output),
            piece: self.piece,
            output,
        }
    }
}

/// Inputs beyond an end give the outputs of that end, with its flag.
fn ends_are_held(tables: &OwnedTables) -> bool {
    let maximum = tables.layout.maximum;
    let (zero, last) = (tables.lookup(0), tables.lookup(maximum));
    let above = [maximum + 1, maximum.saturating_mul(2), i32::MAX - 1, i32::MAX];
    let below = [-1, -maximum, i32::MIN / 2, -i32::MAX];
    above.iter().all(|&count| {
        tables.lookup(count)
            == Outputs {
                saturated: true,
                ..last
            }
    }) && below.iter().all(|&count| {
        tables.lookup(count)
            == Outputs {
                negative: true,
                ..zero
            }
    })
}
