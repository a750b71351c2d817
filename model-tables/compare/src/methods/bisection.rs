//! The way of the source paper: fixed-step Runge-Kutta from the pole, nested bisections of the unknowns.
//!
//! Shi, Shariati, Eames and Wurdemann, *Soft Matter* 18 (2022) 9076, with the equations of equilibrium as they are
//! (the printed ones carry misprints). State `rho, l1, phi, height, volume` over the meridian's parameter: radius,
//! stretch and tangent angle. The innermost bisection closes the edge's radius by the pole stretch, the middle one
//! the volume by the pressure, the outer one the indentation by the contact edge.
//!
//! Its weaknesses: thousands of integrations a state, each bisection at the mercy of the tolerance of those inside
//! it; and fixed steps that are too long next to a small contact, where everything varies with the distance to the
//! pole. So a state is shown to twice the steps before it is believed: one Newton step from it says how far it is
//! off, and one that is further off than half a per cent is refused.

use super::matrix::invert;
use super::plain::{Met, PlainMembrane};
use super::runge_kutta::runge_kutta;
use super::{MethodFailure, MethodState, Unknown};
use core::f64::consts::{FRAC_PI_2, PI};
use model_tables::design::Design;
use model_tables::material::Hyperelastic;

/// Radius, stretch, angle, height, volume.
type State = [f64; 5];
/// Parts of the free zone's steps that the contact zone gets.
const CONTACT_SHARE: usize = 4;
/// First guess of how far a root lies from the state before, relative.
const FIRST_SPREAD: f64 = 0.02;
/// Growth of a bracket that does not hold the root.
const SPREAD_GROWTH: f64 = 2.5;
/// Attempts at a bracket.
const MAX_BRACKETS: usize = 12;
/// What is left of an equation, over the tolerance, at which a root was a jump.
const JUMP: f64 = 300.0;
/// Force error, relative, beyond which a state is refused.
const MAX_ERROR: f64 = 0.005;
/// Relative differences that its estimate takes.
const DIFFERENCE: f64 = 1e-4;
/// Indentations below so many tolerances of the height are lost in the errors of the bisections.
const MIN_INDENTATION: f64 = 30.0;

/// How fine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fineness {
    /// Steps from contact edge to equator.
    pub steps: usize,
    /// Width, relative to the bracket, at which a bisection ends.
    pub tolerance: f64,
}

/// The fineness of the paper.
pub const PAPER: Fineness = Fineness {
    steps: 200,
    tolerance: 1e-4,
};

/// Nested bisection for one design.
#[derive(Clone, Debug)]
pub struct Bisection {
    problem: PlainMembrane,
    fineness: Fineness,
    rest: Rest,
    /// The rest state with twice the steps.
    finer_rest: Rest,
    /// Pole stretch, pressure, contact parameter of the state before.
    latest: Option<[f64; 3]>,
    integrations: u64,
}

#[derive(Clone, Copy, Debug, Default)]
struct Rest {
    pressure: f64,
    edge: f64,
    height: f64,
    volume: f64,
    compressed: bool,
}

#[derive(Clone, Copy, Debug)]
struct Reached {
    end: State,
    contact_radius: f64,
    met: Met,
}

/// The side of the root on which a function may be undefined: the integration blows up there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Undefined {
    Below,
    Above,
}

