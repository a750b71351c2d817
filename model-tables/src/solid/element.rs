//! One element: its forces and its stiffness.
//!
//! In-plane gradient `F` (2 x 2), hoop stretch `f = r/R`, `D = det F`, `S = |F|^2`, `J = D f`; the invariants are
//! `I1 = S + f^2` and `I2 = D^2 + f^2 S` (as `J = 1`). The density is `W(I1, I2) + p (J - 1)`, with the pressure `p`
//! linear in each element and discontinuous between them ([`pressure_terms`]). Where [`Material`] says so, the density has a term
//! `k/2 (J - 1)^2` besides.

use super::mesh::{CUBIC_PRESSURES, FUNCTIONS, PLACES, POINTS, Point};
use crate::material::{Hyperelastic as _, Law};

/// Unknowns of an element at most: radii, heights, pressures.
pub const UNKNOWNS: usize = 2 * FUNCTIONS + CUBIC_PRESSURES;

/// Derivatives of the energy by the invariants; `W` of these laws has no other second derivatives.
#[derive(Clone, Copy, Debug)]
struct ByInvariants {
    first: f64,
    second: f64,
    first_first: f64,
}

/// Strain-energy density and its derivatives at the invariants.
fn by_invariants(law: &Law, i1: f64) -> ByInvariants {
    match *law {
        Law::NeoHookean { c1 } => ByInvariants {
            first: c1,
            second: 0.0,
            first_first: 0.0,
        },
        Law::MooneyRivlin { c1, c2 } => ByInvariants {
            first: c1,
            second: c2,
            first_first: 0.0,
        },
        Law::Yeoh { c1, c2, c3 } => {
            let e = i1 - 3.0;
            ByInvariants {
                first: c1 + e * (2.0 * c2 + 3.0 * c3 * e),
                second: 0.0,
                first_first: 2.0 * c2 + 6.0 * c3 * e,
            }
        }
    }
}

/// Strain-energy density at the invariants.
fn energy_density(law: &Law, i1: f64, i2: f64) -> f64 {
    let e = i1 - 3.0;
    match *law {
        Law::NeoHookean { c1 } => c1 * e,
        Law::MooneyRivlin { c1, c2 } => c1 * e + c2 * (i2 - 3.0),
        Law::Yeoh { c1, c2, c3 } => e * (c1 + e * (c2 + e * c3)),
    }
}

/// Volume stiffness `k`, in shear moduli, where there is one.
const VOLUME_STIFFNESS: f64 = 1.0 / 3.0;

/// Volume stiffness besides, in `-C2` of a law that softens.
const CURVATURE: f64 = 8.0;

/// A law, and a stiffness against what the pressure's terms leave free of an element's volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// The law.
    pub law: Law,
    /// The stiffness `k`. `W - 2 W' (J - 1)` falls with a change of volume, as `-mu (J - 1)^2 / 6`, and as `I1` grows by `2 (J - 1)`, by
    /// `2 W'' (J - 1)^2` besides: coarse elements are soft by it, and with a law that softens (`C2 < 0` or `C3 < 0`) they find states
    /// that are none. `mu/3 - 8 C2` just makes up for it; where the volume is kept it does nothing. Elements that are cubic through the
    /// wall, and so free to be soft, have `mu/3` with every law.
    volume_stiffness: f64,
}

impl Material {
    /// Of a mesh whose elements are `cubic` through the wall, or not.
    pub fn new(law: Law, cubic: bool) -> Self {
        let (softens, by_curvature) = match law {
            Law::Yeoh { c2, c3, .. } => (c2 < 0.0 || c3 < 0.0, CURVATURE * (-c2).max(0.0)),
            _ => (false, 0.0),
        };
        let moduli = if cubic || softens { VOLUME_STIFFNESS } else { 0.0 };
        Self {
            law,
            volume_stiffness: moduli * law.shear_modulus() + by_curvature,
        }
    }
}

/// The pressure of an undeformed wall free of stress.
pub fn pressure_at_rest(law: &Law) -> f64 {
    let w = by_invariants(law, 3.0);
    -(2.0 * w.first + 4.0 * w.second)
}

/// `I1` of a deformation.
pub fn first_invariant([f11, f12, f, f21, f22]: Deformation) -> f64 {
    f11 * f11 + f12 * f12 + f21 * f21 + f22 * f22 + f * f
}

/// Whether the law softens at a Gauss point: where in simple shear by `e = I1 - 3` the stress no longer grows,
/// `W' + 2 e W'' <= 0`.
pub fn softens(law: &Law, deformation: Deformation) -> bool {
    let i1 = first_invariant(deformation);
    let w = by_invariants(law, i1);
    w.first + w.second + 2.0 * (i1 - 3.0) * w.first_first <= 0.0
}

