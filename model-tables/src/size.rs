//! Sizing: a wanted force over the indentation, and bounds -> the membranes that come nearest, with what each costs.
//!
//! [`target`] (what is wanted) -> a search over materials, aspects and stretches, in which one solved press serves every
//! size and wall, because a membrane's force is proportional to modulus, wall and size -> least squares from the
//! best -> [`Sized`] designs, ranked.

pub mod target;

use crate::adapt::Resolution;
use crate::design::{Design, Membrane, RestBy};
use crate::material::Law;
use crate::material::preset::Preset;
use crate::membrane::TensionField;
use crate::press::{ModelError, Press, SWEEP};
use crate::state::Wrinkling;
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::storage::Owned;
use nalgebra::{DMatrix, DVector, Dyn, OVector, U4};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use target::Target;

/// Aspects, stretches and sizes of the search.
const GRID: [usize; 3] = [7, 8, 24];
/// Mesh of the search and of the refinement.
const MESH: Resolution = Resolution {
    density: 1.0,
    contact_elements: 1,
    tolerance: 1e-10,
    last_term: f64::INFINITY,
};
/// Indentations over the height at which a press of the search is solved; a press ends at about half the height.
const DEPTHS: [f64; 12] = [
    0.01, 0.02, 0.04, 0.065, 0.1, 0.14, 0.18, 0.23, 0.28, 0.33, 0.38, 0.44,
];
/// Points of a meridian at which the strain is looked at.
const STATIONS: usize = 21;
/// Indentation over the height at which a membrane of the search must be taut.
const TAUT_AT: f64 = 0.2;
/// Starts of each material that are refined.
const REFINED: usize = 4;
/// Dimensions closer than this, relative, are the same.
const SAME: f64 = 0.02;
/// Walls thicker than this part of the smaller semi-axis are no membranes.
const THICKEST: f64 = 0.3;
/// What a percent of uncertain force from making counts against a percent of misfit, when starts are chosen.
const MAKING: f64 = 0.1;
/// Misfits under this are as good as none: nobody makes a fingertip to a percent.
const GOOD: f64 = 0.01;
/// Step of the differences that stand for derivatives, in logarithms.
const STEP: f64 = 1e-4;
/// How hard a pressure beyond the range, or a strain beyond the tested one, counts.
const BEYOND: f64 = 10.0;
/// The pull towards the start among equals.
const PULL: f64 = 1e-4;

/// A membrane that was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Sized {
    /// Its material.
    pub material: &'static Preset,
    /// Everything the model needs.
    pub design: Design,
    /// Root mean square of the force's deviation from the target, relative.
    pub misfit: f64,
    /// Force at each indentation of the target, newtons.
    pub forces: Vec<f64>,
    /// Gauge pressure at rest, pascals.
    pub rest_pressure: f64,
    /// Gauge pressure at the deepest indentation of the target, pascals.
    pub peak_pressure: f64,
    /// Largest principal stretch at rest and pressed.
    pub largest_stretch: f64,
    /// Largest `I1 - 3` there over that up to which the material was tested; `None` where that is not known.
    pub strain_share: Option<f64>,
    /// Smallest tension at rest and pressed, newtons per metre.
    pub least_tension: f64,
    /// The worst zone.
    pub wrinkling: Wrinkling,
    /// The end of the press, metres.
    pub limit: f64,
    /// Largest relative change of force at the target's indentations for the tolerance in radial semi-axis, axial
    /// semi-axis, wall.
    pub by_tolerance: [f64; 3],
}

impl Sized {
    /// The three tolerances together, as independent ones.
    pub fn making(&self) -> f64 {
        libm::sqrt(self.by_tolerance.iter().map(|part| part * part).sum())
    }

    /// The end of the press over the deepest indentation of the target.
    pub fn limit_margin(&self, target: &Target) -> f64 {
        self.limit / target.deepest()
    }

