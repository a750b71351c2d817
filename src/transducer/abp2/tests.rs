use super::*;
use crate::transducer::script::{Script, Step, Stopwatch, fail_everywhere, play, read, write};
use model_tables::constants::Quantity;
use proptest::prelude::*;

/// -1 to 1 psi by transfer function A, as the datasheet's example has it; 1 psi is 6894.757 Pa.
const ONE_PSI: constants::Transducer = transducer([-6895, 6895], [1_677_722, 15_099_494]);

const fn transducer(range: [i32; 2], counts: [u32; 2]) -> constants::Transducer {
    constants::Transducer {
        range,
        resolution: 1000,
        noise: 1000,
        quantity: Quantity::Gauge,
        kind: TransducerKind::Abp2 {
            address: 0x28,
            counts,
        },
    }
}

/// What a start and a sample ask, both answered alike: a measurement commanded, then seven bytes.
fn steps(status: u8, pressure: u32, temperature: u32) -> Vec<Step> {
    let ([_, p @ ..], [_, t @ ..]) = (pressure.to_be_bytes(), temperature.to_be_bytes());
    let mut bytes = vec![status];
    bytes.extend(p);
    bytes.extend(t);
    let measurement = [write(&[0xAA, 0x00, 0x00]), read(&[], bytes)];
    [measurement.clone(), measurement].concat()
}

fn part(script: Script, stopwatch: Stopwatch) -> Abp2<Script, Stopwatch> {
    Abp2::new(&ONE_PSI, script, stopwatch)
}

fn outcome(status: u8, pressure: u32, temperature: u32) -> Result<Sample, Fault> {
    play(0x28, &steps(status, pressure, temperature), part).0
}

#[test]
fn a_measurement_transaction_by_transaction() {
    // The datasheet's worked examples (section 6), which other drivers' tests quote too: 0.875 psi and 25 degC.
    // 14 260 634 counts are (14260634 - 1677722) / (15099494 - 1677722) = 0.9375 of the range: 0.875 psi. 6 291 456 of
    // 16 777 215 counts of 200 K are 75 K: 25 degC.
    let (outcome, waited) = play(0x28, &steps(0x40, 14_260_634, 6_291_456), part);
    let sample = outcome.expect("a sound part");
    assert!(sample.pressure.0.abs_diff(6_033_125) <= 1, "{sample:?}");
    assert!(
        sample.headroom.0.abs_diff(6_895_000 - 6_033_125) <= 1,
        "{sample:?}"
    );
    assert_eq!(sample.temperature, Some(Centidegrees(2500)));
    assert_eq!(sample.raw, Some(14_260_634));
    assert_eq!(waited, 10_000);
}

#[test]
fn every_transaction_that_fails_is_a_fault_and_passes() {
    assert_eq!(
        fail_everywhere(0x28, &steps(0x40, 8_388_608, 6_291_456), part),
        24
    );
}

#[test]
fn every_status_is_a_sample_or_its_reason() {
    for status in 0..=u8::MAX {
        let measured = ONE_PSI_LINE.sample([status, 0x80, 0, 0, 0x60, 0, 0]);
        let expected = match status {
            0xFF => Err(Fault::SensorImplausible),
            _ if status & 0x40 == 0 => Err(Fault::SensorImplausible),
            _ if status & 0x04 != 0 => Err(Fault::SensorMemory),
            _ if status & 0x01 != 0 => Err(Fault::SensorSaturated),
            _ if status & 0x20 != 0 => Err(Fault::SensorBusy),
            _ => Ok(()),
        };
        assert_eq!(measured.map(|_| ()), expected, "{status:#04x}");
    }
}

const ONE_PSI_LINE: Line = Line {
    counts: [1_677_722, 15_099_494],
    range: [-6895, 6895],
};

#[test]
fn an_undriven_line_is_no_pressure() {
    assert_eq!(
        outcome(0xFF, 0x00FF_FFFF, 0x00FF_FFFF),
        Err(Fault::SensorImplausible)
    );
    assert_eq!(outcome(0x00, 0, 0), Err(Fault::SensorImplausible));
    assert_eq!(outcome(0x40, 0x00FF_FFFF, 6_291_456), Err(Fault::SensorSaturated));
    assert_eq!(outcome(0x40, 0, 6_291_456), Err(Fault::SensorSaturated));
}

#[test]
fn busy_is_waited_for_and_not_for_ever() {
    let busy = read(&[], [0x60, 0, 0, 0, 0, 0, 0]);
    let command = write(&[0xAA, 0x00, 0x00]);
    let done = read(&[], [0x40, 0x80, 0, 0, 0x60, 0, 0]);
    let mut once = vec![command.clone(), busy.clone(), done.clone()];
    once.extend([command.clone(), done]);
    let (outcome, waited) = play(0x28, &once, part);
    assert!(outcome.is_ok());
    assert_eq!(waited, 10_500);
    let for_ever = [vec![command], vec![busy; 4]].concat();
    let (outcome, waited) = play(0x28, &for_ever, part);
    assert_eq!(outcome, Err(Fault::SensorBusy));
    assert_eq!(waited, 7_000);
}

proptest! {
    #[test]
    fn pressure_is_the_datasheets_line(
        pressure in 1_u32..0x00FF_FFFF,
        temperature in 0_u32..=0x00FF_FFFF,
        start in -100_000_i32..100_000,
        span in 1000_i32..1_000_000,
        transfer in any::<bool>(),
    ) {
        let counts = if transfer { [1_677_722, 15_099_494] } else { [5_033_165, 11_744_051] };
        let line = Line { counts, range: [start, start + span] };
        let [_, p2, p1, p0] = pressure.to_be_bytes();
        let [_, t2, t1, t0] = temperature.to_be_bytes();
        let sample = line.sample([0x40, p2, p1, p0, t2, t1, t0]).expect("every other word is one");
        let [low, high] = counts.map(f64::from);
        let exact = (f64::from(pressure) - low) / (high - low) * f64::from(span) + f64::from(start);
        prop_assert!((f64::from(sample.pressure.0) - exact * 1e3).abs() <= 0.51);
        let degrees = f64::from(temperature) * 200.0 / 16_777_215.0 - 50.0;
        prop_assert!((f64::from(sample.temperature.expect("measured").0) - degrees * 100.0).abs() <= 0.51);
        let beyond = exact > f64::from(start + span) + 0.001;
        prop_assert_eq!(sample.headroom.0 < 0, beyond || sample.pressure.0 > (start + span) * 1000);
    }

    #[test]
    fn no_answer_makes_it_panic(bytes in any::<[u8; 7]>()) {
        if let Ok(sample) = ONE_PSI_LINE.sample(bytes) {
            prop_assert_eq!(bytes[0] & 0x65, 0x40);
            // 10 % of counts beyond each end is 12.5 % of the range.
            prop_assert!(sample.pressure.0.abs() <= 6_895_000 + 13_790_000 / 8 + 1);
        }
    }
}
