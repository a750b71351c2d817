//! The models of a soft, fluid-filled fingertip, membrane and solid, and the compact tables made from them.
//!
//! An axisymmetric hyperelastic dome is bonded at its equator to a rigid base, filled with incompressible fluid, inflated or not, and
//! pressed by a plate, a ball, a cup or a punch. The models give pressure, force, contact and shape at any indentation up to the end of
//! the press, or say why there is no answer.
//!
//! ```
//! use model_tables::design::{Design, Membrane, RestBy};
//! use model_tables::object::Object;
//! use model_tables::{material::Law, membrane::TensionField, membrane::press::Press};
//!
//! // Metres and pascals: a small dome of Agilus30, stretched to 2.3 at its pole.
//! let design = Design {
//!     membrane: Membrane {
//!         radial_semi_axis: 4.5e-3,
//!         axial_semi_axis: 2.7e-3,
//!         thickness: 1e-3,
//!     },
//!     law: Law::MooneyRivlin { c1: 160_355.0, c2: 46_559.0 },
//!     rest: RestBy::PoleStretch(2.3),
//!     compliance: 0.0,
//!     object: Object::PLATE,
//! };
//! let mut press = Press::new(&design, TensionField::Relaxed)?;
//! let state = press.at_indentation(1.5e-3)?;
//! assert!((state.force - 8.371).abs() < 1e-3, "{} N", state.force);
//! # Ok::<(), model_tables::membrane::press::MembraneError>(())
//! ```
//!
//! # The way through the crate
//!
//! [`design`] (what the fingertip is) of a [`material`], and the [`object`] that it touches -> [`membrane`] (thin walls) or [`solid`] (walls that bend), with the
//! [`solver`], which knows no physics -> `model` (either of them behind one interface, and which of them a design needs) ->
//! [`curve`] (pressure rise -> force and indentation) -> `generate` (tables and certificate, by `certified_lookup`) -> [`table`] (integers for the
//! chip, in the quantities of [`units`], beside the [`constants`] of the design), or a [`block`] of bytes that is loaded. A design comes from a file by
//! `design_file`. Beside it all stands the feedback [`actuator`].
//!
//! The command line, calibration and sizing are the package `designer`; other ways to solve and to look up, and campaigns,
//! are `compare`.
//!
//! A law that [`material::Law`] lacks joins by implementing [`material::Hyperelastic`], and is pressed by
//! [`membrane::press::Press::inflate`].
//!
//! # Features
//!
//! | feature | default | adds |
//! |---|---|---|
//! | none | | the model, the tables' look-up and their quantities: `no_std`, no allocation, no operating system |
//! | `std` | yes | the solid, design files (`design_file`), the choice of model (`model`), the curve of a press, the table generator and its certificate (`generate`) |
//!
//! On a chip: `model-tables = { ..., default-features = false }`. The look-up works in integers alone. The model works in
//! `f64` and keeps everything in one [`Press`](membrane::press::Press) of less than 200 kB; a [`Workspace`](membrane::press::workspace::Workspace) keeps that in
//! a static, so that it never passes through the stack.
//!
//! # What it promises
//!
//! - Host mathematics is `f64` in SI units; transcendental functions come from `libm`, so that every host computes the
//!   same bits.
//! - No global state: a [`Press`](membrane::press::Press) is `Send` and `Sync`, and as many as wanted run side by side.
//! - No unsafe code; what cannot be solved is an error with its reason ([`MembraneError`](membrane::press::MembraneError)), never a number.
//! - Rust 1.95 or later (`rust-version`), the version it is tested with.
//!
//! How its numbers compare with published ones, and how far a membrane is from a real dome with a wall that bends, is
//! in `PUBLISHED.md` beside the sources.
#![cfg_attr(not(feature = "std"), no_std)]
#![forbid(unsafe_code)]

pub mod actuator;
pub mod block;
pub mod constants;
pub mod curve;
pub mod design;
#[cfg(feature = "std")]
pub mod design_file;
#[cfg(feature = "std")]
pub mod generate;
pub mod limit;
pub mod material;
pub mod membrane;
#[cfg(feature = "std")]
pub mod model;
#[cfg(feature = "std")]
pub mod monotone;
pub mod object;
pub mod random;
pub mod solid;
pub mod solver;
pub mod table;
pub mod units;
