//! Contact force and indentation of a fluid-filled fingertip, from the pressure in its fluid.
//!
//! A sample's way: [`transducer`] -> [`signal`] -> [`link`], and what accompanies it: [`storage`] and [`device`].
//!
//! | module | what | imports |
//! |---|---|---|
//! | [`units`] | the quantities between the stages | |
//! | [`status`] | why there is no reading, and what qualifies one | |
//! | [`transducer`] | a part's words -> pressure | `units`, `status` |
//! | [`signal`] | pressure -> force and indentation with their 1-sigma | and `transducer` |
//! | [`link`] | reports and commands as bytes | and `signal` |
//! | [`storage`] | the calibration in flash | and `link` |
//! | [`device`] | commands, resets, tasks that must report | all of these |
//! | `image` | the design that this build is for (feature `design`), or the tips of a hand | and `signal`, of a hand `device` |
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
