//! Gauss collocation of a two-component boundary-value problem on one element, condensed to its end points.
//!
//! Unknown on an element `[t_a, t_a + h]` are the values at `S` Gauss points; they satisfy
//! `Y_j = y_a + h sum_k a_jk f(t_k, Y_k)`, and `y_b = y_a + h sum_k b_k f_k` (order `2 S` at the nodes for smooth
//! solutions; Ascher, Mattheij and Russell, *Numerical Solution of Boundary Value Problems*, ch. 5). Newton's
//! equations for the stage values are eliminated element by element, which leaves a linear map from the left
//! end and the parameters to the right end and to two integrals.
//!
//! This module is independent of the physics.

/// Components of the state at a point.
pub const STATES: usize = 2;
/// Scalar parameters of the whole problem.
pub const PARAMETERS: usize = 4;
/// Integrals carried along with the solution.
pub const INTEGRALS: usize = 2;
/// Columns of a linear map: left end, parameters, constant.
pub const COLUMNS: usize = STATES + PARAMETERS + 1;
const CONSTANT: usize = COLUMNS - 1;
/// Largest number of Gauss points an element can have.
pub const MAX_STAGES: usize = 8;

/// Nodes and weights of the `S`-point Gauss collocation method on `[0, 1]`.
#[derive(Clone, Debug)]
pub struct Gauss<const S: usize> {
    /// Nodes `c_j`, over the element's length.
    pub nodes: [f64; S],
    /// Weights `b_j`, dimensionless.
    pub weights: [f64; S],
    /// Stage matrix `a_jk`.
    pub stages: [[f64; S]; S],
    /// `d = b A^-1`: the right end from stage values, `y_b = y_a + sum_k d_k (Y_k - y_a)`.
    pub end: [f64; S],
    /// Barycentric weights of the points `0, c_1, ..., c_S`.
    barycentric: [f64; MAX_STAGES + 1],
}

impl<const S: usize> Default for Gauss<S> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const S: usize> Gauss<S> {
    /// Room for the method.
    pub(crate) const BLANK: Self = Self {
        nodes: [0.0; S],
        weights: [0.0; S],
        stages: [[0.0; S]; S],
        end: [0.0; S],
        barycentric: [0.0; MAX_STAGES + 1],
    };

    /// The method, computed from the roots of the Legendre polynomial of degree `S`.
    ///
    /// # Panics
    /// Unless `S` is 1 to 8.
    #[must_use]
    pub fn new() -> Self {
        assert!(S >= 1 && S <= MAX_STAGES, "one to eight Gauss points");
        let mut nodes = [0.0; S];
        let mut weights = [0.0; S];
        for (j, (node, weight)) in nodes.iter_mut().zip(&mut weights).enumerate() {
            let mut z = libm::cos(core::f64::consts::PI * (j as f64 + 0.75) / (S as f64 + 0.5));
            let mut slope = 1.0;
            for _ in 0..20 {
                let (value, derivative) = legendre(S, z);
                slope = derivative;
                z -= value / derivative;
            }
            *node = 0.5 * (1.0 - z);
            *weight = 1.0 / ((1.0 - z * z) * slope * slope);
        }
        let mut stages = [[0.0; S]; S];
        for (j, row) in stages.iter_mut().enumerate() {
            for (k, a) in row.iter_mut().enumerate() {
                // Exact: the Lagrange polynomial has degree S - 1, the rule integrates 2 S - 1.
                *a = nodes[j]
                    * (0..S)
                        .map(|m| weights[m] * lagrange(&nodes, k, nodes[j] * nodes[m]))
                        .sum::<f64>();
            }
        }
        let mut end = [0.0; S];
        for (k, d) in end.iter_mut().enumerate() {
            // The polynomial through (0, 0) and the stages, at 1: t/c_k times Lagrange's.
            *d = lagrange(&nodes, k, 1.0) / nodes[k];
        }
        let mut barycentric = [0.0; MAX_STAGES + 1];
        for (i, weight) in barycentric.iter_mut().enumerate().take(S + 1) {
            let x = |i: usize| if i == 0 { 0.0 } else { nodes[i - 1] };
            *weight = 1.0 / (0..=S).filter(|&j| j != i).map(|j| x(i) - x(j)).product::<f64>();
        }
        Self {
            nodes,
            weights,
            stages,
            end,
            barycentric,
        }
    }

    /// The last term of the collocation polynomial: the coefficient of Chebyshev's polynomial of degree `S` on the element.
    #[inline]
    pub fn last_term(&self, left: [f64; STATES], stages: &[[f64; STATES]; S]) -> [f64; STATES] {
        // The barycentric weights are those of the divided difference; Chebyshev's polynomial on [0, 1] begins with
        // 2^(2 S - 1) t^S.
        let scale = 2.0 / f64::from(1_u32 << (2 * S));
        let mut term = left.map(|y| self.barycentric[0] * y);
        for (stage, weight) in stages.iter().zip(&self.barycentric[1..]) {
            term[0] += weight * stage[0];
            term[1] += weight * stage[1];
        }
        term.map(|t| scale * t)
    }

