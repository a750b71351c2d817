//! Five fingertips on one board: one is pressed, the wire of one comes off.

use crate::{SIGNAL_PATH, design, press_hold_release};
use emulator::fingertip_design::FingertipDesign;
use emulator::hand::{EmulatedHand, HandInstant, HandRun};
use emulator::image::{Image, Size};
use emulator::plant::Plant;
use emulator::scenario::{Phase, Scenario, WireFault};
use emulator::transducer::Wiring;
use fingertip::image::ImageDesign;
use fingertip::link::command::{Command, CommandKind, Outcome, Request};
use fingertip::link::tips::encode_request;
use fingertip::signal::calibration::Calibration;
use fingertip::signal::report::Measurement;
use fingertip::status::{Fault, Stored, Touch, Warnings};
use fingertip::storage::hand_record::length;
use fingertip::storage::hand_store::TipIdentity;
use fingertip::units::Millipascals;
use host_tests::nor_flash::saved_hand;
use model_tables::design_file::hand::HandFile;
use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;
use std::sync::OnceLock;

pub(crate) const TIPS: usize = 5;
/// Scans of a block, each with one code of a tip: (5 * 10 + 17) us * 15 = 1005 us.
const CODES: f64 = 15.0;
const PERIOD: f64 = 1005e-6;
/// Most instructions in a millisecond: 2.6 times the 3102 of one fingertip.
const PER_MILLISECOND: f64 = 8_065.0;
/// The same of five walls that relax in seven terms: an eighth of the core's 128 000 cycles if each took one.
const RELAXING_PER_MILLISECOND: f64 = 16_000.0;
/// Instructions of a report of one fingertip, which each of five may exceed by a tenth.
const REPORT: f64 = 513.0;
/// Most bytes of flash and RAM, the stack left out.
const LARGEST: Size = Size {
    flash: 56 * 1024,
    ram: 24 * 1024,
};
const PRESSED: usize = 1;
const UNPLUGGED: usize = 3;
/// When its wire is off, and when codes lie in their neighbours' places, seconds.
const OFF: std::ops::Range<f64> = 0.8..1.1;
const SHIFTED: std::ops::Range<f64> = 1.75..1.80;
const END: f64 = 2.0;

/// The shipped hand: five fingertips of the default design.
pub(crate) fn hand_file() -> PathBuf {
    host_tests::workspace().join("model-tables/hands/hand.toml")
}

pub(crate) const NAMES: [&str; TIPS] = ["thumb", "index", "middle", "ring", "little"];

pub(crate) fn phase(name: &str, duration_ms: f64, to_percent: Option<f64>) -> Phase {
    Phase {
        name: name.to_owned(),
        duration_ms,
        to_percent,
        to_force_n: None,
        radius_mm: None,
    }
}

/// What happens to a tip; its noise is its own.
fn scenario(tip: usize) -> Scenario {
    let mut scenario = Scenario {
        about: format!("tip {tip}"),
        seed: 40 + tip as u64,
        air_kpa: 101.325,
        design: None,
        phase: vec![phase("rest", 1e3 * END, None)],
        wire: vec![],
        event: vec![],
        repeats: false,
    };
    if tip == PRESSED {
        scenario.phase = vec![
            phase("rest", 500.0, None),
            phase("press", 400.0, Some(90.0)),
            phase("hold", 400.0, None),
            phase("release", 300.0, Some(0.0)),
            phase("rest", 400.0, None),
        ];
    }
    if tip == UNPLUGGED {
        scenario.wire = vec![WireFault {
            is: Wiring::Open,
            from_ms: 1e3 * OFF.start,
            until_ms: Some(1e3 * OFF.end),
        }];
    }
    scenario
}

fn image() -> &'static Image {
    static IMAGE: OnceLock<Image> = OnceLock::new();
    IMAGE.get_or_init(|| Image::firmware(Some(&hand_file())).expect("the firmware builds"))
}

pub(crate) struct Run {
    plants: Vec<Plant>,
    pub(crate) hand: HandRun,
}

