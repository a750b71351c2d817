//! Hyperelastic laws of an incompressible membrane.

/// Strain-energy density of the membrane, with its constants in pascals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// `W = C1 (I1 - 3)`.
    NeoHookean {
        /// `C1`, pascals.
        c1: f64,
    },
    /// `W = C1 (I1 - 3) + C2 (I2 - 3)`.
    MooneyRivlin {
        /// `C1`, pascals.
        c1: f64,
        /// `C2`, pascals.
        c2: f64,
    },
    /// `W = C1 (I1 - 3) + C2 (I1 - 3)^2 + C3 (I1 - 3)^3`.
    Yeoh {
        /// `C1`, pascals.
        c1: f64,
        /// `C2`, pascals.
        c2: f64,
        /// `C3`, pascals.
        c3: f64,
    },
}
