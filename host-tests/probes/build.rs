//! Hands the linker its scripts when building for the chip.

use std::env;
use std::path::Path;

/// Bytes of stack of the image that runs the model, for the six or seven copies of a solution (9.3 kB each) that it
/// makes at its deepest. What is left of the RAM just holds a press.
const SOLVER_STACK: u32 = 64 * 1024;

/// The same of the image that compares lookups, for the largest tables that it searches.
const KERNELS_STACK: u32 = 24 * 1024;

fn main() {
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return;
    }
    // The macro of the tests asks for it.
    println!("cargo::rustc-check-cfg=cfg(rust_analyzer)");
    let package = env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets it");
    let root = Path::new(&package).join("../..");
    println!("cargo::rerun-if-changed={}", root.join("memory.x").display());
    println!("cargo::rustc-link-search={}", root.display());
    for board in ["l432kc", "g474re"] {
        if env::var_os(format!("CARGO_FEATURE_BOARD_NUCLEO_{}", board.to_uppercase())).is_some() {
            // Comes first, and so before the sizes of memory.x.
            let sizes = root.join(format!("src/board/nucleo_{board}.x"));
            println!("cargo::rustc-link-arg-bins=-T{}", sizes.display());
        }
    }
    for argument in ["--nmagic", "-Tlink.x", "-Tdefmt.x"] {
        println!("cargo::rustc-link-arg-bins={argument}");
    }
    println!("cargo::rustc-link-arg-bin=board_test=-Tembedded-test.x");
    println!("cargo::rustc-link-arg-bin=kernel_probe=--defsym=_stack_length={KERNELS_STACK}");
    println!("cargo::rustc-link-arg-bin=solver_probe=--defsym=_stack_length={SOLVER_STACK}");
}
