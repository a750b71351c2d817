//! The condition that selects a state of equilibrium, and the outcome of the search for it.

/// Condition that fixes a rest state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RestControl {
    /// The stretch of the pole.
    PoleStretch(f64),
    /// The pressure.
    Pressure(f64),
    /// The hoop stretch of the equator (its radius over `a0`).
    EquatorStretch(f64),
    /// The height.
    Height(f64),
}

/// Condition that selects a pressed state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PressControl {
    /// The contact parameter `t_c`.
    ContactParameter(f64),
    /// The deformed contact radius.
    ContactRadius(f64),
    /// The height left under the plate.
    Height(f64),
}

/// The equations that close a chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Closure {
    /// Not pressed: the equator's tangent is vertical.
    Rest(RestControl),
    /// Not pressed, of a flat membrane: the equator clamped where it is undeformed.
    Clamped(RestControl),
    /// Pressed, the equator clamped at its rest radius.
    Press {
        /// What selects the state.
        control: PressControl,
        /// Hoop stretch of the clamped equator.
        equator_stretch: f64,
        /// `V + compliance P` of the rest state.
        fluid: f64,
        /// Compliance.
        compliance: f64,
    },
}

/// The direction in which an unpressed state goes on inflating while its edge is held: derivatives by the stretch of the
/// pole, dimensionless.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosureTangent {
    /// Derivative of the dimensionless pressure.
    pub pressure: f64,
    /// Derivative of the dimensionless volume.
    pub volume: f64,
    /// Derivative of the dimensionless height.
    pub height: f64,
}

/// How Newton's method ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NewtonOutcome {
    /// The step became negligible.
    Converged {
        /// Iterations taken.
        iterations: u32,
        /// Largest residual of the collocation equations before the last step.
        residual: f64,
        /// Size of the last step, relative to the solution.
        step: f64,
    },
    /// An iterate left what a membrane can be: no tension in the free zone, or an unstable law.
    Inadmissible {
        /// Iterations taken.
        iterations: u32,
        /// Where on the meridian.
        position: f64,
    },
    /// Newton's matrix is singular.
    Singular {
        /// Iterations taken.
        iterations: u32,
    },
    /// The iterations ran out.
    Stalled {
        /// Size of the last step, relative to the solution.
        step: f64,
    },
}

impl NewtonOutcome {
    /// Whether there is a solution.
    pub fn converged(&self) -> bool {
        matches!(self, Self::Converged { .. })
    }
}
