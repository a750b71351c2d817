//! Newton's method on the wall, the fluid and the plate together.
//!
//! Dimensionless: lengths in outer radial semi-axes, stresses in shear moduli.

mod linear;
mod touch;

use super::Failure;
use super::assembly::Assembly;
use super::element::{self, Material, positions};
use super::fluid;
use super::friction::Sliding;
use super::frontal::FrontalMatrix;
use super::memory::Memory;
use super::mesh::{CUBIC_PRESSURES, Elements, Mesh};
use super::object::Surface;
use super::state::{Balance, Fluid, State};
use crate::material::Law;

/// Contact stiffness times wall thickness, over the shear modulus: a contact pressure of a tenth of the modulus penetrates
/// 5e-4 of the wall. Seven times as stiff changes the force by less than 0.1 % and takes a third more iterations.
const CONTACT_STIFFNESS: f64 = 200.0;
/// Largest unbalanced force of a node, and with it the largest excess of an element's volume, over the plate's force.
const RELATIVE_TOLERANCE: f64 = 1e-8;
/// The same in moduli times radius times thickness (volume: square radii times thickness), used if the force is nearly zero.
const TOLERANCE: f64 = 1e-10;
/// Largest number of iterations, including those with earlier factors. After it, the state counts as not found.
const MAX_ITERATIONS: usize = 60;
/// Largest displacement of a node in an iteration, over the wall thickness.
const STEP_LIMIT: f64 = 0.5;
/// Displacement of a node, over the wall thickness, after which the wall's part of the equations is set up again. A moving
/// contact edge changes only the plate's part.
const RENEWAL: f64 = 0.1;
/// Smallest part of a step that is taken, with friction.
const MIN_DAMPING: f64 = 0.125;
/// If a step leaves more than this share of the residual, the equations are factored again.
const CONTRACTION: f64 = 0.1;
/// If a step leaves more than this share with a plate's part of its own state, the wall's part is set up again too.
const WALL_CONTRACTION: f64 = 0.5;

/// The part of the factors that belongs to the latest iterate.
#[derive(PartialEq)]
enum Renewed {
    Nothing,
    /// The plate's part.
    Plate,
    All,
}

/// How a state follows the plate, at a fixed equation of the fluid.
#[derive(Clone, Debug)]
pub struct Tangent {
    /// Derivatives of the unknowns by the indentation.
    pub state: State,
    /// Derivative of the plate's dimensionless force.
    pub force: f64,
}

/// A wall, and the memory to solve it.
#[derive(Clone, Debug)]
pub struct SolidWall {
    /// The undeformed wall.
    pub mesh: Mesh,
    /// Its material, in shear moduli.
    pub material: Material,
    /// Its memory, if it relaxes.
    pub(super) memory: Option<Memory>,
    assembly: Assembly,
    /// Largest unbalanced force if the plate's force is nearly zero, in moduli times radius times thickness.
    tolerance: f64,
    /// Contact pressure over penetration.
    contact_stiffness: f64,
    /// Whether that is a foundation's own, which a step of time leaves as it is; a rigid plate's penalty goes with the wall's stiffness.
    on_foundation: bool,
    /// What touches the outer surface.
    surface: Surface,
    /// Its friction, if it has any.
    sliding: Option<Sliding>,
    /// Undeformed radii and heights of each column's outer edge.
    outer: Vec<[[f64; 3]; 2]>,
    fronts: FrontalMatrix,
    /// Forces on the nodes, unbalanced.
    forces: Vec<[f64; 2]>,
    /// Derivative of the volume by the nodes: zero but for the inner ones.
    by_node: Vec<[f64; 2]>,
    /// The object's stiffness on each column's outer edge, in the latest factors.
    by_edge: Vec<[[f64; 6]; 6]>,
    /// Negative pivots of each column.
    negative: Vec<usize>,
    /// Newton's step, and its derivative by the fluid's pressure.
    step: State,
    by_pressure: State,
    /// Factorisations so far.
    pub factorisations: u64,
    /// Newton iterations so far, with the factors of their own state or of one before.
    pub iterations: u64,
}

impl SolidWall {
    /// A dome's wall of outer semi-axes 1 and `height`, with a law in shear moduli.
    pub fn new(height: f64, thickness: f64, law: Law, elements: Elements) -> Self {
        Self::of(Mesh::new(height, thickness, elements), law)
    }

