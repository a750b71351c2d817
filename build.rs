//! Solves the model of the design and writes its tables; hands the linker its scripts when building for a chip.
//!
//! `FINGERTIP_DESIGN`, relative to the workspace root, chooses the design.

use model_tables::constants::TransducerKind;
use model_tables::design_file::hand::bus::{BusRound, SET_UP};
use model_tables::design_file::hand::{HandFile, TransducerPlace, is_hand};
use model_tables::design_file::{DesignFile, TransducerKindSection};
use model_tables::generate::{self, AccuracyLimit, GenerateError, Generated};
use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

const DEFAULT_DESIGN: &str = "model-tables/designs/index-fingertip-elastic.toml";

/// Each board with the linker's sizes of its chip; those of the default board are in `memory.x`. And how long its converter takes for
/// the internal reference, microseconds: `IDENTITY_CONVERSION` of its chip.
const BOARDS: [(&str, Option<&str>, u32); 3] = [
    ("nucleo-f429zi", None, 17),
    ("nucleo-l432kc", Some("src/board/nucleo_l432kc.x"), 10),
    ("nucleo-g474re", Some("src/board/nucleo_g474re.x"), 10),
];

/// What the firmware of a board that is not the default one does for a transaction on a hand's bus beside its bits, microseconds: 3500
/// instructions, all that runs beside them among them, at 1.3 cycles of 24 and 104 MHz.
const SET_UPS: [(&str, u32); 2] = [("nucleo-l432kc", 190), ("nucleo-g474re", 45)];

/// A tip's conversion, and what the scans of a block come to at about, microseconds.
const CONVERSION: u32 = 10;
const BLOCK: u32 = 1_000;

fn main() {
    println!("cargo::rerun-if-env-changed=FINGERTIP_DESIGN");
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-check-cfg=cfg(relaxation)");
    println!(
        "cargo::rustc-check-cfg=cfg(transducer, values(\"ratiometric\", \"abp2\", \"ms5837\", \"dps310\", \"bus\"))"
    );
    println!("cargo::rustc-check-cfg=cfg(part, values(\"abp2\", \"ms5837\", \"dps310\"))");
    println!("cargo::rustc-check-cfg=cfg(multiplexer)");
    println!("cargo::rustc-check-cfg=cfg(object)");
    println!("cargo::rustc-check-cfg=cfg(band)");
    println!("cargo::rustc-check-cfg=cfg(feedback)");
    println!("cargo::rustc-check-cfg=cfg(feedback_tables)");
    println!("cargo::rustc-check-cfg=cfg(hand)");
    println!("cargo::rustc-check-cfg=cfg(tips)");
    if env::var_os("CARGO_FEATURE_TIPS").is_some() {
        println!("cargo::rustc-cfg=tips");
    }
    if loads_tips() {
        // A tip that is loaded may have an actuator.
        println!("cargo::rustc-cfg=feedback");
    }
    if let Err(reason) = build() {
        println!("cargo::error={}", reason.replace('\n', " "));
    }
}

fn build() -> Result<(), String> {
    let for_the_chip = env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("none");
    if for_the_chip {
        link_for_the_chip()?;
    } else {
        // A host reads the band of every board.
        println!("cargo::rustc-cfg=band");
    }
    // Without a design the library is the signal path alone, and nothing is solved.
    if env::var_os("CARGO_FEATURE_DESIGN").is_some() {
        fold_in_the_design(for_the_chip)?;
    }
    Ok(())
}

/// Writes the tables of the design, or says why there are none.
fn fold_in_the_design(for_the_chip: bool) -> Result<(), String> {
    let asked = env::var_os("FINGERTIP_DESIGN");
    let design = design_path(asked.as_deref())?;
    println!("cargo::rerun-if-changed={design}");
    if for_the_chip || asked.is_some() {
        // Cargo compares dates alone, and takes a variable that is not UTF-8 for unset: an older file in the design's
        // place, or such a path, would go unnoticed. What does not exist is always changed, so that this runs, and
        // sees, at every build: 7 s of a processor for an image.
        println!("cargo::rerun-if-changed={design}/always");
    }
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets it"));
    let write =
        |name: &str, text: String| fs::write(out.join(name), text).expect("cargo's folder can be written");
    if fs::read_to_string(design).is_ok_and(|text| is_hand(&text)) {
        let (tables, tips) = hand(Path::new(design))?;
        write("design.rs", tables);
        write("hand.rs", tips);
    } else {
        if for_the_chip && loads_tips() {
            // A block is judged on the stack, its tables blended there.
            println!("cargo::rustc-link-arg-bins=--defsym=_stack_length=0x4000");
        }
        write("design.rs", tables(Path::new(design))?);
    }
    Ok(())
}

