//! Load stepping: first contact from the asymptotics, then steps as long as Newton's method allows.

use super::{LARGEST_STEP, Press, SMALLEST_STEP};
use crate::material::Hyperelastic;
use crate::membrane::adapt::{Graded, Unsolved};
use crate::membrane::closure::PressControl;
use crate::membrane::equations::{CONTACT_PARAMETER, CONTACT_RADIUS};
use core::f64::consts::FRAC_PI_2;

/// First indentation on the way from rest, over the height.
const FIRST_INDENTATION: f64 = 1e-4;
/// Largest factor between indentations on the way up.
const LARGEST_FACTOR: f64 = 4.0;
/// Contact radius over edge radius, minus one, that counts as rounding.
const EDGE_ROUNDING: f64 = 1e-10;

/// Growth of the contact parameter beyond a state that may be the last before the press turns back, and how often.
const TURN_FACTOR: f64 = 1.004;
const TURN_STEPS: usize = 10;

/// Why a state was not reached.
#[derive(Clone, Copy, Debug)]
pub(super) enum Stop {
    BeyondLimit,
    Failed { reached: f64, failure: Unsolved },
}

/// Where a step over a gap begins, over the indentation at which the contact edge loses its tension: the bend there is still wide.
const RUN_UP: [f64; 2] = [0.97, 0.9];
/// How far it goes, over the height.
const STEPS_OVER_A_GAP: [f64; 4] = [0.03, 0.06, 0.1, 0.15];

impl<L: Hyperelastic, const S: usize> Press<L, S> {
    /// Solves the state at a dimensionless indentation, from the latest one, or from rest where no way leads down from
    /// there.
    pub(super) fn reach(&mut self, indentation: f64) -> Result<(), Stop> {
        let from = self.predictor.latest().map(|g| g.solution.height);
        let result = self.reach_from_here(indentation);
        match from {
            Some(left) if result.is_err() && self.rest.solution.height - left > indentation => {
                self.predictor.clear();
                self.reach_from_here(indentation)
            }
            _ => result,
        }
    }

    /// The same from the latest state. Of a plain membrane whose contact edge loses its tension, there may be states again
    /// farther down, where the deeper press has stretched it.
    fn reach_from_here(&mut self, indentation: f64) -> Result<(), Stop> {
        let mut stop = match self.walk(indentation) {
            Ok(()) => return Ok(()),
            Err(stop) => stop,
        };
        while let Stop::Failed {
            reached,
            failure: Unsolved::EdgePushes { .. },
        } = stop
            && reached < indentation
            && self.step_over_gap(reached, indentation)
        {
            stop = match self.walk(indentation) {
                Ok(()) => return Ok(()),
                Err(stop) => stop,
            };
        }
        Err(stop)
    }

    /// Whether a state was found beyond a stretch of indentations, from `reached` on, that have none.
    fn step_over_gap(&mut self, reached: f64, indentation: f64) -> bool {
        let height = self.rest.solution.height;
        RUN_UP.iter().any(|part| {
            self.walk(part * reached).is_ok()
                && STEPS_OVER_A_GAP.iter().any(|step| {
                    let to = (reached + step * height).min(indentation);
                    self.predictor.repeat();
                    self.attempt(to).is_ok()
                })
        })
    }

    /// Walks to a dimensionless indentation, over as many states in between as it takes.
    fn walk(&mut self, indentation: f64) -> Result<(), Stop> {
        let height = self.rest.solution.height;
        if indentation >= height {
            return Err(Stop::BeyondLimit);
        }
        if self.predictor.latest().is_none() {
            let mut first = indentation.min(FIRST_INDENTATION * height);
            loop {
                *self.predictor.working() = self.first_contact(first);
                let Err(stop) = self.attempt(first) else { break };
                first *= 0.1;
                if first < 1e-10 * height {
                    // A dome that hardly holds its volume bends sharply at first, and lets itself be pressed farther on.
                    first = FIRST_INDENTATION * height;
                    *self.predictor.working() = self.first_contact(first);
                    self.attempt(first).map_err(|_| stop)?;
                    break;
                }
            }
        }
        let mut factor = LARGEST_FACTOR;
        let mut largest_step = LARGEST_STEP * height;
        loop {
            let at = height - self.latest().solution.height;
            let next = indentation
                .clamp(at / factor, at * factor)
                .clamp(at - largest_step, at + largest_step);
            let arrives = next.to_bits() == indentation.to_bits();
            self.predictor.predict(next);
            let mut result = self.attempt(next);
            if matches!(result, Err(Stop::Failed { .. })) {
                self.predictor.repeat();
                result = self.attempt(next);
            }
            if matches!(result, Err(Stop::Failed { .. }))
                && let Some(other) = self.solver.with_other_pole(self.latest())
            {
                *self.predictor.working() = other;
                result = self.attempt(next);
            }
            match result {
                Ok(()) if arrives => return Ok(()),
                Ok(()) => {
                    factor = libm::sqrt(factor * LARGEST_FACTOR);
                    largest_step = (2.0 * largest_step).min(LARGEST_STEP * height);
                }
                Err(stop) => {
                    let tried = (next - at).abs();
                    largest_step = 0.5 * tried;
                    factor = libm::sqrt((next / at).max(at / next));
                    if tried < SMALLEST_STEP * at {
                        return Err(match stop {
                            Stop::Failed { failure, .. } => Stop::Failed {
                                reached: at,
                                failure: self
                                    .solver
                                    .edge_pushes(self.latest())
                                    .or_else(|| self.turns_back())
                                    .unwrap_or(failure),
                            },
                            Stop::BeyondLimit => stop,
                        });
                    }
                }
            }
        }
    }

