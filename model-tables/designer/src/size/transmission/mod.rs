//! Sizing of a haptic loop: a wanted feedback force over touch force, and bounds -> fingertips and actuators that have it.
//!
//! [`target`] (what is wanted) -> candidates spread over the bounds, each a loop solved at the wanted indentation -> from the nearest the shortest way
//! to the wanted ratio (Newton's method of least norm, in logarithms of the free dimensions) -> ranked by what making does to the ratio.

pub mod target;

use model_tables::design::{Design, Membrane, RestBy};
use model_tables::material::preset::Preset;
use model_tables::model::Kind;
use model_tables::model::feedback::Loop;
use model_tables::object::{Friction, Object};
use model_tables::solid::disc::{Disc, DiscDesign};
use model_tables::solid::gas::TrappedGas;
use model_tables::solid::mesh::Elements;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use target::{DIMENSIONS, WantedLoop};

/// Elements of the fingertip and of the actuator: ratios to about 2 %, as well as a part is made.
const TIP: Elements = Elements {
    through: 1,
    along: 16,
};
const DISC: Elements = Elements {
    through: 1,
    along: 16,
};
/// Candidates of each pair of materials, at least and for each free dimension.
const CANDIDATES: [usize; 2] = [4, 8];
/// Candidates from which the wanted ratio is looked for.
const REFINED: usize = 4;
/// Steps on the way there, and the largest in the logarithm of a dimension.
const STEPS: usize = 8;
const LARGEST_STEP: f64 = 0.3;
/// Relative change of a dimension, for derivatives.
const CHANGE: f64 = 1e-3;
/// Deviation from the wanted ratio, relative, that counts as none.
const GOOD: f64 = 1e-3;
/// A wall is thinner than this part of the smaller semi-axis.
const THICKEST: f64 = 0.4;
/// Absolute temperature, kelvin, of which a kelvin changes the modulus of a rubber by its share: the theory of rubber elasticity (Treloar, "The Physics
/// of Rubber Elasticity", 3rd ed., 1975, chapter 4).
const TEMPERATURE: f64 = 293.15;

/// A candidate: dimensions in metres in the order of [`target::NAMES`], and both materials.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopCandidate {
    /// The dimensions, metres.
    pub dimensions: [f64; DIMENSIONS],
    /// Of the fingertip.
    pub tip: &'static Preset,
    /// Of the actuator.
    pub actuator: &'static Preset,
}

/// What disturbs a loop, beside its dimensions.
#[derive(Clone, Copy, Debug)]
struct Circuit {
    /// Trapped air at ambient pressure, cubic metres.
    air: f64,
    /// Compliance of the tubing, cubic metres per pascal.
    tube: f64,
    /// Kelvin over the temperature of the constants.
    warmer: f64,
}

/// What a loop does at the wanted indentation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopAnswer {
    /// Feedback force over touch force.
    pub ratio: f64,
    /// Force of the touch, newtons.
    pub touch_force: f64,
    /// Force of the feedback, newtons.
    pub feedback_force: f64,
    /// Pressure rise, pascals.
    pub pressure_rise: f64,
}

/// A loop that was found.
#[derive(Clone, Debug, PartialEq)]
pub struct SizedLoop {
    /// What it is.
    pub candidate: LoopCandidate,
    /// What it does.
    pub answer: LoopAnswer,
    /// Deviation from the wanted ratio, relative.
    pub misfit: f64,
    /// Relative change of the ratio for the tolerance in each dimension.
    pub by_tolerance: [f64; DIMENSIONS],
    /// Relative change of the ratio for the target's further air.
    pub by_air: f64,
    /// Relative change of the ratio for the target's further compliance.
    pub by_tube: f64,
    /// Relative change of the ratio for the target's kelvin.
    pub by_temperature: f64,
}

impl SizedLoop {
    /// All tolerances together, as independent ones.
    pub fn making(&self) -> f64 {
        libm::sqrt(self.by_tolerance.iter().map(|part| part * part).sum())
    }

    fn rank(&self) -> (u64, f64) {
        (
            libm::ceil(self.misfit.max(GOOD) / GOOD - 1e-9) as u64,
            self.making(),
        )
    }
}

