//! A press as a curve.

use super::{ModelError, Press};
use crate::curve::{Curve, CurveError};
use crate::material::Hyperelastic;
use std::fmt;

impl<L: Hyperelastic, const S: usize> Press<L, S> {
    /// The curve of a press down to `deepest`, metres: states from `deepest * 1e-6` on.
    ///
    /// # Errors
    /// As [`Press::at_indentation`], and [`CurveFailure::Shape`] if pressure or force do not grow throughout.
    pub fn curve(&mut self, deepest: f64) -> Result<Curve, CurveFailure> {
        let mut points = Vec::new();
        for k in 0..=CURVE_STATES {
            let ratio = k as f64 / CURVE_STATES as f64;
            let indentation = deepest * libm::pow(CURVE_RANGE, ratio - 1.0);
            points.push(self.contact_at(indentation).map_err(CurveFailure::Model)?);
        }
        Curve::new(points).map_err(CurveFailure::Shape)
    }
}

/// States of a curve.
const CURVE_STATES: usize = 96;
/// Deepest over shallowest indentation of a curve.
const CURVE_RANGE: f64 = 1e5;

/// Why there is no curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CurveFailure {
    /// A state is missing.
    Model(ModelError),
    /// Pressure or force do not grow with indentation.
    Shape(CurveError),
}

impl fmt::Display for CurveFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Model(error) => error.fmt(f),
            Self::Shape(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for CurveFailure {}
