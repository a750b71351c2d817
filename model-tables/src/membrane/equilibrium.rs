//! Newton's method for a state of equilibrium on a given mesh.
//!
//! Unknown are the state at every node and Gauss point, and four parameters: the pole's (its stretch, or the edge
//! of a slack core), the pressure, the deformed contact radius and the contact parameter. Because the contact
//! parameter is an unknown, the mesh moves with it; its derivatives are exact, so the convergence is quadratic
//! whatever controls the press.

mod convergence;

use crate::material::Hyperelastic;
use crate::membrane::closure::{Closure, ClosureTangent, NewtonOutcome, PressControl, RestControl};
use crate::membrane::equations::{
    CONTACT_PARAMETER, CONTACT_RADIUS, HEIGHT, LocalEquations, POLE, PRESSURE, Response, VOLUME,
};
use crate::membrane::solution::{MAX_ELEMENTS, Pole, Solution};
use crate::solver::bordered_block::{self, BORDERS, BlockRow, BorderedBlocks, UNKNOWNS};
use crate::solver::collocation::{self, Condensed, Gauss, GaussPoint, PARAMETERS, STATES, Span};
use convergence::{Convergence, Step};
use core::f64::consts::FRAC_PI_2;

/// Iterations before Newton's method gives up.
const MAX_ITERATIONS: u32 = 30;
/// Largest relative change of a quantity in one damped step.
const LARGEST_CHANGE: f64 = 0.3;

/// The membrane's equations, a collocation method and room to work in.
#[derive(Clone, Debug)]
pub struct Equilibrium<L, const S: usize> {
    /// The membrane.
    pub membrane: LocalEquations<L>,
    /// The collocation method.
    pub gauss: Gauss<S>,
    condensed: [Condensed<S>; MAX_ELEMENTS],
    linear_system: BorderedBlocks<MAX_ELEMENTS>,
    convergence: Convergence,
}

/// `row . x + constant = 0` with one coefficient 1.
fn unit_row(index: usize, residual: f64) -> BlockRow {
    let mut row = [0.0; UNKNOWNS + 1];
    row[index] = 1.0;
    row[UNKNOWNS] = residual;
    row
}

const CONTACT_EDGE: usize = 2;

impl<L, const S: usize> Equilibrium<L, S> {
    /// Room to work in, to be set.
    pub(crate) const fn blank(membrane: LocalEquations<L>) -> Self {
        Self {
            membrane,
            gauss: Gauss::BLANK,
            condensed: [Condensed::BLANK; MAX_ELEMENTS],
            linear_system: BorderedBlocks::BLANK,
            convergence: Convergence::new(0.0),
        }
    }

    /// Makes it ready to solve, as [`Equilibrium::new`].
    pub(crate) fn set(&mut self, tolerance: f64) {
        self.gauss = Gauss::new();
        self.convergence = Convergence::new(tolerance);
    }
}

impl<L: Hyperelastic, const S: usize> Equilibrium<L, S> {
    /// Ready to solve.
    ///
    /// `tolerance` bounds the relative change that one more iteration would make.
    pub fn new(membrane: LocalEquations<L>, tolerance: f64) -> Self {
        let mut equilibrium = Self::blank(membrane);
        equilibrium.set(tolerance);
        equilibrium
    }

    /// Values of the first node and their derivative by the pole parameter.
    fn first_node(&self, pole: Pole, parameter: f64) -> ([f64; STATES], [f64; STATES]) {
        match pole {
            Pole::Taut => {
                let d = self.membrane.law.derivatives(parameter, parameter);
                ([parameter, d.w1], [1.0, d.w11 + d.w12])
            }
            Pole::Slack => ([1.0, 0.0], [0.0, 0.0]),
        }
    }