    /// Whether it can be made and read: taut, its strain tested, its pressures in the range, its press deep enough.
    fn is_possible(&self, target: &Target) -> bool {
        self.wrinkling == Wrinkling::Taut
            && self.strain_share.is_none_or(|share| share < 1.05)
            && self.peak_pressure < 1.001e3 * target.range_kpa[1]
            && self.limit > target.deepest()
    }

    /// Whether another is the same design for all that counts.
    fn is_like(&self, other: &Self) -> bool {
        let of = |sized: &Self| {
            let membrane = sized.design.membrane;
            [
                membrane.radial_semi_axis,
                membrane.axial_semi_axis,
                membrane.thickness,
            ]
        };
        self.material.name == other.material.name
            && of(self)
                .iter()
                .zip(of(other))
                .all(|(a, b)| (a / b - 1.0).abs() < SAME)
    }

    /// What the ranking goes by: misfits of a percent count alike, and then the effect of making.
    fn rank(&self) -> (u64, f64) {
        let tier = libm::ceil(self.misfit.max(GOOD) / GOOD - 1e-9) as u64;
        (tier, self.making())
    }

    /// Whether nothing is worse than another's and something better: misfit, making, peak pressure.
    pub fn dominates(&self, other: &Self) -> bool {
        let of = |sized: &Self| [sized.misfit.max(GOOD), sized.making(), sized.peak_pressure];
        let (mine, theirs) = (of(self), of(other));
        mine.iter().zip(&theirs).all(|(a, b)| a <= b) && mine.iter().zip(&theirs).any(|(a, b)| a < b)
    }
}

/// What a sizing found.
#[derive(Clone, Debug, PartialEq)]
pub struct Sizing {
    /// Ranked, the best first.
    pub designs: Vec<Sized>,
    /// Presses that were solved.
    pub solved: usize,
}

