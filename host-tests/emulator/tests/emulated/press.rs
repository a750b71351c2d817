//! A press is reported as it is.

use crate::{Run, design, press_hold_release, run};
use emulator::accuracy::{RunAccuracy, is_wrong};
use emulator::record::Row;
use fingertip::status::Status;

/// Largest median error, share of reading, from 5 % of full scale up.
const MEDIAN_ERROR: f64 = 0.005;
/// Least share of the reports within two standard deviations of the transducer's noise.
const WITHIN: f64 = 0.95;
/// Time that the firmware may take to find its zero, seconds.
const START: f64 = 0.4;
/// The firmware reports once a millisecond.
const PERIOD: f64 = 1e-3;
/// Time that the first samples after power-on take to become a report with a time of its own, seconds.
const FIRST: f64 = 5e-3;

fn of_phase(run: &Run, name: &str) -> RunAccuracy {
    let rows = run
        .record
        .rows
        .iter()
        .filter(|row| run.plant.scenario().phase_at(row.time) == name);
    RunAccuracy::of(rows, &run.plant)
}

#[test]
fn press_hold_and_release_meet_the_targets() {
    let run = press_hold_release();
    for phase in ["press", "hold", "release"] {
        let accuracy = of_phase(run, phase);
        println!("{phase}: {accuracy:?}");
        assert!(accuracy.readings > 400, "{phase}: {accuracy:?}");
        assert!(accuracy.force_median <= MEDIAN_ERROR, "{phase}: {accuracy:?}");
        assert!(
            accuracy.indentation_median <= MEDIAN_ERROR,
            "{phase}: {accuracy:?}"
        );
        assert!(accuracy.pressure_within >= WITHIN, "{phase}: {accuracy:?}");
        assert!(accuracy.force_within >= WITHIN, "{phase}: {accuracy:?}");
        assert!(accuracy.indentation_within >= WITHIN, "{phase}: {accuracy:?}");
    }
}

#[test]
fn no_value_that_it_vouches_for_is_wrong() {
    for run in [press_hold_release(), &run("light-touch"), &run("staircase")] {
        let rows = run.record.rows.iter();
        let wrong: Vec<&Row> = rows.filter(|row| is_wrong(row, &run.plant)).collect();
        assert!(
            wrong.is_empty(),
            "{} wrong, the first {:?}",
            wrong.len(),
            wrong[0]
        );
    }
}

#[test]
fn there_is_a_report_every_millisecond_and_a_reading_from_the_start_of_the_press() {
    let run = press_hold_release();
    let rows = &run.record.rows;
    assert_eq!((run.record.lost, run.record.broken.len()), (0, 0));
    assert!(
        rows.len() as f64 > (run.time - 0.01) / PERIOD,
        "{} reports",
        rows.len()
    );
    for pair in rows.windows(2).filter(|pair| pair[0].time > FIRST) {
        let step = pair[1].time - pair[0].time;
        assert!(
            (step - PERIOD).abs() < 0.02 * PERIOD,
            "{step} s at {} s",
            pair[0].time
        );
    }
    for row in rows.iter().filter(|row| row.time > START) {
        assert_eq!(row.status, Status::Ok, "at {} s", row.time);
    }
}

#[test]
fn it_says_which_design_and_why_it_started() {
    let run = press_hold_release();
    let hello = run.record.hellos.first().expect("it greets once a second");
    assert_eq!(hello.design_hash, design().hash());
    assert_eq!(hello.reset_cause.to_string(), "power-on");
    assert_eq!((hello.samples_lost, hello.frames_dropped), (0, 0));
}

#[test]
fn it_runs_without_a_reset_and_within_what_the_emulator_models() {
    let run = press_hold_release();
    assert_eq!(run.resets, Vec::<String>::new());
    assert_eq!(run.gaps, Vec::<String>::new());
}