fn loads_tips() -> bool {
    env::var_os("CARGO_FEATURE_LOAD_TIP").is_some()
}

/// The Rust source of the tables of a hand, and of its tips; or the reason why there are none.
fn hand(path: &Path) -> Result<(String, String), String> {
    let named = |reason: &str| format!("{}: {reason}", path.display());
    let file = HandFile::read(path).map_err(|error| error.to_string())?;
    if loads_tips() {
        expect_slots(file.tips.len()).map_err(|reason| named(&reason))?;
    }
    for tip in &file.tips {
        println!("cargo::rerun-if-changed={}", tip.design.display());
    }
    let designs = file.designs().map_err(|error| error.to_string())?;
    println!("cargo::rustc-cfg=hand");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("none") {
        // Its tips are made on the stack; with `load-tip` a block is judged there too, its tables blended.
        let length = if loads_tips() { "0x9000" } else { "0x4000" };
        println!("cargo::rustc-link-arg-bins=--defsym=_stack_length={length}");
    }
    println!("cargo::rustc-cfg=tips");
    let board = chosen_board().map_or(BOARDS[0].0, |(board, ..)| board);
    let other = SET_UPS.iter().find(|(name, _)| *name == board);
    let set_up = other.map_or(SET_UP, |(_, set_up)| *set_up);
    let round = BusRound::of(&file, &designs, set_up).map_err(|error| error.to_string())?;
    if loads_tips() && round.is_some() {
        return Err(named(
            "its parts are on a bus, and the tip files of a hand are of analogue tips: build it without the feature load-tip",
        ));
    }
    let of_the_kind = match &round {
        None => scanned(&file),
        Some(round) => on_the_bus(&file, &designs, round),
    };
    let names: Vec<&str> = file.tips.iter().map(|tip| tip.name.as_str()).collect();
    let tips = file.tips.len();
    let mut source = format!(
        "/// The hand's name.\npub const NAME: &str = {:?};\n\
         /// Hash of its tips, where they are, and their designs.\npub const HASH: u64 = {};\n\
         /// Its tips.\npub const TIPS: usize = {tips};\n\
         /// Their names.\npub const TIP_NAMES: [&str; TIPS] = {names:?};\n\
         /// What their stored calibrations are for: hashes of each tip's name, place and design.\npub const TIP_HASHES: [u64; TIPS] = {:?};\n\
         {of_the_kind}",
        file.name,
        file.hash(&designs),
        file.tip_hashes(&designs),
    );
    // Tips of one design share its tables and its code.
    let mut different: Vec<&DesignFile> = Vec::new();
    let (mut list, mut of_tips) = (String::new(), String::new());
    let mut object = false;
    for (number, (tip, design)) in file.tips.iter().zip(&designs).enumerate() {
        let known = different.iter().position(|other| other.hash() == design.hash());
        let which = known.unwrap_or(different.len());
        let _ = writeln!(of_tips, "        tip_{number} Design{which},");
        if known.is_some() {
            continue;
        }
        different.push(design);
        let generated = generated(&tip.design)?;
        if generated.certified.feedback.is_some() {
            return Err(format!(
                "{}: the frames of a hand have no feedback force: leave actuator.thickness_mm out",
                tip.design.display()
            ));
        }
        let wall = if generated.wall().is_some() {
            "relaxing"
        } else {
            "elastic"
        };
        let touched = if generated.certified.object.is_some() {
            object = true;
            tell_band(&generated);
            "object"
        } else {
            "plate"
        };
        let _ = writeln!(
            list,
            "        Design{which} Plate{which} design_{which} {wall} {touched},"
        );
        let _ = write!(
            source,
            "/// A design.\npub mod design_{which} {{\n{}}}\n",
            generated.rust_source()
        );
    }
    if object {
        println!("cargo::rustc-cfg=object");
    }
    let tips = format!("hand! {{\n    designs {{\n{list}    }}\n    tips {{\n{of_tips}    }}\n}}\n");
    Ok((source, tips))
}

