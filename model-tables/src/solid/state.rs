//! The unknowns of a state, the fluid's equation, and the results of a state in equilibrium.

use super::mesh::CUBIC_PRESSURES;

/// Unknowns of a state.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Radius and height of every node, in the mesh's order, with the amplitudes of cubic functions.
    pub nodes: Vec<[f64; 2]>,
    /// Terms of the pressure in each element.
    pub pressures: Vec<[f64; CUBIC_PRESSURES]>,
    /// Gauge pressure of the fluid, dimensionless.
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
    /// Weight of the volume, dimensionless.
    pub by_volume: f64,
    /// Volume to have, `V` over `by_volume`'s unit.
    pub volume: f64,
    /// Weight of the pressure, dimensionless: the compliance, where volume is kept.
    pub by_pressure: f64,
    /// Pressure to have, dimensionless.
    pub pressure: f64,
}

impl Fluid {
    /// What a state has too much of the left side.
    pub(super) fn excess(&self, balance: &Balance, state: &State) -> f64 {
        self.by_volume * (balance.volume - self.volume) + self.by_pressure * (state.fluid - self.pressure)
    }
}

/// What a converged state comes with.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Balance {
    /// Volume of the fluid, over the cube of the radial semi-axis.
    pub volume: f64,
    /// Force on the plate, dimensionless.
    pub force: f64,
    /// Energy in the contact, dimensionless.
    pub contact_energy: f64,
    /// Largest entry of the residual, in units of the tolerance's scale.
    pub residual: f64,
}
