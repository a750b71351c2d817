//! Solves the model of the design and writes its tables; hands the linker its scripts when building for a chip.
//!
//! `FINGERTIP_DESIGN`, relative to the workspace root, chooses the design.

use model_tables::constants::TransducerKind;
use model_tables::generate::{self, GenerateError, Limit};
use std::path::{Path, PathBuf};
use std::{env, fs};

const DEFAULT_DESIGN: &str = "model-tables/designs/index-fingertip.toml";

fn main() {
    println!(
        "cargo::rustc-check-cfg=cfg(transducer, values(\"ratiometric\", \"abp2\", \"ms5837\", \"dps310\"))"
    );
    println!("cargo::rerun-if-changed=build.rs");
    // Without a design the library is a sample's way alone, and nothing is solved.
    if env::var_os("CARGO_FEATURE_DESIGN").is_some() {
        fold_in_the_design();
    }
    if env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("none") {
        let root = env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets it");
        link_for_the_chip(Path::new(&root));
    }
}

/// Writes the tables, or says why there are none.
fn fold_in_the_design() {
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets it"));
    println!("cargo::rerun-if-env-changed=FINGERTIP_DESIGN");
    let design = env::var("FINGERTIP_DESIGN").unwrap_or_else(|_| DEFAULT_DESIGN.into());
    // The build script runs in the folder of its package, which is the workspace root.
    println!("cargo::rerun-if-changed={design}");
    match tables(Path::new(&design)) {
        Ok(source) => fs::write(out.join("design.rs"), source).expect("cargo's folder can be written"),
        Err(reason) => println!("cargo::error={}", reason.replace('\n', " ")),
    }
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
    if generated.limits() != [Limit::Accuracy; 2] {
        println!("cargo::warning={}: {}", design.display(), generated.choice());
    }
    Ok(generated.rust_source())
}

fn link_for_the_chip(root: &Path) {
    println!("cargo::rerun-if-changed=memory.x");
    println!("cargo::rustc-link-search={}", root.display());
    // The default board's chip is the one of memory.x; another one's sizes lie beside its file, and come first.
    if env::var_os("CARGO_FEATURE_BOARD_NUCLEO_L432KC").is_some() {
        let sizes = root.join("src/board/nucleo_l432kc.x");
        println!("cargo::rerun-if-changed={}", sizes.display());
        println!("cargo::rustc-link-arg-bins=-T{}", sizes.display());
    }
    for argument in ["--nmagic", "-Tlink.x", "-Tdefmt.x"] {
        println!("cargo::rustc-link-arg-bins={argument}");
    }
}
