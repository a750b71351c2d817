//! Shooting: integrate from the pole, correct pole stretch, pressure and contact edge by Newton's method.
//!
//! Textbook (Stoer and Bulirsch, *Introduction to Numerical Analysis*, 7.3), done as well as it can be: order eight
//! with step control, exact derivatives from the variational equations, prediction from the states before.
//! Its weakness: errors at the pole grow along the meridian. Near a pre-stretch of 1 the matrix's condition
//! exceeds a million, and Newton's method fails from guesses a few parts in ten thousand off.

use super::dop853::integrate;
use super::matrix::invert;
use super::plain::{
    Free, HEIGHT, LastStretches, Load, Met, PlainMembrane, RADIUS, STATE, THRUST, VARIED, VOLUME,
};
use super::unpressed::{FIRST_STEP, MAX_STEPS, ShootingRest, start_of, tolerance};
use super::{MethodFailure, MethodState};
use core::f64::consts::{FRAC_PI_2, PI};
use model_tables::design::Design;

/// Halvings of a Newton step at most.
const MAX_HALVINGS: usize = 8;
/// Largest relative change of an unknown in one step.
const LARGEST_CHANGE: f64 = 0.3;
/// States kept for prediction.
const HISTORY: usize = 4;
/// Halvings of the way to a state.
const MAX_DETOURS: usize = 6;
/// Contact radius over edge radius, minus one, that counts as rounding.
const EDGE_ROUNDING: f64 = 1e-9;
/// First indentation on the way from rest, over the height.
const FIRST_INDENTATION: f64 = 1e-3;
/// Largest factor between indentations.
const LARGEST_FACTOR: f64 = 4.0;

/// The unknowns: pole stretch, pressure, contact parameter.
pub type Unknowns = [f64; VARIED];

/// Shooting for one design.
#[derive(Clone, Debug)]
pub struct Shooting {
    problem: PlainMembrane,
    tolerance: f64,
    rest: ShootingRest,
    /// Logarithm of the indentation and unknowns of the latest states, newest last.
    history: Vec<(f64, Unknowns)>,
    condition: f64,
}

/// The edge reached from some unknowns.
struct Shot {
    end: Free,
    contact_radius: f64,
    met: Met,
}

impl Shooting {
    /// Inflates a design to its rest state; `tolerance` is the relative one of the integration.
    ///
    /// # Errors
    /// [`MethodFailure`].
    pub fn new(design: &Design, tolerance: f64) -> Result<Self, MethodFailure> {
        let problem = PlainMembrane::new(design)?;
        let rest = ShootingRest::new(&problem, tolerance)?;
        Ok(Self {
            problem,
            tolerance,
            rest,
            history: Vec::new(),
            condition: 1.0,
        })
    }

    /// The rest state, dimensionless.
    pub fn rest(&self) -> &ShootingRest {
        &self.rest
    }

    /// Condition of Newton's last matrix, in relative changes.
    pub fn condition(&self) -> f64 {
        self.condition
    }

    /// The state at an indentation in metres, over states in between where it takes them.
    ///
    /// # Errors
    /// [`MethodFailure`].
    pub fn at_indentation(&mut self, indentation: f64) -> Result<MethodState, MethodFailure> {
        let target = self.dimensionless(indentation)?;
        let mut reached = if let Some(&(place, _)) = self.history.last() {
            libm::exp(place)
        } else {
            let first = target.min(FIRST_INDENTATION * self.rest.height);
            let found = self.solve(first, self.first_contact(first))?;
            if first.to_bits() == target.to_bits() {
                return Ok(self.found(indentation, &found));
            }
            first
        };
        let mut detours = 0;
        loop {
            let mut next = target.clamp(reached / LARGEST_FACTOR, reached * LARGEST_FACTOR);
            loop {
                match self.solve(next, self.predict(next)) {
                    Ok(found) if next.to_bits() == target.to_bits() => {
                        return Ok(self.found(indentation, &found));
                    }
                    Ok(_) => break,
                    Err(failure) if detours == MAX_DETOURS => return Err(failure),
                    Err(_) => {
                        detours += 1;
                        next = libm::sqrt(next * reached);
                    }
                }
            }
            reached = next;
        }
    }

    /// The state at an indentation in metres from a guess: pole stretch, pressure in pascals, contact parameter.
    ///
    /// # Errors
    /// [`MethodFailure`].
    pub fn from_guess(&mut self, indentation: f64, guess: Unknowns) -> Result<MethodState, MethodFailure> {
        let target = self.dimensionless(indentation)?;
        let [stretch, pressure, contact] = guess;
        let found = self.solve(target, [stretch, pressure / self.problem.scale.pressure, contact])?;
        Ok(self.found(indentation, &found))
    }

