//! How deep the stack goes, read from the paint that the image leaves in its unused part.

use crate::{press_hold_release, run};
use host_tests::assert_measured_figure;

/// Bytes of the stack of an image of one tip (`memory.x`), of which it may use half, and of that of a hand (`build.rs`).
const STACK: u64 = 8 * 1024;
const STACK_OF_A_HAND: u64 = 16 * 1024;

fn expect_half_empty(label: &str, used: Option<u64>, length: u64) {
    let used = used.expect("the run went on to its end");
    println!("{label}: {used} of {length}");
    assert!(used > 500 && used <= length / 2, "{label}: {used}");
    assert_measured_figure(label, used as f64, 0.05);
}

#[test]
fn half_of_the_stack_of_one_tip_stays_empty() {
    // With a save, a tare and a self-test, and a press.
    let deepest = run("commands").stack.max(press_hold_release().stack);
    expect_half_empty("stack used, of 8192 bytes", deepest, STACK);
}

#[test]
fn half_of_the_stack_of_a_hand_stays_empty() {
    let used = crate::hand::run().hand.stack;
    expect_half_empty(
        "stack used by a hand of five tips, of 16384 bytes",
        used,
        STACK_OF_A_HAND,
    );
}
