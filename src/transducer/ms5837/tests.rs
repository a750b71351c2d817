use super::*;
use crate::transducer::script::{Script, Step, Stopwatch, fail_everywhere, play, read, write};
use proptest::prelude::*;

/// The datasheet's example (page 7): C1 to C6, D1, D2, and what comes of them.
const COEFFICIENTS: [u16; 6] = [46372, 43981, 29059, 27842, 31553, 28165];
const D1: u32 = 6_465_444;
const D2: u32 = 8_077_636;
const PASCALS: i32 = 110_002;
const CENTIDEGREES: i16 = 2000;

/// The check by long division of the 112 bits and twelve zeros by x^4 + x + 1.
fn check(words: [u16; 7]) -> u16 {
    let mut bits: Vec<bool> = words
        .iter()
        .flat_map(|word| (0..16).rev().map(move |n| word >> n & 1 == 1))
        .collect();
    bits[..4].fill(false);
    bits.resize(124, false);
    for i in 0..120 {
        if bits[i] {
            for (j, tap) in [true, false, false, true, true].into_iter().enumerate() {
                bits[i + j] ^= tap;
            }
        }
    }
    bits[120..]
        .iter()
        .fold(0, |number, &bit| number << 1 | u16::from(bit))
}

fn prom(version: u16, coefficients: [u16; 6]) -> [u16; 7] {
    let [c1, c2, c3, c4, c5, c6] = coefficients;
    let words = [version << 5, c1, c2, c3, c4, c5, c6];
    [check(words) << 12 | words[0], c1, c2, c3, c4, c5, c6]
}

/// Reset, seven words, then temperature and pressure, each converted and read: typed from the datasheet's figures of
/// the I2C commands.
fn steps(prom: [u16; 7], temperature: u32, pressure: u32) -> Vec<Step> {
    const PROM_COMMANDS: [&[u8]; 7] = [&[0xA0], &[0xA2], &[0xA4], &[0xA6], &[0xA8], &[0xAA], &[0xAC]];
    let mut steps = vec![write(&[0x1E])];
    for (command, word) in PROM_COMMANDS.into_iter().zip(prom) {
        steps.push(read(command, word.to_be_bytes()));
    }
    let adc = |word: u32| read(&[0x00], &word.to_be_bytes()[1..]);
    steps.extend([write(&[0x50]), adc(temperature), write(&[0x46]), adc(pressure)]);
    steps
}

fn part(script: Script, stopwatch: Stopwatch) -> Ms5837<Script, Stopwatch> {
    Ms5837::new(0x76, script, stopwatch)
}

fn outcome(prom: [u16; 7], temperature: u32, pressure: u32) -> Result<Sample, Fault> {
    play(0x76, &steps(prom, temperature, pressure), part).0
}

#[test]
fn the_datasheets_example_transaction_by_transaction() {
    // The first word of the example, with the check worked out by TE's own code: 8 for version 0.
    assert_eq!(prom(0, COEFFICIENTS)[0], 0x8000);
    let (outcome, waited) = play(0x76, &steps(prom(0, COEFFICIENTS), D2, D1), part);
    let sample = outcome.expect("a sound part");
    // In whole pascals, rounded down, as there.
    assert_eq!(sample.pressure.0 / 1000, PASCALS);
    assert_eq!(sample.temperature, Some(Centidegrees(CENTIDEGREES)));
    // Up to 2 bar.
    assert_eq!(sample.headroom.0, 200_000_000 - sample.pressure.0);
    assert_eq!(sample.raw, Some(D1));
    // 10 ms of reload, 0.6 and 4.6 ms of conversion.
    assert_eq!(waited, 15_200);
}

#[test]
fn every_transaction_that_fails_is_a_fault_and_passes() {
    assert_eq!(
        fail_everywhere(0x76, &steps(prom(0, COEFFICIENTS), D2, D1), part),
        72
    );
}

