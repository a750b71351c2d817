//! Several elements side by side: their forces and their stiffness.
//!
//! The pressure of an element belongs to this element only, so it is eliminated before assembly. Its rows `B u = -g` have no
//! diagonal. For the step of Newton's method they get a small one, `-m / c`, with `m` the volume of a term of the pressure and
//! `c` the constant `BULK`. This acts as if the wall were slightly compressible. The residual does not have this term, so the
//! solution is exactly incompressible; a step leaves about `1 / c` of an excess of volume to the next one. As a benefit, the
//! remaining equations are symmetric, and positive definite where the state is stable.

use super::element::{self, Deformation, Material};
use super::lanes::{LANES, Lanes};
use super::memory::{self, HeldStress};
use super::mesh::{CUBIC_PRESSURES, Mesh, NODES, PLACES, POINTS};

/// Bulk modulus in the steps of Newton's method, in shear moduli.
const BULK: f64 = 1e5;

/// Position of an element's `N` functions among a mesh's nodes, in the order of the nodes.
pub fn nodes<const N: usize>(mesh: &Mesh, column: usize, layer: usize) -> [usize; N] {
    core::array::from_fn(|i| {
        let function = function::<N>(i);
        if function < NODES {
            mesh.node(2 * column + function / 3, 2 * layer + function % 3)
        } else {
            mesh.node(2 * column + function - NODES, mesh.layers())
        }
    })
}

/// Which function is in a place: the cubic ones stand behind their stations' nodes.
fn function<const N: usize>(place: usize) -> usize {
    let per_station = N / 3;
    let (station, layer) = (place / per_station, place % per_station);
    if layer < 3 {
        3 * station + layer
    } else {
        NODES + station
    }
}

/// Elements side by side, of `N` functions and `T` terms of the pressure.
#[derive(Clone, Debug)]
pub struct Batch<const N: usize, const T: usize> {
    /// Number of lanes that hold an element. The other lanes have weight 0.
    pub count: usize,
    /// Position of each function among the mesh's nodes.
    pub nodes: [[usize; N]; LANES],
    /// Undeformed volume of each Gauss point.
    weight: [Lanes; POINTS],
    /// Derivatives by the undeformed radius and height, and values over the radius, of the functions at each Gauss point.
    gradient: Box<[[[Lanes; N]; 3]; POINTS]>,
    /// [`BULK`] divided by the volume of each term of the pressure.
    bulk: [Lanes; T],
}

/// Forces of elements side by side.
#[derive(Clone, Debug)]
pub struct Forces<const N: usize, const T: usize> {
    /// Forces on radii and heights.
    pub nodes: [[Lanes; N]; 2],
    /// Excess volume.
    pub excess: [Lanes; T],
}

/// Stiffness of elements side by side.
#[derive(Clone, Debug)]
pub struct Stiffness<const N: usize, const T: usize> {
    /// Radius by radius, the upper half.
    pub radial: [[Lanes; N]; N],
    /// Radius by height.
    pub mixed: [[Lanes; N]; N],
    /// Height by height, the upper half.
    pub axial: [[Lanes; N]; N],
    /// Volume by radius and height.
    pub volume: [[[Lanes; N]; 2]; T],
}

impl<const N: usize, const T: usize> Default for Stiffness<N, T> {
    fn default() -> Self {
        Self {
            radial: [[Lanes::ZERO; N]; N],
            mixed: [[Lanes::ZERO; N]; N],
            axial: [[Lanes::ZERO; N]; N],
            volume: [[[Lanes::ZERO; N]; 2]; T],
        }
    }
}

/// Values of the terms of the pressure at a Gauss point.
fn terms(point: usize) -> [f64; CUBIC_PRESSURES] {
    element::pressure_terms(PLACES[point / 3], PLACES[point % 3])
}

impl<const N: usize, const T: usize> Batch<N, T> {
    /// All elements of a mesh, in its order.
    pub fn all(mesh: &Mesh, shear_modulus: f64) -> Vec<Self> {
        let elements = mesh.points.len();
        (0..elements)
            .step_by(LANES)
            .map(|first| Self::new(mesh, first, (elements - first).min(LANES), shear_modulus))
            .collect()
    }

