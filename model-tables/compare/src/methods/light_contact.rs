//! The closed form for light contact.
//!
//! A small plate presses a membrane under the tension `T0` of its rest pole. Near the contact the membrane is flat:
//! outside of the radius `r`, Laplace's equation; under the plate, the cap `P0 s^2 / 4 T0` is levelled. Far away the
//! plate is the point force `F = pi r^2 P0`, and the membrane answers as the linearised equations of the rest state
//! say, its edge clamped and its fluid kept: a deflection `F / (2 pi T0) ln(L / s)` near the pole and a pressure
//! rise `k F`. Both match where
//!
//! ```text
//! H = (P0 r^2 / 2 T0) ln(K / r),   K = L e^(1/2)      dP = k pi r^2 P0      F = pi r^2 (P0 + dP)
//! ```
//!
//! `k` and `K` come from one integration of the plate-free membrane with its variations by pole stretch, pressure
//! and point force; after that a state costs a microsecond. Its weakness: errors of the order `(r / K)^2 ln K / r`,
//! and no state at all beyond the largest indentation of the formula.

use super::MethodFailure;
use super::plain::{HEIGHT, PlainMembrane, RADIUS, STATE, VOLUME};
use super::unpressed::{ShootingRest, inflate};
use core::f64::consts::{E, PI};
use model_tables::curve::Contact;
use model_tables::design::Design;
use model_tables::material::Hyperelastic;

/// Relative tolerance of the rest state.
const TOLERANCE: f64 = 1e-11;
/// Where the point force's field is read: it is logarithmic up to terms of the square of this.
const START: f64 = 1e-5;
/// The formula's indentation grows up to this part of `K`.
const LARGEST_RADIUS: f64 = 0.606_530_659_712_633_4;

/// Light contact of one design; SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightContact {
    /// Pressure at rest, pascals.
    pub rest_pressure: f64,
    /// Tension of the rest pole, newtons per metre.
    pub rest_tension: f64,
    /// `k`: pressure rise by force, pascals per newton.
    pub rise_per_force: f64,
    /// `K`, metres.
    pub length: f64,
}

impl LightContact {
    /// The constants of a design.
    ///
    /// # Errors
    /// [`MethodFailure`]; [`MethodFailure::RestWrinkled`] where some tension of the rest state is negative.
    pub fn new(design: &Design) -> Result<Self, MethodFailure> {
        let problem = PlainMembrane::new(design)?;
        let rest = ShootingRest::new(&problem, TOLERANCE)?;
        if rest.met.least < 0.0 {
            return Err(MethodFailure::RestWrinkled);
        }
        let stretch = problem.pole_stretch;
        // All variations control the step: that by the point force is singular at the pole.
        let reading = [START, TOLERANCE];
        let (end, _) = inflate(&problem, stretch, rest.pressure, reading, STATE * 4)?;
        let by = |parameter: usize, component: usize| end[STATE * (1 + parameter) + component];
        // Changes of pole stretch and pressure by a unit of force over 2 pi: edge and fluid stay.
        let (a, b) = (by(0, RADIUS), by(1, RADIUS));
        let (c, d) = (by(0, VOLUME), by(1, VOLUME) + problem.compliance);
        let determinant = a * d - b * c;
        if determinant == 0.0 || !determinant.is_finite() {
            return Err(MethodFailure::Singular);
        }
        let (e, f) = (-by(2, RADIUS), -by(2, VOLUME));
        let stretch_by = (e * d - b * f) / determinant;
        let pressure_by = (a * f - e * c) / determinant;
        let deflection = -(by(2, HEIGHT) + stretch_by * by(0, HEIGHT) + pressure_by * by(1, HEIGHT));
        let tension = problem.law.derivatives(stretch, stretch).w1 / stretch;
        let scale = &problem.scale;
        let reading_radius = stretch * START;
        Ok(Self {
            rest_pressure: rest.pressure * scale.pressure,
            rest_tension: tension * scale.tension,
            rise_per_force: pressure_by * scale.pressure / (2.0 * PI * scale.tension * scale.length),
            length: libm::sqrt(E) * reading_radius * libm::exp(tension * deflection) * scale.length,
        })
    }

    /// The largest indentation of the formula, metres.
    pub fn largest_indentation(&self) -> f64 {
        let radius = LARGEST_RADIUS * self.length;
        self.rest_pressure * radius * radius / (4.0 * self.rest_tension)
    }

    /// The state of a deformed contact radius, metres.
    pub fn at_contact_radius(&self, radius: f64) -> Contact {
        let area = PI * radius * radius;
        let pressure_rise = self.rise_per_force * area * self.rest_pressure;
        Contact {
            pressure_rise,
            force: area * (self.rest_pressure + pressure_rise),
            indentation: 0.5 * self.rest_pressure * radius * radius / self.rest_tension
                * libm::log(self.length / radius),
        }
    }

    /// The contact radius of an indentation, both metres.
    ///
    /// # Errors
    /// [`MethodFailure::NotAnIndentation`], [`MethodFailure::BeyondModel`].
    pub fn contact_radius(&self, indentation: f64) -> Result<f64, MethodFailure> {
        if !(indentation >= 0.0 && indentation.is_finite()) {
            return Err(MethodFailure::NotAnIndentation { asked: indentation });
        }
        let largest = self.largest_indentation();
        if indentation > largest {
            return Err(MethodFailure::BeyondModel {
                asked: indentation,
                largest,
            });
        }
        if indentation == 0.0 {
            return Ok(0.0);
        }
        // With s = ln(K / r) - 1/2 >= 0 the equation is 2 s - ln(1 + 2 s) = ln(largest / indentation), convex and
        // increasing: Newton's iterates approach from above.
        let depth = libm::log(largest / indentation);
        let mut s = 0.5 * depth + libm::sqrt(0.5 * depth) + 0.5 * libm::log1p(depth);
        for _ in 0..60 {
            let over = 2.0 * s - libm::log1p(2.0 * s) - depth;
            let step = over * (1.0 + 2.0 * s) / (4.0 * s);
            if !step.is_finite() || step.abs() <= 1e-16 * s {
                break;
            }
            s = (s - step).max(0.0);
        }
        Ok(self.length * libm::exp(-s - 0.5))
    }

    /// The state of an indentation in metres.
    ///
    /// # Errors
    /// [`MethodFailure::NotAnIndentation`], [`MethodFailure::BeyondModel`].
    pub fn at_indentation(&self, indentation: f64) -> Result<Contact, MethodFailure> {
        let radius = self.contact_radius(indentation)?;
        if radius == 0.0 {
            return Ok(Contact::default());
        }
        Ok(Contact {
            indentation,
            ..self.at_contact_radius(radius)
        })
    }
}
