//! Static memory for a press.
//!
//! A [`Press`] is larger than the stack of most chips. A workspace is made at compile time, so it can be a static. It inflates and
//! presses in place.

use crate::design::{Membrane as Dimensions, RestBy};
use crate::material::{Hyperelastic, Law, Scaled};
use crate::membrane::adapt::Resolution;
use crate::membrane::adapt::{Adaptive, Graded};
use crate::membrane::continuation::Predictor;
use crate::membrane::equations::{LocalEquations, TensionField};
use crate::membrane::inflation::End;
use crate::membrane::press::{MembraneError, Press, STAGES};
use crate::membrane::rest::{Branch, RestFailure, RestQuantity};
use crate::membrane::state::{self, PressShape, UnitScale};

/// Memory for a press of a membrane of the law `L`, with `S` Gauss points an element.
#[derive(Clone, Debug)]
pub struct Workspace<L = Law, const S: usize = STAGES> {
    press: Press<L, S>,
}

impl<L, const S: usize> Workspace<L, S> {
    /// Nothing inflated yet.
    pub const fn new(law: L) -> Self {
        let membrane = LocalEquations {
            aspect: 1.0,
            law: Scaled { law, factor: 1.0 },
            tension_field: TensionField::Relaxed,
            curvature: 0.0,
        };
        Self {
            press: Press {
                solver: Adaptive::blank(membrane),
                scale: UnitScale::BLANK,
                compliance: 0.0,
                rest: Graded::BLANK,
                rest_shape: PressShape::BLANK,
                branch: Branch::Only,
                predictor: Predictor::new(),
                limit: None,
            },
        }
    }
}

impl<L: Hyperelastic, const S: usize> Workspace<L, S> {
    /// Inflates a membrane to its rest state, in place of whatever was here; `compliance` in cubic metres per pascal.
    ///
    /// # Errors
    /// [`MembraneError::NoRestState`], [`MembraneError::LawUnstable`], [`MembraneError::Unheld`] and
    /// [`MembraneError::RestUnsolved`].
    pub fn inflate(
        &mut self,
        dimensions: &Dimensions,
        rest: RestBy,
        compliance: f64,
        tension_field: TensionField,
        resolution: Resolution,
    ) -> Result<&mut Press<L, S>, MembraneError> {
        let press = &mut self.press;
        let membrane = &mut press.solver.equilibrium.membrane;
        let modulus = membrane.law.law.shear_modulus();
        let scale = UnitScale::new(dimensions, modulus);
        membrane.aspect = dimensions.axial_semi_axis / dimensions.radial_semi_axis;
        membrane.law.factor = 1.0 / modulus;
        membrane.tension_field = tension_field;
        press.solver.set(resolution);
        press.scale = scale;
        press.compliance = compliance * scale.pressure / scale.volume();
        press.predictor.clear();
        press.limit = None;
        match rest {
            RestBy::Unstretched => return Err(MembraneError::Unstretched),
            RestBy::PoleStretch(stretch) => {
                let found = press.solver.rest_by_pole_stretch(stretch, &mut press.rest);
                found.map_err(|end| match end {
                    End::Turns { greatest } => MembraneError::NoRestState {
                        quantity: RestQuantity::PoleStretch,
                        asked: stretch,
                        least: 1.0,
                        greatest,
                    },
                    End::Unstable(margin) => MembraneError::LawUnstable {
                        asked: stretch,
                        margin,
                    },
                    End::Bulges => MembraneError::Unheld {
                        compliance,
                        largest: None,
                    },
                    End::Lost(failure) => MembraneError::RestUnsolved { failure },
                })?;
                press.branch = Branch::Only;
            }
            RestBy::Pressure(pascals) => press.rest_by(RestQuantity::Pressure, pascals, scale.pressure)?,
            RestBy::EquatorRadius(metres) => {
                press.rest_by(RestQuantity::EquatorRadius, metres, scale.length)?;
            }
            RestBy::Height(metres) => press.rest_by(RestQuantity::Height, metres, scale.length)?,
        }
        // `1 + c dP/dV > 0`, or the fluid inflates the dome by itself.
        let held_below = press
            .solver
            .equilibrium
            .tangent(&mut press.rest.solution)
            .map(|tangent| -tangent.volume / tangent.pressure)
            .filter(|&largest| largest > 0.0)
            .map(|largest| largest * scale.volume() / scale.pressure);
        if let Some(largest) = held_below
            && compliance >= largest
        {
            return Err(MembraneError::Unheld {
                compliance,
                largest: Some(largest),
            });
        }
        press.rest_shape = state::shape(&press.solver.equilibrium, &scale, &press.rest.solution);
        Ok(press)
    }

    /// The press by value.
    pub(super) fn into_press(self) -> Press<L, S> {
        self.press
    }
}

impl<L: Hyperelastic, const S: usize> Press<L, S> {
    /// The rest state in which a quantity is `asked`, in its SI `unit`.
    fn rest_by(&mut self, quantity: RestQuantity, asked: f64, unit: f64) -> Result<(), MembraneError> {
        let found = self.solver.rest_by(quantity, asked / unit);
        (self.rest, self.branch) = found.map_err(|failure| match failure {
            RestFailure::OutOfReach { least, greatest, .. } => MembraneError::NoRestState {
                quantity,
                asked,
                least: least * unit,
                greatest: greatest * unit,
            },
            RestFailure::Solver(failure) => MembraneError::RestUnsolved { failure },
        })?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::membrane::press::SWEEP;

    #[test]
    fn a_second_design_finds_nothing_of_the_first() {
        let law = Law::MooneyRivlin {
            c1: 160_355.0,
            c2: 46_559.0,
        };
        let dimensions = Dimensions {
            radial_semi_axis: 4.5e-3,
            axial_semi_axis: 2.7e-3,
            thickness: 1e-3,
        };
        let force = |workspace: &mut Workspace<Law, 5>, stretch: f64| {
            let rest = RestBy::PoleStretch(stretch);
            let press = workspace
                .inflate(&dimensions, rest, 0.0, TensionField::Relaxed, SWEEP)
                .expect("it inflates");
            let force = press.contact_at(0.5e-3).expect("it can be pressed").force;
            (
                force.to_bits(),
                press.iterations(),
                press.rest().pressure.to_bits(),
            )
        };
        let mut used = Workspace::new(law);
        let other = force(&mut used, 1.5);
        let again = force(&mut used, 2.3);
        assert_ne!(other, again);
        assert_eq!(again, force(&mut Workspace::new(law), 2.3));
    }
}
