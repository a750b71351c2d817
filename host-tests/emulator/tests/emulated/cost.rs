//! What a report costs, measured on the emulated chip.

use crate::{firmware, press_hold_release};

/// Most instructions from the averaged counts to both results.
const INSTRUCTIONS_PER_REPORT: u64 = 400;
/// Most instructions in a millisecond, everything counted: a tenth of the part's 160 000 cycles.
const INSTRUCTIONS_PER_MILLISECOND: f64 = 16_000.0;
/// Most bytes of flash and of RAM, the stack left out.
const FLASH: u64 = 64 * 1024;
const RAM: u64 = 16 * 1024;

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
    // The most may include an interrupt.
    assert!(median <= INSTRUCTIONS_PER_REPORT && most <= 4 * INSTRUCTIONS_PER_REPORT);
}

#[test]
fn the_core_sleeps_most_of_the_time() {
    let run = press_hold_release();
    let per_millisecond = run.instructions as f64 / (run.time * 1e3);
    println!("instructions per millisecond, all included: {per_millisecond:.0}");
    assert!(
        per_millisecond <= INSTRUCTIONS_PER_MILLISECOND,
        "{per_millisecond}"
    );
}

#[test]
fn the_image_is_small() {
    let size = firmware().size().expect("it is an image");
    println!("flash {} bytes, RAM {} bytes", size.flash, size.ram);
    assert!(size.flash <= FLASH && size.ram <= RAM, "{size:?}");
}
