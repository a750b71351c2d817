//! All methods over the same states in one run: time a state against error of the force.
//!
//! Each method presses a design through the same indentations, each state warm-started from those before; the rest
//! state is solved beforehand. Repetitions of the methods are interleaved, so that whatever else the machine does
//! falls on all of them.

use super::bisection::{Bisection, Fineness};
use super::few_states::FewStates;
use super::light_contact::LightContact;
use super::shooting::Shooting;
use model_tables::design::{Design, Membrane, RestBy};
use model_tables::material::Law;
use model_tables::material::preset::{AGILUS30, SKIN};
use model_tables::membrane::TensionField;
use model_tables::membrane::adapt::Resolution;
use model_tables::membrane::press::{MembraneError, Press};
use model_tables::object::Object;
use std::time::{Duration, Instant};

/// States of a sweep.
pub const STATES: usize = 64;
/// Depth of a sweep over the limit of the press.
const DEPTH: f64 = 0.6;
/// Repetitions at most.
const MAX_REPETITIONS: usize = 41;
/// Repetitions that are made however long they take.
const MIN_REPETITIONS: usize = 3;
/// Time after which a method is not repeated.
const BUDGET: Duration = Duration::from_millis(400);
/// Time after which it is not repeated even so.
const LARGEST_BUDGET: Duration = Duration::from_secs(3);

/// The truth: more Gauss points, a finer mesh.
const TRUTH: Resolution = Resolution {
    density: 5.0,
    contact_elements: 8,
    tolerance: 1e-14,
    last_term: 1e-7,
};
/// What the truth is checked against: another order and mesh.
const CHECK: Resolution = Resolution {
    density: 3.5,
    contact_elements: 6,
    tolerance: 1e-14,
    last_term: 1e-7,
};

/// A design of the benchmark.
#[derive(Clone, Copy, Debug)]
pub struct BenchmarkDesign {
    /// Short name, for files.
    pub name: &'static str,
    /// What it is, for people.
    pub title: &'static str,
    /// The design.
    pub design: Design,
}

const fn dome(radial: f64, axial: f64, law: Law, pole_stretch: f64) -> Design {
    Design {
        membrane: Membrane {
            radial_semi_axis: radial,
            axial_semi_axis: axial,
            thickness: 1e-3,
        },
        law,
        rest: RestBy::PoleStretch(pole_stretch),
        compliance: 0.0,
        object: Object::PLATE,
    }
}

/// The designs: much, little and moderate pre-stretch. Nothing in them is compressed, so that wrinkles play no part.
pub const DESIGNS: [BenchmarkDesign; 3] = [
    BenchmarkDesign {
        name: "paper",
        title: "4.5 x 2.7 mm, Agilus30, pole stretch 2.3",
        design: dome(4.5e-3, 2.7e-3, AGILUS30, 2.3),
    },
    BenchmarkDesign {
        name: "finger",
        title: "9 x 7 mm, Agilus30, pole stretch 1.02",
        design: dome(9e-3, 7e-3, AGILUS30, 1.02),
    },
    BenchmarkDesign {
        name: "skin",
        title: "9 x 7 mm, skin analogue, pole stretch 1.1",
        design: dome(9e-3, 7e-3, SKIN, 1.1),
    },
];

/// A method with its settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// The project's: Gauss collocation on an adapted mesh.
    Collocation {
        /// Gauss points an element; the order is twice that.
        stages: usize,
        /// Elements a unit of depth.
        density: f64,
    },
    /// Shooting with Newton's method.
    Shooting {
        /// Relative tolerance of the integration.
        tolerance: f64,
    },
    /// The paper's nested bisection.
    Bisection(Fineness),
    /// A curve through so many states.
    FewStates(usize),
    /// The closed form.
    LightContact,
}

impl Method {
    /// The family, for files and legends.
    pub fn family(self) -> &'static str {
        match self {
            Self::Collocation { .. } => "collocation",
            Self::Shooting { .. } => "shooting",
            Self::Bisection(_) => "bisection",
            Self::FewStates(_) => "few-states",
            Self::LightContact => "closed-form",
        }
    }

    /// It solves every so many of the states: the slow one takes fewer, the time a state stays comparable.
    pub fn stride(self) -> usize {
        match self {
            Self::Bisection(_) => 16,
            _ => 1,
        }
    }

    /// Its settings, for files.
    pub fn settings(self) -> String {
        match self {
            Self::Collocation { stages, density } => {
                format!("order {} density {density}", 2 * stages)
            }
            Self::Shooting { tolerance } => format!("tolerance {tolerance:e}"),
            Self::Bisection(Fineness { steps, tolerance }) => {
                format!("{steps} steps tolerance {tolerance:e}")
            }
            Self::FewStates(states) => format!("{states} states"),
            Self::LightContact => "-".to_owned(),
        }
    }
}

