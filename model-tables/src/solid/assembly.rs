//! All elements of a wall: their forces, and their stiffness in the linear equations.

use super::batch::{Batch, Forces, Stiffness};
use super::element::Material;
use super::frontal::FrontalMatrix;
use super::lanes::{Lanes, vectorised};
use super::memory::Memory;
use super::mesh::{CUBIC_PRESSURES, FUNCTIONS, Mesh, NODES, PRESSURES};
use super::state::State;
use crate::material::Hyperelastic as _;

/// The elements of a mesh, all of one kind.
#[derive(Clone, Debug)]
struct Elements<const N: usize, const T: usize> {
    batches: Vec<Batch<N, T>>,
    /// Where the upper half of an element's stiffness is kept in its column: for every layer of elements, by the places of its functions.
    places: Vec<[[usize; N]; N]>,
    /// Excess volume in the latest state.
    excess: Vec<[Lanes; T]>,
    /// Derivative of the volume by the nodes, in the state of the latest stiffness.
    volume: Vec<[[[Lanes; N]; 2]; T]>,
    through: usize,
    work: Box<Stiffness<N, T>>,
    /// How many times as stiff as relaxed the wall is, in the latest stiffness.
    stiffening: f64,
}

impl<const N: usize, const T: usize> Elements<N, T> {
    fn new(mesh: &Mesh, material: &Material) -> Self {
        let batches = Batch::all(mesh, material.law.shear_modulus());
        let station = 2 * mesh.stride();
        let places = (0..mesh.elements.through)
            .map(|layer| {
                let nodes = super::batch::nodes::<N>(mesh, 0, layer);
                nodes.map(|a| nodes.map(|b| FrontalMatrix::place(station, 2 * a.min(b), 2 * a.max(b))))
            })
            .collect();
        Self {
            excess: vec![[Lanes::ZERO; T]; batches.len()],
            volume: vec![[[[Lanes::ZERO; N]; 2]; T]; batches.len()],
            batches,
            places,
            through: mesh.elements.through,
            work: Box::default(),
            stiffening: 1.0,
        }
    }

    #[inline(always)]
    fn forces(
        &mut self,
        material: &Material,
        memory: Option<&Memory>,
        state: &State,
        forces: &mut [[f64; 2]],
    ) -> f64 {
        let mut largest = Lanes::ZERO.largest();
        let pressures = state.pressures.chunks(super::lanes::LANES);
        let batches = self.batches.iter().enumerate().zip(pressures);
        for (((i, batch), pressures), kept) in batches.zip(&mut self.excess) {
            let held = memory.map(|memory| memory.held(i));
            let Forces { nodes, excess } = batch.forces(material, &state.nodes, pressures, held);
            for (lane, places) in batch.nodes.iter().enumerate().take(batch.count) {
                for (i, &node) in places.iter().enumerate() {
                    forces[node][0] += nodes[0][i].0[lane];
                    forces[node][1] += nodes[1][i].0[lane];
                }
            }
            for term in excess {
                let of_batch = term.largest();
                largest = if of_batch.is_nan() {
                    of_batch
                } else {
                    largest.max(of_batch)
                };
            }
            *kept = excess;
        }
        largest
    }

    #[inline(always)]
    fn stiffness(
        &mut self,
        material: &Material,
        memory: Option<&Memory>,
        state: &State,
        fronts: &mut FrontalMatrix,
    ) {
        self.stiffening = memory.map_or(1.0, Memory::stiffening);
        let width = FrontalMatrix::width(2 * (N / 3 + 2 * (self.through - 1)));
        let mut element = 0;
        let pressures = state.pressures.chunks(super::lanes::LANES);
        let batches = self.batches.iter().enumerate().zip(pressures);
        for (((i, batch), pressures), volume) in batches.zip(&mut self.volume) {
            let work = &mut *self.work;
            let held = memory.map(|memory| memory.held(i));
            batch.stiffness(material, &state.nodes, pressures, held, work);
            *volume = work.volume;
            batch.condense(self.stiffening, work);
            for lane in 0..batch.count {
                let places = &self.places[element % self.through];
                let front = fronts.column(element / self.through);
                for a in 0..N {
                    for b in a..N {
                        let at = places[a][b];
                        front[at] += work.radial[a][b].0[lane];
                        front[at + 1] += work.mixed[a][b].0[lane];
                        front[at + width + 1] += work.axial[a][b].0[lane];
                        if b > a {
                            // Height of the first by radius of the second.
                            front[at + width] += work.mixed[b][a].0[lane];
                        }
                    }
                }
                element += 1;
            }
        }
    }

