//! The ladder of models: from the closed form for light contact to the full membrane.
//!
//! Each rung is measured against the full membrane over the press asked about, and [`cheapest`] takes the lowest
//! one that is accurate enough, with the evidence.

use super::Failure;
use super::few_states::FewStates;
use super::light_contact::LightContact;
use crate::curve::Contact;
use crate::design::Design;
use crate::membrane::TensionField;
use crate::press::Press;
use std::fmt;

/// A model, cheapest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rung {
    /// The closed form: no pressed state of the membrane.
    LightContact,
    /// A curve through so many pressed states of the membrane.
    FewStates(usize),
    /// A solve of the membrane a state.
    Membrane,
}

/// All rungs, cheapest first.
pub const RUNGS: [Rung; 6] = [
    Rung::LightContact,
    Rung::FewStates(2),
    Rung::FewStates(4),
    Rung::FewStates(8),
    Rung::FewStates(16),
    Rung::Membrane,
];
/// Indentations at which rungs are measured.
pub const SAMPLES: usize = 65;
/// Relative error of the full membrane's force: the last rung meets no accuracy below it.
pub const MEMBRANE_ERROR: f64 = 1e-8;

impl fmt::Display for Rung {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::LightContact => write!(f, "closed form"),
            Self::FewStates(states) => write!(f, "curve through {states} states"),
            Self::Membrane => write!(f, "full membrane"),
        }
    }
}

/// Relative errors of a rung at one indentation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// The indentation, metres.
    pub indentation: f64,
    /// Error of the force, relative; what failed where there is none.
    pub force: Result<f64, Failure>,
    /// Error of the pressure rise, relative; infinite where there is none.
    pub rise: f64,
}

/// What a rung was measured to do.
#[derive(Clone, Debug, PartialEq)]
pub struct Evidence {
    /// The rung.
    pub rung: Rung,
    /// Its errors, from the shallowest indentation to the deepest.
    pub samples: Vec<Sample>,
}

impl Evidence {
    /// The largest relative error of the force; infinite where a state is missing.
    pub fn worst(&self) -> f64 {
        self.samples
            .iter()
            .map(|sample| sample.force.unwrap_or(f64::INFINITY))
            .fold(0.0, f64::max)
    }
}

/// The cheapest rung, and what was measured on the way to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The rung.
    pub rung: Rung,
    /// Evidence of all rungs up to it.
    pub evidence: Vec<Evidence>,
}

/// Why there is no choice.
#[derive(Clone, Debug, PartialEq)]
pub enum NoChoice {
    /// The full membrane gave no answer to measure against.
    Membrane(Failure),
    /// No model here is that accurate.
    TooAccurate {
        /// What was asked, relative.
        asked: f64,
        /// What the full membrane reaches.
        best: f64,
    },
    /// The range is empty or not one of indentations.
    NoRange,
}

impl fmt::Display for NoChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Membrane(failure) => failure.fmt(f),
            Self::TooAccurate { asked, best } => write!(
                f,
                "no model meets a relative error of {asked:.1e}: the full membrane reaches {best:.0e}"
            ),
            Self::NoRange => write!(f, "the indentations must be 0 < from <= to"),
        }
    }
}

impl core::error::Error for NoChoice {}

/// The full membrane over a range of indentations, to measure against.
#[derive(Clone, Debug)]
pub struct Yardstick {
    design: Design,
    rest: Press,
    truth: Vec<Contact>,
}

impl Yardstick {
    /// Solves the full membrane at [`SAMPLES`] indentations spread geometrically over a range, metres.
    ///
    /// # Errors
    /// [`NoChoice`].
    pub fn new(design: &Design, field: TensionField, [from, to]: [f64; 2]) -> Result<Self, NoChoice> {
        if !(from > 0.0 && from <= to && to.is_finite()) {
            return Err(NoChoice::NoRange);
        }
        let lost = |error| NoChoice::Membrane(Failure::Membrane(error));
        let rest = Press::new(design, field).map_err(lost)?;
        let mut press = rest.clone();
        let mut truth = Vec::with_capacity(SAMPLES);
        for k in 0..SAMPLES {
            let part = k as f64 / (SAMPLES - 1) as f64;
            let indentation = if k + 1 == SAMPLES {
                to
            } else {
                from * libm::pow(to / from, part)
            };
            truth.push(press.contact_at(indentation).map_err(lost)?);
        }
        Ok(Self {
            design: *design,
            rest,
            truth,
        })
    }

    /// Measures a rung. The full membrane's error is the stated one.
    pub fn measure(&self, rung: Rung) -> Evidence {
        let deepest = self.truth[SAMPLES - 1].indentation;
        let light = LightContact::new(&self.design);
        let curve = match rung {
            Rung::FewStates(states) => FewStates::new(&self.design, &mut self.rest.clone(), deepest, states),
            _ => Err(Failure::Singular),
        };
        let answer = |indentation: f64| match rung {
            Rung::LightContact => light.and_then(|light| light.at_indentation(indentation)),
            _ => match &curve {
                Ok(curve) => curve.at_indentation(indentation),
                Err(failure) => Err(*failure),
            },
        };
        let samples = self
            .truth
            .iter()
            .map(|truth| {
                let indentation = truth.indentation;
                if rung == Rung::Membrane {
                    return Sample {
                        indentation,
                        force: Ok(MEMBRANE_ERROR),
                        rise: MEMBRANE_ERROR,
                    };
                }
                let found = answer(indentation);
                Sample {
                    indentation,
                    force: found.map(|found| (found.force / truth.force - 1.0).abs()),
                    rise: found.map_or(f64::INFINITY, |found| {
                        (found.pressure_rise / truth.pressure_rise - 1.0).abs()
                    }),
                }
            })
            .collect();
        Evidence { rung, samples }
    }
}

/// The cheapest rung whose force is off by at most `accuracy`, relative, over a range of indentations in metres.
///
/// # Errors
/// [`NoChoice`].
pub fn cheapest(
    design: &Design,
    field: TensionField,
    range: [f64; 2],
    accuracy: f64,
) -> Result<Choice, NoChoice> {
    let yardstick = Yardstick::new(design, field, range)?;
    let mut evidence = Vec::new();
    for rung in RUNGS {
        let measured = yardstick.measure(rung);
        let worst = measured.worst();
        evidence.push(measured);
        if worst <= accuracy {
            return Ok(Choice { rung, evidence });
        }
    }
    Err(NoChoice::TooAccurate {
        asked: accuracy,
        best: MEMBRANE_ERROR,
    })
}
