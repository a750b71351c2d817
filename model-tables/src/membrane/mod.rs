//! The membrane model: a wall so thin that it carries tension alone.
//!
//! [`equations`] (the local equations along the meridian) -> [`equilibrium`] (with a [`closure`], Newton's method over the
//! [`solver`](crate::solver)) -> [`adapt`] (on a [`mesh`] that fits the [`solution`]) -> [`inflation`] and [`rest`] (the rest
//! state) -> [`press`] (states at given indentations, started from the [`continuation`] of earlier ones, and the end of the press)
//! -> [`state`] (quantities in SI units). [`disc`] is the dome without height: a flat membrane, clamped at its rim.

pub mod adapt;
pub mod closure;
pub mod continuation;
pub mod disc;
pub mod equations;
pub mod equilibrium;
pub mod inflation;
pub mod mesh;
pub mod press;
mod refine;
pub mod rest;
pub mod solution;
pub mod state;
mod wrinkle;

pub use equations::{TensionField, Zone};
