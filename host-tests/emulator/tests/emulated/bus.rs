//! A transducer on a bus: the image for each kind of part. The DPS310 is as the emulator's authors model it.

use crate::{design_with, firmware_for};
use emulator::accuracy::is_wrong;
use emulator::bench;
use emulator::plant::Plant;
use emulator::record::{Recorder, Recording, Row};
use emulator::scenario::{Scenario, WireFault};
use emulator::transducer::Wiring;
use fingertip::status::{Fault, Status};
use fingertip::transducer::{abp2, dps310, ms5837};
use std::sync::OnceLock;

/// A report is made of this many samples, and dated to the middle one.
const SAMPLES: f64 = 3.0;
/// The tare of the scenario is done, seconds.
const ZEROED: f64 = 0.9;

struct Run {
    kind: &'static str,
    /// From one sample to the next, seconds.
    sample: f64,
    record: Recording,
    plant: Plant,
    scenario: Scenario,
    resets: Vec<String>,
    gaps: Vec<String>,
}

impl Run {
    /// Readings are back this long after their cause has gone, seconds: a tenth of a second until the part gives samples,
    /// and what the filter needs of them.
    fn recovery(&self) -> f64 {
        0.1 + SAMPLES * self.sample
    }
}

/// Every kind, gone through once for all tests.
fn runs() -> &'static [Run; 3] {
    static RUNS: OnceLock<[Run; 3]> = OnceLock::new();
    RUNS.get_or_init(|| {
        [
            ("dps310", dps310::PERIOD),
            ("abp2", abp2::PERIOD),
            ("ms5837-02ba", ms5837::PERIOD),
        ]
        .map(|(kind, period)| run(kind, f64::from(period) * 1e-6))
    })
}

fn run(kind: &'static str, sample: f64) -> Run {
    let design = design_with(
        "skin-light-touch",
        "kind = \"dps310\"",
        &format!("kind = \"{kind}\""),
    );
    let image = firmware_for(&design);
    let scenario = Scenario::named("bus-faults").expect("it is shipped");
    let plant = design.plant(scenario.clone()).expect("it can be pressed");
    let recorder = Recorder::new(|_: &Row| {});
    let outcome =
        bench::run(image, plant.clone(), scenario.duration(), &[], recorder).expect("the image runs");
    Run {
        kind,
        sample,
        record: outcome.listener.into_record(),
        plant,
        scenario,
        resets: outcome.resets,
        gaps: outcome.gaps,
    }
}

fn window(fault: &WireFault) -> (f64, f64) {
    let until = fault.until_ms.expect("every fault ends");
    (fault.from_ms * 1e-3, until * 1e-3)
}

#[test]
fn a_press_is_read_at_the_parts_own_pace() {
    for run in runs() {
        let (kind, rows) = (run.kind, &run.record.rows);
        let count = rows.iter().filter(|row| (1.0..2.0).contains(&row.time)).count() as f64;
        let expected = 1.0 / run.sample;
        assert!(
            (count - expected).abs() <= 2.0,
            "{kind}: {count} reports a second, not {expected:.0}"
        );
    }
}

#[test]
fn no_fault_of_the_bus_becomes_a_number() {
    for run in runs() {
        let zeroed = run.record.rows.iter().filter(|row| row.time > ZEROED);
        let readings: Vec<&Row> = zeroed.filter(|row| row.reported.is_some()).collect();
        let held = readings
            .iter()
            .filter(|row| row.truth.pressure_rise > 500.0)
            .count();
        assert!(held > 200, "{}: {held} readings of the press", run.kind);
        for row in readings {
            // Whatever qualifies it, it is right.
            let as_ok = Row {
                status: Status::Ok,
                ..*row
            };
            assert!(!is_wrong(&as_ok, &run.plant), "{}: {row:?}", run.kind);
            assert_eq!(row.status, Status::Ok, "{}: {row:?}", run.kind);
        }
    }
}

