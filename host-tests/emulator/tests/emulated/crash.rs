//! Code that fails on the running image: word of it survives the reset, and reset after reset ends in a board that says
//! so. The first instruction of the signal path, the store or the transducer's start is exchanged in the image.

use crate::{design, firmware};
use emulator::bench;
use emulator::image::Image;
use emulator::inlined;
use emulator::record::{Recorder, Recording, Row};
use emulator::scenario::{Event, Happening, Scenario};
use fingertip::device::task_monitor::{RESET_LIMIT, Stage};
use fingertip::link::command::{CommandKind, Outcome};
use fingertip::link::telemetry::Hello;
use fingertip::status::{Fault, LastFault, ResetCause, Status};

/// `UDF #0` twice (ARMv7-M ARM A7.7.194, encoding T1).
const UNDEFINED: [u16; 2] = [0xDE00; 2];
/// `B` to itself, twice (A7.7.12, encoding T2).
const ENDLESS: [u16; 2] = [0xE7FE; 2];
/// `PUSH {R0}`, `MOV R1, SP`, `LSLS R1, R1, #19` and `BNE` back until the stack of 8 KB is full, then `B` to itself (A7.7.101,
/// A7.7.77, A7.7.68, A7.7.12). Not further: the emulator takes stores below it without the chip's fault of the bus.
const FILLING: [[u16; 2]; 3] = [[0xB401, 0x4669], [0x04C9, 0xD1FB], [0xE7FE, 0xE7FE]];
/// Functions that do nothing but panic: one of them is in every image.
const PANICS: [(&str, &str); 4] = [
    ("core::result", "unwrap_failed"),
    ("core::option", "unwrap_failed"),
    ("core::slice::index", "slice_index_fail"),
    ("core::panicking", "panic_fmt"),
];
/// All resets are over, seconds, where the code resets the chip; ...
const OVER: f64 = 0.2;
/// ... and where the watchdog does: until it is fed for the first time it waits for 0.512 s (RM0090 21.3.3), six times.
const HANGS_OVER: f64 = 3.2;
/// The run goes on for this long, seconds.
const AFTER: f64 = 0.8;
/// What the host asks of the board that measures nothing, a tenth of a second apart, and what comes of it.
const ASKED: [(Happening, CommandKind, Outcome); 5] = [
    (Happening::Tare, CommandKind::Tare, Outcome::NoReading),
    (Happening::Undo, CommandKind::Undo, Outcome::NothingToUndo),
    (Happening::Save, CommandKind::Save, Outcome::NoReading),
    (Happening::Info, CommandKind::Info, Outcome::Done),
    (Happening::SelfTest, CommandKind::SelfTest, Outcome::Done),
];

/// `B.W` at an address to another (ARMv7-M ARM A7.7.12, encoding T4), within 16 MB.
fn branch(at: u64, to: u64) -> [u16; 2] {
    let offset = to.wrapping_sub(at).wrapping_sub(4) as u32;
    let sign = offset >> 24 & 1;
    let j = |bit: u32| 1 ^ (offset >> bit & 1) ^ sign;
    [
        (0xF000 | sign << 10 | offset >> 12 & 0x3FF) as u16,
        (0x9000 | j(23) << 13 | j(22) << 11 | offset >> 1 & 0x7FF) as u16,
    ]
}

fn entry() -> u64 {
    firmware().function("Pipeline", "step").expect("it is there")
}

/// Runs the image with these instructions at an address: what it says when it has given up, after `over` seconds.
fn hello_with(address: u64, instructions: [u16; 2], over: f64, cause: ResetCause) -> Hello {
    hello_of(
        &firmware()
            .with_code(address, instructions)
            .expect("it is in a section"),
        over,
        cause,
    )
}