    fn dimensionless(&self, indentation: f64) -> Result<f64, MethodFailure> {
        if indentation > 0.0 && indentation.is_finite() {
            Ok(indentation / self.problem.scale.length)
        } else {
            Err(MethodFailure::NotAnIndentation { asked: indentation })
        }
    }

    fn found(&self, indentation: f64, (unknowns, shot): &(Unknowns, Shot)) -> MethodState {
        let scale = &self.problem.scale;
        let [pole_stretch, pressure, contact_parameter] = *unknowns;
        let contact_radius = shot.contact_radius * scale.length;
        MethodState {
            indentation,
            pressure: pressure * scale.pressure,
            pressure_rise: (pressure - self.rest.pressure) * scale.pressure,
            force: pressure * scale.pressure * PI * contact_radius * contact_radius,
            contact_radius,
            contact_parameter,
            pole_stretch,
            compressed: self.rest.met.least.min(shot.met.least) < 0.0,
        }
    }

    /// The rest state's pole and pressure, and the contact of first touch (`H = (P r^2 / 2 T) ln(edge / r)`).
    fn first_contact(&self, indentation: f64) -> Unknowns {
        let stretch = self.problem.pole_stretch;
        let d = model_tables::material::Hyperelastic::derivatives(&self.problem.law, stretch, stretch);
        let tension = d.w1 / stretch;
        let mut radius = 0.1 * self.rest.edge;
        for _ in 0..30 {
            let logarithm = libm::log(self.rest.edge / radius).max(0.3);
            radius = libm::sqrt(2.0 * tension * indentation / (self.rest.pressure * logarithm))
                .min(0.5 * self.rest.edge);
        }
        [
            stretch,
            self.rest.pressure,
            libm::asin((radius / stretch).min(0.9)),
        ]
    }

    /// Extrapolates the latest states in the logarithm of the indentation.
    fn predict(&self, indentation: f64) -> Unknowns {
        let target = libm::log(indentation);
        let mut unknowns = [0.0; VARIED];
        for (i, (place, state)) in self.history.iter().enumerate() {
            let weight: f64 = self
                .history
                .iter()
                .enumerate()
                .filter(|&(j, _)| j != i)
                .map(|(_, (other, _))| (target - other) / (place - other))
                .product();
            for (value, part) in unknowns.iter_mut().zip([state[0], state[1], libm::log(state[2])]) {
                *value += weight * part;
            }
        }
        unknowns[2] = libm::exp(unknowns[2]);
        let sane = unknowns.iter().all(|value| value.is_finite() && *value > 0.0) && unknowns[2] < FRAC_PI_2;
        match self.history.last() {
            Some((_, latest)) if !sane => *latest,
            _ => unknowns,
        }
    }

    fn shoot(&self, [stretch, pressure, contact]: Unknowns) -> Result<Shot, MethodFailure> {
        let problem = &self.problem;
        let mut memory = LastStretches::new(stretch);
        let start = start_of(self.tolerance).min(0.5 * contact);
        let [rho, p, rho_by, p_by] = integrate(
            |t, y| problem.contact_rates(t, y, &mut memory),
            [start, contact],
            problem.contact_start(start, stretch),
            FIRST_STEP * start,
            &tolerance(self.tolerance, 2),
        )?;
        // The rate of the edge's radius as the edge moves; radius and thrust themselves are continuous there.
        let edge_rate = problem
            .contact_rates(contact, &[rho, p, 0.0, 0.0], &mut memory)
            .ok_or(MethodFailure::BlewUp { position: contact })?[RADIUS];
        let radius_by = [rho_by, 0.0, edge_rate];
        let load = Load {
            pressure,
            load: 0.5 * pressure * rho * rho,
            pressure_by: [0.0, 1.0, 0.0],
            load_by: [
                pressure * rho * radius_by[0],
                0.5 * rho * rho,
                pressure * rho * radius_by[2],
            ],
        };
        let mut y = [0.0; STATE * (1 + VARIED)];
        (y[RADIUS], y[THRUST]) = (rho, p);
        (y[STATE + RADIUS], y[STATE + THRUST]) = (rho_by, p_by);
        let end = integrate(
            |t, y| problem.free_rates(t, y, &load, &mut memory),
            [contact, FRAC_PI_2],
            y,
            0.5 * contact,
            &tolerance(self.tolerance, STATE),
        )?;
        Ok(Shot {
            end,
            contact_radius: rho,
            met: memory.met,
        })
    }

