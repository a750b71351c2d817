//! The meridian against the state it belongs to, its own geometry, the material law and equilibrium.

mod common;

use common::{AGILUS30, design};
use core::f64::consts::{FRAC_PI_2, PI};
use model_tables::design::Design;
use model_tables::material::{Hyperelastic as _, Law};
use model_tables::membrane::adapt::Resolution;
use model_tables::membrane::press::Press;
use model_tables::membrane::state::{MeridianPoint, PressedState, Wrinkling};
use model_tables::membrane::{TensionField, Zone};

/// Designs and indentations: deep, barely touched, wrinkled, with a slack core.
fn cases() -> Vec<(Design, TensionField, f64)> {
    let paper = design(4.5, 2.7, 1.0, AGILUS30, 2.3);
    let oblate = design(9.0, 4.05, 1.0, AGILUS30, 1.05);
    let sphere = design(10.0, 10.0, 0.2, Law::MooneyRivlin { c1: 1e5, c2: 1e4 }, 1.005);
    vec![
        (paper, TensionField::Relaxed, 0.0),
        (paper, TensionField::Relaxed, 1e-6),
        (paper, TensionField::Relaxed, 2e-3),
        (paper, TensionField::Relaxed, 4.1e-3),
        (oblate, TensionField::Relaxed, 0.5e-3),
        (oblate, TensionField::Plain, 0.5e-3),
        (sphere, TensionField::Relaxed, 1e-3),
    ]
}

fn meridian(
    design: &Design,
    field: TensionField,
    indentation: f64,
    points: usize,
) -> (PressedState, Vec<MeridianPoint>) {
    let mut press = Press::new(design, field).expect("rest state");
    let state = press.at_indentation(indentation).expect("state");
    let meridian: Vec<_> = press.profile(indentation, points).expect("state").collect();
    assert_eq!(meridian.len(), points);
    (state, meridian)
}

fn near(found: f64, truth: f64, tolerance: f64, what: &str) {
    assert!((found - truth).abs() <= tolerance, "{what}: {found} for {truth}");
}

#[test]
fn its_ends_and_its_contact_edge_are_those_of_the_state() {
    for (design, field, indentation) in cases() {
        for points in [3, 4, 101] {
            let (state, meridian) = meridian(&design, field, indentation, points);
            let label = format!("{design:?} {field:?} at {indentation}");
            let (pole, equator) = (meridian[0], meridian[points - 1]);
            let length = design.membrane.radial_semi_axis;
            assert_eq!(pole.parameter.to_bits(), 0.0_f64.to_bits());
            near(pole.radius, 0.0, 0.0, &label);
            near(pole.height, state.shape.height, 1e-12 * length, &label);
            near(pole.angle, 0.0, 0.0, &label);
            near(pole.hoop_stretch, state.shape.pole_stretch, 1e-9, &label);
            near(pole.meridional_stretch, pole.hoop_stretch, 1e-9, &label);
            near(pole.meridional_tension, pole.hoop_tension, 1e-6, &label);
            assert_eq!(equator.parameter.to_bits(), FRAC_PI_2.to_bits());
            near(equator.height, 0.0, 1e-12 * length, &label);
            near(equator.radius, state.shape.edge_radius, 1e-11 * length, &label);
            near(equator.angle, state.shape.edge_angle, 1e-9, &label);

            // The contact: flat, level with the pole, up to the contact radius.
            let under_plate = meridian.iter().filter(|p| p.zone == Zone::Contact).count();
            if indentation == 0.0 {
                assert_eq!(under_plate, 0, "{label}");
                continue;
            }
            let edge = meridian[under_plate - 1];
            assert!(under_plate >= 2 && under_plate < points, "{label}");
            // Solved twice: equal up to what Newton's method leaves.
            near(edge.parameter, state.contact_parameter, 1e-10, &label);
            near(edge.radius, state.contact_radius, 1e-11 * length, &label);
            for (i, point) in meridian.iter().enumerate() {
                assert_eq!(point.zone == Zone::Contact, i < under_plate, "{label}");
                if i < under_plate {
                    near(point.height, pole.height, 0.0, &label);
                    near(point.angle, 0.0, 0.0, &label);
                }
            }
        }
    }
}

