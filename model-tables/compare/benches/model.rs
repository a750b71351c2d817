//! `cargo bench`: what the model and its tables cost on the host.
//!
//! Medians over repetitions, in one process; a plain harness, because the pieces take from nanoseconds to
//! milliseconds and nothing but their medians is wanted.

use compare::campaign::scaling;
use compare::methods::benchmark::{BenchmarkDesign, DESIGNS, STATES};
use model_tables::design_file::{Accuracy, DesignFile};
use model_tables::generate;
use model_tables::material::Law;
use model_tables::membrane::TensionField;
use model_tables::membrane::press::{CURVE, Press, SWEEP};
use model_tables::solid;
use model_tables::solid::mesh::Elements;
use model_tables::table::ContactLookup as _;
use model_tables::units::PressureRise;
use std::hint::black_box;
use std::path::Path;
use std::time::{Duration, Instant};

/// Time that is spent on one figure.
const BUDGET: Duration = Duration::from_secs(2);
/// Lookups timed together.
const LOOKUPS: i32 = 100_000;

/// Median and spread of the runs that fit the budget, at least three, in microseconds over `count`.
fn figure<T>(name: &str, count: usize, mut run: impl FnMut() -> T) {
    let mut times = Vec::new();
    let start = Instant::now();
    while times.len() < 3 || start.elapsed() < BUDGET {
        let one = Instant::now();
        black_box(run());
        times.push(one.elapsed().as_secs_f64() * 1e6 / count as f64);
    }
    times.sort_by(f64::total_cmp);
    let at = |part: usize| times[(times.len() - 1) * part / 10];
    println!(
        "{name:<58} {:>12.4} us   (10 %: {:.4}, 90 %: {:.4}; {} runs)",
        at(5),
        at(1),
        at(9),
        times.len()
    );
}

/// Forces of evenly spaced states down to `deepest`.
fn sweep<const S: usize>(mut press: Press<Law, S>, deepest: f64) -> Vec<f64> {
    let states = (1..=STATES).map(|k| deepest * k as f64 / STATES as f64);
    states
        .map(|indentation| press.contact_at(indentation).expect("within the limit").force)
        .collect()
}

/// The printed fingertip as solids of more and more elements: each state from those before it.
fn solids() {
    for [through, along] in scaling::MESHES {
        let rest = solid::press::Press::new(&scaling::PRINTED, Elements { through, along })
            .expect("unstretched is a rest state");
        let name = format!(
            "solid {through} x {along}: a state of a sweep of {}",
            scaling::STATES
        );
        figure(&name, scaling::STATES, || {
            scaling::sweep(&mut rest.clone()).expect("within the limit")
        });
    }
}

fn main() {
    solids();
    for BenchmarkDesign { name, design, .. } in &DESIGNS {
        let rest =
            Press::new(design, TensionField::Relaxed).expect("the benchmark's designs have a rest state");
        let deepest = 0.6 * rest.clone().limit().expect("a limit").indentation;
        figure(&format!("{name}: rest state"), 1, || {
            Press::new(design, TensionField::Relaxed).expect("as above")
        });
        figure(&format!("{name}: a state of a sweep of {STATES}"), STATES, || {
            sweep(rest.clone(), deepest)
        });
        let coarse =
            Press::<Law, 5>::with_resolution(design, TensionField::Relaxed, SWEEP).expect("as above");
        figure(
            &format!("{name}: the same on the mesh for sweeps"),
            STATES,
            || sweep(coarse.clone(), deepest),
        );
        let forces = sweep(rest.clone(), deepest)
            .into_iter()
            .zip(sweep(coarse, deepest));
        let error = forces.fold(0.0, |most, (full, coarse): (f64, f64)| {
            (coarse / full - 1.0).abs().max(most)
        });
        println!(
            "{:<58} {error:>12.1e}",
            format!("{name}: and its largest force error")
        );
        figure(&format!("{name}: rest state to curve"), 1, || {
            let mut press: Press =
                Press::with_resolution(design, TensionField::Relaxed, CURVE).expect("as above");
            press.curve(deepest).expect("within the limit")
        });
    }
    for name in ["paper-prestretched", "skin-analogue", "skin-light-touch"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../designs/{name}.toml"));
        let file = DesignFile::read(&path).expect("a shipped design");
        let design = file.design();
        let deepest = 1e-3 * file.max_indentation_mm.expect("shipped with it");
        let accuracy: Accuracy = file.accuracy.expect("shipped with it");
        let resolution = file.transducer.as_ref().expect("shipped with it").resolution_pa;
        figure(&format!("{name}: rest state to fitted tables"), 1, || {
            let mut press: Press =
                Press::with_resolution(&design, TensionField::Relaxed, CURVE).expect("a shipped design");
            let curve = press.curve(deepest).expect("a shipped design");
            generate::fit(&curve, curve.end(), &accuracy, resolution).expect("a shipped design")
        });
    }
    let text = include_str!(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../designs/paper-prestretched.toml"
    ));
    let file = DesignFile::parse(text, "paper-prestretched.toml").expect("a shipped design");
    let accuracy: Accuracy = file.accuracy.expect("shipped with it");
    let resolution = file.transducer.as_ref().expect("shipped with it").resolution_pa;
    let mut press = Press::new(&file.design(), TensionField::Relaxed).expect("a shipped design");
    let deepest = 1e-3 * file.max_indentation_mm.expect("shipped with it");
    let curve = press.curve(deepest).expect("a shipped design");
    let fitted = || generate::tables(&curve, curve.end(), &accuracy, resolution).expect("a shipped design");
    figure("paper-prestretched: curve to certified tables", 1, fitted);
    let tables = fitted().tables;
    let bits = tables.layout.fraction_bits;
    let last = PressureRise::from_pascals(curve.end().pressure_rise, bits).0;
    figure("paper-prestretched: a lookup", LOOKUPS as usize, || {
        (0..LOOKUPS).fold(0_i64, |sum, k| {
            let rise = PressureRise((i64::from(last) * i64::from(k) / i64::from(LOOKUPS)) as i32);
            let reading = tables.contact_at(black_box(rise));
            sum + i64::from(reading.force.0) + i64::from(reading.indentation.0)
        })
    });
}