#[test]
fn no_bit_of_the_calibration_can_flip() {
    let sound = prom(0x15, COEFFICIENTS);
    assert!(outcome(sound, D2, D1).is_ok());
    for bit in 0..112 {
        let mut bent = sound;
        bent[bit / 16] ^= 1 << (bit % 16);
        assert_eq!(outcome(bent, D2, D1), Err(Fault::SensorCalibration), "bit {bit}");
    }
}

#[test]
fn empty_memory_is_no_calibration_though_its_check_fits() {
    assert_eq!(check([0; 7]), 0);
    assert_eq!(outcome([0; 7], D2, D1), Err(Fault::SensorCalibration));
    assert_eq!(outcome([u16::MAX; 7], D2, D1), Err(Fault::SensorCalibration));
    for coefficient in 0..6 {
        let mut blank = COEFFICIENTS;
        blank[coefficient] = 0;
        assert_eq!(outcome(prom(0, blank), D2, D1), Err(Fault::SensorCalibration));
    }
}

#[test]
fn the_thirty_bar_part_is_another() {
    assert_eq!(outcome(prom(0x1A, COEFFICIENTS), D2, D1), Err(Fault::WrongSensor));
}

/// The datasheet's example of the MS5837-30BA: 399.98 kPa after the second order, 399.97 before it.
const THIRTY_BAR: [u16; 6] = [34982, 36352, 20328, 22354, 26646, 26146];
const THIRTY_BAR_D1: u32 = 4_958_179;
const THIRTY_BAR_D2: u32 = 6_815_414;

#[test]
fn the_thirty_bar_part_with_this_parts_version_is_another() {
    let (pascals, _) = datasheet(THIRTY_BAR, THIRTY_BAR_D1, THIRTY_BAR_D2);
    // What this part's formula makes of it: a twentieth.
    assert!((pascals - 399_980.0 / 20.0).abs() < 100.0, "{pascals}");
    for version in [0, 0x15] {
        assert_eq!(
            outcome(prom(version, THIRTY_BAR), THIRTY_BAR_D2, THIRTY_BAR_D1),
            Err(Fault::WrongSensor)
        );
    }
}

/// D1 at a pressure, pascals, with the example's coefficients and temperature: the slope of the example's formula, and
/// then the nearest.
fn d1_at(pascals: f64) -> u32 {
    let at = |d1: u32| datasheet(COEFFICIENTS, d1, D2).0;
    let slope = (at(D1 + 100_000) - at(D1)) / 1e5;
    (f64::from(D1) + (pascals - at(D1)) / slope).round() as u32
}

#[test]
fn a_part_that_does_not_feel_the_air_at_its_start_is_another() {
    let prom = prom(0, COEFFICIENTS);
    // The air as a 30 bar part reads here: a twentieth, even of 10 bar; and the thinnest, 3 kPa off.
    for pascals in [3_000.0, 5_066.0, 50_000.0, 56_990.0] {
        assert_eq!(
            outcome(prom, D2, d1_at(pascals)),
            Err(Fault::WrongSensor),
            "{pascals}"
        );
    }
    for pascals in [57_010.0, 60_000.0, 108_000.0, 190_000.0] {
        assert!(outcome(prom, D2, d1_at(pascals)).is_ok(), "{pascals}");
    }
}

#[test]
fn a_part_that_felt_the_air_once_is_believed_below_it_until_it_is_started_again() {
    let prom = prom(0, COEFFICIENTS);
    let low = steps(prom, D2, d1_at(40_000.0));
    let script = Script::new(0x76, &[steps(prom, D2, D1), low[8..].to_vec(), low].concat());
    let mut part = part(script.clone(), Stopwatch::default());
    let both = async {
        part.start().await?;
        part.sample().await?;
        let below = part.sample().await;
        part.start().await?;
        assert_eq!(part.sample().await, Err(Fault::WrongSensor));
        below
    };
    let below = embassy_futures::block_on(both).expect("it is recognised");
    assert!((below.pressure.0 - 40_000_000).abs() < 10_000);
    assert!(script.is_over());
}

