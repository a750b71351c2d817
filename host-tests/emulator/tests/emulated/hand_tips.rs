//! Five fingertips of five kinds on one board whose image takes tip files: pressed at once, each against its own truth; one is unplugged, one
//! has garbage in its flash, one is loaded while all are read.
//!
//! The emulated flash is erased in the time that the part takes, and keeps what it holds: what is to be loaded lies there before, so that
//! each chunk is found as it was sent. What a write changes is shown on the host, over simulated flash.

use crate::hand::{NAMES, TIPS, hand_file, phase};
use crate::{SIGNAL_PATH, design_of, replaced};
use embassy_futures::block_on;
use emulator::fingertip_design::FingertipDesign;
use emulator::hand::{EmulatedHand, HandInstant, HandRun};
use emulator::image::Image;
use emulator::plant::Plant;
use emulator::scenario::{Scenario, WireFault};
use emulator::transducer::Wiring;
use fingertip::device::tip_loader::{LARGEST_BLOCK, TipLoader};
use fingertip::image::ImageDesign;
use fingertip::link::command::{Command, CommandKind, Outcome, Request};
use fingertip::link::load::{CHUNK, LoadCommand, LoadKind, LoadOutcome, LoadReply, LoadRequest, Piece};
use fingertip::link::tips::{encode_load, encode_request};
use fingertip::signal::design::Design as _;
use fingertip::signal::loaded_design::LoadedDesign;
use fingertip::status::{Fault, Stored, Touch, Warnings};
use fingertip::storage::tip_slots::{Slot, TipSlots};
use fingertip::units::Microseconds;
use host_tests::nor_flash::SimulatedFlash;
use model_tables::block::read::stated;
use model_tables::generate;
use model_tables::table::law::Touched;
use model_tables::units::PressureRise;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command as Process;
use std::sync::OnceLock;
use std::time::Instant;

/// The sectors 14 to 23 of the part (RM0090 table 6), from this address on, KB.
const BASE: u64 = 0x0810_8000;
const SECTORS: [u32; 10] = [16, 16, 64, 128, 128, 128, 128, 128, 128, 128];
const UNIT: usize = 16 * 1024;

/// From one report to the next, seconds.
const PERIOD: f64 = 1005e-6;

/// The tips: of the image's own tables, of two other walls, of another one with an object, and of garbage in the place of a block.
const OWN: usize = 0;
const THIN: usize = 1;
const WITH_OBJECT: usize = 2;
const UNPLUGGED: usize = 3;
const GARBAGE: usize = 4;

/// While its wire is off, and all are pressed, seconds.
const OFF: std::ops::Range<f64> = 0.8..1.0;
const HELD: std::ops::Range<f64> = 1.05..1.6;
const END: f64 = 1.7;

/// The ball that a tip touches from then on, micrometres, and when it is told.
const BALL: i32 = 8_000;
const TOLD: f64 = 1.4;
/// So long around it a report may be of either: its instant lies before the board's work on it, seconds.
const EITHER: f64 = 5e-3;

/// The slots of the tips, from [`BASE`] on.
fn slots() -> [[Slot; 2]; TIPS] {
    let mut begin = 0;
    let slots = SECTORS.map(|kilobytes| {
        let slot = Slot {
            begin,
            length: 1024 * kilobytes,
        };
        begin += slot.length;
        slot
    });
    slots.as_chunks().0.try_into().expect("two a tip")
}

/// The board's loader, on the host.
fn loader() -> TipLoader<TIPS> {
    TipLoader::new(
        slots().map(TipSlots::of),
        [ImageDesign::CONSTANTS.transducer; TIPS],
    )
}