pub(crate) fn run() -> &'static Run {
    static RUN: OnceLock<Run> = OnceLock::new();
    RUN.get_or_init(|| {
        let one = design()
            .plant(scenario(0))
            .expect("the default design can be pressed");
        let plants: Vec<Plant> = (0..TIPS).map(|tip| one.through(scenario(tip))).collect();
        let request = |sequence, command| Request { sequence, command };
        let hand = EmulatedHand {
            tips: plants.clone(),
            places: vec![],
            held: None,
            shifted: SHIFTED,
            sent: vec![
                (0.45, encode_request(2, &request(7, Command::Undo)).to_vec()),
                (
                    1.0,
                    encode_request(PRESSED as u8, &request(8, Command::SelfTest { indentation: 0 })).to_vec(),
                ),
                (1.2, encode_request(9, &request(9, Command::Info)).to_vec()),
            ],
        };
        let hand = emulator::hand::run(image(), hand, END, SIGNAL_PATH).expect("the image runs");
        Run { plants, hand }
    })
}

/// The reports of an instant that are values.
fn measured(instant: &HandInstant, tip: usize) -> Option<Measurement> {
    instant.reports[tip].outcome.ok()
}

/// Instants while everything is as it should be: zeros are taken, and the converter's codes are in their places.
fn settled(hand: &HandRun) -> impl Iterator<Item = &HandInstant> {
    let whole = |instant: &&HandInstant| instant.time > 0.42 && instant.time < SHIFTED.start - 0.01;
    hand.instants.iter().filter(whole)
}

#[test]
fn five_tips_report_twice_a_millisecond_less_and_nothing_is_lost() {
    let hand = &run().hand;
    assert_eq!(hand.gaps, Vec::<String>::new());
    assert!(
        hand.broken.is_empty() && hand.of_version_2 == 0,
        "{:?}",
        hand.broken
    );
    assert_eq!(hand.lost, 0);
    assert!(hand.instants.iter().all(|instant| instant.reports.len() == TIPS));
    // One in two of the periods, and one more for each change of a status.
    let steady: Vec<&HandInstant> = settled(hand).collect();
    let most = steady
        .windows(2)
        .map(|pair| {
            let periods = (pair[1].time - pair[0].time) / PERIOD;
            (periods - periods.round()).abs()
        })
        .fold(0.0, f64::max);
    println!("sampling instants: within {:.3} % of the period", 1e2 * most);
    assert!(most < 0.01, "{most}");
    let rate = settled(hand).count() as f64 / (SHIFTED.start - 0.43);
    println!("frames of five tips: {rate:.1} a second");
    assert!((rate / 497.5 - 1.0).abs() < 0.05, "{rate}");
}

#[test]
fn each_tip_reports_its_own_press_and_its_own_broken_wire() {
    let run = run();
    let mut forces = 0;
    for instant in settled(&run.hand) {
        for (tip, plant) in run.plants.iter().enumerate() {
            let off = tip == UNPLUGGED && instant.time > OFF.start - 2e-3 && instant.time < OFF.end + 0.02;
            if tip == UNPLUGGED && instant.time > OFF.start + 3e-3 && instant.time < OFF.end - 3e-3 {
                assert_eq!(
                    instant.reports[tip].outcome,
                    Err(Fault::SensorOpen),
                    "{}",
                    instant.time
                );
            }
            if off {
                continue;
            }
            let found = measured(instant, tip);
            let found =
                found.unwrap_or_else(|| panic!("tip {tip} at {}: {:?}", instant.time, instant.reports[tip]));
            let rise = found
                .pressure_rise
                .pascals(u32::from(instant.pressure_fraction_bits));
            // The plate moves while a report is sampled; then six deviations of what it says of itself, which the byte rounds
            // by 4.5 %.
            let [low, high] = plant.pressure_rises(instant.time);
            let sigma = found
                .sigma
                .pressure_rise
                .pascals(u32::from(instant.pressure_fraction_bits));
            let allowed = 6.3 * sigma;
            assert!(
                (low - allowed..=high + allowed).contains(&rise),
                "tip {tip} at {}: {rise} Pa for {low} to {high}, sigma {sigma}",
                instant.time
            );
            let truth = plant.truth(instant.time);
            if tip == PRESSED && (0.95..1.25).contains(&instant.time) {
                forces += 1;
                assert_eq!(found.touch, Touch::Touched);
                let force = found.force.newtons();
                assert!(
                    (force / truth.force - 1.0).abs() < 0.01,
                    "{force} N for {}",
                    truth.force
                );
            }
            if tip != PRESSED {
                assert_ne!(found.touch, Touch::Touched, "tip {tip} at {}", instant.time);
            }
        }
    }
    assert!(forces > 100, "{forces}");
}

