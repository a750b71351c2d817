//! Linear equations of a wall, column of elements by column.
//!
//! A column couples its left station, its own unknowns (middle station and pressures) and its right station. One dense
//! front passes along the meridian: what is complete (left and own) is eliminated with partial pivoting, what is left on the
//! right station is carried into the next column. The last right station is the rim, which does not move.

/// Right-hand sides carried along: the residual, and the border of the fluid's pressure.
pub const SIDES: usize = 2;

/// Columns in elimination.
#[derive(Clone, Debug)]
pub struct Fronts {
    /// Unknowns of a station.
    station: usize,
    /// Unknowns of a column's own.
    own: usize,
    columns: usize,
    /// A matrix a column, rows one after the other, each with its right-hand sides behind it.
    values: Vec<f64>,
    /// Unknowns of one column.
    unknowns: Vec<[f64; SIDES]>,
}

impl Fronts {
    /// Room for a number of columns.
    pub fn new(station: usize, own: usize, columns: usize) -> Self {
        let size = 2 * station + own;
        Self {
            station,
            own,
            columns,
            values: vec![0.0; columns * size * (size + SIDES)],
            unknowns: vec![[0.0; SIDES]; size],
        }
    }

    fn size(&self) -> usize {
        2 * self.station + self.own
    }

    fn width(&self) -> usize {
        self.size() + SIDES
    }

    /// All zero.
    pub fn clear(&mut self) {
        self.values.fill(0.0);
    }

    /// The rows of a column: left station, own, right station; each row's right-hand sides stand behind it.
    pub fn column(&mut self, column: usize) -> Column<'_> {
        let (size, width) = (self.size(), self.width());
        let values = &mut self.values[column * size * width..(column + 1) * size * width];
        Column { values, width }
    }

    /// Holds an unknown of the first station.
    pub fn hold_first(&mut self, unknown: usize) {
        let (size, width) = (self.size(), self.width());
        for i in 0..size {
            self.values[i * width + unknown] = 0.0;
        }
        self.values[unknown * width..(unknown + 1) * width].fill(0.0);
        self.values[unknown * width + unknown] = 1.0;
    }

    /// Eliminates every column. `None` if the equations are singular.
    pub fn eliminate(&mut self) -> Option<()> {
        let (size, width, station) = (self.size(), self.width(), self.station);
        let complete = station + self.own;
        for column in 0..self.columns {
            let (before, rest) = self.values.split_at_mut(column * size * width);
            let values = &mut rest[..size * width];
            if column > 0 {
                let last = &before[(column - 1) * size * width..];
                for i in 0..station {
                    let carried = &last[(complete + i) * width + complete..(complete + i + 1) * width];
                    let row = &mut values[i * width..(i + 1) * width];
                    for j in 0..station {
                        row[j] += carried[j];
                    }
                    for j in 0..SIDES {
                        row[size + j] += carried[station + j];
                    }
                }
            }
            // The rim's rows and columns stay out.
            let rows = if column + 1 == self.columns {
                complete
            } else {
                size
            };
            eliminate(values, width, complete, rows)?;
        }
        Some(())
    }

    /// The solutions of all right-hand sides, after elimination: `take` gets column, unknown within it (left station and
    /// own), and values.
    pub fn solutions(&mut self, mut take: impl FnMut(usize, usize, [f64; SIDES])) {
        let (size, width) = (self.size(), self.width());
        let complete = self.station + self.own;
        let x = &mut self.unknowns;
        // The rim.
        x.fill([0.0; SIDES]);
        for column in (0..self.columns).rev() {
            let values = &self.values[column * size * width..(column + 1) * size * width];
            for i in (0..complete).rev() {
                let row = &values[i * width..(i + 1) * width];
                let mut sums: [f64; SIDES] = core::array::from_fn(|side| row[size + side]);
                for j in i + 1..size {
                    for side in 0..SIDES {
                        sums[side] -= row[j] * x[j][side];
                    }
                }
                x[i] = sums.map(|sum| sum / row[i]);
                take(column, i, x[i]);
            }
            let (left, right) = x.split_at_mut(complete);
            right.copy_from_slice(&left[..self.station]);
        }
    }
}

/// One column's equations.
pub struct Column<'a> {
    values: &'a mut [f64],
    width: usize,
}

impl Column<'_> {
    /// A row: coefficients, then right-hand sides.
    #[inline]
    pub fn row(&mut self, row: usize) -> &mut [f64] {
        &mut self.values[row * self.width..(row + 1) * self.width]
    }
}

/// Gaussian elimination of the first `complete` unknowns from `rows` rows, pivoted among the first `complete`.
fn eliminate(values: &mut [f64], width: usize, complete: usize, rows: usize) -> Option<()> {
    for k in 0..complete {
        let mut pivot = k;
        for i in k + 1..complete {
            if values[i * width + k].abs() > values[pivot * width + k].abs() {
                pivot = i;
            }
        }
        let (upper, lower) = values.split_at_mut((k + 1) * width);
        let row = &mut upper[k * width..];
        if pivot > k {
            row[k..].swap_with_slice(&mut lower[(pivot - k - 1) * width + k..(pivot - k) * width]);
        }
        let divisor = row[k];
        if divisor == 0.0 || !divisor.is_finite() {
            return None;
        }
        let row = &row[k + 1..];
        for other in lower.chunks_exact_mut(width).take(rows - k - 1) {
            let factor = other[k] / divisor;
            if factor == 0.0 {
                continue;
            }
            for (x, y) in other[k + 1..].iter_mut().zip(row) {
                *x -= factor * y;
            }
        }
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pseudo-random numbers in [-1, 1]: the multiplier of Lehmer's generator.
    fn random(seed: &mut u64) -> f64 {
        *seed = *seed * 48_271 % 2_147_483_647;
        *seed as f64 / 1_073_741_823.5 - 1.0
    }

    /// The right-hand sides of a known solution give it back, pivots of zero included.
    #[test]
    fn solves_what_it_was_given() {
        let (station, own, columns) = (3, 4, 5);
        let size = 2 * station + own;
        let mut seed = 7;
        let mut fronts = Fronts::new(station, own, columns);
        let count = columns * (station + own);
        let known: Vec<[f64; SIDES]> = (0..count)
            .map(|_| core::array::from_fn(|_| random(&mut seed)))
            .collect();
        fronts.clear();
        for column in 0..columns {
            let mut front = fronts.column(column);
            for i in 0..size {
                for j in 0..size {
                    // A diagonal of zeros among a column's own, as the constraint's pressures have.
                    let value = if i == j && i >= station && i < station + 2 {
                        0.0
                    } else {
                        random(&mut seed)
                    };
                    front.row(i)[j] = value;
                    let unknown = column * (station + own) + j;
                    if unknown < count {
                        for side in 0..SIDES {
                            front.row(i)[size + side] += value * known[unknown][side];
                        }
                    }
                }
            }
        }
        fronts.eliminate().expect("regular equations");
        let mut seen = 0;
        fronts.solutions(|column, i, x| {
            for (found, expected) in x.iter().zip(known[column * (station + own) + i]) {
                assert!(
                    (found - expected).abs() < 1e-9,
                    "{column} {i}: {found} {expected}"
                );
            }
            seen += 1;
        });
        assert_eq!(seen, count);
    }

    #[test]
    fn notices_singular_equations() {
        let mut fronts = Fronts::new(2, 2, 2);
        fronts.clear();
        assert!(fronts.eliminate().is_none());
    }
}
