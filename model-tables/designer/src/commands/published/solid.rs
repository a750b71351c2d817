//! The membrane beside a solid dome with a real wall.

use super::shipped;
use model_tables::curve::{Contact, CurveFailure};
use model_tables::design::{Design, Membrane, RestBy};
use model_tables::material::preset::AGILUS30;
use model_tables::membrane::TensionField;
use model_tables::membrane::press::Press;
use model_tables::model::Fingertip;
use model_tables::model::ModelError;
use model_tables::object::Object;
use output::Refusal;

/// A pressed dome of solid finite elements.
#[derive(Clone, Copy)]
pub(in crate::commands) struct Pressed {
    /// Indentation, metres.
    pub(in crate::commands) indentation: f64,
    /// Gauge pressure, pascals; it starts from 0.
    pub(in crate::commands) pressure: f64,
    /// Force, newtons.
    pub(in crate::commands) force: f64,
}

const fn pressed(indentation_mm: f64, pressure_kpa: f64, force: f64) -> Pressed {
    Pressed {
        indentation: indentation_mm * 1e-3,
        pressure: pressure_kpa * 1e3,
        force,
    }
}

/// Axisymmetric solid finite elements (quadratic displacement, discontinuous linear pressure, 80 x 4 elements; mesh
/// and penalty error about 0.1 %) of a dome of 9 x 7 mm outside with a wall of 1 mm: Agilus30, not stretched at
/// rest, clamped at the equator, filled with a rigid fluid, pressed by a plate without friction.
pub(in crate::commands) const SOLID: [Pressed; 12] = [
    pressed(0.25, 0.671, 0.0764),
    pressed(0.5, 1.790, 0.1800),
    pressed(0.75, 3.69, 0.348),
    pressed(1.0, 6.74, 0.639),
    pressed(1.25, 11.41, 1.144),
    pressed(1.5, 18.27, 2.008),
    pressed(1.75, 28.03, 3.443),
    pressed(2.0, 41.5, 5.754),
    pressed(2.25, 59.6, 9.338),
    pressed(2.5, 82.9, 14.65),
    pressed(2.75, 111.4, 22.08),
    pressed(3.0, 144.3, 31.75),
];
/// Radius of the solid's contact at 0.5 mm, metres.
pub(super) const SOLID_CONTACT_RADIUS: f64 = 1.77e-3;
/// Force of the solid at 2 mm with [`COMPLIANCE`] beside it, newtons.
pub(super) const SOLID_COMPLIANT_FORCE: f64 = 2.41;
/// A compliance of tubing and bubbles, cubic metres per pascal.
pub(super) const COMPLIANCE: f64 = 4e-12;
/// Mid-surface and wall of the solid.
const MID_SURFACE: Membrane = Membrane {
    radial_semi_axis: 8.5e-3,
    axial_semi_axis: 6.5e-3,
    thickness: 1e-3,
};
/// Pole stretch that leaves the membrane all but unstretched at rest.
pub(super) const UNSTRETCHED: f64 = 1.002;

/// Pole stretch that stands in for bending nearest to a light touch.
pub(super) const STRETCHED: f64 = 1.02;

/// The membrane at the indentations of the solid.
pub(super) struct Beside {
    /// Pole stretch at rest.
    pub(super) pole_stretch: f64,
    /// Rest pressure, pascals.
    pub(super) rest_pressure: f64,
    /// Pressure (pascals) and force (newtons) at each indentation.
    pub(super) states: Vec<(f64, f64)>,
    /// Force at 2 mm with [`COMPLIANCE`], newtons.
    pub(super) compliant_force: f64,
}

/// Everything the page says about the solid dome.
pub(super) struct Solid {
    /// The membrane all but unstretched at rest.
    pub(super) unstretched: Beside,
    /// The membrane with the stretch that stands in best for bending.
    pub(super) stretched: Beside,
    /// What that membrane, and the shipped index fingertip, read off the solid's pressure; `None` beyond the deepest
    /// indentation.
    pub(super) readings: Vec<[Option<Contact>; 2]>,
    /// That indentation, metres.
    pub(super) deepest: f64,
}

impl Solid {
    /// Solves both membranes at the solid's indentations.
    pub(super) fn solve() -> Result<Self, Refusal> {
        let file = shipped(
            "index-fingertip-elastic.toml",
            include_str!(concat!(
                env!("CARGO_MANIFEST_DIR"),
                "/../designs/index-fingertip-elastic.toml"
            )),
        )?;
        let membrane = |stretch| Design {
            membrane: MID_SURFACE,
            law: AGILUS30,
            rest: RestBy::PoleStretch(stretch),
            compliance: 0.0,
            object: Object::PLATE,
        };
        let (unstretched, stretched) = (membrane(UNSTRETCHED), membrane(STRETCHED));
        let deepest = file.max_indentation_mm.ok_or_else(|| {
            Refusal("the index fingertip has no press.max_indentation_mm; add it".to_owned())
        })? * 1e-3;
        let curves = [
            Press::new(&stretched, TensionField::Relaxed)
                .map_err(failed)?
                .curve(deepest)
                .map_err(CurveFailure::of),
            Fingertip::new(&file).map_err(failed)?.curve(deepest),
        ];
        let [before, after] =
            curves.map(|curve| curve.map_err(|error| Refusal(format!("the index fingertip: {error}"))));
        let curves = [before?, after?];
        let readings = SOLID
            .iter()
            .map(|solid| {
                curves.each_ref().map(|curve| {
                    let within = solid.pressure <= curve.end().pressure_rise;
                    within.then(|| curve.at_pressure_rise(solid.pressure))
                })
            })
            .collect();
        Ok(Self {
            unstretched: beside(&unstretched)?,
            stretched: beside(&stretched)?,
            readings,
            deepest,
        })
    }
}

fn failed(error: impl Into<ModelError>) -> Refusal {
    Refusal(format!("the membrane beside the solid dome: {}", error.into()))
}

fn beside(design: &Design) -> Result<Beside, Refusal> {
    let mut press = Press::new(design, TensionField::Relaxed).map_err(failed)?;
    let mut states = Vec::new();
    for solid in SOLID {
        let state = press.at_indentation(solid.indentation).map_err(failed)?;
        states.push((state.shape.pressure, state.force));
    }
    let compliant = Design {
        compliance: COMPLIANCE,
        ..*design
    };
    let compliant_force = Press::new(&compliant, TensionField::Relaxed)
        .and_then(|mut press| press.at_indentation(2e-3))
        .map_err(failed)?
        .force;
    Ok(Beside {
        pole_stretch: press.rest().pole_stretch,
        rest_pressure: press.rest().pressure,
        states,
        compliant_force,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The distances an independent membrane solution found, to the percent it was given with.
    #[test]
    fn the_unstretched_membrane_is_as_far_off_as_an_independent_solution_was() {
        let solid = Solid::solve().unwrap_or_else(|Refusal(reason)| panic!("{reason}"));
        let off = |i: usize| 100.0 * (solid.unstretched.states[i].1 / SOLID[i].force - 1.0);
        assert!((off(1) + 64.0).abs() < 0.6, "{}", off(1));
        assert!((off(7) + 24.0).abs() < 0.6, "{}", off(7));
        assert!(off(11).abs() < 1.0, "{}", off(11));
    }
}
