//! Where the elements of a mesh lie.
//!
//! Nodes are spread evenly over a depth `z(t)` whose slope is the inverse of the length over which the solution
//! varies at `t`: the distance to the pole (under a small plate everything goes with `ln t`), a fixed reach, and,
//! next to the contact edge, the distance to the complex singularity of the tangent angle, which lies a bend
//! length `T1 / P` off the edge and comes close when little tension crosses it.

use core::f64::consts::FRAC_PI_2;

/// Length over which the solution varies away from pole and contact edge, in the meridian's parameter.
const REACH: f64 = 0.6;

/// Most fixed break points a mesh may have.
pub const MAX_BREAKS: usize = 8;

/// Positions at which a node must stand, because the equations have a kink there. Increasing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Breaks {
    positions: [f64; MAX_BREAKS],
    count: usize,
}

impl Breaks {
    /// None.
    pub const NONE: Self = Self {
        positions: [0.0; MAX_BREAKS],
        count: 0,
    };

    /// Adds a position larger than all before it; silently full beyond [`MAX_BREAKS`], which costs accuracy only.
    pub fn push(&mut self, position: f64) {
        if self.count < MAX_BREAKS {
            self.positions[self.count] = position;
            self.count += 1;
        }
    }

    /// The positions.
    pub fn positions(&self) -> &[f64] {
        &self.positions[..self.count]
    }
}

/// The depth function of a free zone.
#[derive(Clone, Copy, Debug)]
pub struct Depth {
    /// Contact parameter, radians, 0 for a membrane that is not pressed.
    pub contact_parameter: f64,
    /// Bend length at the contact edge, in the meridian's parameter, radians.
    pub bend: f64,
}

impl Depth {
    fn pressed(&self) -> bool {
        self.contact_parameter > 0.0
    }

    /// `z(t)`, zero at the contact edge.
    pub fn at(&self, t: f64) -> f64 {
        let from_edge = t - self.contact_parameter;
        let mut depth = from_edge / REACH;
        if self.pressed() {
            depth += libm::log(t / self.contact_parameter) + libm::asinh(from_edge / self.bend);
        }
        depth
    }

    fn slope(&self, t: f64) -> f64 {
        let from_edge = t - self.contact_parameter;
        let mut slope = 1.0 / REACH;
        if self.pressed() {
            slope += 1.0 / t + 1.0 / libm::sqrt(from_edge * from_edge + self.bend * self.bend);
        }
        slope
    }

    /// Total depth of the free zone.
    pub fn total(&self) -> f64 {
        self.at(FRAC_PI_2)
    }

    /// `t` at a depth, from a smaller `t`: concave and increasing, so Newton's iterates approach from the left.
    fn inverse(&self, depth: f64, from: f64) -> f64 {
        let mut t = from;
        for _ in 0..100 {
            let step = (depth - self.at(t)) / self.slope(t);
            t += step;
            if step < 1e-12 * t {
                break;
            }
        }
        t
    }

    /// Nodes `from .. to` (both included) of equal depth, at least one element, about `density` elements a unit of
    /// depth. Calls `take` with each node after `from`; the number of elements.
    pub fn spread(&self, from: f64, to: f64, density: f64, mut take: impl FnMut(f64)) -> usize {
        let (low, high) = (self.at(from), self.at(to));
        let elements = libm::ceil((high - low) * density - 1e-9).max(1.0) as usize;
        let mut t = from;
        for k in 1..elements {
            t = self.inverse(low + (high - low) * k as f64 / elements as f64, t);
            take(t);
        }
        take(to);
        elements
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_are_equidistant_in_depth_and_end_where_asked() {
        let depth = Depth {
            contact_parameter: 0.01,
            bend: 1e-3,
        };
        let mut nodes = vec![0.01];
        let elements = depth.spread(0.01, FRAC_PI_2, 1.5, |t| nodes.push(t));
        assert_eq!(nodes.len(), elements + 1);
        assert_eq!(nodes[elements].to_bits(), FRAC_PI_2.to_bits());
        let step = depth.total() / elements as f64;
        for pair in nodes.windows(2) {
            assert!((depth.at(pair[1]) - depth.at(pair[0]) - step).abs() < 1e-9);
        }
    }

    #[test]
    fn an_unpressed_membrane_has_equal_elements() {
        let depth = Depth {
            contact_parameter: 0.0,
            bend: 1.0,
        };
        let mut nodes = vec![0.0];
        let elements = depth.spread(0.0, FRAC_PI_2, 2.0, |t| nodes.push(t));
        for (k, t) in nodes.iter().enumerate() {
            assert!((t - FRAC_PI_2 * k as f64 / elements as f64).abs() < 1e-12);
        }
    }
}
