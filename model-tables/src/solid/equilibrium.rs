//! Newton's method on the wall, the fluid and the plate together.
//!
//! Dimensionless: lengths in outer radial semi-axes, stresses in shear moduli.

use super::Failure;
use super::element::{self, Element, Material};
use super::fluid;
use super::front::{Fronts, SIDES};
use super::mesh::{CUBIC_PRESSURES, Elements, FUNCTIONS, Mesh, NODES, PRESSURES};
use super::plate;
use crate::material::Law;

/// Contact stiffness times wall thickness, over the shear modulus: a contact pressure of a tenth of the modulus penetrates
/// 5e-4 of the wall. Seven times as stiff changes the force by less than 0.1 % and takes a third more iterations.
const CONTACT_STIFFNESS: f64 = 200.0;
/// Largest unbalanced force of a node, and with it the largest excess of an element's volume, over the plate's force.
const RELATIVE_TOLERANCE: f64 = 1e-8;
/// The same in moduli times radius times thickness (volume: square radii times thickness), where there is hardly a force.
const TOLERANCE: f64 = 1e-10;
/// Iterations after which a state counts as lost.
const MAX_ITERATIONS: usize = 30;
/// Largest displacement of a node in an iteration, over the wall thickness.
const STEP_LIMIT: f64 = 0.5;

/// Unknowns of a state.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Radius and height of every node, in the mesh's order, with the amplitudes of cubic functions.
    pub nodes: Vec<[f64; 2]>,
    /// Terms of the pressure in each element.
    pub pressures: Vec<[f64; CUBIC_PRESSURES]>,
    /// Gauge pressure of the fluid.
    pub fluid: f64,
}

impl State {
    /// Takes over another state of the same mesh, without allocating.
    pub fn copy_from(&mut self, other: &Self) {
        self.nodes.copy_from_slice(&other.nodes);
        self.pressures.copy_from_slice(&other.pressures);
        self.fluid = other.fluid;
    }

    /// Adds a multiple of another vector of unknowns.
    pub fn add(&mut self, factor: f64, other: &Self) {
        for (x, y) in self.nodes.iter_mut().zip(&other.nodes) {
            x[0] += factor * y[0];
            x[1] += factor * y[1];
        }
        for (x, y) in self.pressures.iter_mut().zip(&other.pressures) {
            for (x, y) in x.iter_mut().zip(y) {
                *x += factor * y;
            }
        }
        self.fluid += factor * other.fluid;
    }

    /// All zero.
    pub fn clear(&mut self) {
        self.nodes.fill([0.0; 2]);
        self.pressures.fill([0.0; CUBIC_PRESSURES]);
        self.fluid = 0.0;
    }
}

/// The equation of the fluid: `by_volume (V - volume) + by_pressure (P - pressure) = 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fluid {
    /// Weight of the volume.
    pub by_volume: f64,
    /// Volume to have, `V` over `by_volume`'s unit.
    pub volume: f64,
    /// Weight of the pressure: the compliance, where volume is kept.
    pub by_pressure: f64,
    /// Pressure to have.
    pub pressure: f64,
}

/// What a converged state comes with.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Balance {
    /// Volume of the fluid.
    pub volume: f64,
    /// Force on the plate.
    pub force: f64,
    /// Energy in the contact.
    pub contact_energy: f64,
    /// Least determinant or hoop stretch at a Gauss point outside the crease; positive.
    pub least: f64,
    /// Largest entry of the residual, in units of the tolerance's scale.
    pub residual: f64,
}

/// A wall, and room to solve it.
#[derive(Clone, Debug)]
pub struct Wall {
    /// The undeformed wall.
    pub mesh: Mesh,
    /// Its material, in shear moduli.
    pub material: Material,
    /// Which unknown of a column each unknown of its elements is, innermost element first.
    places: Vec<Vec<usize>>,
    /// Contact pressure over penetration.
    contact_stiffness: f64,
    /// Undeformed radii and heights of each column's outer edge.
    outer: Vec<[[f64; 3]; 2]>,
    fronts: Fronts,
    element: Element,
    /// Derivative of the volume by the inner nodes.
    volume_by_node: Vec<[f64; 2]>,
    /// Newton's step, and the part of it that goes with the fluid's pressure.
    step: State,
    by_pressure: State,
    /// Newton iterations so far.
    pub iterations: u64,
}

