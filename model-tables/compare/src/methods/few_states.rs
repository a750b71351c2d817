//! A curve through a few states of the full membrane, on top of the closed form.
//!
//! Against the contact radius `r`, `H / r^2 + (P0 / 2 T0) ln r` and `dP / r^2` have finite values at first contact
//! (those of [`LightContact`]) and bend little: polynomials through them and a few solved states carry the
//! closed form to the end of the press. Its weakness: next to first contact the terms left are `r^2 ln r`, so the
//! order of convergence is low there; and it knows nothing of zones that appear on the way.

use super::MethodFailure;
use super::light_contact::LightContact;
use core::f64::consts::PI;
use model_tables::curve::Contact;
use model_tables::design::Design;
use model_tables::membrane::press::Press;

/// States at most.
pub const MAX_STATES: usize = 16;
/// Points of one interpolating polynomial. The first points lie far closer than the last: higher degrees swing.
const STENCIL: usize = 5;
/// A radius that moves by less than this, relative, is found.
const ROOT_TOLERANCE: f64 = 1e-13;
/// Steps of the search for the radius of an indentation.
const MAX_STEPS: usize = 100;

/// A curve from first contact to the deepest of its states.
#[derive(Clone, Debug)]
pub struct FewStates {
    light: LightContact,
    /// Contact radii, metres: 0, then increasing.
    radii: Vec<f64>,
    /// Indentation and pressure rise over the squared radius, the logarithm taken out.
    values: Vec<[f64; 2]>,
    deepest: f64,
}

impl FewStates {
    /// A curve down to `deepest`, metres, through so many states of the press, 1 to [`MAX_STATES`].
    ///
    /// # Errors
    /// [`MethodFailure`].
    pub fn new<const S: usize>(
        design: &Design,
        press: &mut Press<model_tables::material::Law, S>,
        deepest: f64,
        states: usize,
    ) -> Result<Self, MethodFailure> {
        let light = LightContact::new(design)?;
        let slope = 0.5 * light.rest_pressure / light.rest_tension;
        let states = states.clamp(1, MAX_STATES);
        let mut radii = vec![0.0];
        let mut values = vec![[
            slope * libm::log(light.length),
            light.rise_per_force * PI * light.rest_pressure,
        ]];
        for j in 1..=states {
            // Chebyshev's points of the contact radius, as far as that goes with the root of the indentation.
            let part = 0.5 * (1.0 - libm::cos(PI * j as f64 / states as f64));
            let state = press.contact_at(deepest * part * part)?;
            let square = state.force / (PI * (light.rest_pressure + state.pressure_rise));
            let radius = libm::sqrt(square);
            radii.push(radius);
            values.push([
                state.indentation / square + slope * libm::log(radius),
                state.pressure_rise / square,
            ]);
        }
        Ok(Self {
            light,
            radii,
            values,
            deepest,
        })
    }

    /// Both interpolated quantities at a contact radius.
    fn interpolate(&self, radius: f64) -> [f64; 2] {
        let points = self.radii.len();
        let count = STENCIL.min(points);
        let after = self.radii.partition_point(|&at| at < radius);
        let start = after.saturating_sub(count / 2).min(points - count);
        let stencil = start..start + count;
        let mut value = [0.0; 2];
        for i in stencil.clone() {
            let others = stencil.clone().filter(|&j| j != i);
            let weight: f64 = others
                .map(|j| (radius - self.radii[j]) / (self.radii[i] - self.radii[j]))
                .product();
            for (sum, known) in value.iter_mut().zip(&self.values[i]) {
                *sum += weight * known;
            }
        }
        value
    }

    fn indentation(&self, radius: f64) -> f64 {
        if radius == 0.0 {
            return 0.0;
        }
        let slope = 0.5 * self.light.rest_pressure / self.light.rest_tension;
        radius * radius * (self.interpolate(radius)[0] - slope * libm::log(radius))
    }

    /// The state at an indentation in metres.
    ///
    /// # Errors
    /// [`MethodFailure::NotAnIndentation`], [`MethodFailure::BeyondModel`] beyond the deepest state.
    pub fn at_indentation(&self, indentation: f64) -> Result<Contact, MethodFailure> {
        if !(indentation >= 0.0 && indentation.is_finite()) {
            return Err(MethodFailure::NotAnIndentation { asked: indentation });
        }
        if indentation > self.deepest {
            return Err(MethodFailure::BeyondModel {
                asked: indentation,
                largest: self.deepest,
            });
        }
        if indentation == 0.0 {
            return Ok(Contact::default());
        }
        let radius = self.radius(indentation);
        let rise = self.interpolate(radius)[1] * radius * radius;
        Ok(Contact {
            pressure_rise: rise,
            force: PI * radius * radius * (self.light.rest_pressure + rise),
            indentation,
        })
    }

    /// The radius of an indentation: the Illinois method on the root of the indentation.
    fn radius(&self, indentation: f64) -> f64 {
        let target = libm::sqrt(indentation);
        let excess = |radius: f64| libm::sqrt(self.indentation(radius).max(0.0)) - target;
        let (mut low, mut high) = (0.0, self.radii[self.radii.len() - 1]);
        let (mut of_low, mut of_high) = (-target, excess(high));
        if of_high <= 0.0 {
            return high;
        }
        let (mut side, mut before) = (0, 0.0);
        for _ in 0..MAX_STEPS {
            let next = (low * of_high - high * of_low) / (of_high - of_low);
            let value = excess(next);
            if value == 0.0 || (next - before).abs() < ROOT_TOLERANCE * next {
                return next;
            }
            before = next;
            if value > 0.0 {
                (high, of_high) = (next, value);
                if side == 1 {
                    of_low *= 0.5;
                }
                side = 1;
            } else {
                (low, of_low) = (next, value);
                if side == -1 {
                    of_high *= 0.5;
                }
                side = -1;
            }
        }
        before
    }
}
