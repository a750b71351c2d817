//! Balls and cups against the membrane: virtual work, the plate as their limit, the membrane limit of a thin wall, the solid of a thin wall.

mod common;

use common::{AGILUS30, design};
use model_tables::design::{Design, Membrane, RestBy};
use model_tables::material::Law;
use model_tables::membrane::TensionField;
use model_tables::membrane::press::{MembraneError, Press};
use model_tables::object::{Friction, Object, Shape};
use model_tables::solid;
use model_tables::solid::inflation::mid_surface;
use model_tables::solid::mesh::Elements;

fn touching(design: Design, shape: Shape) -> Design {
    Design {
        object: Object {
            shape,
            friction: Friction::NONE,
        },
        ..design
    }
}

fn press(design: &Design) -> Press {
    Press::new(design, TensionField::Relaxed).expect("a rest state")
}

/// The published fingertip, its rest state inflated to a crown of 9.9 mm radius, and a printed dome that is hardly stretched.
fn tips() -> [Design; 2] {
    [
        design(4.5, 2.7, 1.0, AGILUS30, 2.3),
        design(9.0, 7.0, 0.3, Law::NeoHookean { c1: 100e3 }, 1.1),
    ]
}

/// `dE/dH = F + P dV/dH` with `V = V0 - c (P - P0)`: nothing in it knows what touches.
#[test]
fn virtual_work_gives_the_force_of_balls_and_cups() {
    for tip in tips() {
        for (shape, compliance) in [
            (Shape::Ball { radius: 3e-3 }, 0.0),
            (Shape::Ball { radius: 8e-3 }, 2e-12),
            (Shape::Cup { radius: 25e-3 }, 0.0),
        ] {
            let tip = touching(Design { compliance, ..tip }, shape);
            let mut press = press(&tip);
            for depth in [0.1e-3, 0.5e-3, 1.0e-3] {
                let step = depth / 100.0;
                let mut at = |depth: f64| {
                    let state = press
                        .at_indentation(depth)
                        .unwrap_or_else(|error| panic!("{shape:?} {error}"));
                    [
                        state.shape.energy,
                        state.shape.volume,
                        state.force,
                        state.shape.pressure,
                    ]
                };
                let [energy, volume] = [0, 1].map(|of| {
                    let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(|k| at(depth + k * step)[of]);
                    (8.0 * (c - b) - (d - a)) / (12.0 * step)
                });
                let [_, _, found, pressure] = at(depth);
                let force = energy - pressure * volume;
                assert!(
                    (force / found - 1.0).abs() < 1e-6,
                    "{shape:?} at {depth}: {force} {found}"
                );
            }
        }
    }
}

#[test]
fn a_wide_ball_and_a_wide_cup_are_plates() {
    for tip in tips() {
        let plate = press(&tip).at_indentation(0.8e-3).expect("a state");
        for shape in [Shape::Ball { radius: 1e4 }, Shape::Cup { radius: 1e4 }] {
            let found = press(&touching(tip, shape))
                .at_indentation(0.8e-3)
                .expect("a state");
            assert!((found.force / plate.force - 1.0).abs() < 1e-5);
            assert!((found.contact_radius / plate.contact_radius - 1.0).abs() < 1e-5);
            assert!((found.pressure_rise / plate.pressure_rise - 1.0).abs() < 1e-5);
        }
    }
}

/// The indentation on a plate at which the pressure has risen as much.
fn on_plate(plate: &mut Press, rise: f64, deepest: f64) -> (f64, f64) {
    let (mut low, mut high) = (0.0, deepest);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if plate.contact_at(middle).expect("a state").pressure_rise < rise {
            low = middle;
        } else {
            high = middle;
        }
    }
    (low, plate.contact_at(low).expect("a state").force)
}

