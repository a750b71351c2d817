//! Five fingertips on one bus, three kinds of part: two that have one address behind a multiplexer, one of another kind on its own branch,
//! two variants of an address. One part dies, one chatters, one holds its branch; the others are read on.

use crate::design_with;
use emulator::hand::{BusPlace, EmulatedHand, HandInstant, HandRun};
use emulator::image::{Image, Size};
use emulator::plant::Plant;
use emulator::scenario::{Phase, Scenario, WireFault};
use emulator::transducer::Wiring;
use fingertip::link::command::{Command, CommandKind, Outcome, Request};
use fingertip::link::tips::encode_request;
use fingertip::status::{Fault, Touch};
use model_tables::constants::hand_bus::FAILURE;
use model_tables::design_file::hand::HandFile;
use model_tables::design_file::hand::bus::{BusRound, SET_UP};
use std::fmt::Write as _;
use std::fs;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::OnceLock;

const TIPS: usize = 5;
const NAMES: [&str; TIPS] = ["thumb", "index", "middle", "ring", "little"];
const KINDS: [&str; TIPS] = ["ms5837-02ba", "ms5837-02ba", "dps310", "abp2", "abp2"];
const PLACES: [BusPlace; TIPS] = [
    place(0x76, Some([0x70, 0])),
    place(0x76, Some([0x70, 1])),
    place(0x77, Some([0x70, 2])),
    place(0x28, None),
    place(0x18, None),
];
/// When the press of a tip begins, seconds, and how deep it goes, percent; `None`: nothing touches it.
const PRESSES: [Option<(f64, f64)>; TIPS] = [
    Some((1.05, 60.0)),
    None,
    None,
    Some((1.2, 75.0)),
    Some((1.35, 40.0)),
];
const DYING: usize = 1;
const CHATTERING: usize = 2;

/// All absolute parts have their zero, seconds.
const TARED: f64 = 1.0;
/// How long a press takes to its end, and after how long it is released as fast, seconds: between them it is held.
const MOVING: f64 = 0.3;
const RELEASED_AFTER: f64 = 3.0;
/// When every press is held, seconds.
const HOLDING: Range<f64> = 1.8..4.0;
/// How far a report of three samples may be from the middle one, pascals: a quarter of the bend that noise makes.
const BEND: f64 = 2.0;
/// From the end of a conversion to the reading of the part, where the emulated one measures, seconds.
const READING: f64 = 1e-3;
const DEAD: Range<f64> = 1.8..2.4;
const CHATTER: Range<f64> = 2.6..3.2;
/// The part that died before holds the data line of its branch.
const HELD: Range<f64> = 3.4..4.0;
const END: f64 = 5.0;
/// Most bytes of flash and RAM, the stack left out.
const LARGEST: Size = Size {
    flash: 80 * 1024,
    ram: 24 * 1024,
};
/// Most instructions in a millisecond: a sixteenth of the core's 128 000 cycles if each took one.
const PER_MILLISECOND: f64 = 8_000.0;
/// Most instructions for each transaction on the bus, everything else that is done counted to them: what the length of a round is worked
/// out from.
const PER_TRANSACTION: f64 = 3_500.0;

const fn place(address: u8, branch: Option<[u8; 2]>) -> BusPlace {
    BusPlace { address, branch }
}

fn phase(name: &str, until: f64, to_percent: Option<f64>, from: f64) -> Phase {
    Phase {
        name: name.to_owned(),
        duration_ms: 1e3 * (until - from),
        to_percent,
        to_force_n: None,
        radius_mm: None,
    }
}

/// When the plate of a press that begins then starts and stops, seconds.
fn corners(begins: f64) -> [f64; 4] {
    let released = begins + RELEASED_AFTER;
    [begins, begins + MOVING, released, released + MOVING]
}

