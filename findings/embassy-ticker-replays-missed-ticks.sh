#!/usr/bin/env bash
# Packages: embassy-time 0.5.1 with its mock-driver, embassy-futures 0.1.2, critical-section 1.2.0
#   (Rust crates)
#
# Expected: embassy_time::Ticker is documented as the way to run something once a period, whatever
#   the body of the loop costs, so a loop that samples and then awaits `next()` samples at uniform
#   times. After a stall (a page erase stops a one-bank STM32L4 for up to 24.5 ms, DS11451) a reader
#   expects the next sample at the next multiple of the period, or one period later.
# Seen: every missed tick is delivered, without waiting: after 25 ms at 1 kHz, 25 calls of `next()`
#   complete at one and the same instant, and the body of the loop runs 25 times in a row. There is
#   no policy to choose and no count of missed ticks. `reset_at(first missed tick)`, which reads
#   like the way to skip them, replays one tick less; `reset()` skips all, but moves the phase.
# Why it matters: 25 samples of one instant enter a filter that assumes 1 ms between them: the rate
#   it sees is a jump followed by zeros, and a debounce counted in samples passes in no time. Take
#   the time from the clock, or move the deadline oneself: the last case skips to one tick and keeps
#   the phase.
set -euo pipefail

dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
mkdir -p "$dir/ticks/src"
cat >"$dir/ticks/Cargo.toml" <<'TOML'
[package]
name = "ticks"
version = "0.0.0"
edition = "2021"

[dependencies]
embassy-time = { version = "=0.5.1", features = ["mock-driver", "generic-queue-8"] }
embassy-futures = "=0.1.2"
critical-section = { version = "=1.2.0", features = ["std"] }
TOML
cat >"$dir/ticks/src/main.rs" <<'RS'
//! A 1 kHz ticker on a clock that the program moves: what is ready after a stall of 25 ms.
use embassy_futures::poll_once;
use embassy_time::{Duration, Instant, MockDriver, Ticker};
use std::process::ExitCode;

const PERIOD: Duration = Duration::from_millis(1);

/// How often `next()` completes with the clock standing still.
fn ready_now(ticker: &mut Ticker) -> u32 {
    let mut count = 0;
    while poll_once(ticker.next()).is_ready() {
        count += 1;
    }
    count
}

/// Time from now to the next tick, in microseconds, once nothing is ready.
fn until_next(ticker: &mut Ticker) -> u64 {
    let start = Instant::now();
    while ready_now(ticker) == 0 {
        MockDriver::get().advance(Duration::from_micros(50));
    }
    start.elapsed().as_micros()
}

/// A ticker that has run for 10 periods and then stalls for 25.3 of them.
fn stalled() -> (Ticker, Instant) {
    MockDriver::get().reset();
    let mut ticker = Ticker::every(PERIOD);
    let mut last = Instant::now();
    for _ in 0..10 {
        MockDriver::get().advance(PERIOD);
        assert_eq!(ready_now(&mut ticker), 1);
        last = Instant::now();
    }
    MockDriver::get().advance(Duration::from_micros(25_300));
    (ticker, last)
}

fn main() -> ExitCode {
    let (mut plain, _) = stalled();
    let replayed = ready_now(&mut plain);
    let phase = until_next(&mut plain);
    println!("plain:             {replayed:>2} ticks at one instant, the next in {phase} us");

    let (mut at, last) = stalled();
    at.reset_at(last + PERIOD);
    let at_ticks = ready_now(&mut at);
    let at_phase = until_next(&mut at);
    println!("reset_at(missed):  {at_ticks:>2} ticks at one instant, the next in {at_phase} us");

    let (mut restart, _) = stalled();
    restart.reset();
    let restart_ticks = ready_now(&mut restart);
    let restart_phase = until_next(&mut restart);
    println!("reset():           {restart_ticks:>2} ticks at one instant, the next in {restart_phase} us");

    // Skip what was missed and keep the phase: the deadline becomes the last multiple before now.
    let (mut skip, last) = stalled();
    let whole = (Instant::now() - last).as_ticks() / PERIOD.as_ticks();
    skip.reset_at(last + PERIOD * (whole as u32 - 1));
    let skip_ticks = ready_now(&mut skip);
    let skip_phase = until_next(&mut skip);
    println!("advanced by hand:  {skip_ticks:>2} tick at one instant, the next in {skip_phase} us");

    let as_described = (replayed, phase) == (25, 700)
        && (at_ticks, at_phase) == (24, 700)
        && (restart_ticks, restart_phase) == (0, 1000)
        && (skip_ticks, skip_phase) == (1, 700);
    println!("{}", if as_described { "as described: missed ticks are replayed" } else { "behaviour changed" });
    if as_described { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
RS
cd "$dir/ticks"
CARGO_TARGET_DIR="$dir/target" cargo run --quiet
