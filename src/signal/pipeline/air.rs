//! Every transducer in any air: samples as the part gives them, so the air is in those of an absolute one.

use super::*;
use crate::signal::test_design::{Linear, TRANSDUCERS};
use crate::status::{Status, Warnings};
use model_tables::constants::{AIR, Quantity};
use model_tables::random::Random;
use proptest::prelude::*;

const THINNEST: f64 = AIR[0] as f64;
const DENSEST: f64 = AIR[1] as f64;

/// How far a reading may be off, pascals: one noise floor of the transducer.
const NOISE_FLOOR: f64 = 10.0;

/// A fingertip in the air; one step is one sample of its transducer.
struct Life {
    pipeline: Pipeline<Linear>,
    now: u64,
    /// Pascals.
    air: f64,
    random: Random,
}

impl Life {
    /// With one of the [`TRANSDUCERS`].
    fn new(transducer: usize, start_up: StartUp, calibration: Calibration, air: f64) -> Self {
        let design = Linear::with(TRANSDUCERS[transducer]);
        Self {
            pipeline: Pipeline::new(design, start_up, calibration, Warnings::NONE),
            now: 0,
            air,
            random: Random(1),
        }
    }

    /// Switched on with nothing stored, and tared unloaded.
    fn zeroed(transducer: usize, air: f64) -> Self {
        let mut life = Self::new(transducer, StartUp::Measured, Calibration::default(), air);
        life.run(3.0, |_| 0.0);
        assert_eq!(life.tare(0.0), Ok(()));
        life.run(0.1, |_| 0.0);
        life
    }

    fn is_absolute(&self) -> bool {
        self.pipeline.parameters().constants.transducer.quantity == Quantity::Absolute
    }

    /// The status of a start until a tare.
    fn unverified(&self) -> Status {
        if self.is_absolute() {
            Status::Warning(Warnings::ZERO_UNVERIFIED)
        } else {
            Status::Ok
        }
    }

    fn step(&mut self, rise: f64) -> Report {
        let Parameters {
            constants, period, ..
        } = *self.pipeline.parameters();
        self.now += u64::from(period);
        let noise = self.random.uniform(-2.0, 2.0);
        let air = if self.is_absolute() { self.air } else { 0.0 };
        let pascals = f64::from(constants.rest_pressure) + air + rise + noise;
        let millipascals = (pascals * 1000.0).round() as i32;
        let sample = Sample {
            pressure: Millipascals(millipascals),
            headroom: Millipascals(constants.transducer.range[1] * 1000 - millipascals),
            age: period / 2,
            ..Sample::default()
        };
        self.pipeline.step(Microseconds(self.now), Ok(sample))
    }

    /// The reports of some seconds at a rise over rest, pascals, by the time since then.
    fn run(&mut self, seconds: f64, rise: impl Fn(f64) -> f64) -> Vec<Report> {
        let from = self.now;
        let mut reports = vec![];
        while ((self.now - from) as f64) < seconds * 1e6 {
            let since = (self.now - from) as f64 / 1e6;
            reports.push(self.step(rise(since)));
        }
        reports
    }

    fn tare(&mut self, rise: f64) -> Result<(), TareRefusal> {
        self.pipeline.tare()?;
        let last = self.now + 3_000_000;
        while self.now < last {
            self.step(rise);
            if let Some(answer) = self.pipeline.take_tare_answer() {
                return answer;
            }
        }
        panic!("patience is bounded")
    }

    /// Presses in 0.3 s, holds, lifts and rests; every reading has that status, and those at rest and held are right.
    fn press(&mut self, rise: f64, status: Status) {
        for report in self.run(0.3, |since| rise * since / 0.3) {
            assert_eq!(report.status(), status);
        }
        self.run(0.1, |_| rise);
        self.holds(rise, status);
        self.lift(rise, status);
    }

    fn lift(&mut self, rise: f64, status: Status) {
        for report in self.run(0.3, |since| rise * (1.0 - since / 0.3)) {
            assert_eq!(report.status(), status);
        }
        self.run(0.1, |_| 0.0);
        self.holds(0.0, status);
    }

