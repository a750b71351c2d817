//! Objects other than a plate against the solid: independent reference states, energy, limits of the shapes, refusals.

mod domes;

use domes::dome;
use model_tables::design::Design;
use model_tables::material::Law;
use model_tables::material::preset::AGILUS30;
use model_tables::model::ModelError;
use model_tables::object::{Friction, Object, Shape};
use model_tables::solid::SolidError;
use model_tables::solid::mesh::Elements;
use model_tables::solid::press::{FULL, Press, PressedState};
use serde::Deserialize;

const FINE: Elements = Elements {
    through: 2,
    along: 60,
};

#[derive(Deserialize)]
struct Reference {
    dome: Dome,
    material: Constants,
    cases: Vec<Case>,
}

#[derive(Deserialize)]
#[expect(clippy::struct_field_names, reason = "the names in the file")]
struct Dome {
    radial_mm: f64,
    axial_mm: f64,
    wall_mm: f64,
}

#[derive(Deserialize)]
struct Constants {
    c1_pa: f64,
    c2_pa: f64,
}

#[derive(Deserialize)]
struct Case {
    object: Touched,
    points: Vec<Point>,
}

#[derive(Deserialize)]
struct Touched {
    radius_mm: Option<f64>,
}

#[derive(Deserialize)]
#[expect(non_snake_case, reason = "the names in the file")]
struct Point {
    H_mm: f64,
    P_kPa: f64,
    F_N: f64,
    strain_energy_mJ: f64,
}

fn frictionless(shape: Shape) -> Object {
    Object {
        shape,
        friction: Friction::NONE,
    }
}

fn ball(radius_mm: f64) -> Object {
    frictionless(Shape::Ball {
        radius: 1e-3 * radius_mm,
    })
}

fn cup(radius_mm: f64) -> Object {
    frictionless(Shape::Cup {
        radius: 1e-3 * radius_mm,
    })
}

fn punch(radius_mm: f64, rim_mm: f64) -> Object {
    frictionless(Shape::Punch {
        radius: 1e-3 * radius_mm,
        rim: 1e-3 * rim_mm,
    })
}

/// The printed dome, 9 x 7 x 1 mm, against an object.
fn printed(object: &Object, elements: Elements) -> Result<Press, ModelError> {
    Press::new(&touching(dome(9.0, 7.0, 1.0, AGILUS30), object), elements)
}

fn touching(design: Design, object: &Object) -> Design {
    Design {
        object: *object,
        ..design
    }
}

/// States at depths in millimetres.
fn states<const N: usize>(object: &Object, elements: Elements, depths_mm: [f64; N]) -> [PressedState; N] {
    let mut press = printed(object, elements).expect("an object");
    depths_mm.map(|depth| press.at_indentation(1e-3 * depth).expect("a state"))
}

/// Every state of the independent solution, with what its pressure and force, and its energy, may be off by indentation.
fn agrees(elements: Elements, allowed: impl Fn(f64) -> f64) {
    let Reference {
        dome: outer,
        material,
        cases,
    } = serde_json::from_str(include_str!("reference/object.json")).expect("the file's form");
    assert!(cases.len() >= 4);
    let law = Law::MooneyRivlin {
        c1: material.c1_pa,
        c2: material.c2_pa,
    };
    let design = dome(outer.radial_mm, outer.axial_mm, outer.wall_mm, law);
    for case in cases {
        let object = case.object.radius_mm.map_or(Object::PLATE, ball);
        let mut press = Press::new(&touching(design, &object), elements).expect("a ball");
        for point in case.points {
            let found = press.at_indentation(point.H_mm * 1e-3).expect("a state");
            let pressure = found.pressure / (point.P_kPa * 1e3) - 1.0;
            let force = found.force / point.F_N - 1.0;
            let energy = found.energy / (point.strain_energy_mJ * 1e-3) - 1.0;
            let name = format!(
                "{object:?} at {} mm: {pressure:+.5} {force:+.5} {energy:+.5}",
                point.H_mm
            );
            println!("{name}");
            let allowed = allowed(point.H_mm);
            assert!(pressure.abs() < allowed && force.abs() < allowed, "{name}");
            assert!(energy.abs() < allowed + 0.003, "{name}");
        }
    }
}

#[test]
fn sixty_elements_along_agree_with_reference_balls_within_half_a_percent() {
    agrees(FINE, |_| 0.005);
}

#[test]
fn twenty_four_elements_along_agree_with_reference_balls_within_a_percent() {
    agrees(FULL, |depth| if depth < 0.5 { 0.02 } else { 0.01 });
}