/// A flash as the board's loader leaves it, with these blocks loaded and activated: each the number of its tip.
pub(crate) fn flash_with(blocks: &[(usize, &[u8])]) -> Vec<u8> {
    let mut flash = <SimulatedFlash<UNIT>>::of_slots(SECTORS.iter().sum::<u32>() as usize / 16, 1);
    for &(tip, block) in blocks {
        let mut loader = loader();
        let mut buffer = vec![0; LARGEST_BLOCK];
        block_on(async {
            for tip in 0..TIPS {
                loader.start(tip, &mut flash, &mut buffer).await;
            }
            for command in load(tip, block).into_iter().chain([activate(block)]) {
                let request = LoadRequest { sequence: 0, command };
                let reply = loader
                    .request(Microseconds(1), &mut flash, (tip as u8, request), &mut buffer)
                    .await;
                let done = matches!(
                    reply,
                    LoadReply::Answer {
                        outcome: LoadOutcome::Done,
                        ..
                    }
                );
                assert!(done, "{command:?}: {reply:?}");
            }
        });
    }
    flash.bytes_mut().to_vec()
}

/// The commands of a load, up to its verification.
fn load(tip: usize, block: &[u8]) -> Vec<LoadCommand> {
    let (length, check) = stated(block).expect("a block");
    let begin = LoadCommand::Begin {
        tip: tip as u8,
        length,
        check,
    };
    let chunks = block
        .chunks(CHUNK)
        .enumerate()
        .map(|(at, bytes)| LoadCommand::Chunk {
            offset: (at * CHUNK) as u32,
            bytes: Piece::of(bytes).expect("not empty"),
        });
    [LoadCommand::Arm, begin]
        .into_iter()
        .chain(chunks)
        .chain([LoadCommand::Verify])
        .collect()
}

fn activate(block: &[u8]) -> LoadCommand {
    let (design, _) = LoadedDesign::read(block).expect("it is one");
    LoadCommand::Activate {
        hash: design.parameters().constants.hash,
    }
}

/// The image of the shipped hand that takes tip files.
pub(crate) fn image() -> &'static Image {
    static IMAGE: OnceLock<Image> = OnceLock::new();
    IMAGE.get_or_init(|| {
        let features = Some("board-nucleo-f429zi,load-tip");
        Image::build_for("firmware", Some(&hand_file()), features).expect("the firmware builds")
    })
}

/// A design, and the block of its tip.
struct Kind {
    design: FingertipDesign,
    block: Vec<u8>,
}

impl Kind {
    fn of(text: &str) -> Self {
        let design = design_of(text).expect("it can be pressed");
        let block = generate::from_design_file(&design.path)
            .expect("it has tables")
            .binary();
        Self { design, block }
    }
}

/// The default design with another wall, and one more line at its end.
fn walled(name: &str, thickness: &str, more: &str) -> String {
    replaced(
        "index-fingertip-elastic",
        "thickness_mm = 1.0",
        &format!("thickness_mm = {thickness}"),
    )
    .replace(
        "name = \"index-fingertip-elastic\"",
        &format!("name = \"{name}\""),
    ) + more
}

/// The kinds of the tips, in their order.
fn kinds() -> &'static [Kind; TIPS] {
    static KINDS: OnceLock<[Kind; TIPS]> = OnceLock::new();
    KINDS.get_or_init(|| {
        let own = fs::read_to_string(host_tests::design("index-fingertip-elastic")).expect("it is shipped");
        [
            Kind::of(&own),
            Kind::of(&walled("thin", "0.9", "")),
            Kind::of(&walled("touching", "0.95", "\n[object]\n")),
            Kind::of(&walled("thinner", "0.8", "")),
            Kind::of(&own),
        ]
    })
}

/// A press to its own depth, percent; its noise is its own.
fn scenario(tip: usize) -> Scenario {
    let mut scenario = Scenario {
        about: format!("tip {tip}"),
        seed: 70 + tip as u64,
        air_kpa: 101.325,
        design: None,
        phase: vec![
            phase("rest", 600.0, None),
            phase("press", 400.0, Some(50.0 + 10.0 * tip as f64)),
            phase("hold", 1e3 * (END - 1.0), None),
        ],
        wire: vec![],
        event: vec![],
        repeats: false,
    };
    if tip == UNPLUGGED {
        scenario.wire = vec![WireFault {
            is: Wiring::Open,
            from_ms: 1e3 * OFF.start,
            until_ms: Some(1e3 * OFF.end),
        }];
    }
    scenario
}