    /// The wall of a mesh, with a law in shear moduli.
    pub fn of(mesh: Mesh, law: Law) -> Self {
        let elements = mesh.elements;
        let material = Material::new(law, mesh.is_cubic());
        let outer = (0..elements.along)
            .map(|column| edge(&mesh, &mesh.nodes, column, mesh.layers() - 1))
            .collect();
        let step = State {
            nodes: vec![[0.0; 2]; mesh.nodes.len()],
            pressures: vec![[0.0; CUBIC_PRESSURES]; mesh.points.len()],
            fluid: 0.0,
        };
        Self {
            tolerance: TOLERANCE,
            contact_stiffness: CONTACT_STIFFNESS / mesh.thickness,
            on_foundation: false,
            outer,
            fronts: FrontalMatrix::new(2 * mesh.stride(), elements.along),
            assembly: Assembly::new(&mesh, &material),
            forces: step.nodes.clone(),
            by_node: step.nodes.clone(),
            by_edge: vec![[[0.0; 6]; 6]; elements.along],
            surface: Surface::Plate,
            sliding: None,
            negative: Vec::with_capacity(elements.along),
            by_pressure: step.clone(),
            step,
            memory: None,
            factorisations: 0,
            iterations: 0,
            material,
            mesh,
        }
    }

    /// The undeformed state, free of stress.
    pub fn undeformed(&self) -> State {
        State {
            nodes: self.mesh.nodes.clone(),
            pressures: vec![
                [element::pressure_at_rest(&self.material.law), 0.0, 0.0, 0.0, 0.0];
                self.mesh.points.len()
            ],
            fluid: 0.0,
        }
    }

    /// Volume of the fluid in a state.
    pub fn volume(&self, state: &State) -> f64 {
        (0..self.mesh.elements.along)
            .map(|column| {
                let [r, z] = edge(&self.mesh, &state.nodes, column, 0);
                fluid::share(&r, &z).volume
            })
            .sum()
    }

    /// Stiffness of the wall in the present time step, over its relaxed stiffness.
    fn stiffening(&self) -> f64 {
        self.memory.as_ref().map_or(1.0, Memory::stiffening)
    }

    /// Strain energy of the wall.
    pub fn energy(&self, state: &State) -> f64 {
        self.assembly.energy(&self.material, state)
    }

    /// Potential energy of the latest settled state: strain energy, and the work of the pressures on the remaining excess
    /// volume. An excess within the tolerance causes an error of first order in the strain energy, but of second order in this
    /// sum.
    pub fn potential(&self, state: &State) -> f64 {
        self.energy(state) + self.assembly.work_of_pressures(state)
    }

