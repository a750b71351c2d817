//! The solid model of a fingertip: an axisymmetric wall that bends, for thick and unstretched domes.
//!
//! The wall between two half ellipsoids of revolution is an incompressible hyperelastic solid, bonded to a rigid base over its
//! whole rim, filled with fluid and pressed by a rigid, flat, frictionless plate. Finite elements: biquadratic displacement,
//! discontinuous linear pressure. Unlike in the membrane, the plate's force is not the fluid's pressure times the contact area:
//! at light touch the wall's bending carries most of it.
//!
//! [`mesh`] (the undeformed wall) -> [`element`] (the mechanics of a point) -> [`batch`] (forces and stiffness of four elements
//! side by side, in [`lanes`]), [`fluid`] (the volume inside) and [`object`] with [`plate`] and `friction` (contact) ->
//! [`frontal`] (linear equations, column by column) -> [`equilibrium`] (Newton's method) -> [`inflation`] -> [`path`] (the
//! [`station`]s of a press from rest, and its end) -> [`press`] (asked states, in SI units, and by `branch` those beside the
//! path) -> [`section`] (quantities along the meridian). [`disc`] is the feedback actuator, a flat wall under the fluid's
//! pressure. [`gas`] is the gas trapped in the line to it.
#![cfg_attr(
    feature = "std",
    expect(
        clippy::inline_always,
        reason = "four elements side by side are vector instructions only where every step of a point is one function"
    )
)]

#[cfg(feature = "std")]
mod assembly;
#[cfg(feature = "std")]
pub mod batch;
#[cfg(feature = "std")]
mod branch;
#[cfg(feature = "std")]
pub mod disc;
#[cfg(feature = "std")]
pub mod element;
#[cfg(feature = "std")]
pub mod equilibrium;
#[cfg(feature = "std")]
mod error;
#[cfg(feature = "std")]
pub mod fluid;
#[cfg(feature = "std")]
mod friction;
#[cfg(feature = "std")]
pub mod frontal;
#[cfg(feature = "std")]
pub mod gas;
#[cfg(feature = "std")]
pub mod history;
#[cfg(feature = "std")]
pub mod inflation;
#[cfg(feature = "std")]
pub mod lanes;
#[cfg(feature = "std")]
mod memory;
#[cfg(feature = "std")]
pub mod mesh;
#[cfg(feature = "std")]
pub mod object;
#[cfg(feature = "std")]
pub mod path;
#[cfg(feature = "std")]
pub mod plate;
#[cfg(feature = "std")]
pub mod press;
#[cfg(feature = "std")]
pub mod section;
#[cfg(feature = "std")]
pub mod state;
#[cfg(feature = "std")]
pub mod station;

#[cfg(feature = "std")]
pub use error::SolidError;

use core::fmt;

/// Reasons why a state of the solid was not found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Failure {
    /// Every step on the way turns an element inside out.
    InsideOut,
    /// The equations are singular.
    Singular,
    /// The state in balance that was found is not on the path from rest.
    Elsewhere,
    /// Newton's method did not converge.
    Stalled {
        /// Largest unbalanced force, in moduli times outer radius times wall thickness.
        residual: f64,
    },
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::InsideOut => write!(f, "the wall folded onto itself"),
            Self::Singular => write!(f, "the equations became singular"),
            Self::Elsewhere => write!(f, "the next state in balance is not on the path from rest"),
            Self::Stalled { residual } => {
                write!(f, "Newton's method did not converge, residual {residual:.1e}")
            }
        }
    }
}