    fn holds(&mut self, rise: f64, status: Status) {
        for report in self.run(0.4, |_| rise) {
            assert_eq!(report.status(), status, "air {}", self.air);
            let read = report.outcome.expect("a reading").pressure_rise;
            let read = read.pascals(Linear::PRESSURE_FRACTION_BITS);
            assert!(
                (read - rise).abs() < NOISE_FLOOR,
                "{read} for {rise} in {}",
                self.air
            );
        }
    }
}

/// Start, tare, press, undo, save; another start in other air; a reset in a grasp; forget.
fn whole_life(transducer: usize, air: f64, later: f64, press: f64) {
    let mut life = Life::new(transducer, StartUp::Measured, Calibration::default(), air);
    life.run(0.5, |_| 0.0);
    life.holds(0.0, life.unverified());
    assert_eq!(life.tare(0.0), Ok(()));
    life.run(0.1, |_| 0.0);
    life.press(press, Status::Ok);

    life.pipeline.undo_tare().expect("there is one");
    life.run(0.1, |_| 0.0);
    life.holds(0.0, life.unverified());
    assert_eq!(life.tare(0.0), Ok(()));
    life.run(0.1, |_| 0.0);
    let stored = life.pipeline.calibration_to_store().expect("it is verified");
    assert!(stored.is_plausible(TRANSDUCERS[transducer].range));
    life.pipeline.calibrated(Some(stored));
    life.press(press, Status::Ok);
    assert_eq!(life.tare(0.0), Ok(()));

    // Switched on again, elsewhere.
    let mut again = Life::new(transducer, StartUp::Measured, stored, later);
    again.run(0.5, |_| 0.0);
    again.press(press, again.unverified());
    assert_eq!(again.tare(0.0), Ok(()));
    again.run(0.1, |_| 0.0);
    again.press(press, Status::Ok);

    // A reset in a grasp, as nobody saw it coming: with the zero from before, and without.
    let kept = again.pipeline.zero().expect("it is zeroed");
    let mut reset = Life::new(transducer, StartUp::Kept(kept), stored, later);
    reset.run(0.1, |_| press);
    reset.holds(press, Status::Ok);
    reset.pipeline.calibrated(None);
    reset.lift(press, Status::Ok);
    reset.press(press, Status::Ok);

    let mut lost = Life::new(transducer, StartUp::Stored, stored, later);
    lost.run(0.1, |_| press);
    for report in lost.run(3.0, |_| press) {
        if lost.is_absolute() {
            assert_eq!(report.outcome, Err(Fault::Zeroing));
        } else {
            assert_eq!(report.status(), Status::Warning(Warnings::ZERO_UNVERIFIED));
        }
    }
    assert_eq!(lost.tare(0.0), Ok(()));
    lost.run(0.1, |_| 0.0);
    lost.press(press, Status::Ok);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn every_transducer_reads_right_in_any_air_after_its_zero(
        transducer in 0..TRANSDUCERS.len(),
        air in THINNEST..=DENSEST,
        later in THINNEST..=DENSEST,
        press in 200.0..9_900.0_f64,
    ) {
        whole_life(transducer, air, later, press);
    }
}

#[test]
fn every_transducer_reads_right_at_the_ends_of_the_air_and_at_sea_level() {
    for transducer in 0..TRANSDUCERS.len() {
        for [air, later] in [
            [THINNEST, DENSEST],
            [DENSEST, THINNEST],
            [80_000.0, 101_325.0],
            [101_325.0, 80_000.0],
        ] {
            whole_life(transducer, air, later, 9_900.0);
        }
    }
}

#[test]
fn an_absolute_transducer_that_finds_no_zero_at_start_has_a_reason_and_no_number() {
    let restless = |since: f64| 400.0 * (60.0 * since).sin();
    let mut life = Life::new(4, StartUp::Measured, Calibration::default(), 101_325.0);
    for report in life.run(6.0, restless) {
        assert_eq!(report.outcome, Err(Fault::Zeroing));
    }
    // It gives way to a command, which is answered, and goes on after it.
    life.pipeline
        .tare()
        .expect("nothing that ends by itself is under way");
    life.run(3.0, restless);
    assert_eq!(life.pipeline.take_tare_answer(), Some(Err(TareRefusal::Restless)));
    // A window, and what was left of the restless one.
    life.run(0.6, |_| 0.0);
    life.holds(0.0, Status::Warning(Warnings::ZERO_UNVERIFIED));
    life.pipeline.tare().expect("nothing is under way");
}

