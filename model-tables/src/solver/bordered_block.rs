//! Linear equations of elements in a row with a border (bordered almost block diagonal): the step of Newton's method.
//!
//! The unknowns are the states `y_0 .. y_E` at the nodes and the parameters `p`. Each element couples its two
//! ends, `T_k y_k - y_(k+1) + C_k p + d_k = 0`; a few border rows couple everything. Nodes are eliminated from
//! the left, the four equations on a node pivoted among themselves, so that growing and decaying solutions are
//! both kept in check (Wright, *Stable parallel algorithms for two-point boundary value problems*, 1992). A plain
//! march `y_(k+1) = T_k y_k` is shooting, and loses every digit on a weakly stretched membrane.

use crate::solver::collocation::{COLUMNS, PARAMETERS, STATES};

/// Border rows that are carried along.
pub const BORDERS: usize = 3;
/// Unknowns left when all nodes but the last are eliminated: the last node, then the parameters.
pub const UNKNOWNS: usize = STATES + PARAMETERS;
/// An equation `sum_i row[i] x_i + row[UNKNOWNS] = 0` on one node and the parameters.
pub type BlockRow = [f64; UNKNOWNS + 1];
const CONSTANT: usize = UNKNOWNS;

/// A node that has been eliminated: its two states from the next node's and the parameters.
type Eliminated = [BlockRow; STATES];

/// The elimination in progress.
#[derive(Clone, Debug)]
pub struct BorderedBlocks<const MAX: usize> {
    eliminated: [Eliminated; MAX],
    nodes: usize,
    /// Two equations on the present node.
    link: [BlockRow; STATES],
    /// Border rows, expressed on the present node.
    pub borders: [BlockRow; BORDERS],
}

impl<const MAX: usize> BorderedBlocks<MAX> {
    /// Room for a chain, to be restarted.
    pub(crate) const BLANK: Self = Self {
        eliminated: [[[0.0; UNKNOWNS + 1]; STATES]; MAX],
        nodes: 0,
        link: [[0.0; UNKNOWNS + 1]; STATES],
        borders: [[0.0; UNKNOWNS + 1]; BORDERS],
    };

    /// A chain whose first node obeys `y_0 = by_parameter p` in the changes.
    pub fn new(by_parameter: [[f64; PARAMETERS]; STATES]) -> Self {
        let mut system = Self::BLANK;
        system.restart(by_parameter);
        system
    }

    /// Begins anew, as [`BorderedBlocks::new`].
    pub fn restart(&mut self, by_parameter: [[f64; PARAMETERS]; STATES]) {
        self.nodes = 0;
        self.borders = [[0.0; UNKNOWNS + 1]; BORDERS];
        for (i, row) in self.link.iter_mut().enumerate() {
            *row = [0.0; UNKNOWNS + 1];
            row[i] = 1.0;
            for (x, y) in row[STATES..CONSTANT].iter_mut().zip(&by_parameter[i]) {
                *x = -y;
            }
        }
    }

    /// Adds a term in the present node, the parameters and a constant to a border row.
    pub fn add_to_border(&mut self, border: usize, term: &BlockRow) {
        for (x, y) in self.borders[border].iter_mut().zip(term) {
            *x += y;
        }
    }

    /// Goes on to the next node through an element: `y_next = end (y, p, 1)`. `None` if the node is undetermined.
    pub fn advance(&mut self, end: &[[f64; COLUMNS]; STATES]) -> Option<()> {
        // Columns: present node, next node, parameters, constant.
        const WIDE: usize = 2 * STATES + PARAMETERS + 1;
        let mut rows = [[0.0; WIDE]; 2 * STATES + BORDERS];
        let widen = |narrow: &BlockRow, wide: &mut [f64; WIDE]| {
            wide[..STATES].copy_from_slice(&narrow[..STATES]);
            wide[2 * STATES..].copy_from_slice(&narrow[STATES..]);
        };
        for i in 0..STATES {
            widen(&self.link[i], &mut rows[i]);
            widen(&end[i], &mut rows[STATES + i]);
            rows[STATES + i][STATES + i] = -1.0;
        }
        for i in 0..BORDERS {
            widen(&self.borders[i], &mut rows[2 * STATES + i]);
        }
        for k in 0..STATES {
            let mut pivot = k;
            for row in k + 1..2 * STATES {
                if rows[row][k].abs() > rows[pivot][k].abs() {
                    pivot = row;
                }
            }
            rows.swap(k, pivot);
            let reciprocal = 1.0 / rows[k][k];
            if !reciprocal.is_finite() {
                return None;
            }
            for x in &mut rows[k] {
                *x *= reciprocal;
            }
            let pivot_row = rows[k];
            for (i, row) in rows.iter_mut().enumerate() {
                if i != k {
                    let factor = row[k];
                    for (x, y) in row.iter_mut().zip(&pivot_row) {
                        *x -= factor * y;
                    }
                }
            }
        }
        let narrow = |wide: &[f64; WIDE]| -> BlockRow {
            let mut row = [0.0; UNKNOWNS + 1];
            row.copy_from_slice(&wide[STATES..]);
            row
        };
        for i in 0..STATES {
            self.eliminated[self.nodes][i] = narrow(&rows[i]);
            self.link[i] = narrow(&rows[STATES + i]);
        }
        for i in 0..BORDERS {
            self.borders[i] = narrow(&rows[2 * STATES + i]);
        }
        self.nodes += 1;
        Some(())
    }

