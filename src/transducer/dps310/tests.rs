use super::*;
use crate::transducer::script::{Script, Step, Stopwatch, fail_everywhere, play, read, write};
use embassy_futures::block_on;
use proptest::prelude::*;

/// Coefficients as of a real part, in the order of table 18.
const C: Coefficients = Coefficients {
    c0: 222,
    c1: -297,
    c00: 79_832,
    c10: -56_308,
    c01: -2_295,
    c11: 1_444,
    c20: -9_701,
    c21: 111,
    c30: -1_289,
};

/// The same, packed by hand: 0x0DE 0xED7, 0x137D8 0xF240C, 0xF709, 0x05A4, 0xDA1B, 0x006F, 0xFAF7.
const PACKED: [u8; 18] = [
    0x0D, 0xEE, 0xD7, 0x13, 0x7D, 0x8F, 0x24, 0x0C, 0xF7, 0x09, 0x05, 0xA4, 0xDA, 0x1B, 0x00, 0x6F, 0xFA,
    0xF7,
];

#[derive(Clone, Copy, Debug)]
struct Coefficients {
    c0: i32,
    c1: i32,
    c00: i32,
    c10: i32,
    c01: i32,
    c11: i32,
    c20: i32,
    c21: i32,
    c30: i32,
}

/// Sections 4.9.1 and 4.9.2 in real numbers, with kP of four pressures and kT of one temperature (table 9): pascals
/// and degrees Celsius.
fn datasheet(c: Coefficients, pressure: i32, temperature: i32) -> (f64, f64) {
    let (ps, ts) = (
        f64::from(pressure) / 3_670_016.0,
        f64::from(temperature) / 524_288.0,
    );
    let f = f64::from;
    let pascals = f(c.c00)
        + ps * (f(c.c10) + ps * (f(c.c20) + ps * f(c.c30)))
        + ts * f(c.c01)
        + ts * ps * (f(c.c11) + ps * f(c.c21));
    (pascals, f(c.c0) * 0.5 + f(c.c1) * ts)
}

/// 101.3 kPa at 25 degC: Ts = (111 - 25) / 297 = 0.28956, and the root of the cubic in Ps by hand.
const TEMPERATURE: i32 = 151_813;
const PRESSURE: i32 = -1_436_000;

/// Start and sample, register by register.
fn steps(coefficients: [u8; 18], pressure: i32, temperature: i32, settings: [u8; 2]) -> Vec<Step> {
    let word = |word: i32| word.to_be_bytes()[1..].to_vec();
    let mut words = [word(pressure), word(temperature)].concat();
    words.extend(settings);
    [
        start(coefficients),
        vec![
            write(&[0x08, 0x02]),
            read(&[0x08], [0xE0]),
            write(&[0x08, 0x01]),
            read(&[0x08], [0xF0]),
            read(&[0x00], words),
        ],
    ]
    .concat()
}

fn start(coefficients: [u8; 18]) -> Vec<Step> {
    vec![
        read(&[0x0D], [0x10]),
        write(&[0x0C, 0x09]),
        read(&[0x08], [0xC0]),
        read(&[0x10], coefficients),
        read(&[0x10], coefficients),
        read(&[0x28], [0x80]),
        write(&[0x0E, 0xA5]),
        write(&[0x0F, 0x96]),
        write(&[0x62, 0x02]),
        write(&[0x0E, 0x00]),
        write(&[0x0F, 0x00]),
        write(&[0x06, 0x02]),
        write(&[0x07, 0x80]),
        write(&[0x09, 0x00]),
    ]
}

fn part(script: Script, stopwatch: Stopwatch) -> Dps310<Script, Stopwatch> {
    Dps310::new(0x77, script, stopwatch)
}

fn sound() -> Vec<Step> {
    steps(PACKED, PRESSURE, TEMPERATURE, [0x02, 0x80])
}

fn outcome(steps: &[Step]) -> Result<Sample, Fault> {
    play(0x77, steps, part).0
}

