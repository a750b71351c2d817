use super::*;
use proptest::prelude::*;

const GATES: Gates = Gates {
    rest: Pressure(10_000),
    band: 500,
    quiet: 20,
};

/// Steps once a millisecond with what `pressure` says of the millisecond, until there is a zero; the
/// millisecond of the first reading, and the reading.
fn first_reading(tare: &mut Tare, pressure: impl Fn(u64) -> i32) -> (u64, (PressureRise, Warnings)) {
    (0..10_000)
        .find_map(|ms| {
            let step = tare.step(Microseconds(ms * 1000), Pressure(pressure(ms)));
            step.ok().map(|reading| (ms, reading))
        })
        .expect("patience is bounded")
}

#[test]
fn a_quiet_rest_is_zeroed_in_one_window() {
    let mut tare = Tare::new(GATES, StartUp::Measured);
    // 10 100 and 10 102 in turns: mean 10 101, spread 2.
    let (ms, reading) = first_reading(&mut tare, |ms| 10_100 + 2 * (ms % 2) as i32);
    assert_eq!((ms, reading), (256, (PressureRise(-1), Warnings::NONE)));
    assert_eq!(
        tare.step(Microseconds(300_000), Pressure(10_601)),
        Ok((PressureRise(500), Warnings::NONE))
    );
}

#[test]
fn a_press_at_power_up_is_not_zeroed() {
    let mut tare = Tare::new(GATES, StartUp::Measured);
    let (ms, reading) = first_reading(&mut tare, |_| 12_000);
    assert_eq!(ms, 2001);
    assert_eq!(reading, (PressureRise(2_000), Warnings::ZERO_UNVERIFIED));
}

#[test]
fn a_press_that_ends_in_time_is_waited_for() {
    let mut tare = Tare::new(GATES, StartUp::Measured);
    let (ms, reading) = first_reading(&mut tare, |ms| if ms < 700 { 12_000 } else { 10_050 });
    // Windows of 256 from 0: the first without a trace of the press starts at 768.
    assert_eq!((ms, reading), (1024, (PressureRise(0), Warnings::NONE)));
}

#[test]
fn a_restless_fingertip_is_not_zeroed() {
    let mut tare = Tare::new(GATES, StartUp::Measured);
    let (_, reading) = first_reading(&mut tare, |ms| 10_000 + (ms % 22) as i32);
    assert_eq!(reading.1, Warnings::ZERO_UNVERIFIED);
}

#[test]
fn a_gap_starts_the_window_again() {
    let mut tare = Tare::new(GATES, StartUp::Measured);
    for ms in 0..200 {
        assert_eq!(
            tare.step(Microseconds(ms * 1000), Pressure(10_400)),
            Err(Fault::Zeroing)
        );
    }
    tare.interrupt(Microseconds(200_000));
    let (ms, reading) = first_reading(&mut tare, |_| 10_000);
    assert_eq!((ms, reading.0), (256, PressureRise(0)));
}

#[test]
fn patience_also_runs_while_there_are_no_blocks() {
    let mut tare = Tare::new(GATES, StartUp::Measured);
    tare.interrupt(Microseconds(0));
    tare.interrupt(Microseconds(5_000_000));
    assert_eq!(
        tare.step(Microseconds(5_001_000), Pressure(10_000)),
        Err(Fault::Zeroing)
    );
    assert_eq!(
        tare.step(Microseconds(5_002_000), Pressure(10_000)),
        Ok((PressureRise(0), Warnings::ZERO_UNVERIFIED))
    );
}

#[test]
fn only_a_reset_by_a_person_or_the_supply_measures() {
    for (cause, start_up) in [
        (ResetCause::PowerOn, StartUp::Measured),
        (ResetCause::Pin, StartUp::Measured),
        (ResetCause::BrownOut, StartUp::Measured),
        (ResetCause::Watchdog, StartUp::Stored),
        (ResetCause::Software, StartUp::Stored),
        (ResetCause::LowPower, StartUp::Stored),
        (ResetCause::Unknown, StartUp::Stored),
    ] {
        assert_eq!(StartUp::after(cause), start_up, "{cause}");
    }
    let mut tare = Tare::new(GATES, StartUp::Stored);
    assert_eq!(
        tare.step(Microseconds(0), Pressure(10_300)),
        Ok((PressureRise(300), Warnings::ZERO_UNVERIFIED))
    );
}

proptest! {
    #[test]
    fn a_measured_zero_is_always_within_the_band(base in 8_000..12_000_i32, noise in 0..30_i32) {
        let mut tare = Tare::new(GATES, StartUp::Measured);
        let (_, (rise, warnings)) =
            first_reading(&mut tare, |ms| base + (ms.wrapping_mul(2_654_435_761) >> 7) as i32 % (noise + 1));
        if warnings == Warnings::NONE {
            prop_assert!(rise.0.abs() <= GATES.quiet);
            prop_assert!((base - 10_000).abs() <= GATES.band + noise);
        }
    }

    #[test]
    fn no_input_panics(steps in prop::collection::vec((any::<u64>(), any::<i32>(), any::<bool>()), 0..600)) {
        let mut tare = Tare::new(GATES, StartUp::Measured);
        for (time, pressure, gap) in steps {
            if gap {
                tare.interrupt(Microseconds(time));
            }
            let _ = tare.step(Microseconds(time), Pressure(pressure));
        }
    }
}
