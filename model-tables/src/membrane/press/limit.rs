//! The end of a press, and its cause.

use super::load_stepping::Stop;
use super::{LARGEST_STEP, MembraneError, Press, SMALLEST_STEP};
use crate::limit::{EndsBy, Limit};
use crate::material::Hyperelastic;
use crate::membrane::adapt::Unsolved;
use crate::membrane::closure::PressControl;
use crate::membrane::equations::{CONTACT_RADIUS, PRESSURE};
use core::f64::consts::PI;

/// Indentation over the height up to which a press is followed before its fluid counts as drained.
const NEARLY_FLAT: f64 = 0.9995;

/// Step over the height at which the place where the bulge touches is found well enough.
const TOUCH_TOLERANCE: f64 = 1e-10;
/// Longest stretch of indentations without a state, over the height, that a plain membrane is followed across.
const LARGEST_GAP: f64 = 0.15;
/// Indentation over the height before which no bulge touches the base.
const EARLIEST_TOUCH: f64 = 0.3;
/// The golden section.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
/// Indentation over the height to which the largest contact is found.
const TURN_TOLERANCE: f64 = 1e-6;
/// Margin of the law's stability under which a press that finds no next state ends because the law softens.
const NO_MARGIN: f64 = 0.02;

impl<L: Hyperelastic, const S: usize> Press<L, S> {
    /// The end of the press.
    ///
    /// # Errors
    /// [`MembraneError::PressUnsolved`] if the way there fails.
    pub fn limit(&mut self) -> Result<Limit, MembraneError> {
        if let Some(limit) = self.limit {
            return limit;
        }
        let limit = self.find_limit();
        self.limit = Some(limit);
        limit
    }

    /// Whether an indentation lies beyond the end. With compliance the bulge that has touched the base may lift off again
    /// as the fluid drains, so that a state alone does not tell; it lies beyond the end all the same.
    pub(super) fn has_ended(&mut self, indentation: f64) -> bool {
        let unit = self.scale.length;
        self.compliance > 0.0
            && indentation > EARLIEST_TOUCH * self.rest.solution.height
            && self
                .limit()
                .is_ok_and(|limit| indentation * unit > limit.indentation)
    }

    fn find_limit(&mut self) -> Result<Limit, MembraneError> {
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
        // Indentation and contact radius of the last two states on the way.
        let mut before = [(0.0, 0.0); 2];
        let mut at = self
            .predictor
            .latest()
            .map_or(0.0, |g| height - g.solution.height);
        let mut step = LARGEST_STEP * height;
        loop {
            if at >= NEARLY_FLAT * height {
                // Nothing but the base is left under the plate.
                let rest = &self.rest.solution;
                let pressure = rest.parameters[PRESSURE] + rest.volume / self.compliance;
                return Ok(end(height, pressure, EndsBy::FluidDrained));
            }
            let mut next = (at + step).min(NEARLY_FLAT * height);
            let stop = match self.reach(next) {
                Ok(()) => {
                    let radius = self.latest().solution.parameters[CONTACT_RADIUS];
                    let [(first, _), (_, largest)] = before;
                    if radius < largest
                        && let Some(touched) = self.touches_between(first, next)
                        && self.reach(first).is_ok()
                    {
                        (at, step) = (first, touched - first);
                        before = [(0.0, 0.0); 2];
                    } else {
                        at = next;
                        before = [before[1], (at, radius)];
                    }
                    continue;
                }
                Err(stop) => stop,
            };
            if let Stop::Failed {
                failure: failure @ Unsolved::EdgePushes { .. },
                reached,
            } = stop
            {
                // Where nothing more is found, the press has ended there.
                let beyond = reached + LARGEST_GAP * height;
                self.reach(beyond).map_err(|_| MembraneError::PressUnsolved {
                    asked: next * unit,
                    reached: reached * unit,
                    failure,
                })?;
                at = beyond;
                continue;
            }
            // The edge lies between: land on it.
            let closure = self.closure(PressControl::ContactRadius(edge));
            if let (Stop::BeyondLimit, Some(latest)) = (stop, self.predictor.latest())
                && let mut landed = latest.clone()
                && self.solver.settle(&mut landed, &closure).is_ok()
            {
                let [_, w] = landed.solution.nodes[landed.solution.elements()];
                let indentation = height - landed.solution.height;
                if w < 0.0 && indentation >= at && indentation <= next {
                    return Ok(end(
                        indentation,
                        landed.solution.parameters[PRESSURE],
                        EndsBy::BulgeTouchesBase,
                    ));
                }
            }
            step *= 0.5;
            next = at + step;
            match stop {
                // Where the contact only just reaches the edge Newton's method does not land.
                Stop::BeyondLimit if step < TOUCH_TOLERANCE * height => {
                    let pressure = self.latest().solution.parameters[PRESSURE];
                    return Ok(end(at, pressure, EndsBy::BulgeTouchesBase));
                }
                // The last state found is the end, with its own contact.
                Stop::Failed { .. } if step < SMALLEST_STEP * height && self.softens() => {
                    let last = &self.latest().solution;
                    let [_, pressure, radius, _] = last.parameters;
                    return Ok(Limit {
                        force: pressure * PI * radius * radius * scale.tension * unit,
                        ..end(height - last.height, pressure, EndsBy::MaterialSoftens)
                    });
                }
                Stop::Failed { failure, .. } if step < SMALLEST_STEP * height => {
                    return Err(MembraneError::PressUnsolved {
                        asked: next * unit,
                        reached: at * unit,
                        failure,
                    });
                }
                _ => {}
            }
        }
    }

    /// Whether the law has lost all but a little of its stability in the latest state.
    fn softens(&self) -> bool {
        self.stability().value < NO_MARGIN
    }

    /// The end of a press whose law softens, if an indentation that was not reached lies beyond it.
    pub(super) fn softened_before(&mut self, indentation: f64) -> Option<Limit> {
        if !self.softens() {
            return None;
        }
        let limit = self.limit().ok()?;
        (limit.ends_by == EndsBy::MaterialSoftens && indentation > limit.indentation).then_some(limit)
    }

    /// An indentation between two at which the contact is wider than the edge, that is, the bulge below the base; if there
    /// is one about the largest contact in between.
    fn touches_between(&mut self, from: f64, to: f64) -> Option<f64> {
        let height = self.rest.solution.height;
        let (mut left, mut right) = (from, to);
        // The contact radius at an indentation, unless it is wider than the edge.
        let radius = |press: &mut Self, at: f64| match press.reach(at) {
            Ok(()) => Ok(press.latest().solution.parameters[CONTACT_RADIUS]),
            Err(Stop::BeyondLimit) => Err(Some(at)),
            Err(Stop::Failed { .. }) => Err(None),
        };
        let mut search = || {
            while right - left > TURN_TOLERANCE * height {
                let low = right - GOLDEN * (right - left);
                let high = left + GOLDEN * (right - left);
                if radius(self, low)? > radius(self, high)? {
                    right = high;
                } else {
                    left = low;
                }
            }
            Err(None)
        };
        let found: Result<(), Option<f64>> = search();
        found.err().flatten()
    }
}
