//! Tables of the feedback actuator's force, in the same layout as the tables of force and indentation.

use super::{Errors, OwnedTables, curve_point};
use crate::curve::Curve;
use crate::table::feedback::{FeedbackScale, MAX_WORDS, force_at, words_per_segment};
use crate::table::{Constant, Layout};
use crate::units::{Micronewtons, PressureRise};
use certified_lookup::generate::{AccuracyGoal, Coefficients, single_beside};

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
    /// Layout of the sums.
    pub scale: FeedbackScale,
    /// The words, [`words_per_segment`] a segment, the segment of the largest inputs first.
    pub words: Vec<i32>,
    /// Errors of the force gained since rest on every input, micronewtons.
    pub errors: Errors,
    /// Error of the comparison itself, relative, caused by the local polynomials that replace the curve.
    pub comparison_error: f64,
}

impl CertifiedFeedback {
    /// Bytes of the words.
    pub fn bytes(&self) -> usize {
        size_of_val(self.words.as_slice())
    }

    /// The words of one segment.
    pub fn segment(&self, index: usize) -> &[i32] {
        let width = words_per_segment(&self.layout);
        &self.words[index * width..(index + 1) * width]
    }

    /// The force at a pressure rise, bit for bit as on the chip.
    pub fn lookup(&self, rise: PressureRise) -> Micronewtons {
        let place = self.layout.place(rise.0);
        let index = place.number.wrapping_sub(self.layout.first_index) as usize;
        let last = self.words.len() / words_per_segment(&self.layout) - 1;
        force_at(&self.layout, self.scale, self.segment(index.min(last)), place)
    }
}

impl FeedbackCurve {
    /// Tables in the layout of others. `None` if no such tables meet the accuracy of the force.
    pub(super) fn tables(
        &self,
        beside: &OwnedTables,
        end_rise: f64,
        goal: &AccuracyGoal,
    ) -> Option<CertifiedFeedback> {
        if beside.words.len() > MAX_WORDS {
            return None;
        }
        let end = curve_point(self.gained.at_pressure_rise(end_rise));
        let gained = single_beside(beside, &self.gained, end, goal)?;
        let layout = beside.layout;
        Some(CertifiedFeedback {
            layout,
            scale: FeedbackScale {
                shift: gained.shift,
                at_rest: libm::round(self.at_rest * 1e6) as i32,
            },
            words: gained
                .sums
                .iter()
                .rev()
                .flat_map(|sum| words(&layout, sum))
                .collect(),
            errors: gained.errors,
            comparison_error: gained.comparison_error,
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
