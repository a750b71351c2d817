//! The ladder of models: from the closed form for light contact to the full membrane.
//!
//! Each rung is measured over the press asked about, its error against the membrane on a finer mesh of higher order and
//! its cost by the clock, and [`cheapest`] takes what costs least of those that are accurate enough, with the evidence.

use super::Failure;
use super::few_states::FewStates;
use super::light_contact::LightContact;
use crate::adapt::Resolution;
use crate::curve::Contact;
use crate::design::Design;
use crate::material::Law;
use crate::membrane::TensionField;
use crate::press::{FULL, Press, SWEEP};
use std::fmt;
use std::hint::black_box;
use std::time::Instant;

/// A model; the one that knows least first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rung {
    /// The closed form: no pressed state of the membrane.
    LightContact,
    /// A curve through so many pressed states of the membrane.
    FewStates(usize),
    /// A solve of the membrane a state, on the mesh for sweeps.
    Sweep,
    /// A solve of the membrane a state, on the mesh of the full model.
    Membrane,
}

/// All rungs.
pub const RUNGS: [Rung; 7] = [
    Rung::LightContact,
    Rung::FewStates(2),
    Rung::FewStates(4),
    Rung::FewStates(8),
    Rung::FewStates(16),
    Rung::Sweep,
    Rung::Membrane,
];
/// Indentations at which rungs are measured.
pub const SAMPLES: usize = 65;
/// Times that a rung's answers are taken; the fastest counts.
const REPETITIONS: usize = 3;
/// Gauss points of what the rungs are measured against: order sixteen.
const TRUTH_STAGES: usize = 8;
/// Its mesh.
const TRUTH: Resolution = Resolution {
    density: 1.5 * FULL.density,
    contact_elements: 2 * FULL.contact_elements,
    tolerance: FULL.tolerance,
    last_term: FULL.last_term,
};
/// Gauss points of the mesh for sweeps.
const SWEEP_STAGES: usize = 5;

impl fmt::Display for Rung {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::LightContact => write!(f, "closed form"),
            Self::FewStates(states) => write!(f, "curve through {states} states"),
            Self::Sweep => write!(f, "membrane; mesh for sweeps"),
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
    /// What all its answers took together, from the rest state on, seconds.
    pub seconds: f64,
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
    /// Evidence of all rungs.
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
        /// The smallest error measured.
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
                "no model meets a relative error of {asked:.1e}: the best was measured to reach {best:.1e}"
            ),
            Self::NoRange => write!(f, "the indentations must be 0 < from <= to"),
        }
    }
}

impl core::error::Error for NoChoice {}

/// States over a range of indentations, to measure against.
#[derive(Clone, Debug)]
pub struct Yardstick {
    design: Design,
    rest: Press,
    sweep: Press<Law, SWEEP_STAGES>,
    truth: Vec<Contact>,
}

impl Yardstick {
    /// Solves the membrane at [`SAMPLES`] indentations spread geometrically over a range, metres.
    ///
    /// # Errors
    /// [`NoChoice`].
    pub fn new(design: &Design, field: TensionField, [from, to]: [f64; 2]) -> Result<Self, NoChoice> {
        if !(from > 0.0 && from <= to && to.is_finite()) {
            return Err(NoChoice::NoRange);
        }
        let lost = |error| NoChoice::Membrane(Failure::Membrane(error));
        let mut press = Press::<Law, TRUTH_STAGES>::with_resolution(design, field, TRUTH).map_err(lost)?;
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
            rest: Press::new(design, field).map_err(lost)?,
            sweep: Press::with_resolution(design, field, SWEEP).map_err(lost)?,
            truth,
        })
    }

    /// Measures a rung.
    pub fn measure(&self, rung: Rung) -> Evidence {
        let mut seconds = f64::INFINITY;
        let mut answers = Vec::new();
        for _ in 0..REPETITIONS {
            let start = Instant::now();
            answers = black_box(self.answers(rung));
            seconds = seconds.min(start.elapsed().as_secs_f64());
        }
        let samples = self
            .truth
            .iter()
            .zip(answers)
            .map(|(truth, found)| Sample {
                indentation: truth.indentation,
                force: found.map(|found| (found.force / truth.force - 1.0).abs()),
                rise: found.map_or(f64::INFINITY, |found| {
                    (found.pressure_rise / truth.pressure_rise - 1.0).abs()
                }),
            })
            .collect();
        Evidence {
            rung,
            samples,
            seconds,
        }
    }

    /// What a rung says to every indentation.
    fn answers(&self, rung: Rung) -> Vec<Result<Contact, Failure>> {
        let indentations = self.truth.iter().map(|truth| truth.indentation);
        match rung {
            Rung::LightContact => {
                let light = LightContact::new(&self.design);
                indentations
                    .map(|h| light.and_then(|light| light.at_indentation(h)))
                    .collect()
            }
            Rung::FewStates(states) => {
                let deepest = self.truth[SAMPLES - 1].indentation;
                let curve = FewStates::new(&self.design, &mut self.sweep.clone(), deepest, states);
                indentations
                    .map(|h| match &curve {
                        Ok(curve) => curve.at_indentation(h),
                        Err(failure) => Err(*failure),
                    })
                    .collect()
            }
            Rung::Sweep => {
                let mut press = self.sweep.clone();
                indentations
                    .map(|h| press.contact_at(h).map_err(Failure::Membrane))
                    .collect()
            }
            Rung::Membrane => {
                let mut press = self.rest.clone();
                indentations
                    .map(|h| press.contact_at(h).map_err(Failure::Membrane))
                    .collect()
            }
        }
    }
}

/// What was measured to cost least of the rungs whose force is off by at most `accuracy`, relative, over a range of
/// indentations in metres.
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
    let evidence = RUNGS.map(|rung| yardstick.measure(rung)).to_vec();
    evidence
        .iter()
        .filter(|measured| measured.worst() <= accuracy)
        .min_by(|a, b| a.seconds.total_cmp(&b.seconds))
        .map(|measured| measured.rung)
        .map_or_else(
            || {
                let best = evidence.iter().map(Evidence::worst).fold(f64::INFINITY, f64::min);
                Err(NoChoice::TooAccurate {
                    asked: accuracy,
                    best,
                })
            },
            |rung| {
                Ok(Choice {
                    rung,
                    evidence: evidence.clone(),
                })
            },
        )
}