    /// Condenses every element at the present iterate. The residual, or where the iterate is inadmissible.
    fn linearise(&mut self, solution: &mut Solution<S>) -> Result<f64, LineariseError> {
        let [_, pressure, contact_radius, _] = solution.parameters;
        if solution.pole == Pole::Taut {
            // No Gauss point stands there, and beyond the loss of stability other roots of the law look like states.
            let stretch = solution.parameters[POLE];
            let d = self.membrane.law.derivatives(stretch, stretch);
            if d.w11.is_nan() || d.w11 <= 0.0 {
                return Err(LineariseError::Inadmissible(0.0));
            }
        }
        let mut residual: f64 = 0.0;
        let mut points = [GaussPoint::default(); S];
        for e in 0..solution.elements() {
            let span = solution.span(e);
            let zone = solution.zone(e);
            let meridians = self
                .membrane
                .meridians(span.start, span.length, &self.gauss.nodes);
            for (j, point) in points.iter_mut().enumerate() {
                let guess = solution.stretches[e][j];
                let (value, response) = self
                    .membrane
                    .point(
                        zone,
                        &meridians[j],
                        solution.stages[e][j],
                        pressure,
                        contact_radius,
                        guess,
                    )
                    .ok_or(LineariseError::Inadmissible(
                        span.start + self.gauss.nodes[j] * span.length,
                    ))?;
                *point = value;
                solution.stretches[e][j] = response.l1;
            }
            collocation::condense(
                &self.gauss,
                &span,
                solution.nodes[e],
                solution.nodes[e + 1],
                &solution.stages[e],
                &points,
                &mut self.condensed[e],
            )
            .ok_or(LineariseError::Singular)?;
            residual = residual.max(self.condensed[e].residual);
        }
        Ok(residual)
    }

    /// Assembles chain and border, and eliminates all nodes but the last.
    fn eliminate(&mut self, solution: &mut Solution<S>) -> Option<()> {
        let [pole, pressure, contact_radius, contact_parameter] = solution.parameters;
        let (first, first_by_pole) = self.first_node(solution.pole, pole);
        solution.nodes[0] = first;
        let mut by_parameter = [[0.0; PARAMETERS]; STATES];
        by_parameter[0][POLE] = first_by_pole[0];
        by_parameter[1][POLE] = first_by_pole[1];
        self.linear_system.restart(by_parameter);
        let edge = self.membrane.meridian(contact_parameter);
        for e in 0..solution.elements() {
            if e == solution.contact_elements {
                let state = solution.nodes[e];
                let (residual, by) = self
                    .membrane
                    .contact_edge(&edge, state, pressure, contact_radius)?;
                let mut row = [0.0; UNKNOWNS + 1];
                row[..STATES].copy_from_slice(&by[..STATES]);
                row[STATES + PRESSURE] = by[STATES];
                row[STATES + CONTACT_RADIUS] = by[STATES + 1];
                row[STATES + CONTACT_PARAMETER] = by[STATES + 2];
                row[UNKNOWNS] = residual;
                self.linear_system.add_to_border(CONTACT_EDGE, &row);
            }
            for integral in [HEIGHT, VOLUME] {
                self.linear_system
                    .add_to_border(integral, &self.condensed[e].integrals[integral]);
            }
            self.linear_system.advance(&self.condensed[e].end)?;
        }
        Some(())
    }

