//! What a state costs, of the membrane and of the solid: one harness for this checkout and for earlier ones.
//!
//! `host-tests/scripts/peers.py` builds it against the package `model-tables` of each, so it may only use what all of them have. Printed is
//! CSV: the model, its settings, microseconds of CPU a state (the least of several sweeps), Newton iterations a state, and, separated by
//! spaces, pressures in pascals and forces in newtons of every state.

use cpu_time::ThreadTime;
use model_tables::curve::Contact;
use model_tables::design::Design;
use model_tables::design_file::DesignFile;
use model_tables::material::Law;
use model_tables::membrane::TensionField;
use model_tables::membrane::adapt::Resolution;
use model_tables::membrane::press::Press as Membrane;
use model_tables::solid::mesh::Elements;
use model_tables::solid::press::Press as Solid;

/// States of the membrane's sweep, and the deepest, metres.
const MEMBRANE_STATES: usize = 64;
const MEMBRANE_DEEPEST: f64 = 2.5e-3;
/// States of the solid's sweep, and the deepest, metres.
const SOLID_STATES: usize = 25;
const SOLID_DEEPEST: f64 = 2.5e-3;
/// Sweeps of which the fastest counts.
const MEMBRANE_SWEEPS: usize = 40;
const SOLID_SWEEPS: usize = 5;
/// Elements through the wall and along the meridian.
const MESHES: [[usize; 2]; 4] = [[1, 24], [2, 24], [2, 60], [3, 96]];
/// Elements of the membrane a unit of depth.
const DENSITIES: [f64; 8] = [0.4, 0.5, 0.7, 0.9, 1.2, 1.8, 2.5, 4.0];

/// The membrane of the paper as its inputs are printed, and the printed fingertip.
const DESIGNS: [&str; 2] = [
    "[membrane]\nradial_semi_axis_mm = 4.5\naxial_semi_axis_mm = 2.7\nthickness_mm = 1.0\n[rest]\npole_stretch = 2.3\n",
    "[membrane]\nradial_semi_axis_mm = 9.0\naxial_semi_axis_mm = 7.0\nthickness_mm = 1.0\n[model]\nkind = \"solid\"\n",
];
const MATERIAL: &str = "[material]\nlaw = \"mooney-rivlin\"\nc1_pa = 160355.0\nc2_pa = 46559.0\n";

fn design(text: &str) -> Design {
    let text = format!("name = \"peer\"\n{text}{MATERIAL}");
    DesignFile::parse(&text, "peer.toml").expect("a design").design()
}

fn depths(deepest: f64, states: usize) -> Vec<f64> {
    (1..=states).map(|k| deepest * k as f64 / states as f64).collect()
}

/// Sweeps `sweeps` times and prints the row.
fn measure<P: Clone>(
    settings: &str,
    rest: &P,
    depths: &[f64],
    sweeps: usize,
    contact_at: impl Fn(&mut P, f64) -> Result<Contact, String>,
    iterations: impl Fn(&P) -> u64,
    rest_pressure: f64,
) {
    let (mut least, mut spent, mut found) = (f64::INFINITY, 0, Vec::new());
    for _ in 0..sweeps {
        let mut press = rest.clone();
        let start = ThreadTime::now();
        let states: Result<Vec<Contact>, String> =
            depths.iter().map(|&depth| contact_at(&mut press, depth)).collect();
        least = least.min(start.elapsed().as_secs_f64());
        spent = iterations(&press) - iterations(rest);
        match states {
            Ok(states) => found = states,
            Err(error) => {
                eprintln!("{settings}: {error}");
                return;
            }
        }
    }
    let list = |value: &dyn Fn(&Contact) -> f64| {
        let values: Vec<String> = found.iter().map(|state| format!("{:.12e}", value(state))).collect();
        values.join(" ")
    };
    println!(
        "{settings},{:.3},{:.2},{},{}",
        least * 1e6 / depths.len() as f64,
        spent as f64 / depths.len() as f64,
        list(&|state| state.pressure_rise + rest_pressure),
        list(&|state| state.force),
    );
}

/// Where Newton's method may stop: well below the error that the mesh leaves.
fn tolerance(stages: usize, density: f64) -> f64 {
    let stages = stages as f64;
    let mesh = 10.0_f64.powf(-1.17 * stages) * (0.7 / density).powf(2.0 * stages);
    (0.01 * mesh).clamp(1e-14, 1e-4)
}

fn membrane<const S: usize>(density: f64, contact_elements: usize) {
    let resolution = Resolution {
        density,
        contact_elements,
        tolerance: tolerance(S, density),
        last_term: f64::INFINITY,
    };
    let rest = Membrane::<Law, S>::with_resolution(&design(DESIGNS[0]), TensionField::Plain, resolution)
        .expect("a rest state");
    let settings = format!("membrane,order {} density {density} contact {contact_elements}", 2 * S);
    measure(
        &settings,
        &rest,
        &depths(MEMBRANE_DEEPEST, MEMBRANE_STATES),
        MEMBRANE_SWEEPS,
        |press, depth| press.contact_at(depth).map_err(|error| error.to_string()),
        Membrane::iterations,
        rest.rest().pressure,
    );
}

fn main() {
    println!("model,settings,us_per_state,iterations,pressure_pa,force_n");
    for density in DENSITIES {
        let contact = density.round().max(1.0) as usize;
        membrane::<2>(density, contact);
        membrane::<3>(density, contact);
        membrane::<4>(density, contact);
        membrane::<5>(density, contact);
        membrane::<6>(density, contact);
    }
    // What errors are measured against.
    membrane::<8>(5.0, 8);
    for [through, along] in MESHES {
        let rest = Solid::new(&design(DESIGNS[1]), Elements { through, along }).expect("a rest state");
        measure(
            &format!("solid,{through} x {along}"),
            &rest,
            &depths(SOLID_DEEPEST, SOLID_STATES),
            SOLID_SWEEPS,
            |press, depth| press.contact_at(depth).map_err(|error| error.to_string()),
            Solid::iterations,
            0.0,
        );
    }
}
