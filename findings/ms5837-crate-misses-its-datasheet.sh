#!/usr/bin/env bash
# Packages: ms5837 0.2.1, embedded-hal 0.2.7 (Rust crates)
#
# Expected: the MS5837-30BA datasheet works one example through: coefficients C1..C6 = 34982 36352
#   20328 22354 26646 26146, D1 = 4958179, D2 = 6815414 give 19.81 degC and 3999.8 mbar. The crate's
#   source states its results in mbar and degC, names the datasheet's figures as its base, and tests
#   its CRC against the datasheet's C code.
# Seen: 5.7e14 mbar and 198.2 degC. The pressure is D1 * SENS - OFF: the divisions by 2^21 and 2^13
#   are missing. As D1 * SENS then dwarfs OFF, 0 mbar no longer gives zero, and the factor to the
#   true pressure changes with pressure: no scale repairs it. Temperature is ten times too high.
# Why it matters: the crate has the part's name, type states, a CRC and passing tests, the usual
#   signs of a usable driver, but no test holds the datasheet's numbers. For a transducer driver the
#   worked example is the first test to look for. The driver also reads the converter straight after
#   the start command, without the 0.6 to 9 ms the conversion takes.
set -euo pipefail

dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
mkdir -p "$dir/example/src"
cat >"$dir/example/Cargo.toml" <<'TOML'
[package]
name = "example"
version = "0.0.0"
edition = "2021"

[dependencies]
ms5837 = "=0.2.1"
embedded-hal = "=0.2.7"
TOML
cat >"$dir/example/src/main.rs" <<'RS'
//! The MS5837-30BA datasheet's worked example, given to the crate over a model of the part.
use embedded_hal::blocking::i2c::WriteRead;
use ms5837::OverSamplingRatio;
use std::process::ExitCode;

const C: [u16; 7] = [0, 34982, 36352, 20328, 22354, 26646, 26146];
const D1: u32 = 4_958_179;
const D2: u32 = 6_815_414;

/// The datasheet's CRC-4 (polynomial x^4 + x + 1) over the seven words with the CRC bits cleared.
fn crc4(words: &[u16; 7]) -> u16 {
    let mut rest = 0_u16;
    for byte in words.iter().flat_map(|w| w.to_be_bytes()).chain([0, 0]) {
        rest ^= u16::from(byte);
        for _ in 0..8 {
            rest = if rest & 0x8000 == 0 { rest << 1 } else { rest << 1 ^ 0x3000 };
        }
    }
    rest >> 12
}

/// The part: its memory, and the converter value that the last command asked for.
struct Part {
    memory: [u16; 7],
    value: u32,
}

impl WriteRead for Part {
    type Error = core::convert::Infallible;
    fn write_read(&mut self, _: u8, out: &[u8], into: &mut [u8]) -> Result<(), Self::Error> {
        match out[0] {
            0x40..=0x4A => self.value = D1,
            0x50..=0x5A => self.value = D2,
            0x00 => into.copy_from_slice(&self.value.to_be_bytes()[1..]),
            word @ 0xA0..=0xAC => {
                into.copy_from_slice(&self.memory[usize::from(word - 0xA0) / 2].to_be_bytes());
            }
            _ => {} // reset
        }
        Ok(())
    }
}

fn main() -> ExitCode {
    // Compensation as in the datasheet: first order, then second order for TEMP below 20 degC.
    let c: Vec<i64> = C.iter().map(|&v| i64::from(v)).collect();
    let dt = i64::from(D2) - (c[5] << 8);
    let temp = 2000 + (dt * c[6] >> 23);
    let off = (c[2] << 16) + (c[4] * dt >> 7);
    let sens = (c[1] << 15) + (c[3] * dt >> 8);
    let low = (temp - 2000).pow(2);
    let (off2, sens2) = (3 * low / 2, 5 * low / 8);
    let temp2 = temp - (3 * dt * dt >> 33);
    let pressure = ((i64::from(D1) * (sens - sens2) >> 21) - (off - off2)) >> 13;
    println!("datasheet: {:.2} degC, {:.1} mbar", temp2 as f64 / 100.0, pressure as f64 / 10.0);

    let mut memory = C;
    memory[0] = crc4(&C) << 12;
    let sensor = ms5837::new(Part { memory, value: 0 }).init();
    let Ok(mut sensor) = sensor else {
        println!("behaviour changed: the example's memory is refused");
        return ExitCode::FAILURE;
    };
    let got = sensor.read_temperature_and_pressure(OverSamplingRatio::R4096).unwrap();
    println!("crate:     {:.2} degC, {:.4e} mbar", got.temperature, got.pressure);

    let undivided = (i64::from(D1) * sens - off) as f64 / 10.0;
    println!("D1 * SENS - OFF, divided by nothing but 10: {undivided:.4e}");
    let ok = (temp2, pressure) == (1981, 39998)
        && (f64::from(got.pressure) / undivided - 1.0).abs() < 1e-6
        && (f64::from(got.temperature) / 198.2 - 1.0).abs() < 1e-3;
    println!("{}", if ok { "as described: the divisions are missing" } else { "behaviour changed" });
    if ok { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
RS
cd "$dir/example"
CARGO_TARGET_DIR="$dir/target" cargo run --quiet
