//! The plate: a rigid, flat, frictionless plane that the outer surface may touch and not cross.
//!
//! A stiff, smooth penalty: at a penetration `d` the contact pressure is `k s(d)` with `s = 0` where there is none, `d^2 / 4w`
//! up to `2 w`, `d - w` beyond. It begins at `d = 0`, so that an unpressed dome feels nothing of a plate that rests on it.

use super::mesh::{shape, slope};
use core::f64::consts::PI;

/// Gauss points of an edge.
pub const POINTS: usize = 6;
/// Gauss points of order twelve on `[-1, 1]`.
const PLACES: [f64; POINTS] = [
    -0.932_469_514_203_152,
    -0.661_209_386_466_264_5,
    -0.238_619_186_083_196_9,
    0.238_619_186_083_196_9,
    0.661_209_386_466_264_5,
    0.932_469_514_203_152,
];
/// Their weights.
const WEIGHTS: [f64; POINTS] = [
    0.171_324_492_379_170_3,
    0.360_761_573_048_138_6,
    0.467_913_934_572_691,
    0.467_913_934_572_691,
    0.360_761_573_048_138_6,
    0.171_324_492_379_170_3,
];

/// Stiffness and smoothness of the contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Penalty {
    /// Contact pressure over penetration, beyond the smooth beginning.
    pub stiffness: f64,
    /// Width `w` of the beginning.
    pub width: f64,
}

impl Penalty {
    /// Energy, contact pressure and its slope at a penetration.
    fn at(self, depth: f64) -> [f64; 3] {
        let w = self.width;
        let [energy, pressure, slope] = if depth <= 0.0 {
            [0.0; 3]
        } else if depth < 2.0 * w {
            [
                depth * depth * depth / (12.0 * w),
                depth * depth / (4.0 * w),
                depth / (2.0 * w),
            ]
        } else {
            let beyond = depth - w;
            [0.5 * beyond * beyond + w * w / 6.0, beyond, 1.0]
        };
        [energy, pressure, slope].map(|x| self.stiffness * x)
    }
}

/// Undeformed areas that the Gauss points of an outer edge stand for, from its undeformed radii and heights.
pub fn areas(r: &[f64; 3], z: &[f64; 3]) -> [f64; POINTS] {
    core::array::from_fn(|i| {
        let (n, dn) = (shape(PLACES[i]), slope(PLACES[i]));
        let dot = |a: &[f64; 3], b: &[f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        2.0 * PI * dot(&n, r) * libm::hypot(dot(&dn, r), dot(&dn, z)) * WEIGHTS[i]
    })
}

/// The plate's action on one outer edge, with derivatives by its three heights.
#[derive(Clone, Copy, Debug, Default)]
pub struct Action {
    /// Energy in the contact.
    pub energy: f64,
    /// Force on the plate.
    pub force: f64,
    /// First derivatives of the energy.
    pub first: [f64; 3],
    /// Second derivatives of the energy.
    pub second: [[f64; 3]; 3],
}

/// The action of a plate at height `plate` on an edge whose nodes are at heights `z`.
pub fn action(penalty: Penalty, areas: &[f64; POINTS], z: &[f64; 3], plate: f64) -> Action {
    let mut action = Action::default();
    for (x, area) in PLACES.into_iter().zip(areas) {
        let n = shape(x);
        let depth = n[0] * z[0] + n[1] * z[1] + n[2] * z[2] - plate;
        if depth <= 0.0 {
            continue;
        }
        let [energy, pressure, slope] = penalty.at(depth).map(|x| area * x);
        action.energy += energy;
        action.force += pressure;
        for a in 0..3 {
            action.first[a] += pressure * n[a];
            for b in 0..3 {
                action.second[a][b] += slope * n[a] * n[b];
            }
        }
    }
    action
}

#[cfg(test)]
mod tests {
    use super::*;

    const PENALTY: Penalty = Penalty {
        stiffness: 1e3,
        width: 1e-3,
    };

    #[test]
    fn a_dome_that_only_touches_feels_nothing() {
        let areas = areas(&[0.0, 0.1, 0.2], &[1.0, 0.99, 0.96]);
        let action = action(PENALTY, &areas, &[1.0, 0.99, 0.96], 1.0);
        assert!(action.force == 0.0 && action.energy == 0.0);
    }

    #[test]
    fn areas_are_those_of_a_disc() {
        let sum: f64 = areas(&[0.0, 0.5, 1.0], &[1.0, 1.0, 1.0]).iter().sum();
        assert!((sum - PI).abs() < 1e-13);
    }

    /// Force and energy are smooth in the height, in the beginning of the contact, past it and in between.
    #[test]
    fn derivatives_are_those_of_the_energy() {
        let areas = areas(&[0.0, 0.1, 0.2], &[1.0, 1.0, 1.0]);
        for place in [
            [1.0, 0.9995, 0.998],
            [1.003, 1.002, 1.004],
            [1.0022, 1.0018, 1.0005],
        ] {
            let at = |z: &[f64; 3]| action(PENALTY, &areas, z, 0.9985);
            let found = at(&place);
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
