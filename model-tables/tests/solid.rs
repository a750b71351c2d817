//! The solid model against independent solutions, closed forms, identities, and the membrane.

mod common;
mod domes;

use common::AGILUS30;
use domes::dome;
use model_tables::design::{Design, RestBy};
use model_tables::limit::EndsBy;
use model_tables::material::Law;
use model_tables::membrane::TensionField;
use model_tables::membrane::press;
use model_tables::solid::SolidError;
use model_tables::solid::equilibrium::SolidWall;
use model_tables::solid::inflation::mid_surface;
use model_tables::solid::mesh::Elements;
use model_tables::solid::press::{COARSE, FULL, Press};
use model_tables::solid::state::{Fluid, State};
use serde::Deserialize;

fn printed_fingertip() -> Design {
    dome(9.0, 7.0, 1.0, AGILUS30)
}

#[derive(Deserialize)]
struct Cases {
    cases: Vec<Case>,
}

#[derive(Deserialize)]
#[expect(non_snake_case, reason = "the names in the file")]
struct Case {
    id: String,
    outer_radius_mm: f64,
    outer_height_mm: f64,
    wall_mm: f64,
    C1_Pa: f64,
    C2_Pa: f64,
    states: Vec<Reference>,
}

#[derive(Deserialize)]
#[expect(non_snake_case, reason = "the names in the file")]
struct Reference {
    H_mm: f64,
    P_kPa: f64,
    F_N: f64,
    contact_radius_mm: f64,
    contact_radius_resolution_mm: f64,
}

/// Every state of the independent solution; `contact` is how far the contact's edge may be off, millimetres, beyond what the
/// solution itself leaves open.
fn agrees(elements: Elements, part: f64, contact: f64) {
    let Cases { cases } =
        serde_json::from_str(include_str!("reference/solid.json")).expect("the file's form");
    assert!(cases.len() >= 2);
    for case in cases {
        let law = Law::MooneyRivlin {
            c1: case.C1_Pa,
            c2: case.C2_Pa,
        };
        let design = dome(case.outer_radius_mm, case.outer_height_mm, case.wall_mm, law);
        let mut press = Press::new(&design, elements).expect("a rest state");
        for state in case.states {
            let found = press.at_indentation(state.H_mm * 1e-3).expect("a state");
            let pressure = found.pressure / (state.P_kPa * 1e3) - 1.0;
            let force = found.force / state.F_N - 1.0;
            let radius = found.contact_radius * 1e3 - state.contact_radius_mm;
            let name = format!(
                "{} at {} mm: {pressure:+.5} {force:+.5} {radius:+.3}",
                case.id, state.H_mm
            );
            assert!(pressure.abs() < part && force.abs() < part, "{name}");
            assert!(
                radius.abs() < contact + state.contact_radius_resolution_mm,
                "{name}"
            );
        }
    }
}

#[test]
fn two_elements_through_the_wall_agree_within_a_percent() {
    agrees(FULL, 0.01, 0.1);
}

#[test]
fn one_element_through_the_wall_agrees_within_two_percent() {
    agrees(COARSE, 0.02, 0.1);
}

#[test]
fn sixty_elements_along_agree_within_half_a_percent() {
    agrees(
        Elements {
            through: 2,
            along: 60,
        },
        0.004,
        0.04,
    );
}

/// The independent solution with 4 mm^3/kPa beside the fluid: 2.41 N at 2 mm, where a rigid path gives 5.75 N.
#[test]
fn compliance_softens_as_in_the_independent_solution() {
    let design = Design {
        compliance: 4e-12,
        ..printed_fingertip()
    };
    let state = Press::new(&design, FULL)
        .expect("a rest state")
        .at_indentation(2e-3)
        .expect("a state");
    assert!((state.force - 2.41).abs() < 0.012, "{}", state.force);
}

