use super::*;
use crate::signal::test_design::{Linear, RISE_END};
use crate::status::{Status, Warnings};
use crate::units::Millipascals;
use model_tables::units::PressureRise;
use proptest::prelude::*;

/// A sample at a gauge pressure, of a transducer up to 100 kPa; half a millisecond old.
fn at(pascals: f64) -> Sample {
    let millipascals = (pascals * 1000.0).round() as i32;
    Sample {
        pressure: Millipascals(millipascals),
        headroom: Millipascals(100_000_000 - millipascals),
        age: 500,
        ..Sample::default()
    }
}

/// A path and the millisecond it has come to.
struct Bench {
    pipeline: Pipeline<Linear>,
    milliseconds: u64,
}

/// Counts of 1/256 Pa.
fn pascals(pascals: i32) -> PressureRise {
    PressureRise(pascals << 8)
}

impl Bench {
    fn new(start_up: StartUp) -> Self {
        Self {
            pipeline: Pipeline::new(Linear::NEW, start_up, Calibration::default(), Warnings::NONE),
            milliseconds: 0,
        }
    }

    fn step(&mut self, sample: Result<Sample, Fault>) -> Report {
        self.milliseconds += 1;
        self.pipeline.step(Microseconds(self.milliseconds * 1000), sample)
    }

    /// The last of `times` reports of the same block.
    fn steps(&mut self, times: u32, sample: Result<Sample, Fault>) -> Report {
        (1..times).for_each(|_| {
            self.step(sample);
        });
        self.step(sample)
    }

    /// At rest and zeroed, 100 Pa off the design's rest pressure.
    fn zeroed() -> Self {
        let mut bench = Self::new(StartUp::Measured);
        assert_eq!(bench.steps(256, Ok(at(20_100.0))).outcome, Err(Fault::Zeroing));
        assert_eq!(bench.steps(2, Ok(at(20_100.0))).outcome, Err(Fault::Settling));
        let rest = bench.step(Ok(at(20_100.0)));
        assert_eq!(rest.status(), Status::Ok);
        bench
    }
}

#[test]
fn a_press_is_measured_from_its_zero() {
    let mut bench = Bench::zeroed();
    let report = bench.steps(3, Ok(at(21_100.0)));
    let measurement = report.outcome.expect("a plain press");
    assert_eq!(report.status(), Status::Ok);
    // 1000 Pa at 1/256 Pa.
    assert_eq!(measurement.pressure_rise.0, 256_000);
    assert_eq!(measurement.force.0, measurement.pressure_rise.0);
}

#[test]
fn a_moving_press_is_dated_to_the_middle_of_its_samples() {
    let mut bench = Bench::zeroed();
    let start = bench.milliseconds;
    // 100 Pa a millisecond: the block that ends at m ms averages to 100 (m - 1/2 - start) Pa.
    for _ in 0..200 {
        let pascals = 100.0 * ((bench.milliseconds - start) as f64 + 0.5);
        let report = bench.step(Ok(at(20_100.0 + pascals)));
        let Ok(measurement) = report.outcome else {
            continue;
        };
        let truth = 100.0 * (report.time.0 as f64 / 1000.0 - start as f64);
        if truth > 200.0 {
            let got = f64::from(measurement.pressure_rise.0) / 256.0;
            assert!((got - truth).abs() < 0.5, "{got} Pa for {truth} Pa");
        }
    }
}

#[test]
fn a_fault_has_no_values_and_ends_with_its_cause() {
    let mut bench = Bench::zeroed();
    assert_eq!(bench.step(Err(Fault::SensorOpen)).outcome, Err(Fault::SensorOpen));
    assert_eq!(bench.step(Ok(at(25_100.0))).outcome, Err(Fault::Settling));
    assert_eq!(bench.step(Ok(at(25_100.0))).outcome, Err(Fault::Settling));
    let report = bench.step(Ok(at(25_100.0)));
    // The zero from before the fault still holds.
    let rise = report.outcome.expect("settled").pressure_rise.0;
    assert!(rise.abs_diff(5000 << 8) <= 64);
}

#[test]
fn beyond_the_tables_and_beyond_the_transducer_read_as_lower_bounds() {
    let mut bench = Bench::zeroed();
    for pascals in [70_000.0, 101_000.0] {
        // A step that no press makes has no number for eight blocks.
        let measurement = bench.steps(12, Ok(at(pascals))).outcome.expect("held at the end");
        assert_eq!(measurement.warnings, Warnings::SATURATED);
        assert_eq!(measurement.force.0, RISE_END);
    }
}

#[test]
fn powered_up_while_pressed_is_reported_so() {
    let mut bench = Bench::new(StartUp::Measured);
    let report = bench.steps(2_100, Ok(at(30_000.0)));
    assert_eq!(report.status().to_string(), "warning: zero unverified");
    let rise = report
        .outcome
        .expect("the design's rest pressure is valid")
        .pressure_rise
        .0;
    assert!(rise.abs_diff(10_000 << 8) <= 64);
}

