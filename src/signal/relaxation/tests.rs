use super::*;
use crate::signal::test_design::{Linear, RISE_END};
use model_tables::material::relaxation::{AGILUS30_RELAXATION, MAX_TERMS, Relaxation};
use model_tables::material::series::TermStep;
use proptest::prelude::*;

const TERMS: usize = 7;

/// Agilus30 over a step in seconds, the fluid bearing half at 4 kPa.
fn agilus30(seconds: f64) -> WallSeries {
    WallSeries {
        step: SeriesStep::over(&AGILUS30_RELAXATION, seconds),
        remaining_permille: 30,
        fluid_least: 0,
        fluid_half: 4_000 << 8,
        weight_gain: 0,
        weight_half: 1_000 << 8,
        retouch: 0,
        temperature_gain: 0,
    }
}

/// The convolution of a series with an elastic pressure over a weight, in `f64`.
struct Convolution {
    series: Relaxation,
    /// `kappa`, and `P_2` in pascals.
    weight: [f64; 2],
    elastic: f64,
    held: [f64; MAX_TERMS],
}

impl Convolution {
    /// The pressure after an even change to an elastic pressure.
    fn to(&mut self, elastic: f64, seconds: f64) -> f64 {
        let [gain, half] = self.weight;
        let stiffer = |elastic: f64| 1.0 + gain * elastic / (half + elastic);
        let weighted = elastic * stiffer(elastic);
        let change = weighted - self.elastic * stiffer(self.elastic);
        self.elastic = elastic;
        let mut pressure = weighted;
        for (held, term) in self.held.iter_mut().zip(self.series.terms()) {
            let decay = term.over(seconds);
            *held = decay.left * *held + decay.taken * change;
            pressure += *held;
        }
        pressure / stiffer(elastic)
    }
}

/// Presses at random, 1 kHz, with a `kappa` over a `P_2` of 1 kPa: the largest error of the elastic pressure, pascals.
fn error_of_the_inversion(steps: u32, gain: f64) -> f64 {
    const PERIOD: f64 = 1e-3;
    let mut truth = Convolution {
        series: AGILUS30_RELAXATION,
        weight: [gain, 1000.0],
        elastic: 0.0,
        held: [0.0; MAX_TERMS],
    };
    let step = WallSeries {
        weight_gain: (65_536.0 * gain) as u32,
        ..agilus30(PERIOD)
    };
    let mut wall = Relaxing::<TERMS>::NEW;
    let mut seed = 1_u64;
    let mut random = || {
        // Knuth, MMIX.
        seed = seed
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (seed >> 32) as f64 / 2_f64.powi(32)
    };
    let (mut left, mut slope) = (0_u32, 0.0);
    let mut largest = 0.0_f64;
    for _ in 0..steps {
        if left == 0 {
            // 0.3 to 10 s to somewhere up to 30 kPa, or a hold.
            left = 300 + (9_700.0 * random()) as u32;
            let target = if random() < 0.3 {
                truth.elastic
            } else {
                30e3 * random()
            };
            slope = (target - truth.elastic) / f64::from(left);
        }
        left -= 1;
        let pressure = truth.to(truth.elastic + slope, PERIOD);
        let rise = PressureRise::from_pascals(pressure, Linear::PRESSURE_FRACTION_BITS);
        assert!(rise.0.abs() < i32::MAX, "{pressure} Pa has no count");
        wall.step(&Linear::NEW, &step, rise);
        largest = largest.max((wall.elastic as f64 / 2_f64.powi(32) - truth.elastic).abs());
    }
    largest
}

/// Pressures come in counts of 0.004 Pa; up to 30 kPa of elastic pressure ten minutes long.
#[test]
fn the_elastic_pressure_of_a_convolution_comes_back() {
    let error = error_of_the_inversion(600_000, 0.0);
    assert!(error < 0.01, "{error} Pa");
}

/// The weight has 16 bits and is that of the pressure that the two steps before lead to: together within 0.02 % of the 30 kPa.
#[test]
fn the_elastic_pressure_of_a_weighted_convolution_comes_back() {
    for gain in [0.3, 4.0, 6.9] {
        let error = error_of_the_inversion(600_000, gain);
        println!("kappa {gain}: {error} Pa");
        assert!(error < 5.0, "{error} Pa");
    }
}

