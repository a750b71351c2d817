//! Linear equations of a wall, column of elements by column: `K = L D L'`.
//!
//! A column of elements couples its left, its middle and its right station. The equations are symmetric, so each row is stored from
//! the diagonal on. Left and middle station of a column are eliminated, in order and without pivoting; the remainder on the right
//! station goes into the next column. The last right station is the rim, which does not move. As many entries of `D` are negative
//! as `K` has negative eigenvalues (Sylvester's law of inertia).

use super::lanes::vectorised;

/// Number of rows that are eliminated together. A column has a multiple of it: four rows for each node through the wall.
const BLOCK: usize = 4;

/// A symmetric matrix, and after [`FrontalMatrix::eliminate`] its factors.
#[derive(Clone, Debug)]
pub struct FrontalMatrix {
    /// Unknowns of a station.
    station: usize,
    columns: usize,
    /// Rows of left and middle stations, each as wide as its column; behind them those of the rim.
    matrix: Vec<f64>,
    /// The factors, in the same layout.
    values: Vec<f64>,
    /// The remainder that elimination before a column left on its left station, column by column.
    carried: Vec<f64>,
    /// One over the entries of `D`.
    inverse: Vec<f64>,
}

impl FrontalMatrix {
    /// A matrix for a number of columns.
    pub fn new(station: usize, columns: usize) -> Self {
        let rows = (2 * columns + 1) * station;
        Self {
            station,
            columns,
            matrix: vec![0.0; rows * 3 * station],
            values: vec![0.0; rows * 3 * station],
            carried: vec![0.0; (columns + 1) * station * station],
            inverse: vec![0.0; 2 * columns * station],
        }
    }

    /// Sets all entries to zero.
    pub fn clear(&mut self) {
        self.matrix.fill(0.0);
    }

    /// Entries from one row of a column to the next.
    pub const fn width(station: usize) -> usize {
        3 * station
    }

    /// Where in a column an entry is kept, `row <= other` of the unknowns of its three stations.
    pub fn place(station: usize, row: usize, other: usize) -> usize {
        let width = 3 * station;
        // The right station's rows are the next column's, and begin with it.
        row * width + other - if row < 2 * station { 0 } else { 2 * station }
    }

    /// The entries of a column, of those [`FrontalMatrix::place`]s.
    #[inline]
    pub fn column(&mut self, column: usize) -> &mut [f64] {
        &mut self.matrix[column * 6 * self.station * self.station..]
    }

    /// Holds an unknown of the first station.
    pub fn hold_first(&mut self, unknown: usize) {
        let width = 3 * self.station;
        for row in 0..unknown {
            self.matrix[row * width + unknown] = 0.0;
        }
        self.matrix[unknown * width..(unknown + 1) * width].fill(0.0);
        self.matrix[unknown * width + unknown] = 1.0;
    }

    /// Factors the matrix, of which only columns from one on have changed since the last time; adds to `negative` how many entries of `D`
    /// are that in each of those columns. `None` if it is singular.
    pub fn eliminate(&mut self, from: usize, negative: &mut Vec<usize>) -> Option<()> {
        vectorised(
            #[inline(always)]
            || self.factor(from, negative),
        )
    }

    #[inline(always)]
    fn factor(&mut self, from: usize, negative: &mut Vec<usize>) -> Option<()> {
        let station = self.station;
        let (own, width) = (2 * station, 3 * station);
        for column in from..self.columns {
            let mut falls = 0;
            let column_values = &mut self.values[column * own * width..][..width * width];
            let matrix = &self.matrix[column * own * width..][..own * width];
            column_values[..own * width].copy_from_slice(matrix);
            column_values[own * width..].fill(0.0);
            let carried = &self.carried[column * station * station..][..station * station];
            for (row, carried) in column_values
                .chunks_exact_mut(width)
                .zip(carried.chunks_exact(station))
            {
                for (x, y) in row.iter_mut().zip(carried) {
                    *x += y;
                }
            }
            let inverse = &mut self.inverse[column * own..][..own];
            for first in (0..own).step_by(BLOCK) {
                let (pivots, targets) = column_values[first * width..].split_at_mut(BLOCK * width);
                for i in 0..BLOCK {
                    let (above, row) = pivots.split_at_mut(i * width);
                    let row = &mut row[..width];
                    for (k, above) in above.chunks_exact(width).enumerate() {
                        let factor = above[first + i] * inverse[first + k];
                        for (x, y) in row[first + i..].iter_mut().zip(&above[first + i..]) {
                            *x -= factor * y;
                        }
                    }
                    let pivot = row[first + i];
                    if pivot == 0.0 || !pivot.is_finite() {
                        return None;
                    }
                    falls += usize::from(pivot < 0.0);
                    inverse[first + i] = 1.0 / pivot;
                }
                let inverse: &[f64; BLOCK] = inverse[first..first + BLOCK].try_into().ok()?;
                update(pivots, inverse, targets, width, own, first);
            }
            let carried = &mut self.carried[(column + 1) * station * station..][..station * station];
            let rows = column_values[own * width..].chunks_exact(width);
            for (row, carried) in rows.zip(carried.chunks_exact_mut(station)) {
                carried.copy_from_slice(&row[..station]);
            }
            negative.push(falls);
        }
        Some(())
    }