    /// The collocation polynomial at `theta` (0 = left end, 1 = right end) of values `left` and `stages`.
    pub fn evaluate(&self, left: [f64; STATES], stages: &[[f64; STATES]; S], theta: f64) -> [f64; STATES] {
        if theta == 0.0 {
            return left;
        }
        let mut sum = self.barycentric[0] / theta;
        let mut value = [sum * left[0], sum * left[1]];
        for (j, stage) in stages.iter().enumerate() {
            let distance = theta - self.nodes[j];
            if distance == 0.0 {
                return *stage;
            }
            let weight = self.barycentric[j + 1] / distance;
            sum += weight;
            value[0] += weight * stage[0];
            value[1] += weight * stage[1];
        }
        [value[0] / sum, value[1] / sum]
    }
}

/// Legendre's polynomial of degree `n` and its derivative at `z`, by the three-term recurrence.
fn legendre(n: usize, z: f64) -> (f64, f64) {
    let (mut before, mut value) = (1.0, z);
    for k in 2..=n {
        let k = k as f64;
        (before, value) = (value, ((2.0 * k - 1.0) * z * value - (k - 1.0) * before) / k);
    }
    (value, n as f64 * (z * value - before) / (z * z - 1.0))
}

/// The `k`-th Lagrange polynomial of `nodes` at `t`.
fn lagrange<const S: usize>(nodes: &[f64; S], k: usize, t: f64) -> f64 {
    (0..S)
        .filter(|&m| m != k)
        .map(|m| (t - nodes[m]) / (nodes[k] - nodes[m]))
        .product()
}

/// Right-hand side, integrands and all their derivatives at one point.
#[derive(Clone, Copy, Debug, Default)]
pub struct GaussPoint {
    /// `f`, the derivative of the dimensionless state.
    pub rate: [f64; STATES],
    /// `df_i/dy_l`.
    pub rate_by_state: [[f64; STATES]; STATES],
    /// `df_i/dt` at fixed state and parameters, dimensionless.
    pub rate_by_position: [f64; STATES],
    /// `df_i/dp_m`, not counting what moves the mesh.
    pub rate_by_parameter: [[f64; PARAMETERS]; STATES],
    /// Integrands, dimensionless.
    pub integrand: [f64; INTEGRALS],
    /// Derivatives of the integrands by state.
    pub integrand_by_state: [[f64; STATES]; INTEGRALS],
    /// Derivatives of the integrands by position, dimensionless.
    pub integrand_by_position: [f64; INTEGRALS],
    /// Derivatives of the integrands by parameter.
    pub integrand_by_parameter: [[f64; PARAMETERS]; INTEGRALS],
}

/// Where an element lies, and how the parameters move it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Span {
    /// Left end, in the dimensionless position.
    pub start: f64,
    /// Length, in the dimensionless position, > 0.
    pub length: f64,
    /// Derivative of `start` by each parameter, dimensionless.
    pub start_by: [f64; PARAMETERS],
    /// Derivative of `length` by each parameter, dimensionless.
    pub length_by: [f64; PARAMETERS],
}

/// An element with its stages eliminated: linear maps of `(dy_a, dp, 1)`.
#[derive(Clone, Copy, Debug)]
pub struct Condensed<const S: usize> {
    /// Change of each stage value.
    pub stages: [[[f64; COLUMNS]; STATES]; S],
    /// `y_a + dy_a` carried to the right end, less the present right end.
    pub end: [[f64; COLUMNS]; STATES],
    /// The integrals over the element: linear part and, in the last column, value.
    pub integrals: [[f64; COLUMNS]; INTEGRALS],
    /// Largest residual of the stage equations, dimensionless.
    pub residual: f64,
}

impl<const S: usize> Condensed<S> {
    /// Room for an element.
    pub(crate) const BLANK: Self = Self {
        stages: [[[0.0; COLUMNS]; STATES]; S],
        end: [[0.0; COLUMNS]; STATES],
        integrals: [[0.0; COLUMNS]; INTEGRALS],
        residual: 0.0,
    };
}

impl<const S: usize> Default for Condensed<S> {
    fn default() -> Self {
        Self::BLANK
    }
}

const ROWS: usize = STATES * MAX_STAGES;