/// What the image of a hand on the converter has to know of its scans.
fn scanned(file: &HandFile) -> String {
    println!("cargo::rustc-cfg=transducer=\"ratiometric\"");
    let channel = |place| match place {
        TransducerPlace::Channel(channel) => Some(channel),
        TransducerPlace::Bus { .. } => None,
    };
    let channels: Vec<u8> = file.tips.iter().filter_map(|tip| channel(tip.place)).collect();
    let reference = chosen_board().map_or(BOARDS[0].2, |(_, _, reference)| reference);
    let scan = CONVERSION * channels.len() as u32 + reference;
    // Two scans are a row of words where their codes are an odd number.
    let step = if channels.len().is_multiple_of(2) { 2 } else { 1 };
    let scans = (BLOCK + step * scan / 2) / (step * scan) * step;
    format!(
        "/// Their channels.\npub const CHANNELS: [u8; TIPS] = {channels:?};\n\
         /// Scans of a block.\npub const SCANS: usize = {scans};\n\
         /// From one block to the next, microseconds.\npub const PERIOD: u32 = {};\n",
        scans * scan
    )
}

/// What the image of a hand on the bus has to know of its parts and their rounds.
fn on_the_bus(file: &HandFile, designs: &[DesignFile], round: &BusRound) -> String {
    println!("cargo::rustc-cfg=transducer=\"bus\"");
    let kinds: BTreeSet<&str> = designs
        .iter()
        .filter_map(|design| match design.transducer.as_ref()?.kind {
            TransducerKindSection::Ratiometric { .. } => None,
            TransducerKindSection::Abp2 { .. } => Some("abp2"),
            TransducerKindSection::Ms5837 => Some("ms5837"),
            TransducerKindSection::Dps310 { .. } => Some("dps310"),
        })
        .collect();
    for kind in kinds {
        // Only the drivers of these kinds get into the image.
        println!("cargo::rustc-cfg=part=\"{kind}\"");
    }
    let branches: Vec<Option<[u8; 2]>> = round
        .parts
        .iter()
        .map(|part| part.branch.map(|branch| [branch.multiplexer, branch.number]))
        .collect();
    if branches.iter().any(Option::is_some) {
        println!("cargo::rustc-cfg=multiplexer");
    }
    // Cargo shows it with -vv.
    println!(
        "hand {}: a round of {} parts in {} us",
        file.name,
        round.parts.len(),
        round.period
    );
    let addresses: Vec<u8> = round.parts.iter().map(|part| part.address).collect();
    format!(
        "/// The addresses of their parts.\npub const ADDRESSES: [u8; TIPS] = {addresses:?};\n\
         /// The address and the channel of the multiplexer of each, if it is behind one.\n\
         pub const BRANCHES: [Option<[u8; 2]>; TIPS] = {branches:?};\n\
         /// From one round to the next, microseconds.\npub const PERIOD: u32 = {};\n\
         /// From the beginning of a round to its instant, and how far a part may be from that, microseconds.\n\
         pub const INSTANT: [u32; 2] = [{}, {}];\n\
         /// From the beginning of a round to that of each part, microseconds.\npub const BEGINS: [u32; TIPS] = {:?};\n\
         /// Half of the conversion of each, microseconds.\npub const HALVES: [u32; TIPS] = {:?};\n",
        round.period, round.instant, round.skew, round.begins, round.halves
    )
}

/// Whether the board can take the tips of a hand while it is measured; why not.
fn expect_slots(tips: usize) -> Result<(), String> {
    let slots = match chosen_board() {
        Ok(("nucleo-l432kc", ..)) => {
            return Err(
                "the one bank of the nucleo-l432kc's flash stands still for 75 ms while a slot of three pages is erased, and with it all \
                 tips: build it without the feature load-tip, or for the nucleo-f429zi"
                    .to_owned(),
            );
        }
        _ => 10,
    };
    if 2 * tips > slots {
        return Err(format!(
            "its {tips} tips would need {} slots of flash, two a tip, and the board keeps {slots}: leave {} of them out, or build it \
             without the feature load-tip",
            2 * tips,
            tips - slots / 2
        ));
    }
    Ok(())
}