/// Deformation at a Gauss point: `F11, F12, f, F21, F22`.
pub type Deformation = [f64; 5];

/// Radii and heights of an element's nodes, deformed, and the amplitudes of its cubic functions.
pub type Positions = [[f64; FUNCTIONS]; 2];

/// The deformation at a point.
pub fn deformation(point: &Point, positions: &Positions) -> Deformation {
    let [g1, g2, g3] = &point.gradient;
    let [r, z] = positions;
    let mut d = [0.0; 5];
    for i in 0..FUNCTIONS {
        d[0] += g1[i] * r[i];
        d[1] += g2[i] * r[i];
        d[2] += g3[i] * r[i];
        d[3] += g1[i] * z[i];
        d[4] += g2[i] * z[i];
    }
    d
}

/// What follows from a deformation and a pressure.
pub struct Stress {
    /// Nominal stress: derivatives of the density by the deformation.
    pub nominal: Deformation,
    /// Volume ratio.
    pub volume_ratio: f64,
    /// The lesser of the in-plane determinant and the hoop stretch: positive unless turned inside out.
    pub least: f64,
    /// Its derivatives by the deformation.
    by_volume: Deformation,
    /// Second derivatives of the density.
    stiffness: [Deformation; 5],
}

/// The stress, also where the wall is turned inside out, as on the way to a solution it may be.
pub fn stress(material: &Material, [f11, f12, f, f21, f22]: Deformation, pressure: f64) -> Stress {
    let determinant = f11 * f22 - f12 * f21;
    let squares = f11 * f11 + f12 * f12 + f21 * f21 + f22 * f22;
    let w = by_invariants(&material.law, squares + f * f);
    let volume_stiffness = material.volume_stiffness;
    let pressure = pressure + volume_stiffness * (determinant * f - 1.0);
    // Derivatives of the density by S, D and f.
    let by_s = w.first + w.second * f * f;
    let by_d = 2.0 * w.second * determinant + pressure * f;
    let by_f = 2.0 * f * (w.first + squares * w.second) + pressure * determinant;
    let in_plane = [2.0 * f11, 2.0 * f12, 0.0, 2.0 * f21, 2.0 * f22];
    let cofactor = [f22, -f21, 0.0, -f12, f11];
    let hoop = [0.0, 0.0, 1.0, 0.0, 0.0];
    let by_sf = 2.0 * f * (w.second + w.first_first);
    let by_ff = 2.0 * (w.first + squares * w.second) + 4.0 * f * f * w.first_first;
    let mut nominal = [0.0; 5];
    let mut by_volume = [0.0; 5];
    let mut stiffness = [[0.0; 5]; 5];
    for i in 0..5 {
        nominal[i] = by_s * in_plane[i] + by_d * cofactor[i] + by_f * hoop[i];
        by_volume[i] = f * cofactor[i] + determinant * hoop[i];
        for j in 0..5 {
            stiffness[i][j] = w.first_first * in_plane[i] * in_plane[j]
                + by_sf * (in_plane[i] * hoop[j] + hoop[i] * in_plane[j])
                + 2.0 * w.second * cofactor[i] * cofactor[j]
                + pressure * (cofactor[i] * hoop[j] + hoop[i] * cofactor[j])
                + by_ff * hoop[i] * hoop[j];
        }
        if i != 2 {
            stiffness[i][i] += 2.0 * by_s;
        }
    }
    if volume_stiffness > 0.0 {
        for i in 0..5 {
            for j in 0..5 {
                stiffness[i][j] += volume_stiffness * by_volume[i] * by_volume[j];
            }
        }
    }
    // The determinant's own second derivatives.
    for (i, j, sign) in [(0, 4, 1.0), (1, 3, -1.0)] {
        stiffness[i][j] += sign * by_d;
        stiffness[j][i] += sign * by_d;
    }
    Stress {
        nominal,
        volume_ratio: determinant * f,
        least: determinant.min(f),
        by_volume,
        stiffness,
    }
}

/// Values of the pressure's terms at a place in `[-1, 1]` along and through. A biquadratic element has the first
/// [`PRESSURES`](super::mesh::PRESSURES) of them.
pub fn pressure_terms(x: f64, y: f64) -> [f64; CUBIC_PRESSURES] {
    [1.0, x, y, x * y, y * y - 1.0 / 3.0]
}

/// Pressure at a place; an element that has fewer terms has none of the others.
pub fn pressure_at(x: f64, y: f64, pressures: &[f64; CUBIC_PRESSURES]) -> f64 {
    let terms = pressure_terms(x, y);
    (0..CUBIC_PRESSURES).map(|i| terms[i] * pressures[i]).sum()
}

