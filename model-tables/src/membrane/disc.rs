//! A flat round membrane clamped at its rim, inflated: the dome whose axial semi-axis is zero.
//!
//! Without pressure it has no stiffness: its deflection begins with the cube root of the pressure (Hencky, Z. Math. Phys. 63 (1915)
//! 311). The path to a given pressure begins with that solution. It continues in the pole stretch, because the pressure has a
//! maximum if the law softens.

use crate::design::Membrane as Dimensions;
use crate::material::{Hyperelastic, Law, Scaled};
use crate::membrane::adapt::{Adaptive, Graded, Unsolved};
use crate::membrane::closure::{Closure, RestControl};
use crate::membrane::equations::{LocalEquations, PRESSURE, TensionField};
use crate::membrane::press::{FULL, STAGES};
use crate::membrane::state::{self, PressShape, UnitScale};
use core::f64::consts::FRAC_PI_2;
use core::fmt;

/// First coefficient of Hencky's series where Poisson's ratio is 1/2, which fixes the tension at the centre.
const HENCKY: f64 = 1.845;
/// Poisson's ratio of what is incompressible.
const POISSON: f64 = 0.5;
/// Largest strain at the centre that begins with Hencky's solution.
const FIRST_STRAIN: f64 = 0.01;
/// Growth of the strain at the centre in a step, and the largest step.
const GROWTH: f64 = 0.3;
const LARGEST_STEP: f64 = 0.1;
/// Step under which nothing more is found.
const SMALLEST_STEP: f64 = 1e-4;
/// Pole stretch at which the way is given up.
const LARGEST_STRETCH: f64 = 20.0;

/// Why a flat membrane gives no answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FlatMembraneError {
    /// Diameter and thickness are more than 0, and the law has a stiffness.
    NotAMembrane,
    /// A flat membrane has no state without pressure, and none below.
    NotAPressure {
        /// What was asked for, pascals.
        asked: f64,
    },
    /// The pressure has its maximum below.
    BeyondMaximum {
        /// What was asked for, pascals.
        asked: f64,
        /// The maximum, pascals.
        greatest: f64,
    },
    /// The solver failed.
    Unsolved(Unsolved),
}

impl fmt::Display for FlatMembraneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotAMembrane => write!(
                f,
                "a flat membrane has a diameter and a thickness of more than 0, and a law with a stiffness"
            ),
            Self::NotAPressure { asked } => write!(
                f,
                "pressure {} kPa is not possible for a flat membrane: it must be more than 0",
                asked / 1e3
            ),
            Self::BeyondMaximum { asked, greatest } => write!(
                f,
                "pressure {} kPa is beyond the maximum of {:.6} kPa, from which on the flat membrane inflates under less and less; \
                 ask for less, or take a thicker, smaller or stiffer one",
                asked / 1e3,
                greatest / 1e3
            ),
            Self::Unsolved(failure) => write!(f, "the flat membrane's state was not found ({failure})"),
        }
    }
}

impl core::error::Error for FlatMembraneError {}

/// A flat membrane, clamped at its rim.
#[derive(Clone, Debug)]
pub struct FlatMembrane<L = Law> {
    solver: Adaptive<Scaled<L>, STAGES>,
    scale: UnitScale,
    state: Graded<STAGES>,
}

impl<L: Hyperelastic> FlatMembrane<L> {
    /// Of a free diameter and an undeformed thickness in metres.
    ///
    /// # Errors
    /// [`FlatMembraneError::NotAMembrane`].
    pub fn new(diameter: f64, thickness: f64, law: L) -> Result<Self, FlatMembraneError> {
        let modulus = law.shear_modulus();
        if !(modulus > 0.0 && diameter > 0.0 && thickness > 0.0) {
            return Err(FlatMembraneError::NotAMembrane);
        }
        let dimensions = Dimensions {
            radial_semi_axis: 0.5 * diameter,
            axial_semi_axis: 0.0,
            thickness,
        };
        let equations = LocalEquations {
            aspect: 0.0,
            law: Scaled {
                law,
                factor: 1.0 / modulus,
            },
            // Inflated from flat it is taut both ways.
            tension_field: TensionField::Plain,
            curvature: 0.0,
        };
        Ok(Self {
            solver: Adaptive::new(equations, FULL),
            scale: UnitScale::new(&dimensions, modulus),
            state: Graded::BLANK,
        })
    }