#[test]
fn a_press_that_no_air_explains_is_no_zero_of_an_absolute_transducer() {
    // 108 kPa and 2.5 % of 90 kPa: up to 110.25 kPa over rest may be air.
    let mut life = Life::new(4, StartUp::Measured, Calibration::default(), DENSEST);
    for report in life.run(4.0, |_| 2_300.0) {
        assert_eq!(report.outcome, Err(Fault::Zeroing));
    }
    assert_eq!(life.tare(2_300.0), Err(TareRefusal::OutOfBounds));
    life.run(0.6, |_| 0.0);
    life.holds(0.0, Status::Warning(Warnings::ZERO_UNVERIFIED));
}

#[test]
fn an_unverified_zero_of_an_absolute_transducer_may_be_off_by_most_of_the_air() {
    let mut life = Life::new(4, StartUp::Measured, Calibration::default(), 101_325.0);
    life.run(0.5, |_| 0.0);
    let sigma = life.step(0.0).outcome.expect("a reading").sigma;
    // Half of 48 kPa and 2.25 kPa, uniform: over sqrt 3.
    let pascals = sigma.pressure_rise.pascals(8);
    assert!((pascals - 26_250.0 / 3.0_f64.sqrt()).abs() < 100.0, "{pascals}");
    assert!(sigma.force.0 > 0 && sigma.indentation.0 > 0);
}

#[test]
fn a_climb_is_no_leak_and_is_reported_until_a_tare() {
    // From the coast to 4200 m in ten minutes.
    let seconds = 600.0;
    let mut life = Life::zeroed(4, DENSEST);
    let from = life.now;
    while (life.now - from) as f64 / 1e6 < seconds {
        let since = (life.now - from) as f64 / 1e6;
        life.air = DENSEST + (THINNEST - DENSEST) * since / seconds;
        let report = life.step(0.0);
        let reading = report.outcome.expect("a reading");
        assert!(!reading.warnings.contains(Warnings::LEAK_SUSPECTED));
        // It is evidence of where the zero is: within what a window and a half lag behind.
        assert!(reading.pressure_rise.pascals(8).abs() < 60.0);
        // Five metres are 60 Pa.
        assert!(since < 2.0 || reading.warnings.contains(Warnings::ZERO_AGED));
    }
    life.run(0.6, |_| 0.0);
    life.press(5_000.0, Status::Warning(Warnings::ZERO_AGED));
    assert_eq!(life.tare(0.0), Ok(()));
    life.run(0.1, |_| 0.0);
    life.press(5_000.0, Status::Ok);
}

#[test]
fn lower_than_the_thinnest_air_allows_is_a_leak() {
    let mut life = Life::zeroed(1, THINNEST);
    // An eighth of 1 kPa and 2.5 % of 230 kPa below the rest pressure in the thinnest air.
    let leaks = |life: &mut Life, fall: f64| {
        let last = life.run(61.0, |_| -fall).pop().expect("a report");
        last.outcome
            .expect("a reading")
            .warnings
            .contains(Warnings::LEAK_SUSPECTED)
    };
    assert!(!leaks(&mut life, 5_850.0));
    assert!(leaks(&mut life, 5_900.0));
}

#[test]
fn a_zero_that_the_air_has_left_behind_is_reported_and_gives_way_to_a_tare() {
    let mut life = Life::zeroed(4, 90_000.0);
    // Down a hill within a minute: denser air, which is no press.
    life.run(60.0, |since| 50.0 * since);
    let last = life.run(1.0, |_| 3_000.0).pop().expect("a report");
    assert_eq!(last.status(), Status::Warning(Warnings::ZERO_AGED));
    assert_eq!(life.tare(3_000.0), Ok(()));
    // A press is faster.
    life.run(0.3, |since| 3_000.0 * (1.0 + since / 0.3));
    assert_eq!(life.tare(6_000.0), Err(TareRefusal::Touched));
}