/// At one pressure rise a wall without bending displaces one volume: `F = F_t / sqrt(1 + Rd / R)` and `H = H_t sqrt(1 + Rd / R)`, with `Rd`
/// the crown's radius of curvature, within 20 %.
#[test]
fn a_thin_wall_goes_to_the_membrane_limit() {
    let tip = design(9.0, 7.0, 0.3, Law::NeoHookean { c1: 100e3 }, 1.02);
    let mut plate = press(&tip);
    let crown = 81e-3 / 7.0;
    for radius in [8e-3, 20e-3_f64] {
        let mut ball = press(&touching(tip, Shape::Ball { radius }));
        let factor = (1.0 + crown / radius).sqrt();
        for depth in [1.0e-3, 1.5e-3, 2.0e-3] {
            let found = ball.contact_at(depth).expect("a state");
            let (indentation, force) = on_plate(&mut plate, found.pressure_rise, 3e-3);
            let (by_force, by_depth) = (
                force / found.force / factor,
                found.indentation / indentation / factor,
            );
            println!("{radius} {depth}: {by_force} {by_depth}");
            assert!((by_force - 1.0).abs() < 0.2 && (by_depth - 1.0).abs() < 0.2);
        }
    }
}

/// A thin, pre-stretched wall: bending hardly matters, and both models give the same force and pressure rise.
#[test]
fn membrane_and_solid_agree_on_a_ball_where_the_wall_is_thin() {
    let outer = Membrane {
        radial_semi_axis: 9e-3,
        axial_semi_axis: 9e-3,
        thickness: 0.1e-3,
    };
    let wall = Design {
        membrane: outer,
        rest: RestBy::PoleStretch(1.3),
        ..design(9.0, 9.0, 0.1, AGILUS30, 1.3)
    };
    let shape = Shape::Ball { radius: 6e-3 };
    let middle = Design {
        membrane: mid_surface(&outer),
        ..wall
    };
    let elements = Elements {
        through: 2,
        along: 60,
    };
    let mut solid = solid::press::Press::new(&touching(wall, shape), elements).expect("a rest state");
    let mut membrane = press(&touching(middle, shape));
    for depth in [1.0e-3, 2.0e-3] {
        let (solid, membrane) = (
            solid.contact_at(depth).expect("a state"),
            membrane.contact_at(depth).expect("a state"),
        );
        let force = solid.force / membrane.force - 1.0;
        let rise = solid.pressure_rise / membrane.pressure_rise - 1.0;
        println!("{depth}: {force:+.4} {rise:+.4}");
        assert!(force.abs() < 0.02 && rise.abs() < 0.02, "{depth}: {force} {rise}");
    }
}

/// The meridian lies on the ball where it touches, and its height is that of the ball.
#[test]
fn the_meridian_follows_the_ball() {
    let radius = 8e-3;
    let tip = touching(tips()[0], Shape::Ball { radius });
    let mut press = press(&tip);
    let state = press.at_indentation(1.0e-3).expect("a state");
    let points: Vec<_> = press.profile(1.0e-3, 60).expect("a state").collect();
    let apex = points[0].height;
    assert!((apex - (press.rest().height - 1.0e-3)).abs() < 1e-9);
    let mut touching = 0;
    for point in &points {
        if point.parameter > state.contact_parameter {
            continue;
        }
        touching += 1;
        let expected = apex + radius - (radius * radius - point.radius * point.radius).sqrt();
        assert!(
            (point.height - expected).abs() < 1e-9,
            "{} {expected}",
            point.height
        );
        assert!((point.angle.sin() + point.radius / radius).abs() < 1e-9);
    }
    assert!(touching > 3);
    // Just outside the tangent goes on as it was.
    let outside = points
        .iter()
        .find(|point| point.parameter > state.contact_parameter)
        .expect("a free zone");
    assert!(outside.angle < 0.5);
}

#[test]
fn what_the_membrane_cannot_touch_is_refused() {
    let tip = tips()[0];
    let refused = |object: Object| {
        Press::new(&Design { object, ..tip }, TensionField::Relaxed).expect_err("not for a membrane")
    };
    let rubber = Object {
        friction: Friction::Coulomb(0.3),
        ..Object::PLATE
    };
    assert_eq!(refused(rubber), MembraneError::ObjectNotForMembrane);
    let crown = 2.0 * 807.81 / 179_060.0;
    let cup = |radius| touching(tip, Shape::Cup { radius }).object;
    let MembraneError::CupTooTight { least, .. } = refused(cup(0.9 * crown)) else {
        panic!("a tight cup");
    };
    assert!((least / crown - 1.0).abs() < 1e-3, "{least} {crown}");
}