fn scenario(tip: usize) -> Scenario {
    let fault = |is, when: &Range<f64>| WireFault {
        is,
        from_ms: 1e3 * when.start,
        until_ms: Some(1e3 * when.end),
    };
    Scenario {
        about: format!("tip {tip}"),
        seed: 70 + tip as u64,
        air_kpa: 101.325,
        design: None,
        phase: match PRESSES[tip] {
            Some((begins, percent)) => {
                let [_, held, released, ended] = corners(begins);
                vec![
                    phase("rest", begins, None, 0.0),
                    phase("press", held, Some(percent), begins),
                    phase("hold", released, None, held),
                    phase("release", ended, Some(0.0), released),
                    phase("rest", END, None, ended),
                ]
            }
            None => vec![phase("rest", END, None, 0.0)],
        },
        wire: match tip {
            DYING => vec![fault(Wiring::Off, &DEAD)],
            CHATTERING => vec![fault(Wiring::Garbage, &CHATTER)],
            _ => vec![],
        },
        event: vec![],
        repeats: false,
    }
}

/// The hand's file, beside the designs of its kinds.
fn hand_file() -> PathBuf {
    let mut text = "name = \"on-a-bus\"\n".to_owned();
    for ((name, kind), place) in NAMES.iter().zip(KINDS).zip(&PLACES) {
        let design = design_of_kind(kind).path;
        let design = design.to_str().expect("a path of this test");
        let _ = writeln!(
            text,
            "[[tip]]\nname = {name:?}\ndesign = {design:?}\nbus = 1\naddress = {}",
            place.address
        );
        if let Some(branch) = place.branch {
            let _ = writeln!(text, "multiplexer = {branch:?}");
        }
    }
    let file = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("bus-hand.toml");
    if fs::read_to_string(&file).ok().as_deref() != Some(&text) {
        fs::write(&file, text).expect("the test folder");
    }
    file
}

fn design_of_kind(kind: &str) -> emulator::fingertip_design::FingertipDesign {
    design_with(
        "skin-light-touch",
        "kind = \"dps310\"",
        &format!("kind = \"{kind}\""),
    )
}

fn round() -> &'static BusRound {
    static ROUND: OnceLock<BusRound> = OnceLock::new();
    ROUND.get_or_init(|| {
        let file = HandFile::read(&hand_file()).expect("a hand");
        let designs = file.designs().expect("its designs");
        let round = BusRound::of(&file, &designs, SET_UP).expect("it fits the bus");
        round.expect("it is on the bus")
    })
}

/// From one report to the next, seconds.
fn period() -> f64 {
    f64::from(round().period) * 1e-6
}

fn image() -> &'static Image {
    static IMAGE: OnceLock<Image> = OnceLock::new();
    IMAGE.get_or_init(|| Image::firmware(Some(&hand_file())).expect("the firmware builds"))
}

struct Run {
    plants: Vec<Plant>,
    hand: HandRun,
}

fn run() -> &'static Run {
    static RUN: OnceLock<Run> = OnceLock::new();
    RUN.get_or_init(|| {
        let plants: Vec<Plant> = KINDS
            .iter()
            .enumerate()
            .map(|(tip, kind)| {
                let plant = design_of_kind(kind).plant(scenario(tip));
                plant.expect("it can be pressed")
            })
            .collect();
        let tare = Request {
            sequence: 3,
            command: Command::Tare,
        };
        let hand = EmulatedHand {
            tips: plants.clone(),
            places: PLACES.to_vec(),
            held: Some((DYING, HELD)),
            shifted: END..END,
            sent: vec![(0.5, encode_request(0xFF, &tare).to_vec())],
        };
        let hand = emulator::hand::run(image(), hand, END, &[]).expect("the image runs");
        Run { plants, hand }
    })
}

/// Whether the part of a tip is as it should be at a time, and has been long enough to be read again: its pause, its start, and the
/// filter's samples.
fn is_sound(tip: usize, time: f64) -> bool {
    let back = 22.0 * period() + 0.05;
    let troubled = |when: &Range<f64>| (when.start - 2.0 * period()..when.end + back).contains(&time);
    match tip {
        DYING => !troubled(&DEAD) && !troubled(&HELD),
        CHATTERING => !troubled(&CHATTER),
        _ => true,
    }
}