    /// Solves with the factors, in place: unknowns column by column. Those of the rim are zero.
    pub fn solve(&self, x: &mut [f64]) {
        vectorised(
            #[inline(always)]
            || self.substitute(x),
        );
    }

    #[inline(always)]
    fn substitute(&self, x: &mut [f64]) {
        let (own, width) = (2 * self.station, 3 * self.station);
        let rows = self.columns * own;
        for first in (0..rows).step_by(BLOCK) {
            let (values, behind) = x[first..].split_at_mut(BLOCK);
            let [within, beyond] = self.block(first, own, width);
            let mut scaled = [0.0; BLOCK];
            for k in 0..BLOCK {
                scaled[k] = values[k] * self.inverse[first + k];
                for i in k + 1..BLOCK {
                    values[i] -= within[k][i] * scaled[k];
                }
            }
            let [a, b, c, d] = beyond;
            for (j, x) in behind[..a.len()].iter_mut().enumerate() {
                *x -= scaled[0] * a[j] + scaled[1] * b[j] + scaled[2] * c[j] + scaled[3] * d[j];
            }
        }
        x[rows..].fill(0.0);
        for first in (0..rows).step_by(BLOCK).rev() {
            let (values, behind) = x[first..].split_at_mut(BLOCK);
            let [within, beyond] = self.block(first, own, width);
            let behind = &behind[..beyond[0].len()];
            let sums = beyond.map(|row| dot(row, behind));
            for k in (0..BLOCK).rev() {
                let rest: f64 = (k + 1..BLOCK).map(|i| within[k][i] * values[i]).sum();
                values[k] = (values[k] - sums[k] - rest) * self.inverse[first + k];
            }
        }
    }

    /// Four rows of factors: among themselves, and beyond.
    #[inline(always)]
    fn block(&self, first: usize, own: usize, width: usize) -> [[&[f64]; BLOCK]; 2] {
        let local = first % own;
        let rows: [&[f64]; BLOCK] =
            core::array::from_fn(|k| &self.values[(first + k) * width + local..(first + k + 1) * width]);
        [rows.map(|row| &row[..BLOCK]), rows.map(|row| &row[BLOCK..])]
    }
}

/// Scalar product of two rows of an even length, summed in four parts.
#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (a, b) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest = a.remainder().iter().zip(b.remainder());
    let rest: f64 = rest.map(|(a, b)| a * b).sum();
    for (a, b) in a.zip(b) {
        for i in 0..4 {
            sums[i] += a[i] * b[i];
        }
    }
    (sums[0] + sums[2]) + (sums[1] + sums[3]) + rest
}