fn plants() -> Vec<Plant> {
    kinds()
        .iter()
        .enumerate()
        .map(|(tip, kind)| kind.design.plant(scenario(tip)).expect("it can be pressed"))
        .collect()
}

/// The image with the tips loaded, one of them broken afterwards, and what lies in the free slots.
fn loaded() -> Image {
    let kinds = kinds();
    let blocks: Vec<(usize, &[u8])> = [THIN, WITH_OBJECT, UNPLUGGED, GARBAGE]
        .into_iter()
        .map(|tip| (tip, kinds[tip].block.as_slice()))
        .collect();
    let mut bytes = flash_with(&blocks);
    let broken = slots()[GARBAGE][0].begin as usize;
    for (at, byte) in bytes[broken..broken + 400].iter_mut().enumerate() {
        *byte = (at as u8).wrapping_mul(0x9D) ^ 0x5A;
    }
    image().clone().with_flash(BASE, bytes)
}

fn run() -> &'static (Vec<Plant>, HandRun) {
    static RUN: OnceLock<(Vec<Plant>, HandRun)> = OnceLock::new();
    RUN.get_or_init(|| {
        let plants = plants();
        let object = Request {
            sequence: 5,
            command: Command::Object(Touched::Ball(BALL)),
        };
        let sent = [WITH_OBJECT, THIN]
            .into_iter()
            .zip([TOLD, TOLD + 0.01])
            .map(|(tip, at)| (at, encode_request(tip as u8, &object).to_vec()))
            .collect();
        let hand = EmulatedHand {
            tips: plants.clone(),
            places: vec![],
            held: None,
            shifted: END..END,
            sent,
        };
        let run = emulator::hand::run(&loaded(), hand, END, SIGNAL_PATH).expect("the image runs");
        (plants, run)
    })
}

fn held(hand: &HandRun) -> impl Iterator<Item = &HandInstant> {
    hand.instants
        .iter()
        .filter(|instant| HELD.contains(&instant.time))
}

#[test]
fn five_kinds_of_tips_pressed_at_once_are_each_right() {
    let (plants, hand) = run();
    assert_eq!(hand.gaps, Vec::<String>::new());
    assert!(hand.broken.is_empty() && hand.lost == 0, "{:?}", hand.broken);
    let mut worst = [0.0_f64; TIPS];
    let before = held(hand).filter(|instant| instant.time < TOLD - EITHER);
    for (count, instant) in before.enumerate() {
        for (tip, plant) in plants.iter().enumerate() {
            let found = instant.reports[tip].outcome;
            let found =
                found.unwrap_or_else(|fault| panic!("tip {tip}, {count}, {}: {fault:?}", instant.time));
            let truth = plant.truth(instant.time);
            assert_eq!(found.touch, Touch::Touched, "tip {tip}");
            worst[tip] = worst[tip].max((found.force.newtons() / truth.force - 1.0).abs());
            let refused = found.warnings.contains(Warnings::CALIBRATION_REFUSED);
            assert_eq!(refused, tip == GARBAGE, "tip {tip}");
        }
    }
    let percent = worst.map(|error| 1e2 * error);
    println!("five kinds, held: force at most {percent:.2?} % off");
    // Noise of 2.5 Pa, the tables' 0.1 %, and the solver's own between two meshes.
    assert!(worst.iter().all(|&error| error < 0.01), "{worst:?}");
    // Their forces differ by more than that: each is its own tables'.
    let forces: Vec<f64> = plants.iter().map(|plant| plant.truth(1.2).force).collect();
    for (tip, force) in forces.iter().enumerate() {
        assert!(
            forces[..tip]
                .iter()
                .all(|other| (other / force - 1.0).abs() > 0.05),
            "{forces:?}"
        );
    }
}

