//! The mechanics of a point of an element: stress, stiffness and energy of a deformation.
//!
//! In-plane gradient `F` (2 x 2), hoop stretch `f = r/R`, `D = det F`, `S = |F|^2`, `J = D f`; the invariants are
//! `I1 = S + f^2` and `I2 = D^2 + f^2 S` (as `J = 1`). The density is `W(I1, I2) + p (J - 1)`, with the pressure `p`
//! linear in each element and discontinuous between them ([`pressure_terms`]). Where [`Material`] says so, the density has a term
//! `k/2 (J - 1)^2` besides.

use super::lanes::Real;
use super::mesh::{CUBIC_PRESSURES, FUNCTIONS, Mesh, NODES};
use crate::material::{Hyperelastic as _, Law};

/// A law as a sum of powers of the invariants.
#[derive(Clone, Copy, Debug)]
pub(super) struct Constants {
    /// Of `I1 - 3`, its square and its cube.
    first: [f64; 3],
    /// Of `I2 - 3`.
    pub(super) second: f64,
}

impl Constants {
    fn of(law: &Law) -> Self {
        let (first, second) = match *law {
            Law::NeoHookean { c1 } => ([c1, 0.0, 0.0], 0.0),
            Law::MooneyRivlin { c1, c2 } => ([c1, 0.0, 0.0], c2),
            Law::Yeoh { c1, c2, c3 } => ([c1, c2, c3], 0.0),
        };
        Self { first, second }
    }

    /// Strain-energy density.
    #[inline(always)]
    fn energy<T: Real>(&self, i1: T, i2: T) -> T {
        let [c1, c2, c3] = self.first;
        let e = i1 - T::from(3.0);
        e * (T::from(c1) + e * (T::from(c2) + e * c3)) + (i2 - T::from(3.0)) * self.second
    }

    /// Its first derivative by `I1`.
    #[inline(always)]
    pub(super) fn slope<T: Real>(&self, i1: T) -> T {
        let [c1, c2, c3] = self.first;
        let e = i1 - T::from(3.0);
        T::from(c1) + e * (T::from(2.0 * c2) + e * (3.0 * c3))
    }

    /// Its second derivative by `I1`.
    #[inline(always)]
    pub(super) fn curvature<T: Real>(&self, i1: T) -> T {
        let [_, c2, c3] = self.first;
        T::from(2.0 * c2) + (i1 - T::from(3.0)) * (6.0 * c3)
    }
}

/// Volume stiffness `k`, in shear moduli, if there is one.
const VOLUME_STIFFNESS: f64 = 1.0 / 3.0;

/// Volume stiffness besides, in `-C2` of a law that softens.
const CURVATURE: f64 = 8.0;

/// A law, and a stiffness against the volume changes that the pressure's terms do not prevent.
#[derive(Clone, Copy, Debug)]
pub struct Material {
    /// The law.
    pub law: Law,
    pub(super) constants: Constants,
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
            constants: Constants::of(&law),
            volume_stiffness: moduli * law.shear_modulus() + by_curvature,
        }
    }
}

/// The pressure of an undeformed, unstressed wall.
pub fn pressure_at_rest(law: &Law) -> f64 {
    let constants = Constants::of(law);
    -(2.0 * constants.first[0] + 4.0 * constants.second)
}

/// Deformation at a point: `F11, F12, f, F21, F22`.
pub type Deformation<T = f64> = [T; 5];

/// Radii and heights of an element's nodes, deformed, and the amplitudes of its cubic functions.
pub type Positions = [[f64; FUNCTIONS]; 2];

/// `I1` of a deformation.
pub fn first_invariant([f11, f12, f, f21, f22]: Deformation) -> f64 {
    f11 * f11 + f12 * f12 + f21 * f21 + f22 * f22 + f * f
}

/// Whether the law softens at a point: where in simple shear by `e = I1 - 3` the stress no longer grows, `W' + 2 e W'' <= 0`.
pub fn softens(law: &Law, deformation: Deformation) -> bool {
    let constants = Constants::of(law);
    let i1 = first_invariant(deformation);
    constants.slope(i1) + constants.second + 2.0 * (i1 - 3.0) * constants.curvature(i1) <= 0.0
}

/// The deformation at a point with these [`Point::gradient`](super::mesh::Point::gradient)s.
#[inline(always)]
pub fn deformation<T: Real, const N: usize>(
    [g1, g2, g3]: &[[T; N]; 3],
    [r, z]: &[[T; N]; 2],
) -> Deformation<T> {
    let mut d = [T::from(0.0); 5];
    for i in 0..N {
        d[0] += g1[i] * r[i];
        d[1] += g2[i] * r[i];
        d[2] += g3[i] * r[i];
        d[3] += g1[i] * z[i];
        d[4] += g2[i] * z[i];
    }
    d
}

/// In-plane determinant and squares.
#[inline(always)]
pub(super) fn in_plane<T: Real>([f11, f12, _, f21, f22]: Deformation<T>) -> (T, T) {
    (
        f11 * f22 - f12 * f21,
        f11 * f11 + f12 * f12 + f21 * f21 + f22 * f22,
    )
}

/// The stress at a point.
#[derive(Clone, Copy, Debug)]
pub struct Stress<T = f64> {
    /// Nominal stress: derivatives of the density by the deformation.
    pub nominal: Deformation<T>,
    /// Volume ratio minus one.
    pub excess: T,
}