    /// Solves for the change of the last node and the parameters.
    fn step(&mut self, solution: &mut Solution<S>, closure: &Closure) -> Option<[f64; UNKNOWNS]> {
        self.eliminate(solution)?;
        let [pole, pressure, contact_radius, contact_parameter] = solution.parameters;
        let borders: [BlockRow; BORDERS] = self.linear_system.borders;
        let [link_0, link_1] = self.linear_system.link();
        let last = solution.nodes[solution.elements()];
        let shifted = |mut row: BlockRow, target: f64| {
            row[UNKNOWNS] -= target;
            row
        };
        let rows = match *closure {
            Closure::Rest(control) | Closure::Clamped(control) => [
                link_0,
                link_1,
                match *closure {
                    Closure::Clamped(_) => unit_row(0, last[0] - 1.0),
                    _ => unit_row(1, last[1]),
                },
                match control {
                    RestControl::PoleStretch(stretch) => unit_row(STATES + POLE, pole - stretch),
                    RestControl::Pressure(target) => unit_row(STATES + PRESSURE, pressure - target),
                    RestControl::EquatorStretch(stretch) => unit_row(0, last[0] - stretch),
                    RestControl::Height(height) => shifted(borders[HEIGHT], height),
                },
                unit_row(STATES + CONTACT_RADIUS, 0.0),
                unit_row(STATES + CONTACT_PARAMETER, 0.0),
            ],
            Closure::Press {
                control,
                equator_stretch,
                fluid,
                compliance,
            } => {
                let mut volume = shifted(borders[VOLUME], fluid - compliance * pressure);
                volume[STATES + PRESSURE] += compliance;
                [
                    link_0,
                    link_1,
                    unit_row(0, last[0] - equator_stretch),
                    borders[CONTACT_EDGE],
                    volume,
                    match control {
                        PressControl::ContactParameter(t) => {
                            unit_row(STATES + CONTACT_PARAMETER, contact_parameter - t)
                        }
                        PressControl::ContactRadius(radius) => {
                            unit_row(STATES + CONTACT_RADIUS, contact_radius - radius)
                        }
                        PressControl::Height(height) => shifted(borders[HEIGHT], height),
                    },
                ]
            }
        };
        bordered_block::solve(rows)
    }

    /// How an unpressed state goes on inflating while its edge is held. `None` where it does not go on smoothly.
    /// Of `solution` only the guesses of the stretches change.
    pub fn tangent(&mut self, solution: &mut Solution<S>) -> Option<ClosureTangent> {
        self.linearise(solution).ok()?;
        self.eliminate(solution)?;
        let [link_0, link_1] = self.linear_system.link();
        let change = bordered_block::solve([
            link_0,
            link_1,
            unit_row(0, 0.0),
            unit_row(STATES + POLE, -1.0),
            unit_row(STATES + CONTACT_RADIUS, 0.0),
            unit_row(STATES + CONTACT_PARAMETER, 0.0),
        ])?;
        let of = |row: &BlockRow| row.iter().zip(&change).map(|(a, x)| a * x).sum::<f64>();
        Some(ClosureTangent {
            pressure: change[STATES + PRESSURE],
            volume: of(&self.linear_system.borders[VOLUME]),
            height: of(&self.linear_system.borders[HEIGHT]),
        })
    }

    /// Newton's method from the values in `solution`, which it replaces.
    pub fn solve(&mut self, solution: &mut Solution<S>, closure: &Closure) -> NewtonOutcome {
        self.convergence.start(matches!(closure, Closure::Press { .. }));
        for iterations in 1..=MAX_ITERATIONS {
            let residual = match self.linearise(solution) {
                Ok(residual) => residual,
                Err(LineariseError::Inadmissible(position)) => {
                    return NewtonOutcome::Inadmissible { iterations, position };
                }
                Err(LineariseError::Singular) => return NewtonOutcome::Singular { iterations },
            };
            let Some(change) = self.step(solution, closure) else {
                return NewtonOutcome::Singular { iterations };
            };
            let step = self.apply(solution, &change);
            if !step.size.is_finite() {
                return NewtonOutcome::Singular { iterations };
            }
            if self.convergence.is_last(&step) {
                return NewtonOutcome::Converged {
                    iterations,
                    residual,
                    step: step.size,
                };
            }
        }
        NewtonOutcome::Stalled {
            step: self.convergence.before(),
        }
    }

