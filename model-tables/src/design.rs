//! The part of a design that the mathematical model needs, in SI units.

use crate::material::Law;
use crate::object::Object;

/// The undeformed membrane: half an ellipsoid of revolution, bonded to a rigid base at its equator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Membrane {
    /// Radial semi-axis `a0` of the mid-surface, metres, > 0.
    pub radial_semi_axis: f64,
    /// Axial semi-axis `b0` of the mid-surface, metres, > 0.
    pub axial_semi_axis: f64,
    /// Wall thickness `h0`, metres, > 0.
    pub thickness: f64,
}

/// How the rest state (inflated, not pressed) is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RestBy {
    /// Not inflated: a solid wall as it was made. No rest state of a membrane.
    Unstretched,
    /// Stretch of the membrane at its pole, > 1. The only one of the four that is one-to-one.
    PoleStretch(f64),
    /// Gauge pressure, pascals, > 0.
    Pressure(f64),
    /// Deformed radius of the equator, metres.
    EquatorRadius(f64),
    /// Height of the inflated dome over its base, metres.
    Height(f64),
}

/// A fingertip as the model sees it, and what it touches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Design {
    /// The undeformed membrane.
    pub membrane: Membrane,
    /// Its hyperelastic law.
    pub law: Law,
    /// The rest state.
    pub rest: RestBy,
    /// Compliance of tubing, actuator and bubbles, cubic metres per pascal, >= 0
    /// (1 mm^3/kPa = 1e-12 m^3/Pa).
    pub compliance: f64,
    /// What it touches.
    pub object: Object,
}
