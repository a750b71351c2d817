//! A transducer whose supply is not the converter's reference: the image measures it beside the output.

use crate::cost::INSTRUCTIONS_PER_MILLISECOND;
use crate::{design_with, firmware_for};
use emulator::accuracy::is_wrong;
use emulator::bench;
use emulator::record::{Recorder, Row};
use emulator::scenario::Scenario;
use emulator::transducer::Wiring;
use fingertip::status::{Fault, Status};

/// A report is made of samples this long before and after its instant, seconds.
const REACH: f64 = 1.6e-3;
/// Readings are back this long after the supply is, seconds.
const RECOVERY: f64 = 0.01;
/// The firmware has its zero, seconds.
const START: f64 = 0.4;

#[test]
fn a_supply_that_sags_moves_nothing_and_one_that_fails_is_a_fault() {
    let design = design_with(
        "skin-analogue",
        "kind = \"ratiometric\"",
        "kind = \"ratiometric\"\nsupply = \"measured\"",
    );
    let image = firmware_for(&design);
    let scenario = Scenario::named("supply-sags").expect("it is shipped");
    let plant = design.plant(scenario.clone()).expect("it can be pressed");
    let recorder = Recorder::new(|_: &Row| {});
    let outcome =
        bench::run(image, plant.clone(), scenario.duration(), &[], recorder).expect("the image runs");
    let record = outcome.listener.into_record();

    assert_eq!(
        (outcome.resets, outcome.gaps, record.lost),
        (vec![], vec![], 0),
        "resets, gaps, frames lost"
    );
    let (mut sagging, mut unsupplied) = (0, 0);
    for row in record.rows.iter().filter(|row| row.time > START) {
        assert!(!is_wrong(row, &plant), "{row:?}");
        let wirings = [-REACH, 0.0, REACH].map(|offset| scenario.wiring(row.time + offset));
        if wirings == [Wiring::Unsupplied; 3] {
            assert_eq!(row.status, Status::Fault(Fault::SensorSupply), "{row:?}");
            unsupplied += 1;
        } else if scenario.wiring(row.time - RECOVERY) != Wiring::Unsupplied
            && !wirings.contains(&Wiring::Unsupplied)
        {
            assert_eq!(row.status, Status::Ok, "{row:?}");
            sagging += usize::from(wirings == [Wiring::Sag; 3]);
        }
    }
    assert!(
        sagging > 190 && unsupplied > 190,
        "{sagging} sagging, {unsupplied} unsupplied"
    );
    let per_millisecond = outcome.instructions as f64 / (outcome.time * 1e3);
    println!("with a measured supply: {per_millisecond:.0} instructions per millisecond");
    assert!(
        per_millisecond <= INSTRUCTIONS_PER_MILLISECOND,
        "{per_millisecond}"
    );
}