/// The loop of a candidate. `None` where it has no state, or its pressure is beyond the transducer's range.
fn answer(wanted: &WantedLoop, candidate: &LoopCandidate, circuit: Circuit) -> Option<LoopAnswer> {
    let [radial, axial, wall, diameter, thickness] = candidate.dimensions;
    if wall >= THICKEST * radial.min(axial) || thickness >= diameter {
        return None;
    }
    let stiffer = 1.0 + circuit.warmer / TEMPERATURE;
    let design = Design {
        membrane: Membrane {
            radial_semi_axis: radial,
            axial_semi_axis: axial,
            thickness: wall,
        },
        law: candidate.tip.law.stiffened(stiffer),
        rest: RestBy::Unstretched,
        compliance: circuit.tube,
        object: Object::PLATE,
    };
    let disc = DiscDesign {
        diameter,
        thickness,
        law: candidate.actuator.law.stiffened(stiffer),
        far_side: wanted.far_side,
        friction: Friction::NONE,
    };
    let gas = TrappedGas {
        volume: circuit.air,
        ..TrappedGas::NONE
    };
    let state = Loop::new(Kind::Solid(TIP), &design, Disc::new(&disc, DISC).ok()?)
        .ok()?
        .with_gas(gas)
        .at_indentation(wanted.indentation)
        .ok()?;
    let [low, high] = wanted.range_kpa.map(|kpa| 1e3 * kpa);
    let found = LoopAnswer {
        ratio: state.transmission()?,
        touch_force: state.touch.force,
        feedback_force: state.actuator.force,
        pressure_rise: state.touch.pressure_rise,
    };
    (found.ratio > 0.0 && (low..=high).contains(&found.pressure_rise)).then_some(found)
}

/// Candidates spread over the bounds in their logarithms, by multiples of powers of the generalised golden ratio.
fn candidates(wanted: &WantedLoop) -> Vec<LoopCandidate> {
    let free: Vec<usize> = (0..DIMENSIONS).filter(|&i| wanted.is_free(i)).collect();
    let count = CANDIDATES[0].max(CANDIDATES[1] * free.len());
    // The root of x^(d + 1) = x + 1.
    let mut ratio: f64 = 2.0;
    for _ in 0..60 {
        ratio = libm::pow(1.0 + ratio, 1.0 / (free.len() as f64 + 1.0));
    }
    let mut all = Vec::new();
    for &tip in &wanted.materials {
        for actuator in wanted.actuator_materials(tip) {
            for k in 0..count {
                let mut dimensions = wanted.bounds.map(|[low, _]| low);
                for (j, &i) in free.iter().enumerate() {
                    let [low, high] = wanted.bounds[i];
                    let part = 0.5 + k as f64 / libm::pow(ratio, j as f64 + 1.0);
                    dimensions[i] = low * libm::pow(high / low, part - libm::floor(part));
                }
                all.push(LoopCandidate {
                    dimensions,
                    tip,
                    actuator,
                });
            }
        }
    }
    all
}

/// Derivatives of the ratio's logarithm by the logarithms of the free dimensions.
fn slopes(wanted: &WantedLoop, candidate: &LoopCandidate, at: f64) -> Option<[f64; DIMENSIONS]> {
    let mut slopes = [0.0; DIMENSIONS];
    for i in (0..DIMENSIONS).filter(|&i| wanted.is_free(i)) {
        let mut beside = *candidate;
        // Inwards of the upper bound.
        let up = beside.dimensions[i] * (1.0 + CHANGE) <= wanted.bounds[i][1];
        let change = if up { CHANGE } else { -CHANGE };
        beside.dimensions[i] *= 1.0 + change;
        let found = answer(wanted, &beside, wanted.circuit())?;
        slopes[i] = libm::log(found.ratio / at) / libm::log(1.0 + change);
    }
    Some(slopes)
}

