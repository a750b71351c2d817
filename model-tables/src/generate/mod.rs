//! The generator: a press curve and the required accuracy -> integer tables and their certificate.
//!
//! [`from_design_file`] does every step: design file -> full model -> tables, with a check of every input. The tables are made
//! and proven by `certified_lookup`. Tables that do not meet the design's accuracy are never returned.

mod design;
mod emit;
pub mod feedback;
pub mod object;
mod terms;

use crate::curve::{Contact, Curve};
use crate::design_file::Accuracy;
use certified_lookup::generate::{AccuracyGoal, CurvePair, CurvePoint, Proof, tables_that};
use feedback::{CertifiedFeedback, FeedbackCurve};
use object::{ObjectTables, SolvedObjects};

pub use certified_lookup::generate::{Errors, NoTables, OwnedTables, Spread};
pub use design::{
    AccuracyLimit, DesignState, GenerateError, Generated, InTime, Solved, from_design, from_design_file,
    from_design_or_worse, solve,
};
pub use terms::ChipSeries;

/// Version of the tables' layout and of the generator. It increases if a change of either changes the integers.
pub const TABLE_VERSION: u32 = 6;

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

/// Proven properties of tables over every input.
#[derive(Clone, Debug, PartialEq)]
pub struct Certificate {
    /// Number of inputs for which it holds: all from zero to the maximum.
    pub inputs: u64,
    /// Whether each was evaluated. If not, largest errors, steps and monotonicity come from exact bounds, and evaluation where
    /// they do not settle it; root-mean-square and mean errors from evenly spaced inputs.
    pub every_input_evaluated: bool,
    /// Errors of the force; absolute ones in micronewtons.
    pub force: Errors,
    /// Errors of the indentation; absolute ones in nanometres.
    pub indentation: Errors,
    /// Error of the comparison itself, relative, caused by the local polynomials that replace the curve.
    pub comparison_error: f64,
}

impl From<Proof> for Certificate {
    fn from(proof: Proof) -> Self {
        let [force, indentation] = proof.outputs;
        Self {
            inputs: proof.inputs,
            every_input_evaluated: proof.every_input_evaluated,
            force,
            indentation,
            comparison_error: proof.comparison_error,
        }
    }
}

impl CurvePair for Curve {
    /// Pascals -> micronewtons and nanometres.
    fn at(&self, input: f64) -> [f64; 2] {
        outputs(self.at_pressure_rise(input))
    }

    fn points(&self) -> Vec<CurvePoint> {
        Self::points(self).iter().copied().map(curve_point).collect()
    }
}

/// Micronewtons and nanometres of a contact.
fn outputs(contact: Contact) -> [f64; 2] {
    [contact.force * 1e6, contact.indentation * 1e9]
}

/// A contact in the units of tables: pascals -> micronewtons and nanometres.
fn curve_point(contact: Contact) -> CurvePoint {
    CurvePoint {
        input: contact.pressure_rise,
        outputs: outputs(contact),
    }
}

/// Accuracy that tables of force and indentation must meet.
fn goal(accuracy: &Accuracy) -> AccuracyGoal {
    AccuracyGoal {
        percent_of_reading: [
            accuracy.force_percent_of_reading,
            accuracy.indentation_percent_of_reading,
        ],
        from_percent_of_full_scale: accuracy.from_percent_of_full_scale,
    }
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
    /// Objects other than the plate; `None` for the plate only.
    pub objects: Option<SolvedObjects>,
    /// The feedback actuator; `None` if there is none that presses.
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
    let asked = goal(accuracy);
    let (made, (object, feedback)) =
        tables_that(curve, curve_point(end), &asked, resolution, |tables, goal| {
            let object = match &beside.objects {
                None => None,
                Some(objects) => Some(objects.tables(tables, end, goal)?),
            };
            let feedback = match &beside.feedback {
                None => None,
                Some(feedback) => Some(feedback.tables(tables, end.pressure_rise, goal)?),
            };
            Some((object, feedback))
        })?;
    Ok(Certified {
        tables: made.tables,
        certificate: made.proof.into(),
        object,
        feedback,
        tried: made.tried,
        resolvable_percent: made.resolvable_percent,
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
    certified_lookup::generate::fit(curve, curve_point(end), &goal(accuracy), resolution)
}

#[cfg(test)]
mod tests;
