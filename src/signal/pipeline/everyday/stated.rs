//! `[zero]` and `[air]`: what is stated is in the bound, and nothing of it is a touch, a number with status ok or a leak.

use super::*;
use model_tables::constants::{AirReference, ZeroAssumptions};

/// A part on a bus tells its temperature.
const GAUGE_ON_BUS: usize = 2;

fn stating(transducer: usize, zero: ZeroAssumptions) -> World {
    World::tared_of(Linear::stating(TRANSDUCERS[transducer], zero))
}

fn bound(world: &World) -> f64 {
    f64::from(world.pipeline.zero().expect("there is one").bound) / 256.0
}

/// An absolute part whose host tells the air.
fn told() -> World {
    let zero = ZeroAssumptions {
        air: AirReference::Host,
        ..ZeroAssumptions::NONE
    };
    let mut world = World::of(
        Linear::stating(TRANSDUCERS[ABSOLUTE], zero),
        StartUp::Measured,
        Calibration::default(),
    );
    world.tell();
    world.run(1.0, |_| (0.0, 0.0));
    assert_eq!(world.tare(0.0, 0.0), Ok(()));
    world.run(0.5, |_| (0.0, 0.0));
    world
}

impl World {
    fn tell(&mut self) {
        let pascals = self.air.round() as i32;
        assert_eq!(self.pipeline.air(Microseconds(self.now), pascals), Ok(()));
    }
}

#[test]
fn the_bound_grows_by_the_drift_that_the_part_is_stated_to_have() {
    let mut grown = Vec::new();
    for drift in [0, 20_000] {
        let mut world = stating(
            GAUGE,
            ZeroAssumptions {
                drift,
                ..ZeroAssumptions::NONE
            },
        );
        world.run(0.2, |since| (5_000.0 * since / 0.2, 0.0));
        let before = bound(&world);
        world.spacing = 20_000;
        world.run(3_600.0, |_| (5_000.0, 0.0));
        grown.push(bound(&world) - before);
    }
    assert!(
        (grown[0] - 2.0).abs() < 0.2 && (grown[1] - 20.0).abs() < 0.2,
        "{grown:?}"
    );
    // Beside an absolute part's own drift there is the weather.
    let absolute = Linear::stating(
        TRANSDUCERS[ABSOLUTE],
        ZeroAssumptions {
            drift: 20_000,
            ..ZeroAssumptions::NONE
        },
    );
    let unstated = Linear::with(TRANSDUCERS[ABSOLUTE]);
    let rate = |design: &Linear| design.parameters().limits.drift as f64;
    assert!((rate(&absolute) / rate(&unstated) - 1.2).abs() < 0.01);
}

/// Case 8 with its cause stated: 140 Pa from one attitude to the other.
#[test]
fn the_weight_of_the_fluid_is_in_the_bound_and_no_touch() {
    let zero = ZeroAssumptions {
        fluid_head: 140_000,
        bound: 200_000,
        ..ZeroAssumptions::NONE
    };
    let mut world = stating(GAUGE, zero);
    for _ in 0..20 {
        for head in [-70.0, 70.0] {
            let last = world.run(10.0, |_| (0.0, head));
            assert_eq!(last.status(), Status::Ok, "{head}");
            assert_ne!(touch(&last), Touch::Touched, "{head}");
            let reading = last.outcome.expect("a reading");
            let rise = reading.pressure_rise.pascals(8).abs();
            assert!(rise <= bound(&world), "{rise} for {head}");
            // 70 Pa over the square root of 3 at the least.
            let sigma = reading.sigma.pressure_rise.pascals(8);
            assert!(sigma > 40.0, "{sigma}: bound {}", bound(&world));
        }
    }
    let held = world.grasp(5_000.0, 70.0);
    assert_eq!(touch(&held), Touch::Touched);
    // Without the statement the same is "zero aged".
    let mut unstated = World::tared(GAUGE);
    unstated.run(10.0, |_| (0.0, -70.0));
    assert!(aged(&unstated.run(10.0, |_| (0.0, 70.0))));
}

/// Cases 9 and 10 with their causes stated.
#[test]
fn hysteresis_and_creep_are_in_the_bound() {
    let zero = ZeroAssumptions {
        hysteresis: 60_000,
        creep: 240_000,
        bound: 350_000,
        ..ZeroAssumptions::NONE
    };
    let mut world = stating(GAUGE, zero);
    for left in [-240.0, 59.0] {
        world.grasp(8_000.0, 0.0);
        for _ in 0..20 {
            let last = world.run(1.0, |_| (0.0, left));
            let reading = last.outcome.expect("a reading");
            assert_ne!(touch(&last), Touch::Touched, "{left}");
            assert!(!aged(&last), "{left}: {}", last.status());
            assert!(reading.pressure_rise.pascals(8).abs() <= bound(&world));
        }
    }
    assert_eq!(world.pipeline.fluid_suspicions(), Warnings::NONE);
}

