//! The loop as a curve against states of their own, and the actuator's force over the pressure.

use model_tables::curve::CurveFailure;
use model_tables::design_file::DesignFile;
use model_tables::membrane::press::CURVE;
use model_tables::model::Kind;
use model_tables::model::feedback::{Loop, LoopError};
use model_tables::solid::disc::DISC;
use model_tables::solid::mesh::Elements;

/// A dome with an actuator of these keys.
fn file(model: &str, actuator: &str) -> DesignFile {
    let text = format!(
        "name = \"loop\"\n[membrane]\nradial_semi_axis_mm = 9.0\naxial_semi_axis_mm = 7.0\nthickness_mm = 1.0\n\
         [material]\npreset = \"agilus30\"\n{model}\n[actuator]\ndiameter_mm = 9.0\nthickness_mm = 1.0\n{actuator}\n"
    );
    DesignFile::parse(&text, "loop.toml").expect("a design")
}

const SOLID: Kind = Kind::Solid(Elements {
    through: 1,
    along: 24,
});
const UNSTRETCHED: &str = "[model]\nkind = \"solid\"\nthrough = 1\nalong = 24";
const INFLATED: &str = "[rest]\npole_stretch = 1.3";

/// Each state of its own, from rest, and a curve whose states come from one another: the same to what the loop is solved to.
#[test]
fn a_curve_has_the_states_of_the_loop() {
    for (kind, model, actuator) in [
        (
            SOLID,
            UNSTRETCHED,
            "foundation_kpa_per_mm = 20.0\ntrapped_air_mm3 = 20.0",
        ),
        (SOLID, UNSTRETCHED, "gap_mm = 0.0"),
        (SOLID, UNSTRETCHED, ""),
        (Kind::Membrane, INFLATED, "foundation_kpa_per_mm = 20.0"),
    ] {
        let file = file(model, actuator);
        let at_rest = || {
            Loop::of_file(&file, kind, DISC)
                .expect("at rest")
                .expect("an actuator")
        };
        let curve = at_rest().with_resolution(CURVE).curve(2e-3).expect("a curve");
        assert_eq!(curve.feedback.is_some(), !actuator.is_empty());
        for depth in [0.02e-3, 0.31e-3, 1.07e-3, 1.9e-3] {
            let state = at_rest().at_indentation(depth).expect("a state");
            let read = curve.touch.at_indentation(depth);
            let near = |got: f64, truth: f64| {
                // The solid's curve has the roughness of its elements between states.
                let allowed = if kind == Kind::Membrane { 1e-5 } else { 2e-3 };
                assert!(
                    (got / truth - 1.0).abs() < allowed,
                    "{actuator} {depth}: {got} {truth}"
                );
            };
            near(read.pressure_rise, state.touch.pressure_rise);
            near(read.force, state.touch.force);
            if let Some(feedback) = &curve.feedback {
                let read = feedback.at_pressure_rise(state.touch.pressure_rise).force;
                let truth = state.actuator.force - curve.force_at_rest;
                // The difference of two forces that are solved to some 1e-7.
                let allowed = 1e-4 * truth + 1e-6 * state.actuator.force;
                assert!(
                    (read - truth).abs() < allowed,
                    "{actuator} {depth}: {read} {truth}"
                );
            }
        }
    }
}

#[test]
fn a_force_that_begins_on_the_way_is_refused() {
    let file = file(UNSTRETCHED, "gap_mm = 0.3");
    let mut haptic = Loop::of_file(&file, SOLID, DISC)
        .expect("at rest")
        .expect("an actuator");
    let refused = haptic.curve(2e-3);
    assert!(
        matches!(refused, Err(CurveFailure::Model(LoopError::Apart { rise })) if rise > 1e3),
        "{refused:?}"
    );
}