#[test]
fn an_unplugged_tip_and_one_of_garbage_are_their_own() {
    let (_, hand) = run();
    let off = hand
        .instants
        .iter()
        .filter(|instant| instant.time > OFF.start + 3e-3 && instant.time < OFF.end - 3e-3);
    let mut seen = 0;
    for instant in off {
        seen += 1;
        for (tip, report) in instant.reports.iter().enumerate() {
            let open = report.outcome == Err(Fault::SensorOpen);
            assert_eq!(
                open,
                tip == UNPLUGGED,
                "tip {tip} at {}: {report:?}",
                instant.time
            );
        }
    }
    assert!(seen > 80, "{seen}");
    // Each greets with the design in use.
    let greetings = &hand.greetings[hand.greetings.len() - TIPS..];
    for (tip, greeting) in greetings.iter().enumerate() {
        let own = ImageDesign::CONSTANTS.hash;
        let expected = if [OWN, GARBAGE].contains(&tip) {
            own
        } else {
            kinds()[tip].design.hash()
        };
        assert_eq!(
            (greeting.name.as_str(), greeting.design_hash),
            (NAMES[tip], expected)
        );
        assert_eq!(
            greeting.stored,
            if tip == GARBAGE {
                Stored::Damaged
            } else {
                Stored::None
            }
        );
    }
}

#[test]
fn one_tip_of_a_hand_is_told_what_it_touches() {
    let (_, hand) = run();
    let answers: Vec<(u8, CommandKind, Outcome)> = hand
        .answers
        .iter()
        .map(|(tip, answer)| (*tip, answer.command, answer.outcome))
        .collect();
    assert_eq!(
        answers,
        [
            (WITH_OBJECT as u8, CommandKind::Object, Outcome::Done),
            (THIN as u8, CommandKind::Object, Outcome::NoSuchObject),
        ]
    );
    let (plate, _) = LoadedDesign::read(&kinds()[WITH_OBJECT].block).expect("a tip");
    let mut ball = plate;
    ball.touch(Touched::Ball(BALL)).expect("it has tables of that");
    let shift = |instant: &HandInstant| {
        plate.parameters().pressure_fraction_bits - u32::from(instant.pressure_fraction_bits)
    };
    let [mut before, mut after] = [0; 2];
    for instant in held(hand) {
        let found = instant.reports[WITH_OBJECT].outcome.expect("a reading");
        // A frame has the pressure in the largest unit of the tips.
        let rise = |add: i32| PressureRise((found.pressure_rise.0 << shift(instant)) + add);
        let within = |design: &LoadedDesign<'_>| {
            let [low, high] = [0, (1 << shift(instant)) - 1].map(|add| design.lookup(rise(add)).force.0);
            (low..=high).contains(&found.force.0)
        };
        if instant.time < TOLD - EITHER {
            before += 1;
            assert!(within(&plate) && !within(&ball), "{found:?}");
        } else if instant.time > TOLD + EITHER {
            after += 1;
            assert!(within(&ball) && !within(&plate), "{found:?}");
        }
    }
    assert!(before > 100 && after > 60, "{before}, {after}");
}

/// The tip that is loaded meanwhile, and what is sent when: the erasure of a sector of 128 KB takes a second or two.
const NEW: usize = 3;
const ARMED: f64 = 0.45;
const CHUNKS: f64 = 2.75;
const STEP: f64 = 6e-3;

