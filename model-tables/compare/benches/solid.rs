//! `cargo bench --bench solid`: CPU time of a state of the solid, from mesh to mesh.
//!
//! It knows nothing but the sweep, so that the same file measures earlier versions: `host-tests/scripts/solid-against.sh COMMIT`
//! runs it in both by turns. CPU time and not wall time, as hosts do other things besides.

use compare::campaign::scaling;
use model_tables::solid::mesh::Elements;
use model_tables::solid::press::Press;
use std::time::Instant;

/// Sweeps of which the fastest counts.
const SWEEPS: usize = 5;

/// Nanoseconds of CPU time so far, where the system tells; else of wall time.
fn nanoseconds(start: Instant) -> f64 {
    std::fs::read_to_string("/proc/self/schedstat")
        .ok()
        .and_then(|text| text.split(' ').next()?.parse().ok())
        .unwrap_or_else(|| start.elapsed().as_nanos() as f64)
}

fn main() {
    println!("through,along,ms_per_state,iterations_per_state,force_n");
    let start = Instant::now();
    for [through, along] in scaling::MESHES {
        let rest = Press::new(&scaling::PRINTED, Elements { through, along }).expect("a rest state");
        let (mut least, mut iterations, mut force) = (f64::INFINITY, 0, 0.0);
        for _ in 0..SWEEPS {
            let mut press = rest.clone();
            let before = nanoseconds(start);
            let states = scaling::sweep(&mut press).expect("within the limit");
            least = least.min(nanoseconds(start) - before);
            iterations = press.iterations() - rest.iterations();
            force = states.last().map_or(0.0, |state| state.force);
        }
        let states = scaling::STATES as f64;
        println!(
            "{through},{along},{:.3},{:.1},{force:.6}",
            least * 1e-6 / states,
            iterations as f64 / states
        );
    }
}