/// Whether the plate starts or stops within two samples of a time.
fn is_corner(tip: usize, time: f64) -> bool {
    PRESSES[tip].is_some_and(|(begins, _)| {
        corners(begins)
            .iter()
            .any(|corner| (corner - time).abs() < 2.0 * period())
    })
}

fn tared() -> impl Iterator<Item = &'static HandInstant> {
    let instants = run().hand.instants.iter();
    instants.filter(|instant| instant.time > TARED)
}

#[test]
fn every_instant_has_a_report_of_each_tip_at_the_hands_period() {
    let hand = &run().hand;
    assert_eq!(hand.gaps, Vec::<String>::new());
    assert_eq!((hand.broken.len(), hand.lost, hand.of_version_2), (0, 0, 0));
    assert_eq!(hand.clashes, 0, "two parts answered at once");
    let (board, tips) = hand.boards.first().expect("a greeting");
    assert_eq!((usize::from(*tips), board.report_period), (TIPS, round().period));
    let times: Vec<f64> = tared().map(|instant| instant.time).collect();
    assert!(
        times.len() as f64 > 0.98 * (END - TARED) / period(),
        "{}",
        times.len()
    );
    let most = times
        .windows(2)
        .map(|pair| ((pair[1] - pair[0]) / period() - 1.0).abs())
        .fold(0.0, f64::max);
    println!(
        "{} us from report to report, within {:.2} %: whatever its parts do",
        round().period,
        1e2 * most
    );
    assert!(most < 0.01, "{most}");
}

#[test]
fn the_other_tips_are_right_whatever_a_part_does() {
    let run = run();
    let (mut readings, mut largest) = ([0; TIPS], 0.0_f64);
    for instant in tared() {
        let bits = u32::from(instant.pressure_fraction_bits);
        for (tip, plant) in run.plants.iter().enumerate() {
            if !is_sound(tip, instant.time) {
                continue;
            }
            let found = match instant.reports[tip].outcome {
                Ok(found) => found,
                // Two samples tell too little of a sharp corner.
                Err(Fault::Jump) if is_corner(tip, instant.time) => continue,
                Err(fault) => panic!("{} at {:.3}: {fault}", NAMES[tip], instant.time),
            };
            readings[tip] += 1;
            // The middle of its conversion is the instant of the round, within the skew; the emulated part measures when it is read.
            let round = round();
            let reach = f64::from(round.skew + round.halves[tip]) * 1e-6 + READING;
            let around = (0..=20).map(|i| instant.time + reach * (f64::from(i) / 10.0 - 1.0));
            let [low, high] = around
                .map(|time| plant.truth(time).pressure_rise)
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], rise| {
                    [low.min(rise), high.max(rise)]
                });
            let allowed = BEND + 6.3 * found.sigma.pressure_rise.pascals(bits);
            let rise = found.pressure_rise.pascals(bits);
            assert!(
                (low - allowed..=high + allowed).contains(&rise),
                "{} at {:.3}: {rise} Pa for {low} to {high}, allowed {allowed}",
                NAMES[tip],
                instant.time
            );
            if PRESSES[tip].is_none() {
                assert_ne!(
                    found.touch,
                    Touch::Touched,
                    "{} at {:.3}",
                    NAMES[tip],
                    instant.time
                );
            } else if HOLDING.contains(&instant.time) {
                assert_eq!(found.touch, Touch::Touched);
                let (force, truth) = (found.force.newtons(), plant.truth(instant.time).force);
                let off = (force / truth - 1.0).abs();
                largest = off.max(largest);
                assert!(off < 0.01, "{}: {force} N for {truth}", NAMES[tip]);
            }
        }
    }
    println!("force of a held press: within {:.2} %", 1e2 * largest);
    println!("readings of each tip: {readings:?}");
    let all = (END - TARED) / period();
    for tip in [0, 3, 4] {
        assert!(f64::from(readings[tip]) > 0.98 * all, "{readings:?}");
    }
    for tip in [DYING, CHATTERING] {
        assert!(f64::from(readings[tip]) > 0.3 * all, "{readings:?}");
    }
}