#[test]
fn one_tip_is_loaded_while_five_are_read_and_no_report_is_missed() {
    let block = &kinds()[NEW].block;
    // It lies in the slot that the load goes to.
    let mut bytes = vec![0xFF; 1024 * SECTORS.iter().sum::<u32>() as usize];
    let place = slots()[NEW][0].begin as usize;
    bytes[place..place + block.len()].copy_from_slice(block);
    let image = image().clone().with_flash(BASE, bytes);
    let commands: Vec<LoadCommand> = load(NEW, block).into_iter().chain([activate(block)]).collect();
    let sent = commands
        .iter()
        .enumerate()
        .map(|(number, &command)| {
            let time = match number {
                0 | 1 => ARMED + STEP * number as f64,
                number => CHUNKS + STEP * number as f64,
            };
            let request = LoadRequest {
                sequence: number as u16,
                command,
            };
            (time, encode_load(NEW as u8, &request).to_vec())
        })
        .collect();
    let end = CHUNKS + STEP * commands.len() as f64 + 0.1;
    let one = kinds()[OWN]
        .design
        .plant(scenario(OWN))
        .expect("it can be pressed");
    let hand = EmulatedHand {
        tips: (0..TIPS)
            .map(|tip| {
                let mut rest = scenario(tip);
                rest.wire.clear();
                rest.phase = vec![phase("rest", 1e3 * end, None)];
                one.through(rest)
            })
            .collect(),
        places: vec![],
        held: None,
        shifted: end..end,
        sent,
    };
    let hand = emulator::hand::run(&image, hand, end, SIGNAL_PATH).expect("the image runs");
    assert_eq!(hand.gaps, Vec::<String>::new());
    let answers: Vec<(u8, LoadKind, LoadOutcome)> = hand
        .loads
        .iter()
        .map(|(tip, reply)| match reply {
            LoadReply::Answer { kind, outcome, .. } => (*tip, *kind, *outcome),
            LoadReply::Data { .. } => panic!("{reply:?}"),
        })
        .collect();
    let expected: Vec<(u8, LoadKind, LoadOutcome)> = commands
        .iter()
        .map(|command| {
            // The emulated flash takes no writes: what was not there before is not there now.
            let outcome = match command {
                LoadCommand::Activate { .. } => LoadOutcome::MemoryFailed,
                _ => LoadOutcome::Done,
            };
            (NEW as u8, command.kind(), outcome)
        })
        .collect();
    assert_eq!(answers, expected);
    let instants: Vec<&HandInstant> = hand
        .instants
        .iter()
        .filter(|instant| instant.time > ARMED)
        .collect();
    for pair in instants.windows(2) {
        let periods = (pair[1].time - pair[0].time) / PERIOD;
        assert!(
            (periods - 2.0).abs() < 0.02,
            "{periods} periods at {}",
            pair[0].time
        );
    }
    assert!(
        instants
            .iter()
            .all(|instant| instant.reports.iter().all(|report| report.outcome.is_ok()))
    );
    let (board, _) = hand.boards.last().expect("a greeting");
    assert_eq!((board.samples_lost, hand.lost), (0, 0));
    println!(
        "one of five tips loaded, {} bytes: {} frames, none missing, no sample lost",
        block.len(),
        instants.len()
    );
}

/// Instructions of a report, of a run of a second.
fn report(image: &Image) -> f64 {
    let one = kinds()[OWN]
        .design
        .plant(scenario(OWN))
        .expect("it can be pressed");
    let hand = EmulatedHand {
        tips: (0..TIPS)
            .map(|tip| {
                let mut quiet = scenario(tip);
                quiet.wire.clear();
                one.through(quiet)
            })
            .collect(),
        places: vec![],
        held: None,
        shifted: END..END,
        sent: vec![],
    };
    let run = emulator::hand::run(image, hand, 1.2, SIGNAL_PATH).expect("the image runs");
    assert_eq!((run.gaps.len(), run.lost), (0, 0));
    run.calls.iter().sum::<u64>() as f64 / run.calls.len() as f64
}

/// Most bytes of flash and RAM, the stack left out.
const FLASH: u64 = 112 * 1024;
const RAM: u64 = 64 * 1024;

