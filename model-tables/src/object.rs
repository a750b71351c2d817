//! The object that a fingertip touches: a rigid body of revolution on its axis, in SI units.

/// A rigid object and its friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Object {
    /// Its shape.
    pub shape: Shape,
    /// Its friction on the wall.
    pub friction: Friction,
}

/// A rigid shape; its apex is the point that faces the fingertip's pole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A flat plate.
    Plate,
    /// A ball.
    Ball {
        /// Its radius, metres, > 0.
        radius: f64,
    },
    /// A hollow that is part of a sphere.
    Cup {
        /// Its radius, metres, > 0.
        radius: f64,
    },
    /// A cylinder across the tip, such as a pen. It has no axial symmetry.
    Cylinder {
        /// Its radius, metres, > 0.
        radius: f64,
    },
    /// A flat-ended round bar with a rounded rim, such as a coin.
    Punch {
        /// Outer radius, metres, > 0.
        radius: f64,
        /// Radius of the rim's fillet, metres, > 0 and at most `radius`.
        rim: f64,
    },
}

/// Friction between object and wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Friction {
    /// Coulomb's law; the coefficient, >= 0.
    Coulomb(f64),
    /// What touches does not slide.
    Stick,
}

impl Friction {
    /// No friction.
    pub const NONE: Self = Self::Coulomb(0.0);
}

impl Object {
    /// A flat, frictionless plate.
    pub const PLATE: Self = Self {
        shape: Shape::Plate,
        friction: Friction::NONE,
    };
}