/// Strain energy against the work of object and fluid along the path.
#[test]
fn energy_closes_against_every_object() {
    for object in [ball(3.0), ball(20.0), cup(20.0), punch(3.0, 0.3)] {
        for state in states(&object, FULL, [0.3, 1.0, 1.8]) {
            let part = state.energy / state.work - 1.0;
            assert!(part.abs() < 2e-3, "{object:?} {}: {part:e}", state.indentation);
        }
    }
}

/// A ball dips in less than a plate at one depth, a cup more; either goes to the plate with its radius.
#[test]
fn balls_and_cups_meet_at_the_plate() {
    let force = |object: &Object| states(object, FULL, [1.5])[0].force;
    let plate = force(&Object::PLATE);
    let mut before = 0.0;
    for radius in [3.0, 8.0, 50.0, 1e5] {
        let found = force(&ball(radius));
        assert!(
            found > before && found < plate * (1.0 + 1e-5),
            "{radius}: {found} {plate}"
        );
        before = found;
    }
    let mut before = f64::INFINITY;
    for radius in [20.0, 50.0, 1e5] {
        let found = force(&cup(radius));
        assert!(
            found < before && found > plate * (1.0 - 1e-5),
            "{radius}: {found} {plate}"
        );
        before = found;
    }
    assert!((before / plate - 1.0).abs() < 5e-4);
}

/// A coin is a plate until its rim is reached; then it is less than one.
#[test]
fn a_punch_is_a_plate_up_to_its_rim() {
    let [before, after] = states(&punch(5.0, 0.2), FULL, [1.0, 2.0]);
    let [plate_before, plate_after] = states(&Object::PLATE, FULL, [1.0, 2.0]);
    assert!(before.contact_radius < 4e-3);
    assert!((before.force / plate_before.force - 1.0).abs() < 1e-6);
    assert!(after.force < 0.97 * plate_after.force);
    assert!(after.contact_radius < 5e-3 && plate_after.contact_radius > 5e-3);
}

#[test]
fn what_cannot_be_pressed_is_refused_by_name() {
    let pen = frictionless(Shape::Cylinder { radius: 5e-3 });
    let text = printed(&pen, FULL).expect_err("no axial symmetry").to_string();
    assert!(
        text.contains("object.shape = \"cylinder\" has no axial symmetry"),
        "{text}"
    );
    // The crown's radius of curvature is 81 / 7 mm.
    let error = printed(&cup(11.0), FULL).expect_err("too tight");
    let ModelError::Solid(SolidError::CupTooTight { least, .. }) = error else {
        panic!("{error}");
    };
    assert!((least - 81e-3 / 7.0).abs() < 2e-5, "{least}");
    assert!(printed(&cup(11.6), FULL).is_ok());
}

/// Newton iterations and factorisations of a press onto a ball, over those onto a plate.
#[test]
fn a_ball_costs_little_more_than_a_plate() {
    let cost = |object: &Object| {
        let mut press = printed(object, FULL).expect("an object");
        press.contact_at(2.0e-3).expect("a state");
        (press.iterations() as f64, press.factorisations() as f64)
    };
    let (plate, ball) = (cost(&Object::PLATE), cost(&ball(8.0)));
    println!("{plate:?} {ball:?}");
    assert!(
        ball.0 < 1.3 * plate.0 && ball.1 < 1.3 * plate.1,
        "{plate:?} {ball:?}"
    );
}

/// A plate with a coefficient of friction, and one that sticks.
fn rough(friction: Friction) -> Object {
    Object {
        friction,
        ..Object::PLATE
    }
}

/// What a table of the frictionless plate reports too much at one pressure, by an independent solution: percent, by kilopascals, for a
/// coefficient of 0.3.
const FRICTION: [(f64, f64); 5] = [(5.0, -3.0), (10.0, -2.8), (30.0, 0.6), (50.0, 3.7), (80.0, 7.1)];

/// Pressure (kilopascals) and force by indentation, on a grid of 0.05 mm down to 3 mm.
fn press_on(object: &Object, elements: Elements) -> Vec<[f64; 2]> {
    let mut press = printed(object, elements).expect("an object");
    (0..=60)
        .map(|k| {
            let state = press.at_indentation(5e-5 * f64::from(k)).expect("a state");
            [1e-3 * state.pressure, state.force]
        })
        .collect()
}

/// The force at a pressure, between states of a press by its logarithm.
fn force_at(states: &[[f64; 2]], pressure: f64) -> f64 {
    let after = states
        .iter()
        .position(|state| state[0] > pressure)
        .expect("pressed as far");
    let ([p0, f0], [p1, f1]) = (states[after - 1], states[after]);
    let part = (pressure / p0).ln() / (p1 / p0).ln();
    f0 * (f1 / f0).powf(part)
}