#[test]
fn loaded_tables_cost_a_few_instructions_and_the_feature_some_flash() {
    let block = &kinds()[OWN].block;
    let all: Vec<(usize, &[u8])> = (0..TIPS).map(|tip| (tip, block.as_slice())).collect();
    let own = report(image());
    let loaded = report(&image().clone().with_flash(BASE, flash_with(&all)));
    let size = image().size().expect("it is an image");
    println!(
        "a report of a hand with load-tip: {own:.0} instructions of the image's tables, {loaded:.0} of loaded ones; flash {} bytes, \
         RAM {} bytes",
        size.flash, size.ram
    );
    assert!(size.flash <= FLASH && size.ram <= RAM, "{size:?}");
}

/// The hand with a design of `[object]` in its image, where nothing is loaded.
#[test]
fn an_image_of_a_hand_has_the_objects_of_its_designs() {
    let kind = &kinds()[WITH_OBJECT];
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let file = folder.join("object-hand.toml");
    let text = format!(
        "name = \"object\"\n[[tip]]\nname = \"thumb\"\ndesign = {:?}\nchannel = 0\n[[tip]]\nname = \"index\"\ndesign = {:?}\nchannel = 1\n",
        host_tests::design("index-fingertip-elastic"),
        kind.design.path,
    );
    fs::write(&file, text).expect("the test folder");
    let image = Image::firmware(Some(&file)).expect("the firmware builds");
    let press = |plant: &Kind, tip| plant.design.plant(scenario(tip)).expect("it can be pressed");
    let request = |sequence, command| Request { sequence, command };
    let ball = request(5, Command::Object(Touched::Ball(BALL)));
    let hand = EmulatedHand {
        tips: vec![press(&kinds()[OWN], 0), press(kind, 1)],
        places: vec![],
        held: None,
        shifted: END..END,
        sent: vec![
            (TOLD, encode_request(1, &ball).to_vec()),
            (TOLD + 0.01, encode_request(0, &ball).to_vec()),
            (
                TOLD + 0.02,
                encode_request(1, &request(6, Command::Indentation { known: 1_500_000 })).to_vec(),
            ),
        ],
    };
    let hand = emulator::hand::run(&image, hand, END, &[]).expect("the image runs");
    assert_eq!(hand.gaps, Vec::<String>::new());
    let answers: Vec<(u8, Outcome, bool)> = hand
        .answers
        .iter()
        .map(|(tip, answer)| (*tip, answer.outcome, answer.known.is_some()))
        .collect();
    assert_eq!(
        answers,
        [
            (1, Outcome::Done, false),
            (0, Outcome::NoSuchObject, false),
            (1, Outcome::Done, true)
        ]
    );
    let (plate, _) = LoadedDesign::read(&kind.block).expect("a tip");
    let mut ball = plate;
    ball.touch(Touched::Ball(BALL)).expect("it has tables of that");
    let mut seen = 0;
    for instant in held(&hand).filter(|instant| (instant.time - TOLD).abs() > EITHER) {
        seen += 1;
        let design = if instant.time < TOLD - EITHER {
            &plate
        } else {
            &ball
        };
        let found = instant.reports[1].outcome.expect("a reading");
        let shift = plate.parameters().pressure_fraction_bits - u32::from(instant.pressure_fraction_bits);
        let [low, high] = [0, (1 << shift) - 1].map(|add| {
            design
                .lookup(PressureRise((found.pressure_rise.0 << shift) + add))
                .force
                .0
        });
        assert!((low..=high).contains(&found.force.0), "{found:?}");
    }
    assert!(seen > 150, "{seen}");
}

/// A file that the guide shows.
fn shown(guide: &str, name: &str) -> String {
    let begin = guide.find(&format!(" {name}\n")).expect("the guide shows it") + name.len() + 2;
    let length = guide[begin..].find("```").expect("it ends");
    // It stands in a list.
    guide[begin..begin + length]
        .lines()
        .map(|line| line.strip_prefix("   ").unwrap_or(line).to_owned() + "\n")
        .collect()
}

