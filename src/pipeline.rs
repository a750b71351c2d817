//! The stages, called in order.

use crate::contact::contact;
use crate::design::Design;
use crate::filter::{Filter, GROUP_DELAY};
use crate::pressure::Scale;
use crate::report::{Fault, Measurement, Microseconds, Report};
use crate::tare::{Gates, StartUp, Tare};
use crate::transducer::{self, Sample};
use core::marker::PhantomData;

/// The signal path of one fingertip.
#[derive(Clone, Debug)]
pub struct Pipeline<D> {
    tare: Tare,
    filter: Filter,
    design: PhantomData<D>,
}

impl<D: Design> Pipeline<D> {
    /// From one sample to the next, microseconds.
    pub const PERIOD: u32 = transducer::period(&D::CONSTANTS.transducer.kind);

    const SCALE: Scale = Scale::of(D::PRESSURE_FRACTION_BITS);
    const GATES: Gates = Gates::of(&D::CONSTANTS, D::PRESSURE_FRACTION_BITS);

    /// A signal path that has seen nothing yet.
    pub const fn new(start_up: StartUp) -> Self {
        Self {
            tare: Tare::new(Self::GATES, start_up),
            filter: Filter::NEW,
            design: PhantomData,
        }
    }

    /// The report of one sample, or of its absence. `now` is when the transducer gave it.
    #[inline]
    pub fn step(&mut self, now: Microseconds, sample: Result<Sample, Fault>) -> Report {
        let age = sample.map_or(Self::PERIOD / 2, |sample| sample.age);
        let measured = Microseconds(now.0.saturating_sub(u64::from(age)));
        let outcome = match sample {
            Ok(sample) => self.measure(measured, sample),
            Err(fault) => {
                self.tare.interrupt(measured);
                self.filter.interrupt();
                Err(fault)
            }
        };
        let delay = u64::from(GROUP_DELAY * Self::PERIOD);
        Report {
            time: Microseconds(measured.0.saturating_sub(delay)),
            outcome,
        }
    }

    #[inline]
    fn measure(&mut self, time: Microseconds, sample: Sample) -> Result<Measurement, Fault> {
        let pressure = Self::SCALE.pressure(sample.pressure);
        let (rise, zero) = self.tare.step(time, pressure)?;
        let (rise, warnings) = self.filter.step(rise, zero.and(sample.warnings()))?;
        Ok(contact::<D>(rise, warnings))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::{Status, Warnings};
    use crate::test_design::{Linear, RISE_END};
    use crate::transducer::Millipascals;
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

    impl Bench {
        fn new(start_up: StartUp) -> Self {
            Self {
                pipeline: Pipeline::new(start_up),
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
            let measurement = bench.steps(3, Ok(at(pascals))).outcome.expect("held at the end");
            assert_eq!(measurement.warnings, Warnings::SATURATED);
            assert_eq!(measurement.force.0, RISE_END);
        }
    }

    #[test]
    fn powered_up_while_pressed_is_said_so() {
        let mut bench = Bench::new(StartUp::Measured);
        let report = bench.steps(2_100, Ok(at(30_000.0)));
        assert_eq!(report.status().to_string(), "warning: zero unverified");
        let rise = report
            .outcome
            .expect("the design's rest pressure serves")
            .pressure_rise
            .0;
        assert!(rise.abs_diff(10_000 << 8) <= 64);
    }

    #[test]
    fn a_leak_is_said_so() {
        let mut bench = Bench::zeroed();
        let report = bench.steps(3, Ok(at(19_000.0)));
        assert_eq!(report.status().to_string(), "warning: below zero");
    }

    #[test]
    fn after_a_watchdog_reset_there_are_readings_at_once_with_an_unverified_zero() {
        let mut bench = Bench::new(StartUp::Stored);
        let report = bench.steps(3, Ok(at(25_000.0)));
        assert_eq!(report.status().to_string(), "warning: zero unverified");
    }

    proptest! {
        #[test]
        fn no_history_panics_and_no_fault_has_values(
            steps in prop::collection::vec((any::<u64>(), any::<[i32; 2]>(), any::<u32>(), 0..30_usize), 0..600),
            stored in any::<bool>(),
        ) {
            let start_up = if stored { StartUp::Stored } else { StartUp::Measured };
            let mut pipeline = Pipeline::<Linear>::new(start_up);
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
}