    fn new(mesh: &Mesh, first: usize, count: usize, shear_modulus: f64) -> Self {
        let through = mesh.elements.through;
        // The lanes after the last element repeat it with weight 0.
        let element = |lane: usize| first + lane.min(count - 1);
        let mut weight = [Lanes::ZERO; POINTS];
        let mut gradient = Box::new([[[Lanes::ZERO; N]; 3]; POINTS]);
        let mut stands_for = [Lanes::ZERO; T];
        for lane in 0..LANES {
            for (p, point) in mesh.points[element(lane)].iter().enumerate() {
                if lane < count {
                    weight[p].0[lane] = point.weight;
                }
                for c in 0..3 {
                    for i in 0..N {
                        gradient[p][c][i].0[lane] = point.gradient[c][function::<N>(i)];
                    }
                }
                for (i, sum) in stands_for.iter_mut().enumerate() {
                    sum.0[lane] += point.weight * terms(p)[i] * terms(p)[i];
                }
            }
        }
        Self {
            count,
            nodes: core::array::from_fn(|lane| {
                nodes::<N>(mesh, element(lane) / through, element(lane) % through)
            }),
            weight,
            gradient,
            bulk: stands_for.map(|volume| Lanes(volume.0.map(|volume| BULK * shear_modulus / volume))),
        }
    }

    /// Radii and heights of the functions.
    #[inline(always)]
    fn gather(&self, nodes: &[[f64; 2]]) -> [[Lanes; N]; 2] {
        let mut gathered = [[Lanes::ZERO; N]; 2];
        for lane in 0..LANES {
            for i in 0..N {
                let node = nodes[self.nodes[lane][i]];
                gathered[0][i].0[lane] = node[0];
                gathered[1][i].0[lane] = node[1];
            }
        }
        gathered
    }

    /// Terms of the pressures; `pressures` are those of the elements from this batch's first on.
    #[inline(always)]
    fn pressures(&self, pressures: &[[f64; CUBIC_PRESSURES]]) -> [Lanes; T] {
        let mut gathered = [Lanes::ZERO; T];
        for (lane, pressures) in pressures.iter().take(self.count).enumerate() {
            for i in 0..T {
                gathered[i].0[lane] = pressures[i];
            }
        }
        gathered
    }

    /// Forces in a state.
    #[inline(always)]
    pub fn forces(
        &self,
        material: &Material,
        nodes: &[[f64; 2]],
        pressures: &[[f64; CUBIC_PRESSURES]],
        held: Option<&HeldStress>,
    ) -> Forces<N, T> {
        let positions = self.gather(nodes);
        let pressures = self.pressures(pressures);
        let mut forces = Forces {
            nodes: [[Lanes::ZERO; N]; 2],
            excess: [Lanes::ZERO; T],
        };
        for (p, gradient) in self.gradient.iter().enumerate() {
            let terms = terms(p);
            let deformation = element::deformation(gradient, &positions);
            let mut stress = element::stress(material, deformation, pressure_at(&terms, &pressures));
            if let Some(held) = held {
                memory::add_stress(material, held, p, deformation, &mut stress.nominal);
            }
            let weight = self.weight[p];
            let n = stress.nominal.map(|x| x * weight);
            let [g1, g2, g3] = gradient;
            for i in 0..N {
                forces.nodes[0][i] += n[0] * g1[i] + n[1] * g2[i] + n[2] * g3[i];
                forces.nodes[1][i] += n[3] * g1[i] + n[4] * g2[i];
            }
            let excess = stress.excess * weight;
            for i in 0..T {
                forces.excess[i] += excess * terms[i];
            }
        }
        forces
    }

    /// Stiffness in a state.
    #[inline(always)]
    pub fn stiffness(
        &self,
        material: &Material,
        nodes: &[[f64; 2]],
        pressures: &[[f64; CUBIC_PRESSURES]],
        held: Option<&HeldStress>,
        stiffness: &mut Stiffness<N, T>,
    ) {
        let positions = self.gather(nodes);
        let pressures = self.pressures(pressures);
        *stiffness = Stiffness::default();
        for (p, gradient) in self.gradient.iter().enumerate() {
            let terms = terms(p);
            let deformation = element::deformation(gradient, &positions);
            let (mut k, v) = element::stiffness(material, deformation, pressure_at(&terms, &pressures));
            if let Some(held) = held {
                memory::add_stiffness(material, held, p, deformation, &mut k);
            }
            let weight = self.weight[p];
            stiffness.add(gradient, &k, &v, weight, &terms);
        }
    }

