//! The stages, called in order.

use crate::contact::contact;
use crate::counts::{CountSum, PERIOD, Window};
use crate::design::Design;
use crate::filter::{Filter, GROUP_DELAY};
use crate::pressure::Conversion;
use crate::report::{Fault, Measurement, Microseconds, Report};
use crate::tare::{Gates, StartUp, Tare};
use core::marker::PhantomData;

/// From the middle of the samples behind a report to the end of its newest block, microseconds: half a block,
/// and the delay of the filter.
pub const DELAY: u32 = PERIOD / 2 + GROUP_DELAY * PERIOD;

/// The signal path of one fingertip.
#[derive(Clone, Debug)]
pub struct Pipeline<D> {
    tare: Tare,
    filter: Filter,
    design: PhantomData<D>,
}

impl<D: Design> Pipeline<D> {
    /// Codes between which the transducer is connected.
    pub const WINDOW: Window = Window::of(&D::CONSTANTS.transducer.kind);

    const CONVERSION: Conversion = Conversion::of(&D::CONSTANTS.transducer, D::PRESSURE_FRACTION_BITS);
    const GATES: Gates = Gates::of(&D::CONSTANTS, D::PRESSURE_FRACTION_BITS);

    /// A signal path that has seen nothing yet.
    pub const fn new(start_up: StartUp) -> Self {
        Self {
            tare: Tare::new(Self::GATES, start_up),
            filter: Filter::NEW,
            design: PhantomData,
        }
    }

    /// The report of one block, or of its absence. `block_end` is when its last sample was taken.
    // A boundary that stays in the image, so that instructions from averaged counts to both results can be
    // counted there.
    #[inline(never)]
    pub fn step(&mut self, block_end: Microseconds, block: Result<CountSum, Fault>) -> Report {
        let time = Microseconds(block_end.0.saturating_sub(u64::from(DELAY)));
        let outcome = match block {
            Ok(sum) => self.measure(block_end, sum),
            Err(fault) => {
                self.tare.interrupt(block_end);
                self.filter.interrupt();
                Err(fault)
            }
        };
        Report { time, outcome }
    }

    #[inline]
    fn measure(&mut self, time: Microseconds, sum: CountSum) -> Result<Measurement, Fault> {
        let (pressure, beyond_range) = Self::CONVERSION.pressure(sum);
        let (rise, zero) = self.tare.step(time, pressure)?;
        let (rise, warnings) = self.filter.step(rise, zero.and(beyond_range))?;
        Ok(contact::<D>(rise, warnings))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::{Status, Warnings};
    use crate::test_design::{Linear, RISE_END};
    use proptest::prelude::*;

    /// The sum of a block at a gauge pressure: 4 % to 94 % of 511 875 for 0 to 100 kPa.
    fn at(pascals: f64) -> CountSum {
        let share = (2621.0 + (61604.0 - 2621.0) * pascals / 100e3) / 65536.0;
        CountSum((share * 511_875.0).round() as u32)
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

        fn step(&mut self, block: Result<CountSum, Fault>) -> Report {
            self.milliseconds += 1;
            self.pipeline.step(Microseconds(self.milliseconds * 1000), block)
        }

        /// The last of `times` reports of the same block.
        fn steps(&mut self, times: u32, block: Result<CountSum, Fault>) -> Report {
            (1..times).for_each(|_| {
                self.step(block);
            });
            self.step(block)
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
        // 1000 Pa at 1/256 Pa; one unit of the sum is 0.22 Pa, so within 0.25 Pa.
        assert!(
            measurement.pressure_rise.0.abs_diff(256_000) <= 64,
            "{measurement:?}"
        );
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
            steps in prop::collection::vec((any::<u64>(), any::<u32>(), 0..20_usize), 0..600),
            stored in any::<bool>(),
        ) {
            let start_up = if stored { StartUp::Stored } else { StartUp::Measured };
            let mut pipeline = Pipeline::<Linear>::new(start_up);
            for (time, sum, fault) in steps {
                let block = Fault::CODES.get(fault).map_or(Ok(CountSum(sum)), |(fault, _)| Err(*fault));
                let report = pipeline.step(Microseconds(time), block);
                if block.is_err() {
                    prop_assert_eq!(report.outcome.err(), block.err());
                }
            }
        }
    }
}