    /// Whether the press turns back just beyond the latest state: as the contact grows on, the plate has to rise.
    #[inline(never)] // its copies of a solution stay off the caller's stack
    fn turns_back(&mut self) -> Option<Unsolved> {
        let latest = &self.latest().solution;
        let (height, mut parameter) = (latest.height, latest.parameters[CONTACT_PARAMETER]);
        self.predictor.repeat();
        for _ in 0..TURN_STEPS {
            parameter *= TURN_FACTOR;
            let closure = self.closure(PressControl::ContactParameter(parameter));
            let state = self.predictor.working();
            self.solver.settle(state, &closure).ok()?;
            if state.solution.height > height {
                return Some(Unsolved::SnapsThrough);
            }
        }
        None
    }

    /// Solves from the state in work; an admissible result becomes the latest.
    fn attempt(&mut self, indentation: f64) -> Result<(), Stop> {
        let closure = self.closure(PressControl::Height(self.rest.solution.height - indentation));
        let edge = self.edge();
        let state = self.predictor.working();
        self.solver
            .settle(state, &closure)
            .map_err(|failure| Stop::Failed {
                reached: 0.0,
                failure,
            })?;
        if state.solution.parameters[CONTACT_RADIUS] > edge * (1.0 + EDGE_ROUNDING) {
            return Err(Stop::BeyondLimit);
        }
        self.predictor.accept(indentation, &self.solver.equilibrium.gauss);
        Ok(())
    }

    /// A guess from the rest state: the asymptotics of first contact.
    ///
    /// `H = (P0 r^2 / 2 T0) ln(K / r)`, with the edge radius for the design's length `K`; under the plate the pole's
    /// state, outside the rest state with the force taken off the vertical balance. On a sphere `r` is the radius of the contact and the
    /// force that of a disc wider by `1 + Rd / R`, with `Rd` the radius of curvature of the pole.
    #[inline(never)] // its copies of a solution stay off the caller's stack
    fn first_contact(&self, indentation: f64) -> Graded<S> {
        let rest = &self.rest.solution;
        let [pole_stretch, pressure, ..] = rest.parameters;
        let tension = rest.nodes[0][1] / pole_stretch;
        let edge = self.edge();
        let curvature = self.solver.equilibrium.membrane.curvature;
        // Square of the radius that makes up the force over that of the contact; 1 under a plate.
        let share = 1.0 + curvature * self.crown_radius();
        let mut radius = 0.1 * edge;
        for _ in 0..30 {
            let logarithm = libm::log(edge / radius).max(0.3);
            radius = libm::sqrt(2.0 * tension * indentation / (pressure * share * logarithm)).min(0.5 * edge);
        }
        let force_radius = radius * libm::sqrt(share);
        let gauss = &self.solver.equilibrium.gauss;
        let contact_parameter = libm::asin((radius / pole_stretch).min(0.9));
        let mut pressed = self.rest.clone();
        pressed.depth.contact_parameter = 0.0;
        // An unpressed solution laid on a mesh with a contact zone, then corrected.
        pressed.solution.parameters[CONTACT_PARAMETER] = contact_parameter;
        pressed.solution.parameters[CONTACT_RADIUS] = force_radius;
        let mut laid = self.solver.lay_contact(&pressed, contact_parameter);
        let correct = |t: f64| {
            let ([u, w], stretch) = rest.at(gauss, t);
            let x = libm::sin(t);
            let k_rest = 0.5 * pressure * u * u * x;
            let n_squared = w * w + k_rest * k_rest;
            let k = if t > contact_parameter {
                0.5 * pressure * (u * u * x - force_radius * force_radius / x)
            } else {
                curvature * u * x * libm::sqrt(n_squared)
            };
            ([u, libm::sqrt((n_squared - k * k).max(w * w))], stretch)
        };
        let solution = &mut laid.solution;
        for e in 0..solution.elements() {
            let span = solution.span(e);
            (solution.nodes[e], _) = correct(span.start);
            for j in 0..S {
                (solution.stages[e][j], solution.stretches[e][j]) =
                    correct(span.start + gauss.nodes[j] * span.length);
            }
        }
        (solution.nodes[solution.elements()], _) = correct(FRAC_PI_2);
        laid
    }
}