fn hello_of(image: &Image, over: f64, cause: ResetCause) -> Hello {
    let mut scenario = Scenario::named("press-hold-release").expect("it is shipped");
    scenario.event = (1..)
        .zip(ASKED)
        .map(|(tenth, (is, ..))| Event {
            at_ms: over * 1e3 + f64::from(100 * tenth),
            is,
            for_ms: None,
            radius_mm: None,
        })
        .collect();
    let plant = design()
        .plant(scenario)
        .expect("the default design can be pressed");
    let recorder = Recorder::new(|_: &Row| {});
    let outcome = bench::run(image, plant, over + AFTER, &[], recorder).expect("the image runs");
    assert_eq!(
        outcome.resets.len(),
        usize::from(RESET_LIMIT) + 1,
        "{:?}",
        outcome.resets
    );
    let record: Recording = outcome.listener.into_record();
    assert!(record.rows.iter().all(|row| row.reported.is_none()));
    let after = record.rows.iter().filter(|row| row.time > over);
    assert!(after.clone().count() > 700, "{} reports", record.rows.len());
    for row in after {
        assert_eq!(row.status, Status::Fault(Fault::ResetLoop), "{row:?}");
    }
    let answers = record.answers.iter();
    assert_eq!(
        answers
            .map(|answer| (answer.command, answer.outcome))
            .collect::<Vec<_>>(),
        ASKED.map(|(_, command, outcome)| (command, outcome))
    );
    let hello = *record.hellos.last().expect("it greets");
    assert_eq!(
        (hello.reset_cause, hello.resets_in_a_row),
        (cause, RESET_LIMIT + 1)
    );
    hello
}

#[test]
fn a_hang_while_the_store_opens_ends_in_a_board_that_says_so_without_it() {
    let store = firmware()
        .function("log::RecordLog", "scan::{{closure}}")
        .expect("the image has a store");
    let hello = hello_with(store, ENDLESS, HANGS_OVER, ResetCause::Watchdog);
    assert_eq!(
        (hello.last_fault, hello.last_fault_detail),
        (LastFault::Hang, Stage::Store as u32)
    );
}

#[test]
fn a_hang_while_the_transducer_starts_ends_in_a_board_that_says_so_without_it() {
    let start = inlined::find(firmware(), &[("Converter", "restart")]).expect("the image starts it");
    let hello = hello_with(start[0], ENDLESS, HANGS_OVER, ResetCause::Watchdog);
    assert_eq!(
        (hello.last_fault, hello.last_fault_detail),
        (LastFault::Hang, Stage::Transducer as u32)
    );
}

#[test]
fn a_panic_after_each_start_is_told_of_and_ends_in_a_board_that_measures_nothing() {
    let panic = PANICS
        .iter()
        .find_map(|(owner, name)| firmware().function(owner, name).ok());
    let panic = branch(entry(), panic.expect("a panic is in the image"));
    let hello = hello_with(entry(), panic, OVER, ResetCause::Software);
    assert_eq!(hello.last_fault, LastFault::Panic);
}

#[test]
fn a_hard_fault_after_each_start_leaves_its_address_and_ends_likewise() {
    let hello = hello_with(entry(), UNDEFINED, OVER, ResetCause::Software);
    assert_eq!(
        (hello.last_fault, u64::from(hello.last_fault_detail)),
        (LastFault::HardFault, entry())
    );
}

#[test]
fn a_stack_that_overflows_after_each_start_is_told_of_as_that() {
    let mut image = firmware().clone();
    for (address, instructions) in (entry()..).step_by(4).zip(FILLING) {
        image = image
            .with_code(address, instructions)
            .expect("it is in a section");
    }
    // Where the chip stops, as the frame of its fault has no place, the emulated one hangs: either way the watchdog resets it.
    let hello = hello_of(&image, HANGS_OVER, ResetCause::Watchdog);
    assert_eq!(hello.last_fault, LastFault::StackOverflow);
}

#[test]
fn a_branch_is_encoded_as_the_manual_has_it() {
    // By hand: to itself, to the next instruction, a megabyte back.
    assert_eq!(branch(0x0800_0100, 0x0800_0100), [0xF7FF, 0xBFFE]);
    assert_eq!(branch(0x0800_0100, 0x0800_0104), [0xF000, 0xB800]);
    assert_eq!(branch(0x0810_0000, 0x0800_0004), [0xF700, 0xB800]);
}