/// 10 Pa/K that nothing compensates: a part that tells its temperature has it in the bound as it warms.
#[test]
fn what_a_kelvin_moves_the_zero_by_is_in_the_bound_of_a_part_that_tells_its_temperature() {
    for (stated, warmer, wrong) in [(0, 12.0, true), (10_000, 12.0, false), (10_000, 3.0, false)] {
        let zero = ZeroAssumptions {
            per_kelvin: stated,
            ..ZeroAssumptions::NONE
        };
        let mut world = World::of(
            Linear::stating(TRANSDUCERS[GAUGE_ON_BUS], zero),
            StartUp::Measured,
            Calibration::default(),
        );
        world.celsius = Some(20.0);
        world.run(1.0, |_| (0.0, 0.0));
        assert_eq!(world.tare(0.0, 0.0), Ok(()));
        world.run(0.4, |since| (5_000.0 * since / 0.4, 0.0));
        let mut last = world.step(5_000.0, 0.0);
        for second in 1..=20 {
            let kelvins = warmer * f64::from(second) / 20.0;
            world.celsius = Some(20.0 + kelvins);
            last = world.run(1.0, |_| (5_000.0, 10.0 * kelvins));
        }
        assert_eq!(
            world.worst_ok > WRONG,
            wrong,
            "{stated}, {warmer} K: {}",
            world.worst_ok
        );
        assert_eq!(
            last.status() == Status::Ok,
            wrong || warmer < 5.0,
            "{stated}, {warmer} K"
        );
        // A tare at the new temperature begins anew.
        world.run(0.4, |since| {
            (5_000.0 * (1.0 - since / 0.4).max(0.0), 10.0 * warmer)
        });
        world.run(1.0, |_| (0.0, 10.0 * warmer));
        if !wrong {
            assert_eq!(world.tare(0.0, 10.0 * warmer), Ok(()));
            let held = world.grasp(5_000.0, 10.0 * warmer);
            assert_eq!(held.status(), Status::Ok);
        }
    }
}

#[test]
fn a_part_that_does_not_tell_its_temperature_has_ten_kelvins_in_its_bound() {
    let zero = ZeroAssumptions {
        per_kelvin: 4_000,
        ..ZeroAssumptions::NONE
    };
    let world = stating(GAUGE, zero);
    assert!((bound(&world) - 45.0).abs() < 1.0, "{}", bound(&world));
}

/// 300 Pa of weather in three hours of a grasp.
#[test]
fn the_weather_that_a_host_tells_moves_no_force() {
    let mut world = told();
    world.run(0.4, |since| (5_000.0 * since / 0.4, 0.0));
    world.spacing = 20_000;
    let from = world.air;
    for minute in 1..=180 {
        world.air = from + 300.0 * f64::from(minute) / 180.0;
        world.tell();
        let last = world.run(60.0, |_| (5_000.0, 0.0));
        assert_eq!(
            last.status(),
            Status::Ok,
            "minute {minute}: bound {}",
            bound(&world)
        );
        let rise = last.outcome.expect("a reading").pressure_rise.pascals(8);
        assert!((rise - 5_000.0).abs() < 15.0, "{rise}");
    }
    // Untold, it ages as without.
    let last = world.run(3_600.0, |_| (5_000.0, 0.0));
    assert!(aged(&last));
    world.tell();
    let last = world.run(1.0, |_| (5_000.0, 0.0));
    assert_eq!(last.status(), Status::Ok);
}

/// A lift by 1 kPa in 20 s, the air told ten times a second; then a tare and its undoing.
#[test]
fn a_lift_that_a_host_tells_leaves_the_zero_ok_and_an_undo_too() {
    let mut world = told();
    let from = world.air;
    for tenth in 0..=200 {
        world.air = from - 5.0 * f64::from(tenth);
        world.tell();
        world.run(0.1, |_| (0.0, 0.0));
    }
    let held = world.grasp(5_000.0, 0.0);
    assert_eq!(held.status(), Status::Ok);
    world.assert_never_wrong();
    assert_eq!(world.tare(0.0, 0.0), Ok(()));
    world.air -= 500.0;
    world.tell();
    world.pipeline.undo_tare().expect("there is one");
    world.run(1.0, |_| (0.0, 0.0));
    let held = world.grasp(5_000.0, 0.0);
    assert_eq!(held.status(), Status::Ok);
    world.assert_never_wrong();
}

#[test]
fn air_that_cannot_be_or_that_nobody_asked_for_is_refused() {
    use crate::signal::zero::surroundings::AirRefusal;
    let mut world = told();
    for pascals in [59_999, 108_001, i32::MIN] {
        let refused = world.pipeline.air(Microseconds(world.now), pascals);
        assert_eq!(refused, Err(AirRefusal::OutOfBounds));
    }
    let mut unasked = World::tared(ABSOLUTE);
    let refused = unasked.pipeline.air(Microseconds(unasked.now), 101_325);
    assert_eq!(refused, Err(AirRefusal::NotInDesign));
}