/// The design tool, which `cargo test` builds beside the tests.
fn designer(folder: &Path, arguments: &[&str]) -> String {
    let tests = std::env::current_exe().expect("this test runs");
    let program = tests
        .ancestors()
        .nth(2)
        .expect("a profile's folder")
        .join("designer");
    assert!(
        program.is_file(),
        "there is no designer: cargo build --package designer"
    );
    let begun = Instant::now();
    let output = Process::new(program)
        .args(arguments)
        .current_dir(folder)
        .output()
        .expect("it runs");
    assert!(
        output.status.success(),
        "{arguments:?}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    println!(
        "{:.1} s: designer {}",
        begun.elapsed().as_secs_f64(),
        arguments.join(" ")
    );
    String::from_utf8(output.stdout).expect("it is text")
}

/// From the bench's file of the guide to readings of the emulated hand: two commands, and no compiler. The fingertip of the bench is 1.2 times
/// as stiff as its design.
#[test]
fn a_bench_file_becomes_a_calibrated_tip_of_the_hand() {
    const CALIBRATED: usize = 1;
    let guide = host_tests::workspace().join("host-tests/guides/calibrate-a-hand.md");
    let guide = fs::read_to_string(guide).expect("it is there");
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("bench-to-hand");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("the test folder");
    let design = shown(&guide, "tip.toml");
    fs::write(folder.join("tip.toml"), &design).expect("the test folder");
    fs::write(folder.join("bench.csv"), shown(&guide, "bench.csv")).expect("the test folder");
    designer(
        &folder,
        &[
            "fit",
            "tip.toml",
            "bench.csv",
            "--fit",
            "material",
            "--out",
            "calibrated",
        ],
    );
    let calibration = "calibrated/left-index-calibrated.toml";
    designer(
        &folder,
        &[
            "tip",
            "tip.toml",
            "--calibration",
            calibration,
            "--out",
            "left-index.bin",
        ],
    );
    let block = fs::read(folder.join("left-index.bin")).expect("it was written");
    let image = image()
        .clone()
        .with_flash(BASE, flash_with(&[(CALIBRATED, &block)]));
    let truth = design_of(&format!("{design}\n[calibration]\nmaterial_factor = 1.2\n")).expect("a design");
    let own = kinds()[OWN]
        .design
        .plant(scenario(OWN))
        .expect("it can be pressed");
    let plants: Vec<Plant> = (0..TIPS)
        .map(|tip| {
            let mut quiet = scenario(tip);
            quiet.wire.clear();
            if tip == CALIBRATED {
                truth.plant(quiet).expect("it can be pressed")
            } else {
                own.through(quiet)
            }
        })
        .collect();
    let hand = EmulatedHand {
        tips: plants.clone(),
        places: vec![],
        held: None,
        shifted: END..END,
        sent: vec![],
    };
    let hand = emulator::hand::run(&image, hand, END, &[]).expect("the image runs");
    assert_eq!((hand.gaps.len(), hand.lost), (0, 0));
    let mut worst = [0.0_f64; TIPS];
    for instant in held(&hand) {
        for (tip, plant) in plants.iter().enumerate() {
            let found = instant.reports[tip].outcome.expect("a reading");
            let force = plant.truth(instant.time).force;
            worst[tip] = worst[tip].max((found.force.newtons() / force - 1.0).abs());
        }
    }
    let percent = worst.map(|error| 1e2 * error);
    println!("the calibrated tip and its neighbours, held: force at most {percent:.2?} % off");
    // The bench's noise is half a percent; the model's own stiffness was 20 % off.
    assert!(worst[CALIBRATED] < 0.02, "{worst:?}");
    assert!(worst.iter().all(|&error| error < 0.02), "{worst:?}");
}
