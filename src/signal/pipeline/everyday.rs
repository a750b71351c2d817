//! Everyday situations in which a zero goes wrong: no reading with status ok may be off by more than the touch threshold and
//! one noise floor.

use super::*;
use crate::signal::test_design::{Linear, TRANSDUCERS};
use crate::status::{Status, Warnings};
use crate::units::Millipascals;
use model_tables::constants::Quantity;
use model_tables::random::Random;

/// Off by more with status ok is wrong, pascals.
const WRONG: f64 = 70.0;

/// A gauge part read by the converter, and an absolute part on a bus.
const GAUGE: usize = 0;
const ABSOLUTE: usize = 3;

/// The gauge pressure at rest, millipascals.
const REST: i32 = 1_000_000;

/// A fingertip with everything that moves its pressure beside a press.
struct World {
    pipeline: Pipeline<Linear>,
    /// Microseconds.
    now: u64,
    /// From one sample to the next, microseconds.
    spacing: u64,
    /// The air around, pascals; only an absolute part reads it.
    air: f64,
    /// Degrees Celsius, where the part measures it.
    celsius: Option<f64>,
    random: Random,
    /// True rises of the last samples, newest first.
    truth: [f64; 4],
    /// The largest error of a steady reading with status ok, pascals.
    worst_ok: f64,
    readings: u64,
    ok: u64,
}

impl World {
    fn new(transducer: usize, start_up: StartUp, calibration: Calibration) -> Self {
        Self::of(Linear::with(TRANSDUCERS[transducer]), start_up, calibration)
    }

    fn of(design: Linear, start_up: StartUp, calibration: Calibration) -> Self {
        Self {
            spacing: u64::from(design.parameters().period),
            pipeline: Pipeline::new(design, start_up, calibration, Warnings::NONE),
            now: 0,
            air: 80_000.0,
            celsius: None,
            random: Random(1),
            truth: [0.0; 4],
            worst_ok: 0.0,
            readings: 0,
            ok: 0,
        }
    }

    /// Switched on untouched, nothing stored, and tared.
    fn tared(transducer: usize) -> Self {
        Self::tared_of(Linear::with(TRANSDUCERS[transducer]))
    }

    fn tared_of(design: Linear) -> Self {
        let mut world = Self::of(design, StartUp::Measured, Calibration::default());
        world.run(1.0, |_| (0.0, 0.0));
        assert_eq!(world.tare(0.0, 0.0), Ok(()));
        world.run(0.5, |_| (0.0, 0.0));
        world
    }

    /// One sample with a true rise and what else lifts the pressure, pascals.
    fn step(&mut self, rise: f64, shift: f64) -> Report {
        let Parameters {
            constants, period, ..
        } = *self.pipeline.parameters();
        self.now += self.spacing;
        let noise = self.random.uniform(-2.0, 2.0);
        let absolute = constants.transducer.quantity == Quantity::Absolute;
        let air = if absolute { self.air } else { 0.0 };
        let pascals = f64::from(constants.rest_pressure) + air + rise + shift + noise;
        let millipascals = (pascals * 1000.0).round() as i32;
        let report = self.pipeline.step(
            Microseconds(self.now),
            Ok(Sample {
                pressure: Millipascals(millipascals),
                headroom: Millipascals(constants.transducer.range[1] * 1000 - millipascals),
                age: period / 2,
                temperature: self
                    .celsius
                    .map(|celsius| Centidegrees((celsius * 100.0).round() as i16)),
                ..Sample::default()
            }),
        );
        self.truth.rotate_right(1);
        self.truth[0] = rise;
        let steady = self.truth.iter().all(|truth| (truth - rise).abs() < 2.0);
        if let Ok(measurement) = report.outcome {
            self.readings += 1;
            if measurement.warnings == Warnings::NONE {
                self.ok += 1;
                if steady {
                    let read = measurement.pressure_rise.pascals(Linear::PRESSURE_FRACTION_BITS);
                    self.worst_ok = self.worst_ok.max((read - rise).abs());
                }
            }
        }
        report
    }

    /// The last report of some seconds of (rise, shift) by the time since then.
    fn run(&mut self, seconds: f64, at: impl Fn(f64) -> (f64, f64)) -> Report {
        let from = self.now;
        loop {
            let since = (self.now - from) as f64 / 1e6;
            let (rise, shift) = at(since);
            let report = self.step(rise, shift);
            if since >= seconds {
                return report;
            }
        }
    }

