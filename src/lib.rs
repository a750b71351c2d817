//! Contact force and indentation of a fluid-filled fingertip, from the pressure in its fluid.
//!
//! Data path: [`transducer`] -> [`signal`] -> [`link`]; beside it: [`storage`] and [`device`].
//!
//! | module | what | imports |
//! |---|---|---|
//! | [`units`] | the quantities between the stages | |
//! | [`status`] | faults (reasons for no reading) and warnings | |
//! | [`transducer`] | codes of a part -> pressure | `units`, `status` |
//! | [`signal`] | pressure -> force and indentation with their 1-sigma | and `transducer` |
//! | [`link`] | reports and commands as bytes | and `signal` |
//! | [`storage`] | the calibration in flash | and `link` |
//! | [`device`] | commands, resets, task monitor | all of these |
//! | `image` | the design of this build (feature `design`), or the tips of a hand | and `signal`, of a hand `device` |
//! | `board` | pins, clocks and interrupts, on the chip only | `units`, `status`, `transducer`, `image` |
//!
//! Integers only. No module but `board` knows a clock or a bus: time and samples are arguments.
#![cfg_attr(not(test), no_std)]
#![cfg_attr(not(target_os = "none"), forbid(unsafe_code))]
// On a chip only denied: the macros of the board's crates bind interrupts.
#![cfg_attr(target_os = "none", deny(unsafe_code))]

pub mod units;

pub mod status;

pub mod transducer;

pub mod signal;

#[cfg(all(feature = "design", not(hand)))]
pub mod image;
#[cfg(all(feature = "design", hand))]
#[path = "image/hand.rs"]
pub mod image;

pub mod link;

pub mod storage;

pub mod device;

#[cfg(target_os = "none")]
pub mod board;
