//! Approximations of the membrane, from the closed form for light contact to the full model.
//!
//! Each is measured over the press asked about: its error against the membrane on a finer mesh of higher order, and its
//! cost by the clock. Which model a design takes is another matter: `model_tables::model::choice`.

use super::MethodFailure;
use super::few_states::FewStates;
use super::light_contact::LightContact;
use model_tables::curve::Contact;
use model_tables::design::Design;
use model_tables::material::Law;
use model_tables::membrane::TensionField;
use model_tables::membrane::adapt::Resolution;
use model_tables::membrane::press::{FULL, Press, SWEEP};
use std::fmt;
use std::hint::black_box;
use std::time::Instant;

/// A way to the states; the one that knows least first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Approximation {
    /// The closed form: no pressed state of the membrane.
    LightContact,
    /// A curve through so many pressed states of the membrane.
    FewStates(usize),
    /// A solve of the membrane a state, on the mesh for sweeps.
    Sweep,
    /// A solve of the membrane a state, on the mesh of the full model.
    Membrane,
}

/// All of them.
pub const APPROXIMATIONS: [Approximation; 7] = [
    Approximation::LightContact,
    Approximation::FewStates(2),
    Approximation::FewStates(4),
    Approximation::FewStates(8),
    Approximation::FewStates(16),
    Approximation::Sweep,
    Approximation::Membrane,
];
/// Indentations at which they are measured.
pub const SAMPLES: usize = 65;
/// Times that the answers are taken; the fastest counts.
const REPETITIONS: usize = 3;
/// Gauss points of what they are measured against: order sixteen.
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

impl fmt::Display for Approximation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::LightContact => write!(f, "closed form"),
            Self::FewStates(states) => write!(f, "curve through {states} states"),
            Self::Sweep => write!(f, "membrane; mesh for sweeps"),
            Self::Membrane => write!(f, "full membrane"),
        }
    }
}

/// Relative errors at one indentation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorSample {
    /// The indentation, metres.
    pub indentation: f64,
    /// Error of the force, relative; what failed where there is none.
    pub force: Result<f64, MethodFailure>,
    /// Error of the pressure rise, relative; infinite where there is none.
    pub rise: f64,
}

/// What an approximation was measured to do.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredErrors {
    /// Which.
    pub approximation: Approximation,
    /// Its errors, from the shallowest indentation to the deepest.
    pub samples: Vec<ErrorSample>,
    /// What all its answers took together, from the rest state on, seconds.
    pub seconds: f64,
}

impl MeasuredErrors {
    /// The largest relative error of the force; infinite where a state is missing.
    pub fn worst(&self) -> f64 {
        self.samples
            .iter()
            .map(|sample| sample.force.unwrap_or(f64::INFINITY))
            .fold(0.0, f64::max)
    }
}

/// Why there is nothing to measure against.
#[derive(Clone, Debug, PartialEq)]
pub enum NoTruth {
    /// The full membrane gave no answer to measure against.
    Membrane(MethodFailure),
    /// The range is empty or not one of indentations.
    NoRange,
}

impl fmt::Display for NoTruth {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Membrane(failure) => failure.fmt(f),
            Self::NoRange => write!(f, "the indentations must be 0 < from <= to"),
        }
    }
}

impl core::error::Error for NoTruth {}

/// States over a range of indentations, to measure against.
#[derive(Clone, Debug)]
pub struct Yardstick {
    design: Design,
    // On the heap: each is hundreds of kilobytes.
    rest: Box<Press>,
    sweep: Box<Press<Law, SWEEP_STAGES>>,
    truth: Vec<Contact>,
}

impl Yardstick {
    /// Solves the membrane at [`SAMPLES`] indentations spread geometrically over a range, metres.
    ///
    /// # Errors
    /// [`NoTruth`].
    pub fn new(design: &Design, field: TensionField, [from, to]: [f64; 2]) -> Result<Self, NoTruth> {
        if !(from > 0.0 && from <= to && to.is_finite()) {
            return Err(NoTruth::NoRange);
        }
        let lost = |error| NoTruth::Membrane(MethodFailure::Membrane(error));
        let mut press =
            Box::new(Press::<Law, TRUTH_STAGES>::with_resolution(design, field, TRUTH).map_err(lost)?);
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
            rest: Box::new(Press::new(design, field).map_err(lost)?),
            sweep: Box::new(Press::with_resolution(design, field, SWEEP).map_err(lost)?),
            truth,
        })
    }

    /// Measures an approximation.
    pub fn measure(&self, approximation: Approximation) -> MeasuredErrors {
        let mut seconds = f64::INFINITY;
        let mut answers = Vec::new();
        for _ in 0..REPETITIONS {
            let start = Instant::now();
            answers = black_box(self.answers(approximation));
            seconds = seconds.min(start.elapsed().as_secs_f64());
        }
        let samples = self
            .truth
            .iter()
            .zip(answers)
            .map(|(truth, found)| ErrorSample {
                indentation: truth.indentation,
                force: found.map(|found| (found.force / truth.force - 1.0).abs()),
                rise: found.map_or(f64::INFINITY, |found| {
                    (found.pressure_rise / truth.pressure_rise - 1.0).abs()
                }),
            })
            .collect();
        MeasuredErrors {
            approximation,
            samples,
            seconds,
        }
    }

    /// The answers at every indentation.
    fn answers(&self, approximation: Approximation) -> Vec<Result<Contact, MethodFailure>> {
        let indentations = self.truth.iter().map(|truth| truth.indentation);
        match approximation {
            Approximation::LightContact => {
                let light = LightContact::new(&self.design);
                indentations
                    .map(|h| light.and_then(|light| light.at_indentation(h)))
                    .collect()
            }
            Approximation::FewStates(states) => {
                let deepest = self.truth[SAMPLES - 1].indentation;
                let curve = FewStates::new(&self.design, &mut *self.sweep.clone(), deepest, states);
                indentations
                    .map(|h| match &curve {
                        Ok(curve) => curve.at_indentation(h),
                        Err(failure) => Err(*failure),
                    })
                    .collect()
            }
            Approximation::Sweep => {
                let mut press = self.sweep.clone();
                indentations
                    .map(|h| press.contact_at(h).map_err(MethodFailure::Membrane))
                    .collect()
            }
            Approximation::Membrane => {
                let mut press = self.rest.clone();
                indentations
                    .map(|h| press.contact_at(h).map_err(MethodFailure::Membrane))
                    .collect()
            }
        }
    }
}
