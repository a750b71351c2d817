//! The solid model of a fingertip: an axisymmetric wall that bends, for thick and unstretched domes.
//!
//! The wall between two half ellipsoids of revolution is an incompressible hyperelastic solid, bonded to a rigid base
//! over its whole rim, filled with fluid and pressed by a rigid, flat, frictionless plate. Finite elements: biquadratic
//! displacement, discontinuous linear pressure. Unlike in the membrane the plate's force is not the fluid's pressure
//! times the contact area: at light touch the wall's bending carries most of it.
//!
//! [`mesh`] (the undeformed wall) -> [`element`] (one element's forces and stiffness), [`fluid`] (the volume inside) and
//! [`plate`] (contact) -> [`front`] (linear equations, column by column) -> [`equilibrium`] (Newton's method) -> [`inflation`] ->
//! [`press`] (states at asked indentations, each from its neighbours on the [`trail`], and the end of the press) -> [`section`] (what is read off along the
//! meridian).

#[cfg(feature = "std")]
pub mod element;
#[cfg(feature = "std")]
pub mod equilibrium;
#[cfg(feature = "std")]
mod error;
#[cfg(feature = "std")]
pub mod fluid;
#[cfg(feature = "std")]
pub mod front;
#[cfg(feature = "std")]
pub mod inflation;
#[cfg(feature = "std")]
pub mod mesh;
#[cfg(feature = "std")]
pub mod plate;
#[cfg(feature = "std")]
pub mod press;
#[cfg(feature = "std")]
pub mod section;
#[cfg(feature = "std")]
pub mod trail;

#[cfg(feature = "std")]
pub use error::SolidError;

use core::fmt;

/// Why a state of the solid was not found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Failure {
    /// Every step on the way turns an element inside out.
    InsideOut,
    /// The equations are singular.
    Singular,
    /// The law softens at strains that the wall reaches, `W' + 2 (I1 - 3) W'' <= 0`, and Newton's method did not converge.
    Softened,
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
            Self::Softened => write!(
                f,
                "the material law softens at strains that the wall reaches: choose constants that hold there, or press less"
            ),
            Self::Stalled { residual } => {
                write!(f, "Newton's method did not converge, residual {residual:.1e}")
            }
        }
    }
}