    /// Eliminates the pressures: what the radii and heights feel of them, in the stiffness. The wall is `stiffening` times as stiff as relaxed.
    #[inline(always)]
    pub fn condense(&self, stiffening: f64, stiffness: &mut Stiffness<N, T>) {
        let Stiffness {
            radial,
            mixed,
            axial,
            volume,
        } = stiffness;
        for (term, bulk) in volume.iter().zip(self.bulk) {
            let [by_radius, by_height] = term;
            let bulk = bulk * stiffening;
            for a in 0..N {
                let (r, z) = (bulk * by_radius[a], bulk * by_height[a]);
                for b in a..N {
                    radial[a][b] += r * by_radius[b];
                    axial[a][b] += z * by_height[b];
                }
                for b in 0..N {
                    mixed[a][b] += r * by_height[b];
                }
            }
        }
    }

    /// What the pressures answer to an excess of volume.
    #[inline(always)]
    pub fn answer(&self, stiffening: f64, excess: &[Lanes; T]) -> [Lanes; T] {
        core::array::from_fn(|i| self.bulk[i] * excess[i] * stiffening)
    }

    /// Change of volume with a step of the nodes.
    #[inline(always)]
    pub fn change(&self, volume: &[[[Lanes; N]; 2]; T], step: &[[f64; 2]]) -> [Lanes; T] {
        let step = self.gather(step);
        let mut change = [Lanes::ZERO; T];
        for (sum, term) in change.iter_mut().zip(volume) {
            for c in 0..2 {
                for i in 0..N {
                    *sum += term[c][i] * step[c][i];
                }
            }
        }
        change
    }

    /// Strain energy.
    #[inline(always)]
    pub fn energy(&self, material: &Material, nodes: &[[f64; 2]]) -> f64 {
        let positions = self.gather(nodes);
        let mut sum = Lanes::ZERO;
        for (gradient, &weight) in self.gradient.iter().zip(&self.weight) {
            sum += element::energy_density(material, element::deformation(gradient, &positions)) * weight;
        }
        sum.sum()
    }
}

#[inline(always)]
fn pressure_at<const T: usize>(terms: &[f64; CUBIC_PRESSURES], pressures: &[Lanes; T]) -> Lanes {
    let mut pressure = Lanes::ZERO;
    for i in 0..T {
        pressure += pressures[i] * terms[i];
    }
    pressure
}