    fn tare(&mut self, rise: f64, shift: f64) -> Result<(), TareRefusal> {
        self.pipeline.tare()?;
        for _ in 0..10_000 {
            self.step(rise, shift);
            if let Some(answer) = self.pipeline.take_tare_answer() {
                return answer;
            }
        }
        panic!("patience is bounded")
    }

    /// A grasp in 0.2 s, held for 2 s and let go, over a standing shift.
    fn grasp(&mut self, rise: f64, shift: f64) -> Report {
        self.run(0.2, |since| (rise * (since / 0.2).min(1.0), shift));
        let held = self.run(2.0, |_| (rise, shift));
        self.run(0.2, |since| (rise * (1.0 - since / 0.2).max(0.0), shift));
        held
    }

    fn assert_never_wrong(&self) {
        assert!(self.worst_ok <= WRONG, "ok, and off by {:.0} Pa", self.worst_ok);
    }
}

fn aged(report: &Report) -> bool {
    report
        .outcome
        .is_ok_and(|reading| reading.warnings.contains(Warnings::ZERO_AGED))
}

fn touch(report: &Report) -> Touch {
    report.outcome.expect("a reading").touch
}

/// Case 1, without a stored zero.
#[test]
fn a_tare_after_a_pressed_start_is_not_ok() {
    for press in [260.0, 1_000.0, 2_400.0] {
        let mut world = World::new(GAUGE, StartUp::Measured, Calibration::default());
        world.run(3.0, |_| (press, 0.0));
        let _ = world.tare(press, 0.0);
        world.run(2.0, |_| (press, 0.0));
        world.grasp(press + 3_000.0, 0.0);
        world.assert_never_wrong();
    }
}

/// Case 1, with a stored zero: the start itself.
#[test]
fn a_press_over_the_stored_zero_at_the_start_is_not_lost() {
    for press in [80.0, 140.0, 200.0, 240.0] {
        let stored = Calibration {
            zero: Some(Millipascals(REST)),
            ..Calibration::default()
        };
        let mut world = World::new(GAUGE, StartUp::Measured, stored);
        world.run(3.0, |_| (press, 0.0));
        let _ = world.tare(press, 0.0);
        world.run(2.0, |_| (press, 0.0));
        world.assert_never_wrong();
    }
}

/// Case 1: light presses that are tared away one by one.
#[test]
fn forty_tares_on_light_presses_do_not_add_up() {
    let mut world = World::tared(GAUGE);
    for round in 1..=40 {
        let press = 28.0 * f64::from(round);
        world.run(3.0, |_| (press, 0.0));
        let _ = world.tare(press, 0.0);
        world.run(60.0, |_| (press, 0.0));
    }
    world.grasp(4_000.0, 0.0);
    world.assert_never_wrong();
}

/// Case 1, absolute: nothing tells 29 kPa of press from denser air but the release.
#[test]
fn an_absolute_part_that_was_tared_while_pressed_is_not_ok_after_the_release() {
    let mut world = World::new(ABSOLUTE, StartUp::Measured, Calibration::default());
    world.run(2.0, |_| (29_000.0, 0.0));
    let _ = world.tare(29_000.0, 0.0);
    world.run(1.0, |_| (29_000.0, 0.0));
    world.run(0.3, |since| (29_000.0 * (1.0 - since / 0.3).max(0.0), 0.0));
    world.run(1.0, |_| (0.0, 0.0));
    world.worst_ok = 0.0;
    let held = world.grasp(3_000.0, 0.0);
    assert_ne!(held.status(), Status::Ok);
    world.assert_never_wrong();
}

/// Case 2.
#[test]
fn a_lift_up_is_remembered_in_the_next_grasp() {
    for climb in [1_000.0, 4_900.0] {
        let mut world = World::tared(ABSOLUTE);
        world.run(20.0, |since| (0.0, -climb * (since / 20.0).min(1.0)));
        world.run(600.0, |_| (0.0, -climb));
        let held = world.grasp(6_000.0, -climb);
        assert_ne!(held.status(), Status::Ok);
        world.assert_never_wrong();
        assert_eq!(world.tare(0.0, -climb), Ok(()));
        let held = world.grasp(6_000.0, -climb);
        assert_eq!(held.status(), Status::Ok);
        world.assert_never_wrong();
    }
}

