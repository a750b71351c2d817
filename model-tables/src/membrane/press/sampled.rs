//! A press as a curve.

use super::{MembraneError, Press};
use crate::curve::{Contact, Curve, CurveFailure};
use crate::material::Hyperelastic;

impl<L: Hyperelastic, const S: usize> Press<L, S> {
    /// The curve of a press down to `deepest`, metres: states from a hundred-thousandth of it on, closest at the end. On the
    /// mesh [`CURVE`](super::CURVE), between its states too, the error is below 1e-6 of every value up to 0.98 of the
    /// limit, and below 1e-7 up to 0.6 of it.
    ///
    /// # Errors
    /// As [`Press::at_indentation`], and [`CurveFailure::Shape`] if pressure or force do not grow throughout.
    pub fn curve(&mut self, deepest: f64) -> Result<Curve, CurveFailure<MembraneError>> {
        let points: Result<Vec<Contact>, MembraneError> = curve_depths(deepest)
            .map(|indentation| self.contact_at(indentation))
            .collect();
        Curve::new(points.map_err(CurveFailure::Model)?).map_err(CurveFailure::Shape)
    }
}

/// Indentations of the states of a curve down to `deepest`, metres, increasing.
pub fn curve_depths(deepest: f64) -> impl Iterator<Item = f64> {
    (0..=CURVE_INTERVALS).rev().map(move |k| {
        let back = k as f64 / CURVE_INTERVALS as f64;
        let logarithm = back * (1.0 - CROWDING + CROWDING * back);
        deepest * libm::pow(CURVE_RANGE, -logarithm)
    })
}

/// Intervals between the states of a curve.
const CURVE_INTERVALS: usize = 64;
/// Deepest over shallowest indentation of a curve.
const CURVE_RANGE: f64 = 1e5;
/// How the states crowd towards the deepest: 0 for equal steps in the logarithm of the indentation, 1 for steps that
/// vanish there. Near the limit everything changes with the distance to it, and beyond the last state there is none to
/// lean on.
const CROWDING: f64 = 0.93;