/// Gauss points an element that take part.
pub const STAGES: [usize; 6] = [2, 3, 4, 5, 6, 8];
const DENSITIES: [f64; 6] = [0.7, 0.9, 1.2, 1.8, 2.5, 4.0];
const TOLERANCES: [f64; 5] = [1e-4, 1e-6, 1e-8, 1e-10, 1e-12];

/// All that take part.
pub fn methods() -> Vec<Method> {
    let mut all = Vec::new();
    for stages in STAGES {
        all.extend(DENSITIES.map(|density| Method::Collocation { stages, density }));
    }
    all.extend(TOLERANCES.map(|tolerance| Method::Shooting { tolerance }));
    all.extend(
        [(50, 1e-3), (200, 1e-4), (400, 1e-5)]
            .map(|(steps, tolerance)| Method::Bisection(Fineness { steps, tolerance })),
    );
    all.extend([2, 4, 8, 16].map(Method::FewStates));
    all.push(Method::LightContact);
    all
}

/// What a method did with a design.
#[derive(Clone, Debug)]
pub struct Result {
    /// The method.
    pub method: Method,
    /// Median time a state, seconds, over the repetitions.
    pub seconds: f64,
    /// Repetitions timed.
    pub repetitions: usize,
    /// Largest relative error of the force over the states that were found.
    pub worst: f64,
    /// Median relative error.
    pub median: f64,
    /// States found, from the first on.
    pub found: usize,
    /// States asked for.
    pub asked: usize,
    /// Why not all of them were found; `None` where all were.
    pub failure: Option<String>,
}

/// The indentations of a sweep and the truth there.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// The design.
    pub design: BenchmarkDesign,
    /// Indentations, metres.
    pub indentations: Vec<f64>,
    /// Forces, newtons.
    pub forces: Vec<f64>,
    /// How far two fine solutions differ, relative, at worst.
    pub uncertainty: f64,
}

impl Sweep {
    /// Equal steps of indentation down to a part of the limit, and the truth at each.
    ///
    /// # Errors
    /// [`MembraneError`].
    pub fn new(of: &BenchmarkDesign) -> core::result::Result<Self, MembraneError> {
        let design = &of.design;
        let mut press = Press::<Law, 8>::with_resolution(design, TensionField::Plain, TRUTH)?;
        let mut check = Press::<Law, 7>::with_resolution(design, TensionField::Plain, CHECK)?;
        let deepest = DEPTH * press.clone().limit()?.indentation;
        let indentations: Vec<f64> = (1..=STATES).map(|k| deepest * k as f64 / STATES as f64).collect();
        let (mut forces, mut uncertainty) = (Vec::new(), 0.0_f64);
        for &indentation in &indentations {
            let force = press.contact_at(indentation)?.force;
            let other = check.contact_at(indentation)?.force;
            uncertainty = uncertainty.max((other / force - 1.0).abs());
            forces.push(force);
        }
        Ok(Self {
            design: *of,
            indentations,
            forces,
            uncertainty,
        })
    }
}

/// Forces found, and what stopped the sweep.
type Run = (Vec<f64>, Option<String>);
/// A method at rest, ready to press: each call is one sweep, with the time it took.
type Ready = Box<dyn Fn(&[f64]) -> (Duration, Run)>;

/// Where Newton's method may stop: well below the error that a mesh leaves anyway, which falls by fifteen for every
/// Gauss point and with the order in the density.
fn newton_tolerance(stages: usize, density: f64) -> f64 {
    let stages = stages as f64;
    let mesh = libm::pow(10.0, -1.17 * stages) * libm::pow(0.7 / density, 2.0 * stages);
    (0.01 * mesh).clamp(1e-14, 1e-4)
}

fn collocation<const S: usize>(design: &Design, density: f64) -> core::result::Result<Ready, String> {
    let resolution = Resolution {
        density,
        contact_elements: libm::round(density) as usize,
        tolerance: newton_tolerance(S, density),
        last_term: f64::INFINITY,
    };
    let rest = Press::<Law, S>::with_resolution(design, TensionField::Plain, resolution)
        .map_err(|error| error.to_string())?;
    Ok(Box::new(move |indentations| {
        let mut press = rest.clone();
        timed(indentations, |h| {
            press
                .contact_at(h)
                .map(|contact| contact.force)
                .map_err(|error| error.to_string())
        })
    }))
}

/// One sweep under the clock.
fn timed(
    indentations: &[f64],
    mut force: impl FnMut(f64) -> core::result::Result<f64, String>,
) -> (Duration, Run) {
    let mut forces = Vec::with_capacity(indentations.len());
    let mut stopped = None;
    let start = Instant::now();
    for &indentation in indentations {
        match force(indentation) {
            Ok(force) => forces.push(force),
            Err(reason) => {
                stopped = Some(reason);
                break;
            }
        }
    }
    (start.elapsed(), (forces, stopped))
}