#[test]
fn friction_changes_force_and_pressure_as_an_independent_solution_has_it() {
    let [smooth, rubbing, stuck] =
        [Friction::NONE, Friction::Coulomb(0.3), Friction::Stick].map(|law| press_on(&rough(law), FULL));
    for (pressure, percent) in FRICTION {
        let found = 100.0 * (force_at(&smooth, pressure) / force_at(&rubbing, pressure) - 1.0);
        println!("{pressure} kPa: {found:+.2} % ({percent:+.1})");
        assert!((found - percent).abs() < 0.6, "{pressure}: {found} {percent}");
    }
    // Pressure at one indentation: 13 % more at 2.5 mm, 26 % at 3 mm, and about the same when it sticks.
    for (k, percent) in [(50, 13.0), (60, 26.0)] {
        for states in [&rubbing, &stuck] {
            let found = 100.0 * (states[k][0] / smooth[k][0] - 1.0);
            println!("{k}: {found:+.2} % ({percent:+.1})");
            assert!((found - percent).abs() < 1.0, "{k}: {found} {percent}");
        }
    }
}

/// Energy stored and taken by friction against the work done, on curved objects too; a coefficient of zero is none.
#[test]
fn energy_closes_with_friction() {
    for object in [
        rough(Friction::Coulomb(0.3)),
        rough(Friction::Stick),
        Object {
            friction: Friction::Coulomb(0.5),
            ..ball(8.0)
        },
        Object {
            friction: Friction::Coulomb(0.2),
            ..cup(20.0)
        },
        Object {
            friction: Friction::Coulomb(0.3),
            ..punch(3.0, 0.3)
        },
    ] {
        for state in states(&object, FULL, [0.3, 1.0, 1.7]) {
            let part = state.energy / state.work - 1.0;
            println!("{object:?} {}: {part:e}", state.indentation);
            assert!(part.abs() < 5e-3, "{object:?} {}: {part:e}", state.indentation);
        }
    }
}

/// Thin walls ripple under the contact; a press onto a ball or into a cup goes on all the same.
#[test]
fn thin_walls_are_pressed_onto_balls_and_cups() {
    let walls = [
        (dome(9.0, 7.0, 0.3, Law::NeoHookean { c1: 100e3 }), 7e-3),
        (dome(12.0, 8.0, 0.5, Law::NeoHookean { c1: 100e3 }), 8e-3),
    ];
    for (wall, height) in walls {
        for (object, deepest) in [
            (ball(3.0), 0.38),
            (ball(8.0), 0.38),
            (ball(50.0), 0.38),
            (cup(30.0), 0.25),
        ] {
            let mut press = Press::new(&touching(wall, &object), FULL).expect("an object");
            for part in [0.05, 0.5, 1.0] {
                let state = press
                    .at_indentation(part * deepest * height)
                    .unwrap_or_else(|error| panic!("{object:?} {error}"));
                assert!((state.energy / state.work - 1.0).abs() < 5e-3, "{object:?}");
            }
        }
    }
}

/// What tables of a plate are worth on a ball of 8 mm radius, at one pressure up to 27 kPa: an independent solution has up to 38 % too much
/// force and 29 to 33 % too little indentation from 5 kPa on. The page of measured figures quotes it.
#[test]
fn a_plates_tables_read_too_much_force_on_a_ball() {
    let grid: Vec<f64> = (1..=50).map(|k| 5e-5 * f64::from(k)).collect();
    let press_all = |object: &Object| -> Vec<[f64; 3]> {
        let mut press = printed(object, FULL).expect("an object");
        let of = |depth: &f64| {
            let state = press.at_indentation(*depth).expect("a state");
            [1e-3 * state.pressure, state.force, *depth]
        };
        grid.iter().map(of).collect()
    };
    let (plate, ball) = (press_all(&Object::PLATE), press_all(&ball(8.0)));
    let (mut force, mut indentation) = (0.0_f64, 0.0_f64);
    for [pressure, of_ball, depth] in ball.into_iter().filter(|state| state[0] > 1.0 && state[0] < 27.0) {
        let after = plate
            .iter()
            .position(|state| state[0] > pressure)
            .expect("pressed as far");
        let ([p0, f0, h0], [p1, f1, h1]) = (plate[after - 1], plate[after]);
        let part = (pressure / p0).ln() / (p1 / p0).ln();
        force = force.max(100.0 * (f0 * (f1 / f0).powf(part) / of_ball - 1.0));
        indentation = indentation.max(100.0 * (1.0 - h0 * (h1 / h0).powf(part) / depth));
    }
    let quoted = format!("up to {force:.0} % too much force and {indentation:.0} % too little indentation");
    println!("{quoted}");
    assert!(
        (37.0..39.5).contains(&force) && (29.0..34.0).contains(&indentation),
        "{quoted}"
    );
    assert!(
        include_str!("../../host-tests/MEASURED.md").contains(&quoted),
        "{quoted}"
    );
}
