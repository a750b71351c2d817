//! The figures of the page of measured ones that the images give, within a hundredth: flash depends a little on where cargo keeps its
//! packages, because panics name their files.

use crate::{firmware, press_hold_release, small_board};
use emulator::accuracy::RunAccuracy;
use host_tests::assert_measured_figure;

#[test]
fn cost_of_the_image() {
    let size = firmware().size().expect("it is an image");
    assert_measured_figure("flash, bytes", size.flash as f64, 0.01);
    assert_measured_figure("RAM without the stack, bytes", size.ram as f64, 0.01);
    let size = small_board().size().expect("it is an image");
    assert_measured_figure("flash on the NUCLEO-L432KC, bytes", size.flash as f64, 0.01);
    assert_measured_figure(
        "RAM without the stack on the NUCLEO-L432KC, bytes",
        size.ram as f64,
        0.01,
    );
}

#[test]
fn accuracy_of_the_press() {
    let run = press_hold_release();
    let all = RunAccuracy::of(run.record.rows.iter(), &run.plant);
    println!("{all:?}");
    let percent = |share: f64| 100.0 * share;
    assert_measured_figure(
        "median error of force, % of reading",
        percent(all.force_median),
        0.1,
    );
    assert_measured_figure(
        "median error of indentation, % of reading",
        percent(all.indentation_median),
        0.1,
    );
}
