//! A fault never becomes a number.

use crate::run;
use emulator::accuracy::is_wrong;
use emulator::transducer::Wiring;
use fingertip::status::{Fault, Status};

/// A report is made of samples this long before and after its instant: half a block and the filter's two blocks,
/// seconds, and a little for the instant itself.
const REACH: f64 = 1.5e-3 + 0.1e-3;
/// Readings are back this long after the wire is, seconds.
const RECOVERY: f64 = 0.01;

#[test]
fn a_broken_or_shorted_wire_is_a_fault_and_no_reading() {
    let run = run("sensor-unplugged");
    let scenario = run.plant.scenario();
    let (mut open, mut short) = (0, 0);
    for row in &run.record.rows {
        let wirings = [-REACH, 0.0, REACH].map(|offset| scenario.wiring(row.time + offset));
        if wirings.iter().all(|&wiring| wiring == Wiring::Open) {
            assert_eq!(row.status, Status::Fault(Fault::SensorOpen), "at {} s", row.time);
            open += 1;
        } else if wirings.iter().all(|&wiring| wiring == Wiring::Short) {
            assert_eq!(row.status, Status::Fault(Fault::SensorShort), "at {} s", row.time);
            short += 1;
        }
        // Where the faulty stretch only touches the samples, there may be a fault or a reading, but a right one.
        assert!(!is_wrong(row, &run.plant), "{row:?}");
    }
    // 300 ms open and 200 ms shorted, less the reach at each end.
    assert!(open >= 295 && short >= 195, "{open} open, {short} short");
}

#[test]
fn readings_are_back_ten_milliseconds_after_the_wire() {
    let run = run("sensor-unplugged");
    for fault in &run.plant.scenario().wire {
        let until = fault.until_ms.expect("both faults end") * 1e-3;
        let row = run
            .record
            .rows
            .iter()
            .find(|row| row.time > until + RECOVERY)
            .expect("the scenario goes on");
        assert_eq!(row.status, Status::Ok, "{row:?}");
    }
}

#[test]
fn a_fault_of_the_wire_resets_nothing() {
    let run = run("sensor-unplugged");
    assert_eq!(run.resets, Vec::<String>::new());
    assert_eq!(run.record.lost, 0);
}
