//! Matrices of three unknowns.

/// Inverse by cofactors, and the condition in the largest row sum. `None` if it is singular.
pub(super) fn invert(m: &[[f64; 3]; 3]) -> Option<([[f64; 3]; 3], f64)> {
    let cofactor = |i: usize, j: usize| {
        let (a, b) = ((i + 1) % 3, (i + 2) % 3);
        let (c, d) = ((j + 1) % 3, (j + 2) % 3);
        m[a][c] * m[b][d] - m[a][d] * m[b][c]
    };
    let determinant: f64 = (0..3).map(|j| m[0][j] * cofactor(0, j)).sum();
    if determinant == 0.0 || !determinant.is_finite() {
        return None;
    }
    let mut inverse = [[0.0; 3]; 3];
    for (i, row) in inverse.iter_mut().enumerate() {
        for (j, value) in row.iter_mut().enumerate() {
            *value = cofactor(j, i) / determinant;
        }
    }
    let norm = |m: &[[f64; 3]; 3]| {
        m.iter()
            .map(|row| row.iter().map(|x| x.abs()).sum::<f64>())
            .fold(0.0, f64::max)
    };
    Some((inverse, norm(m) * norm(&inverse)))
}
