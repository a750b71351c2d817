//! What a report costs, measured on the emulated chip.

use crate::{SIGNAL_PATH, firmware, firmware_for, press_hold_release, small_board, small_board_for};
use emulator::bench::{self, RunOutcome};
use emulator::fingertip_design::FingertipDesign;
use emulator::image::Image;
use emulator::record::{Recorder, Row};
use emulator::scenario::Scenario;
use host_tests::{assert_measured_figure, design};

/// Most instructions from the averaged counts to both results. Was 500 while the zero was a value without a bound: the bound is in
/// every sigma now.
const INSTRUCTIONS_PER_REPORT: u64 = 520;
/// The same of a wall that relaxes in seven terms: ten products of 64 by 32 bits a term, a division, and a lookup between two counts.
/// The weight of the remembered stress is one division more; a step of Newton's method keeps it stable.
const RELAXING_INSTRUCTIONS: u64 = 2_300;
/// Most instructions in a millisecond, everything counted, a measured supply too: 2.7 % of the core's 128 000 cycles if each took one. Was
/// 3 360 before hum was looked for.
pub(crate) const INSTRUCTIONS_PER_MILLISECOND: f64 = 3_480.0;
/// From the instant of a report to when it is ready, seconds: its block, and a millisecond.
const LATENCY: f64 = 2e-3;
/// A hello of 65 bytes and a report of 46 on the line, ten bits each at 921 600 baud, seconds.
const LINE: f64 = 111.0 * 10.0 / 921_600.0;
/// Most bytes of flash and of RAM, the stack left out, on either board.
const FLASH: u64 = 48 * 1024;
const RAM: u64 = 8 * 1024;

#[test]
fn a_report_costs_few_instructions() {
    let run = press_hold_release();
    // Each report is one call; the last ones may be on their way when the run ends.
    let under_way = run.calls.len() - run.record.rows.len();
    assert!(under_way <= 2, "{under_way} calls without a report");
    let mut readings: Vec<u64> = run
        .record
        .rows
        .iter()
        .zip(&run.calls)
        .filter_map(|(row, &instructions)| row.reported.map(|_| instructions))
        .collect();
    readings.sort_unstable();
    let (least, median, most) = (
        readings[0],
        readings[readings.len() / 2],
        readings[readings.len() - 1],
    );
    println!("instructions from averaged counts to both results: median {median}, {least} to {most}");
    assert_measured_figure(
        "instructions from averaged counts to both results",
        median as f64,
        0.01,
    );
    // The most may include an interrupt.
    assert!(median <= INSTRUCTIONS_PER_REPORT && most <= 4 * INSTRUCTIONS_PER_REPORT);
}

#[test]
fn the_core_sleeps_most_of_the_time() {
    let run = press_hold_release();
    let per_millisecond = run.instructions as f64 / (run.time * 1e3);
    println!("instructions per millisecond, all included: {per_millisecond:.0}");
    assert_measured_figure("instructions a millisecond, everything", per_millisecond, 0.01);
    assert!(
        per_millisecond <= INSTRUCTIONS_PER_MILLISECOND,
        "{per_millisecond}"
    );
}

#[test]
fn a_report_is_out_two_milliseconds_after_its_instant() {
    let run = press_hold_release();
    let latest = run.record.latencies.iter().copied().fold(0.0, f64::max);
    println!(
        "from the instant of a report to the end of its last byte: at most {:.3} ms",
        latest * 1e3
    );
    assert_measured_figure(
        "from the instant of a report to its last byte on the line, at most, ms",
        latest * 1e3,
        0.01,
    );
    assert!(latest <= LATENCY + LINE, "{latest} s");
}

#[test]
fn the_image_is_small_on_every_board() {
    for (board, image) in [("NUCLEO-F429ZI", firmware()), ("NUCLEO-L432KC", small_board())] {
        let size = image.size().expect("it is an image");
        println!("{board}: flash {} bytes, RAM {} bytes", size.flash, size.ram);
        assert!(size.flash <= FLASH && size.ram <= RAM, "{board}: {size:?}");
    }
}

fn relaxing() -> FingertipDesign {
    FingertipDesign::read(&design("index-fingertip")).expect("it is shipped")
}

/// Asserts that from a sample to a frame nothing can panic: a panic names its source file in flash. Transducers, storage and tasks are
/// asynchronous functions, each with the compiler's own panic for a use after its end.
fn assert_no_panic(image: &Image) {
    let holds = |text| image.holds(text).expect("it is an image");
    for place in [
        "src/signal/",
        "src/link/",
        "src/units",
        "src/status",
        "model-tables/",
    ] {
        assert!(!holds(place), "{place} can panic");
    }
    assert!(holds("src/storage/"), "no panic names its source file");
}

#[test]
fn the_image_of_a_wall_that_relaxes_is_small_on_every_board() {
    let relaxing = relaxing();
    let boards = [
        (
            "flash of index-fingertip without folders, bytes",
            firmware_for(&relaxing),
        ),
        (
            "flash of index-fingertip on the NUCLEO-L432KC without folders, bytes",
            &small_board_for(&relaxing),
        ),
    ];
    for (label, image) in boards {
        assert_no_panic(image);
        let size = image.size().expect("it is an image");
        // Their length is the building machine's: some 1.4 kB where the user's name is short.
        let folders = image.folder_bytes().expect("it is an image");
        let flash = size.flash - folders;
        println!(
            "{label}: {flash}, folders of this machine {folders} more, RAM {} bytes",
            size.ram
        );
        assert!(
            folders > 0,
            "{label}: no panic names a source file of the registry"
        );
        assert_measured_figure(label, flash as f64, 0.01);
        assert!(flash <= FLASH && size.ram <= RAM, "{label}: {flash}, {size:?}");
    }
}

/// Of the memory of seven terms, and of two of them while the past is not known: the chip was reset in a grasp.
#[test]
fn a_report_of_a_wall_that_relaxes_costs_few_instructions() {
    let relaxing = relaxing();
    for (scenario, from, label, most) in [
        (
            "press-hold-release",
            1.0,
            "instructions from averaged counts to both results of index-fingertip",
            RELAXING_INSTRUCTIONS,
        ),
        (
            "reset-in-a-grasp",
            3.0,
            "the same after a reset in a grasp",
            2 * RELAXING_INSTRUCTIONS,
        ),
    ] {
        let scenario = Scenario::named(scenario).expect("it is shipped");
        let duration = scenario.duration();
        let plant = relaxing.plant(scenario).expect("it can be pressed");
        let recorder = Recorder::new(|_: &Row| {});
        let outcome: RunOutcome<_> =
            bench::run(firmware_for(&relaxing), plant, duration, SIGNAL_PATH, recorder)
                .expect("the image runs");
        let calls = &outcome.calls[(from * 1e3) as usize..];
        let mut calls = calls.to_vec();
        calls.sort_unstable();
        let median = calls[calls.len() / 2];
        println!(
            "{label}: median {median}, {} to {}",
            calls[0],
            calls[calls.len() - 1]
        );
        assert_measured_figure(label, median as f64, 0.01);
        assert!(median <= most, "{median}");
    }
}
