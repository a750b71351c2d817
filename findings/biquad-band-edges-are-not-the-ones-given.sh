#!/usr/bin/env bash
# Package: biquad 0.6.0 (Rust crate)
#
# Expected: Coefficients::band_0db_from_cutting_frequencies(type, low, high) takes the two edges of
#   a band-pass or notch. A filter with the edges 49 Hz and 51 Hz at 1 kHz should have its -3 dB
#   points there, a Q of about f0 / (high - low) = 25. from_normalized_params documents its
#   frequency as "divided by two times sampling frequency".
# Seen: only the geometric mean of the edges is used; Q is 1 for every pair. The -3 dB points lie a
#   factor of 2.6 apart whatever is asked for: the notch for 49..51 Hz takes out 31..80 Hz, the
#   band-pass for 25..100 Hz passes the same 31..80 Hz. The gain in the middle is right. The
#   normalised frequency is to half the sampling frequency: who divides as documented gets a
#   low-pass at a quarter of the frequency.
# Why it matters: a hum notch of 2 Hz also takes out what a fast touch has between 31 and 80 Hz, and
#   the hum is gone, so it seems to work. Use from_params(type, fs, f0, Q) with Q = f0 / (high -
#   low), and measure the gain at the edges.
set -euo pipefail

dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
mkdir -p "$dir/edges/src"
cat >"$dir/edges/Cargo.toml" <<'TOML'
[package]
name = "edges"
version = "0.0.0"
edition = "2021"

[dependencies]
biquad = "=0.6.0"
TOML
cat >"$dir/edges/src/main.rs" <<'RS'
//! -3 dB points of band filters at a sampling frequency of 1 kHz, from their coefficients.
use biquad::{Coefficients, ToHertz, Type, Q_BUTTERWORTH_F64};
use std::f64::consts::{FRAC_1_SQRT_2, TAU};
use std::process::ExitCode;

const FS: f64 = 1000.0;

/// |H| at a frequency in Hz.
fn gain(c: &Coefficients<f64>, hz: f64) -> f64 {
    let w = TAU * hz / FS;
    let size = |k: [f64; 3]| {
        let re = k[0] + k[1] * w.cos() + k[2] * (2.0 * w).cos();
        let im = k[1] * w.sin() + k[2] * (2.0 * w).sin();
        re.hypot(im)
    };
    size([c.b0, c.b1, c.b2]) / size([1.0, c.a1, c.a2])
}

/// Where the gain passes -3 dB between two frequencies with one such point between them.
fn edge(c: &Coefficients<f64>, mut a: f64, mut b: f64) -> f64 {
    let above = gain(c, a) > FRAC_1_SQRT_2;
    for _ in 0..60 {
        let mid = 0.5 * (a + b);
        if (gain(c, mid) > FRAC_1_SQRT_2) == above { a = mid } else { b = mid }
    }
    a
}

fn main() -> ExitCode {
    let near = |a: f64, b: f64| (a / b - 1.0).abs() < 0.01;
    let mut ok = true;
    println!("asked, Hz        -3 dB from the edges   from f0 and Q = f0 / (high - low)");
    for (name, kind) in [("notch", Type::Notch), ("band-pass", Type::BandPass)] {
        for (low, high) in [(49.0, 51.0), (45.0, 55.0), (25.0, 100.0)] {
            let (n_low, n_high) = (low / (FS / 2.0), high / (FS / 2.0));
            let c = Coefficients::band_0db_from_cutting_frequencies(kind, n_low, n_high).unwrap();
            let middle = f64::sqrt(low * high);
            let got = (edge(&c, 1.0, middle), edge(&c, middle, 499.0));
            // The same centre with the Q of the edges; a band-pass of this crate has gain Q there.
            let q = middle / (high - low);
            let mut r = Coefficients::from_params(kind, FS.hz(), middle.hz(), q).unwrap();
            if kind == Type::BandPass {
                (r.b0, r.b1, r.b2) = (r.b0 / q, r.b1 / q, r.b2 / q);
            }
            let right = (edge(&r, 1.0, middle), edge(&r, middle, 499.0));
            println!("{name:<9} {low:>3}..{high:<3} {:>10.1} .. {:<8.1} {:>8.1} .. {:.1}",
                got.0, got.1, right.0, right.1);
            ok &= near(got.0, 31.0) && near(got.1, 79.8);
            ok &= (right.1 - right.0 - (high - low)).abs() < 0.1 * (high - low);
        }
    }
    let quotients =
        [("as documented, f / (2 fs)", 50.0 / (2.0 * FS)), ("f / (fs / 2)", 50.0 / (FS / 2.0))];
    for (how, normal) in quotients {
        let c = Coefficients::from_normalized_params(Type::LowPass, normal, Q_BUTTERWORTH_F64);
        let c = c.unwrap();
        let at = edge(&c, 1.0, 499.0);
        println!("low-pass of 50 Hz, {how}: -3 dB at {at:.2} Hz");
        ok &= near(at, if normal < 0.05 { 12.5 } else { 50.0 });
    }
    let end = if ok { "as described: the band's width is not read" } else { "behaviour changed" };
    println!("{end}");
    if ok { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
RS
cd "$dir/edges"
CARGO_TARGET_DIR="$dir/target" cargo run --quiet