/// A root of an increasing function, to a relative width. The bracket starts around `guess`, grows, and stays within
/// `limits`.
fn bisect(
    unknown: Unknown,
    undefined: Undefined,
    tolerance: f64,
    guess: f64,
    limits: [f64; 2],
    mut of: impl FnMut(f64) -> Result<f64, MethodFailure>,
) -> Result<f64, MethodFailure> {
    let mut last = None;
    let mut value = |x: f64| match of(x) {
        Ok(value) => value,
        Err(failure) => {
            last = Some(failure);
            match undefined {
                Undefined::Below => f64::NEG_INFINITY,
                Undefined::Above => f64::INFINITY,
            }
        }
    };
    let (mut low, mut high) = (guess, guess);
    let mut below = value(guess);
    let mut above = below;
    let mut spread = FIRST_SPREAD;
    for _ in 0..MAX_BRACKETS {
        if below < 0.0 && above >= 0.0 {
            break;
        }
        if above < 0.0 {
            (low, below) = (high, above);
            high = (high * (1.0 + spread)).min(limits[1]);
            above = value(high);
        } else {
            (high, above) = (low, below);
            low = (low * (1.0 - spread).max(0.5)).max(limits[0]);
            below = value(low);
        }
        spread *= SPREAD_GROWTH;
    }
    if below >= 0.0 || above < 0.0 {
        return Err(last.unwrap_or(MethodFailure::NoBracket { unknown }));
    }
    while high - low > tolerance * high {
        let middle = 0.5 * (low + high);
        let found = value(middle);
        if found < 0.0 {
            (low, below) = (middle, found);
        } else {
            (high, above) = (middle, found);
        }
    }
    let residual = above.min(-below);
    if residual.is_infinite() {
        return Err(last.unwrap_or(MethodFailure::NoBracket { unknown }));
    }
    if residual > JUMP * tolerance {
        return Err(MethodFailure::Jump { unknown, residual });
    }
    Ok(0.5 * (low + high))
}

impl Rest {
    fn of(pressure: f64, reached: &Reached) -> Result<Self, MethodFailure> {
        if reached.met.unstable {
            return Err(MethodFailure::LawUnstable);
        }
        let [edge, _, _, height, volume] = reached.end;
        Ok(Self {
            pressure,
            edge,
            height,
            volume,
            compressed: reached.met.least < 0.0,
        })
    }
}

impl Bisection {
    /// Inflates a design to its rest state.
    ///
    /// # Errors
    /// [`MethodFailure`].
    pub fn new(design: &Design, fineness: Fineness) -> Result<Self, MethodFailure> {
        let problem = PlainMembrane::new(design)?;
        let stretch = problem.pole_stretch;
        let mut found = Self {
            problem,
            fineness,
            rest: Rest::default(),
            finer_rest: Rest::default(),
            latest: None,
            integrations: 0,
        };
        let tension = problem.law.derivatives(stretch, stretch).w1 / stretch;
        let guess = 2.0 * tension / stretch * problem.aspect;
        // More pressure turns the equator further; where the integration fails it was too much.
        let pressure = bisect(
            Unknown::Pressure,
            Undefined::Above,
            fineness.tolerance,
            guess,
            [0.01 * guess, 10.0 * guess],
            |pressure| Ok(found.integrate([stretch, pressure, 0.0])?.end[2] - FRAC_PI_2),
        )?;
        found.rest = Rest::of(pressure, &found.integrate([stretch, pressure, 0.0])?)?;
        let mut finer = |pressure: f64| found.integrate_in(2 * fineness.steps, [stretch, pressure, 0.0]);
        let aside = pressure * (1.0 + DIFFERENCE);
        let (here, there) = (finer(pressure)?.end[2], finer(aside)?.end[2]);
        let pressure = pressure + (FRAC_PI_2 - here) / (there - here) * (aside - pressure);
        found.finer_rest = Rest::of(pressure, &finer(pressure)?)?;
        Ok(found)
    }

    /// Integrations from pole to equator made so far.
    pub fn integrations(&self) -> u64 {
        self.integrations
    }

    /// Rest pressure, pascals.
    pub fn rest_pressure(&self) -> f64 {
        self.rest.pressure * self.problem.scale.pressure
    }