/// Bit for bit, pressures of any kind: what the tests of [`SeriesStep`] show of 8 h is so of the wall.
#[test]
fn without_a_weight_the_elastic_pressure_is_that_of_the_series_alone() {
    let series = agilus30(1e-3);
    let step = &series.step;
    let mut wall = Relaxing::<TERMS>::NEW;
    let (mut elastic, mut held) = (0_i64, [0_i64; TERMS]);
    let mut seed = 7_u32;
    for i in 0..100_000_i32 {
        // Numerical Recipes, 3rd ed., section 7.1.
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let rise = PressureRise((i % 40_000 - 2_000) * 200 + (seed >> 16) as i32);
        wall.step(&Linear::NEW, &series, rise);
        let stress = (i64::from(rise.0) << (FRACTION_BITS - 8)) - elastic - step.decay(&mut held);
        step.take(&mut held, stress);
        elastic += step.settled.of(stress);
        assert_eq!(wall.elastic, elastic, "{i}");
    }
}

/// `1 + sum c`: what a change over a step meets.
fn stiffness(seconds: f64) -> f64 {
    AGILUS30_RELAXATION
        .terms()
        .iter()
        .fold(1.0, |sum, term| sum + term.over(seconds).taken)
}

/// By hand: a first step meets `1 + sum c`, and a pressure held for thirty times the slowest term is the relaxed wall's.
#[test]
fn a_pressure_that_stays_becomes_the_relaxed_one() {
    let (seconds, rise) = (0.1, PressureRise(10_000 << 8));
    let step = agilus30(seconds);
    let mut wall = Relaxing::<TERMS>::NEW;
    let mut before = wall.step(&Linear::NEW, &step, rise).elastic;
    assert!((before.pascals(8) - 10_000.0 / stiffness(seconds)).abs() < 0.01);
    for _ in 0..300_000 {
        let elastic = wall.step(&Linear::NEW, &step, rise).elastic;
        assert!(elastic >= before && elastic <= rise);
        before = elastic;
    }
    assert!((before.pascals(8) - 10_000.0).abs() < 0.01, "{before:?}");
}

/// Both forms of the force are the area times the pressure where the area does not change, here 1 uN a count.
#[test]
fn a_constant_area_bears_the_pressure() {
    let step = agilus30(0.01);
    let mut wall = Relaxing::<TERMS>::NEW;
    // To its half, held, and back to a tenth.
    for i in 0..3_000 {
        let part = [i, 1000, 1000 - 9 * (i - 2000) / 10][i as usize / 1000];
        let rise = PressureRise(RISE_END / 2000 * part);
        let reading = wall.step(&Linear::NEW, &step, rise);
        let error = reading.contact.force.0 - rise.0;
        assert!(error.abs() <= 2 + (rise.0 >> 16), "{i}: {reading:?} at {rise:?}");
        assert_eq!(reading.contact.warnings, Warnings::NONE);
    }
}

/// The pressure is below that of rest while the wall comes back.
#[test]
fn a_wall_that_was_left_is_recovering_and_bears_nothing() {
    let step = agilus30(0.01);
    let mut wall = Relaxing::<TERMS>::NEW;
    for _ in 0..100 {
        wall.step(&Linear::NEW, &step, PressureRise(10_000 << 8));
    }
    for _ in 0..100 {
        let reading = wall.step(&Linear::NEW, &step, PressureRise(-256));
        assert_eq!(reading.contact.force, Micronewtons(0));
        assert_eq!(reading.contact.warnings, Warnings::RECOVERING);
        assert!(reading.elastic > PressureRise(0) && reading.contact.indentation > Nanometres(0));
    }
}

