//! Tables from bench data alone, on the image: it reads as the bench did.
//!
//! `measured/pad.csv` says what it was made of; `measured/skin-analogue-from-data.toml` is what `designer fit --from-data` makes of
//! it, which a test of the designer holds it to.

use emulator::accuracy::is_wrong;
use emulator::bench;
use emulator::fingertip_design::FingertipDesign;
use emulator::image::Image;
use emulator::record::{Recorder, Row};
use emulator::scenario::Scenario;
use std::path::Path;

/// The law of the data: force in newtons and pressure rise in kilopascals at an indentation in millimetres.
fn law(indentation: f64) -> [f64; 2] {
    [
        0.6 * indentation.powf(1.5),
        8.0 * (1.0 - (-0.5 * indentation).exp()),
    ]
}

/// Errors are looked at from this share of the deepest indentation on: the data begin at a thirtieth.
const FROM: f64 = 0.1;
/// Largest median and largest error at all of force and pressure rise, share of reading: the data scatter by half a percent in either,
/// and the command says that it meets a row's force to a percent.
const MEDIAN: f64 = 0.01;
const LARGEST: f64 = 0.03;

#[test]
fn a_press_reads_as_the_bench_measured_it() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/measured/skin-analogue-from-data.toml");
    let design = FingertipDesign::read(&path).expect("it is well formed");
    let image = Image::firmware(Some(&design.path)).expect("the firmware builds");
    let scenario = Scenario::named("press-hold-release").expect("it is shipped");
    let duration = scenario.duration();
    let plant = design.plant(scenario).expect("the data reach that deep");
    let recorder = Recorder::new(|_: &Row| {});
    let outcome = bench::run(&image, plant.clone(), duration, &[], recorder).expect("the image runs");
    assert_eq!(outcome.resets, Vec::<String>::new());
    let record = outcome.listener.into_record();
    assert_eq!(record.hellos[0].design_hash, design.hash());
    assert!(record.rows.iter().all(|row| !is_wrong(row, &plant)));
    let mut errors: Vec<[f64; 2]> = record
        .rows
        .iter()
        .filter(|row| row.truth.indentation >= FROM * plant.full_scale().indentation)
        .filter_map(|row| {
            let reported = row.reported?;
            let [force, rise] = law(1e3 * row.truth.indentation);
            Some([
                (reported.force / force - 1.0).abs(),
                (1e-3 * reported.pressure_rise / rise - 1.0).abs(),
            ])
        })
        .collect();
    assert!(errors.len() > 2000, "{} readings", errors.len());
    for (k, quantity) in ["force", "pressure rise"].into_iter().enumerate() {
        errors.sort_by(|a, b| a[k].total_cmp(&b[k]));
        let (median, largest) = (errors[errors.len() / 2][k], errors[errors.len() - 1][k]);
        println!("{quantity}: median {median:.4}, largest {largest:.4} of reading");
        assert!(
            median < MEDIAN && largest < LARGEST,
            "{quantity}: {median} {largest}"
        );
    }
}