    /// The state at an indentation in metres.
    ///
    /// # Errors
    /// [`MethodFailure`].
    pub fn at_indentation(&mut self, indentation: f64) -> Result<MethodState, MethodFailure> {
        if !(indentation > 0.0 && indentation.is_finite()) {
            return Err(MethodFailure::NotAnIndentation { asked: indentation });
        }
        let scale = self.problem.scale;
        let target = indentation / scale.length;
        let [stretch, pressure, contact] = self.latest.unwrap_or_else(|| self.first_contact(target));
        let tolerance = self.fineness.tolerance;
        let least = MIN_INDENTATION * tolerance * self.rest.height;
        if target < least {
            return Err(MethodFailure::BelowResolution {
                asked: indentation,
                least: least * scale.length,
            });
        }
        let mut inner = (stretch, pressure);
        let this = &mut *self;
        let contact = bisect(
            Unknown::Contact,
            Undefined::Above,
            tolerance,
            contact,
            [1e-6, FRAC_PI_2 * (1.0 - 1e-6)],
            |contact| {
                let reached = this.at_contact(contact, &mut inner)?;
                Ok((this.rest.height - target - reached.end[3]) / this.rest.height)
            },
        )?;
        let reached = self.at_contact(contact, &mut inner)?;
        let (pole_stretch, pressure) = inner;
        self.latest = Some([pole_stretch, pressure, contact]);
        let ratio = reached.contact_radius / self.rest.edge;
        if ratio > 1.0 + tolerance {
            return Err(MethodFailure::BeyondLimit { ratio });
        }
        if reached.met.unstable {
            return Err(MethodFailure::LawUnstable);
        }
        let estimate = self.error([pole_stretch, pressure, contact], target)?;
        if estimate.is_nan() || estimate > MAX_ERROR {
            return Err(MethodFailure::Inaccurate { estimate });
        }
        let contact_radius = reached.contact_radius * scale.length;
        Ok(MethodState {
            indentation,
            pressure: pressure * scale.pressure,
            pressure_rise: (pressure - self.rest.pressure) * scale.pressure,
            force: pressure * scale.pressure * PI * contact_radius * contact_radius,
            contact_radius,
            contact_parameter: contact,
            pole_stretch,
            compressed: self.rest.compressed || reached.met.least < 0.0,
        })
    }

    /// How far the force of a state is off, relative: by what a Newton step with twice the steps changes it.
    fn error(&mut self, state: [f64; 3], target: f64) -> Result<f64, MethodFailure> {
        let steps = 2 * self.fineness.steps;
        let (rest, compliance) = (self.finer_rest, self.problem.compliance);
        let fluid = rest.volume + compliance * rest.pressure;
        let mut at = |state: [f64; 3]| {
            let Reached {
                end, contact_radius, ..
            } = self.integrate_in(steps, state)?;
            let left = [
                end[0] / rest.edge - 1.0,
                (end[4] + compliance * state[1]) / fluid - 1.0,
                (rest.height - target - end[3]) / target,
            ];
            Ok::<_, MethodFailure>((left, state[1] * contact_radius * contact_radius))
        };
        let (left, force) = at(state)?;
        let mut matrix = [[0.0; 3]; 3];
        for column in 0..3 {
            let mut aside = state;
            aside[column] *= 1.0 + DIFFERENCE;
            let (moved, _) = at(aside)?;
            for row in 0..3 {
                matrix[row][column] = (moved[row] - left[row]) / (aside[column] - state[column]);
            }
        }
        let (inverse, _) = invert(&matrix).ok_or(MethodFailure::Singular)?;
        let step = inverse.map(|row| row[0] * left[0] + row[1] * left[1] + row[2] * left[2]);
        let (_, better) = at(core::array::from_fn(|i| state[i] - step[i]))?;
        Ok((better / force - 1.0).abs())
    }

    fn first_contact(&self, target: f64) -> [f64; 3] {
        let stretch = self.problem.pole_stretch;
        let tension = self.problem.law.derivatives(stretch, stretch).w1 / stretch;
        let radius = libm::sqrt(2.0 * tension * target / (2.0 * self.rest.pressure));
        let contact = libm::asin((radius / stretch).min(0.5));
        [stretch, self.rest.pressure, contact]
    }

    /// The state of a contact edge: bisects the pressure for the volume.
    fn at_contact(&mut self, contact: f64, inner: &mut (f64, f64)) -> Result<Reached, MethodFailure> {
        let (mut stretch, guess) = *inner;
        let compliance = self.problem.compliance;
        let fluid = self.rest.volume + compliance * self.rest.pressure;
        let this = &mut *self;
        let pressure = bisect(
            Unknown::Pressure,
            Undefined::Above,
            this.fineness.tolerance,
            guess,
            [0.2 * guess, 10.0 * guess],
            |pressure| {
                let reached = this.at_pressure(contact, pressure, &mut stretch)?;
                Ok((reached.end[4] + compliance * pressure) / fluid - 1.0)
            },
        )?;
        let reached = self.at_pressure(contact, pressure, &mut stretch)?;
        *inner = (stretch, pressure);
        Ok(reached)
    }