/// Forces and stiffness of an element; unknowns are the radii, the heights, the pressures, one behind the other.
#[derive(Clone, Debug)]
pub struct Element {
    /// Forces, and the volumes' excess.
    pub residual: [f64; UNKNOWNS],
    /// Their derivatives.
    pub stiffness: [[f64; UNKNOWNS]; UNKNOWNS],
}

impl Default for Element {
    fn default() -> Self {
        Self {
            residual: [0.0; UNKNOWNS],
            stiffness: [[0.0; UNKNOWNS]; UNKNOWNS],
        }
    }
}

impl Element {
    /// Sums over the Gauss points, and gives the least [`Stress::least`] of those outside the crease. `N` shape functions, the nodes'
    /// with or without the cubic ones, and `T` terms of the pressure.
    pub fn assemble<const N: usize, const T: usize>(
        &mut self,
        material: &Material,
        points: &[Point; POINTS],
        positions: &Positions,
        pressures: &[f64; CUBIC_PRESSURES],
    ) -> f64 {
        let mut forces = [[0.0; N]; 2];
        let mut excess = [0.0; T];
        let mut radial = [[0.0; N]; N];
        let mut mixed = [[0.0; N]; N];
        let mut axial = [[0.0; N]; N];
        let mut volume = [[[0.0; N]; 2]; T];
        let mut least = f64::INFINITY;
        for (index, point) in points.iter().enumerate() {
            let (x, y) = (PLACES[index / 3], PLACES[index % 3]);
            let stress = stress(
                material,
                deformation(point, positions),
                pressure_at(x, y, pressures),
            );
            if !point.in_crease {
                least = least.min(stress.least);
            }
            let [g1, g2, g3] = &point.gradient;
            let w = point.weight;
            let n = stress.nominal.map(|x| w * x);
            let v = stress.by_volume.map(|x| w * x);
            let k = stress.stiffness.map(|row| row.map(|x| w * x));
            // Columns of stiffness times gradient, of each node's radius and height.
            let mut by_radius = [[0.0; N]; 5];
            let mut by_height = [[0.0; N]; 2];
            let mut of_volume = [[0.0; N]; 2];
            for b in 0..N {
                forces[0][b] += n[0] * g1[b] + n[1] * g2[b] + n[2] * g3[b];
                forces[1][b] += n[3] * g1[b] + n[4] * g2[b];
                of_volume[0][b] = v[0] * g1[b] + v[1] * g2[b] + v[2] * g3[b];
                of_volume[1][b] = v[3] * g1[b] + v[4] * g2[b];
                for i in 0..5 {
                    by_radius[i][b] = k[i][0] * g1[b] + k[i][1] * g2[b] + k[i][2] * g3[b];
                }
                for i in 0..2 {
                    by_height[i][b] = k[3 + i][3] * g1[b] + k[3 + i][4] * g2[b];
                }
            }
            for a in 0..N {
                let (a1, a2, a3) = (g1[a], g2[a], g3[a]);
                for b in 0..N {
                    radial[a][b] += a1 * by_radius[0][b] + a2 * by_radius[1][b] + a3 * by_radius[2][b];
                    mixed[a][b] += a1 * by_radius[3][b] + a2 * by_radius[4][b];
                    axial[a][b] += a1 * by_height[0][b] + a2 * by_height[1][b];
                }
            }
            let terms = pressure_terms(x, y);
            for i in 0..T {
                excess[i] += w * terms[i] * (stress.volume_ratio - 1.0);
                for c in 0..2 {
                    for b in 0..N {
                        volume[i][c][b] += terms[i] * of_volume[c][b];
                    }
                }
            }
        }
        for a in 0..N {
            for c in 0..2 {
                self.residual[c * N + a] = forces[c][a];
            }
            for b in 0..N {
                self.stiffness[a][b] = radial[a][b];
                self.stiffness[N + a][b] = mixed[a][b];
                self.stiffness[b][N + a] = mixed[a][b];
                self.stiffness[N + a][N + b] = axial[a][b];
            }
        }
        for i in 0..T {
            self.residual[2 * N + i] = excess[i];
            for c in 0..2 {
                for b in 0..N {
                    self.stiffness[2 * N + i][c * N + b] = volume[i][c][b];
                    self.stiffness[c * N + b][2 * N + i] = volume[i][c][b];
                }
            }
        }
        least
    }
}