#[test]
fn it_runs_from_the_pole_to_the_equator() {
    for (design, field, indentation) in cases() {
        let (_, meridian) = meridian(&design, field, indentation, 101);
        for pair in meridian.windows(2) {
            assert!(pair[0].parameter < pair[1].parameter && pair[0].height >= pair[1].height);
        }
    }
}

#[test]
fn an_inflated_sphere_has_its_closed_form() {
    let (c1, c2, l, radius) = (100e3, 30e3, 1.4_f64, 8e-3);
    let design = design(8.0, 8.0, 0.5, Law::MooneyRivlin { c1, c2 }, l);
    // T = 2 h0 (1 - l^-6)(C1 + C2 l^2), the same both ways.
    let tension = 2.0 * 0.5e-3 * (1.0 - l.powi(-6)) * (c1 + c2 * l * l);
    for point in meridian(&design, TensionField::Relaxed, 0.0, 37).1 {
        let t = point.parameter;
        near(point.radius, radius * l * t.sin(), 1e-11 * radius, "radius");
        near(point.height, radius * l * t.cos(), 1e-11 * radius, "height");
        near(point.meridional_stretch, l, 1e-9, "meridional stretch");
        near(point.hoop_stretch, l, 1e-9, "hoop stretch");
        near(
            point.meridional_tension,
            tension,
            1e-9 * tension,
            "meridional tension",
        );
        near(point.hoop_tension, tension, 1e-9 * tension, "hoop tension");
        near(point.angle, t, 1e-9, "angle");
    }
}

/// The same meridian from a mesh twice as fine.
#[test]
fn it_does_not_depend_on_the_mesh() {
    for (design, field, indentation) in cases() {
        let (_, coarse) = meridian(&design, field, indentation, 101);
        let finer = Resolution {
            density: 5.0,
            contact_elements: 6,
            tolerance: 1e-14,
            last_term: 1e-7,
        };
        let mut press: Press = Press::with_resolution(&design, field, finer).expect("rest state");
        let fine: Vec<_> = press.profile(indentation, 101).expect("state").collect();
        let length = design.membrane.radial_semi_axis;
        let tension = coarse
            .iter()
            .map(|p| p.meridional_tension)
            .fold(0.0_f64, f64::max);
        for (a, b) in coarse.iter().zip(&fine) {
            let label = format!("{design:?} {field:?} at {indentation}, {}", a.parameter);
            near(a.radius, b.radius, 1e-8 * length, &label);
            near(a.height, b.height, 1e-8 * length, &label);
            near(a.meridional_stretch, b.meridional_stretch, 1e-6, &label);
            near(a.meridional_tension, b.meridional_tension, 1e-6 * tension, &label);
            near(a.hoop_tension, b.hoop_tension, 1e-6 * tension, &label);
        }
    }
}