/// The reasons that a part must give for a fault, and those that it may give.
fn reasons(kind: &str, fault: Wiring) -> (Vec<Fault>, Vec<Fault>) {
    let only = |fault| (vec![fault], vec![fault]);
    match (fault, kind) {
        // Nobody acknowledges the address, ever or now and then.
        (Wiring::Off | Wiring::Intermittent, _) => only(Fault::SensorAbsent),
        // Nobody answers with the right identity, ...
        (Wiring::Wrong, "dps310") => only(Fault::WrongSensor),
        // ... a status that the part has, ...
        (Wiring::Wrong, "abp2") => only(Fault::SensorImplausible),
        // ... or calibration words that fit their check.
        (Wiring::Wrong, _) => only(Fault::SensorCalibration),
        // The MS5837 alone is read blindly after its longest conversion.
        (Wiring::Slow, _) | (Wiring::Delayed, "ms5837-02ba") => only(Fault::SensorBusy),
        // A reset is over before a report is made of samples after it alone.
        (Wiring::Delayed | Wiring::Stuck | Wiring::Reset, _) => (vec![], vec![]),
        // Whatever is read first is no identity, no settings, no calibration, no status and no word: but somebody answers.
        (Wiring::Garbage, _) => (
            vec![],
            vec![
                Fault::WrongSensor,
                Fault::SensorCalibration,
                Fault::SensorReset,
                Fault::SensorBusy,
                Fault::SensorMemory,
                Fault::SensorSaturated,
                Fault::SensorImplausible,
            ],
        ),
        (Wiring::Sound | Wiring::Open | Wiring::Short | Wiring::Sag | Wiring::Unsupplied, _) => {
            unreachable!("not of a bus")
        }
    }
}

#[test]
fn every_fault_of_the_bus_has_its_reason_and_is_over_in_a_tenth_of_a_second() {
    for run in runs() {
        for fault in &run.scenario.wire {
            check(run, fault);
        }
    }
}

fn check(run: &Run, fault: &WireFault) {
    let (from, until) = window(fault);
    let around = SAMPLES * run.sample;
    let mut reported: Vec<Fault> = vec![];
    for row in &run.record.rows {
        if (from + around..until - around).contains(&row.time)
            && let Status::Fault(fault) = row.status
            && fault != Fault::Settling
            && !reported.contains(&fault)
        {
            reported.push(fault);
        }
    }
    let mut rows = run.record.rows.iter();
    let back = rows
        .find(|row| row.time > until && row.reported.is_some())
        .expect("readings come back")
        .time
        - until;
    println!(
        "{}, {:?}: {reported:?}, a reading {back:.3} s after it ended",
        run.kind, fault.is
    );
    let (must, may) = reasons(run.kind, fault.is);
    let about = format!("{}, {:?}: {reported:?}", run.kind, fault.is);
    assert!(must.iter().all(|fault| reported.contains(fault)), "{about}");
    // Bytes of chance have one reason or another, and one at least.
    assert!(fault.is != Wiring::Garbage || !reported.is_empty(), "{about}");
    // A start of the part that was broken off may leave another reason once, at the edges.
    assert!(reported.iter().all(|fault| may.contains(fault)), "{about}");
    assert!(back < run.recovery(), "{about}: {back} s");
}

#[test]
fn a_part_that_lost_its_settings_is_set_up_again() {
    let [run, ..] = runs();
    let fault = run.scenario.wire.iter().find(|fault| fault.is == Wiring::Reset);
    let (from, until) = window(fault.expect("it is in the scenario"));
    let mut rows = run
        .record
        .rows
        .iter()
        .filter(|row| row.time > from && row.time < until + run.recovery());
    assert!(rows.any(|row| matches!(row.status, Status::Fault(fault) if fault != Fault::Settling)));
}

#[test]
fn no_fault_of_the_bus_resets_the_chip() {
    for run in runs() {
        assert_eq!(run.resets, Vec::<String>::new(), "{}", run.kind);
        assert_eq!(run.gaps, Vec::<String>::new(), "{}", run.kind);
        assert_eq!(run.record.lost, 0, "{}", run.kind);
    }
}