#[test]
fn an_unpressed_dome_is_at_rest() {
    let mut press = Press::new(&printed_fingertip(), FULL).expect("a rest state");
    let before = press.iterations();
    let state = press.at_indentation(0.0).expect("the rest state");
    assert_eq!(press.iterations(), before);
    assert!(state.force == 0.0 && state.pressure == 0.0 && state.contact_radius == 0.0);
    // Half an ellipsoid: (2/3) pi a^2 b of the inner semi-axes.
    let volume = 2.0 / 3.0 * std::f64::consts::PI * 8.0 * 8.0 * 6.0 * 1e-9;
    assert!((press.rest().volume / volume - 1.0).abs() < 3e-7);
    assert!((press.rest().pole_stretch - 1.0).abs() < 1e-12);
}

/// `dE/dH = F` at constant volume, `dE/dH = F + P dV/dH` with compliance: nothing in it uses the plate's force.
#[test]
fn virtual_work_is_the_plates_force() {
    let inflated = Design {
        rest: RestBy::Pressure(40e3),
        ..printed_fingertip()
    };
    let compliant = Design {
        compliance: 2e-12,
        ..printed_fingertip()
    };
    let yeoh = Law::Yeoh {
        c1: 120e3,
        c2: 15e3,
        c3: 4e3,
    };
    for design in [
        printed_fingertip(),
        inflated,
        compliant,
        dome(6.0, 8.0, 0.6, yeoh),
    ] {
        let mut press = Press::new(&design, COARSE).expect("a rest state");
        for indentation in [0.3e-3, 1.1e-3, 2.3e-3] {
            // Far below the distance between the contact's points, each of which is a kink.
            let step = 3e-7;
            let middle = press.at_indentation(indentation).expect("a state");
            let [below, above] =
                [-step, step].map(|by| press.at_indentation(indentation + by).expect("a state"));
            let work = (above.energy - below.energy - middle.pressure * (above.volume - below.volume))
                / (2.0 * step);
            assert!(
                (work / middle.force - 1.0).abs() < 1e-5,
                "{indentation}: {work} {}",
                middle.force
            );
        }
    }
}

/// The volume of an incompressible wall does not change, so the fluid's is what the outer surface leaves of it.
#[test]
fn the_fluid_keeps_its_volume_and_the_wall_its_own() {
    let mut press = Press::new(&printed_fingertip(), FULL).expect("a rest state");
    let state = press.at_indentation(2.5e-3).expect("a state");
    assert!((state.volume / press.rest().volume - 1.0).abs() < 1e-9);
}

/// A thick sphere inflated about its centre: `r^3 = R^3 + A`, and the pressure is the integral of the stress difference,
/// `P = integral of 2 (l^2 - l^-4) (2 C1 + 2 C2 l^2) dr / r` with `l = r/R`.
#[test]
fn half_a_thick_sphere_inflates_as_the_closed_form() {
    let (c1, c2) = (0.35, 0.15);
    let law = Law::MooneyRivlin { c1, c2 };
    for thickness in [0.3, 0.1] {
        let (wall, state) = inflated_sphere(thickness, 1.3, law, FULL);
        let (inner, outer) = (1.0 - thickness, 1.0);
        let grown = sphere_growth(thickness, 1.3);
        let steps = 4000;
        let pressure: f64 = (0..steps)
            .map(|i| {
                let undeformed: f64 = inner + (outer - inner) * (f64::from(i) + 0.5) / f64::from(steps);
                let r = (undeformed.powi(3) + grown).cbrt();
                let l = r / undeformed;
                // dr = (R/r)^2 dR
                2.0 * (l * l - l.powi(-4)) * (2.0 * c1 + 2.0 * c2 * l * l) / r / (l * l) * (outer - inner)
                    / f64::from(steps)
            })
            .sum();
        assert!(
            (state.fluid / pressure - 1.0).abs() < 1e-4,
            "{thickness}: {} {pressure}",
            state.fluid
        );
        let top = state.nodes[wall.mesh.layers() - 1][1];
        assert!((top - (1.0 + grown).cbrt()).abs() < 1e-5);
    }
}

/// `A` of a sphere of outer radius 1 whose middle is stretched.
fn sphere_growth(thickness: f64, stretch: f64) -> f64 {
    (1.0 - 0.5 * thickness).powi(3) * (stretch.powi(3) - 1.0)
}

