//! The memory of the wall: quasi-linear viscoelasticity at the Gauss points.
//!
//! Beside the relaxed law's stress the wall has one for each term of its [`Relaxation`], `h_i = g_i integral exp(-(t - s) / tau_i)
//! dS_d(s)`, with `S_d` the relaxed second Piola-Kirchhoff stress without its part along `C^-1`: convected with the wall, and no
//! pressure. Over a time step in which `S_d` changes linearly
//!
//! `h_i <- left_i h_i + taken_i (S_d - S_d')`, [`Decay`] from the term and the step, exactly. At the end of a step, therefore, only
//! `taken S_d` depends on the deformation, with `taken = sum taken_i`; the rest is constant. Both have a potential: `taken W_d + H
//! : C / 2`.
//!
//! `W_d` is the law's density at `I1 J^(-2/3)` and `I2 J^(-4/3)`, the powers as parabolas that touch them at `J = 1`, where the wall is.

use super::element::{self, Deformation, Material, in_plane, positions};
use super::lanes::{LANES, Lanes, Real};
use super::mesh::{Mesh, POINTS};
use super::state::State;
use crate::material::relaxation::{Decay, MAX_TERMS, Relaxation};

/// Components of a symmetric tensor in the undeformed wall: radial, shear, axial, hoop.
type Tensor<T = f64> = [T; 4];

/// `J^(-2/3)` and its first two derivatives, near `J = 1 + e`: `1 - 2/3 e + 5/9 e^2`.
#[inline(always)]
fn first_power<T: Real>(e: T) -> [T; 3] {
    let (one, two) = (2.0 / 3.0, 5.0 / 9.0);
    let slope = T::from(-one) + e * (2.0 * two);
    [
        T::from(1.0) + e * (T::from(-one) + e * two),
        slope,
        T::from(2.0 * two),
    ]
}

/// `J^(-4/3)` likewise: `1 - 4/3 e + 14/9 e^2`.
#[inline(always)]
fn second_power<T: Real>(e: T) -> [T; 3] {
    let (one, two) = (4.0 / 3.0, 14.0 / 9.0);
    let slope = T::from(-one) + e * (2.0 * two);
    [
        T::from(1.0) + e * (T::from(-one) + e * two),
        slope,
        T::from(2.0 * two),
    ]
}

/// First derivatives of `W_d` by `S`, `D` and `f`, and what its second ones are made of.
struct Deviatoric<T> {
    by: [T; 3],
    /// First derivatives of the first invariant.
    first: [T; 3],
    slope: T,
    curvature: T,
    powers: [[T; 3]; 2],
    invariants: [T; 2],
}

#[inline(always)]
fn deviatoric<T: Real>(material: &Material, deformation: Deformation<T>) -> Deviatoric<T> {
    let (d, s) = in_plane(deformation);
    let f = deformation[2];
    let (i1, i2) = (s + f * f, d * d + f * f * s);
    let e = d * f - T::from(1.0);
    let (one, two) = (first_power(e), second_power(e));
    let (slope, curvature) = (
        material.constants.slope(i1 * one[0]),
        material.constants.curvature(i1 * one[0]),
    );
    let second = material.constants.second;
    let (by_one, by_two) = (i1 * one[1], i2 * two[1]);
    let first = [one[0], by_one * f, f * one[0] * 2.0 + by_one * d];
    let other = [
        f * f * two[0],
        d * two[0] * 2.0 + by_two * f,
        f * s * two[0] * 2.0 + by_two * d,
    ];
    Deviatoric {
        by: [0, 1, 2].map(|i: usize| slope * first[i] + other[i] * second),
        first,
        slope,
        curvature,
        powers: [one, two],
        invariants: [i1, i2],
    }
}

/// What does not change within a step of time, of elements side by side.
#[derive(Clone, Debug)]
pub struct HeldStress {
    /// Weight of `S_d`.
    taken: f64,
    /// The part of the memory's stress that is known.
    stress: [Tensor<Lanes>; POINTS],
}

/// Adds the memory's stress at a point.
#[inline(always)]
pub(super) fn add_stress(
    material: &Material,
    held: &HeldStress,
    point: usize,
    deformation: Deformation<Lanes>,
    nominal: &mut Deformation<Lanes>,
) {
    let [f11, f12, f, f21, f22] = deformation;
    let [by_s, by_d, by_f] = deviatoric(material, deformation).by.map(
        #[inline(always)]
        |x| x * held.taken,
    );
    let by_s = by_s * 2.0;
    let [h11, h12, h22, h33] = held.stress[point];
    nominal[0] += by_s * f11 + by_d * f22 + f11 * h11 + f12 * h12;
    nominal[1] += by_s * f12 - by_d * f21 + f11 * h12 + f12 * h22;
    nominal[2] += by_f + f * h33;
    nominal[3] += by_s * f21 - by_d * f12 + f21 * h11 + f22 * h12;
    nominal[4] += by_s * f22 + by_d * f11 + f21 * h12 + f22 * h22;
}