    /// Adds a damped step to the solution.
    fn apply(&mut self, solution: &mut Solution<S>, change: &[f64; UNKNOWNS]) -> Step {
        let elements = solution.elements();
        let mut node_changes = [[0.0; STATES]; MAX_ELEMENTS + 1];
        self.linear_system
            .back_substitute(change, |k, node| node_changes[k] = node);
        let tension = solution.nodes[..=elements]
            .iter()
            .fold(0.0_f64, |a, y| a.max(y[1].abs()));
        let mut size: f64 = 0.0;
        let mut shrink: f64 = 1.0;
        let mut pole: f64 = 0.0;
        for (k, (node, by)) in solution.nodes[..=elements].iter().zip(&node_changes).enumerate() {
            let relative = (by[0] / node[0]).abs();
            shrink = shrink.max(relative / LARGEST_CHANGE);
            if k > 0 {
                size = size.max(relative).max(by[1].abs() / tension.max(1e-3));
            }
        }
        let parameter_changes = &change[STATES..];
        for (m, &by) in parameter_changes.iter().enumerate() {
            let value = solution.parameters[m];
            if by == 0.0 {
                continue;
            }
            let scale = if m == CONTACT_PARAMETER {
                value.min(FRAC_PI_2 - value)
            } else {
                value
            };
            let relative = (by / scale).abs();
            if m == POLE {
                pole = (by / value).abs();
            } else {
                size = size.max((by / value).abs());
            }
            shrink = shrink.max(relative / LARGEST_CHANGE);
        }
        let damping = 1.0 / shrink;
        let (mut height, mut volume) = (0.0, 0.0);
        for e in 0..elements {
            let mut x = [0.0; collocation::COLUMNS];
            x[..STATES].copy_from_slice(&node_changes[e]);
            x[STATES..UNKNOWNS].copy_from_slice(parameter_changes);
            x[UNKNOWNS] = 1.0;
            for (stage, map) in solution.stages[e].iter_mut().zip(&self.condensed[e].stages) {
                for (value, row) in stage.iter_mut().zip(map) {
                    *value += damping * row.iter().zip(&x).map(|(a, b)| a * b).sum::<f64>();
                }
            }
            // Exact to the square of the step, which is rounding when the iteration ends.
            let sum = |row: &[f64; collocation::COLUMNS]| row.iter().zip(&x).map(|(a, b)| a * b).sum::<f64>();
            height += sum(&self.condensed[e].integrals[HEIGHT]);
            volume += sum(&self.condensed[e].integrals[VOLUME]);
        }
        solution.height = height;
        solution.volume = volume;
        for (node, by) in solution.nodes[..=elements].iter_mut().zip(&node_changes) {
            node[0] += damping * by[0];
            node[1] += damping * by[1];
        }
        for (value, by) in solution.parameters.iter_mut().zip(parameter_changes) {
            *value += damping * by;
        }
        Step { size, pole, damping }
    }

    /// Height over the base at `t`.
    pub fn height_at(&self, solution: &Solution<S>, t: f64) -> f64 {
        let [_, pressure, contact_radius, contact_parameter] = solution.parameters;
        if t <= contact_parameter && self.membrane.curvature == 0.0 {
            return solution.height;
        }
        let mut height = 0.0;
        for e in (0..solution.elements()).rev() {
            let span = solution.span(e);
            let end = span.start + span.length;
            if end <= t {
                break;
            }
            let start = span.start.max(t);
            for (node, weight) in self.gauss.nodes.iter().zip(&self.gauss.weights) {
                let position = start + node * (end - start);
                let (state, guess) = solution.at(&self.gauss, position);
                if let Some((point, _)) = self.membrane.point(
                    solution.zone(e),
                    &self.membrane.meridian(position),
                    state,
                    pressure,
                    contact_radius,
                    guess,
                ) {
                    height += weight * (end - start) * point.integrand[HEIGHT];
                }
            }
        }
        height
    }

    /// Visits every Gauss point: element, index, span, what the equations say, the law's response.
    pub fn for_each_point(
        &self,
        solution: &Solution<S>,
        mut visit: impl FnMut(usize, usize, &Span, &GaussPoint, &Response),
    ) {
        let [_, pressure, contact_radius, _] = solution.parameters;
        for e in 0..solution.elements() {
            let span = solution.span(e);
            let meridians = self
                .membrane
                .meridians(span.start, span.length, &self.gauss.nodes);
            for (j, meridian) in meridians.iter().enumerate() {
                let state = solution.stages[e][j];
                if let Some((point, response)) = self.membrane.point(
                    solution.zone(e),
                    meridian,
                    state,
                    pressure,
                    contact_radius,
                    solution.stretches[e][j],
                ) {
                    visit(e, j, &span, &point, &response);
                }
            }
        }
    }
}

enum LineariseError {
    Inadmissible(f64),
    Singular,
}