/// Finds membranes for a target; `advance` is told the part that is done.
pub fn size(target: &Target, advance: &(dyn Fn(f64) + Sync)) -> Sizing {
    let shapes = grid(target);
    let done = AtomicUsize::new(0);
    let total = shapes.len() as f64;
    let mut starts: Vec<(f64, Start)> = shapes
        .par_iter()
        .filter_map(|&(material, aspect, stretch)| {
            let found = Shape::solve(target, material, aspect, stretch).and_then(|shape| shape.best(target));
            advance(0.6 * done.fetch_add(1, Ordering::Relaxed) as f64 / total);
            found
        })
        .collect();
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut chosen: Vec<Start> = Vec::new();
    for (_, start) in starts {
        let same = chosen
            .iter()
            .filter(|other| other.material.name == start.material.name)
            .count();
        if same < REFINED {
            chosen.push(start);
        }
    }
    let refined = AtomicUsize::new(0);
    let count = chosen.len().max(1) as f64;
    let mut designs: Vec<Sized> = chosen
        .par_iter()
        .filter_map(|start| {
            let found = judge(target, start.material, &refine(target, start)).ok();
            advance(0.6 + 0.4 * refined.fetch_add(1, Ordering::Relaxed) as f64 / count);
            found
        })
        .filter(|sized| sized.is_possible(target))
        .collect();
    designs.sort_by(|a, b| {
        let (a, b) = (a.rank(), b.rank());
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    let mut distinct: Vec<Sized> = Vec::new();
    for sized in designs {
        if !distinct.iter().any(|other| other.is_like(&sized)) {
            distinct.push(sized);
        }
    }
    Sizing {
        solved: shapes.len(),
        designs: distinct,
    }
}

/// Values from one end to the other, equally spaced in their logarithm.
fn spread([low, high]: [f64; 2], count: usize) -> Vec<f64> {
    if high <= low {
        return vec![low];
    }
    (0..count)
        .map(|k| low * libm::pow(high / low, k as f64 / (count - 1) as f64))
        .collect()
}

/// Materials, aspects and stretches of the search.
fn grid(target: &Target) -> Vec<(&'static Preset, f64, f64)> {
    let aspects = [
        target.axial[0] / target.radial[1],
        target.axial[1] / target.radial[0],
    ];
    let over_one = target.stretch.map(|stretch| stretch - 1.0);
    let mut shapes = Vec::new();
    for &material in &target.materials {
        for aspect in spread(aspects, GRID[0]) {
            for &over_one in &spread(over_one, GRID[1]) {
                shapes.push((material, aspect, 1.0 + over_one));
            }
        }
    }
    shapes
}

/// Where a refinement starts: metres.
#[derive(Clone, Copy, Debug)]
struct Start {
    material: &'static Preset,
    radial: f64,
    axial: f64,
    wall: f64,
    stretch: f64,
}

impl Start {
    fn logarithms(&self) -> [f64; 4] {
        [self.radial, self.axial, self.wall, self.stretch - 1.0].map(libm::log)
    }

    fn design(&self, target: &Target) -> Design {
        Design {
            membrane: Membrane {
                radial_semi_axis: self.radial,
                axial_semi_axis: self.axial,
                thickness: self.wall,
            },
            law: self.material.law,
            rest: RestBy::PoleStretch(self.stretch),
            compliance: 1e-12 * target.compliance_mm3_per_kpa,
        }
    }
}

/// A press of unit size and wall.
struct Shape {
    start: Start,
    /// Indentation, pressure, force.
    states: Vec<[f64; 3]>,
}

/// Radial semi-axis and wall of the search's presses, metres.
const UNIT: f64 = 1e-2;
const UNIT_WALL: f64 = 1e-3;

impl Shape {
    fn solve(target: &Target, material: &'static Preset, aspect: f64, stretch: f64) -> Option<Self> {
        let start = Start {
            material,
            radial: UNIT,
            axial: aspect * UNIT,
            wall: UNIT_WALL,
            stretch,
        };
        // The fluid's compliance belongs to a size; the refinement knows it.
        let design = Design {
            compliance: 0.0,
            ..start.design(target)
        };
        let mut press = Press::<Law, 4>::with_resolution(&design, TensionField::Relaxed, MESH).ok()?;
        let rest = *press.rest();
        if material
            .largest_invariant()
            .is_some_and(|most| invariant(&mut press, 0.0) > most)
        {
            return None;
        }
        let pressed = press.at_indentation(TAUT_AT * rest.height).ok()?;
        if pressed.shape.wrinkling != Wrinkling::Taut {
            return None;
        }
        let mut states = vec![[0.0, rest.pressure, 0.0]];
        for depth in DEPTHS {
            let Ok(contact) = press.contact_at(depth * rest.height) else {
                break;
            };
            states.push([
                contact.indentation,
                rest.pressure + contact.pressure_rise,
                contact.force,
            ]);
        }
        Some(Self { start, states })
    }

    /// Pressure and force of the unit press at an indentation of it: straight lines in logarithms.
    fn at(&self, indentation: f64) -> Option<[f64; 2]> {
        let after = self.states.iter().position(|state| state[0] >= indentation)?;
        if after < 2 {
            let [depth, pressure, force] = self.states[1];
            return Some([pressure, force * indentation / depth]);
        }
        let (a, b) = (self.states[after - 1], self.states[after]);
        let part = libm::log(indentation / a[0]) / libm::log(b[0] / a[0]);
        Some([a[1] + part * (b[1] - a[1]), a[2] * libm::pow(b[2] / a[2], part)])
    }

    /// The size and wall that come nearest to the target, and how near, making counted in.
    fn best(&self, target: &Target) -> Option<(f64, Start)> {
        let aspect = self.start.axial / UNIT;
        let sizes = [
            target.radial[0].max(target.axial[0] / aspect),
            target.radial[1].min(target.axial[1] / aspect),
        ];
        if sizes[0] > sizes[1] {
            return None;
        }
        spread(sizes, GRID[2])
            .into_iter()
            .filter_map(|radial| {
                let scale = radial / UNIT;
                let states: Vec<[f64; 2]> = target
                    .indentations
                    .iter()
                    .map(|depth| self.at(depth / scale))
                    .collect::<Option<_>>()?;
                // Force over the wanted one, for a wall of one unit.
                let ratios: Vec<f64> = states
                    .iter()
                    .zip(&target.forces)
                    .map(|(state, force)| scale * state[1] / force)
                    .collect();
                let pressure = states.last()?[0] / scale;
                let squares: f64 = ratios.iter().map(|ratio| ratio * ratio).sum();
                let wanted = ratios.iter().sum::<f64>() / squares;
                let most = (THICKEST * radial * aspect.min(1.0))
                    .min(target.wall[1])
                    .min(UNIT_WALL * 1e3 * target.range_kpa[1] / pressure);
                if most < target.wall[0] {
                    return None;
                }
                let wall = (wanted * UNIT_WALL).clamp(target.wall[0], most);
                let misfit = root_mean_square(ratios.iter().map(|ratio| ratio * wall / UNIT_WALL - 1.0));
                let start = Start {
                    radial,
                    axial: aspect * radial,
                    wall,
                    ..self.start
                };
                Some((misfit + MAKING * target.tolerance / wall, start))
            })
            .min_by(|a, b| a.0.total_cmp(&b.0))
    }
}

/// Largest `I1 - 3` at an indentation in metres; infinite where there is no such state.
fn invariant<const S: usize>(press: &mut Press<Law, S>, indentation: f64) -> f64 {
    press
        .profile(indentation, STATIONS)
        .map_or(f64::INFINITY, |meridian| {
            meridian
                .map(|point| {
                    let (a, b) = (point.meridional_stretch, point.hoop_stretch);
                    a * a + b * b + 1.0 / (a * a * b * b) - 3.0
                })
                .fold(0.0, f64::max)
        })
}

fn root_mean_square(values: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for value in values {
        sum += value * value;
        count += 1.0;
    }
    libm::sqrt(sum / count)
}

/// Pressure at the deepest indentation, largest `I1 - 3` at rest, and forces of a design.
fn pressed(target: &Target, design: &Design) -> Result<(f64, f64, Vec<f64>), ModelError> {
    let mut press = Press::<Law, 4>::with_resolution(design, TensionField::Relaxed, MESH)?;
    let strain = invariant(&mut press, 0.0);
    let rest = press.rest().pressure;
    let mut peak = rest;
    let mut forces = Vec::new();
    for &depth in &target.indentations {
        let contact = press.contact_at(depth)?;
        peak = rest + contact.pressure_rise;
        forces.push(contact.force);
    }
    Ok((peak, strain, forces))
}

/// Least squares from a start, within the bounds.
fn refine(target: &Target, start: &Start) -> Start {
    let problem = Refinement {
        target,
        start,
        at: OVector::from(start.logarithms()),
    };
    let (found, _) = LevenbergMarquardt::new()
        .with_ftol(1e-8)
        .with_xtol(1e-6)
        .with_patience(6)
        .minimize(problem);
    let refined = found.place(&found.at);
    // A place without a press is no answer.
    match pressed(target, &refined.design(target)) {
        Ok(_) => refined,
        Err(_) => *start,
    }
}

struct Refinement<'a> {
    target: &'a Target,
    start: &'a Start,
    at: OVector<f64, U4>,
}

impl Refinement<'_> {
    /// Held within the bounds.
    fn place(&self, at: &OVector<f64, U4>) -> Start {
        let target = self.target;
        let [radial, axial, wall, over_one] = [0, 1, 2, 3].map(|k| libm::exp(at[k]));
        let within = |value: f64, [low, high]: [f64; 2]| value.clamp(low, high);
        let (radial, axial) = (within(radial, target.radial), within(axial, target.axial));
        let thickest = (THICKEST * radial.min(axial)).max(target.wall[0]);
        Start {
            material: self.start.material,
            radial,
            axial,
            wall: within(wall, target.wall).min(thickest),
            stretch: within(1.0 + over_one, target.stretch),
        }
    }

    fn residuals_at(&self, at: &OVector<f64, U4>) -> DVector<f64> {
        let count = self.target.forces.len();
        let mut residuals = DVector::from_element(count + 6, 1e3);
        let design = self.place(at).design(self.target);
        if let Ok((peak, strain, forces)) = pressed(self.target, &design) {
            for (k, (force, wanted)) in forces.iter().zip(&self.target.forces).enumerate() {
                residuals[k] = force / wanted - 1.0;
            }
            let excess = peak / (1e3 * self.target.range_kpa[1]) - 1.0;
            residuals[count] = BEYOND * excess.max(0.0);
            let most = self.start.material.largest_invariant().unwrap_or(f64::INFINITY);
            residuals[count + 5] = BEYOND * (strain / most - 1.0).max(0.0);
            let from = self.start.logarithms();
            for k in 0..4 {
                residuals[count + 1 + k] = PULL * (at[k] - from[k]);
            }
        }
        residuals
    }
}

