//! Sizing: a wanted force over the indentation, and bounds -> the membranes that come nearest, with what each costs.
//!
//! [`target`] (what is wanted) -> a search over materials, aspects and stretches, in which one solved press covers every
//! size and wall, because a membrane's force is proportional to modulus, wall and size -> least squares from the
//! best -> [`Sized`] designs, ranked -> [`confirm`] (the model that each wall needs, and its tables).
//!
//! [`question`] is the same from a buyer's side: lightest touch, greatest force, rate -> designs with a transducer.
//! [`transmission`] sizes fingertip and feedback actuator together.

pub mod confirm;
pub mod question;
mod refine;
mod search;
pub mod target;
pub mod transmission;
mod written;

use model_tables::design::{Design, Membrane, RestBy};
use model_tables::material::Law;
use model_tables::material::preset::Preset;
use model_tables::membrane::TensionField;
use model_tables::membrane::adapt::Resolution;
use model_tables::membrane::press::{MembraneError, Press, SWEEP};
use model_tables::membrane::state::Wrinkling;
use model_tables::object::Object;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use target::Target;

/// Mesh of the search and of the refinement.
const MESH: Resolution = Resolution {
    density: 1.0,
    contact_elements: 1,
    tolerance: 1e-10,
    last_term: f64::INFINITY,
};
/// Points of a meridian at which the strain is looked at.
const STATIONS: usize = 21;
/// Starts of each material that are refined.
const REFINED: usize = 4;
/// Dimensions closer than this, relative, are the same.
const SAME: f64 = 0.02;
/// Walls thicker than this part of the smaller semi-axis are no membranes.
const THICKEST: f64 = 0.3;
/// The part of the transducer's range that a press may fill: the model that a wall needs may be a few percent off the membrane.
const FILLED: f64 = 0.96;
/// Misfits under this are as good as none: nobody makes a fingertip to a percent.
const GOOD: f64 = 0.01;

/// Why there is no design, with the remedy.
pub const NOTHING_FOUND: &str = "no membrane within the bounds can be pressed that deep while it is taut, its material's strain tested and \
     its pressure in the transducer's range: widen `[bounds]`, or take another range or material";

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
            && self.peak_pressure < 1e3 * target.range_kpa[1]
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
    pub fn rank(&self) -> (u64, f64) {
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
    let shapes = search::grid(target);
    let done = AtomicUsize::new(0);
    let total = shapes.len() as f64;
    let mut starts: Vec<(f64, Start)> = shapes
        .par_iter()
        .filter_map(|&(material, aspect, stretch)| {
            let found = search::best(target, material, aspect, stretch);
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
            // Least squares knows nothing of wrinkles: where it leads into them, its start still is a design.
            let found = [refine::refine(target, start), *start]
                .iter()
                .filter_map(|place| judge(target, start.material, place).ok())
                .find(|sized| sized.is_possible(target));
            advance(0.6 + 0.4 * refined.fetch_add(1, Ordering::Relaxed) as f64 / count);
            found
        })
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
            object: Object::PLATE,
        }
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
fn pressed(target: &Target, design: &Design) -> Result<(f64, f64, Vec<f64>), MembraneError> {
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

/// Everything there is to say of a design.
fn judge(target: &Target, material: &'static Preset, start: &Start) -> Result<Sized, MembraneError> {
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
    let limit = match press.limit() {
        Ok(limit) => limit.indentation,
        // A law with `C3 < 0` loses its stability before the press ends: that deep it goes.
        Err(MembraneError::PressUnsolved { reached, .. }) => reached,
        Err(error) => return Err(error),
    };
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
