//! Which model a design needs.
//!
//! `kind = "auto"` solves every fidelity of a ladder up to the solid of 2 x 60 elements, at eight indentations up to the deepest.
//! **The rule:** the cheapest fidelity is chosen whose force and pressure rise differ from those of that solid by at most the
//! allowed error, less the solid's own error ([`Wanted::own_error`]). The allowed error is 1 % of the reading, or
//! [`model_percent`](crate::design_file::Accuracy::model_percent) if a design states less. If the own error is most of the allowed
//! one, or no fidelity is close enough, all of them are compared with a refined solid. Coarse solids are never the reference,
//! because their errors are of one kind: two of them agreed with each other where both were wrong. They are not chosen either.
//! Their contact edge moves from element to element, so the indentation of a light touch is 2 % off between the compared
//! indentations, and the ripple costs tables 12 to 112 bytes more. `designer ladder` checks the rule against the refined solid over
//! random walls.

use super::{Fingertip, Kind, ModelError};
use crate::curve::Contact;
use crate::design::Design;
use crate::design_file::{DEFAULT_ELEMENTS, DesignFile, ModelSection};
use crate::object::Shape;
use crate::solid;
use crate::solid::SolidError;
use crate::solid::mesh::Elements;

/// The ladder that `auto` climbs, past its coarse solids; `designer ladder` measures them all.
pub const LADDER: [Kind; 5] = [
    Kind::Membrane,
    Kind::Solid(solid::press::COARSE),
    Kind::Solid(solid::press::FULL),
    Kind::Solid(FINE),
    Kind::Solid(REFINED),
];
/// Enough elements for a few tenths of a percent.
pub const FINE: Elements = Elements {
    through: DEFAULT_ELEMENTS[0] as usize,
    along: DEFAULT_ELEMENTS[1] as usize,
};

/// The elements of a wall in time: a design's own, or with `auto` [`FINE`]; `None` of a membrane, which has no press in time.
pub const fn elements_in_time(model: ModelSection) -> Option<Elements> {
    match model {
        ModelSection::Membrane => None,
        ModelSection::Auto => Some(FINE),
        ModelSection::Solid { through, along } => Some(Elements {
            through: through as usize,
            along: along as usize,
        }),
    }
}

/// The reference for the other fidelities.
pub const REFINED: Elements = Elements {
    through: 3,
    along: 96,
};
/// Indentations at which fidelities are compared, over the deepest.
pub const PARTS: [f64; 8] = [0.05, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 1.0];
/// Error of [`FINE`], largest of the walls of `designer ladder` that are no [`THIN`] ones.
const FINE_ERROR: f64 = 0.006;
/// The same of walls that are [`THIN`], and of presses that are [`DEEP`].
const HARD_ERROR: f64 = 0.01;
/// The largest part of what is allowed that a judge's own error may take.
const MAX_SHARE: f64 = 0.75;
/// Wall over outer radius under which 60 elements are long for what bends, `sqrt(radius * wall)`.
const THIN: f64 = 0.02;
/// Indentation over the height beyond which the bonded rim takes part.
const DEEP: f64 = 0.36;
/// What is allowed of a model's force and pressure rise where a design does not state less, percent of the reading.
const MAX_PERCENT: f64 = 1.0;
/// Where the percentage begins where a design does not say, percent of the deepest.
const DEFAULT_FROM: f64 = 1.0;
/// The deepest indentation where a design does not say, over the height: well before the end of any press.
const DEFAULT_DEPTH: f64 = 0.35;
/// The part of a press that ends before the default depth to which fidelities are compared.
const NEAR_END: f64 = 0.98;
/// Square of the smallest part of a depth that a cup is looked at to.
const TIGHTEST_CUP: f64 = 0.01;

/// How near a design's model has to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wanted {
    /// Error of force and pressure rise, relative to the reading.
    pub error: f64,
    /// The part of the deepest reading below which the same error counts in absolute terms.
    pub from: f64,
    /// Deepest indentation, metres.
    pub deepest: f64,
    /// Whether the design states the deepest. Otherwise a press that ends before it is compared down to its end.
    pub is_stated: bool,
}

impl Wanted {
    /// The values of a design file, and defaults for the others. The accuracy of the tables is independent of this: they round a
    /// curve of any model.
    pub fn of(file: &DesignFile) -> Self {
        let percent = file
            .accuracy
            .map_or(MAX_PERCENT, |a| a.model_percent.min(MAX_PERCENT));
        let from = file
            .accuracy
            .map_or(DEFAULT_FROM, |a| a.from_percent_of_full_scale);
        let design = file.design();
        let height = 1e3 * design.membrane.axial_semi_axis;
        Self {
            error: percent / 100.0,
            from: from / 100.0,
            deepest: 1e-3 * file.max_indentation_mm.unwrap_or(DEFAULT_DEPTH * height) * in_a_cup(&design),
            is_stated: file.max_indentation_mm.is_some(),
        }
    }

