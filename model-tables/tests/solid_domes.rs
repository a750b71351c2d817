//! The solid's two coarse fidelities over domes of many shapes, walls and laws, against the same model refined.

use model_tables::design::{Design, Membrane, RestBy};
use model_tables::material::Law;
use model_tables::material::preset::{AGILUS30, SKIN};
use model_tables::object::Object;
use model_tables::solid::mesh::Elements;
use model_tables::solid::press::{COARSE, FULL, Press};

/// Indentations over the height, those of the independent reference states.
const PARTS: [f64; 10] = [
    0.036, 0.071, 0.107, 0.143, 0.179, 0.214, 0.25, 0.286, 0.357, 0.429,
];
const REFINED: Elements = Elements {
    through: 3,
    along: 72,
};

const SOFT: Law = Law::NeoHookean { c1: 100e3 };
const STIFFENING: Law = Law::Yeoh {
    c1: 120e3,
    c2: 15e3,
    c3: 4e3,
};
const DRAGON_SKIN: Law = Law::Yeoh {
    c1: 20_400.0,
    c2: 4_470.0,
    c3: 0.0,
};

/// As a silicone's first percents are.
const SOFTENING: Law = Law::Yeoh {
    c1: 120e3,
    c2: -10e3,
    c3: 2e3,
};

/// So much that a shear stress all but stops growing.
const SOFTENING_MUCH: Law = Law::Yeoh {
    c1: 120e3,
    c2: -60e3,
    c3: 20e3,
};

/// Outer semi-axes and wall in millimetres, and the law.
const DOMES: [([f64; 3], Law); 20] = [
    ([9.0, 7.0, 0.3], SOFT),
    ([9.0, 7.0, 0.8], AGILUS30),
    ([9.0, 7.0, 1.2], AGILUS30),
    ([9.0, 7.0, 1.0], SKIN),
    ([9.0, 9.0, 0.8], STIFFENING),
    ([6.0, 6.0, 0.5], AGILUS30),
    ([6.0, 6.0, 0.8], DRAGON_SKIN),
    ([9.0, 7.0, 0.8], SOFTENING),
    ([9.0, 7.0, 0.8], SOFTENING_MUCH),
    ([12.0, 8.0, 0.5], SOFTENING_MUCH),
    ([12.0, 8.0, 0.5], AGILUS30),
    ([12.0, 8.0, 1.2], SOFT),
    ([15.0, 12.0, 1.5], SKIN),
    ([8.0, 5.0, 0.5], STIFFENING),
    ([5.0, 4.0, 0.4], DRAGON_SKIN),
    ([9.0, 7.0, 1.5], STIFFENING),
    ([12.0, 8.0, 0.3], SOFT),
    ([7.0, 10.0, 0.5], AGILUS30),
    ([7.0, 10.0, 1.0], SOFT),
    ([5.0, 5.0, 1.0], AGILUS30),
];

fn forces(dome: &([f64; 3], Law), elements: Elements) -> [[f64; 2]; PARTS.len()] {
    let [radial, axial, thickness] = dome.0.map(|x| x * 1e-3);
    let design = Design {
        membrane: Membrane {
            radial_semi_axis: radial,
            axial_semi_axis: axial,
            thickness,
        },
        law: dome.1,
        rest: RestBy::Unstretched,
        compliance: 0.0,
        object: Object::PLATE,
    };
    let mut press = Press::new(&design, elements).expect("a rest state");
    PARTS.map(|part| {
        let contact = press.contact_at(part * axial).unwrap_or_else(|error| {
            panic!("{:?} {elements:?} at {part}: {error}", dome.0);
        });
        [contact.pressure_rise, contact.force]
    })
}

/// Walls up to a fifth of the outer radius: no state fails, and pressure and force are within 2 % with one element through the wall, within 1 % with two, at every indentation.
#[test]
fn coarse_solids_keep_their_word_over_shapes_walls_and_laws() {
    for dome in &DOMES {
        let truth = forces(dome, REFINED);
        for (elements, allowed) in [(COARSE, 0.02), (FULL, 0.01)] {
            let found = forces(dome, elements);
            for (i, (found, truth)) in found.iter().zip(&truth).enumerate() {
                for quantity in 0..2 {
                    let error = found[quantity] / truth[quantity] - 1.0;
                    assert!(
                        error.abs() < allowed,
                        "{:?} {elements:?} at {}: {:?} {error:+.4}",
                        dome.0,
                        PARTS[i],
                        ["pressure", "force"][quantity]
                    );
                }
            }
        }
    }
}