#[test]
fn codes_out_of_place_are_a_fault_of_every_tip_and_over_with_them() {
    let hand = &run().hand;
    let mut seen = 0;
    for instant in &hand.instants {
        if instant.time > SHIFTED.start + 4e-3 && instant.time < SHIFTED.end - 4e-3 {
            seen += 1;
            assert!(
                instant.reports.iter().all(|report| report.outcome.is_err()),
                "{instant:?}"
            );
            assert!(
                instant
                    .reports
                    .iter()
                    .all(|report| report.outcome == Err(Fault::ChannelIdentity)),
                "{instant:?}"
            );
        }
    }
    assert!(seen > 10, "{seen}");
    let last = hand.instants.last().expect("reports");
    assert!(
        last.reports.iter().all(|report| report.outcome.is_ok()),
        "{last:?}"
    );
}

#[test]
fn a_hand_greets_and_each_tip_answers_for_itself() {
    let hand = &run().hand;
    let (board, tips) = hand.boards.first().expect("a greeting");
    assert_eq!((usize::from(*tips), board.report_period), (TIPS, 2010));
    for (tip, greeting) in hand.greetings.iter().take(TIPS).enumerate() {
        assert_eq!(
            (usize::from(greeting.tip), greeting.name.as_str()),
            (tip, NAMES[tip])
        );
        assert_eq!(greeting.design_hash, design().hash());
    }
    let of = |sequence: u16| {
        hand.answers
            .iter()
            .filter(|(_, answer)| answer.command_sequence == sequence)
            .map(|(tip, answer)| (*tip, answer.command, answer.outcome))
            .collect::<Vec<_>>()
    };
    assert_eq!(of(7), [(2, CommandKind::Undo, Outcome::NothingToUndo)]);
    assert_eq!(of(8), [(PRESSED as u8, CommandKind::SelfTest, Outcome::Done)]);
    // There is no tip 9.
    assert_eq!(of(9), []);
    let refused = hand.boards.last().map(|(board, _)| board.commands_refused);
    println!("commands refused: {refused:?}");
}

/// Bytes of a slot of the default board, and where the first one lies.
const SLOT: usize = 16 * 1024;
const CALIBRATIONS: u64 = 0x0810_0000;

