//! The firmware image, unmodified, on the emulated board.

mod budget;
mod bus;
mod cost;
mod crash;
mod faults;
mod hold;
mod integers;
mod kernels;
mod lookup;
mod measured;
mod monitor;
mod press;
mod readme;
mod service;
mod solver;
mod stored;
mod supply;

use emulator::bench::{self, Outcome};
use emulator::fingertip_design::{FingertipDesign, default_path};
use emulator::image::Image;
use emulator::plant::Plant;
use emulator::record::{Record, Recorder, Row};
use emulator::scenario::Scenario;
use std::sync::OnceLock;

/// The signal path from the averaged counts to both results, by owner and name: the conversion to pressure, and the
/// stages after it.
const SIGNAL_PATH: &[(&str, &str)] = &[("ratiometric", "pressure"), ("Pipeline", "step")];

/// The firmware for the default design, built once.
fn firmware() -> &'static Image {
    static IMAGE: OnceLock<Image> = OnceLock::new();
    IMAGE.get_or_init(|| Image::firmware(Some(&design().path)).expect("the firmware builds"))
}

/// The same for the smaller board: nothing emulates it, but it has a size.
fn small_board() -> &'static Image {
    static IMAGE: OnceLock<Image> = OnceLock::new();
    IMAGE.get_or_init(|| {
        let design = design().path;
        Image::build_for("firmware", Some(&design), Some("board-nucleo-l432kc")).expect("the firmware builds")
    })
}

fn design() -> FingertipDesign {
    FingertipDesign::read(&default_path()).expect("the default design is well formed")
}

/// What came of one scenario.
struct Run {
    plant: Plant,
    record: Record,
    instructions: u64,
    time: f64,
    calls: Vec<u64>,
    resets: Vec<String>,
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
    let outcome: Outcome<_> =
        bench::run(firmware(), plant.clone(), duration, SIGNAL_PATH, recorder).expect("the image runs");
    Run {
        plant,
        record: outcome.listener.into_record(),
        instructions: outcome.instructions,
        time: outcome.time,
        calls: outcome.calls,
        resets: outcome.resets,
        gaps: outcome.gaps,
    }
}

/// The default scenario, run once for all tests that look at it.
fn press_hold_release() -> &'static Run {
    static RUN: OnceLock<Run> = OnceLock::new();
    RUN.get_or_init(|| run("press-hold-release"))
}
