//! The fluid inside: `V = -pi integral of r^2 dz` over the inner surface, from the pole to the rim.

use super::mesh::{PLACES, WEIGHTS, shape, slope};
use core::f64::consts::PI;

/// Volume under one inner edge, with its derivatives; unknowns are the three radii, then the three heights.
#[derive(Clone, Copy, Debug, Default)]
pub struct Share {
    /// The volume, over the cube of the radial semi-axis.
    pub volume: f64,
    /// First derivatives of the dimensionless volume.
    pub first: [f64; 6],
    /// Second derivatives.
    pub second: [[f64; 6]; 6],
}

/// The volume alone under an edge with these radii and heights, and its first derivatives by both. The quadrature is exact.
pub fn volume(r: &[f64; 3], z: &[f64; 3]) -> (f64, [[f64; 3]; 2]) {
    let mut volume = 0.0;
    let mut first = [[0.0; 3]; 2];
    for (x, w) in PLACES.into_iter().zip(WEIGHTS) {
        let (n, dn) = (shape(x), slope(x));
        let radius = n[0] * r[0] + n[1] * r[1] + n[2] * r[2];
        let rise = dn[0] * z[0] + dn[1] * z[1] + dn[2] * z[2];
        let w = -PI * w;
        volume += w * radius * radius * rise;
        for a in 0..3 {
            first[0][a] += 2.0 * w * radius * rise * n[a];
            first[1][a] += w * radius * radius * dn[a];
        }
    }
    (volume, first)
}

/// The share of an edge with these radii and heights. The quadrature is exact.
pub fn share(r: &[f64; 3], z: &[f64; 3]) -> Share {
    let mut share = Share::default();
    for (x, w) in PLACES.into_iter().zip(WEIGHTS) {
        let (n, dn) = (shape(x), slope(x));
        let radius = n[0] * r[0] + n[1] * r[1] + n[2] * r[2];
        let rise = dn[0] * z[0] + dn[1] * z[1] + dn[2] * z[2];
        let w = -PI * w;
        share.volume += w * radius * radius * rise;
        for a in 0..3 {
            share.first[a] += 2.0 * w * radius * rise * n[a];
            share.first[3 + a] += w * radius * radius * dn[a];
            for b in 0..3 {
                share.second[a][b] += 2.0 * w * rise * n[a] * n[b];
                let mixed = 2.0 * w * radius * n[a] * dn[b];
                share.second[a][3 + b] += mixed;
                share.second[3 + b][a] += mixed;
            }
        }
    }
    share
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `V = pi R^2 h / 3` of a cone, from its tip on the axis down to its foot.
    #[test]
    fn a_cone_has_its_volume() {
        let share = share(&[0.0, 0.5, 1.0], &[2.0, 1.0, 0.0]);
        assert!((share.volume - PI * 2.0 / 3.0).abs() < 1e-14);
    }

    #[test]
    fn derivatives_are_those_of_the_volume() {
        let place = [0.3, 0.5, 0.8, 1.0, 0.9, 0.5];
        let at = |x: &[f64; 6]| share(&[x[0], x[1], x[2]], &[x[3], x[4], x[5]]);
        let found = at(&place);
        for j in 0..6 {
            let [below, above] = [-1e-5, 1e-5].map(|by| {
                let mut moved = place;
                moved[j] += by;
                at(&moved)
            });
            assert!(((above.volume - below.volume) / 2e-5 - found.first[j]).abs() < 1e-9);
            for i in 0..6 {
                assert!(((above.first[i] - below.first[i]) / 2e-5 - found.second[i][j]).abs() < 1e-9);
            }
        }
    }
}