    /// The error that a fidelity counts with as a judge; infinite if it does not judge, as where its own error would leave cheaper fidelities
    /// too little.
    pub fn own_error(&self, kind: Kind, design: &Design) -> f64 {
        let outer = &design.membrane;
        match kind {
            Kind::Solid(REFINED) => 0.0,
            Kind::Solid(FINE) => {
                let thin = outer.thickness < THIN * outer.radial_semi_axis;
                let deep = self.deepest > DEEP * outer.axial_semi_axis;
                let own = if thin || deep { HARD_ERROR } else { FINE_ERROR };
                if own <= MAX_SHARE * self.error {
                    own
                } else {
                    f64::INFINITY
                }
            }
            _ => f64::INFINITY,
        }
    }

    /// How far contacts are from true ones, over the readings: the largest difference of force or pressure rise.
    pub fn distance(&self, found: &[Contact], truth: &[Contact]) -> f64 {
        let Some(end) = truth.last() else {
            return f64::INFINITY;
        };
        found
            .iter()
            .zip(truth)
            .flat_map(|(found, truth)| {
                [
                    (found.force, truth.force, end.force),
                    (found.pressure_rise, truth.pressure_rise, end.pressure_rise),
                ]
            })
            .map(|(found, truth, full)| (found - truth).abs() / truth.abs().max(self.from * full))
            .fold(0.0, f64::max)
    }

    /// The first of some fidelities, the judge among them, that is near enough to the judge with its own error.
    pub fn judge<'a>(
        &self,
        mut fidelities: impl Iterator<Item = &'a [Contact]>,
        truth: &[Contact],
        own_error: f64,
    ) -> Option<usize> {
        fidelities.position(|contacts| self.distance(contacts, truth) + own_error <= self.error)
    }

    /// A model's contacts at [`PARTS`] of the deepest indentation.
    ///
    /// # Errors
    /// [`ModelError`] of the model.
    pub fn contacts(&self, fingertip: &mut Fingertip) -> Result<Vec<Contact>, ModelError> {
        PARTS
            .iter()
            .map(|part| fingertip.contact_at(part * self.deepest))
            .collect()
    }
}

/// The depth at which an object has the pressure that a plate has at a depth, over that depth: 1, and less of a cup, which lies against
/// more of the wall and whose press ends earlier. Of a wall without bending: `sqrt(1 - Rd / R)`, with `Rd` the crown's radius of
/// curvature.
fn in_a_cup(design: &Design) -> f64 {
    let Shape::Cup { radius } = design.object.shape else {
        return 1.0;
    };
    let dome = &design.membrane;
    let crown = dome.radial_semi_axis * dome.radial_semi_axis / dome.axial_semi_axis;
    libm::sqrt((1.0 - crown / radius).max(TIGHTEST_CUP))
}

/// The chosen model, and the evidence for the choice.
#[derive(Clone, Debug)]
pub struct Choice {
    /// The model.
    pub kind: Kind,
    /// The fidelity that judged it, and how far it may be off, relative; `None` where none could judge.
    pub judged: Option<(Kind, f64)>,
    /// The model at rest, its contacts solved.
    pub fingertip: Fingertip,
}

/// Climbs the ladder for a design whose semi-axes are the outer surface's. Fidelities that do not apply, or find no state, are
/// passed over.
///
/// # Errors
/// [`ModelError`] of the last fidelity.
pub fn choose(design: &Design, wanted: &Wanted) -> Result<Choice, ModelError> {
    let mut wanted = *wanted;
    loop {
        let (choice, end) = climb(design, &wanted);
        let is_judged = choice.as_ref().is_ok_and(|choice| choice.judged.is_some());
        match end {
            Some(end) if !is_judged && !wanted.is_stated && end > 0.0 => wanted.deepest = NEAR_END * end,
            _ => return choice,
        }
    }
}

/// Climbs the ladder once. Beside the choice: the least indentation, metres, at which a fidelity ended before the deepest.
fn climb(design: &Design, wanted: &Wanted) -> (Result<Choice, ModelError>, Option<f64>) {
    let mut end: Option<f64> = None;
    let mut solved: Vec<(Kind, Fingertip, Vec<Contact>)> = Vec::new();
    let mut failure = ModelError::Solid(SolidError::RestNotForSolid);
    for judge in LADDER {
        if !judge.applies(design) || judge.is_coarse() {
            continue;
        }
        let own_error = wanted.own_error(judge, design);
        let found = Fingertip::of(judge, design).and_then(|mut fingertip| {
            let contacts = wanted.contacts(&mut fingertip)?;
            Ok((fingertip, contacts))
        });
        let contacts = match found {
            Ok((fingertip, contacts)) => {
                solved.push((judge, fingertip, contacts.clone()));
                contacts
            }
            Err(error) => {
                if let Some(limit) = error.beyond() {
                    end = Some(limit.indentation.min(end.unwrap_or(f64::INFINITY)));
                }
                failure = error;
                continue;
            }
        };
        let fidelities = solved.iter().map(|(_, _, contacts)| contacts.as_slice());
        if let Some(near) = wanted.judge(fidelities, &contacts, own_error) {
            let (kind, fingertip, found) = solved.swap_remove(near);
            let distance = wanted.distance(&found, &contacts);
            let choice = Choice {
                kind,
                judged: Some((judge, distance + own_error)),
                fingertip,
            };
            return (Ok(choice), end);
        }
    }
    let choice = match solved.pop() {
        Some((kind, fingertip, _)) => Ok(Choice {
            kind,
            judged: None,
            fingertip,
        }),
        None => Err(failure),
    };
    (choice, end)
}
