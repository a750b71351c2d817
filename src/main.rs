//! The firmware: samples in, one report each millisecond out. The tasks are in `firmware/`, pins and clocks in `board/`.
#![cfg_attr(target_os = "none", no_std, no_main)]
#![deny(unsafe_code)]

#[cfg(target_os = "none")]
mod firmware;

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!(
        "This is the firmware of a board. `cargo flash-board` builds it for the chip and flashes it; `cargo demo` \
         runs it on an emulated one."
    );
    std::process::exit(1);
}