/// Half a sphere whose rim is moved to where a whole inflated sphere has it, settled under the fluid that fills it.
fn inflated_sphere(thickness: f64, stretch: f64, law: Law, elements: Elements) -> (SolidWall, State) {
    let mut wall = SolidWall::new(1.0, thickness, law, elements);
    let mut state = wall.undeformed();
    let growth = sphere_growth(thickness, stretch);
    for node in &mut state.nodes {
        let radius = node[0].hypot(node[1]);
        let grown = (radius.powi(3) + growth).cbrt();
        *node = node.map(|x| x * grown / radius);
    }
    let fluid = Fluid {
        by_volume: 1.0,
        volume: wall.volume(&state),
        by_pressure: 0.0,
        pressure: 0.0,
    };
    wall.settle(&mut state, 1e3, &fluid).expect("the inflated sphere");
    (wall, state)
}

/// Both models on one design: a sphere stretched by 1.3. The thinner its wall, the nearer the solid is to the membrane.
#[test]
fn thin_stretched_walls_press_like_membranes() {
    // Mid-surface radius 9 mm, pressed by 1 mm.
    let excess = |thickness: f64| {
        let outer = 9.0 + 0.5 * thickness;
        let unit = 2.0 * (160_355.0 + 46_559.0);
        let law = Law::MooneyRivlin {
            c1: 160_355.0 / unit,
            c2: 46_559.0 / unit,
        };
        let (mut wall, rest) = inflated_sphere(
            thickness / outer,
            1.3,
            law,
            Elements {
                through: 2,
                along: 60,
            },
        );
        let mut state = rest.clone();
        let fluid = Fluid {
            by_volume: 1.0,
            volume: wall.volume(&rest),
            by_pressure: 0.0,
            pressure: 0.0,
        };
        let top = rest.nodes[wall.mesh.layers() - 1][1];
        let mut force = 0.0;
        for step in 1..=20 {
            let plate = top - f64::from(step) * 0.05 / outer;
            force = wall.settle(&mut state, plate, &fluid).expect("a state").force;
        }
        let membrane = common::design(9.0, 9.0, thickness, AGILUS30, 1.3);
        let membrane = press::Press::new(&membrane, TensionField::Relaxed)
            .expect("a rest state")
            .at_indentation(1e-3)
            .expect("the membrane");
        force * unit * outer * outer * 1e-6 / membrane.force - 1.0
    };
    let (thick, middle, thin) = (excess(0.4), excess(0.2), excess(0.1));
    assert!(thin.abs() < 0.005, "{thick} {middle} {thin}");
    assert!(
        thin < 0.6 * middle && middle < 0.6 * thick,
        "{thick} {middle} {thin}"
    );
}

/// Halving the elements' length changes little, and less each time; the contact's edge, anywhere in an element, holds the order
/// between one and two.
#[test]
fn refining_converges() {
    let depths = [0.5e-3, 0.7e-3, 0.9e-3, 1.1e-3, 1.3e-3, 1.5e-3, 1.7e-3, 1.9e-3];
    let forces = [12, 24, 48, 96].map(|along| {
        let elements = Elements { through: 2, along };
        let mut press = Press::new(&printed_fingertip(), elements).expect("a rest state");
        depths.map(|indentation| press.contact_at(indentation).expect("a state").force)
    });
    let change = |i: usize| {
        let parts = forces[i]
            .iter()
            .zip(forces[i + 1])
            .map(|(coarse, fine)| (coarse / fine - 1.0).powi(2));
        (parts.sum::<f64>() / depths.len() as f64).sqrt()
    };
    assert!(change(1) < 0.01, "{}", change(1));
    let order = 0.5 * (change(0) / change(2)).log2();
    assert!(order > 1.5, "{order}: {} {} {}", change(0), change(1), change(2));
}