    #[inline(always)]
    fn answer(&self, right_side: &mut [[f64; 2]]) {
        for ((batch, excess), volume) in self.batches.iter().zip(&self.excess).zip(&self.volume) {
            let pressures = batch.answer(self.stiffening, excess);
            for c in 0..2 {
                for i in 0..N {
                    let mut sum = Lanes::ZERO;
                    for (pressure, term) in pressures.iter().zip(volume) {
                        sum += *pressure * term[c][i];
                    }
                    for lane in 0..batch.count {
                        right_side[batch.nodes[lane][i]][c] -= sum.0[lane];
                    }
                }
            }
        }
    }

    #[inline(always)]
    fn pressures(&self, step: &mut State, excess: bool) {
        let pressures = step.pressures.chunks_mut(super::lanes::LANES);
        for (((batch, kept), volume), pressures) in self
            .batches
            .iter()
            .zip(&self.excess)
            .zip(&self.volume)
            .zip(pressures)
        {
            let mut change = batch.change(volume, &step.nodes);
            if excess {
                for (sum, excess) in change.iter_mut().zip(kept) {
                    *sum += *excess;
                }
            }
            let answer = batch.answer(self.stiffening, &change);
            for (lane, pressures) in pressures.iter_mut().enumerate() {
                for (i, pressure) in answer.iter().enumerate() {
                    pressures[i] = pressure.0[lane];
                }
            }
        }
    }

    #[inline(always)]
    fn energy(&self, material: &Material, state: &State) -> f64 {
        let energies = self.batches.iter();
        energies.map(|batch| batch.energy(material, &state.nodes)).sum()
    }

    fn work_of_pressures(&self, state: &State) -> f64 {
        let pressures = state.pressures.chunks(super::lanes::LANES);
        let of_batch = |(excess, pressures): (&[Lanes; T], &[[f64; CUBIC_PRESSURES]])| -> f64 {
            let lanes = pressures.iter().enumerate();
            lanes
                .flat_map(|(lane, pressures)| excess.iter().zip(pressures).map(move |(e, p)| e.0[lane] * p))
                .sum()
        };
        self.excess.iter().zip(pressures).map(of_batch).sum()
    }
}

/// The elements of a wall.
#[derive(Clone, Debug)]
pub(super) struct Assembly(Kind);

#[derive(Clone, Debug)]
enum Kind {
    Quadratic(Elements<NODES, PRESSURES>),
    /// Elements that are cubic through the wall.
    Cubic(Elements<FUNCTIONS, CUBIC_PRESSURES>),
}

/// Calls a method of either kind of elements, with the processor's vector instructions.
macro_rules! of_either {
    ($assembly:expr, $elements:ident => $call:expr) => {
        match $assembly {
            Kind::Quadratic($elements) => vectorised(
                #[inline(always)]
                || $call,
            ),
            Kind::Cubic($elements) => vectorised(
                #[inline(always)]
                || $call,
            ),
        }
    };
}

impl Assembly {
    /// The elements of a mesh.
    pub(super) fn new(mesh: &Mesh, material: &Material) -> Self {
        Self(if mesh.is_cubic() {
            Kind::Cubic(Elements::new(mesh, material))
        } else {
            Kind::Quadratic(Elements::new(mesh, material))
        })
    }

    /// Adds the forces on the nodes in a state. Returns the largest excess volume.
    pub(super) fn forces(
        &mut self,
        material: &Material,
        memory: Option<&Memory>,
        state: &State,
        forces: &mut [[f64; 2]],
    ) -> f64 {
        of_either!(&mut self.0, elements => elements.forces(material, memory, state, forces))
    }

    /// Adds the stiffness in a state, with the pressures eliminated.
    pub(super) fn stiffness(
        &mut self,
        material: &Material,
        memory: Option<&Memory>,
        state: &State,
        fronts: &mut FrontalMatrix,
    ) {
        of_either!(&mut self.0, elements => elements.stiffness(material, memory, state, fronts));
    }

    /// Takes what the pressures answer to the latest excess of volume out of a right-hand side.
    pub(super) fn answer(&self, right_side: &mut [[f64; 2]]) {
        of_either!(&self.0, elements => elements.answer(right_side));
    }

    /// The pressures of a step of the nodes, with what they answer to the latest excess of volume or without.
    pub(super) fn pressures(&self, step: &mut State, excess: bool) {
        of_either!(&self.0, elements => elements.pressures(step, excess));
    }

    /// Strain energy.
    pub(super) fn energy(&self, material: &Material, state: &State) -> f64 {
        of_either!(&self.0, elements => elements.energy(material, state))
    }

    /// Work of the pressures on the latest excess of volume.
    pub(super) fn work_of_pressures(&self, state: &State) -> f64 {
        of_either!(&self.0, elements => elements.work_of_pressures(state))
    }
}