#[test]
fn a_part_that_fails_has_its_reason_and_never_a_number() {
    let mut seen = [0; 3];
    for instant in tared() {
        let within = |when: &Range<f64>| {
            (when.start + 2.0 * period() + 0.01..when.end - period()).contains(&instant.time)
        };
        let of = |tip: usize| instant.reports[tip].outcome.err();
        if within(&DEAD) {
            seen[0] += 1;
            assert_eq!(of(DYING), Some(Fault::SensorAbsent), "{:.3}", instant.time);
        }
        if within(&CHATTER) {
            seen[1] += 1;
            assert!(of(CHATTERING).is_some(), "{:.3}", instant.time);
        }
        if within(&HELD) {
            seen[2] += 1;
            assert_eq!(of(DYING), Some(Fault::BusFault), "{:.3}", instant.time);
        }
    }
    assert!(seen.iter().all(|&seen| seen > 10), "{seen:?}");
}

#[test]
fn each_tip_is_tared_by_itself() {
    let answers: Vec<(u8, CommandKind, Outcome)> = run()
        .hand
        .answers
        .iter()
        .map(|(tip, answer)| (*tip, answer.command, answer.outcome))
        .collect();
    let mut tips: Vec<u8> = answers.iter().map(|(tip, ..)| *tip).collect();
    tips.sort_unstable();
    assert_eq!(tips, [0, 1, 2, 3, 4]);
    assert!(
        answers
            .iter()
            .all(|answer| (answer.1, answer.2) == (CommandKind::Tare, Outcome::Done)),
        "{answers:?}"
    );
}

/// How late the commands of the two ABP2 are, against the earliest of each, in a stretch of time: microseconds.
fn lateness(when: &Range<f64>) -> f64 {
    let commands = &run().hand.commands;
    let phase = |time: f64| time.rem_euclid(period());
    let mut most = 0.0_f64;
    for tip in [3, 4] {
        let of_the_tip = || {
            commands
                .iter()
                .filter(|command| command.tip == tip && command.time > TARED)
        };
        let first = of_the_tip()
            .map(|command| phase(command.time))
            .fold(f64::MAX, f64::min);
        let late = of_the_tip()
            .filter(|command| when.contains(&command.time))
            .map(|command| phase(command.time) - first)
            .fold(0.0, f64::max);
        most = most.max(late);
    }
    1e6 * most
}

#[test]
fn a_dead_part_delays_no_other_by_more_than_is_stated() {
    let quiet = lateness(&(TARED..DEAD.start));
    println!("commands are at most {quiet:.0} us late while all is well");
    for (when, label) in [
        (DEAD, "a dead part"),
        (CHATTER, "a part that chatters"),
        (HELD, "a branch that is held"),
    ] {
        let late = lateness(&when);
        println!("{label}: commands of the others at most {late:.0} us late");
        assert!(late - quiet <= f64::from(FAILURE), "{label}: {late} us");
    }
}

#[test]
fn a_hand_on_the_bus_costs_little_and_is_small_on_every_board() {
    let hand = &run().hand;
    let per_millisecond = hand.instructions as f64 / (hand.time * 1e3);
    println!("five tips on a bus: {per_millisecond:.0} instructions a millisecond");
    let per_transaction = hand.instructions as f64 / hand.transactions as f64;
    println!(
        "{per_transaction:.0} instructions for each of {} transactions",
        hand.transactions
    );
    assert!(per_millisecond <= PER_MILLISECOND, "{per_millisecond}");
    assert!(per_transaction <= PER_TRANSACTION, "{per_transaction}");
    for board in [None, Some("board-nucleo-l432kc")] {
        let size = match board {
            None => image().size(),
            Some(_) => Image::build_for("firmware", Some(&hand_file()), board)
                .expect("the firmware builds")
                .size(),
        }
        .expect("it is an image");
        let name = board.unwrap_or("board-nucleo-f429zi");
        println!("{name}: flash {} bytes, RAM {} bytes", size.flash, size.ram);
        assert!(size.flash <= LARGEST.flash && size.ram <= LARGEST.ram, "{size:?}");
    }
}