impl LeastSquaresProblem<f64, Dyn, U4> for Refinement<'_> {
    type ParameterStorage = Owned<f64, U4>;
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, U4>;

    fn set_params(&mut self, at: &OVector<f64, U4>) {
        self.at = *at;
    }

    fn params(&self) -> OVector<f64, U4> {
        self.at
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        Some(self.residuals_at(&self.at))
    }

    fn jacobian(&self) -> Option<nalgebra::OMatrix<f64, Dyn, U4>> {
        let here = self.residuals_at(&self.at);
        let mut jacobian = DMatrix::zeros(here.len(), 4);
        for k in 0..4 {
            let mut there = self.at;
            there[k] += STEP;
            jacobian.set_column(k, &((self.residuals_at(&there) - &here) / STEP));
        }
        Some(jacobian.fixed_columns::<4>(0).into_owned())
    }
}

/// Everything there is to say of a design.
fn judge(target: &Target, material: &'static Preset, start: &Start) -> Result<Sized, ModelError> {
    let design = start.design(target);
    let mut press = Press::<Law, 5>::with_resolution(&design, TensionField::Relaxed, SWEEP)?;
    let rest = *press.rest();
    let mut forces = Vec::new();
    let (mut stretch, mut strain) = (0.0_f64, 0.0_f64);
    let (mut tension, mut wrinkling) = (rest.least_tension(), rest.wrinkling);
    let mut peak = rest.pressure;
    for depth in [0.0].into_iter().chain(target.indentations.iter().copied()) {
        let state = press.at_indentation(depth)?;
        if depth > 0.0 {
            forces.push(state.force);
        }
        peak = state.shape.pressure;
        tension = tension.min(state.shape.least_tension());
        wrinkling = wrinkling.max(state.shape.wrinkling);
        strain = strain.max(invariant(&mut press, depth));
        for point in press.profile(depth, STATIONS)? {
            stretch = stretch.max(point.meridional_stretch).max(point.hoop_stretch);
        }
    }
    let misfit = root_mean_square(
        forces
            .iter()
            .zip(&target.forces)
            .map(|(force, wanted)| force / wanted - 1.0),
    );
    let limit = press.limit()?.indentation;
    let mut by_tolerance = [0.0; 3];
    for (k, effect) in by_tolerance.iter_mut().enumerate() {
        let mut changed = design;
        match k {
            0 => changed.membrane.radial_semi_axis += target.tolerance,
            1 => changed.membrane.axial_semi_axis += target.tolerance,
            _ => changed.membrane.thickness += target.tolerance,
        }
        let (_, _, other) = pressed(target, &changed)?;
        *effect = other
            .iter()
            .zip(&forces)
            .map(|(other, force)| (other / force - 1.0).abs())
            .fold(0.0, f64::max);
    }
    Ok(Sized {
        material,
        design,
        misfit,
        forces,
        rest_pressure: rest.pressure,
        peak_pressure: peak,
        largest_stretch: stretch,
        strain_share: material.largest_invariant().map(|most| strain / most),
        least_tension: tension,
        wrinkling,
        limit,
        by_tolerance,
    })
}
