//! The error of a model itself: its difference from a better model of the same fingertip.
//!
//! A membrane is compared with the solid of the same wall, inflated to the same pole stretch; a solid with a finer mesh. Both are
//! compared as the chip reads them, at the same pressure rise.

use super::{Fingertip, Kind, ModelError};
use crate::curve::Contact;
use crate::design::{Design, RestBy};
use crate::design_file::{Axes, DesignFile};
use crate::solid;
use crate::solid::mesh::Elements;
use std::fmt;

/// Parts of the deepest indentation at which models are compared.
const PARTS: [f64; 4] = [0.1, 0.3, 0.6, 1.0];
/// The solid that a membrane is compared with, which is about 1 % off itself.
const JUDGE: Elements = solid::press::FULL;
/// Part of the end of a press that is surely before it.
const NEARLY: f64 = 0.999;
/// Accuracy of the pressure rise at which a model is read, relative.
const TOLERANCE: f64 = 1e-5;
/// States that it takes to get there, at most.
const MAX_STATES: usize = 8;
/// The power of the indentation that a pressure rise goes with, about: where a second state does not tell yet.
const POWER: f64 = 2.0;

/// A model against a better one.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// The better model, in words.
    pub better: String,
    /// States compared.
    pub states: usize,
    /// The lightest of them, metres, > 0: a lighter touch can be further off.
    pub lightest: f64,
    /// Largest error of the force at a pressure rise, percent of reading, as the tables' errors are.
    pub force_percent: f64,
    /// The same of the indentation, percent of reading.
    pub indentation_percent: f64,
}

impl Comparison {
    /// The larger of both errors.
    pub fn percent(&self) -> f64 {
        self.force_percent.max(self.indentation_percent)
    }
}

/// The error of a model itself.
#[derive(Clone, Debug, PartialEq)]
pub enum OwnError {
    /// A better model was solved.
    Compared(Comparison),
    /// There is none to compare a membrane with: thickness over radius at the pole at rest, the order of the bending that it leaves
    /// out.
    Estimated {
        /// Percent of reading.
        percent: f64,
        /// Why there is none.
        reason: ModelError,
    },
    /// There is no finer solid, and no estimate.
    Unknown {
        /// Why there is none.
        reason: ModelError,
    },
}

impl OwnError {
    /// Percent of reading, where it is known.
    pub fn percent(&self) -> Option<f64> {
        match self {
            Self::Compared(comparison) => Some(comparison.percent()),
            Self::Estimated { percent, .. } => Some(*percent),
            Self::Unknown { .. } => None,
        }
    }

    /// Of a model down to an indentation in metres; `from` is the part of the deepest reading below which an error counts in
    /// absolute terms.
    pub fn of(model: &mut Fingertip, file: &DesignFile, deepest: f64, from: f64) -> Self {
        let found = better(model, file)
            .and_then(|(mut better, words)| compare(model, &mut better, words, deepest, from));
        match found {
            Ok(comparison) => Self::Compared(comparison),
            Err(reason) => match wall_over_radius(model, file) {
                Some(share) => Self::Estimated {
                    percent: 100.0 * share,
                    reason,
                },
                None => Self::Unknown { reason },
            },
        }
    }
}

impl fmt::Display for OwnError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Compared(found) => write!(
                f,
                "against the {} the model is off by {:.2} % (force) and {:.2} % (indentation) of reading at most, from {:.3} mm on",
                found.better,
                found.force_percent,
                found.indentation_percent,
                1e3 * found.lightest
            ),
            Self::Estimated { percent, reason } => write!(
                f,
                "the membrane may be off by about {percent:.0} %, its thickness over its radius at rest; no solid was compared: \
                 {reason}"
            ),
            Self::Unknown { reason } => write!(f, "the model's own error is not known: {reason}"),
        }
    }
}

/// The better model at rest, and its name.
fn better(model: &Fingertip, file: &DesignFile) -> Result<(Fingertip, String), ModelError> {
    match model {
        Fingertip::Membrane(press) => {
            let design = Design {
                rest: RestBy::PoleStretch(press.rest().pole_stretch),
                ..file.design_to(Axes::Outer)
            };
            let kind = Kind::Solid(JUDGE);
            Ok((Fingertip::of(kind, &design)?, format!("{kind} of the same wall")))
        }
        Fingertip::Solid(_) => model.finer(file),
    }
}

/// Compares two models down to an indentation, or to the end of the better one's press if that comes first.
fn compare(
    model: &mut Fingertip,
    better: &mut Fingertip,
    words: String,
    deepest: f64,
    from: f64,
) -> Result<Comparison, ModelError> {
    let full = up_to_the_end(better, deepest)?;
    let mut found = Comparison {
        better: words,
        states: 0,
        lightest: f64::INFINITY,
        force_percent: 0.0,
        indentation_percent: 0.0,
    };
    for part in PARTS {
        let truth = better.contact_at(part * full.indentation)?;
        let read = reading(model, &truth)?;
        let share = |of: fn(&Contact) -> f64| {
            100.0 * (of(&read) - of(&truth)).abs() / of(&truth).max(from * of(&full))
        };
        found.states += 1;
        found.lightest = found.lightest.min(truth.indentation);
        found.force_percent = found.force_percent.max(share(|contact| contact.force));
        found.indentation_percent = found
            .indentation_percent
            .max(share(|contact| contact.indentation));
    }
    Ok(found)
}

/// The state at an indentation, or at the end of the press if that comes first.
fn up_to_the_end(model: &mut Fingertip, indentation: f64) -> Result<Contact, ModelError> {
    model.contact_at(indentation).or_else(|error| {
        // A press that ends where it begins has nothing to compare.
        let limit = error
            .beyond()
            .filter(|limit| limit.indentation > 0.0)
            .ok_or(error)?;
        model.contact_at(NEARLY * limit.indentation)
    })
}

/// What a model reads where another one has `truth`: its state of the same pressure rise, or the end of its press.
fn reading(model: &mut Fingertip, truth: &Contact) -> Result<Contact, ModelError> {
    let mut state = up_to_the_end(model, truth.indentation)?;
    let mut power = POWER;
    for _ in 0..MAX_STATES {
        let ratio = truth.pressure_rise / state.pressure_rise;
        if (ratio - 1.0).abs() < TOLERANCE {
            break;
        }
        // Secants in logarithms.
        let next = up_to_the_end(model, state.indentation * libm::pow(ratio, 1.0 / power))?;
        let longer = libm::log(next.indentation / state.indentation);
        // A step that leads nowhere is the end of the press.
        if longer.abs() < TOLERANCE * TOLERANCE {
            break;
        }
        power = (libm::log(next.pressure_rise / state.pressure_rise) / longer).max(0.5);
        state = next;
    }
    Ok(state)
}

/// Thickness over radius of a membrane at rest: of the pole's wall, over the radius that the equator has.
fn wall_over_radius(model: &mut Fingertip, file: &DesignFile) -> Option<f64> {
    if !matches!(model, Fingertip::Membrane(_)) {
        return None;
    }
    let thickness = file.design().membrane.thickness;
    let pole = *model.profile(0.0, 3).ok()?.first()?;
    Some(pole.thickness_stretch * thickness / model.rest().edge_radius)
}

#[cfg(test)]
mod tests;