fn ready(method: Method, design: &Design) -> core::result::Result<Ready, String> {
    let words = |failure: super::MethodFailure| failure.to_string();
    let design = *design;
    match method {
        Method::Collocation { stages, density } => match stages {
            2 => collocation::<2>(&design, density),
            3 => collocation::<3>(&design, density),
            4 => collocation::<4>(&design, density),
            5 => collocation::<5>(&design, density),
            6 => collocation::<6>(&design, density),
            8 => collocation::<8>(&design, density),
            _ => Err(format!("{stages} Gauss points take no part")),
        },
        Method::Shooting { tolerance } => {
            let rest = Shooting::new(&design, tolerance).map_err(words)?;
            Ok(Box::new(move |indentations| {
                let mut shooting = rest.clone();
                timed(indentations, |h| {
                    shooting.at_indentation(h).map(|found| found.force).map_err(words)
                })
            }))
        }
        Method::Bisection(fineness) => {
            let rest = Bisection::new(&design, fineness).map_err(words)?;
            Ok(Box::new(move |indentations| {
                let mut bisection = rest.clone();
                timed(indentations, |h| {
                    bisection
                        .at_indentation(h)
                        .map(|found| found.force)
                        .map_err(words)
                })
            }))
        }
        Method::FewStates(states) => {
            let rest = Press::new(&design, TensionField::Plain).map_err(|error| error.to_string())?;
            Ok(Box::new(move |indentations| {
                // The few states are part of the sweep.
                let start = Instant::now();
                let deepest = indentations.last().copied().unwrap_or_default();
                match FewStates::new(&design, &mut rest.clone(), deepest, states) {
                    Ok(curve) => {
                        let run = timed(indentations, |h| {
                            curve.at_indentation(h).map(|found| found.force).map_err(words)
                        });
                        (start.elapsed(), run.1)
                    }
                    Err(failure) => (start.elapsed(), (Vec::new(), Some(failure.to_string()))),
                }
            }))
        }
        Method::LightContact => {
            let light = LightContact::new(&design).map_err(words)?;
            Ok(Box::new(move |indentations| {
                timed(indentations, |h| {
                    light.at_indentation(h).map(|found| found.force).map_err(words)
                })
            }))
        }
    }
}

/// Every `stride`-th value, the last among them.
fn every(values: &[f64], stride: usize) -> Vec<f64> {
    values.iter().skip(stride - 1).step_by(stride).copied().collect()
}

/// Runs all methods over a sweep, repetitions interleaved; `progress` gets the number of each round.
pub fn run(sweep: &Sweep, methods: &[Method], mut progress: impl FnMut(usize)) -> Vec<Result> {
    let mut ready: Vec<core::result::Result<Ready, String>> = methods
        .iter()
        .map(|&method| ready(method, &sweep.design.design))
        .collect();
    let mut times: Vec<Vec<Duration>> = vec![Vec::new(); methods.len()];
    let mut runs: Vec<Option<Run>> = vec![None; methods.len()];
    for repetition in 0..MAX_REPETITIONS {
        progress(repetition);
        for (i, method) in ready.iter_mut().enumerate() {
            let Ok(method) = method else { continue };
            let spent: Duration = times[i].iter().sum();
            if spent > LARGEST_BUDGET || (repetition >= MIN_REPETITIONS && spent > BUDGET) {
                continue;
            }
            let (took, run) = method(&every(&sweep.indentations, methods[i].stride()));
            times[i].push(took);
            runs[i] = Some(run);
        }
    }
    let mut results = Vec::new();
    for (i, &method) in methods.iter().enumerate() {
        let (forces, failure) = match (&ready[i], runs[i].take()) {
            (Err(reason), _) => (Vec::new(), Some(reason.clone())),
            (Ok(_), run) => run.unwrap_or_default(),
        };
        let mut errors: Vec<f64> = forces
            .iter()
            .zip(every(&sweep.forces, method.stride()))
            .map(|(found, truth)| (found / truth - 1.0).abs())
            .collect();
        errors.sort_by(f64::total_cmp);
        times[i].sort();
        let found = errors.len();
        let took = times[i].get(times[i].len() / 2).copied().unwrap_or_default();
        results.push(Result {
            method,
            seconds: took.as_secs_f64() / found.max(1) as f64,
            repetitions: times[i].len(),
            worst: errors.last().copied().unwrap_or(f64::NAN),
            median: errors.get(found / 2).copied().unwrap_or(f64::NAN),
            found,
            asked: STATES / method.stride(),
            failure,
        });
    }
    results
}
