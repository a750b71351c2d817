//! Least squares from a start of the search, within the bounds: size, aspect, wall and stretch at once.

use super::target::Target;
use super::{FILLED, Start, THICKEST, pressed};
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::storage::Owned;
use nalgebra::{DMatrix, DVector, Dyn, OVector, U4};

/// Step of the differences that stand for derivatives, in logarithms.
const STEP: f64 = 1e-4;
/// How hard a pressure beyond the range, or a strain beyond the tested one, counts.
const BEYOND: f64 = 10.0;
/// The pull towards the start among equals.
const PULL: f64 = 1e-4;

/// Least squares from a start, within the bounds.
pub(super) fn refine(target: &Target, start: &Start) -> Start {
    let problem = Refinement {
        target,
        start,
        at: OVector::from(start.logarithms()),
    };
    let (found, _) = LevenbergMarquardt::new()
        .with_ftol(1e-8)
        .with_xtol(1e-6)
        .with_patience(6)
        .minimize(problem);
    let refined = found.place(&found.at);
    // A place without a press is no answer.
    match pressed(target, &refined.design(target)) {
        Ok(_) => refined,
        Err(_) => *start,
    }
}

struct Refinement<'a> {
    target: &'a Target,
    start: &'a Start,
    at: OVector<f64, U4>,
}

impl Refinement<'_> {
    /// Held within the bounds.
    fn place(&self, at: &OVector<f64, U4>) -> Start {
        let target = self.target;
        let [radial, axial, wall, over_one] = [0, 1, 2, 3].map(|k| libm::exp(at[k]));
        let within = |value: f64, [low, high]: [f64; 2]| value.clamp(low, high);
        let (radial, axial) = (within(radial, target.radial), within(axial, target.axial));
        let thickest = (THICKEST * radial.min(axial)).max(target.wall[0]);
        Start {
            material: self.start.material,
            radial,
            axial,
            wall: within(wall, target.wall).min(thickest),
            stretch: within(1.0 + over_one, target.stretch),
        }
    }

    fn residuals_at(&self, at: &OVector<f64, U4>) -> DVector<f64> {
        let count = self.target.forces.len();
        let mut residuals = DVector::from_element(count + 6, 1e3);
        let design = self.place(at).design(self.target);
        if let Ok((peak, strain, forces)) = pressed(self.target, &design) {
            for (k, (force, wanted)) in forces.iter().zip(&self.target.forces).enumerate() {
                residuals[k] = force / wanted - 1.0;
            }
            let excess = peak / (FILLED * 1e3 * self.target.range_kpa[1]) - 1.0;
            residuals[count] = BEYOND * excess.max(0.0);
            let most = self.start.material.largest_invariant().unwrap_or(f64::INFINITY);
            residuals[count + 5] = BEYOND * (strain / most - 1.0).max(0.0);
            let from = self.start.logarithms();
            for k in 0..4 {
                residuals[count + 1 + k] = PULL * (at[k] - from[k]);
            }
        }
        residuals
    }
}

impl LeastSquaresProblem<f64, Dyn, U4> for Refinement<'_> {
    type ParameterStorage = Owned<f64, U4>;
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, U4>;

    fn set_params(&mut self, at: &OVector<f64, U4>) {
        self.at = *at;
    }

    fn params(&self) -> OVector<f64, U4> {
        self.at
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        Some(self.residuals_at(&self.at))
    }

    fn jacobian(&self) -> Option<nalgebra::OMatrix<f64, Dyn, U4>> {
        let here = self.residuals_at(&self.at);
        let mut jacobian = DMatrix::zeros(here.len(), 4);
        for k in 0..4 {
            let mut there = self.at;
            there[k] += STEP;
            jacobian.set_column(k, &((self.residuals_at(&there) - &here) / STEP));
        }
        Some(jacobian.fixed_columns::<4>(0).into_owned())
    }
}