/// What a wall without shear, or of constant thickness, cannot follow. An independent solution sees a thickness of 0.91 to
/// 1.0 of the undeformed at 2 mm, a knuckle with a radius of about three walls, and fibres that lean where the contact ends.
#[test]
fn the_wall_shears_thins_and_bends_into_a_knuckle() {
    let elements = Elements {
        through: 2,
        along: 60,
    };
    let mut press = Press::new(&printed_fingertip(), elements).expect("a rest state");
    let edge = press.at_indentation(2e-3).expect("a state").contact_parameter;
    let stations = press.profile(2e-3, 361).expect("a profile");
    // The rim's corner has a shear of its own.
    let steepest = stations
        .iter()
        .filter(|station| station.parameter < 1.2)
        .max_by(|a, b| a.shear.abs().total_cmp(&b.shear.abs()))
        .expect("there are stations");
    assert!((0.1..0.22).contains(&steepest.shear), "{steepest:?}");
    assert!((steepest.parameter - edge).abs() < 0.05, "{steepest:?} {edge}");
    let thickness = stations.iter().map(|station| station.thickness_stretch);
    let least = thickness.clone().fold(f64::INFINITY, f64::min);
    let most = thickness.fold(0.0, f64::max);
    assert!(
        (least - 0.91).abs() < 0.01 && (most - 1.0).abs() < 0.01,
        "{least} {most}"
    );
    // Over a tenth of a radian beyond the contact.
    let from = stations
        .iter()
        .position(|station| station.parameter > edge)
        .expect("an edge");
    let (first, last) = (stations[from], stations[from + 23]);
    let arc = (last.radius - first.radius).hypot(last.height - first.height);
    let knuckle = arc / (last.angle - first.angle);
    assert!((2.5e-3..3.5e-3).contains(&knuckle), "{knuckle}");
}

#[test]
fn refuses_indentations_that_are_none_or_too_deep() {
    let mut press = Press::new(&printed_fingertip(), COARSE).expect("a rest state");
    for wrong in [-1e-6, f64::NAN, f64::INFINITY] {
        assert!(
            matches!(
                press.at_indentation(wrong),
                Err(SolidError::NotAnIndentation { .. })
            ),
            "{wrong}"
        );
    }
    let limit = press.limit().expect("an end");
    assert!(
        limit.indentation > 3.15e-3 && limit.indentation < 3.8e-3,
        "{limit:?}"
    );
    assert!(press.at_indentation(0.999 * limit.indentation).is_ok());
    for deep in [1.01 * limit.indentation, 6.9e-3, 7.1e-3] {
        match press.at_indentation(deep) {
            Err(SolidError::BeyondLimit { asked, limit: found }) => {
                assert!((asked - deep).abs() < 1e-15 && found == limit);
            }
            other => panic!("{deep}: {other:?}"),
        }
    }
}

/// A Yeoh law with `C3 < 0` holds only inside the strain it was fitted to. Where the wall reaches more there is no state, and the
/// refusal says why.
#[test]
fn a_law_that_softens_is_refused_by_name() {
    let softening = Law::Yeoh {
        c1: 120e3,
        c2: 0.0,
        c3: -40e3,
    };
    let mut press = Press::new(&dome(9.0, 7.0, 1.0, softening), COARSE).expect("a rest state");
    assert!(press.contact_at(0.5e-3).is_ok());
    let error = press.contact_at(3e-3).expect_err("beyond the law");
    assert!(error.to_string().contains("material-softens"), "{error}");
    let limit = press.limit().expect("the last state is an end");
    assert_eq!(limit.ends_by, EndsBy::MaterialSoftens);
    assert!(press.contact_at(limit.indentation).is_ok());
}

/// Any order of asking gives the same states.
#[test]
fn the_order_of_asking_does_not_matter() {
    let depths = [2.4e-3, 0.1e-3, 1.7e-3, 0.02e-3, 0.9e-3];
    let mut press = Press::new(&printed_fingertip(), COARSE).expect("a rest state");
    for depth in depths {
        let found = press.contact_at(depth).expect("a state");
        let alone = Press::new(&printed_fingertip(), COARSE)
            .expect("a rest state")
            .contact_at(depth)
            .expect("a state");
        assert!(
            (found.force / alone.force - 1.0).abs() < 1e-6,
            "{depth}: {found:?} {alone:?}"
        );
    }
}