/// Where the in-plane components are among all of a deformation.
const IN_PLANE: [usize; 4] = [0, 1, 3, 4];

/// Adds the memory's stiffness at a point.
#[inline(always)]
pub(super) fn add_stiffness(
    material: &Material,
    held: &HeldStress,
    point: usize,
    deformation: Deformation<Lanes>,
    k: &mut [Deformation<Lanes>; 5],
) {
    let [f11, f12, f, f21, f22] = deformation;
    let (d, s) = in_plane(deformation);
    let Deviatoric {
        by: [by_s, by_d, _],
        first: [a_s, a_d, a_f],
        slope,
        curvature,
        powers: [one, two],
        invariants: [i1, i2],
    } = deviatoric(material, deformation);
    let second = material.constants.second;
    let taken = held.taken;
    let j = d * f;
    // Second derivatives of both invariants, then of the density.
    let (one_2, two_2) = (i1 * one[2], i2 * two[2]);
    let join = |x: Lanes, y: Lanes, first: Lanes, other: Lanes| {
        (curvature * x * y + slope * first + other * second) * taken
    };
    let ss = curvature * a_s * a_s * taken;
    let sd = join(a_s, a_d, one[1] * f, f * f * f * two[1]);
    let sf = join(a_s, a_f, one[1] * d, f * two[0] * 2.0 + f * f * d * two[1]);
    let dd = join(
        a_d,
        a_d,
        one_2 * f * f,
        two[0] * 2.0 + j * two[1] * 4.0 + two_2 * f * f,
    );
    let df = join(
        a_d,
        a_f,
        (f * f * 2.0 + i1) * one[1] + one_2 * j,
        (d * d * 2.0 + f * f * s * 2.0 + i2) * two[1] + two_2 * j,
    );
    let ff = join(
        a_f,
        a_f,
        one[0] * 2.0 + j * one[1] * 4.0 + one_2 * d * d,
        s * two[0] * 2.0 + j * s * two[1] * 4.0 + two_2 * d * d,
    );
    let (by_s, by_d) = (by_s * (2.0 * taken), by_d * taken);
    let zero = Lanes::ZERO;
    let deformed = [f11, f12, f21, f22];
    let cofactor = [f22, zero - f21, zero - f12, f11];
    let [h11, h12, h22, h33] = held.stress[point];
    let in_plane = [[h11, h12], [h12, h22]];
    for i in 0..4 {
        for j in i..4 {
            let mut sum = (ss * deformed[i] * deformed[j]) * 4.0
                + sd * (deformed[i] * cofactor[j] + cofactor[i] * deformed[j]) * 2.0
                + dd * cofactor[i] * cofactor[j];
            if i == j {
                sum += by_s;
            }
            if i / 2 == j / 2 {
                sum += in_plane[i % 2][j % 2];
            }
            if (i, j) == (0, 3) {
                sum += by_d;
            }
            if (i, j) == (1, 2) {
                sum = sum - by_d;
            }
            k[IN_PLANE[i]][IN_PLANE[j]] += sum;
            if i != j {
                k[IN_PLANE[j]][IN_PLANE[i]] += sum;
            }
        }
        let sum = sf * deformed[i] * 2.0 + df * cofactor[i];
        k[IN_PLANE[i]][2] += sum;
        k[2][IN_PLANE[i]] += sum;
    }
    k[2][2] += ff + h33;
}

/// `S_d` of a deformation.
fn deviatoric_stress(material: &Material, deformation: Deformation) -> Tensor {
    let f = deformation[2];
    let [by_s, by_d, by_f] = deviatoric(material, deformation).by;
    let (d, _) = in_plane(deformation);
    let [c11, c12, c22, _] = strain(deformation);
    // By C: of S the unit tensor, of D half of D C^-1 in the plane, of f half of 1 / f.
    let by_d = by_d / d;
    [
        2.0 * by_s + by_d * c22,
        -by_d * c12,
        2.0 * by_s + by_d * c11,
        by_f / f,
    ]
}

