//! Least squares with no negative unknown (Lawson and Hanson 1974).

use nalgebra::{DMatrix, DVector};

/// The unknowns, none negative, for which `matrix * x` is nearest to `target`. Each set of free unknowns is solved by a QR
/// decomposition of its columns, whose condition is the root of that of the normal equations. `None` where columns in use
/// depend on each other.
pub(super) fn non_negative(matrix: &DMatrix<f64>, target: &DVector<f64>) -> Option<DVector<f64>> {
    let n = matrix.ncols();
    let tolerance = 1e-10 * matrix.tr_mul(target).amax().max(f64::MIN_POSITIVE);
    let mut passive: Vec<usize> = Vec::new();
    let mut x = DVector::zeros(n);
    for _ in 0..10 * n {
        let gradient = matrix.tr_mul(&(target - matrix * &x));
        let Some(next) = (0..n)
            .filter(|k| !passive.contains(k) && gradient[*k] > tolerance)
            .max_by(|&a, &b| gradient[a].total_cmp(&gradient[b]))
        else {
            return Some(x);
        };
        passive.push(next);
        loop {
            if passive.len() > matrix.nrows() {
                return None;
            }
            let (q, r) = matrix.select_columns(&passive).qr().unpack();
            let solved = r.solve_upper_triangular(&q.tr_mul(target))?;
            if solved.iter().all(|&value| value > 0.0) {
                x.fill(0.0);
                for (i, &k) in passive.iter().enumerate() {
                    x[k] = solved[i];
                }
                break;
            }
            // As far as it goes until the first unknown is zero, which then stays there.
            let step = passive
                .iter()
                .enumerate()
                .filter(|(i, _)| solved[*i] <= 0.0)
                .map(|(i, &k)| x[k] / (x[k] - solved[i]))
                .fold(1.0, f64::min);
            for (i, &k) in passive.iter().enumerate() {
                x[k] += step * (solved[i] - x[k]);
            }
            passive.retain(|&k| x[k] > 1e-14);
            if passive.is_empty() {
                break;
            }
        }
    }
    Some(x)
}