impl<const N: usize, const T: usize> Stiffness<N, T> {
    /// Adds the contribution of a Gauss point.
    #[inline(always)]
    fn add(
        &mut self,
        [g1, g2, g3]: &[[Lanes; N]; 3],
        k: &[Deformation<Lanes>; 5],
        v: &Deformation<Lanes>,
        weight: Lanes,
        terms: &[f64; CUBIC_PRESSURES],
    ) {
        for b in 0..N {
            let [w1, w2, w3] = [g1[b] * weight, g2[b] * weight, g3[b] * weight];
            // Stiffness times gradient, of the node's radius and height.
            let radial = [0, 1, 2, 3, 4].map(
                #[inline(always)]
                |i: usize| k[i][0] * w1 + k[i][1] * w2 + k[i][2] * w3,
            );
            let axial = [3, 4].map(
                #[inline(always)]
                |i: usize| k[i][3] * w1 + k[i][4] * w2,
            );
            for a in 0..=b {
                self.radial[a][b] += radial[0] * g1[a] + radial[1] * g2[a] + radial[2] * g3[a];
                self.axial[a][b] += axial[0] * g1[a] + axial[1] * g2[a];
            }
            // Of this node's radius by every height.
            for a in 0..N {
                self.mixed[b][a] += radial[3] * g1[a] + radial[4] * g2[a];
            }
            let of_volume = [v[0] * w1 + v[1] * w2 + v[2] * w3, v[3] * w1 + v[4] * w2];
            for (term, &value) in self.volume.iter_mut().zip(terms) {
                term[0][b] += of_volume[0] * value;
                term[1][b] += of_volume[1] * value;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Law;
    use crate::solid::mesh::{Elements, FUNCTIONS, PRESSURES};

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

    /// A wall of a batch and a part of one, the elements from inside to outside one after the other.
    fn wall(cubic: bool) -> Mesh {
        let through = if cubic { 1 } else { 2 };
        Mesh::new(0.8, 0.2, Elements { through, along: 3 })
    }

    #[test]
    fn the_undeformed_wall_is_free_of_forces() {
        for law in LAWS {
            let mesh = wall(true);
            let material = Material::new(law, true);
            let pressures = vec![[element::pressure_at_rest(&law), 0.0, 0.0, 0.0, 0.0]; mesh.points.len()];
            for batch in Batch::<FUNCTIONS, CUBIC_PRESSURES>::all(&mesh, 1.0) {
                let forces = batch.forces(&material, &mesh.nodes, &pressures, None);
                let largest = forces.nodes.as_flattened().iter().chain(&forces.excess);
                assert!(
                    largest.map(|x| x.largest()).fold(0.0, f64::max) < 1e-14,
                    "{law:?}"
                );
            }
        }
    }

    /// Forces are derivatives of the energy with the constraint, stiffness that of the forces; both by central differences. Elements
    /// that are stretched, bent and sheared.
    fn derivatives<const N: usize, const T: usize>() {
        let cubic = N > NODES;
        let mesh = wall(cubic);
        let mut random = crate::random::Random(5);
        let mut noise = || 0.01 * (random.unit() - 0.5);
        let bent = |[r, z]: [f64; 2]| [1.1 * r + 0.1 * r * z, 0.9 * z + 0.2 * r * r];
        let nodes: Vec<[f64; 2]> = mesh.nodes.iter().map(|x| bent(*x).map(|x| x + noise())).collect();
        let mut pressure = || core::array::from_fn(|i| [-1.3, 0.2, -0.1, 0.3, -0.4][i] + noise());
        let pressures: Vec<[f64; CUBIC_PRESSURES]> = mesh.points.iter().map(|_| pressure()).collect();
        for law in LAWS {
            let material = Material::new(law, cubic);
            let batches = Batch::<N, T>::all(&mesh, 1.0);
            // The last is not full.
            for (batch, pressures) in batches.iter().zip(pressures.chunks(LANES)) {
                let mut stiffness = Stiffness::default();
                batch.stiffness(&material, &nodes, pressures, None, &mut stiffness);
                let forces = batch.forces(&material, &nodes, pressures, None);
                let lane = batch.count - 1;
                for (j, &node) in batch.nodes[lane].iter().enumerate() {
                    for c in 0..2 {
                        let step = 1e-5;
                        let [(below, less), (above, more)] = [-step, step].map(|by| {
                            let mut nodes = nodes.clone();
                            nodes[node][c] += by;
                            let forces = batch.forces(&material, &nodes, pressures, None);
                            let mut potential = batch.energy(&material, &nodes);
                            for lane in 0..batch.count {
                                let terms = forces.excess.iter().zip(&pressures[lane]);
                                potential += terms.map(|(excess, p)| excess.0[lane] * p).sum::<f64>();
                            }
                            (forces, potential)
                        });
                        // The node's forces from all lanes that have it.
                        let mut force = 0.0;
                        for lane in 0..batch.count {
                            let places = batch.nodes[lane].iter().zip(&forces.nodes[c]);
                            force += places
                                .filter(|(other, _)| **other == node)
                                .map(|(_, force)| force.0[lane])
                                .sum::<f64>();
                        }
                        let slope = (more - less) / (2.0 * step);
                        assert!((slope - force).abs() < 1e-6, "{law:?} {j}: {slope} {force}");
                        let by =
                            |below: &Lanes, above: &Lanes| (above.0[lane] - below.0[lane]) / (2.0 * step);
                        for i in 0..N {
                            let found = match c {
                                0 => [stiffness.radial[i.min(j)][i.max(j)], stiffness.mixed[j][i]],
                                _ => [stiffness.mixed[i][j], stiffness.axial[i.min(j)][i.max(j)]],
                            };
                            for row in 0..2 {
                                let slope = by(&below.nodes[row][i], &above.nodes[row][i]);
                                let found = found[row].0[lane];
                                assert!(
                                    (slope - found).abs() < 1e-6 * (1.0 + found.abs()),
                                    "{law:?} {row} {i} {c} {j}: {slope} {found}"
                                );
                            }
                        }
                        for i in 0..T {
                            let slope = by(&below.excess[i], &above.excess[i]);
                            let found = stiffness.volume[i][c][j].0[lane];
                            assert!(
                                (slope - found).abs() < 1e-6,
                                "{law:?} {i} {c} {j}: {slope} {found}"
                            );
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn forces_and_stiffness_are_derivatives() {
        derivatives::<NODES, PRESSURES>();
        derivatives::<FUNCTIONS, CUBIC_PRESSURES>();
    }
}
