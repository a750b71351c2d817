//! Rest states of a solid: inflated with the rim held, or inflated free and then bonded as a membrane is.

use super::equilibrium::SolidWall;
use super::section;
use super::state::{Fluid, State};
use crate::design::Membrane;
use crate::solid::{Failure, SolidError};
use core::f64::consts::PI;

/// Height of a plate that nothing reaches.
const NO_PLATE: f64 = 1e6;
/// Growth of the fluid's volume from state to state of an inflation.
const INFLATION_STEP: f64 = 0.03;
/// Total growth of the fluid's volume after which an inflation stops without a result.
const LARGEST_INFLATION: f64 = 100.0;
/// Growth of the pole stretch from state to state.
const STRETCH_STEP: f64 = 0.04;
/// Accuracy of the pole stretch.
const STRETCH_TOLERANCE: f64 = 1e-9;

fn unsolved(failure: Failure) -> SolidError {
    SolidError::RestUnsolved { failure }
}

/// The equation of a given volume.
fn filled(volume: f64) -> Fluid {
    Fluid {
        by_volume: 1.0,
        volume,
        by_pressure: 0.0,
        pressure: 0.0,
    }
}

/// The membrane in the middle of a wall, whose semi-axes are the outer surface's.
pub fn mid_surface(wall: &Membrane) -> Membrane {
    Membrane {
        radial_semi_axis: wall.radial_semi_axis - 0.5 * wall.thickness,
        axial_semi_axis: wall.axial_semi_axis - 0.5 * wall.thickness,
        thickness: wall.thickness,
    }
}

/// What a dome inflates to whose rim slides on the base: of the middle of its wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeRest {
    /// Radius of the equator, metres.
    pub edge_radius: f64,
    /// Height of the pole, metres.
    pub height: f64,
    /// Volume inside, cubic metres.
    pub volume: f64,
    /// Thickness of the wall at the equator over the undeformed one.
    pub thinning: f64,
}

/// Inflates the wall as a membrane is, its rim free to slide on the base, until the pole is stretched by so much, and bonds it
/// there: the rim goes where the membrane in the middle of the wall has its equator, as thin as that is there.
///
/// `length` is the outer radial semi-axis in metres; `free` gives what the middle of the wall inflates to, by the pole stretch.
///
/// # Errors
/// Those of `free`, and [`SolidError::RestUnsolved`].
pub fn bonded<E: From<SolidError>>(
    wall: &mut SolidWall,
    state: &mut State,
    length: f64,
    stretch: f64,
    mut free: impl FnMut(f64) -> Result<FreeRest, E>,
) -> Result<(), E> {
    let half_of_wall = {
        let (a, b, h) = (1.0, wall.mesh.height, wall.mesh.thickness);
        PI / 3.0 * (a * a * b - (a - h) * (a - h) * (b - h))
    };
    let layers = wall.mesh.layers();
    let rim = wall.mesh.node(wall.mesh.stations() - 1, 0);
    let (mut reached, mut step) = (1.0, STRETCH_STEP);
    while reached < stretch {
        let next = (reached + step).min(stretch);
        let rest = free(next)?;
        let mut trial = state.clone();
        grow(
            &mut trial,
            layers,
            wall.mesh.stride(),
            [rest.edge_radius / length, rest.height / length],
        );
        for layer in 0..layers {
            let through = layer as f64 / (layers - 1) as f64 - 0.5;
            trial.nodes[rim + layer] = [
                rest.edge_radius / length + through * rest.thinning * wall.mesh.thickness,
                0.0,
            ];
        }
        let volume = rest.volume / (length * length * length) - half_of_wall;
        match wall.settle(&mut trial, NO_PLATE, &filled(volume)) {
            Ok(_) => {
                *state = trial;
                reached = next;
            }
            Err(failure) => {
                step *= 0.5;
                if step < 1e-3 * STRETCH_STEP {
                    return Err(unsolved(failure).into());
                }
            }
        }
    }
    // From the membrane's volume to the pole stretch, by secants.
    let mut volume = wall.volume(state);
    let mut excess = section::pole_stretch(wall, state) - stretch;
    let mut change = 1e-3 * volume;
    for _ in 0..20 {
        if excess.abs() < STRETCH_TOLERANCE {
            return Ok(());
        }
        volume += change;
        wall.settle(state, NO_PLATE, &filled(volume)).map_err(unsolved)?;
        let next = section::pole_stretch(wall, state) - stretch;
        change *= -next / (next - excess);
        excess = next;
    }
    Err(unsolved(Failure::Stalled { residual: excess }).into())
}

/// A guess for a wall whose middle has grown to a radius and a height: as much thinner as it grew.
fn grow(state: &mut State, layers: usize, stride: usize, [radius, height]: [f64; 2]) {
    let middle = layers / 2;
    let last = state.nodes.len() - stride;
    let factors = [
        radius / state.nodes[last + middle][0],
        height / state.nodes[middle][1],
    ];
    let thinning = 1.0 / (factors[0] * factors[1]);
    for station in state.nodes.chunks_exact_mut(stride) {
        let at = station[middle];
        // The amplitude of a cubic function, behind the nodes, stays as it is.
        for node in &mut station[..layers] {
            for c in 0..2 {
                node[c] = factors[c] * at[c] + thinning * (node[c] - at[c]);
            }
        }
    }
}

/// Inflates the undeformed wall, its rim held, to a pressure in pascals of a law whose shear modulus is `unit`. It goes by
/// volume, as the pressure may have a maximum on the way.
///
/// # Errors
/// [`SolidError::PressureOutOfReach`], [`SolidError::RestUnsolved`].
pub fn held(wall: &mut SolidWall, state: &mut State, pascals: f64, unit: f64) -> Result<(), SolidError> {
    let pressure = pascals / unit;
    let first = wall.volume(state);
    let mut volume = first;
    let mut step = INFLATION_STEP;
    let mut greatest = 0.0;
    let none = |greatest: f64| SolidError::PressureOutOfReach {
        asked: pressure * unit,
        greatest: greatest * unit,
    };
    let mut before = state.clone();
    loop {
        let next = volume * (1.0 + step);
        let mut trial = state.clone();
        // Repeats the last step as a guess.
        trial.add(1.0, state);
        trial.add(-1.0, &before);
        if let Err(failure) = wall.settle(&mut trial, NO_PLATE, &filled(next)) {
            before = state.clone();
            step *= 0.5;
            if step < 1e-6 {
                return Err(unsolved(failure));
            }
            continue;
        }
        if trial.fluid >= pressure {
            let by_pressure = Fluid {
                by_volume: 0.0,
                volume: 0.0,
                by_pressure: 1.0,
                pressure,
            };
            let share = (pressure - state.fluid) / (trial.fluid - state.fluid);
            let mut found = state.clone();
            found.add(share, &trial);
            found.add(-share, state);
            found.fluid = pressure;
            return match wall.settle(&mut found, NO_PLATE, &by_pressure) {
                Ok(_) => {
                    *state = found;
                    Ok(())
                }
                Err(failure) => Err(unsolved(failure)),
            };
        }
        if trial.fluid < greatest || next > LARGEST_INFLATION * first {
            return Err(none(greatest));
        }
        greatest = trial.fluid;
        before = core::mem::replace(state, trial);
        volume = next;
    }
}