    /// The two equations that the system leaves on the last node and the parameters.
    pub fn link(&self) -> [BlockRow; STATES] {
        self.link
    }

    /// Changes of the nodes before the last, once the last (`UNKNOWNS` values: node, parameters) is known.
    pub fn back_substitute(&self, last: &[f64; UNKNOWNS], mut take: impl FnMut(usize, [f64; STATES])) {
        let mut known = *last;
        take(self.nodes, [last[0], last[1]]);
        for k in (0..self.nodes).rev() {
            let mut node = [0.0; STATES];
            for (value, row) in node.iter_mut().zip(&self.eliminated[k]) {
                *value = -row[CONSTANT]
                    - row[..CONSTANT]
                        .iter()
                        .zip(&known)
                        .map(|(a, x)| a * x)
                        .sum::<f64>();
            }
            known[..STATES].copy_from_slice(&node);
            take(k, node);
        }
    }
}

/// Solves the equations on the last node and the parameters. `None` if they are singular.
pub fn solve(mut rows: [BlockRow; UNKNOWNS]) -> Option<[f64; UNKNOWNS]> {
    // Rows of very different units: pivot on what is large within its row.
    for row in &mut rows {
        let scale = row[..CONSTANT].iter().fold(0.0_f64, |a, x| a.max(x.abs()));
        if scale == 0.0 || !scale.is_finite() {
            return None;
        }
        for x in row.iter_mut() {
            *x /= scale;
        }
    }
    for k in 0..UNKNOWNS {
        let mut pivot = k;
        for row in k + 1..UNKNOWNS {
            if rows[row][k].abs() > rows[pivot][k].abs() {
                pivot = row;
            }
        }
        rows.swap(k, pivot);
        let reciprocal = 1.0 / rows[k][k];
        if !reciprocal.is_finite() {
            return None;
        }
        let pivot_row = rows[k];
        for (i, row) in rows.iter_mut().enumerate() {
            if i != k {
                let factor = row[k] * reciprocal;
                for (x, y) in row.iter_mut().zip(&pivot_row) {
                    *x -= factor * y;
                }
            }
        }
    }
    let mut solution = [0.0; UNKNOWNS];
    for (k, x) in solution.iter_mut().enumerate() {
        *x = -rows[k][CONSTANT] / rows[k][k];
    }
    Some(solution)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chain with one solution growing and one decaying by `1e4` an element: shooting through eight elements
    /// would lose 32 digits.
    #[test]
    fn growing_and_decaying_solutions_are_kept_apart() {
        const ELEMENTS: usize = 8;
        // y_(k+1) = diag(g, 1/g) y_k + (1, 1) p_1; y_0 = (p_0, 2) in its first component, last node (3, .).
        let g = 1e4;
        let mut element = [[0.0; COLUMNS]; STATES];
        element[0][0] = g;
        element[1][1] = 1.0 / g;
        element[0][STATES + 1] = 1.0;
        element[1][STATES + 1] = 1.0;
        let mut system = BorderedBlocks::<ELEMENTS>::new([[1.0, 0.0, 0.0, 0.0], [0.0; 4]]);
        // Border 0: the sum of all second components, less 5.
        for _ in 0..ELEMENTS {
            let mut row = [0.0; UNKNOWNS + 1];
            row[1] = 1.0;
            system.add_to_border(0, &row);
            system.advance(&element).expect("regular");
        }
        let [a, b] = system.link();
        let unit = |i: usize, constant: f64| {
            let mut row = [0.0; UNKNOWNS + 1];
            row[i] = 1.0;
            row[UNKNOWNS] = constant;
            row
        };
        let mut border = system.borders[0];
        border[UNKNOWNS] -= 5.0;
        let solution = solve([
            a,
            b,
            unit(0, -3.0),
            border,
            unit(STATES + 2, 0.0),
            unit(STATES + 3, 0.0),
        ])
        .expect("regular");
        let mut nodes = [[0.0; STATES]; ELEMENTS + 1];
        system.back_substitute(&solution, |k, node| nodes[k] = node);
        let p = solution[STATES + 1];
        assert!((nodes[ELEMENTS][0] - 3.0).abs() < 1e-14);
        assert!((nodes[..ELEMENTS].iter().map(|n| n[1]).sum::<f64>() - 5.0).abs() < 1e-12);
        for k in 0..ELEMENTS {
            // Backward stable: the recurrence holds relative to its largest term.
            let first = nodes[k + 1][0] - g * nodes[k][0] - p;
            assert!(
                first.abs() < 1e-12 * (1.0 + (g * nodes[k][0]).abs()),
                "node {k}: {first:e}"
            );
            assert!((nodes[k + 1][1] - nodes[k][1] / g - p).abs() < 1e-13, "node {k}");
        }
    }

    #[test]
    fn singular_equations_are_refused() {
        assert!(solve([[0.0; UNKNOWNS + 1]; UNKNOWNS]).is_none());
        assert!(solve([[1.0; UNKNOWNS + 1]; UNKNOWNS]).is_none());
        assert!(solve([[f64::NAN; UNKNOWNS + 1]; UNKNOWNS]).is_none());
    }
}