/// The stress, also where the wall is turned inside out, as on the way to a solution it may be.
#[inline(always)]
pub fn stress<T: Real>(material: &Material, deformation: Deformation<T>, pressure: T) -> Stress<T> {
    let [f11, f12, f, f21, f22] = deformation;
    let (determinant, squares) = in_plane(deformation);
    let constants = material.constants;
    let (first, second) = (constants.slope(squares + f * f), constants.second);
    let excess = determinant * f - T::from(1.0);
    let pressure = pressure + excess * material.volume_stiffness;
    // Derivatives of the density by S, D and f.
    let by_s = (first + f * f * second) * 2.0;
    let by_d = determinant * (2.0 * second) + pressure * f;
    let by_f = f * (first + squares * second) * 2.0 + pressure * determinant;
    Stress {
        nominal: [
            by_s * f11 + by_d * f22,
            by_s * f12 - by_d * f21,
            by_f,
            by_s * f21 - by_d * f12,
            by_s * f22 + by_d * f11,
        ],
        excess,
    }
}

/// Where a deformation's components in the plane of the meridian are.
const IN_PLANE: [usize; 4] = [0, 1, 3, 4];

/// Second derivatives of the density, in the order of the [`Deformation`], and the volume ratio's first.
#[inline(always)]
pub fn stiffness<T: Real>(
    material: &Material,
    deformation: Deformation<T>,
    pressure: T,
) -> ([Deformation<T>; 5], Deformation<T>) {
    let [f11, f12, f, f21, f22] = deformation;
    let (determinant, squares) = in_plane(deformation);
    let constants = material.constants;
    let (i1, second) = (squares + f * f, constants.second);
    let (first, curvature) = (constants.slope(i1), constants.curvature(i1));
    let volume_stiffness = material.volume_stiffness;
    let pressure = pressure + (determinant * f - T::from(1.0)) * volume_stiffness;
    let by_s = (first + f * f * second) * 2.0;
    let by_d = determinant * (2.0 * second) + pressure * f;
    let by_sf = f * (curvature + T::from(second)) * 4.0;
    let by_ff = (first + squares * second) * 2.0 + f * f * curvature * 4.0;
    let deformed = [f11, f12, f21, f22];
    let cofactor = [f22, T::from(0.0) - f21, T::from(0.0) - f12, f11];
    let by_square = curvature * 4.0;
    let by_volume = f * f * volume_stiffness + T::from(2.0 * second);
    let hoop = pressure + determinant * f * volume_stiffness;
    let zero = T::from(0.0);
    let mut k = [[zero; 5]; 5];
    for i in 0..4 {
        for j in i..4 {
            let mut sum = by_square * deformed[i] * deformed[j] + by_volume * cofactor[i] * cofactor[j];
            // The squares' and the determinant's own second derivatives.
            if i == j {
                sum += by_s;
            }
            if (i, j) == (0, 3) {
                sum += by_d;
            }
            if (i, j) == (1, 2) {
                sum = sum - by_d;
            }
            k[IN_PLANE[i]][IN_PLANE[j]] = sum;
            k[IN_PLANE[j]][IN_PLANE[i]] = sum;
        }
        let sum = by_sf * deformed[i] + hoop * cofactor[i];
        k[IN_PLANE[i]][2] = sum;
        k[2][IN_PLANE[i]] = sum;
    }
    k[2][2] = by_ff + determinant * determinant * volume_stiffness;
    let by_deformation = [
        f * cofactor[0],
        f * cofactor[1],
        determinant,
        f * cofactor[2],
        f * cofactor[3],
    ];
    (k, by_deformation)
}

/// Strain-energy density at a point.
#[inline(always)]
pub fn energy_density<T: Real>(material: &Material, deformation: Deformation<T>) -> T {
    let (determinant, squares) = in_plane(deformation);
    let f = deformation[2];
    let excess = determinant * f - T::from(1.0);
    let energy = material
        .constants
        .energy(squares + f * f, determinant * determinant + f * f * squares);
    energy + excess * excess * (0.5 * material.volume_stiffness)
}

/// The smaller of the in-plane determinant and the hoop stretch. It is positive unless the element is turned inside out.
pub fn least(deformation: Deformation) -> f64 {
    in_plane(deformation).0.min(deformation[2])
}

/// Values of the pressure's terms at a place in `[-1, 1]` along and through. A biquadratic element has the first
/// [`PRESSURES`](super::mesh::PRESSURES) of them.
pub fn pressure_terms(x: f64, y: f64) -> [f64; CUBIC_PRESSURES] {
    [1.0, x, y, x * y, y * y - 1.0 / 3.0]
}

/// Pressure at a place. The missing terms of an element with fewer terms count as 0.
pub fn pressure_at(x: f64, y: f64, pressures: &[f64; CUBIC_PRESSURES]) -> f64 {
    let terms = pressure_terms(x, y);
    (0..CUBIC_PRESSURES).map(|i| terms[i] * pressures[i]).sum()
}

/// Radii and heights of an element's nodes, and the amplitudes of its cubic functions.
pub fn positions(mesh: &Mesh, nodes: &[[f64; 2]], column: usize, layer: usize) -> Positions {
    let at = mesh.element_nodes(column, layer);
    [0, 1].map(|c| {
        core::array::from_fn(|i| {
            if i < NODES {
                nodes[at[i]][c]
            } else if mesh.is_cubic() {
                nodes[mesh.node(2 * column + i - NODES, mesh.layers())][c]
            } else {
                0.0
            }
        })
    })
}
