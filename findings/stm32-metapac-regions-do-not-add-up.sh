#!/usr/bin/env bash
# Package: stm32-metapac 21.0.0 (Rust crates), its metadata alone
#
# Expected: METADATA.memory lists a chip's memory regions, each with kind, address, size and, for
#   flash, the erase size. Nothing in the type marks one region as a view of another. So the sum of
#   the Ram regions should be the datasheet's RAM (STM32L432KC, DS11451: 64 KiB; STM32F429ZI,
#   DS9405: 256 KiB with the core-coupled part), the sum of the Flash regions its flash (256 KiB; 2
#   MiB), and each Flash region should have an erase size.
# Seen: the STM32L432KC's Ram regions add up to 80 KiB: its 16 KiB SRAM2 stands there twice, as
#   SRAM2 behind SRAM and as SRAM2_ICODE at 0x1000_0000, the same cells at two addresses. The
#   STM32F429ZI's Flash regions add up to 2 MiB and 528 bytes: the one-time-programmable area is of
#   kind Flash, with an erase size of 0. The two chips differ in kind: the STM32L432KC's own
#   one-time area (RM0394) is not listed at all.
# Why it matters: a memory budget, a stack painter or a linker script made from this list hands out
#   16 KiB that is already in use, and both owners write the same bytes; a flash store that walks
#   the Flash regions computes a remainder by erase size 0, or ends in cells that can be written
#   only once. Take sizes from the datasheet; filter on names (BANK_*), not on the kind alone.
set -euo pipefail

dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
mkdir -p "$dir/regions/src"
cat >"$dir/regions/Cargo.toml" <<'TOML'
[package]
name = "regions"
version = "0.0.0"
edition = "2021"

[features]
l432 = ["stm32-metapac/stm32l432kc"]
f429 = ["stm32-metapac/stm32f429zi"]

[dependencies]
stm32-metapac = { version = "=21.0.0", default-features = false, features = ["metadata"] }
TOML
cat >"$dir/regions/src/main.rs" <<'RS'
//! Prints the regions of one chip; exits 0 if its RAM and flash add up to the stated sums, in bytes.
use std::process::ExitCode;
use stm32_metapac::metadata::{MemoryRegionKind, METADATA};

fn main() -> ExitCode {
    let want: Vec<u32> = std::env::args().skip(1).map(|a| a.parse().unwrap()).collect();
    let [true_ram, true_flash, ram, flash, unerasable] = want[..] else {
        return ExitCode::FAILURE;
    };
    println!("{}", METADATA.name);
    let regions = METADATA.memory[0];
    for r in regions {
        let erase = r.settings.as_ref().map_or(String::new(), |s| format!("erase {}", s.erase_size));
        println!("  {:<16} {:?} {:#010x} {:>8} {erase}", r.name, r.kind, r.address, r.size);
    }
    let sum = |kind| regions.iter().filter(|r| r.kind == kind).map(|r| r.size).sum::<u32>();
    let got_ram = sum(MemoryRegionKind::Ram);
    let got_flash = sum(MemoryRegionKind::Flash);
    let zero = regions.iter().filter(|r| r.settings.as_ref().is_some_and(|s| s.erase_size == 0));
    let got_zero = zero.count() as u32;
    println!("  RAM   {got_ram:>8}, datasheet {true_ram:>8}, {:+}", got_ram as i64 - true_ram as i64);
    println!("  flash {got_flash:>8}, datasheet {true_flash:>8}, {:+}; erase size 0: {got_zero}",
        got_flash as i64 - true_flash as i64);
    if (got_ram, got_flash, got_zero) == (ram, flash, unerasable) {
        return ExitCode::SUCCESS;
    }
    ExitCode::FAILURE
}
RS
cd "$dir/regions"
export CARGO_TARGET_DIR="$dir/target"
KIB=1024
if cargo run --quiet --features l432 -- \
    $((64 * KIB)) $((256 * KIB)) $((80 * KIB)) $((256 * KIB)) 0 &&
  cargo run --quiet --features f429 -- \
    $((256 * KIB)) $((2048 * KIB)) $((256 * KIB)) $((2048 * KIB + 528)) 1; then
  echo "as described: neither list adds up to its datasheet"
else
  echo "behaviour changed"
  exit 1
fi
