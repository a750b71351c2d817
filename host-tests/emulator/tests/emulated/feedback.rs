//! Both ends of the loop: a fingertip whose fluid drives a feedback membrane, and what its force costs.

use crate::{SIGNAL_PATH, design_with, firmware_for};
use emulator::accuracy::is_wrong;
use emulator::bench::{self, RunOutcome};
use emulator::fingertip_design::FingertipDesign;
use emulator::record::{Recorder, Recording, Row};
use emulator::scenario::Scenario;
use fingertip::status::Status;
use host_tests::{assert_measured_figure, design};

/// Time that the firmware may take to find its zero, seconds.
const START: f64 = 0.4;
/// Largest median error of the feedback force, share of reading, from 5 % of full scale up.
const MEDIAN_ERROR: f64 = 0.005;
/// Most instructions of a report beside those of the same fingertip without an actuator: two lookups, and a difference.
const MORE_INSTRUCTIONS: f64 = 110.0;
/// Most bytes of flash beside the same.
const MORE_FLASH: f64 = 700.0;

fn haptic() -> FingertipDesign {
    FingertipDesign::read(&design("haptic-loop")).expect("it is shipped")
}

/// The same fingertip, with the paper's formula for an actuator: it has no table.
fn without() -> FingertipDesign {
    design_with(
        "haptic-loop",
        "thickness_mm = 1.0\nfoundation_kpa_per_mm = 20.0\n",
        "",
    )
}

/// The record, and the median instructions of a report once there is a zero.
fn pressed(design: &FingertipDesign) -> (Recording, f64) {
    let scenario = Scenario::named("both-ends").expect("it is shipped");
    let duration = scenario.duration();
    let plant = design.plant(scenario).expect("it can be pressed");
    let recorder = Recorder::new(|_: &Row| {});
    let outcome: RunOutcome<_> = bench::run(
        firmware_for(design),
        plant.clone(),
        duration,
        SIGNAL_PATH,
        recorder,
    )
    .expect("the image runs");
    let record = outcome.listener.into_record();
    assert_eq!((record.lost, record.broken.len()), (0, 0));
    for row in record.rows.iter().filter(|row| row.time > START) {
        assert_eq!(row.status, Status::Ok, "at {} s", row.time);
        assert!(!is_wrong(row, &plant), "{row:?}");
    }
    let mut calls = outcome.calls[(START * 1e3) as usize..].to_vec();
    calls.sort_unstable();
    (record, calls[calls.len() / 2] as f64)
}

#[test]
fn the_wearer_is_told_what_presses_them_and_a_design_without_pays_nothing() {
    let (record, with) = pressed(&haptic());
    let rows: Vec<&Row> = record.rows.iter().filter(|row| row.time > START).collect();
    let full = rows
        .iter()
        .filter_map(|row| row.feedback.truth)
        .fold(0.0, f64::max);
    assert!(full > 0.3, "{full} N");
    let mut errors: Vec<f64> = rows
        .iter()
        .map(|row| {
            let truth = row.feedback.truth.expect("an actuator");
            (row.feedback.reported.expect("a force"), truth)
        })
        .filter(|(_, truth)| *truth > 0.05 * full)
        .map(|(reported, truth)| (reported / truth - 1.0).abs())
        .collect();
    assert!(errors.len() > 500, "{}", errors.len());
    errors.sort_unstable_by(f64::total_cmp);
    let median = errors[errors.len() / 2];
    println!(
        "median error of the feedback force: {:.3} % of reading",
        100.0 * median
    );
    assert!(median < MEDIAN_ERROR, "{median}");

    let (record, alone) = pressed(&without());
    assert!(record.rows.iter().all(|row| row.feedback.reported.is_none()));
    let more = with - alone;
    println!("instructions of a report: {with} with a feedback force, {alone} without");
    assert_measured_figure(
        "instructions of a report for the feedback force of haptic-loop",
        more,
        0.1,
    );
    assert!(more > 0.0 && more <= MORE_INSTRUCTIONS, "{more}");

    let flash = |design: &FingertipDesign| firmware_for(design).size().expect("it is an image").flash as f64;
    let more = flash(&haptic()) - flash(&without());
    println!("flash for the feedback force: {more} bytes");
    assert_measured_figure("flash for the feedback force of haptic-loop, bytes", more, 0.1);
    assert!(more > 0.0 && more <= MORE_FLASH, "{more}");
}