/// By hand, at a nanometre a count: while the pressure is below rest, three sixteenths of the fall of the settled indentation, times the part
/// that relaxes. A new contact forgets it with 2 s, and by eight times the relative growth.
#[test]
fn a_free_wall_comes_back_faster_than_a_pressed_one() {
    let step = agilus30(0.01);
    let settled = 1.0 / stiffness(0.01);
    let mut wall = Relaxing::<TERMS>::NEW;
    let rebound = |wall: &Relaxing<TERMS>| f64::from(wall.rebound) / 64.0;
    wall.indentation = 1_000_000;
    let reading = wall.rebounded(&step.step, 800_000, PressureRise(-1));
    let by_hand = 0.1875 * 200_000.0 * (1.0 - settled);
    assert!((rebound(&wall) - by_hand).abs() < 1.0, "{}", rebound(&wall));
    assert!(
        (800_000.0 - by_hand - f64::from(reading)).abs() < 2.0,
        "{reading}"
    );
    // At most a quarter.
    wall.indentation = 100_000_000;
    assert_eq!(wall.rebounded(&step.step, 800_000, PressureRise(-1)), 600_000);
    wall.rebounded(&step.step, 804_000, PressureRise(1));
    let by_hand = 200_000.0 * (-0.01_f64 / 2.0).exp() * (1.0 - 8.0 * 4.0 / 804.0);
    assert!((rebound(&wall) - by_hand).abs() < 5.0, "{}", rebound(&wall));
    // Twice as deep nothing is left, and a fall leaves it as it is.
    assert_eq!(wall.rebounded(&step.step, 1_608_000, PressureRise(1)), 1_608_000);
    // A wall of no series follows its table.
    let elastic = SeriesStep::over(&Relaxation::new(&[], 20.0, 0.0), 0.01);
    wall.indentation = 1_000_000;
    assert_eq!(wall.rebounded(&elastic, 800_000, PressureRise(-1)), 800_000);
}

#[test]
fn an_untouched_wall_stays_at_zero() {
    let step = agilus30(1e-3);
    let mut wall = Relaxing::<TERMS>::NEW;
    for _ in 0..10_000 {
        let reading = wall.step(&Linear::NEW, &step, PressureRise(0));
        assert_eq!(reading, RelaxedReading::default());
    }
    assert_eq!(wall, Relaxing::NEW);
}

fn any_rise() -> impl Strategy<Value = i32> {
    prop_oneof![Just(i32::MIN), Just(i32::MAX), Just(0), any::<i32>()]
}

fn any_factor() -> impl Strategy<Value = Factor> {
    (any::<u32>(), 0..=Factor::MAX_SHIFT).prop_map(|(mantissa, shift)| Factor { mantissa, shift })
}

proptest! {
    /// No pressure, and no series, has a force below zero or a panic.
    #[test]
    fn extremes_saturate(
        rises in proptest::collection::vec(any_rise(), 1..300),
        factors in proptest::array::uniform9(any_factor()),
        stiffness in any::<u32>(),
        any_rules in proptest::array::uniform4(any::<u32>()),
    ) {
        // Five eighths of a change are shared at most: no more than the whole.
        let eighth = |factor: Factor| Factor { shift: factor.shift.max(3), ..factor };
        let [settled, lost @ .., a, b, c, d] = factors;
        let settled = eighth(settled);
        let mut any_series = SeriesStep { settled, stiffness, count: 4, ..SeriesStep::default() };
        for (term, (lost, share)) in any_series.terms.iter_mut().zip(lost.into_iter().zip([a, b, c, d])) {
            *term = TermStep { lost, share: eighth(share) };
        }
        let [fluid_least, fluid_half, weight_gain, weight_half] = any_rules;
        let any_series = WallSeries {
            step: any_series, remaining_permille: 30, fluid_least, fluid_half, weight_gain, weight_half,
            retouch: stiffness,
            temperature_gain: 0,
        };
        let mut any_wall = Relaxing::<4>::NEW;
        let mut wall = Relaxing::<TERMS>::NEW;
        let step = agilus30(1e-3);
        for rise in rises {
            let reading = any_wall.step(&Linear::NEW, &any_series, PressureRise(rise));
            prop_assert!(reading.contact.force >= Micronewtons(0));
            let reading = wall.step(&Linear::NEW, &step, PressureRise(rise));
            prop_assert!(reading.contact.force >= Micronewtons(0));
            // A rise of all bits is 8.4 MPa, of which the wall's memory holds a half.
            let largest = (1_i64 << 54) + (1 << 40);
            prop_assert!(wall.elastic.abs() <= largest, "{}", wall.elastic);
        }
    }
}
