//! Domes that the tests of the solid share.

use model_tables::design::{Design, Membrane, RestBy};
use model_tables::material::Law;
use model_tables::object::Object;

/// An unstretched solid in millimetres.
pub(crate) fn dome(radial: f64, axial: f64, thickness: f64, law: Law) -> Design {
    Design {
        membrane: Membrane {
            radial_semi_axis: radial * 1e-3,
            axial_semi_axis: axial * 1e-3,
            thickness: thickness * 1e-3,
        },
        law,
        rest: RestBy::Unstretched,
        compliance: 0.0,
        object: Object::PLATE,
    }
}
