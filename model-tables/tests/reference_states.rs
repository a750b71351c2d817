//! Every state of the reference designs, in both tension fields, against independent solutions.

use model_tables::design::{Design, Membrane, RestBy};
use model_tables::limit::EndsBy;
use model_tables::material::Law;
use model_tables::membrane::TensionField;
use model_tables::membrane::press::Press;
use model_tables::membrane::state::Wrinkling;
use model_tables::object::Object;
use serde::Deserialize;
use std::collections::BTreeMap;

#[derive(Deserialize)]
struct Cases {
    cases: Vec<Case>,
}

#[derive(Deserialize)]
struct Case {
    name: String,
    a0: f64,
    b0: f64,
    h0: f64,
    material: Material,
    inflation: Inflation,
    #[serde(rename = "compliance_m3_per_Pa")]
    compliance: f64,
    models: BTreeMap<String, Model>,
}

#[derive(Deserialize)]
#[serde(rename_all = "UPPERCASE")]
struct Material {
    #[serde(rename = "kind")]
    kind: String,
    c1: f64,
    c2: f64,
    c3: f64,
}

#[derive(Deserialize)]
struct Inflation {
    lambda0: f64,
}

#[derive(Deserialize)]
struct Model {
    inflated: BTreeMap<String, f64>,
    limit: BTreeMap<String, serde_json::Value>,
    states: Vec<State>,
}

#[derive(Deserialize)]
#[expect(non_snake_case, reason = "the names in the file")]
struct State {
    H: f64,
    P: f64,
    dP: f64,
    F: f64,
    V: f64,
    E: f64,
    rho_c: f64,
    rho_max: f64,
    phi_edge: f64,
    lambda0: f64,
    theta_slack: f64,
    minT1: f64,
    minT2: f64,
    unc: BTreeMap<String, f64>,
}

fn cases() -> Vec<Case> {
    let text = include_str!("reference/membrane.json");
    let cases: Cases = serde_json::from_str(text).expect("the reference file is JSON");
    assert_eq!(cases.cases.len(), 8);
    cases.cases
}

fn design(case: &Case) -> Design {
    let Material { c1, c2, c3, .. } = case.material;
    Design {
        membrane: Membrane {
            radial_semi_axis: case.a0,
            axial_semi_axis: case.b0,
            thickness: case.h0,
        },
        law: match case.material.kind.as_str() {
            "NH" => Law::NeoHookean { c1 },
            "MR" => Law::MooneyRivlin { c1, c2 },
            "Yeoh" => Law::Yeoh { c1, c2, c3 },
            other => panic!("unknown law {other}"),
        },
        rest: RestBy::PoleStretch(case.inflation.lambda0),
        compliance: case.compliance,
        object: Object::PLATE,
    }
}

fn field(name: &str) -> TensionField {
    match name {
        "plain" => TensionField::Plain,
        "relaxed" => TensionField::Relaxed,
        other => panic!("unknown model {other}"),
    }
}

fn relative(found: f64, expected: f64) -> f64 {
    (found / expected - 1.0).abs()
}

/// The first state of the plain oblate design is a known exception: see `plain_compressed_design`.
fn force_tolerance(case: &Case, model: &str, state: &State) -> f64 {
    let stated = state.unc["F"] / state.F;
    if model == "plain" && case.name == "agilus_oblate_b0.45_l1.05_wrinkled" {
        return 3e-7;
    }
    if stated > 1e-9 { 1e-7 } else { 1e-8 }
}

#[test]
fn pressure_and_force_of_every_state() {
    for case in cases() {
        for (name, model) in &case.models {
            let mut press = Press::new(&design(&case), field(name)).expect("rest state");
            for (index, state) in model.states.iter().enumerate() {
                let found = press.at_indentation(state.H).expect("state");
                let label = format!("{} {name} H = {:e}", case.name, state.H);
                let pressure = relative(found.shape.pressure, state.P);
                let force = relative(found.force, state.F);
                assert!(pressure < 1e-8, "{label}: pressure off by {pressure:e}");
                assert!(
                    force < force_tolerance(&case, name, state),
                    "{label}: force off by {force:e}"
                );
                // A small difference at the first two indentations: graded in absolute terms there.
                let rise = (found.pressure_rise - state.dP).abs();
                let allowed = if index < 2 {
                    1e-8 * state.P
                } else {
                    1e-6 * state.dP
                };
                assert!(rise < allowed, "{label}: pressure rise off by {rise:e} Pa");
            }
        }
    }
}

