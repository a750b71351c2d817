//! The linear equations of a Newton iteration: set up, factored, solved.

use super::{SolidWall, Tangent, edge, edge_nodes};
use crate::solid::fluid;
use crate::solid::frontal::FrontalMatrix;
use crate::solid::state::{Fluid, State};

impl SolidWall {
    /// Sets up the linear equations of wall and fluid at a state.
    pub(super) fn set_up(&mut self, state: &State) {
        let station = 2 * self.mesh.stride();
        self.fronts.clear();
        self.assembly
            .stiffness(&self.material, self.memory.as_ref(), state, &mut self.fronts);
        self.by_node.fill([0.0; 2]);
        for column in 0..self.mesh.elements.along {
            let [nodes, local] = [column, 0].map(|column| edge_nodes(&self.mesh, column, 0));
            let front = self.fronts.column(column);
            let [r, z] = edge(&self.mesh, &state.nodes, column, 0);
            let share = fluid::share(&r, &z);
            for i in 0..6 {
                self.by_node[nodes[i % 3]][i / 3] += share.first[i];
                for j in 0..6 {
                    let [row, other] = [i, j].map(|i| 2 * local[i % 3] + i / 3);
                    if row <= other {
                        front[FrontalMatrix::place(station, row, other)] -= state.fluid * share.second[i][j];
                    }
                }
            }
        }
        for layer in 0..self.mesh.stride() {
            self.fronts.hold_first(2 * layer);
        }
        let rim = self.by_node.len() - self.mesh.stride();
        self.by_node[rim..].fill([0.0; 2]);
        for node in &mut self.by_node[..self.mesh.stride()] {
            node[0] = 0.0;
        }
        self.by_edge.fill([[0.0; 6]; 6]);
    }

    /// Factors the linear equations at a state: those of the wall as they were set up, the plate's of now.
    pub(super) fn factor(&mut self, state: &State, plate: f64, from: usize) -> Option<()> {
        self.factorisations += 1;
        let station = 2 * self.mesh.stride();
        let local = edge_nodes(&self.mesh, 0, self.mesh.layers() - 1);
        let mut first = from;
        for column in 0..self.mesh.elements.along {
            let mut now = self.action(state, column, plate).unwrap_or_default().second;
            if column == 0 {
                // The pole is held sideways.
                now[0] = [0.0; 6];
                for row in &mut now {
                    row[0] = 0.0;
                }
            }
            if now == self.by_edge[column] {
                continue;
            }
            first = first.min(column);
            let front = self.fronts.column(column);
            for i in 0..6 {
                for j in 0..6 {
                    let [row, other] = [i, j].map(|i| 2 * local[i % 3] + i / 3);
                    if row <= other {
                        front[FrontalMatrix::place(station, row, other)] +=
                            now[i][j] - self.by_edge[column][i][j];
                    }
                }
            }
            self.by_edge[column] = now;
        }
        self.negative.truncate(first);
        self.fronts.eliminate(first, &mut self.negative)?;
        Some(())
    }

    /// What goes with the fluid's pressure, by the latest factors.
    pub(super) fn follow_pressure(&mut self) {
        self.by_pressure.nodes.copy_from_slice(&self.by_node);
        self.fronts.solve(self.by_pressure.nodes.as_flattened_mut());
        self.assembly.pressures(&mut self.by_pressure, false);
    }

    /// How a settled state follows the fluid's pressure, a plate held at a height, by factors of its own.
    pub fn follow(&mut self, state: &State, plate: f64) -> Option<State> {
        self.set_up(state);
        self.factor(state, plate, 0)?;
        self.follow_pressure();
        Some(State {
            fluid: 1.0,
            ..self.by_pressure.clone()
        })
    }

    /// Derivative of the fluid's volume by its pressure, a plate held at a height, by the latest factors: those of an iterate beside the state.
    pub(in crate::solid) fn compliance(&mut self) -> f64 {
        self.follow_pressure();
        self.change(&self.by_pressure)
    }

    /// Change of the fluid's volume with a step.
    pub(in crate::solid) fn change(&self, step: &State) -> f64 {
        let by_node = self.by_node.as_flattened();
        by_node
            .iter()
            .zip(step.nodes.as_flattened())
            .map(|(d, x)| d * x)
            .sum()
    }

    /// Newton's step for the latest balance, with the latest factors; the largest displacement in it.
    pub(super) fn solve(&mut self, fluid: &Fluid, excess: f64) -> Option<f64> {
        for (x, force) in self.step.nodes.iter_mut().zip(&self.forces) {
            *x = force.map(|force| -force);
        }
        self.assembly.answer(&mut self.step.nodes);
        for node in &mut self.step.nodes[..self.mesh.stride()] {
            node[0] = 0.0;
        }
        self.fronts.solve(self.step.nodes.as_flattened_mut());
        self.assembly.pressures(&mut self.step, true);
        self.border(fluid, excess)?;
        let largest = self.step.nodes.as_flattened().iter().map(|x| x.abs());
        Some(largest.fold(0.0, f64::max))
    }

    /// The fluid's pressure of a step, and what goes with it.
    pub(super) fn border(&mut self, fluid: &Fluid, excess: f64) -> Option<()> {
        let pressure = -(excess + fluid.by_volume * self.change(&self.step))
            / (fluid.by_volume * self.change(&self.by_pressure) + fluid.by_pressure);
        self.step.fluid = 0.0;
        self.step.add(pressure, &self.by_pressure);
        self.step.fluid = pressure;
        pressure.is_finite().then_some(())
    }

    /// How the latest settled state follows the plate, by the latest factors: those of an iterate beside it.
    pub fn tangent(&mut self, fluid: &Fluid) -> Option<Tangent> {
        self.follow_pressure();
        self.step.nodes.fill([0.0; 2]);
        let outer = self.mesh.layers() - 1;
        for (column, by_edge) in self.by_edge.iter().enumerate() {
            let nodes = edge_nodes(&self.mesh, column, outer);
            for (i, row) in by_edge.iter().enumerate() {
                self.step.nodes[nodes[i % 3]][i / 3] -= row[3..].iter().sum::<f64>();
            }
        }
        self.fronts.solve(self.step.nodes.as_flattened_mut());
        self.assembly.pressures(&mut self.step, false);
        self.border(fluid, 0.0)?;
        let mut force = 0.0;
        for (column, by_edge) in self.by_edge.iter().enumerate() {
            let nodes = edge_nodes(&self.mesh, column, outer);
            for (i, row) in by_edge.iter().enumerate() {
                let of_plate = if i < 3 { 0.0 } else { 1.0 };
                force += row[3..].iter().sum::<f64>() * (of_plate + self.step.nodes[nodes[i % 3]][i / 3]);
            }
        }
        Some(Tangent {
            state: self.step.clone(),
            force,
        })
    }
}