/// A start with a record in the flash: the index has a gain of 2 %, the middle what was saved for another tip, the others nothing.
#[test]
fn each_tip_starts_with_its_own_stored_calibration() {
    const GAIN: i32 = 20_000;
    let file = HandFile::read(&hand_file()).expect("it is shipped");
    let designs = file.designs().expect("they are shipped");
    let hashes = file.tip_hashes(&designs);
    let constants = ImageDesign::CONSTANTS;
    let identity = |hash: u64| TipIdentity {
        hash,
        table_version: constants.table_version,
        range: constants.transducer.range,
    };
    let mut identities: [TipIdentity; TIPS] = std::array::from_fn(|tip| identity(hashes[tip]));
    identities[2] = identity(!hashes[2]);
    let calibration = Calibration {
        zero: Some(Millipascals(constants.rest_pressure * 1000)),
        gain: GAIN,
        ..Calibration::default()
    };
    let bytes =
        saved_hand::<SLOT, TIPS, { length(TIPS) }>(identities, &[(2, calibration), (PRESSED, calibration)]);
    let image = image().clone().with_flash(CALIBRATIONS, bytes);
    let one = design()
        .plant(scenario(0))
        .expect("the default design can be pressed");
    let plants: Vec<Plant> = (0..TIPS).map(|tip| one.through(scenario(tip))).collect();
    let save = Request {
        sequence: 7,
        command: Command::Save { gain: None },
    };
    let hand = EmulatedHand {
        tips: plants.clone(),
        places: vec![],
        held: None,
        shifted: 9.0..9.0,
        sent: vec![(0.47, encode_request(4, &save).to_vec())],
    };
    let hand = emulator::hand::run(&image, hand, 1.25, &[]).expect("the image runs");
    assert_eq!(hand.gaps, Vec::<String>::new());
    let states: Vec<(Stored, u32)> = hand.greetings[hand.greetings.len() - TIPS..]
        .iter()
        .map(|greeting| (greeting.stored, greeting.stored_sequence))
        .collect();
    let nothing = (Stored::None, 0);
    let expected = [
        nothing,
        (Stored::InUse, 2),
        (Stored::OtherDesign, 1),
        nothing,
        nothing,
    ];
    assert_eq!(states, expected);
    // The emulated flash takes no writes.
    let answers: Vec<(u8, Outcome)> = hand
        .answers
        .iter()
        .map(|(tip, answer)| (*tip, answer.outcome))
        .collect();
    assert_eq!(answers, [(4, Outcome::MemoryFailed)]);
    let mut held = 0;
    for instant in hand
        .instants
        .iter()
        .filter(|instant| (0.95..1.2).contains(&instant.time))
    {
        held += 1;
        let bits = u32::from(instant.pressure_fraction_bits);
        let found = measured(instant, PRESSED)
            .expect("a reading")
            .pressure_rise
            .pascals(bits);
        let [low, high] = plants[PRESSED].pressure_rises(instant.time);
        let ratio = 2.0 * found / (low + high);
        assert!((ratio - 1.02).abs() < 1.5e-3, "{ratio}");
        let refused = |tip: usize| {
            measured(instant, tip)
                .expect("a reading")
                .warnings
                .contains(Warnings::CALIBRATION_REFUSED)
        };
        let of_tips: Vec<bool> = [0, 1, 2, 4].map(refused).to_vec();
        assert_eq!(of_tips, [false, false, true, false]);
    }
    assert!(held > 100, "{held}");
}

#[test]
fn five_tips_cost_less_than_three_boards_and_a_report_no_more() {
    let hand = &run().hand;
    let per_millisecond = hand.instructions as f64 / (hand.time * 1e3);
    let reports = hand.calls.len() as f64;
    let report = hand.calls.iter().sum::<u64>() as f64 / reports;
    println!("five tips: {per_millisecond:.0} instructions a millisecond, {report:.0} a report");
    assert!(per_millisecond <= PER_MILLISECOND, "{per_millisecond}");
    assert!(report <= 1.1 * REPORT, "{report}");
}

/// Five tips of a wall that relaxes, at rest and one pressed.
#[test]
fn five_relaxing_tips_cost_an_eighth_of_the_core() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let design = host_tests::design("index-fingertip");
    let mut tips = String::new();
    for (channel, name) in NAMES.iter().enumerate() {
        let _ = write!(
            tips,
            "[[tip]]\nname = {name:?}\ndesign = {design:?}\nchannel = {channel}\n"
        );
    }
    let file = folder.join("relaxing-hand.toml");
    fs::write(&file, format!("name = \"relaxing\"\n{tips}")).expect("the test folder");
    let image = Image::firmware(Some(&file)).expect("the firmware builds");
    let one = FingertipDesign::read(&design)
        .expect("it is shipped")
        .plant(scenario(0))
        .expect("it can be pressed");
    let hand = EmulatedHand {
        tips: (0..TIPS).map(|tip| one.through(scenario(tip))).collect(),
        places: vec![],
        held: None,
        shifted: END..END,
        sent: vec![],
    };
    let hand = emulator::hand::run(&image, hand, 1.2, SIGNAL_PATH).expect("the image runs");
    assert_eq!((hand.gaps.len(), hand.broken.len(), hand.lost), (0, 0, 0));
    // In the hold; what the wall makes of it in time is a single tip's matter.
    let pressed = one.through(scenario(PRESSED));
    let held = hand.instants.iter().filter(|instant| instant.time > 1.0);
    let mut held_for = 0;
    for instant in held {
        held_for += 1;
        let found = measured(instant, PRESSED).expect("a reading");
        assert_eq!(found.touch, Touch::Touched);
        let bits = u32::from(instant.pressure_fraction_bits);
        let [low, high] = pressed.pressure_rises(instant.time);
        let allowed = 6.3 * found.sigma.pressure_rise.pascals(bits);
        let rise = found.pressure_rise.pascals(bits);
        assert!(
            (low - allowed..=high + allowed).contains(&rise),
            "{rise} Pa for {low}"
        );
    }
    assert!(held_for > 80, "{held_for}");
    let per_millisecond = hand.instructions as f64 / (hand.time * 1e3);
    let report = hand.calls.iter().sum::<u64>() as f64 / hand.calls.len() as f64;
    let size = image.size().expect("it is an image");
    println!(
        "five relaxing tips: {per_millisecond:.0} instructions a millisecond, {report:.0} a report; flash {} bytes, RAM {} bytes",
        size.flash, size.ram
    );
    assert!(per_millisecond <= RELAXING_PER_MILLISECOND, "{per_millisecond}");
    assert!(size.flash <= LARGEST.flash && size.ram <= LARGEST.ram, "{size:?}");
}

