//! The plate: a rigid, flat, frictionless plane. The outer surface may touch it but not cross it.
//!
//! A stiff penalty: the contact pressure is `k d` at a penetration `d`, per undeformed area. An edge's height is a parabola, so its
//! intersections with the plate are known in closed form, and the integrals run exactly over the touching part. The force and its
//! slope are therefore continuous in all variables, and the number of quadrature points does not change as the contact grows.

use super::mesh::{shape, slope};
use core::f64::consts::PI;

/// Gauss points of each part of an edge that touches.
pub const POINTS: usize = 6;
/// Gauss points of order twelve on `[-1, 1]`.
pub const PLACES: [f64; POINTS] = [
    -0.932_469_514_203_152,
    -0.661_209_386_466_264_5,
    -0.238_619_186_083_196_9,
    0.238_619_186_083_196_9,
    0.661_209_386_466_264_5,
    0.932_469_514_203_152,
];
/// Their weights.
pub const WEIGHTS: [f64; POINTS] = [
    0.171_324_492_379_170_3,
    0.360_761_573_048_138_6,
    0.467_913_934_572_691,
    0.467_913_934_572_691,
    0.360_761_573_048_138_6,
    0.171_324_492_379_170_3,
];

/// The plate's action on one outer edge, with derivatives by its three heights.
#[derive(Clone, Copy, Debug, Default)]
pub struct PlateAction {
    /// Energy in the contact, dimensionless.
    pub energy: f64,
    /// Force on the plate, dimensionless.
    pub force: f64,
    /// First derivatives of the dimensionless energy.
    pub first: [f64; 3],
    /// Second derivatives of the energy.
    pub second: [[f64; 3]; 3],
}

/// The action of a plate at height `plate`, of a contact pressure `stiffness` times the penetration, on an edge whose nodes are
/// at heights `z` and were at `undeformed` radii and heights.
pub fn action(stiffness: f64, undeformed: &[[f64; 3]; 2], z: &[f64; 3], plate: f64) -> PlateAction {
    let mut action = PlateAction::default();
    // The penetration is `c + b x + a x^2`.
    let (c, b) = (z[1] - plate, 0.5 * (z[2] - z[0]));
    let a = 0.5 * (z[0] + z[2]) - z[1];
    let (cuts, count) = cuts(a, b, c);
    for part in cuts[..count].windows(2) {
        let (middle, half) = (0.5 * (part[0] + part[1]), 0.5 * (part[1] - part[0]));
        if c + middle * (b + middle * a) <= 0.0 {
            continue;
        }
        for (place, weight) in PLACES.into_iter().zip(WEIGHTS) {
            let x = middle + half * place;
            let depth = c + x * (b + x * a);
            let n = shape(x);
            let [energy, pressure, slope] = [0.5 * depth * depth, depth, 1.0]
                .map(|y| stiffness * half * weight * area(undeformed, x) * y);
            action.energy += energy;
            action.force += pressure;
            for i in 0..3 {
                action.first[i] += pressure * n[i];
                for j in 0..3 {
                    action.second[i][j] += slope * n[i] * n[j];
                }
            }
        }
    }
    action
}

/// Where `[-1, 1]` is to be cut so that `c + b x + a x^2` keeps its sign in between, ends included, and how many cuts there are.
fn cuts(a: f64, b: f64, c: f64) -> ([f64; 4], usize) {
    let mut cuts = [-1.0; 4];
    let mut count = 1;
    let discriminant = b * b - 4.0 * a * c;
    if discriminant > 0.0 {
        // No cancellation in either root; one that is not finite is outside.
        let q = -0.5 * (b + libm::copysign(libm::sqrt(discriminant), b));
        let (one, other) = (q / a, c / q);
        for root in [one.min(other), one.max(other)] {
            if root > -1.0 && root < 1.0 {
                cuts[count] = root;
                count += 1;
            }
        }
    }
    cuts[count] = 1.0;
    (cuts, count + 1)
}

/// Undeformed area per unit of the edge's coordinate.
pub(super) fn area([r, z]: &[[f64; 3]; 2], x: f64) -> f64 {
    let dot = |n: [f64; 3], y: &[f64; 3]| n[0] * y[0] + n[1] * y[1] + n[2] * y[2];
    let (n, dn) = (shape(x), slope(x));
    2.0 * PI * dot(n, r) * libm::hypot(dot(dn, r), dot(dn, z))
}

#[cfg(test)]
mod tests {
    use super::*;

    const STIFFNESS: f64 = 1e3;
    const DISC: [[f64; 3]; 2] = [[0.0, 0.1, 0.2], [1.0, 1.0, 1.0]];

    #[test]
    fn a_dome_that_only_touches_feels_nothing() {
        let cap = [[0.0, 0.1, 0.2], [1.0, 0.99, 0.96]];
        let action = action(STIFFNESS, &cap, &cap[1], 1.0);
        assert!(action.force == 0.0 && action.energy == 0.0);
    }

    /// A flat disc of radius 0.2, pushed in by 0.003: area, force and energy by hand.
    #[test]
    fn a_disc_is_pushed_back_over_its_area() {
        let action = action(STIFFNESS, &DISC, &[1.0; 3], 0.997);
        let area = PI * 0.04;
        assert!((action.force - 3.0 * area).abs() < 1e-12);
        assert!((action.energy - 0.0045 * area).abs() < 1e-14);
    }

    /// The disc's height falls from the axis as a parabola, `1 - r^2`: pushed in by `d` it touches up to `r^2 = d`, with the force
    /// `k integral of (d - r^2) 2 pi r dr = k pi d^2 / 2`, wherever in the edge that ends.
    #[test]
    fn a_part_of_an_edge_is_integrated_to_its_end() {
        let bent = [1.0, 0.99, 0.96];
        for depth in [1e-6, 1e-4, 0.003, 0.0123, 0.0399] {
            let action = action(STIFFNESS, &DISC, &bent, 1.0 - depth);
            let force = STIFFNESS * PI * depth * depth / 2.0;
            assert!(
                (action.force / force - 1.0).abs() < 1e-9,
                "{depth}: {}",
                action.force / force
            );
        }
    }

    /// Force and slope, with the end of the contact in the edge, none, and a gap in its middle.
    #[test]
    fn derivatives_are_those_of_the_energy() {
        for place in [
            [1.0, 0.9995, 0.998],
            [1.003, 1.002, 1.004],
            [1.001, 0.9975, 1.002],
            [0.997, 0.999, 0.997],
        ] {
            let at = |z: &[f64; 3]| action(STIFFNESS, &DISC, z, 0.9985);
            let found = at(&place);
            assert!(found.energy > 0.0);
            assert!((found.force - found.first.iter().sum::<f64>()).abs() < 1e-12);
            for j in 0..3 {
                let [below, above] = [-1e-7, 1e-7].map(|by| {
                    let mut moved = place;
                    moved[j] += by;
                    at(&moved)
                });
                assert!(((above.energy - below.energy) / 2e-7 - found.first[j]).abs() < 1e-7);
                for i in 0..3 {
                    assert!(((above.first[i] - below.first[i]) / 2e-7 - found.second[i][j]).abs() < 1e-4);
                }
            }
        }
    }
}