/// Case 3.
#[test]
fn a_slow_press_ends_as_aged_before_it_has_passed_for_a_zero() {
    for rate in [0.3, 0.5, 0.83] {
        let mut world = World::tared(GAUGE);
        world.spacing = 10_000;
        let last = world.run(60.0 / rate, |since| (rate * since, 0.0));
        assert!(aged(&last), "{rate}: {}", last.status());
        let last = world.run(1_000.0, |since| (60.0 + rate * since, 0.0));
        assert!(aged(&last), "{rate}: {}", last.status());
        world.assert_never_wrong();
    }
}

/// Case 3: in steps, and as creep.
#[test]
fn small_steps_and_creep_do_not_add_up() {
    for step in [10.0, 25.0] {
        let mut world = World::tared(GAUGE);
        world.spacing = 10_000;
        world.run(40.0 * 60.0, |since| (step * (since / 40.0).floor(), 0.0));
        world.grasp(5_000.0, 0.0);
        world.assert_never_wrong();
    }
    let mut world = World::tared(GAUGE);
    world.spacing = 10_000;
    world.run(3_600.0, |since| (0.0, 300.0 * (1.0 - (-since / 900.0_f64).exp())));
    world.grasp(5_000.0, 300.0);
    world.assert_never_wrong();
}

/// Case 4.
#[test]
fn undo_does_not_bring_back_a_zero_as_if_no_time_had_passed() {
    let mut world = World::tared(ABSOLUTE);
    assert_eq!(world.tare(0.0, 0.0), Ok(()));
    world.spacing = 100_000;
    world.run(8.0 * 3_600.0, |since| (0.0, 100.0 * since / 3_600.0));
    world.pipeline.undo_tare().expect("there is one");
    world.spacing = u64::from(world.pipeline.parameters().period);
    world.run(3.0, |_| (0.0, 800.0));
    let held = world.grasp(5_000.0, 800.0);
    assert_ne!(held.status(), Status::Ok);
    world.assert_never_wrong();
}

/// Case 5.
#[test]
fn fast_drift_is_no_touch_with_ok() {
    let mut world = World::tared(GAUGE);
    world.spacing = 10_000;
    let last = world.run(60.0 / 0.83, |since| (0.0, 0.83 * since));
    assert!(aged(&last), "{}", last.status());
    world.run(530.0, |since| (0.0, 60.0 + 0.83 * since));
    let last = world.run(3_600.0, |_| (0.0, 500.0));
    assert!(aged(&last), "{}", last.status());
    world.assert_never_wrong();

    // 8 m of stairs or a lift, down at 1.5 m/s.
    let mut world = World::tared(ABSOLUTE);
    world.run(5.3, |since| (0.0, 18.0 * since));
    let last = world.run(600.0, |_| (0.0, 96.0));
    assert!(aged(&last), "{}", last.status());
    world.assert_never_wrong();
    assert_eq!(world.tare(0.0, 96.0), Ok(()));
    assert_eq!(world.grasp(2_000.0, 96.0).status(), Status::Ok);
    world.assert_never_wrong();
}

/// Case 7.
#[test]
fn a_grasp_that_warms_the_part_is_over_when_it_is() {
    for warmer in [4.0, 7.0] {
        let calibration = Calibration {
            zero: Some(Millipascals(REST)),
            temperature: Some(Centidegrees(2_000)),
            coefficient: 10_000,
            gain: 0,
        };
        let mut world = World::new(GAUGE, StartUp::Measured, calibration);
        world.celsius = Some(20.0);
        world.run(1.0, |_| (0.0, 0.0));
        world.run(0.2, |since| (5_000.0 * (since / 0.2), 0.0));
        world.celsius = Some(20.0 + warmer);
        world.run(20.0, |_| (5_000.0, 10.0 * warmer));
        world.run(0.2, |since| {
            (5_000.0 * (1.0 - since / 0.2).max(0.0), 10.0 * warmer)
        });
        let last = world.run(5.0, |_| (0.0, 10.0 * warmer));
        assert_eq!(touch(&last), Touch::Untouched, "{warmer} K");
        let rise = last.outcome.expect("a reading").pressure_rise.pascals(8);
        assert!(rise.abs() < 10.0, "{warmer} K: {rise}");
        world.assert_never_wrong();
    }
}