#[test]
fn a_hands_image_is_small_on_every_board() {
    let boards = [None, Some("board-nucleo-l432kc")];
    for board in boards {
        let size = match board {
            None => image().size(),
            Some(_) => Image::build_for("firmware", Some(&hand_file()), board)
                .expect("the firmware builds")
                .size(),
        }
        .expect("it is an image");
        println!(
            "{}: flash {} bytes, RAM {} bytes",
            board.unwrap_or("board-nucleo-f429zi"),
            size.flash,
            size.ram
        );
        assert!(size.flash <= LARGEST.flash && size.ram <= LARGEST.ram, "{size:?}");
    }
}

/// Noise of a pressure rise and what the report says of it, both root mean squares, pascals.
struct Spread {
    noise: f64,
    sigma: f64,
}

fn spread(values: &[(f64, f64)]) -> Spread {
    let count = values.len() as f64;
    let mean = values.iter().map(|(rise, _)| rise).sum::<f64>() / count;
    let square = |f: &dyn Fn(&(f64, f64)) -> f64| (values.iter().map(f).sum::<f64>() / count).sqrt();
    Spread {
        noise: square(&|(rise, _)| (rise - mean) * (rise - mean)),
        sigma: square(&|(_, sigma)| sigma * sigma),
    }
}

#[test]
fn fewer_codes_a_report_are_more_noise_and_a_report_says_so() {
    let hand = &run().hand;
    let one: Vec<(f64, f64)> = press_hold_release()
        .record
        .rows
        .iter()
        .filter(|row| row.time > 0.35 && row.time < 0.49)
        .filter_map(|row| Some((row.reported?.pressure_rise, row.sigma?.pressure_rise)))
        .collect();
    let one = spread(&one);
    println!(
        "one tip: 100 codes a report, noise {:.2} Pa, sigma {:.2} Pa",
        one.noise, one.sigma
    );
    // White noise of 10 Pa a code, averaged, and by the kernel 1-2-1 over 4: 6/16 of its variance.
    let expected = |codes: f64| 10.0 * (6.0 / 16.0 / codes).sqrt();
    for tip in [0, 2, 4] {
        let values: Vec<(f64, f64)> = settled(hand)
            .filter_map(|instant| {
                let bits = u32::from(instant.pressure_fraction_bits);
                let found = measured(instant, tip)?;
                Some((
                    found.pressure_rise.pascals(bits),
                    found.sigma.pressure_rise.pascals(bits),
                ))
            })
            .collect();
        let five = spread(&values);
        println!(
            "tip {tip} of five: {CODES} codes a report, noise {:.2} Pa, sigma {:.2} Pa",
            five.noise, five.sigma
        );
        // A code is three deviations of the noise: where the level is at a code's edge, its rounding adds as much again.
        assert!(
            (0.9..1.7).contains(&(five.noise / expected(CODES))),
            "{} Pa",
            five.noise
        );
        assert!(five.noise > one.noise && five.sigma >= 0.95 * one.sigma);
        // What it says of itself is no less than what it is.
        assert!(five.sigma > five.noise);
    }
}