/// The design file: what `FINGERTIP_DESIGN` asks for, or the default. The build script runs in the folder of its
/// package, which is the workspace root.
fn design_path(asked: Option<&OsStr>) -> Result<&str, String> {
    let Some(asked) = asked else {
        return Ok(DEFAULT_DESIGN);
    };
    let path = asked.to_str().ok_or_else(|| {
        format!(
            "FINGERTIP_DESIGN={} is not UTF-8: rename the file or its folder",
            asked.display()
        )
    })?;
    if path.is_empty() {
        return Err(
            "FINGERTIP_DESIGN is empty: give a design file, or unset it for the default design".into(),
        );
    }
    if !Path::new(path).is_file() {
        return Err(format!(
            "FINGERTIP_DESIGN={path} is no file: give a design file, absolute or relative to the workspace root"
        ));
    }
    Ok(path)
}

/// The tables of a design, or the reason why there are none.
fn generated(design: &Path) -> Result<Generated, String> {
    let named = |reason: String| format!("{}: {reason}", design.display());
    let generated = generate::from_design_file(design).map_err(|error| match error {
        // These name the file themselves.
        GenerateError::File(error) => error.to_string(),
        error => named(error.to_string()),
    })?;
    if generated.limits() != [AccuracyLimit::Accuracy; 2] {
        println!("cargo::warning={}: {}", design.display(), generated.choice());
    }
    if let Some(error) = generated.own_error() {
        // Cargo shows it with -vv, and the certificate has it.
        println!("{}: {error}", design.display());
    }
    Ok(generated)
}

/// The Rust source of the tables, or the reason why there are none.
fn tables(design: &Path) -> Result<String, String> {
    let generated = generated(design)?;
    // Only the driver of this kind gets into the image.
    let kind = match generated.transducer().kind {
        TransducerKind::Ratiometric { .. } => "ratiometric",
        TransducerKind::Abp2 { .. } => "abp2",
        TransducerKind::Ms5837 { .. } => "ms5837",
        TransducerKind::Dps310 { .. } => "dps310",
    };
    println!("cargo::rustc-cfg=transducer=\"{kind}\"");
    if generated.wall().is_some() {
        // The wall's memory, which an elastic one has not.
        println!("cargo::rustc-cfg=relaxation");
    }
    if generated.certified.object.is_some() {
        // Tables of other objects than a plate, and the command that says which.
        println!("cargo::rustc-cfg=object");
        tell_band(&generated);
    }
    if generated.certified.feedback.is_some() {
        // The force of the feedback actuator, and its place in a reading.
        println!("cargo::rustc-cfg=feedback_tables");
        if !loads_tips() {
            println!("cargo::rustc-cfg=feedback");
        }
    }
    Ok(generated.rust_source())
}

/// Has the image send the band of a design that is not told what it touches.
fn tell_band(generated: &Generated) {
    if generated.chip_band().is_some() {
        println!("cargo::rustc-cfg=band");
    }
}

/// The board of the build; the reason where it is not one.
fn chosen_board() -> Result<(&'static str, Option<&'static str>, u32), String> {
    let feature = |board: &str| board.to_uppercase().replace('-', "_");
    let chosen = |board: &str| env::var_os(format!("CARGO_FEATURE_BOARD_{}", feature(board))).is_some();
    let boards: Vec<_> = BOARDS.iter().filter(|(board, ..)| chosen(board)).collect();
    if let [board] = boards[..] {
        return Ok(*board);
    }
    let known = BOARDS.map(|(board, ..)| format!("board-{board}")).join(" or ");
    Err(format!(
        "{} boards are chosen: choose one, with --package fingertip --no-default-features --features {known}",
        boards.len()
    ))
}

fn link_for_the_chip() -> Result<(), String> {
    let (_, sizes, _) = chosen_board()?;
    let root = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets it"));
    println!("cargo::rerun-if-changed=memory.x");
    println!("cargo::rustc-link-search={}", root.display());
    if let Some(sizes) = sizes {
        // Come first, and so before those of memory.x.
        println!("cargo::rerun-if-changed={sizes}");
        println!("cargo::rustc-link-arg-bins=-T{}", root.join(sizes).display());
    }
    for argument in ["--nmagic", "-Tlink.x", "-Tdefmt.x"] {
        println!("cargo::rustc-link-arg-bins={argument}");
    }
    Ok(())
}