/// Case 8.
#[test]
fn turning_the_hand_walks_the_zero_nowhere() {
    let mut world = World::tared(GAUGE);
    for _ in 0..20 {
        world.run(1.0, |since| (0.0, -70.0 * since.min(1.0)));
        world.run(10.0, |_| (0.0, -70.0));
        world.run(1.0, |since| (0.0, -70.0 + 140.0 * since.min(1.0)));
        world.run(10.0, |_| (0.0, 70.0));
        world.run(1.0, |since| (0.0, 70.0 - 70.0 * since.min(1.0)));
    }
    world.assert_never_wrong();
}

/// Case 9.
#[test]
fn what_hysteresis_leaves_after_a_press_is_no_touch_for_an_hour() {
    for left in [35.0, 45.0, 59.0] {
        let mut world = World::tared(GAUGE);
        world.grasp(8_000.0, 0.0);
        world.run(0.2, |_| (8_000.0, 0.0));
        let last = world.run(60.0, |_| (0.0, left));
        assert_ne!(touch(&last), Touch::Touched, "{left} Pa: {}", last.status());
    }
}

/// Case 10.
#[test]
fn creep_back_is_no_leak_and_a_gap_is_no_time_below() {
    let leaks = |world: &World| world.pipeline.fluid_suspicions() != Warnings::NONE;
    let mut world = World::tared(GAUGE);
    world.grasp(8_000.0, 0.0);
    world.run(120.0, |since| (0.0, -240.0 * (-since / 60.0_f64).exp()));
    assert!(!leaks(&world));

    let mut world = World::tared(GAUGE);
    for _ in 0..100 {
        world.run(0.6, |_| (0.0, -2_000.0));
        world.now += 1_000_000;
    }
    assert!(!leaks(&world));
}

/// A part that fails a few times in each window: no window ends, and the weather goes on.
#[test]
fn an_intermittent_part_ages_all_the_same() {
    let mut world = World::tared(ABSOLUTE);
    let mut last = None;
    for minute in 0..60 {
        for _ in 0..240 {
            let shift = 100.0 * f64::from(minute) / 60.0;
            let report = world.run(0.1, |_| (0.0, shift));
            last = Some(report);
            world.now += 150_000;
        }
    }
    assert!(aged(&last.expect("it ran")));
    world.assert_never_wrong();
}

/// Case 11: hum of the mains that comes after the zero was taken. Nothing is wrong but in the first four parts of a window, 64 ms.
#[test]
fn hum_is_noisy_and_no_number_with_ok() {
    let hum = |hertz: f64, since: f64| 100.0 * (core::f64::consts::TAU * hertz * since).sin();
    for (hertz, rise) in [(50.0, 0.0), (60.0, 0.0), (50.0, 5_000.0), (60.0, 5_000.0)] {
        let mut world = World::tared(GAUGE);
        if rise > 0.0 {
            world.run(0.2, |since| (rise * since / 0.2, 0.0));
            world.run(1.0, |_| (rise, 0.0));
        }
        world.run(0.064, |since| (rise, hum(hertz, since)));
        world.worst_ok = 0.0;
        let last = world.run(20.0, |since| (rise, hum(hertz, since + 0.064)));
        world.assert_never_wrong();
        let reading = last.outcome.expect("a reading");
        assert!(reading.warnings.contains(Warnings::NOISY), "{}", last.status());
        // One deviation allows for the amplitude.
        assert!(reading.sigma.pressure_rise.pascals(8) > 100.0 / 3.0_f64.sqrt());
        assert_eq!(touch(&last) == Touch::Touched, rise > 0.0);
        // A grasp on top of it does not hide it.
        world.run(0.2, |since| {
            (rise + 3_000.0 * (since / 0.2).min(1.0), hum(hertz, since))
        });
        world.run(1.0, |since| (rise + 3_000.0, hum(hertz, since)));
        world.assert_never_wrong();
        let last = world.run(2.0, |_| (rise + 3_000.0, 0.0));
        assert_eq!(last.status(), Status::Ok, "{hertz} Hz");
    }
}

/// What the design states of its zero, and the air that a host tells.
mod stated;
