//! Tables of the feedback actuator's force, in the same layout as the tables of force and indentation.

use super::candidate::{Candidate, Work, with_force};
use super::certify::force_errors;
use super::owned::OwnedTables;
use super::quantise::Coefficients;
use super::shape::Segmentation;
use super::tally::Errors;
use super::truth::Truth;
use crate::curve::Curve;
use crate::design_file::Accuracy;
use crate::table::feedback::{FeedbackScale, MAX_WORDS};
use crate::table::{Constant, Layout};
use crate::units::{Micronewtons, PressureRise};

/// The force of an actuator over a press.
#[derive(Clone, Debug)]
pub struct FeedbackCurve {
    /// Its gain since rest: pressure rise as the transducer reads it, force, indentation of the fingertip.
    pub gained: Curve,
    /// Force at rest, newtons, >= 0.
    pub at_rest: f64,
}

/// Tables of that force, with their proven errors.
#[derive(Clone, Debug, PartialEq)]
pub struct CertifiedFeedback {
    /// The layout, that of the tables of force and indentation.
    pub layout: Layout,
    /// How a sum is read.
    pub scale: FeedbackScale,
    /// The words, [`Layout::feedback_words`] a segment, the segment of the largest inputs first.
    pub words: Vec<i32>,
    /// Errors of the force gained since rest on every input, micronewtons.
    pub errors: Errors,
    /// Error of the comparison itself, relative: the local polynomials that stand for the curve.
    pub comparison_error: f64,
}

impl CertifiedFeedback {
    /// Bytes of the words.
    pub fn bytes(&self) -> usize {
        size_of_val(self.words.as_slice())
    }

    /// The words of one segment.
    pub fn segment(&self, index: usize) -> &[i32] {
        let width = self.layout.feedback_words();
        &self.words[index * width..(index + 1) * width]
    }

    /// The force at a pressure rise, bit for bit as on the chip.
    pub fn lookup(&self, rise: PressureRise) -> Micronewtons {
        let place = self.layout.place(rise);
        let index = place.number.wrapping_sub(self.layout.first_index) as usize;
        let last = self.words.len() / self.layout.feedback_words() - 1;
        self.layout
            .feedback(self.scale, self.segment(index.min(last)), place)
    }
}

impl FeedbackCurve {
    /// Tables beside others, over whose inputs `truth` is, if there are some that meet the accuracy of the force.
    pub(super) fn tables(
        &self,
        beside: &OwnedTables,
        truth: &Truth,
        end_rise: f64,
        accuracy: &Accuracy,
    ) -> Option<CertifiedFeedback> {
        if beside.words.len() > MAX_WORDS {
            return None;
        }
        let end = self.gained.at_pressure_rise(end_rise);
        let own = Truth::new(&self.gained, end, truth.fraction_bits, truth.maximum);
        let work = Work::default();
        let candidate = Candidate {
            truth: &own,
            segmentation: Segmentation::of(beside.layout)?,
            error: 0.0,
            work: &work,
        };
        let (shift, sums) = candidate.force_alone(accuracy)?;
        let layout = beside.layout;
        let paired = with_force(beside, shift, &sums);
        let errors = force_errors(&paired, &own, accuracy).filter(Errors::holds)?;
        let comparison_error = own.deviation(&self.gained);
        (comparison_error <= 1e-4 * errors.allowed_percent).then(|| CertifiedFeedback {
            layout,
            scale: FeedbackScale {
                shift,
                at_rest: libm::round(self.at_rest * 1e6) as i32,
            },
            words: sums.iter().rev().flat_map(|sum| words(&layout, sum)).collect(),
            errors,
            comparison_error,
        })
    }
}

/// The words of a segment.
fn words(layout: &Layout, sum: &Coefficients) -> Vec<i32> {
    // With halves, a constant's fraction is the linear coefficient already.
    let first = match layout.constant {
        Constant::Half => 2,
        Constant::Whole => 1,
    };
    let mut words = vec![sum[0]];
    for pair in sum[first..=layout.powers.terms()].chunks(2) {
        let lower = pair.get(1).copied().unwrap_or(0);
        words.push(pair[0] << 16 | i32::from(lower as i16 as u16));
    }
    words
}
