#!/usr/bin/env bash
# Packages: ufmt_float 0.2.0, ufmt 0.2.0 (Rust crates)
#
# Expected: uFmt_f32::Two(x) prints x with two decimals through ufmt, the small formatter for chips
#   without room for core::fmt. The documentation says that the last digit is not rounded and that 4
#   to 5 significant figures are right; nothing is said of signs. -3.07 should print as -3.07, or
#   -3.06 at worst.
# Seen: every negative number prints without its fraction, and between -1 and 0 without its sign:
#   -3.07 is "-3.00", -0.5 is "0.00". The fraction is computed with the sign of the number and then
#   converted to an unsigned integer, which Rust saturates at 0. uFmt_f64 does the same. The digits
#   are well formed, so no parser complains.
# Why it matters: a tared tip is negative half the time. Its log has no value between -1 and 0, the
#   mean of a noise of +-0.5 about zero comes out at +0.12 instead of 0, and a small pull looks
#   exactly like rest. Tests with positive numbers pass. Print the sign and the magnitude apart, or
#   an integer in a smaller unit.
set -euo pipefail

dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
mkdir -p "$dir/print/src"
cat >"$dir/print/Cargo.toml" <<'TOML'
[package]
name = "print"
version = "0.0.0"
edition = "2021"

[dependencies]
ufmt = "=0.2.0"
ufmt_float = "=0.2.0"
TOML
cat >"$dir/print/src/main.rs" <<'RS'
//! Numbers of both signs through the crate's printers, read back as numbers.
use std::process::ExitCode;
use ufmt::uwrite;
use ufmt_float::{uFmt_f32, uFmt_f64};

struct Text(String);

impl ufmt::uWrite for Text {
    type Error = core::convert::Infallible;
    fn write_str(&mut self, s: &str) -> Result<(), Self::Error> {
        self.0.push_str(s);
        Ok(())
    }
}

fn single(x: f32) -> String {
    let mut out = Text(String::new());
    uwrite!(out, "{}", uFmt_f32::Two(x)).unwrap();
    out.0
}

fn double(x: f32) -> String {
    let mut out = Text(String::new());
    uwrite!(out, "{}", uFmt_f64::Two(f64::from(x))).unwrap();
    out.0
}

fn main() -> ExitCode {
    let mut ok = true;
    println!("{:>8} {:>9} {:>9}", "number", "uFmt_f32", "uFmt_f64");
    for x in [3.07_f32, 0.5, 0.12, -0.12, -0.5, -0.99, -1.25, -3.07] {
        let (a, b) = (single(x), double(x));
        println!("{x:>8} {a:>9} {b:>9}");
        for read in [a.parse::<f32>().unwrap(), b.parse().unwrap()] {
            // Above zero within one last digit; below zero the whole part alone.
            ok &= if x > 0.0 { (read - x).abs() < 0.0101 } else { read == x.trunc() };
        }
        ok &= x <= -1.0 || !a.starts_with('-');
    }
    // A symmetric noise about zero, -0.5 to 0.5 in steps of 0.001.
    let read = |i: i32| single(i as f32 / 1000.0).parse::<f32>().unwrap();
    let mean = (-500..=500).map(read).sum::<f32>() / 1001.0;
    println!("mean of -0.5..0.5 as printed: {mean:.3}, true 0");
    ok &= (0.115..0.13).contains(&mean);
    let end = if ok { "as described: no fraction below zero" } else { "behaviour changed" };
    println!("{end}");
    if ok { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
RS
cd "$dir/print"
CARGO_TARGET_DIR="$dir/target" cargo run --quiet