/// Takes what four pivot rows are to the rows behind them out of those, two by two.
#[inline(always)]
fn update(
    pivots: &[f64],
    inverse: &[f64; BLOCK],
    targets: &mut [f64],
    width: usize,
    own: usize,
    first: usize,
) {
    let rows: [&[f64]; BLOCK] = core::array::from_fn(|k| &pivots[k * width..(k + 1) * width]);
    for (index, pair) in targets.chunks_exact_mut(2 * width).enumerate() {
        let i = first + BLOCK + 2 * index;
        if i >= width {
            break;
        }
        // The right station's rows begin with their own column.
        let from = if i < own { i } else { i - own };
        let [f, g] = [i, i + 1].map(
            #[inline(always)]
            |i| {
                let [a, b, c, d] = rows;
                [
                    a[i] * inverse[0],
                    b[i] * inverse[1],
                    c[i] * inverse[2],
                    d[i] * inverse[3],
                ]
            },
        );
        let count = width - i;
        let (one, two) = pair.split_at_mut(width);
        let (one, two) = (&mut one[from..from + count], &mut two[from..from + count]);
        let [a, b, c, d] = rows.map(|row| &row[i..i + count]);
        for j in 0..count {
            let y = [a[j], b[j], c[j], d[j]];
            one[j] -= f[0] * y[0] + f[1] * y[1] + f[2] * y[2] + f[3] * y[3];
            two[j] -= g[0] * y[0] + g[1] * y[1] + g[2] * y[2] + g[3] * y[3];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pseudo-random numbers in [-1, 1]: the multiplier of Lehmer's generator.
    fn random(seed: &mut u64) -> f64 {
        *seed = *seed * 48_271 % 2_147_483_647;
        *seed as f64 / 1_073_741_823.5 - 1.0
    }

    const STATION: usize = 6;
    const COLUMNS: usize = 5;
    const UNKNOWNS: usize = 2 * COLUMNS * STATION;

    /// A matrix of sums of random columns, with `diagonal` besides on every unknown that moves, and itself in full.
    fn matrix(diagonal: impl Fn(usize) -> f64) -> (FrontalMatrix, Vec<Vec<f64>>) {
        let mut seed = 7;
        let mut fronts = FrontalMatrix::new(STATION, COLUMNS);
        let mut full = vec![vec![0.0; UNKNOWNS]; UNKNOWNS];
        fronts.clear();
        for column in 0..COLUMNS {
            for i in 0..3 * STATION {
                for j in i..3 * STATION {
                    let (row, other) = (2 * column * STATION + i, 2 * column * STATION + j);
                    let own = if i == j && i < 2 * STATION {
                        diagonal(row)
                    } else {
                        0.0
                    };
                    let value = random(&mut seed) + own;
                    fronts.column(column)[FrontalMatrix::place(STATION, i, j)] += value;
                    if other < UNKNOWNS {
                        full[row][other] += value;
                        if i != j {
                            full[other][row] += value;
                        }
                    }
                }
            }
        }
        (fronts, full)
    }

    fn negative_count(fronts: &mut FrontalMatrix) -> Option<usize> {
        let mut negative = Vec::new();
        fronts.eliminate(0, &mut negative)?;
        Some(negative.iter().sum())
    }

    /// The right-hand side of a known solution gives it back.
    #[test]
    fn solves_what_it_was_given() {
        let (mut fronts, full) = matrix(|_| 20.0);
        let mut seed = 11;
        let known: Vec<f64> = (0..UNKNOWNS).map(|_| random(&mut seed)).collect();
        let mut x: Vec<f64> = full
            .iter()
            .map(|row| row.iter().zip(&known).map(|(a, x)| a * x).sum())
            .collect();
        x.extend([0.0; STATION]);
        assert_eq!(negative_count(&mut fronts), Some(0));
        fronts.solve(&mut x);
        for (found, expected) in x.iter().zip(&known) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }

    /// A change in the middle, factored from there on, gives what factoring all of it does.
    #[test]
    fn a_change_is_factored_from_its_column_on() {
        let (mut fronts, _) = matrix(|_| 20.0);
        assert_eq!(negative_count(&mut fronts), Some(0));
        fronts.column(3)[FrontalMatrix::place(STATION, 1, 8)] += 0.5;
        let mut anew = fronts.clone();
        assert!(fronts.eliminate(3, &mut Vec::new()).is_some() && negative_count(&mut anew).is_some());
        let [mut x, mut y] = [(); 2].map(|()| vec![1.0; UNKNOWNS + STATION]);
        fronts.solve(&mut x);
        anew.solve(&mut y);
        assert_eq!(x, y);
    }

    /// A diagonally dominant matrix has as many negative eigenvalues as negative diagonals (Gershgorin's circles).
    #[test]
    fn counts_negative_eigenvalues() {
        let negative = |row: usize| row % 7 == 3;
        let (mut fronts, _) = matrix(|row| if negative(row) { -60.0 } else { 60.0 });
        let expected = (0..UNKNOWNS).filter(|&row| negative(row)).count();
        assert_eq!(negative_count(&mut fronts), Some(expected));
    }

    #[test]
    fn a_held_unknown_does_not_move() {
        let (mut fronts, _) = matrix(|_| 20.0);
        fronts.hold_first(2);
        let mut x = vec![1.0; UNKNOWNS + STATION];
        x[2] = 0.0;
        assert!(negative_count(&mut fronts).is_some());
        fronts.solve(&mut x);
        assert!(x[2] == 0.0 && x[3] != 0.0);
    }

    #[test]
    fn notices_singular_equations() {
        let mut fronts = FrontalMatrix::new(2, 2);
        fronts.clear();
        assert!(negative_count(&mut fronts).is_none());
    }
}