/// Inflated free and then bonded, as a membrane is: at the membrane's pressure, the nearer the thinner, with its pole stretch.
#[test]
fn a_wall_bonded_after_inflation_rests_like_its_membrane() {
    for (thickness, within) in [(0.8, 0.02), (0.2, 0.004)] {
        let design = Design {
            rest: RestBy::PoleStretch(1.25),
            ..dome(9.0, 7.0, thickness, AGILUS30)
        };
        let solid = *Press::new(&design, FULL).expect("a rest state").rest();
        let middle = Design {
            membrane: mid_surface(&design.membrane),
            ..design
        };
        let membrane = *press::Press::new(&middle, TensionField::Relaxed)
            .expect("a rest state")
            .rest();
        assert!((solid.pole_stretch - 1.25).abs() < 1e-8);
        assert!(
            (solid.pressure / membrane.pressure - 1.0).abs() < within,
            "{solid:?} {membrane:?}"
        );
    }
}

/// Fibres through the wall lean where the contact ends: an independent solution has them up to 12 degrees off the normal of the
/// deformed wall at 2 mm. Seven of these the undeformed wall has already, whose fibres are the ellipses' common parameter and not its
/// normals; the rest is shear of the straight fibre from inside to outside, and there is more of it in the middle of the wall.
#[test]
fn fibres_lean_where_the_contact_ends() {
    let elements = Elements {
        through: 2,
        along: 60,
    };
    let Law::MooneyRivlin { c1, c2 } = AGILUS30 else {
        panic!("Agilus30 is a Mooney-Rivlin law");
    };
    let modulus = 2.0 * (c1 + c2);
    let law = Law::MooneyRivlin {
        c1: c1 / modulus,
        c2: c2 / modulus,
    };
    let mut wall = SolidWall::new(7.0 / 9.0, 1.0 / 9.0, law, elements);
    let rest = wall.undeformed();
    let mut state = rest.clone();
    let fluid = Fluid {
        by_volume: 1.0,
        volume: wall.volume(&rest),
        by_pressure: 0.0,
        pressure: 0.0,
    };
    for step in 1..=20 {
        let plate = (7.0 - 0.1 * f64::from(step)) / 9.0;
        wall.settle(&mut state, plate, &fluid).expect("a state");
    }
    let layers = wall.mesh.layers();
    // Of the fibre between two layers against the normal of the middle of the wall, degrees.
    let lean = |state: &State, station: usize, inner: usize, outer: usize| {
        let between = |from: usize, to: usize| {
            let (a, b) = (state.nodes[from], state.nodes[to]);
            [b[0] - a[0], b[1] - a[1]]
        };
        let node = |station, layer| wall.mesh.node(station, layer);
        let along = between(node(station - 1, layers / 2), node(station + 1, layers / 2));
        let fibre = between(node(station, inner), node(station, outer));
        (fibre[0] * along[0] + fibre[1] * along[1])
            .atan2(fibre[1] * along[0] - fibre[0] * along[1])
            .to_degrees()
    };
    let straight = |state: &State, station| lean(state, station, 0, layers - 1);
    // Without the rim's corner.
    let most = (1..wall.mesh.stations())
        .take_while(|&station| wall.mesh.parameters[station] < 1.2)
        .max_by(|&a, &b| straight(&state, a).total_cmp(&straight(&state, b)))
        .expect("there are stations");
    let (now, before) = (straight(&state, most), straight(&rest, most));
    assert!((11.5..13.5).contains(&now), "{now}");
    assert!((7.0..7.6).contains(&before), "{before}");
    // At the contact's edge, which is at a radius of 6.02 mm.
    let outer = state.nodes[wall.mesh.node(most, layers - 1)][0] * 9.0;
    assert!((outer - 6.02).abs() < 0.25, "{outer}");
    let middle = lean(&state, most, layers / 2 - 1, layers / 2 + 1)
        - lean(&rest, most, layers / 2 - 1, layers / 2 + 1);
    assert!(middle > 1.1 * (now - before), "{middle} {now} {before}");
}
