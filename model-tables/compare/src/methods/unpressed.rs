//! The rest state by shooting: the plate-free membrane, integrated from the pole to the equator.

use super::MethodFailure;
use super::dop853::{Tolerance, integrate};
use super::plain::{Free, HEIGHT, LastStretches, Load, Met, PlainMembrane, RADIUS, STATE, THRUST, VOLUME};
use core::f64::consts::FRAC_PI_2;

/// Where integration starts, over the fourth root of the tolerance: the series there errs by its fourth power.
const START: f64 = 0.3;
/// First step over the distance to the pole. Longer ones excite the singular solution, unseen by the error estimate.
pub(super) const FIRST_STEP: f64 = 2.0;
/// Newton steps at most.
pub(super) const MAX_STEPS: usize = 30;

/// The rest state, dimensionless.
#[derive(Clone, Copy, Debug)]
pub struct ShootingRest {
    /// Pressure, dimensionless.
    pub pressure: f64,
    /// Radius of the equator, dimensionless.
    pub edge: f64,
    /// Height, dimensionless.
    pub height: f64,
    /// Volume, dimensionless.
    pub volume: f64,
    /// State at the equator, varied by pole stretch, pressure and a point force over `2 pi` at the pole.
    pub varied: Free,
    /// What was met on the meridian.
    pub met: Met,
}

/// Where the series is as good as the tolerance.
pub(super) fn start_of(relative: f64) -> f64 {
    START * libm::sqrt(libm::sqrt(relative))
}

pub(super) fn tolerance(relative: f64, controlled: usize) -> Tolerance {
    Tolerance {
        relative,
        absolute: 1e-3 * relative,
        controlled,
    }
}

/// The plate-free membrane from `start` to the equator, varied by pole stretch, pressure and a point force.
pub(super) fn inflate(
    problem: &PlainMembrane,
    pole_stretch: f64,
    pressure: f64,
    [start, relative]: [f64; 2],
    controlled: usize,
) -> Result<(Free, Met), MethodFailure> {
    let load = Load {
        pressure,
        load: 0.0,
        pressure_by: [0.0, 1.0, 0.0],
        load_by: [0.0, 0.0, 1.0],
    };
    let mut memory = LastStretches::new(pole_stretch);
    let end = integrate(
        |t, y| problem.free_rates(t, y, &load, &mut memory),
        [start, FRAC_PI_2],
        problem.free_start(start, pole_stretch, pressure),
        FIRST_STEP * start,
        &tolerance(relative, controlled),
    )?;
    Ok((end, memory.met))
}

impl ShootingRest {
    /// The rest state of the problem's pole stretch: the pressure at which the equator is vertical, by Newton.
    ///
    /// # Errors
    /// [`MethodFailure::BlewUp`], [`MethodFailure::Stalled`].
    pub fn new(problem: &PlainMembrane, relative: f64) -> Result<Self, MethodFailure> {
        let stretch = problem.pole_stretch;
        let d = model_tables::material::Hyperelastic::derivatives(&problem.law, stretch, stretch);
        let mut pressure = 2.0 * d.w1 / (stretch * stretch) * problem.aspect;
        let mut moved = f64::INFINITY;
        for _ in 0..MAX_STEPS {
            let (end, met) = match inflate(problem, stretch, pressure, [start_of(relative), relative], STATE)
            {
                Ok(reached) => reached,
                Err(MethodFailure::BlewUp { .. }) => {
                    // Too much pressure for the stretch.
                    pressure *= 0.7;
                    continue;
                }
                Err(failure) => return Err(failure),
            };
            let step = -end[THRUST] / end[2 * STATE + THRUST];
            moved = (step / pressure).abs();
            if moved < 0.1 * relative {
                if met.unstable {
                    return Err(MethodFailure::LawUnstable);
                }
                return Ok(Self {
                    pressure,
                    edge: end[RADIUS],
                    height: end[HEIGHT],
                    volume: end[VOLUME],
                    varied: end,
                    met,
                });
            }
            pressure += step.clamp(-0.5 * pressure, pressure);
        }
        Err(MethodFailure::Stalled {
            residual: moved,
            condition: 1.0,
        })
    }
}