#[test]
fn a_start_and_a_sample_transaction_by_transaction() {
    let (outcome, waited) = play(0x77, &sound(), part);
    let sample = outcome.expect("a sound part");
    let (pascals, degrees) = datasheet(C, PRESSURE, TEMPERATURE);
    assert!((95e3..105e3).contains(&pascals) && (degrees - 25.0).abs() < 0.01);
    assert!(
        (f64::from(sample.pressure.0) - 1e3 * pascals).abs() < 5.0,
        "{sample:?} for {pascals}"
    );
    assert_eq!(sample.temperature, Some(Centidegrees(2500)));
    // Up to 120 kPa.
    assert_eq!(sample.headroom.0, 120_000_000 - sample.pressure.0);
    // 40 ms of start-up, 3.6 and 8.4 ms of measurement.
    assert_eq!(waited, 52_000);
}

#[test]
fn every_transaction_that_fails_is_a_fault_and_passes() {
    assert_eq!(fail_everywhere(0x77, &sound(), part), 114);
}

#[test]
fn another_part_at_the_address_is_reported_so() {
    // A BMP280 says 0x58 at another register; here it reads 0. An undriven line reads ones.
    for identity in [0x00, 0x58, 0x11, 0xFF] {
        let steps = [read(&[0x0D], [identity])];
        assert_eq!(outcome(&steps), Err(Fault::WrongSensor));
    }
}

/// It has no register 0x28 and acknowledges it all the same. What it reads there is known from reports alone: no bit 7.
#[test]
fn an_spl06_which_answers_with_the_same_identity_is_refused() {
    let mut steps = start(PACKED);
    steps.truncate(5);
    for without_the_bit in [0x00, 0x7F] {
        steps.push(read(&[0x28], [without_the_bit]));
        assert_eq!(outcome(&steps), Err(Fault::WrongSensor));
        steps.pop();
    }
}

#[test]
fn a_part_that_does_not_feel_the_air_at_its_start_is_another() {
    let word_at = |pascals: f64| {
        let mut word = PRESSURE;
        while datasheet(C, word, TEMPERATURE).0 > pascals {
            word += 100;
        }
        word
    };
    let sound = |word| steps(PACKED, word, TEMPERATURE, [0x02, 0x80]);
    assert_eq!(outcome(&sound(word_at(56_900.0))), Err(Fault::WrongSensor));
    assert!(outcome(&sound(word_at(57_100.0))).is_ok());
    // What has felt the air is believed below it.
    let script = [self::sound(), sound(word_at(40_000.0))[14..].to_vec()].concat();
    let mut part = part(Script::new(0x77, &script), Stopwatch::default());
    let below = block_on(async {
        part.start().await?;
        part.sample().await?;
        part.sample().await
    });
    let below = below.expect("it is recognised").pressure.0;
    assert!((39_900_000..=40_000_000).contains(&below), "{below}");
}

#[test]
fn coefficients_that_are_blank_or_bent_are_refused() {
    for blank in [0x00, 0xFF] {
        assert_eq!(outcome(&start([blank; 18])), Err(Fault::SensorCalibration));
    }
    for bit in 0..144 {
        let mut bent = PACKED;
        bent[bit / 8] ^= 1 << (bit % 8);
        let mut steps = start(PACKED);
        steps[4] = read(&[0x10], bent);
        assert_eq!(outcome(&steps), Err(Fault::SensorCalibration), "bit {bit}");
    }
}

#[test]
fn a_part_that_lost_its_settings_gives_no_number() {
    // After a reset by itself: both settings at their reset value of 0, or one of them.
    for settings in [[0x00, 0x00], [0x02, 0x00], [0x00, 0x80]] {
        let steps = steps(PACKED, PRESSURE, TEMPERATURE, settings);
        assert_eq!(outcome(&steps), Err(Fault::SensorReset));
    }
}