#[test]
fn a_word_of_zero_is_no_conversion_and_one_of_ones_no_part() {
    let prom = prom(0, COEFFICIENTS);
    assert_eq!(outcome(prom, 0, D1), Err(Fault::SensorBusy));
    assert_eq!(outcome(prom, D2, 0), Err(Fault::SensorBusy));
    assert_eq!(outcome(prom, 0x00FF_FFFF, D1), Err(Fault::SensorImplausible));
    assert_eq!(outcome(prom, D2, 0x00FF_FFFF), Err(Fault::SensorImplausible));
}

#[test]
fn beyond_two_bar_is_a_lower_bound() {
    // 81.4 % of the word's range is 2.1 bar with these coefficients.
    let sample = outcome(prom(0, COEFFICIENTS), D2, 8_700_000).expect("the part goes on beyond its range");
    assert!(
        sample.pressure.0 > 200_000_000 && sample.headroom.0 < 0,
        "{sample:?}"
    );
}

#[test]
fn without_a_start_there_is_no_sample() {
    let mut part = part(Script::new(0x76, &[]), Stopwatch::default());
    assert_eq!(embassy_futures::block_on(part.sample()), Err(Fault::SensorReset));
}

/// Pages 7 and 8 in real numbers: pascals and hundredths of a degree.
fn datasheet(coefficients: [u16; 6], d1: u32, d2: u32) -> (f64, f64) {
    let [c1, c2, c3, c4, c5, c6] = coefficients.map(f64::from);
    let (d1, d2) = (f64::from(d1), f64::from(d2));
    let two = |power: i32| f64::powi(2.0, power);
    let dt = d2 - c5 * two(8);
    let temp = 2000.0 + dt * c6 / two(23);
    let off = c2 * two(17) + c4 * dt / two(6);
    let sens = c1 * two(16) + c3 * dt / two(7);
    let (ti, offi, sensi) = if temp < 2000.0 {
        (
            11.0 * dt * dt / two(35),
            31.0 * (temp - 2000.0).powi(2) / two(3),
            63.0 * (temp - 2000.0).powi(2) / two(5),
        )
    } else {
        (0.0, 0.0, 0.0)
    };
    let p = (d1 * (sens - sensi) / two(21) - (off - offi)) / two(15);
    (p, temp - ti)
}

proptest! {
    #[test]
    fn pressure_and_temperature_are_the_datasheets(
        sensitivity in 37_001_u16..50_000,
        others in prop::array::uniform5(20_000_u16..50_000),
        d1 in 1_u32..0x00FF_FFFF,
        d2 in 1_u32..0x00FF_FFFF,
    ) {
        let [c2, c3, c4, c5, c6] = others;
        let coefficients = [sensitivity, c2, c3, c4, c5, c6];
        let (pascals, centidegrees) = datasheet(coefficients, d1, d2);
        match outcome(prom(0, coefficients), d2, d1) {
            Ok(sample) => {
                // Whole hundredths of a degree go into the second order: a few pascals at the cold end.
                prop_assert!((f64::from(sample.pressure.0) - pascals * 1e3).abs() < 4e3, "{sample:?} for {pascals}");
                let temperature = sample.temperature.expect("measured").0;
                prop_assert!((f64::from(temperature) - centidegrees).abs() <= 2.0);
                prop_assert!((56_990.0..).contains(&pascals) && (-4002.0..=8502.0).contains(&centidegrees));
            }
            Err(Fault::WrongSensor) => prop_assert!(pascals < 57_010.0),
            Err(fault) => {
                prop_assert_eq!(fault, Fault::SensorImplausible);
                prop_assert!(pascals < 1010.0 || !(-3998.0..8500.0).contains(&centidegrees));
            }
        }
    }

    #[test]
    fn no_words_make_it_panic(words in any::<[u16; 7]>(), valid in any::<bool>(), d1 in any::<u32>(), d2 in any::<u32>()) {
        let [_, coefficients @ ..] = words;
        let words = if valid { prom(0, coefficients) } else { words };
        let _ = outcome(words, d2 >> 8, d1 >> 8);
    }
}
