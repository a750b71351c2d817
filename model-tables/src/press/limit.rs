//! Where a press ends, and by what.

use super::way::Stop;
use super::{LARGEST_STEP, ModelError, Press, SMALLEST_STEP};
use crate::adapt::Failure;
use crate::equilibrium::PressControl;
use crate::material::Hyperelastic;
use crate::membrane::PRESSURE;
use core::f64::consts::PI;

/// What ends a press.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EndsBy {
    /// The bulge becomes tangent to the base plane.
    BulgeTouchesBase,
    /// All fluid has been pressed into the compliance: the membrane lies flat.
    FluidDrained,
    /// The inner surface of a solid wall reaches the base plane.
    WallTouchesBase,
}

impl EndsBy {
    /// The word used in tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::BulgeTouchesBase => "bulge-touches-base",
            Self::FluidDrained => "fluid-drained",
            Self::WallTouchesBase => "wall-touches-base",
        }
    }
}

/// The end of a press.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// Largest indentation, metres.
    pub indentation: f64,
    /// Pressure there, pascals.
    pub pressure: f64,
    /// Force there, newtons.
    pub force: f64,
    /// Why it ends.
    pub ends_by: EndsBy,
}

/// Indentation over the height up to which a press is followed before its fluid counts as drained.
const NEARLY_FLAT: f64 = 0.9995;

impl<L: Hyperelastic, const S: usize> Press<L, S> {
    /// The end of the press.
    ///
    /// # Errors
    /// [`ModelError::PressUnsolved`] if the way there fails.
    pub fn limit(&mut self) -> Result<Limit, ModelError> {
        if let Some(limit) = self.limit {
            return Ok(limit);
        }
        let height = self.rest.solution.height;
        let edge = self.edge();
        let scale = self.scale;
        let unit = scale.length;
        let end = |indentation: f64, pressure: f64, ends_by: EndsBy| Limit {
            indentation: indentation * unit,
            pressure: pressure * scale.pressure,
            force: pressure * PI * edge * edge * scale.tension * unit,
            ends_by,
        };
        let mut at = self.history.latest().map_or(0.0, |g| height - g.solution.height);
        let mut step = LARGEST_STEP * height;
        let limit = loop {
            // A step may not leap over what happens just before the end.
            let next = (at + step).min(NEARLY_FLAT * height);
            if at >= NEARLY_FLAT * height {
                // Nothing but the base is left under the plate.
                let rest = &self.rest.solution;
                let pressure = rest.parameters[PRESSURE] + rest.volume / self.compliance;
                break end(height, pressure, EndsBy::FluidDrained);
            }
            let stop = match self.reach(next) {
                Ok(()) => {
                    at = next;
                    continue;
                }
                Err(stop) => stop,
            };
            // The edge lies between: land on it.
            let closure = self.closure(PressControl::ContactRadius(edge));
            if let (Stop::BeyondLimit, Some(latest)) = (stop, self.history.latest())
                && let mut landed = latest.clone()
                && self.solver.settle(&mut landed, &closure).is_ok()
            {
                let [_, w] = landed.solution.nodes[landed.solution.elements()];
                let indentation = height - landed.solution.height;
                if w < 0.0 && indentation >= at && indentation <= next {
                    break end(
                        indentation,
                        landed.solution.parameters[PRESSURE],
                        EndsBy::BulgeTouchesBase,
                    );
                }
            }
            step *= 0.5;
            if step < SMALLEST_STEP * height {
                let failure = match stop {
                    Stop::Failed { failure, .. } => failure,
                    Stop::BeyondLimit => Failure::Unsettled,
                };
                return Err(ModelError::PressUnsolved {
                    asked: next * unit,
                    reached: at * unit,
                    failure,
                });
            }
        };
        self.limit = Some(limit);
        Ok(limit)
    }
}
