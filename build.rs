//! Solves the model of the design and writes its tables; hands the linker its scripts when building for a chip.
//!
//! `FINGERTIP_DESIGN`, relative to the workspace root, chooses the design.

use model_tables::constants::TransducerKind;
use model_tables::generate::{self, AccuracyLimit, GenerateError};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::{env, fs};

const DEFAULT_DESIGN: &str = "model-tables/designs/index-fingertip-elastic.toml";

/// Each board with the linker's sizes of its chip; those of the default board are in `memory.x`.
const BOARDS: [(&str, Option<&str>); 2] = [
    ("nucleo-f429zi", None),
    ("nucleo-l432kc", Some("src/board/nucleo_l432kc.x")),
];

fn main() {
    println!("cargo::rerun-if-env-changed=FINGERTIP_DESIGN");
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-check-cfg=cfg(relaxation)");
    println!(
        "cargo::rustc-check-cfg=cfg(transducer, values(\"ratiometric\", \"abp2\", \"ms5837\", \"dps310\"))"
    );
    println!("cargo::rustc-check-cfg=cfg(object)");
    if let Err(reason) = build() {
        println!("cargo::error={}", reason.replace('\n', " "));
    }
}

fn build() -> Result<(), String> {
    let for_the_chip = env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("none");
    if for_the_chip {
        link_for_the_chip()?;
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
    fs::write(out.join("design.rs"), tables(Path::new(design))?).expect("cargo's folder can be written");
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

/// The Rust source of the tables, or the reason why there are none.
fn tables(design: &Path) -> Result<String, String> {
    let named = |reason: String| format!("{}: {reason}", design.display());
    let generated = generate::from_design_file(design).map_err(|error| match error {
        // These name the file themselves.
        GenerateError::File(error) => error.to_string(),
        error => named(error.to_string()),
    })?;
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
    }
    if generated.limits() != [AccuracyLimit::Accuracy; 2] {
        println!("cargo::warning={}: {}", design.display(), generated.choice());
    }
    if let Some(error) = generated.own_error() {
        // Cargo shows it with -vv, and the certificate has it.
        println!("{}: {error}", design.display());
    }
    Ok(generated.rust_source())
}

fn link_for_the_chip() -> Result<(), String> {
    let feature = |board: &str| board.to_uppercase().replace('-', "_");
    let chosen = |board: &str| env::var_os(format!("CARGO_FEATURE_BOARD_{}", feature(board))).is_some();
    let boards: Vec<_> = BOARDS.iter().filter(|(board, _)| chosen(board)).collect();
    let [(_, sizes)] = boards[..] else {
        let known = BOARDS.map(|(board, _)| format!("board-{board}")).join(" or ");
        return Err(format!(
            "{} boards are chosen: choose one, with --package fingertip --no-default-features --features {known}",
            boards.len()
        ));
    };
    let root = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets it"));
    println!("cargo::rerun-if-changed=memory.x");
    println!("cargo::rustc-link-search={}", root.display());
    if let Some(sizes) = sizes {
        // Come first, and so before those of memory.x.
        println!("cargo::rerun-if-changed={sizes}");
        println!("cargo::rustc-link-arg-bins=-T{}", root.join(sizes).display());
    }
    if env::var_os("CARGO_FEATURE_LOAD_TIP").is_some() {
        // A block is judged on the stack, its tables blended there.
        println!("cargo::rustc-link-arg-bins=--defsym=_stack_length=0x4000");
    }
    for argument in ["--nmagic", "-Tlink.x", "-Tdefmt.x"] {
        println!("cargo::rustc-link-arg-bins={argument}");
    }
    Ok(())
}