    /// The membrane at a gauge pressure in pascals, more than 0 and up to its maximum. `height` is the deflection of the centre.
    ///
    /// # Errors
    /// [`FlatMembraneError`].
    pub fn at_pressure(&mut self, pressure: f64) -> Result<PressShape, FlatMembraneError> {
        if !(pressure > 0.0 && pressure.is_finite()) {
            return Err(FlatMembraneError::NotAPressure { asked: pressure });
        }
        let target = pressure / self.scale.pressure;
        // Of the strain at the centre, q = P a / (E h), E = 3 mu.
        let strain = (1.0 - POISSON) * HENCKY / 4.0 * libm::pow(target / 3.0, 2.0 / 3.0);
        let mut stretch = 1.0 + strain.min(FIRST_STRAIN);
        self.begin(stretch - 1.0);
        self.settle(RestControl::PoleStretch(stretch))
            .map_err(FlatMembraneError::Unsolved)?;
        let mut step = GROWTH * (stretch - 1.0);
        while self.reached() < target {
            let below = (self.state.clone(), self.reached());
            let found = self.settle(RestControl::PoleStretch(stretch + step));
            match found {
                Ok(()) if self.reached() > below.1 => {
                    stretch += step;
                    step = (GROWTH * (stretch - 1.0)).min(LARGEST_STEP);
                    if stretch > LARGEST_STRETCH {
                        return Err(self.beyond(pressure));
                    }
                }
                other => {
                    self.state = below.0;
                    step *= 0.5;
                    if step < SMALLEST_STEP {
                        return Err(match other {
                            Ok(()) => self.beyond(pressure),
                            Err(failure) => FlatMembraneError::Unsolved(failure),
                        });
                    }
                }
            }
        }
        self.settle(RestControl::Pressure(target))
            .map_err(FlatMembraneError::Unsolved)?;
        Ok(state::shape(
            &self.solver.equilibrium,
            &self.scale,
            &self.state.solution,
        ))
    }

    fn beyond(&self, asked: f64) -> FlatMembraneError {
        FlatMembraneError::BeyondMaximum {
            asked,
            greatest: self.reached() * self.scale.pressure,
        }
    }

    fn reached(&self) -> f64 {
        self.state.solution.parameters[PRESSURE]
    }

    fn settle(&mut self, control: RestControl) -> Result<(), Unsolved> {
        self.solver.settle(&mut self.state, &Closure::Clamped(control))
    }

    /// Hencky's solution of a strain at the centre, by the first terms of his series.
    fn begin(&mut self, strain: f64) {
        self.solver.guess_inflated(1.0 + strain, &mut self.state);
        let load = libm::pow(4.0 * strain / ((1.0 - POISSON) * HENCKY), 1.5);
        let unit = 0.25 * libm::pow(load, 2.0 / 3.0);
        let (first, second) = (-1.0 / (HENCKY * HENCKY), -2.0 / 3.0 / libm::pow(HENCKY, 5.0));
        // Radial tension and hoop strain at the square of the radius; the rim does not move.
        let guess = |t: f64| {
            let x = libm::sin(t);
            let s = x * x;
            let radial = unit * (HENCKY + s * (first + s * second));
            [1.0 + strain * (1.0 - s), 3.0 * radial]
        };
        let solution = &mut self.state.solution;
        solution.parameters[PRESSURE] = 3.0 * load;
        solution.stretches.fill([1.0 + strain; STAGES]);
        for e in 0..solution.elements() {
            let span = solution.span(e);
            solution.nodes[e] = guess(span.start);
            for j in 0..STAGES {
                let t = span.start + self.solver.equilibrium.gauss.nodes[j] * span.length;
                solution.stages[e][j] = guess(t);
            }
        }
        let last = solution.elements();
        solution.nodes[last] = guess(FRAC_PI_2);
    }
}
