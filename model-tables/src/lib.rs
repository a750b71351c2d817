//! The membrane model of a soft, fluid-filled fingertip and the compact tables made from it.
//!
//! The way through the crate: [`design`] (what the fingertip is) -> [`material`] -> [`membrane`] (the local
//! equations) -> [`equilibrium`] (Newton's method over the [`solver`], which knows no physics) -> [`adapt`] (on a
//! [`mesh`] that fits) -> [`rest`] and [`press`] ([`state`]s of equilibrium) -> [`curve`] (pressure rise -> force and
//! indentation) -> `generate` (fits and certifies) -> [`table`] (integers for the chip, in the quantities of [`units`], beside the [`constants`] of
//! the design).
//!
//! Host mathematics is `f64` in SI units; transcendental functions come from `libm`, so that every host
//! computes the same bits.
#![cfg_attr(not(feature = "std"), no_std)]
#![forbid(unsafe_code)]

pub mod actuator;
pub mod adapt;
pub mod constants;
pub mod curve;
pub mod design;
#[cfg(feature = "std")]
pub mod design_file;
#[cfg(feature = "cli")]
pub mod designer;
pub mod equilibrium;
#[cfg(feature = "std")]
pub mod generate;
pub mod history;
pub mod material;
pub mod membrane;
pub mod mesh;
pub mod press;
pub mod rest;
pub mod solver;
pub mod state;
pub mod table;
pub mod units;