impl Wall {
    /// A wall of outer semi-axes 1 and `height`, with a law in shear moduli.
    pub fn new(height: f64, thickness: f64, law: Law, elements: Elements) -> Self {
        let mesh = Mesh::new(height, thickness, elements);
        let Layout { station, own } = layout(&mesh);
        let outer = (0..elements.along)
            .map(|column| edge(&mesh, &mesh.nodes, column, mesh.layers() - 1))
            .collect();
        let step = State {
            nodes: vec![[0.0; 2]; mesh.nodes.len()],
            pressures: vec![[0.0; CUBIC_PRESSURES]; mesh.points.len()],
            fluid: 0.0,
        };
        Self {
            contact_stiffness: CONTACT_STIFFNESS / thickness,
            outer,
            fronts: Fronts::new(station, own, elements.along),
            element: Element::default(),
            volume_by_node: vec![[0.0; 2]; mesh.stations()],
            by_pressure: step.clone(),
            step,
            iterations: 0,
            material: Material::new(law, mesh.is_cubic()),
            places: (0..elements.through).map(|layer| places(&mesh, layer)).collect(),
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

    /// Strain energy of the wall.
    pub fn energy(&self, state: &State) -> f64 {
        let through = self.mesh.elements.through;
        self.mesh
            .points
            .iter()
            .enumerate()
            .map(|(e, points)| {
                let positions = positions(&self.mesh, &state.nodes, e / through, e % through);
                element::energy(&self.material, points, &positions)
            })
            .sum()
    }

    /// The largest `I1` outside the crease.
    pub fn largest_invariant(&self, state: &State) -> f64 {
        let through = self.mesh.elements.through;
        let mut largest = 3.0_f64;
        for (e, points) in self.mesh.points.iter().enumerate() {
            let positions = positions(&self.mesh, &state.nodes, e / through, e % through);
            for point in points.iter().filter(|point| !point.in_crease) {
                largest = largest.max(element::first_invariant(element::deformation(point, &positions)));
            }
        }
        largest
    }

    /// Whether the law softens anywhere in a state.
    pub fn softens(&self, state: &State) -> bool {
        let through = self.mesh.elements.through;
        self.mesh.points.iter().enumerate().any(|(e, points)| {
            let positions = positions(&self.mesh, &state.nodes, e / through, e % through);
            points
                .iter()
                .any(|point| element::softens(&self.material.law, element::deformation(point, &positions)))
        })
    }

    /// Solves for the state in balance with a plate at a height and the fluid's equation, starting from `state`.
    ///
    /// # Errors
    /// [`Failure`]; `state` is then of no use.
    pub fn settle(&mut self, state: &mut State, plate: f64, fluid: &Fluid) -> Result<Balance, Failure> {
        let mut residual = f64::INFINITY;
        for _ in 0..MAX_ITERATIONS {
            let balance = self.assemble(state, plate);
            self.iterations += 1;
            let excess = fluid.by_volume * (balance.volume - fluid.volume)
                + fluid.by_pressure * (state.fluid - fluid.pressure);
            residual = balance.residual.max(excess.abs() / self.mesh.thickness);
            if !residual.is_finite() {
                return Err(Failure::Singular);
            }
            let force = balance.force / self.mesh.thickness;
            if residual < TOLERANCE + RELATIVE_TOLERANCE * force {
                // Admissible only right side out: the equations go on beyond.
                return if balance.least > 0.0 {
                    Ok(Balance { residual, ..balance })
                } else {
                    Err(Failure::InsideOut)
                };
            }
            let largest = self.solve(fluid, excess).ok_or(Failure::Singular)?;
            state.add((STEP_LIMIT * self.mesh.thickness / largest).min(1.0), &self.step);
        }
        Err(Failure::Stalled { residual })
    }

    /// Sets up the linear equations at a state.
    fn assemble(&mut self, state: &State, plate: f64) -> Balance {
        let Self {
            mesh,
            material,
            places,
            contact_stiffness,
            outer,
            fronts,
            element,
            volume_by_node,
            ..
        } = self;
        let Elements { through, along } = mesh.elements;
        let layers = mesh.layers();
        let Layout { station, own } = layout(mesh);
        let size = 2 * station + own;
        let starts = starts(mesh);
        let mut balance = Balance {
            least: f64::INFINITY,
            ..Balance::default()
        };
        // Forces on the column's nodes and volumes of its elements; the right station's go on to the next column.
        fronts.clear();
        volume_by_node.fill([0.0; 2]);
        for column in 0..along {
            let mut front = fronts.column(column);
            for layer in 0..through {
                let index = column * through + layer;
                let positions = positions(mesh, &state.nodes, column, layer);
                let (points, pressures) = (&mesh.points[index], &state.pressures[index]);
                let least = if mesh.is_cubic() {
                    element.assemble::<FUNCTIONS, CUBIC_PRESSURES>(material, points, &positions, pressures)
                } else {
                    element.assemble::<NODES, PRESSURES>(material, points, &positions, pressures)
                };
                balance.least = balance.least.min(least);
                let places = &places[layer];
                for (i, &place) in places.iter().enumerate() {
                    let row = front.row(place);
                    for (&place, stiffness) in places.iter().zip(&element.stiffness[i]) {
                        row[place] += stiffness;
                    }
                    row[size] -= element.residual[i];
                }
            }
            let [r, z] = edge(mesh, &state.nodes, column, 0);
            let share = fluid::share(&r, &z);
            balance.volume += share.volume;
            let inner: [usize; 6] = core::array::from_fn(|i| starts[i % 3] + i / 3);
            for i in 0..6 {
                volume_by_node[2 * column + i % 3][i / 3] += share.first[i];
                let row = front.row(inner[i]);
                row[size] += state.fluid * share.first[i];
                row[size + 1] += share.first[i];
                for j in 0..6 {
                    row[inner[j]] -= state.fluid * share.second[i][j];
                }
            }
            let [_, z] = edge(mesh, &state.nodes, column, layers - 1);
            let action = plate::action(*contact_stiffness, &outer[column], &z, plate);
            balance.force += action.force;
            balance.contact_energy += action.energy;
            for i in 0..3 {
                let row = front.row(starts[i] + 2 * layers - 1);
                row[size] -= action.first[i];
                for j in 0..3 {
                    row[starts[j] + 2 * layers - 1] += action.second[i][j];
                }
            }
        }
        for layer in 0..mesh.stride() {
            fronts.hold_first(2 * layer);
        }
        balance.residual = residual(fronts, station, own, along) / mesh.thickness;
        balance
    }

    /// Newton's step at the assembled state; the largest displacement in it.
    fn solve(&mut self, fluid: &Fluid, excess: f64) -> Option<f64> {
        self.fronts.eliminate()?;
        let Self {
            fronts,
            step,
            by_pressure,
            ..
        } = self;
        let stride = self.mesh.stride();
        let Layout { station, .. } = layout(&self.mesh);
        let through = self.mesh.elements.through;
        let terms = terms(&self.mesh);
        fronts.solutions(|column, i, x: [f64; SIDES]| {
            for (part, x) in [&mut *step, &mut *by_pressure].into_iter().zip(x) {
                if i < 2 * station {
                    let at = 2 * column + i / station;
                    part.nodes[at * stride + (i % station) / 2][i % 2] = x;
                } else {
                    let p = i - 2 * station;
                    part.pressures[column * through + p / terms][p % terms] = x;
                }
            }
        });
        let volumes = [&self.step, &self.by_pressure].map(|part| {
            self.volume_by_node
                .iter()
                .enumerate()
                .map(|(station, d)| {
                    let x = part.nodes[station * stride];
                    d[0] * x[0] + d[1] * x[1]
                })
                .sum::<f64>()
        });
        let pressure =
            -(excess + fluid.by_volume * volumes[0]) / (fluid.by_volume * volumes[1] + fluid.by_pressure);
        if !pressure.is_finite() {
            return None;
        }
        self.step.add(pressure, &self.by_pressure);
        self.step.fluid = pressure;
        Some(
            self.step
                .nodes
                .iter()
                .map(|x| x[0].abs().max(x[1].abs()))
                .fold(0.0, f64::max),
        )
    }
}

/// Numbers of unknowns in a column of elements.
struct Layout {
    /// Of a station: radius and height of its nodes from inside to outside, and of its cubic function.
    station: usize,
    /// Of a column's own: its middle station, and the pressures of its elements.
    own: usize,
}

fn layout(mesh: &Mesh) -> Layout {
    let station = 2 * mesh.stride();
    Layout {
        station,
        own: station + terms(mesh) * mesh.elements.through,
    }
}

/// Terms of an element's pressure.
fn terms(mesh: &Mesh) -> usize {
    if mesh.is_cubic() {
        CUBIC_PRESSURES
    } else {
        PRESSURES
    }
}

/// Where in a column its three stations begin.
fn starts(mesh: &Mesh) -> [usize; 3] {
    let Layout { station, own } = layout(mesh);
    [0, station, station + own]
}

/// Where in a column the unknowns of an element are.
fn places(mesh: &Mesh, layer: usize) -> Vec<usize> {
    let starts = starts(mesh);
    let functions = if mesh.is_cubic() { FUNCTIONS } else { NODES };
    let node = |component: usize, i: usize| {
        let (station, layer) = if i < NODES {
            (i / 3, 2 * layer + i % 3)
        } else {
            (i - NODES, mesh.layers())
        };
        starts[station] + 2 * layer + component
    };
    let pressure = 2 * layout(mesh).station + terms(mesh) * layer;
    (0..2 * functions)
        .map(|i| node(i / functions, i % functions))
        .chain(pressure..pressure + terms(mesh))
        .collect()
}

/// Largest entry of the residual on the unknowns that are free.
fn residual(fronts: &mut Fronts, station: usize, own: usize, along: usize) -> f64 {
    let size = 2 * station + own;
    let complete = station + own;
    let mut largest = 0.0_f64;
    for column in 0..along {
        for i in 0..complete {
            let mut value: f64 = fronts.column(column).row(i)[size];
            if i < station && column > 0 {
                // The column before has a part of the same station.
                value += fronts.column(column - 1).row(complete + i)[size];
            }
            if value.is_nan() {
                return f64::NAN;
            }
            largest = largest.max(value.abs());
        }
    }
    largest
}

/// Radii and heights of the three nodes of a column's edge in a layer of nodes.
pub fn edge(mesh: &Mesh, nodes: &[[f64; 2]], column: usize, layer: usize) -> [[f64; 3]; 2] {
    [0, 1].map(|c| core::array::from_fn(|i| nodes[mesh.node(2 * column + i, layer)][c]))
}

/// Radii and heights of an element's nodes, and the amplitudes of its cubic functions.
pub fn positions(mesh: &Mesh, nodes: &[[f64; 2]], column: usize, layer: usize) -> element::Positions {
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