#[test]
fn a_pressure_below_the_zero_is_reported_so() {
    let mut bench = Bench::zeroed();
    let report = bench.steps(5, Ok(at(19_000.0)));
    assert_eq!(report.status().to_string(), "warning: below zero; zero aged");
    assert_eq!(
        bench.steps(5, Ok(at(20_030.0))).status().to_string(),
        "warning: zero aged"
    );
    assert_eq!(bench.steps(5, Ok(at(20_100.0))).status(), Status::Ok);
}

#[test]
fn after_a_watchdog_reset_there_are_readings_at_once_with_an_unverified_zero() {
    let mut bench = Bench::new(StartUp::Stored);
    let report = bench.steps(3, Ok(at(25_000.0)));
    assert_eq!(report.status().to_string(), "warning: zero unverified");
}

#[test]
fn a_leak_is_suspected_after_a_minute_and_stays() {
    let mut bench = Bench::zeroed();
    // Rests at 20 kPa: an eighth of it is 2.5 kPa below the design's rest.
    bench.steps(61_000, Ok(at(17_400.0)));
    let report = bench.steps(20, Ok(at(20_100.0)));
    assert_eq!(report.status().to_string(), "warning: leak suspected; zero aged");
}

#[test]
fn a_touch_is_told_with_its_hysteresis() {
    let mut bench = Bench::zeroed();
    let mut touch = |rise: f64| {
        bench
            .steps(5, Ok(at(20_100.0 + rise)))
            .outcome
            .expect("a reading")
            .touch
    };
    let touches = [0.0, 59.0, 61.0, 31.0, 29.0].map(&mut touch);
    let (on, off, unknown) = (Touch::Touched, Touch::Untouched, Touch::Unknown);
    assert_eq!(touches, [off, unknown, on, on, off]);
}

#[test]
fn one_sigma_is_of_the_transducer_and_grows_with_doubt() {
    let mut bench = Bench::zeroed();
    let sure = bench.steps(3, Ok(at(21_100.0))).outcome.expect("a reading").sigma;
    // 2.9 Pa of noise and resolution, and a zero within 5 Pa, which is as much: 4.1 Pa, to 3 %. The test design has 1 uN and
    // 1 nm a count.
    assert!((sure.pressure_rise.0 - 1_050).abs() < 32, "{sure:?}");
    assert_eq!(sure.force.0, sure.pressure_rise.0);
    assert_eq!(sure.indentation.0, sure.pressure_rise.0);
    let mut bench = Bench::new(StartUp::Stored);
    let unsure = bench.steps(3, Ok(at(21_100.0))).outcome.expect("a reading").sigma;
    assert!(unsure.pressure_rise > pascals(1_400) && unsure.force.0 > 1_400 << 8);
}

#[test]
fn a_tare_is_refused_on_a_pressed_tip_and_undone_on_demand() {
    let mut bench = Bench::zeroed();
    bench.steps(50, Ok(at(25_000.0)));
    bench.pipeline.tare().expect("nothing is under way");
    bench.steps(2_100, Ok(at(25_000.0)));
    assert_eq!(bench.pipeline.take_tare_answer(), Some(Err(TareRefusal::Touched)));
    bench.steps(50, Ok(at(20_140.0)));
    bench.pipeline.tare().expect("nothing presses");
    bench.steps(300, Ok(at(20_140.0)));
    assert_eq!(bench.pipeline.take_tare_answer(), Some(Ok(())));
    let rise = |report: Report| report.outcome.expect("a reading").pressure_rise;
    assert_eq!(rise(bench.step(Ok(at(20_140.0)))), pascals(0));
    bench.pipeline.undo_tare().expect("there is one");
    // But for what it followed meanwhile, half a pascal a second.
    let rise = rise(bench.steps(4, Ok(at(20_140.0))));
    assert!((rise.0 - (40 << 8)).abs() < 128, "{rise:?}");
}

#[test]
fn a_stuck_word_is_a_fault_and_a_living_one_is_not() {
    let mut bench = Bench::zeroed();
    let word = |raw: u32| {
        Ok(Sample {
            raw: Some(raw),
            ..at(20_100.0)
        })
    };
    for raw in 0..3_000 {
        assert!(bench.step(word(raw)).outcome.is_ok());
    }
    assert_eq!(bench.steps(2_001, word(7)).outcome, Err(Fault::Stuck));
    assert_eq!(bench.steps(3, word(8)).status(), Status::Ok);
}