    /// The state of a contact edge and a pressure: bisects the pole stretch for the clamped edge.
    fn at_pressure(
        &mut self,
        contact: f64,
        pressure: f64,
        stretch: &mut f64,
    ) -> Result<Reached, MethodFailure> {
        let this = &mut *self;
        let found = bisect(
            Unknown::PoleStretch,
            Undefined::Below,
            this.fineness.tolerance,
            *stretch,
            [0.3, 20.0],
            |stretch| {
                let reached = this.integrate([stretch, pressure, contact])?;
                Ok(reached.end[0] / this.rest.edge - 1.0)
            },
        )?;
        *stretch = found;
        self.integrate([found, pressure, contact])
    }

    /// From the pole to the equator; a contact edge at 0 means no plate.
    fn integrate(&mut self, state: [f64; 3]) -> Result<Reached, MethodFailure> {
        self.integrate_in(self.fineness.steps, state)
    }

    fn integrate_in(
        &mut self,
        steps: usize,
        [stretch, pressure, contact]: [f64; 3],
    ) -> Result<Reached, MethodFailure> {
        self.integrations += 1;
        let problem = &self.problem;
        let mut met = Met::NOTHING;
        let (start, mut y) = if contact > 0.0 {
            // The pole's series where the first step would begin.
            let contact_steps = (steps / CONTACT_SHARE).max(2);
            let first = contact / contact_steps as f64;
            let y: State = [stretch * libm::sin(first), stretch, 0.0, 0.0, 0.0];
            let flat = |t: f64, y: &State| rates(problem, t, y, None, &mut met);
            (
                contact,
                runge_kutta(flat, [first, contact], contact_steps - 1, y)?,
            )
        } else {
            let first = FRAC_PI_2 / steps as f64;
            let tension = problem.law.derivatives(stretch, stretch).w1 / stretch;
            let angle = 0.5 * pressure * stretch / tension * first;
            let cap = 0.5 * stretch * first * angle;
            (first, [stretch * libm::sin(first), stretch, angle, cap, 0.0])
        };
        let contact_radius = if contact > 0.0 { y[0] } else { 0.0 };
        let free = |t: f64, y: &State| rates(problem, t, y, Some(pressure), &mut met);
        y = runge_kutta(free, [start, FRAC_PI_2], steps, y)?;
        Ok(Reached {
            end: y,
            contact_radius,
            met,
        })
    }
}

/// Rates of the state: under the plate without a pressure, in the free zone with one.
fn rates(
    problem: &PlainMembrane,
    t: f64,
    &[rho, l1, angle, _, _]: &State,
    pressure: Option<f64>,
    met: &mut Met,
) -> Option<State> {
    if !(rho > 0.0 && l1 > 0.0 && l1 < 100.0 && rho < 100.0 && angle.abs() < 10.0) {
        return None;
    }
    let (x, x_rate, g) = problem.meridian(t);
    let l2 = rho / x;
    let d = problem.law.derivatives(l1, l2);
    // Tensions per deformed length; T1' = -(rho'/rho)(T1 - T2).
    let (t1, t2) = (d.w1 / l2, d.w2 / l1);
    met.note(problem, [l1, l2], [t1, t2]);
    let (sin, cos) = libm::sincos(angle);
    let forward = l1 * g * cos;
    let l2_rate = (forward - l2 * x_rate) / x;
    let t1_rate = -(forward / rho) * (t1 - t2);
    let l1_rate = (t1_rate * l2 - (d.w12 - d.w1 / l2) * l2_rate) / d.w11;
    let (turn, descent) = match pressure {
        None => (0.0, 0.0),
        Some(_) if t1 <= 0.0 => return None,
        Some(pressure) => (l1 * g * (pressure - t2 * sin / rho) / t1, l1 * g * sin),
    };
    Some([forward, l1_rate, turn, descent, PI * rho * rho * descent])
}

#[cfg(test)]
mod tests;
