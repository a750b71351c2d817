//! Designs the tests share.

use model_tables::design::{Design, Membrane, RestBy};
use model_tables::material::Law;
use model_tables::object::Object;

pub(crate) use model_tables::material::preset::AGILUS30;

/// A design in millimetres, rest by pole stretch, rigid fluid path.
pub(crate) fn design(radial: f64, axial: f64, thickness: f64, law: Law, pole_stretch: f64) -> Design {
    Design {
        membrane: Membrane {
            radial_semi_axis: radial * 1e-3,
            axial_semi_axis: axial * 1e-3,
            thickness: thickness * 1e-3,
        },
        law,
        rest: RestBy::PoleStretch(pole_stretch),
        compliance: 0.0,
        object: Object::PLATE,
    }
}
