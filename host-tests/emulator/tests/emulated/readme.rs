//! The figures of the README that the emulated chip gives: counts exactly, the rest within a band. Flash depends a
//! little on where cargo keeps its packages, because panics name their files.

use crate::{firmware, press_hold_release, small_board};
use emulator::accuracy::Accuracy;
use host_tests::assert_readme_figure;

#[test]
fn cost_of_the_image() {
    let run = press_hold_release();
    let mut readings: Vec<u64> = run
        .record
        .rows
        .iter()
        .zip(&run.calls)
        .filter_map(|(row, &instructions)| row.reported.map(|_| instructions))
        .collect();
    readings.sort_unstable();
    let size = firmware().size().expect("it is an image");
    assert_readme_figure(
        "instructions from averaged counts to both results",
        readings[readings.len() / 2] as f64,
        0.0,
    );
    assert_readme_figure(
        "instructions a millisecond, everything",
        run.instructions as f64 / (run.time * 1e3),
        0.03,
    );
    assert_readme_figure("flash, bytes", size.flash as f64, 0.01);
    assert_readme_figure("RAM without the stack, bytes", size.ram as f64, 0.0);
    let size = small_board().size().expect("it is an image");
    assert_readme_figure("flash on the NUCLEO-L432KC, bytes", size.flash as f64, 0.01);
    assert_readme_figure(
        "RAM without the stack on the NUCLEO-L432KC, bytes",
        size.ram as f64,
        0.0,
    );
}

#[test]
fn accuracy_of_the_press() {
    let run = press_hold_release();
    let all = Accuracy::of(run.record.rows.iter(), &run.plant);
    assert_readme_figure(
        "median error of force, % of reading",
        100.0 * all.force_median,
        0.2,
    );
    assert_readme_figure(
        "median error of indentation, % of reading",
        100.0 * all.indentation_median,
        0.2,
    );
}
