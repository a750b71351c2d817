//! The membrane model of a soft, fluid-filled fingertip and the compact tables made from it.
//!
//! An axisymmetric hyperelastic dome is inflated to its rest state, bonded at its equator to a rigid base, filled with
//! incompressible fluid and pressed by a flat, frictionless plate. The model gives pressure, force, contact, shape
//! and tensions at any indentation up to the end of the press, or says why there is no answer.
//!
//! ```
//! use model_tables::design::{Design, Membrane, RestBy};
//! use model_tables::{material::Law, membrane::TensionField, press::Press};
//!
//! // Metres and pascals: a small dome of Agilus30, inflated to 2.3 times its length at the pole.
//! let design = Design {
//!     membrane: Membrane { radial_semi_axis: 4.5e-3, axial_semi_axis: 2.7e-3, thickness: 1e-3 },
//!     law: Law::MooneyRivlin { c1: 160_355.0, c2: 46_559.0 },
//!     rest: RestBy::PoleStretch(2.3),
//!     compliance: 0.0,
//! };
//! let mut press = Press::new(&design, TensionField::Relaxed)?;
//! let state = press.at_indentation(1.5e-3)?;
//! assert!((state.force - 8.371).abs() < 1e-3, "{} N", state.force);
//! # Ok::<(), model_tables::press::ModelError>(())
//! ```
//!
//! # The way through the crate
//!
//! [`design`] (what the fingertip is) -> [`material`] -> [`membrane`] (the local equations) -> [`equilibrium`]
//! (Newton's method over the [`solver`], which knows no physics) -> [`adapt`] (on a [`mesh`] that fits) -> [`rest`]
//! and [`press`] ([`state`]s of equilibrium) -> [`curve`] (pressure rise -> force and indentation) -> `generate`
//! (fits and certifies) -> [`table`] (integers for the chip, in the quantities of [`units`], beside the
//! [`constants`] of the design). Beside it stands the feedback [`actuator`].
//!
//! With `cli` come `fit` (bench data -> a calibrated design) and `size` (a wanted force -> designs).
//!
//! A law that [`material::Law`] lacks joins by implementing [`material::Hyperelastic`], and is pressed by
//! [`press::Press::inflate`].
//!
//! # Features
//!
//! | feature | default | adds |
//! |---|---|---|
//! | none | | the model, the tables' look-up and their quantities: `no_std`, no allocation, no operating system |
//! | `std` | yes | design files (`design_file`), the curve of a press, the table generator and its certificate (`generate`) |
//! | `cli` | no | calibration (`fit`), sizing (`size`) and the `designer` command line; implies `std` |
//!
//! On a chip: `model-tables = { ..., default-features = false }`. The look-up works in integers alone. The model works in
//! `f64` and keeps everything in one [`press::Press`] of less than 200 kB; a [`press::workspace::Workspace`] keeps that in
//! a static, so that it never passes through the stack.
//!
//! # What it promises
//!
//! - Host mathematics is `f64` in SI units; transcendental functions come from `libm`, so that every host computes the
//!   same bits.
//! - No global state: a [`press::Press`] is `Send` and `Sync`, and as many as wanted run side by side.
//! - No unsafe code; what cannot be solved is a [`press::ModelError`], never a number.
//! - Rust 1.95 or later (`rust-version`), the version it is tested with.
//!
//! How its numbers compare with published ones, and how far a membrane is from a real dome with a wall that bends, is
//! in `PUBLISHED.md` beside the sources.
#![cfg_attr(not(feature = "std"), no_std)]
#![forbid(unsafe_code)]

pub mod actuator;
#[path = "membrane/adapt.rs"]
pub mod adapt;
#[cfg(feature = "std")]
#[path = "../compare/src/campaign/mod.rs"]
pub mod campaign;
pub mod constants;
pub mod curve;
pub mod design;
#[cfg(feature = "std")]
pub mod design_file;
#[cfg(feature = "cli")]
#[path = "../designer/src/commands/mod.rs"]
pub mod designer;
#[path = "membrane/equilibrium.rs"]
pub mod equilibrium;
#[cfg(feature = "cli")]
#[path = "../designer/src/fit/mod.rs"]
pub mod fit;
#[cfg(feature = "std")]
pub mod generate;
#[path = "membrane/history.rs"]
pub mod history;
#[path = "membrane/inflation.rs"]
pub mod inflation;
#[path = "../compare/src/lookups.rs"]
pub mod lookups;
pub mod material;
#[path = "membrane/equations.rs"]
pub mod membrane;
#[path = "membrane/mesh.rs"]
pub mod mesh;
#[cfg(feature = "std")]
#[path = "../compare/src/methods/mod.rs"]
pub mod methods;
#[cfg(feature = "std")]
pub mod monotone;
#[path = "membrane/press/mod.rs"]
pub mod press;
#[cfg(feature = "std")]
mod random;
#[path = "membrane/refine.rs"]
mod refine;
#[path = "membrane/rest.rs"]
pub mod rest;
#[cfg(feature = "std")]
#[path = "model/mod.rs"]
pub mod rung;
#[cfg(feature = "cli")]
#[path = "../designer/src/size/mod.rs"]
pub mod size;
pub mod solid;
#[path = "membrane/solution.rs"]
pub mod solution;
pub mod solver;
#[path = "material/stability.rs"]
pub mod stability;
#[path = "membrane/state.rs"]
pub mod state;
pub mod table;
pub mod units;
#[path = "membrane/wrinkle.rs"]
mod wrinkle;
