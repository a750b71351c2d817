//! The membrane model of a soft, fluid-filled fingertip and the compact tables made from it.
//!
//! The way through the crate: [`design`] (what the fingertip is) -> [`material`] -> `membrane` (the
//! equations) -> `rest` and `press` (states of equilibrium) -> [`curve`] (pressure rise -> force and
//! indentation) -> [`table`] (integers for the chip, in the quantities of [`units`], beside the [`constants`] of
//! the design).
//!
//! Host mathematics is `f64` in SI units; transcendental functions come from `libm`, so that every host
//! computes the same bits.
#![cfg_attr(not(feature = "std"), no_std)]
#![forbid(unsafe_code)]

pub mod constants;
pub mod curve;
pub mod design;
#[cfg(feature = "std")]
pub mod design_file;
pub mod material;
pub mod table;
pub mod units;
