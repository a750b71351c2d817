//! Solids inflated with their rim held, and pressed from there.

mod domes;

use domes::dome;
use model_tables::design::{Design, RestBy};
use model_tables::material::Law;
use model_tables::material::preset::{AGILUS30, SKIN};
use model_tables::model::ModelError;
use model_tables::solid::SolidError;
use model_tables::solid::mesh::Elements;
use model_tables::solid::press::{COARSE, FULL, Press};

/// Inflated with the rim held and then pressed: both coarse meshes against a finer one, pressure from 1 % of its deepest rise on; and
/// however it was inflated, the plate's work is the energy stored.
#[test]
fn inflated_walls_press_like_refined_ones() {
    let fine = Elements {
        through: 3,
        along: 72,
    };
    for (design, pressure) in [
        (dome(9.0, 7.0, 1.0, AGILUS30), 20e3),
        (dome(9.0, 7.0, 0.5, Law::NeoHookean { c1: 100e3 }), 8e3),
        (dome(6.0, 6.0, 0.8, SKIN), 3e3),
    ] {
        let design = Design {
            rest: RestBy::Pressure(pressure),
            ..design
        };
        let height = design.membrane.axial_semi_axis;
        let depths = [0.036, 0.107, 0.214, 0.3].map(|part| part * height);
        let states = |elements| {
            let mut press = Press::new(&design, elements).expect("a rest state");
            assert!((press.rest().pressure / pressure - 1.0).abs() < 1e-9);
            assert!(press.rest().height > height && press.rest().pole_stretch > 1.02);
            depths.map(|depth| press.contact_at(depth).expect("a state"))
        };
        let truth = states(fine);
        for (elements, allowed) in [(COARSE, 0.02), (FULL, 0.01)] {
            for (found, truth) in states(elements).iter().zip(&truth) {
                let force = (found.force / truth.force - 1.0).abs();
                let rise = (found.pressure_rise / truth.pressure_rise - 1.0).abs();
                assert!(
                    force < allowed && rise < allowed,
                    "{design:?} {elements:?}: {found:?} {truth:?}"
                );
            }
        }
    }
    let design = Design {
        rest: RestBy::Pressure(20e3),
        ..dome(9.0, 7.0, 1.0, AGILUS30)
    };
    let mut press = Press::new(&design, FULL).expect("a rest state");
    let [below, middle, above] =
        [-2e-6, 0.0, 2e-6].map(|by| press.at_indentation(1e-3 + by).expect("a state"));
    let work = (above.energy - below.energy - middle.pressure * (above.volume - below.volume)) / 4e-6;
    assert!(
        (work / middle.force - 1.0).abs() < 1e-5,
        "{work} {}",
        middle.force
    );
}

/// A thin wall inflated far with its rim held: away from the rim a membrane, whose tension at the pole carries the pressure,
/// `2 T k = P` with the curvature `k` of its middle, and whose stretches give that tension by the law.
#[test]
fn a_thin_inflated_wall_carries_its_pressure_as_a_membrane() {
    let (c1, pressure) = (100e3, 3e3);
    let design = Design {
        rest: RestBy::Pressure(pressure),
        ..dome(9.0, 7.0, 0.1, Law::NeoHookean { c1 })
    };
    let fine = Elements {
        through: 2,
        along: 60,
    };
    let mut press = Press::new(&design, fine).expect("a rest state");
    let stations = press.profile(0.0, 721).expect("a profile");
    let (pole, beside) = (stations[0], stations[8]);
    let stretch = pole.meridional_stretch;
    assert!(stretch > 1.05, "{stretch}");
    // Equal stretches: T = 2 C1 h (1 - l^-6), per deformed length.
    let tension = 2.0 * c1 * 0.1e-3 * (1.0 - stretch.powi(-6));
    assert!(
        (pole.meridional_tension / tension - 1.0).abs() < 0.01,
        "{pole:?} {tension}"
    );
    // The angle of the tangent over the arc is the curvature.
    let curvature = beside.angle.sin() / beside.radius;
    assert!(
        (2.0 * tension * curvature / pressure - 1.0).abs() < 0.01,
        "{tension} {curvature}"
    );
}

/// A neo-Hookean dome has a greatest pressure; asked for more, it says which.
#[test]
fn a_rest_pressure_out_of_reach_is_refused() {
    let law = Law::NeoHookean { c1: 100e3 };
    let design = |pressure| Design {
        rest: RestBy::Pressure(pressure),
        ..dome(9.0, 9.0, 0.5, law)
    };
    let Err(ModelError::Solid(SolidError::PressureOutOfReach { greatest, .. })) =
        Press::new(&design(1e6), COARSE)
    else {
        panic!("no rest state has that pressure");
    };
    let within = Press::new(&design(0.95 * greatest), COARSE).expect("a rest state");
    assert!((within.rest().pressure / (0.95 * greatest) - 1.0).abs() < 1e-9);
    assert!(Press::new(&design(1.01 * greatest), COARSE).is_err());
    let stretched = Design {
        rest: RestBy::Height(8e-3),
        ..dome(9.0, 7.0, 1.0, AGILUS30)
    };
    assert!(matches!(
        Press::new(&stretched, COARSE),
        Err(ModelError::Solid(SolidError::RestNotForSolid))
    ));
}