/// The shortest way from a candidate to the wanted ratio.
fn refine(wanted: &WantedLoop, mut candidate: LoopCandidate) -> Option<(LoopCandidate, LoopAnswer)> {
    let mut now = answer(wanted, &candidate, wanted.circuit())?;
    for _ in 0..STEPS {
        let missing = libm::log(wanted.ratio / now.ratio);
        if missing.abs() < 0.1 * GOOD {
            break;
        }
        let mut slopes = slopes(wanted, &candidate, now.ratio)?;
        // A bound that is reached holds its dimension.
        for (i, slope) in slopes.iter_mut().enumerate() {
            let [low, high] = wanted.bounds[i];
            let outward = missing * *slope > 0.0;
            let at = candidate.dimensions[i];
            if outward && at >= high || !outward && at <= low {
                *slope = 0.0;
            }
        }
        let square: f64 = slopes.iter().map(|slope| slope * slope).sum();
        if square < 1e-6 {
            break;
        }
        let mut part = 1.0;
        let next = loop {
            let mut next = candidate;
            for (i, slope) in slopes.iter().enumerate() {
                let step = (missing * slope / square * part).clamp(-LARGEST_STEP, LARGEST_STEP);
                let [low, high] = wanted.bounds[i];
                next.dimensions[i] = (next.dimensions[i] * libm::exp(step)).clamp(low, high);
            }
            if let Some(found) = answer(wanted, &next, wanted.circuit()) {
                break Some((next, found));
            }
            part *= 0.5;
            if part < 0.1 {
                break None;
            }
        };
        let Some((next, found)) = next else { break };
        if libm::log(wanted.ratio / found.ratio).abs() >= missing.abs() {
            break;
        }
        (candidate, now) = (next, found);
    }
    Some((candidate, now))
}

/// A loop with what disturbs it.
fn sized(wanted: &WantedLoop, candidate: LoopCandidate, now: LoopAnswer) -> Option<SizedLoop> {
    let circuit = wanted.circuit();
    let change = |candidate: &LoopCandidate, circuit: Circuit| -> Option<f64> {
        Some(answer(wanted, candidate, circuit)?.ratio / now.ratio - 1.0)
    };
    let mut by_tolerance = [0.0; DIMENSIONS];
    for (i, part) in by_tolerance.iter_mut().enumerate() {
        let mut larger = candidate;
        larger.dimensions[i] += wanted.tolerance;
        *part = change(&larger, circuit)?;
    }
    Some(SizedLoop {
        misfit: (now.ratio / wanted.ratio - 1.0).abs(),
        by_air: change(
            &candidate,
            Circuit {
                air: circuit.air + wanted.disturbing_air,
                ..circuit
            },
        )?,
        by_tube: change(
            &candidate,
            Circuit {
                tube: circuit.tube + wanted.disturbing_tube,
                ..circuit
            },
        )?,
        by_temperature: change(
            &candidate,
            Circuit {
                warmer: wanted.disturbing_kelvin,
                ..circuit
            },
        )?,
        answer: now,
        by_tolerance,
        candidate,
    })
}

/// Loops with the wanted ratio or near it, ranked, and how many candidates were solved. Progress goes from 0 to 1.
pub fn size(wanted: &WantedLoop, progress: &(impl Fn(f64) + Sync)) -> (Vec<SizedLoop>, usize) {
    let all = candidates(wanted);
    let (count, done) = (all.len(), AtomicUsize::new(0));
    let solved: Vec<(f64, LoopCandidate)> = all
        .into_par_iter()
        .filter_map(|candidate| {
            let found = answer(wanted, &candidate, wanted.circuit());
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            progress(0.7 * done as f64 / count as f64);
            Some((libm::log(found?.ratio / wanted.ratio).abs(), candidate))
        })
        .collect();
    let mut nearest = solved.clone();
    nearest.sort_by(|a, b| a.0.total_cmp(&b.0));
    nearest.truncate(REFINED);
    let mut found: Vec<SizedLoop> = nearest
        .into_par_iter()
        .filter_map(|(_, candidate)| {
            let (candidate, now) = refine(wanted, candidate)?;
            sized(wanted, candidate, now)
        })
        .collect();
    progress(1.0);
    found.sort_by(|a, b| {
        let (a, b) = (a.rank(), b.rank());
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    (found, solved.len())
}