/// Differences over a short stretch of meridian against what the points at it say.
#[test]
fn its_stretches_angles_and_tensions_belong_together() {
    for (design, field, indentation) in cases() {
        let (state, meridian) = meridian(&design, field, indentation, 2001);
        let dimensions = design.membrane;
        let (a0, b0) = (dimensions.radial_semi_axis, dimensions.axial_semi_axis);
        let pressure = state.shape.pressure;
        let mut checked = 0;
        for triple in meridian.windows(3) {
            let [left, here, right] = [triple[0], triple[1], triple[2]];
            // A slack core has more length than room: it lies in folds that the profile does not show.
            let slack = here.wrinkling == Wrinkling::Slack;
            if left.zone != right.zone || left.wrinkling != right.wrinkling || slack {
                continue;
            }
            let label = format!("{design:?} {field:?} at {indentation}, {}", here.parameter);
            let t = here.parameter;
            let undeformed = (a0 * t.cos()).hypot(b0 * t.sin());
            let span = right.parameter - left.parameter;
            let (across, down) = (right.radius - left.radius, left.height - right.height);
            // Curvature makes a chord of angle 2 d shorter than its arc by d^2 / 6, and so for the tensions.
            let bend = 0.5 * (right.angle - left.angle) + 1e-3;
            // Just outside a small contact everything goes with the logarithm of the parameter.
            let allowed = bend * bend + here.angle * (span / t).powi(2);
            near(
                across.hypot(down) / (undeformed * span),
                here.meridional_stretch,
                allowed,
                &label,
            );
            near(down.atan2(across), here.angle, allowed, &label);
            near(here.radius, here.hoop_stretch * a0 * t.sin(), 1e-12 * a0, &label);
            if here.wrinkling == Wrinkling::Taut || field == TensionField::Plain {
                let (l1, l2) = (here.meridional_stretch, here.hoop_stretch);
                let law = design.law.derivatives(l1, l2);
                let h0 = dimensions.thickness;
                let scale = h0 * design.law.shear_modulus();
                near(here.meridional_tension, h0 * law.w1 / l2, 1e-9 * scale, &label);
                near(here.hoop_tension, h0 * law.w2 / l1, 1e-9 * scale, &label);
            }
            if here.wrinkling == Wrinkling::Wrinkled && field == TensionField::Relaxed {
                near(here.hoop_tension, 0.0, 0.0, &label);
            }
            // Along the meridian: d(rho T1) = T2 d rho.
            let thrust = right.radius * right.meridional_tension - left.radius * left.meridional_tension;
            let scale = here.meridional_tension.abs().max(here.hoop_tension.abs()) * undeformed * span;
            near(
                thrust / scale,
                here.hoop_tension * across / scale,
                20.0 * allowed,
                &label,
            );
            // Across it: the pressure on everything above carries the tension's vertical part.
            let lifted = pressure * PI * (here.radius.powi(2) - state.contact_radius.powi(2));
            let carried = 2.0 * PI * here.radius * here.meridional_tension * here.angle.sin();
            if here.zone == Zone::Free {
                near(carried, lifted, 1e-9 * pressure * a0 * a0, &label);
            }
            checked += 1;
        }
        assert!(checked > 1500, "{checked}");
    }
}

#[test]
fn its_zones_are_those_of_the_state() {
    let mut seen = Vec::new();
    for (design, field, indentation) in cases() {
        let (state, meridian) = meridian(&design, field, indentation, 401);
        let worst = meridian.iter().map(|p| p.wrinkling).max().expect("points");
        assert_eq!(
            worst, state.shape.wrinkling,
            "{design:?} {field:?} at {indentation}"
        );
        seen.push(worst);
        for point in meridian {
            if point.wrinkling == Wrinkling::Slack {
                assert!(point.parameter < state.shape.slack_edge && point.zone == Zone::Contact);
                near(point.meridional_tension, 0.0, 0.0, "slack");
                near(point.hoop_tension, 0.0, 0.0, "slack");
            }
        }
    }
    for zone in [Wrinkling::Taut, Wrinkling::Wrinkled, Wrinkling::Slack] {
        assert!(seen.contains(&zone), "{zone:?} is not among the cases");
    }
}

#[test]
fn the_rest_state_can_be_asked_for_after_a_press() {
    let design = design(9.0, 7.0, 1.0, AGILUS30, 1.02);
    let mut press = Press::new(&design, TensionField::Relaxed).expect("rest state");
    let before: Vec<_> = press.profile(0.0, 11).expect("state").collect();
    let pressed: Vec<_> = press.profile(1e-3, 11).expect("state").collect();
    let after: Vec<_> = press.profile(0.0, 11).expect("state").collect();
    assert_eq!(before, after);
    assert_ne!(before, pressed);
    assert!(press.profile(-1e-3, 11).is_err());
    assert!(press.profile(1.0, 11).is_err());
}
