//! A transducer on a bus: the image for a DPS310, against the part as the emulator's authors model it.

use emulator::bench;
use emulator::fingertip_design::FingertipDesign;
use emulator::image::Image;
use emulator::record::{Record, Recorder, Row};
use emulator::scenario::{Scenario, WireFault};
use emulator::transducer::Wiring;
use fingertip::report::{Fault, Status};
use fingertip::transducer::dps310::PERIOD;
use std::sync::OnceLock;

/// From one sample to the next, seconds.
const SAMPLE: f64 = PERIOD as f64 * 1e-6;
/// A report is made of this many samples, and dated to the middle one.
const SAMPLES: f64 = 3.0;
/// Readings are back this long after their cause has gone, seconds: a tenth of a second until the part gives samples, and
/// what the filter needs of them.
const RECOVERY: f64 = 0.1 + SAMPLES * SAMPLE;
/// How far two readings of the same press may differ, pascals: the noise of 1 Pa, a pascal of rounding, and the plate's
/// own rest.
const SAME: f64 = 8.0;

struct Run {
    record: Record,
    scenario: Scenario,
    resets: Vec<String>,
    gaps: Vec<String>,
}

fn run() -> &'static Run {
    static RUN: OnceLock<Run> = OnceLock::new();
    RUN.get_or_init(|| {
        let design = FingertipDesign::read(&host_tests::design("skin-light-touch")).expect("it is shipped");
        let image = Image::firmware(Some(&design.path)).expect("the firmware builds");
        let scenario = Scenario::named("bus-faults").expect("it is shipped");
        let plant = design.plant(scenario.clone()).expect("it can be pressed");
        let recorder = Recorder::new(|_: &Row| {});
        let outcome = bench::run(&image, plant, scenario.duration(), &[], recorder).expect("the image runs");
        Run {
            record: outcome.listener.into_record(),
            scenario,
            resets: outcome.resets,
            gaps: outcome.gaps,
        }
    })
}

/// Pressure rises of all readings while the press is held: one number, but for noise.
fn held(run: &Run) -> Vec<(f64, f64)> {
    run.record
        .rows
        .iter()
        .filter(|row| (1.6..6.9).contains(&row.time))
        .filter_map(|row| Some((row.time, row.reported?.pressure_rise)))
        .collect()
}

fn window(fault: &WireFault) -> (f64, f64) {
    let until = fault.until_ms.expect("every fault ends");
    (fault.from_ms * 1e-3, until * 1e-3)
}

#[test]
fn a_press_is_read_at_the_parts_own_pace() {
    let rows = &run().record.rows;
    let count = rows.iter().filter(|row| (1.0..2.0).contains(&row.time)).count() as f64;
    let expected = 1.0 / SAMPLE;
    assert!(
        (count - expected).abs() <= 2.0,
        "{count} reports a second, not {expected:.0}"
    );
    // From the press to the rest after it, whatever the zero.
    let at = |time: f64| {
        let row = rows.iter().find(|row| row.time > time && row.reported.is_some());
        let row = row.expect("the part works there");
        (
            row.truth.pressure_rise,
            row.reported.expect("a reading").pressure_rise,
        )
    };
    let (pressed, rest) = (at(6.8), at(7.7));
    let (truth, reported) = (pressed.0 - rest.0, pressed.1 - rest.1);
    assert!(
        truth > 500.0 && (truth - reported).abs() < SAME,
        "{reported} Pa for {truth} Pa"
    );
}

#[test]
fn no_fault_of_the_bus_becomes_a_number() {
    let held = held(run());
    let mut rises: Vec<f64> = held.iter().map(|(_, rise)| *rise).collect();
    rises.sort_by(f64::total_cmp);
    let median = rises[rises.len() / 2];
    assert!(held.len() > 200);
    for (time, rise) in held {
        assert!(
            (rise - median).abs() < SAME,
            "{rise} Pa for {median} Pa at {time} s"
        );
    }
}

#[test]
fn every_fault_of_the_bus_has_its_reason_and_is_over_in_a_tenth_of_a_second() {
    let run = run();
    for fault in &run.scenario.wire {
        let (from, until) = window(fault);
        let within = |row: &&Row| row.time > from + SAMPLES * SAMPLE && row.time < until - SAMPLES * SAMPLE;
        let mut said: Vec<Fault> = vec![];
        for row in run.record.rows.iter().filter(within) {
            if let Status::Fault(fault) = row.status
                && !said.contains(&fault)
            {
                said.push(fault);
            }
        }
        let after = |row: &&Row| (from..until).contains(&row.time) && matches!(row.status, Status::Fault(_));
        let first = run.record.rows.iter().find(after).map(|row| row.time - from);
        let back = run
            .record
            .rows
            .iter()
            .find(|row| row.time > until && row.reported.is_some());
        let back = back.expect("readings come back").time - until;
        println!(
            "{:?}: {said:?}, first fault {first:?} s after it began, a reading {back:.3} s after it ended",
            fault.is
        );
        let expected: &[Fault] = match fault.is {
            Wiring::Off => &[Fault::SensorAbsent],
            // Nobody answers with the right identity.
            Wiring::Wrong => &[Fault::WrongSensor],
            Wiring::Slow => &[Fault::SensorBusy],
            Wiring::Delayed | Wiring::Stuck => &[],
            // Whatever is read first.
            Wiring::Garbage | Wiring::Intermittent | Wiring::Reset => &said,
            Wiring::Sound | Wiring::Open | Wiring::Short => unreachable!("not of a bus"),
        };
        let reasons = said.iter().filter(|fault| **fault != Fault::Settling);
        assert!(
            reasons.clone().all(|fault| expected.contains(fault)),
            "{:?}: {said:?}",
            fault.is
        );
        assert!(
            expected.iter().all(|fault| said.contains(fault)),
            "{:?}: {said:?}",
            fault.is
        );
        assert!(back < RECOVERY, "{:?}: {back} s", fault.is);
    }
}

#[test]
fn a_part_that_lost_its_settings_is_set_up_again() {
    let run = run();
    let fault = run.scenario.wire.iter().find(|fault| fault.is == Wiring::Reset);
    let (from, until) = window(fault.expect("it is in the scenario"));
    let mut rows = run
        .record
        .rows
        .iter()
        .filter(|row| row.time > from && row.time < until + RECOVERY);
    assert!(rows.any(|row| matches!(row.status, Status::Fault(fault) if fault != Fault::Settling)));
}

#[test]
fn no_fault_of_the_bus_resets_the_chip() {
    assert_eq!(run().resets, Vec::<String>::new());
    assert_eq!(run().gaps, Vec::<String>::new());
    assert_eq!(run().record.lost, 0);
}