#[test]
fn shape_of_every_state() {
    for case in cases() {
        for (name, model) in &case.models {
            let mut press = Press::new(&design(&case), field(name)).expect("rest state");
            for state in &model.states {
                let found = press.at_indentation(state.H).expect("state");
                let shape = &found.shape;
                let check = |what: &str, found: f64, expected: f64, tolerance: f64| {
                    let off = (found - expected).abs();
                    assert!(
                        off < tolerance,
                        "{} {name} H = {:e}: {what} is {found}, expected {expected}: off by {off:e}",
                        case.name,
                        state.H
                    );
                };
                check(
                    "contact radius",
                    found.contact_radius,
                    state.rho_c,
                    3e-7 * state.rho_c,
                );
                check("volume", shape.volume, state.V, 1e-9 * state.V);
                check("energy", shape.energy, state.E, 1e-8 * state.E);
                // Extremes: the reference takes them over its samples, here they are found between samples.
                check(
                    "largest radius",
                    shape.largest_radius,
                    state.rho_max,
                    3e-5 * state.rho_max,
                );
                assert!(shape.largest_radius > state.rho_max * (1.0 - 1e-9));
                check("edge angle", shape.edge_angle, state.phi_edge, 1e-7);
                // Converged to 1e-10 under refinement; near the limit the reference differs by 3e-7.
                check("pole stretch", shape.pole_stretch, state.lambda0, 1e-6);
                check("slack edge", shape.slack_edge, state.theta_slack, 1e-6);
                let allowed = |tension: f64| 1e-4 * tension.abs().max(1.0);
                check(
                    "least T1",
                    shape.least_meridional_tension,
                    state.minT1,
                    allowed(state.minT1),
                );
                check(
                    "least T2",
                    shape.least_hoop_tension,
                    state.minT2,
                    allowed(state.minT2),
                );
                if name == "relaxed" {
                    assert_eq!(shape.wrinkling == Wrinkling::Slack, state.theta_slack > 0.0);
                }
            }
        }
    }
}

#[test]
fn rest_state_and_limit_of_every_design() {
    for case in cases() {
        for (name, model) in &case.models {
            let mut press = Press::new(&design(&case), field(name)).expect("rest state");
            let rest = *press.rest();
            let label = format!("{} {name}", case.name);
            assert!(
                relative(rest.pressure, model.inflated["P"]) < 1e-10,
                "{label}: pressure"
            );
            assert!(
                relative(rest.height, model.inflated["height"]) < 1e-10,
                "{label}: height"
            );
            assert!(
                relative(rest.volume, model.inflated["V"]) < 1e-10,
                "{label}: volume"
            );
            assert!(
                relative(rest.edge_radius, model.inflated["rho_edge"]) < 1e-10,
                "{label}: equator"
            );
            let limit = press.limit().expect("limit");
            let expected = |key: &str| model.limit[key].as_f64().expect("a number");
            assert!(
                relative(limit.indentation, expected("H")) < 1e-8,
                "{label}: limit"
            );
            assert!(
                relative(limit.force, expected("F")) < 1e-7,
                "{label}: force at the limit"
            );
            let ends_by = match model.limit["end"].as_str() {
                Some("base_touch") => EndsBy::BulgeTouchesBase,
                _ => EndsBy::FluidDrained,
            };
            assert_eq!(limit.ends_by, ends_by, "{label}");
        }
    }
}

#[test]
fn relaxed_equals_plain_where_nothing_is_compressed() {
    for case in cases().iter().filter(|case| !case.models.contains_key("relaxed")) {
        let mut plain = Press::new(&design(case), TensionField::Plain).expect("rest state");
        let mut relaxed = Press::new(&design(case), TensionField::Relaxed).expect("rest state");
        for state in &case.models["plain"].states {
            let (a, b) = (
                plain.at_indentation(state.H).expect("plain"),
                relaxed.at_indentation(state.H).expect("relaxed"),
            );
            assert!(
                relative(a.force, b.force) < 1e-9,
                "{} H = {:e}",
                case.name,
                state.H
            );
            assert!(
                relative(a.shape.pressure, b.shape.pressure) < 1e-12,
                "{} H = {:e}",
                case.name,
                state.H
            );
        }
    }
}