/// `C` of a deformation.
fn strain([f11, f12, f, f21, f22]: Deformation) -> Tensor {
    [
        f11 * f11 + f21 * f21,
        f11 * f12 + f21 * f22,
        f12 * f12 + f22 * f22,
        f * f,
    ]
}

/// The memory's stress at a point.
#[derive(Clone, Copy, Debug)]
struct Point {
    /// `S_d` at the end of the latest step.
    stress: Tensor,
    /// `C` there.
    strain: Tensor,
    /// The terms' stresses.
    terms: [Tensor; MAX_TERMS],
}

/// The memory of a wall.
#[derive(Clone, Debug)]
pub(super) struct Memory {
    relaxation: Relaxation,
    /// Constants of the present step.
    decays: [Decay; MAX_TERMS],
    taken: f64,
    held: Vec<HeldStress>,
    points: Vec<[Point; POINTS]>,
    /// Values at the end of the present step.
    next: Vec<[Point; POINTS]>,
}

impl Memory {
    /// The memory of an undeformed wall without any past deformation.
    pub(super) fn new(mesh: &Mesh, relaxation: &Relaxation) -> Self {
        let elements = mesh.points.len();
        let none = Point {
            stress: [0.0; 4],
            strain: [1.0, 0.0, 1.0, 1.0],
            terms: [[0.0; 4]; MAX_TERMS],
        };
        Self {
            relaxation: *relaxation,
            decays: [Decay::default(); MAX_TERMS],
            taken: 0.0,
            held: vec![
                HeldStress {
                    taken: 0.0,
                    stress: [[Lanes::ZERO; 4]; POINTS],
                };
                elements.div_ceil(LANES)
            ],
            points: vec![[none; POINTS]; elements],
            next: vec![[none; POINTS]; elements],
        }
    }

    /// Stiffness of the wall in the present step, over its relaxed stiffness.
    pub(super) fn stiffening(&self) -> f64 {
        1.0 + self.taken
    }

    /// The constants of the present step, for a batch of elements.
    pub(super) fn held(&self, batch: usize) -> &HeldStress {
        &self.held[batch]
    }

    /// Begins a step of `seconds` after the latest accepted step, and discards the present one.
    pub(super) fn begin(&mut self, seconds: f64) {
        let count = self.relaxation.terms().len();
        for (decay, term) in self.decays.iter_mut().zip(self.relaxation.terms()) {
            *decay = term.over(seconds);
        }
        self.taken = self.decays[..count].iter().map(|decay| decay.taken).sum();
        for (e, points) in self.points.iter().enumerate() {
            let held = &mut self.held[e / LANES];
            held.taken = self.taken;
            for (point, stress) in points.iter().zip(&mut held.stress) {
                for (i, component) in stress.iter_mut().enumerate() {
                    let terms = self.decays[..count].iter().zip(&point.terms);
                    let left: f64 = terms.map(|(decay, term)| decay.left * term[i]).sum();
                    component.0[e % LANES] = left - self.taken * point.stress[i];
                }
            }
        }
    }

    /// Ends the present step in a state. The memory's work in it, of the mean of its stresses before and after.
    pub(super) fn end(&mut self, mesh: &Mesh, material: &Material, state: &State) -> f64 {
        let count = self.relaxation.terms().len();
        let through = mesh.elements.through;
        let mut work = 0.0;
        for (e, (points, next)) in self.points.iter().zip(&mut self.next).enumerate() {
            let positions = positions(mesh, &state.nodes, e / through, e % through);
            for ((point, next), place) in points.iter().zip(next).zip(&mesh.points[e]) {
                let deformation = element::deformation(&place.gradient, &positions);
                next.stress = deviatoric_stress(material, deformation);
                next.strain = strain(deformation);
                for i in 0..4 {
                    let change = next.stress[i] - point.stress[i];
                    let mut mean = 0.0;
                    for (k, decay) in self.decays[..count].iter().enumerate() {
                        next.terms[k][i] = decay.left * point.terms[k][i] + decay.taken * change;
                        mean += 0.5 * (point.terms[k][i] + next.terms[k][i]);
                    }
                    // The shear stands for two components.
                    let weight = if i == 1 { 1.0 } else { 0.5 };
                    work += place.weight * weight * mean * (next.strain[i] - point.strain[i]);
                }
            }
        }
        work
    }

    /// Accepts the ended step.
    pub(super) fn take(&mut self) {
        core::mem::swap(&mut self.points, &mut self.next);
    }
}

#[cfg(test)]
mod tests;