    /// The deformations at the Gauss points, with those in the crease or without.
    fn deformations<'a>(
        &'a self,
        state: &'a State,
        crease: bool,
    ) -> impl Iterator<Item = element::Deformation> + 'a {
        let through = self.mesh.elements.through;
        self.mesh.points.iter().enumerate().flat_map(move |(e, points)| {
            let positions = positions(&self.mesh, &state.nodes, e / through, e % through);
            let outside = points.iter().filter(move |point| crease || !point.in_crease);
            outside.map(move |point| element::deformation(&point.gradient, &positions))
        })
    }

    /// The largest `I1` outside the crease.
    pub fn largest_invariant(&self, state: &State) -> f64 {
        self.deformations(state, false)
            .map(element::first_invariant)
            .fold(3.0, f64::max)
    }

    /// Whether the law softens anywhere in a state.
    pub fn softens(&self, state: &State) -> bool {
        self.deformations(state, true)
            .any(|deformation| element::softens(&self.material.law, deformation))
    }

    /// Whether the latest settled state is a minimum of the energy, the fluid's included, among its neighbours: by the latest factors.
    pub fn is_stable(&mut self, fluid: &Fluid) -> bool {
        // In the crease at the rim the surface may roll over the base, of no consequence for the rest.
        let through = self.mesh.elements.through;
        let columns = self.mesh.points.chunks(through);
        let outside = columns.take_while(|column| !column.iter().flatten().any(|point| point.in_crease));
        match self.negative.iter().take(outside.count()).sum() {
            0 => true,
            1 => {
                // A direction in which the energy falls is no way out where the fluid's volume closes it.
                self.follow_pressure();
                fluid.by_pressure + fluid.by_volume * self.change(&self.by_pressure) < 0.0
            }
            _ => false,
        }
    }

    /// Solves for the state in balance with a plate at a height and the fluid's equation, starting from `state`.
    ///
    /// The equations are factored where the factors of an iteration before bring the residual down too slowly: first with the plate's part of now,
    /// and where that is still slow, as where the law softens, all of them.
    ///
    /// # Errors
    /// [`Failure`]; `state` is then of no use.
    pub fn settle(&mut self, state: &mut State, plate: f64, fluid: &Fluid) -> Result<Balance, Failure> {
        let mut before = f64::INFINITY;
        // Not set up yet.
        let mut moved = f64::INFINITY;
        let mut renewed = Renewed::Nothing;
        let mut shortened = false;
        let mut damping: f64 = 1.0;
        for _ in 0..MAX_ITERATIONS {
            let balance = self.balance(state, plate, fluid);
            self.iterations += 1;
            if !balance.residual.is_finite() {
                return Err(Failure::Singular);
            }
            let force = balance.force / self.mesh.thickness;
            if balance.residual < self.tolerance * self.stiffening() + RELATIVE_TOLERANCE * force {
                // A state with an element inside out is not admissible, although the equations continue there.
                let least = self.deformations(state, false).map(element::least);
                return if least.fold(f64::INFINITY, f64::min) > 0.0 {
                    Ok(balance)
                } else {
                    Err(Failure::InsideOut)
                };
            }
            let contraction = balance.residual / before;
            before = balance.residual;
            renewed = if moved > RENEWAL * self.mesh.thickness
                || renewed == Renewed::Plate && contraction > WALL_CONTRACTION
            {
                self.set_up(state);
                self.factor(state, plate, 0).ok_or(Failure::Singular)?;
                // Good enough also where the contact's edge moves on.
                self.follow_pressure();
                moved = 0.0;
                Renewed::All
            } else if shortened || contraction > CONTRACTION {
                self.factor(state, plate, usize::MAX).ok_or(Failure::Singular)?;
                Renewed::Plate
            } else {
                Renewed::Nothing
            };
            if self.sliding.is_some() {
                // Some points alternate between sticking and sliding.
                damping = if contraction > 1.0 {
                    (0.5 * damping).max(MIN_DAMPING)
                } else {
                    (2.0 * damping).min(1.0)
                };
            }
            let excess = fluid.excess(&balance, state);
            let largest = self.solve(fluid, excess).ok_or(Failure::Singular)?;
            let limit = STEP_LIMIT * self.mesh.thickness / largest;
            shortened = limit < 1.0;
            moved += largest * limit.min(damping);
            state.add(limit.min(damping), &self.step);
        }
        Err(Failure::Stalled { residual: before })
    }

    /// Forces, volumes and the plate's action in a state; what is left unbalanced goes to the right-hand side.
    fn balance(&mut self, state: &State, plate: f64, fluid: &Fluid) -> Balance {
        let mut balance = Balance::default();
        self.forces.fill([0.0; 2]);
        let excess = self
            .assembly
            .forces(&self.material, self.memory.as_ref(), state, &mut self.forces);
        for column in 0..self.mesh.elements.along {
            let [inner, outer] =
                [0, self.mesh.layers() - 1].map(|layer| edge_nodes(&self.mesh, column, layer));
            let [r, z] = edge(&self.mesh, &state.nodes, column, 0);
            let (volume, by_node) = fluid::volume(&r, &z);
            balance.volume += volume;
            for i in 0..3 {
                for c in 0..2 {
                    self.forces[inner[i]][c] -= state.fluid * by_node[c][i];
                }
            }
            let Some(action) = self.action(state, column, plate) else {
                continue;
            };
            balance.force += action.force;
            balance.contact_energy += action.energy;
            for (i, force) in action.first.into_iter().enumerate() {
                self.forces[outer[i % 3]][i / 3] += force;
            }
        }
        self.hold();
        let mut largest = excess.max(fluid.excess(&balance, state).abs());
        for x in self.forces.as_flattened() {
            largest = if x.is_nan() {
                f64::NAN
            } else {
                largest.max(x.abs())
            };
        }
        if excess.is_nan() {
            largest = f64::NAN;
        }
        balance.residual = largest / self.mesh.thickness;
        balance
    }

    /// Removes the forces on the held unknowns: the rim, and the radius of the pole.
    fn hold(&mut self) {
        let stride = self.mesh.stride();
        let rim = self.forces.len() - stride;
        for node in &mut self.forces[rim..] {
            *node = [0.0; 2];
        }
        for node in &mut self.forces[..stride] {
            node[0] = 0.0;
        }
    }
}

/// The three nodes of a column's edge in a layer of nodes.
fn edge_nodes(mesh: &Mesh, column: usize, layer: usize) -> [usize; 3] {
    core::array::from_fn(|i| mesh.node(2 * column + i, layer))
}

/// Radii and heights of the three nodes of a column's edge in a layer of nodes.
pub fn edge(mesh: &Mesh, nodes: &[[f64; 2]], column: usize, layer: usize) -> [[f64; 3]; 2] {
    [0, 1].map(|c| core::array::from_fn(|i| nodes[mesh.node(2 * column + i, layer)][c]))
}
