//! Which model a design needs.
//!
//! `kind = "auto"` climbs a ladder, cheapest rung first: the membrane in the middle of the wall, then solids of more and more
//! elements. **The rule:** each rung that is solved judges those below it that have fewer elements along, the cheapest first.
//! One is taken when its force and its pressure rise differ from the judge's by no more than what
//! [`Accuracy`](crate::design_file::Accuracy) allows of the force less the judge's own error ([`LADDER`]), at eight
//! indentations up to the deepest one. If none is, the last rung answers. `designer ladder` holds the rule to a refined solid over random designs.

use super::{Kind, Rung};
use crate::curve::Contact;
use crate::design::Design;
use crate::design_file::DesignFile;
use crate::press::ModelError;
use crate::solid;
use crate::solid::mesh::Elements;

/// The ladder that `auto` climbs, each rung with the error it counts with as a judge: what nine of ten random designs stay below
/// against a refined solid.
pub const LADDER: [(Kind, f64); 5] = [
    (Kind::Membrane, f64::INFINITY),
    (Kind::Solid(solid::press::COARSE), 0.015),
    (Kind::Solid(solid::press::FULL), 0.015),
    (Kind::Solid(FINE), 0.002),
    (Kind::Solid(REFINED), 0.0),
];
/// Enough elements for a few tenths of a percent.
pub const FINE: Elements = Elements {
    through: 2,
    along: 60,
};
/// What the other rungs are measured against.
pub const REFINED: Elements = Elements {
    through: 3,
    along: 96,
};
/// Indentations at which rungs are compared, over the deepest.
pub const PARTS: [f64; 8] = [0.05, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 1.0];
/// What is allowed of the force where a design does not say, percent.
const DEFAULT_PERCENT: f64 = 1.0;
/// Where the percentage begins where a design does not say, percent of the deepest.
const DEFAULT_FROM: f64 = 1.0;
/// The deepest indentation where a design does not say, over the height: well before the end of any press.
const DEFAULT_DEPTH: f64 = 0.35;

/// How near a design's model has to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wanted {
    /// Error of force and pressure rise, relative to the reading.
    pub error: f64,
    /// The part of the deepest reading below which the same error counts in absolute terms.
    pub from: f64,
    /// Deepest indentation, metres.
    pub deepest: f64,
}

impl Wanted {
    /// What a design file says, and what goes without saying.
    pub fn of(file: &DesignFile) -> Self {
        let percent = file
            .accuracy
            .map_or(DEFAULT_PERCENT, |a| a.force_percent_of_reading);
        let from = file
            .accuracy
            .map_or(DEFAULT_FROM, |a| a.from_percent_of_full_scale);
        let height = file.membrane.axial_semi_axis_mm;
        Self {
            error: percent / 100.0,
            from: from / 100.0,
            deepest: 1e-3 * file.max_indentation_mm.unwrap_or(DEFAULT_DEPTH * height),
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

    /// The first of some rungs that is near enough to a judge with an error of its own. Solids with as many elements along as
    /// the judge share its error, and are not judged.
    pub fn judge<'a>(
        &self,
        mut rungs: impl Iterator<Item = (Kind, &'a [Contact])>,
        (judge, truth): (Kind, &[Contact]),
        own_error: f64,
    ) -> Option<usize> {
        rungs.position(|(kind, contacts)| {
            kind.along() < judge.along() && self.distance(contacts, truth) + own_error <= self.error
        })
    }

    /// A model's contacts at [`PARTS`] of the deepest indentation.
    ///
    /// # Errors
    /// [`ModelError`] of the model.
    pub fn contacts(&self, rung: &mut Rung) -> Result<Vec<Contact>, ModelError> {
        PARTS
            .iter()
            .map(|part| rung.contact_at(part * self.deepest))
            .collect()
    }
}

/// A rung that was taken, and on what evidence.
#[derive(Clone, Debug)]
pub struct Choice {
    /// The model.
    pub kind: Kind,
    /// The rung that judged it, and how far it is from that, relative; `None` of the last rung.
    pub judged: Option<(Kind, f64)>,
    /// The model at rest, its contacts solved.
    pub rung: Rung,
}

/// Climbs the ladder for a design whose semi-axes are the outer surface's. Rungs that do not apply, or find no state, are
/// passed over.
///
/// # Errors
/// [`ModelError`] of the last rung.
pub fn choose(design: &Design, wanted: &Wanted) -> Result<Choice, ModelError> {
    let mut solved: Vec<(Kind, Rung, Vec<Contact>)> = Vec::new();
    let mut failure = ModelError::RestNotForSolid;
    for (kind, own_error) in LADDER {
        if !kind.applies(design) {
            continue;
        }
        let found = Rung::of(kind, design).and_then(|mut rung| {
            let contacts = wanted.contacts(&mut rung)?;
            Ok((rung, contacts))
        });
        let (rung, contacts) = match found {
            Ok(found) => found,
            Err(error) => {
                failure = error;
                continue;
            }
        };
        let below = solved
            .iter()
            .map(|(kind, _, contacts)| (*kind, contacts.as_slice()));
        if let Some(near) = wanted.judge(below, (kind, &contacts), own_error) {
            let (chosen, rung, below) = solved.swap_remove(near);
            let distance = wanted.distance(&below, &contacts);
            return Ok(Choice {
                kind: chosen,
                judged: Some((kind, distance)),
                rung,
            });
        }
        solved.push((kind, rung, contacts));
    }
    match solved.pop() {
        Some((kind, rung, _)) => Ok(Choice {
            kind,
            judged: None,
            rung,
        }),
        None => Err(failure),
    }
}