/// Strain energy of an element.
pub fn energy(material: &Material, points: &[Point; POINTS], positions: &Positions) -> f64 {
    points
        .iter()
        .map(|point| {
            let [f11, f12, f, f21, f22] = deformation(point, positions);
            let determinant = f11 * f22 - f12 * f21;
            let squares = f11 * f11 + f12 * f12 + f21 * f21 + f22 * f22;
            let volume = determinant * f - 1.0;
            point.weight
                * (energy_density(
                    &material.law,
                    squares + f * f,
                    determinant * determinant + f * f * squares,
                ) + 0.5 * material.volume_stiffness * volume * volume)
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solid::mesh::{Elements, Mesh, NODES, PRESSURES};

    const LAWS: [Law; 4] = [
        Law::NeoHookean { c1: 0.5 },
        Law::MooneyRivlin { c1: 0.3, c2: 0.2 },
        Law::Yeoh {
            c1: 0.5,
            c2: 0.2,
            c3: 0.1,
        },
        Law::Yeoh {
            c1: 0.5,
            c2: -0.05,
            c3: 0.01,
        },
    ];

    /// The nodes of an element moved somewhere, and amplitudes of the cubic functions.
    fn moved(mesh: &Mesh, to: impl Fn([f64; 2]) -> [f64; 2], cubic: [[f64; 3]; 2]) -> Positions {
        let nodes = mesh.element_nodes(1, 0).map(|node| to(mesh.nodes[node]));
        [0, 1].map(|c| {
            core::array::from_fn(|i| {
                if i < NODES {
                    nodes[i][c]
                } else {
                    cubic[c][i - NODES]
                }
            })
        })
    }

    #[test]
    fn the_undeformed_wall_is_free_of_forces() {
        for law in LAWS {
            let mesh = Mesh::new(0.8, 0.2, Elements { through: 1, along: 4 });
            let positions = moved(&mesh, |x| x, [[0.0; 3]; 2]);
            let mut element = Element::default();
            let mut pressures = [0.0; CUBIC_PRESSURES];
            pressures[0] = pressure_at_rest(&law);
            let least = element.assemble::<FUNCTIONS, CUBIC_PRESSURES>(
                &Material::new(law, true),
                &mesh.points[1],
                &positions,
                &pressures,
            );
            assert!((least - 1.0).abs() < 1e-12);
            assert!(
                element.residual.iter().all(|x| x.abs() < 1e-14),
                "{law:?} {:?}",
                element.residual
            );
        }
    }

    /// Forces are derivatives of the energy with the constraint, stiffness that of the forces; both by central differences. An element
    /// that is stretched, bent and sheared.
    fn derivatives<const N: usize, const T: usize>(cubic: [[f64; 3]; 2]) {
        let mesh = Mesh::new(0.8, 0.2, Elements { through: 1, along: 4 });
        let bent = |[r, z]: [f64; 2]| [1.1 * r + 0.1 * r * z, 0.9 * z + 0.2 * r * r];
        let positions = moved(&mesh, bent, cubic);
        let mut pressures = [0.0; CUBIC_PRESSURES];
        pressures[..T].copy_from_slice(&[-1.3, 0.2, -0.1, 0.3, -0.4][..T]);
        let at = |i: usize| (i / N, i % N);
        for law in LAWS {
            let material = Material::new(law, N > NODES);
            let moved = |j: usize, by: f64| {
                let (mut positions, mut pressures) = (positions, pressures);
                match at(j) {
                    (2, term) => pressures[term] += by,
                    (c, i) => positions[c][i] += by,
                }
                let mut element = Element::default();
                element.assemble::<N, T>(&material, &mesh.points[1], &positions, &pressures);
                let excess = &element.residual[2 * N..2 * N + T];
                let potential = energy(&material, &mesh.points[1], &positions)
                    + (0..T).map(|i| pressures[i] * excess[i]).sum::<f64>();
                (element, potential)
            };
            let (element, _) = moved(0, 0.0);
            let step = 1e-5;
            for j in 0..2 * N + T {
                let ((below, less), (above, more)) = (moved(j, -step), moved(j, step));
                let force = (more - less) / (2.0 * step);
                assert!(
                    (force - element.residual[j]).abs() < 1e-6,
                    "{law:?} {j}: {force} {}",
                    element.residual[j]
                );
                for i in 0..2 * N + T {
                    let slope = (above.residual[i] - below.residual[i]) / (2.0 * step);
                    let found = element.stiffness[i][j];
                    assert!(
                        (slope - found).abs() < 1e-6 * (1.0 + found.abs()),
                        "{law:?} {i} {j}: {slope} {found}"
                    );
                }
            }
        }
    }

    #[test]
    fn forces_and_stiffness_are_derivatives() {
        derivatives::<NODES, PRESSURES>([[0.0; 3]; 2]);
        derivatives::<FUNCTIONS, CUBIC_PRESSURES>([[0.01, -0.02, 0.03], [0.02, 0.01, -0.01]]);
    }
}
