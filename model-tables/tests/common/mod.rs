//! Designs the tests share.

use model_tables::design::{Design, Membrane, RestBy};
use model_tables::material::Law;

/// Agilus30 as the source paper gives it.
pub(crate) const AGILUS30: Law = Law::MooneyRivlin {
    c1: 160_355.0,
    c2: 46_559.0,
};

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
    }
}