/// Eliminates the stages of one element from Newton's equations. `None` if the stage matrix is singular.
///
/// `left` and `right` are the present values at the ends, `stages` those at the Gauss points and `points` what
/// the equations say there.
pub fn condense<const S: usize>(
    gauss: &Gauss<S>,
    span: &Span,
    left: [f64; STATES],
    right: [f64; STATES],
    stages: &[[f64; STATES]; S],
    points: &[GaussPoint; S],
    into: &mut Condensed<S>,
) -> Option<()> {
    let h = span.length;
    let mut matrix = [[0.0; ROWS]; ROWS];
    let mut sides = [[0.0; COLUMNS]; ROWS];
    // Rate of change of the contribution h f_k with each parameter, and its value.
    let mut forcing = [[[0.0; PARAMETERS + 1]; STATES]; S];
    for (k, point) in points.iter().enumerate() {
        for i in 0..STATES {
            for m in 0..PARAMETERS {
                let position = span.start_by[m] + gauss.nodes[k] * span.length_by[m];
                forcing[k][i][m] = h * (point.rate_by_parameter[i][m] + point.rate_by_position[i] * position)
                    + span.length_by[m] * point.rate[i];
            }
            forcing[k][i][PARAMETERS] = h * point.rate[i];
        }
    }
    let mut residual: f64 = 0.0;
    for j in 0..S {
        for i in 0..STATES {
            let row = STATES * j + i;
            let side = &mut sides[row];
            side[i] = 1.0;
            let mut total = [0.0; PARAMETERS + 1];
            for k in 0..S {
                let a = gauss.stages[j][k];
                for l in 0..STATES {
                    matrix[row][STATES * k + l] = -h * a * points[k].rate_by_state[i][l];
                }
                for (sum, term) in total.iter_mut().zip(&forcing[k][i]) {
                    *sum += a * term;
                }
            }
            matrix[row][row] += 1.0;
            side[STATES..CONSTANT].copy_from_slice(&total[..PARAMETERS]);
            side[CONSTANT] = left[i] + total[PARAMETERS] - stages[j][i];
            residual = residual.max(side[CONSTANT].abs());
        }
    }
    solve::<S>(&mut matrix, &mut sides)?;
    for (k, stage) in into.stages.iter_mut().enumerate() {
        stage.copy_from_slice(&sides[STATES * k..STATES * (k + 1)]);
    }
    let rest = 1.0 - gauss.end.iter().sum::<f64>();
    for i in 0..STATES {
        let mut end = [0.0; COLUMNS];
        end[i] = rest;
        end[CONSTANT] = rest * left[i] - right[i];
        for (k, &d) in gauss.end.iter().enumerate() {
            for (sum, term) in end.iter_mut().zip(&into.stages[k][i]) {
                *sum += d * term;
            }
            end[CONSTANT] += d * stages[k][i];
        }
        into.end[i] = end;
    }
    for i in 0..INTEGRALS {
        let mut total = [0.0; COLUMNS];
        for (k, point) in points.iter().enumerate() {
            let b = gauss.weights[k];
            for l in 0..STATES {
                let factor = b * h * point.integrand_by_state[i][l];
                for (sum, term) in total.iter_mut().zip(&into.stages[k][l]) {
                    *sum += factor * term;
                }
            }
            for m in 0..PARAMETERS {
                let position = span.start_by[m] + gauss.nodes[k] * span.length_by[m];
                total[STATES + m] += b
                    * (h * (point.integrand_by_parameter[i][m] + point.integrand_by_position[i] * position)
                        + span.length_by[m] * point.integrand[i]);
            }
            total[CONSTANT] += b * h * point.integrand[i];
        }
        into.integrals[i] = total;
    }
    into.residual = residual;
    Some(())
}

/// Gaussian elimination with partial pivoting; the solution replaces `sides`.
fn solve<const S: usize>(matrix: &mut [[f64; ROWS]; ROWS], sides: &mut [[f64; COLUMNS]; ROWS]) -> Option<()> {
    let n = STATES * S;
    for k in 0..n {
        let mut pivot = k;
        for row in k + 1..n {
            if matrix[row][k].abs() > matrix[pivot][k].abs() {
                pivot = row;
            }
        }
        if pivot != k {
            matrix.swap(k, pivot);
            sides.swap(k, pivot);
        }
        let reciprocal = 1.0 / matrix[k][k];
        if !reciprocal.is_finite() {
            return None;
        }
        let (done, below) = matrix.split_at_mut(k + 1);
        let (done_sides, below_sides) = sides.split_at_mut(k + 1);
        let (pivot_row, pivot_side) = (&mut done[k], &mut done_sides[k]);
        pivot_row[k] = reciprocal;
        for (row, side) in below.iter_mut().zip(below_sides).take(n - k - 1) {
            let factor = row[k] * reciprocal;
            for (x, y) in row[k + 1..n].iter_mut().zip(&pivot_row[k + 1..n]) {
                *x -= factor * y;
            }
            for (x, y) in side.iter_mut().zip(pivot_side.iter()) {
                *x -= factor * y;
            }
        }
    }
    for k in (0..n).rev() {
        let mut value = sides[k];
        for column in k + 1..n {
            let factor = matrix[k][column];
            for (x, y) in value.iter_mut().zip(&sides[column]) {
                *x -= factor * y;
            }
        }
        for x in &mut value {
            *x *= matrix[k][k];
        }
        sides[k] = value;
    }
    Some(())
}

#[cfg(test)]
mod tests;