#[test]
fn temperature_is_compensated_untouched_and_held_in_contact() {
    let calibration = Calibration {
        zero: Some(Millipascals(20_000_000)),
        temperature: Some(Centidegrees(2_000)),
        coefficient: 10_000,
        gain: 0,
    };
    let mut bench = Bench {
        pipeline: Pipeline::new(Linear::NEW, StartUp::Measured, calibration, Warnings::NONE),
        milliseconds: 0,
    };
    let warm = |pascals: f64, centidegrees: i16| {
        Ok(Sample {
            temperature: Some(Centidegrees(centidegrees)),
            ..at(pascals)
        })
    };
    bench.steps(400, warm(20_000.0, 2_000));
    let rise = |report: Report| f64::from(report.outcome.expect("a reading").pressure_rise.0) / 256.0;
    // 10 Pa a kelvin: 5 K later the part reads 50 Pa more, and it is none.
    assert!(rise(bench.steps(5, warm(20_050.0, 2_500))).abs() < 0.1);
    assert!((rise(bench.steps(5, warm(21_050.0, 2_500))) - 1000.0).abs() < 0.1);
    // 10 K more in contact: nothing moves, and the doubt is reported.
    let report = bench.steps(5, warm(21_050.0, 3_500));
    assert!((rise(report) - 1000.0).abs() < 0.1);
    assert_eq!(report.status().to_string(), "warning: temperature");
    let sigma = report.outcome.expect("a reading").sigma.pressure_rise;
    assert!(sigma > pascals(99) && sigma < pascals(104), "{sigma:?}");
}

#[test]
fn what_is_stored_is_the_zero_that_is_in_use_and_is_in_use_at_the_next_start() {
    let mut bench = Bench::zeroed();
    bench.steps(50, Ok(at(20_100.0)));
    let calibration = bench.pipeline.calibration_to_store().expect("it is verified");
    assert!((calibration.zero.expect("a zero").0 - 20_100_000).abs() < 100);
    let mut next = Bench {
        pipeline: Pipeline::new(Linear::NEW, StartUp::Measured, calibration, Warnings::NONE),
        milliseconds: 0,
    };
    // 150 Pa over the design's rest pressure, 50 over the stored zero.
    assert_eq!(next.steps(400, Ok(at(20_150.0))).status(), Status::Ok);
    // A still press at power-up of 300 Pa over it is not taken for the zero.
    let mut pressed = Bench {
        pipeline: Pipeline::new(Linear::NEW, StartUp::Measured, calibration, Warnings::NONE),
        milliseconds: 0,
    };
    let report = pressed.steps(2_100, Ok(at(20_400.0)));
    assert_eq!(report.status().to_string(), "warning: zero unverified");
    let rise = report.outcome.expect("the stored zero is in use").pressure_rise;
    assert!((rise.0 - (300 << 8)).abs() < 64);
    assert_eq!(pressed.pipeline.calibration_to_store(), None);
}

#[test]
fn the_gain_trim_scales_the_rise() {
    let calibration = Calibration {
        gain: 50_000,
        ..Calibration::default()
    };
    let mut bench = Bench {
        pipeline: Pipeline::new(Linear::NEW, StartUp::Measured, calibration, Warnings::NONE),
        milliseconds: 0,
    };
    bench.steps(400, Ok(at(20_000.0)));
    let rise = bench
        .steps(12, Ok(at(30_000.0)))
        .outcome
        .expect("a press")
        .pressure_rise;
    assert!((rise.0 - (10_500 << 8)).abs() <= 2, "{rise:?}");
}

#[test]
fn what_stands_since_start_up_qualifies_every_reading_until_it_is_seen_to() {
    let mut bench = Bench {
        pipeline: Pipeline::new(
            Linear::NEW,
            StartUp::Measured,
            Calibration::default(),
            Warnings::CALIBRATION_REFUSED,
        ),
        milliseconds: 0,
    };
    let report = bench.steps(400, Ok(at(20_000.0)));
    assert_eq!(report.status().to_string(), "warning: calibration refused");
    let calibration = bench.pipeline.calibration_to_store().expect("it is verified");
    bench.pipeline.calibrated(Some(calibration));
    assert_eq!(bench.steps(3, Ok(at(20_000.0))).status(), Status::Ok);
}

#[test]
fn softer_than_the_model_at_a_known_indentation_is_reported_so() {
    let mut bench = Bench::zeroed();
    let read = bench
        .steps(12, Ok(at(21_100.0)))
        .outcome
        .expect("a press")
        .indentation;
    assert!(!bench.pipeline.compare(read, Nanometres(read.0 * 2)));
    assert_eq!(
        bench.step(Ok(at(21_100.0))).status().to_string(),
        "warning: bubble suspected"
    );
}

proptest! {
    #[test]
    fn no_history_panics_and_no_fault_has_values(
        steps in prop::collection::vec((any::<u64>(), any::<[i32; 2]>(), any::<u32>(), 0..30_usize), 0..600),
        stored in any::<bool>(),
    ) {
        let start_up = if stored { StartUp::Stored } else { StartUp::Measured };
        let mut pipeline = Pipeline::new(Linear::NEW, start_up, Calibration::default(), Warnings::NONE);
        for (time, [pressure, headroom], age, fault) in steps {
            let sample = Sample {
                pressure: Millipascals(pressure),
                headroom: Millipascals(headroom),
                age,
                ..Sample::default()
            };
            let sample = Fault::CODES.get(fault).map_or(Ok(sample), |(fault, _)| Err(*fault));
            let report = pipeline.step(Microseconds(time), sample);
            if sample.is_err() {
                prop_assert_eq!(report.outcome.err(), sample.err());
            }
        }
    }
}
