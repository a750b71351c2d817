//! The volumes that a fingertip's fluid moves into in time: an actuator, and the gas and the tubing of the line.
//!
//! `V_tip(P, H) + V_actuator(P) + V_gas(P) + c P = const` at the end of each step. The actuator's volume is a line, its
//! tangent; the fingertip is solved with that as a compliance, until both have one pressure (Newton's method).

use super::Rejected;
use crate::solid::Failure;
use crate::solid::disc::DiscInTime;
use crate::solid::equilibrium::SolidWall;
use crate::solid::gas::TrappedGas;
use crate::solid::state::{Balance, Fluid, State};

/// Iterations between fingertip and actuator.
const ITERATIONS: usize = 40;
/// Allowed relative difference between the volume that the outlet takes and the volume with which the fingertip was solved.
const TOLERANCE: f64 = 1e-8;
/// The same over the cube of the fingertip's radius, where hardly any has gone: below what a wall's own volume is solved to.
const FLOOR: f64 = 1e-12;
/// Iterations by the tangent of the actuator's volume; after them by the secant.
const NEWTON: usize = 12;

/// The volumes into which the fluid moves.
#[derive(Clone, Debug)]
pub(super) struct Outlet {
    pub(super) disc: DiscInTime,
    gas: TrappedGas,
    /// Compliance of the tubing, cubic metres per pascal.
    compliance: f64,
    /// Radius of the fingertip, metres, and its modulus, pascals.
    length: f64,
    modulus: f64,
}

impl Outlet {
    /// Of a fingertip of this radius in metres and this modulus in pascals.
    pub(super) fn new(disc: DiscInTime, gas: TrappedGas, compliance: f64, length: f64, modulus: f64) -> Self {
        Self {
            disc,
            gas,
            compliance,
            length,
            modulus,
        }
    }

    /// Volume that the line has taken at a pressure, and its derivative, in the fingertip's units.
    fn line(&self, pressure: f64) -> [f64; 2] {
        let pascals = pressure * self.modulus;
        let unit = self.length * self.length * self.length;
        [
            (self.compliance * pascals + self.gas.compressed(pascals)) / unit,
            (self.compliance + self.gas.compliance(pascals)) * self.modulus / unit,
        ]
    }

    /// Pressure and volume of the disc's units in those of the fingertip.
    fn units(&self) -> [f64; 2] {
        let [length, modulus] = self.disc.units();
        let ratio = length / self.length;
        [modulus / self.modulus, ratio * ratio * ratio]
    }

    /// Solves a step of fingertip and actuator with the plate at a height. `whole` is the volume of all the fluid; `fluid` becomes the equation that
    /// the fingertip sees.
    pub(super) fn settle(
        &mut self,
        wall: &mut SolidWall,
        trial: &mut State,
        plate: f64,
        whole: f64,
        fluid: &mut Fluid,
    ) -> Result<Balance, Rejected> {
        let mut pressure = trial.fluid;
        let [mut volume, mut slope] = self.of_disc(pressure)?;
        for iteration in 0..ITERATIONS {
            let [line, by_line] = self.line(pressure);
            *fluid = Fluid {
                by_volume: 1.0,
                volume: whole - volume - line,
                by_pressure: slope + by_line,
                pressure,
            };
            let balance = wall.settle(trial, plate, fluid).map_err(Rejected::Failed)?;
            let next = trial.fluid;
            let [found, tangent] = self.of_disc(next)?;
            let secant = (found - volume) / (next - pressure);
            // A face that comes to what is over it leaves its tangents behind: from one to the other, and back.
            slope = if iteration >= NEWTON && secant > 0.0 && secant.is_finite() {
                secant
            } else {
                tangent
            };
            let taken = volume + line + fluid.by_pressure * (next - pressure);
            let [line, by_line] = self.line(next);
            if (found + line - taken).abs() <= TOLERANCE * taken.abs() + FLOOR {
                fluid.by_pressure = slope + by_line;
                return Ok(balance);
            }
            (pressure, volume) = (next, found);
        }
        Err(Rejected::Failed(Failure::Stalled { residual: 1.0 }))
    }

    /// Volume of the disc at a pressure, and its derivative, in the fingertip's units.
    fn of_disc(&mut self, pressure: f64) -> Result<[f64; 2], Rejected> {
        let [of_pressure, of_volume] = self.units();
        let found = self.disc.settle(pressure / of_pressure);
        let [volume, slope] = found.map_err(Rejected::Actuator)?;
        Ok([volume * of_volume, slope * of_volume / of_pressure])
    }
}
