//! Tables of further curves in the layout of others: they share its pre-lookup.

use super::candidate::{Candidate, Work, with_first};
use super::certify::first_errors;
use super::owned::OwnedTables;
use super::quantise::Coefficients;
use super::shape::Segmentation;
use super::tally::Errors;
use super::truth::Truth;
use super::{AccuracyGoal, CurvePair, CurvePoint};

/// The outputs of tables at the end of their lowest segment. `None` if the layout has no segments with enough inputs.
pub fn lowest_segment_end(tables: &OwnedTables) -> Option<[i32; 2]> {
    let segments = Segmentation::of(tables.layout)?;
    let (lowest, _) = segments.spans.split_first()?;
    Some(tables.lookup(lowest.end - 1).values)
}

/// Tables of a pair of curves in the layout of others, whose lowest segment they take over as it is; beyond it from the outputs
/// `before` on, of which they never fall short. Full scale is at `end`. They are not proven: [`super::prove`]. `None` where there
/// are none that meet the accuracy.
pub fn beside(
    others: &OwnedTables,
    curve: &impl CurvePair,
    end: CurvePoint,
    before: [i32; 2],
    goal: &AccuracyGoal,
) -> Option<OwnedTables> {
    let truth = Truth::new(curve, end, others.layout.fraction_bits, others.layout.maximum);
    candidate(&truth, others, &Work::default())?.beside(others, before, goal)
}

/// Sums of one output in the layout of others, with their proven errors.
#[derive(Clone, Debug, PartialEq)]
pub struct SingleOutput {
    /// Bits of a sum below one unit of the output, beside those of the octave.
    pub shift: u32,
    /// The constant and the coefficients of each segment, the segment of the smallest inputs first.
    pub sums: Vec<Coefficients>,
    /// Errors on every input, absolute ones in the output's unit.
    pub errors: Errors,
    /// Error of the comparison itself, relative.
    pub comparison_error: f64,
}

/// Sums of the first of two curves in the layout of others; `None` where there are none that meet the accuracy of the first.
pub fn single_beside(
    others: &OwnedTables,
    curve: &impl CurvePair,
    end: CurvePoint,
    goal: &AccuracyGoal,
) -> Option<SingleOutput> {
    let truth = Truth::new(curve, end, others.layout.fraction_bits, others.layout.maximum);
    let (shift, sums) = candidate(&truth, others, &Work::default())?.first_alone(goal)?;
    let errors = first_errors(&with_first(others, shift, &sums), &truth, goal).filter(Errors::holds)?;
    let comparison_error = truth.deviation(curve);
    (comparison_error <= 1e-4 * errors.allowed_percent).then_some(SingleOutput {
        shift,
        sums,
        errors,
        comparison_error,
    })
}

fn candidate<'a>(truth: &'a Truth, others: &OwnedTables, work: &'a Work) -> Option<Candidate<'a>> {
    Some(Candidate {
        truth,
        segmentation: Segmentation::of(others.layout)?,
        error: 0.0,
        work,
    })
}
