//! Blocks of a tip's data that nobody wrote: random bytes, and whole blocks changed a little, with their check made anew or not.
//! None panics, and whatever is believed has outputs that never fall.
//!
//! `TIP_BLOCKS=20000000 cargo test --release --package host-tests --test tip_block` draws more of them.

use fingertip::signal::contact::contact;
use fingertip::signal::design::Design;
use fingertip::signal::loaded_design::LoadedDesign;
use fingertip::status::Warnings;
use model_tables::block::write::{TipData, sign};
use model_tables::block::{BlockError, ENTRY, HEAD, StoredCalibration};
use model_tables::random::Random;
use model_tables::units::PressureRise;
use std::collections::BTreeMap;

/// Blocks drawn in every run of the tests.
const BLOCKS: u64 = 200_000;

#[allow(clippy::unreadable_literal, unreachable_pub, dead_code)] // generated source
mod golden {
    pub(crate) mod index {
        include!("../../model-tables/golden/index-fingertip/tables.rs");
    }
    pub(crate) mod paper {
        include!("../../model-tables/golden/paper-prestretched/tables.rs");
    }
    pub(crate) mod analogue {
        include!("../../model-tables/golden/skin-analogue/tables.rs");
    }
    pub(crate) mod light {
        include!("../../model-tables/golden/skin-light-touch/tables.rs");
    }
}

/// The shipped designs, with and without a calibration.
fn shipped() -> Vec<Vec<u8>> {
    macro_rules! block {
        ($design:ident, $calibration:expr, $relaxation:expr) => {
            TipData {
                constants: golden::$design::DESIGN,
                layout: golden::$design::TABLES.layout,
                words: golden::$design::TABLES.segments.as_flattened(),
                name: golden::$design::NAME,
                calibration: $calibration,
                relaxation: $relaxation,
                object: None,
                feedback: None,
            }
            .write()
        };
    }
    let calibration = Some(StoredCalibration {
        zero: 10_000_000,
        temperature: 2_000,
        coefficient: 0,
        gain: 500,
    });
    vec![
        block!(index, None, Some(golden::index::RELAXATION)),
        block!(paper, calibration, None),
        block!(analogue, None, None),
        block!(light, calibration, None),
    ]
}

/// A block that nobody wrote.
fn drawn(shipped: &[Vec<u8>], random: &mut Random) -> Vec<u8> {
    let mut block = shipped[random.below(shipped.len() as u64) as usize].clone();
    match random.below(8) {
        0 => block = (0..random.below(400)).map(|_| random.bits() as u8).collect(),
        // A head that is believed, and anything behind it.
        1 => {
            let from = [8, 16, HEAD, HEAD + ENTRY][random.below(4) as usize];
            for byte in &mut block[from..] {
                *byte = random.bits() as u8;
            }
        }
        // A coefficient that is a little different.
        2 | 3 => {
            let at = block.len() - 4 - 2 * random.below(100) as usize;
            let word = i16::from_le_bytes([block[at], block[at + 1]]);
            let other = word.wrapping_add((random.below(65) as i16 - 32) << random.below(10));
            block[at..at + 2].copy_from_slice(&other.to_le_bytes());
        }
        _ => {
            for _ in 0..=random.below(3) {
                if block.is_empty() {
                    break;
                }
                let at = random.below(block.len() as u64) as usize;
                match random.below(6) {
                    0 | 1 => block[at] ^= 1 << random.below(8),
                    2 => block[at] = random.bits() as u8,
                    3 => block.truncate(at),
                    4 => drop(block.remove(at)),
                    _ => block.insert(at, random.bits() as u8),
                }
            }
        }
    }
    if random.below(8) > 0 && block.len() >= HEAD {
        block[..6].copy_from_slice(b"FTIP\x01\x00");
        let length = block.len() as u32;
        block[8..12].copy_from_slice(&length.to_le_bytes());
        sign(&mut block);
    }
    block
}

/// What a loaded design reads at rising inputs, everywhere in the word and next to each other.
fn never_falls(design: &LoadedDesign, random: &mut Random) {
    let end = design.parameters().last_rise.0;
    let mut counts: Vec<i32> = (0..32)
        .flat_map(|_| {
            let count = (random.unit() * f64::from(end)) as i32;
            [count, count + 1, random.bits() as i32]
        })
        .chain([i32::MIN, -1, 0, 1, end, i32::MAX])
        .collect();
    counts.sort_unstable();
    let mut before = (0, 0);
    for count in counts {
        let reading = contact(design, PressureRise(count), Warnings::NONE);
        let now = (reading.force.0, reading.indentation.0);
        assert!(now.0 >= before.0 && now.1 >= before.1, "{design:?} at {count}");
        before = now;
    }
}

#[test]
fn what_nobody_wrote_is_refused_or_never_falls() {
    let blocks = std::env::var("TIP_BLOCKS").map_or(BLOCKS, |text| text.parse().expect("a number of blocks"));
    let shipped = shipped();
    for block in &shipped {
        LoadedDesign::read(block).expect("the shipped designs can be loaded");
    }
    let mut random = Random(13);
    let mut outcomes: BTreeMap<&str, u64> = BTreeMap::new();
    for _ in 0..blocks {
        let block = drawn(&shipped, &mut random);
        let outcome = match LoadedDesign::read(&block) {
            Ok((design, _)) => {
                never_falls(&design, &mut random);
                "believed"
            }
            Err(BlockError::NoBlock) => "no block",
            Err(BlockError::LayoutVersion(_)) => "other layout",
            Err(BlockError::Short { .. }) => "cut off",
            Err(BlockError::Check) => "check",
            Err(BlockError::Directory) => "directory",
            Err(BlockError::UnknownSection(_)) => "unknown section",
            Err(BlockError::SectionVersion(..)) => "section version",
            Err(BlockError::Missing(_)) => "missing section",
            Err(BlockError::SectionLength(_)) => "section length",
            Err(BlockError::Value(..)) => "value",
            Err(BlockError::Tables(_)) => "tables",
        };
        *outcomes.entry(outcome).or_default() += 1;
    }
    println!("{outcomes:?}");
    // Every reader of a part was reached, and neither all nor nothing is believed.
    for outcome in [
        "believed",
        "check",
        "directory",
        "section version",
        "unknown section",
        "value",
        "tables",
    ] {
        let seen = outcomes.get(outcome).copied().unwrap_or_default();
        assert!(seen > blocks / 1_000, "{outcome}: {seen}");
    }
}