    /// Relative residuals (edge radius, volume, height) and their derivatives by relative changes.
    fn equations(&self, target: f64, unknowns: &Unknowns, shot: &Shot) -> ([f64; 3], [[f64; 3]; 3]) {
        let rest = &self.rest;
        let compliance = self.problem.compliance;
        let fluid = rest.volume + compliance * rest.pressure;
        let residual = [
            shot.end[RADIUS] / rest.edge - 1.0,
            (shot.end[VOLUME] + compliance * unknowns[1]) / fluid - 1.0,
            (shot.end[HEIGHT] - (rest.height - target)) / rest.height,
        ];
        let mut matrix = [[0.0; 3]; 3];
        for k in 0..VARIED {
            let at = STATE * (1 + k);
            let squeezed = if k == 1 { compliance } else { 0.0 };
            matrix[0][k] = shot.end[at + RADIUS] / rest.edge * unknowns[k];
            matrix[1][k] = (shot.end[at + VOLUME] + squeezed) / fluid * unknowns[k];
            matrix[2][k] = shot.end[at + HEIGHT] / rest.height * unknowns[k];
        }
        (residual, matrix)
    }

    fn solve(&mut self, target: f64, guess: Unknowns) -> Result<(Unknowns, Shot), MethodFailure> {
        if target >= self.rest.height {
            return Err(MethodFailure::BeyondLimit {
                ratio: target / self.rest.height,
            });
        }
        let size = |r: &[f64; 3]| r.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
        let mut unknowns = guess;
        let mut shot = self.shoot(unknowns)?;
        for _ in 0..MAX_STEPS {
            let (residual, matrix) = self.equations(target, &unknowns, &shot);
            let (inverse, condition) = invert(&matrix).ok_or(MethodFailure::Singular)?;
            self.condition = condition;
            let step = inverse.map(|row| -row.iter().zip(&residual).map(|(a, r)| a * r).sum::<f64>());
            let largest = size(&step);
            if !largest.is_finite() {
                return Err(MethodFailure::Singular);
            }
            let moved = |damping: f64| {
                let mut next = unknowns;
                for (value, by) in next.iter_mut().zip(&step) {
                    *value *= 1.0 + (damping * by).clamp(-LARGEST_CHANGE, LARGEST_CHANGE);
                }
                next[2] = next[2].min(0.5 * (unknowns[2] + FRAC_PI_2));
                next
            };
            let stalled = MethodFailure::Stalled {
                residual: size(&residual),
                condition,
            };
            // The step is the error: with it applied, what is left is its square.
            if largest < 1e-2 * libm::sqrt(self.tolerance) || largest < 1e-11 * condition.min(1e3) {
                unknowns = moved(1.0);
                shot = self.shoot(unknowns)?;
                if largest < self.tolerance || largest < 1e-11 * condition.min(1e3) {
                    return self.accept(target, unknowns, shot);
                }
                let (left, _) = self.equations(target, &unknowns, &shot);
                if size(&left) < 0.1 * self.tolerance {
                    return self.accept(target, unknowns, shot);
                }
                continue;
            }
            let mut damping = 1.0;
            let mut halvings = 0;
            shot = loop {
                let trial = self.shoot(moved(damping));
                if let Ok(trial) = trial {
                    let (left, _) = self.equations(target, &moved(damping), &trial);
                    if size(&left) < (1.0 - 0.1 * damping) * size(&residual) {
                        break trial;
                    }
                }
                damping *= 0.5;
                halvings += 1;
                if halvings > MAX_HALVINGS {
                    return Err(stalled);
                }
            };
            unknowns = moved(damping);
        }
        let (residual, _) = self.equations(target, &unknowns, &shot);
        Err(MethodFailure::Stalled {
            residual: size(&residual),
            condition: self.condition,
        })
    }

    fn accept(
        &mut self,
        target: f64,
        unknowns: Unknowns,
        shot: Shot,
    ) -> Result<(Unknowns, Shot), MethodFailure> {
        let ratio = shot.contact_radius / self.rest.edge;
        if ratio > 1.0 + EDGE_ROUNDING {
            return Err(MethodFailure::BeyondLimit { ratio });
        }
        if shot.met.unstable {
            return Err(MethodFailure::LawUnstable);
        }
        let place = libm::log(target);
        self.history.retain(|(other, _)| (other - place).abs() > 1e-6);
        if self.history.len() == HISTORY {
            self.history.remove(0);
        }
        self.history.push((place, unknowns));
        Ok((unknowns, shot))
    }
}
