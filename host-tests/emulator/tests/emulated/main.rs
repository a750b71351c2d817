//! The firmware image, unmodified, on the emulated board.

mod budget;
mod bus;
mod bus_hand;
mod cost;
mod crash;
mod faults;
mod feedback;
mod hand;
mod hand_tips;
mod hold;
mod in_time;
mod integers;
mod kernels;
mod lookup;
mod measured;
mod monitor;
mod press;
mod service;
mod size;
mod solver;
mod stack;
mod stored;
mod supply;
mod transducers;

use emulator::bench::{self, RunOutcome};
use emulator::fingertip_design::{FingertipDesign, FingertipDesignError, default_path};
use emulator::image::Image;
use emulator::plant::Plant;
use emulator::record::{Recorder, Recording, Row};
use emulator::scenario::Scenario;
use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::Path;
use std::sync::{Mutex, OnceLock, PoisonError};

/// The signal path from the averaged counts to both results, by owner and name: the conversion to pressure, and the
/// stages after it.
const SIGNAL_PATH: &[(&str, &str)] = &[("ratiometric", "pressure"), ("Pipeline", "step")];

/// The firmware for the default design.
fn firmware() -> &'static Image {
    firmware_for(&design())
}

/// The firmware for a design, built once for all tests that ask for it.
fn firmware_for(design: &FingertipDesign) -> &'static Image {
    /// By the hash of the design.
    static IMAGES: Mutex<BTreeMap<u64, &Image>> = Mutex::new(BTreeMap::new());
    let mut images = IMAGES.lock().unwrap_or_else(PoisonError::into_inner);
    images.entry(design.hash()).or_insert_with(|| {
        let image = Image::firmware(Some(&design.path)).expect("the firmware builds");
        Box::leak(Box::new(image))
    })
}

/// The text of a shipped design, a part of it replaced.
fn replaced(shipped: &str, from: &str, to: &str) -> String {
    let text = std::fs::read_to_string(host_tests::design(shipped)).expect("it is shipped");
    assert!(text.contains(from), "{shipped} has no {from}");
    text.replace(from, to)
}

/// The design of a text, in a file that no other test writes at the same time.
fn design_of(text: &str) -> Result<FingertipDesign, FingertipDesignError> {
    static WRITING: Mutex<()> = Mutex::new(());
    let _writing = WRITING.lock();
    let mut hasher = DefaultHasher::new();
    text.hash(&mut hasher);
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{:016x}.toml", hasher.finish()));
    if std::fs::read_to_string(&path).ok().as_deref() != Some(text) {
        std::fs::write(&path, text).expect("the folder of tests can be written");
    }
    FingertipDesign::read(&path)
}

/// A shipped design, a part of its text replaced.
fn design_with(shipped: &str, from: &str, to: &str) -> FingertipDesign {
    design_of(&replaced(shipped, from, to)).expect("it is well formed")
}

/// The same for the smaller board: nothing emulates it, but it has a size.
fn small_board() -> &'static Image {
    static IMAGE: OnceLock<Image> = OnceLock::new();
    IMAGE.get_or_init(|| small_board_for(&design()))
}

fn small_board_for(design: &FingertipDesign) -> Image {
    Image::build_for("firmware", Some(&design.path), Some("board-nucleo-l432kc"))
        .expect("the firmware builds")
}

fn design() -> FingertipDesign {
    FingertipDesign::read(&default_path()).expect("the default design is well formed")
}

/// What came of one scenario.
struct Run {
    plant: Plant,
    record: Recording,
    instructions: u64,
    time: f64,
    calls: Vec<u64>,
    resets: Vec<String>,
    stack: Option<u64>,
    gaps: Vec<String>,
}

/// The firmware goes through a shipped scenario.
fn run(scenario: &str) -> Run {
    let scenario = Scenario::named(scenario).expect("it is shipped");
    let duration = scenario.duration();
    let plant = design()
        .plant(scenario)
        .expect("the default design can be pressed");
    let recorder = Recorder::new(|_: &Row| {});
    let outcome: RunOutcome<_> =
        bench::run(firmware(), plant.clone(), duration, SIGNAL_PATH, recorder).expect("the image runs");
    Run {
        plant,
        record: outcome.listener.into_record(),
        instructions: outcome.instructions,
        time: outcome.time,
        calls: outcome.calls,
        resets: outcome.resets,
        stack: outcome.stack,
        gaps: outcome.gaps,
    }
}

/// The default scenario, run once for all tests that look at it.
fn press_hold_release() -> &'static Run {
    static RUN: OnceLock<Run> = OnceLock::new();
    RUN.get_or_init(|| run("press-hold-release"))
}
