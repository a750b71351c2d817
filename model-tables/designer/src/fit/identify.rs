//! What the data can tell: standard errors, correlations, and the directions in which they say nothing.

use super::parameter::Parameter;
use nalgebra::{DMatrix, SVD};

/// A singular value under this part of the largest is none: the parameters act as one.
const DEPENDENT: f64 = 1e-6;
/// A standard deviation, in coordinates, beyond which the data do not say where a direction stands. One is what a
/// parameter could change at all.
const UNIDENTIFIABLE_FROM: f64 = 0.7;
/// Components under this part of the largest do not belong to a direction.
const PART: f64 = 0.3;

/// A combination of parameters that the data do not determine.
#[derive(Clone, Debug, PartialEq)]
pub struct Unidentified {
    /// The parameter that was held because of it.
    pub held: Parameter,
    /// The parameters that move together, with their shares, in coordinates (logarithms of factors).
    pub direction: Vec<(Parameter, f64)>,
    /// Standard deviation along it, in coordinates; infinite where nothing depends on it at all.
    pub deviation: f64,
}

/// The worst direction that the data do not determine, of a Jacobian in standard deviations; `None` if all are told.
/// With `noise` unknown only dependence is found.
pub(super) fn unidentifiable(
    jacobian: &DMatrix<f64>,
    free: &[Parameter],
    noise_known: bool,
) -> Option<Unidentified> {
    let svd = SVD::new(jacobian.clone(), false, true);
    let directions = svd.v_t.as_ref()?;
    let largest = svd.singular_values.max();
    let (least, value) = svd
        .singular_values
        .iter()
        .enumerate()
        .min_by(|a, b| a.1.total_cmp(b.1))?;
    let dependent = *value <= DEPENDENT * largest || free.len() > jacobian.nrows();
    let deviation = if dependent { f64::INFINITY } else { 1.0 / value };
    if !(dependent || (noise_known && deviation > UNIDENTIFIABLE_FROM)) {
        return None;
    }
    let row = directions.row(least);
    let most = row.amax();
    let mut direction: Vec<(Parameter, f64)> = free
        .iter()
        .zip(row.iter())
        .filter(|(_, part)| part.abs() > PART * most)
        .map(|(&parameter, &part)| (parameter, part))
        .collect();
    // Its sign means nothing: the first is made positive.
    let sign = direction.first()?.1.signum();
    for (_, part) in &mut direction {
        *part *= sign;
    }
    let held = direction.iter().map(|(parameter, _)| *parameter).max()?;
    Some(Unidentified {
        held,
        direction,
        deviation,
    })
}

/// Covariance of the coordinates, of a Jacobian and residuals in standard deviations; so many more numbers than its columns were `spent`.
pub(super) fn covariance(
    jacobian: &DMatrix<f64>,
    standardised: &[f64],
    spent: usize,
) -> Option<DMatrix<f64>> {
    let freedom = standardised.len() as f64 - (jacobian.ncols() + spent) as f64;
    if freedom < 1.0 {
        return None;
    }
    let squares: f64 = standardised.iter().map(|r| r * r).sum();
    Some((jacobian.transpose() * jacobian).try_inverse()? * (squares / freedom))
}

/// Correlations of a covariance.
pub(super) fn correlations(covariance: &DMatrix<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(covariance.nrows(), covariance.ncols(), |i, j| {
        covariance[(i, j)] / libm::sqrt(covariance[(i, i)] * covariance[(j, j)])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_parameters_that_act_as_one_and_holds_the_lesser() {
        use Parameter::{Material, PoleStretch, Thickness};
        let jacobian = DMatrix::from_fn(20, 3, |i, j| match j {
            1 => 1.0 + i as f64,
            _ => 30.0 + (i * i) as f64,
        });
        let found =
            unidentifiable(&jacobian, &[Material, PoleStretch, Thickness], false).expect("two act as one");
        assert_eq!(found.held, Thickness);
        assert_eq!(found.direction.len(), 2);
        assert!((found.direction[0].1 + found.direction[1].1).abs() < 1e-9);
        let told = jacobian.remove_column(2);
        assert_eq!(unidentifiable(&told, &[Material, PoleStretch], true), None);
        // So much noise that nothing is left of the difference.
        let drowned =
            unidentifiable(&(told * 1e-4), &[Material, PoleStretch], true).expect("nothing is told");
        assert!(drowned.deviation.is_finite());
    }

    /// A line through points: covariance `sigma^2 (J^T J)^-1` in closed form.
    #[test]
    fn covariance_is_that_of_a_straight_line() {
        let jacobian = DMatrix::from_fn(11, 2, |i, j| if j == 0 { 1.0 } else { i as f64 - 5.0 });
        let residuals: Vec<f64> = (0..11).map(|i| if i % 2 == 0 { 0.3 } else { -0.3 }).collect();
        let found = covariance(&jacobian, &residuals, 0).expect("enough points");
        let variance = 11.0 * 0.09 / 9.0;
        assert!((found[(0, 0)] - variance / 11.0).abs() < 1e-12);
        assert!((found[(1, 1)] - variance / 110.0).abs() < 1e-12);
        assert!(correlations(&found)[(0, 1)].abs() < 1e-12);
    }
}
