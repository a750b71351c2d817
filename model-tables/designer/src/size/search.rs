//! The search: materials, aspects and stretches, each pressed once at unit size and wall and scaled to whatever size and wall comes
//! nearest to the target.

use super::target::Target;
use super::{FILLED, MESH, Start, THICKEST, invariant, root_mean_square};
use model_tables::design::Design;
use model_tables::material::Law;
use model_tables::material::preset::Preset;
use model_tables::membrane::TensionField;
use model_tables::membrane::press::Press;
use model_tables::membrane::state::Wrinkling;

/// Aspects, stretches and sizes of the search.
const GRID: [usize; 3] = [7, 8, 24];
/// Indentations over the height at which a press of the search is solved; a press ends at about half the height.
const DEPTHS: [f64; 12] = [
    0.01, 0.02, 0.04, 0.065, 0.1, 0.14, 0.18, 0.23, 0.28, 0.33, 0.38, 0.44,
];
/// Indentation over the height at which a membrane of the search must be taut.
const TAUT_AT: f64 = 0.2;
/// What a percent of uncertain force from making counts against a percent of misfit, when starts are chosen.
const MAKING: f64 = 0.1;

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
pub(super) fn grid(target: &Target) -> Vec<(&'static Preset, f64, f64)> {
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

/// The size and wall of an aspect and a stretch that come nearest to the target, and how near, making counted in; `None` where that
/// membrane is no design.
pub(super) fn best(
    target: &Target,
    material: &'static Preset,
    aspect: f64,
    stretch: f64,
) -> Option<(f64, Start)> {
    Shape::solve(target, material, aspect, stretch)?.best(target)
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
                    .min(UNIT_WALL * FILLED * 1e3 * target.range_kpa[1] / pressure);
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