#[test]
fn a_flag_that_never_comes_is_given_up() {
    for at in [2, 15, 17] {
        let mut steps = sound();
        steps.truncate(at);
        // Everything but the flags waited for.
        let stuck = [0x80, 0xC0, 0xE0][[2, 15, 17].iter().position(|&n| n == at).expect("one of them")];
        steps.extend(vec![read(&[0x08], [stuck]); 8]);
        let (outcome, waited) = play(0x77, &steps, part);
        assert_eq!(outcome, Err(Fault::SensorBusy));
        assert!(waited <= 40_000 + 3_600 + 8_400 + 2_000);
    }
}

#[test]
fn an_undriven_line_is_no_pressure() {
    let ones = steps(PACKED, -1, -1, [0xFF, 0xFF]);
    assert_eq!(outcome(&ones), Err(Fault::SensorReset));
    for end in [0x7F_FFFF, -0x80_0000] {
        assert_eq!(
            outcome(&steps(PACKED, end, TEMPERATURE, [0x02, 0x80])),
            Err(Fault::SensorSaturated)
        );
    }
}

#[test]
fn without_a_start_there_is_no_sample() {
    let mut part = part(Script::new(0x77, &[]), Stopwatch::default());
    assert_eq!(block_on(part.sample()), Err(Fault::SensorReset));
}

#[test]
fn beyond_120_kilopascals_is_a_lower_bound() {
    let mut word = PRESSURE;
    while datasheet(C, word, TEMPERATURE).0 < 121e3 {
        word -= 1000;
    }
    let sample = outcome(&steps(PACKED, word, TEMPERATURE, [0x02, 0x80])).expect("the part goes on");
    assert!(sample.headroom.0 < -990_000, "{sample:?}");
}

/// Coefficients into registers as table 18 has them.
fn packed(c: Coefficients) -> [u8; 18] {
    let field = |value: i32, bits: u32| u64::from(value as u32) & ((1 << bits) - 1);
    let mut bytes = vec![];
    bytes.extend(&(field(c.c0, 12) << 12 | field(c.c1, 12)).to_be_bytes()[5..]);
    bytes.extend(&(field(c.c00, 20) << 20 | field(c.c10, 20)).to_be_bytes()[3..]);
    for value in [c.c01, c.c11, c.c20, c.c21, c.c30] {
        bytes.extend((value as i16).to_be_bytes());
    }
    bytes.try_into().expect("eighteen")
}

#[test]
fn the_packing_is_table_18s() {
    assert_eq!(packed(C), PACKED);
}

prop_compose! {
    fn coefficients()(
        [c0, c1] in [-2048_i32..2048, -2048_i32..2048],
        [c00, c10] in [-524_288_i32..524_288, -524_288_i32..524_288],
        small in any::<[i16; 5]>(),
    ) -> Coefficients {
        let [c01, c11, c20, c21, c30] = small.map(i32::from);
        Coefficients { c0, c1, c00, c10, c01, c11, c20, c21, c30 }
    }
}

proptest! {
    #[test]
    fn pressure_and_temperature_are_the_datasheets(
        c in coefficients(),
        pressure in -0x80_0000_i32..=0x7F_FFFF,
        temperature in -0x80_0000_i32..=0x7F_FFFF,
    ) {
        let (pascals, degrees) = datasheet(c, pressure, temperature);
        let calibration = Calibration::of(packed(c)).expect("not blank");
        match calibration.sample(pressure, temperature) {
            Ok(sample) => {
                // Rounding down at each of six products, the last one of them multiplied by up to 16 of Ts.
                let held = (1e3 * pascals).clamp(f64::from(i32::MIN), f64::from(i32::MAX));
                prop_assert!((f64::from(sample.pressure.0) - held).abs() < 60.0, "{sample:?} for {pascals}");
                let measured = f64::from(sample.temperature.expect("measured").0);
                prop_assert!((measured - 100.0 * degrees).abs() <= 1.01);
            }
            Err(Fault::SensorSaturated) => prop_assert!([-0x80_0000, 0x7F_FFFF].iter().any(|end| [pressure, temperature].contains(end))),
            Err(fault) => {
                prop_assert_eq!(fault, Fault::SensorImplausible);
                prop_assert!(pascals < 29_000.1 || !(-39.98..=85.0).contains(&degrees));
            }
        }
    }
}
