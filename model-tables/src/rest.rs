//! The rest state: inflated, not pressed.

use crate::adapt::{Adaptive, Failure, Graded};
use crate::equilibrium::{Closure, MAX_ELEMENTS, Outcome, Pole, RestControl, Solution};
use crate::material::Hyperelastic;
use crate::membrane::{POLE, PRESSURE, TensionField};
use crate::mesh::{Breaks, Depth};
use core::f64::consts::FRAC_PI_2;

/// What the rest state is given by, for messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Gauge pressure.
    Pressure,
    /// Radius of the equator.
    EquatorRadius,
    /// Height of the dome.
    Height,
}

/// Which of several rest states of the same pressure, radius or height was taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Branch {
    /// There is no other up to the largest pole stretch looked at.
    Only,
    /// The less stretched of two; the other has this pole stretch.
    Lower {
        /// Pole stretch of the other state.
        other: f64,
    },
    /// The more stretched of two; the other has this pole stretch.
    Upper {
        /// Pole stretch of the other state.
        other: f64,
    },
}

/// Why there is no rest state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RestFailure {
    /// No pole stretch up to the largest one looked at gives the quantity; it lies within these bounds
    /// (dimensionless: pressure over `mu h0 / a0`, lengths over `a0`).
    OutOfReach {
        /// Which quantity.
        quantity: Quantity,
        /// The least value found.
        least: f64,
        /// The greatest value found.
        greatest: f64,
    },
    /// The solver failed.
    Solver(Failure),
}

/// How much finer the mesh of the rest state is than that of a press. It is solved once, and the first
/// indentations are small differences against its height.
const REST_FINENESS: f64 = 3.0;
/// Largest pole stretch at which a rest state of given pressure, radius or height is looked for.
pub const LARGEST_POLE_STRETCH: f64 = 6.0;
/// First step of the scan, in pole stretch over 1.
const FIRST_STEP: f64 = 2e-3;
/// Growth of the scan's steps.
const STEP_GROWTH: f64 = 1.15;

impl<L: Hyperelastic, const S: usize> Adaptive<L, S> {
    /// A mesh without a solution on it: uniformly stretched, the tangent of the undeformed membrane.
    fn inflated_guess(&self, pole_stretch: f64) -> Graded<S> {
        let membrane = &self.equilibrium.membrane;
        let depth = Depth {
            contact_parameter: 0.0,
            bend: 0.5,
        };
        let mut fractions = [0.0; MAX_ELEMENTS + 2];
        let mut count = 0;
        let free_elements = depth.spread(0.0, FRAC_PI_2, REST_FINENESS * self.resolution.density, |t| {
            count += 1;
            fractions[1 + count] = t / FRAC_PI_2;
        });
        let tension = membrane.law.derivatives(pole_stretch, pole_stretch).w1;
        let mut solution = Solution {
            pole: Pole::Taut,
            contact_elements: 0,
            free_elements,
            fractions,
            nodes: [[0.0; 2]; MAX_ELEMENTS + 1],
            stages: [[[0.0; 2]; S]; MAX_ELEMENTS],
            stretches: [[pole_stretch; S]; MAX_ELEMENTS],
            // Exact for a sphere; of an ellipsoid, the curvature at the pole is b0 / a0^2.
            parameters: [
                pole_stretch,
                2.0 * tension / (pole_stretch * pole_stretch) * membrane.aspect,
                0.0,
                0.0,
            ],
            height: 0.0,
            volume: 0.0,
        };
        let guess = |t: f64| {
            let meridian = membrane.meridian(t);
            [pole_stretch, tension * meridian.x_rate / meridian.arc_rate]
        };
        for e in 0..free_elements {
            let span = solution.span(e);
            solution.nodes[e] = guess(span.start);
            for j in 0..S {
                solution.stages[e][j] = guess(span.start + self.equilibrium.gauss.nodes[j] * span.length);
            }
        }
        solution.nodes[free_elements] = guess(FRAC_PI_2);
        Graded {
            solution,
            depth,
            breaks: Breaks::default(),
            outcome: Outcome::Stalled { step: f64::INFINITY },
        }
    }

    /// The rest state of a pole stretch.
    ///
    /// # Errors
    /// [`Failure`] when even a slow way from the sphere, whose state is known, does not arrive.
    pub fn rest_by_pole_stretch(&mut self, pole_stretch: f64) -> Result<Graded<S>, Failure> {
        let closure = Closure::Rest(RestControl::PoleStretch(pole_stretch));
        if let Ok(state) = self.settle(self.inflated_guess(pole_stretch), &closure) {
            return Ok(state);
        }
        // Continuation in the aspect, from the sphere; a plain membrane first, so that kinks come last.
        let (aspect, field) = (
            self.equilibrium.membrane.aspect,
            self.equilibrium.membrane.tension_field,
        );
        let mut result = Err(Failure::Unsettled);
        for steps in [4, 16, 64] {
            self.equilibrium.membrane.tension_field = TensionField::Plain;
            self.equilibrium.membrane.aspect = 1.0;
            let mut state = self.settle(self.inflated_guess(pole_stretch), &closure);
            for k in 1..=steps {
                let Ok(from) = state else { break };
                self.equilibrium.membrane.aspect = libm::pow(aspect, f64::from(k) / f64::from(steps));
                state = self.settle(from, &closure);
            }
            self.equilibrium.membrane.aspect = aspect;
            self.equilibrium.membrane.tension_field = field;
            result = state.and_then(|from| self.settle(from, &closure));
            if result.is_ok() {
                break;
            }
        }
        result
    }

    /// The rest state of a pressure, equator radius or height, all dimensionless.
    ///
    /// None of the three is one-to-one. The pole stretch is scanned upward from 1; of two states of one pressure the
    /// less stretched is taken (inflation reaches it first), of two states of one radius or height the more
    /// stretched (the other lies where the membrane still shrinks as it is inflated).
    ///
    /// # Errors
    /// [`RestFailure`] with the reachable values if there is no such state.
    pub fn rest_by(&mut self, quantity: Quantity, value: f64) -> Result<(Graded<S>, Branch), RestFailure> {
        let of = |state: &Graded<S>| match quantity {
            Quantity::Pressure => state.solution.parameters[PRESSURE],
            Quantity::EquatorRadius => state.solution.nodes[state.solution.elements()][0],
            Quantity::Height => state.solution.height,
        };
        let control = match quantity {
            Quantity::Pressure => RestControl::Pressure(value),
            Quantity::EquatorRadius => RestControl::EquatorStretch(value),
            Quantity::Height => RestControl::Height(value),
        };
        let (mut least, mut greatest) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut crossings: [Option<Graded<S>>; 2] = [None, None];
        let mut before: Option<Graded<S>> = None;
        let mut step = FIRST_STEP;
        let mut pole_stretch = 1.0 + FIRST_STEP;
        while pole_stretch <= LARGEST_POLE_STRETCH {
            let state = match &before {
                None => self.rest_by_pole_stretch(pole_stretch),
                Some(from) => {
                    let closure = Closure::Rest(RestControl::PoleStretch(pole_stretch));
                    self.settle(from.clone(), &closure)
                        .or_else(|_| self.rest_by_pole_stretch(pole_stretch))
                }
            };
            let Ok(state) = state else { break };
            let (low, high) = (before.as_ref().map_or(f64::NAN, of), of(&state));
            let below_first = before.is_none() && quantity == Quantity::Pressure && value <= high;
            if below_first || (low <= value && value < high) || (high < value && value <= low) {
                let nearer = match before {
                    Some(from) if (low - value).abs() < (high - value).abs() => from,
                    _ => state.clone(),
                };
                let slot = usize::from(crossings[0].is_some());
                crossings[slot] = self.settle(nearer, &Closure::Rest(control)).ok();
                if slot == 1 && crossings[1].is_some() {
                    break;
                }
            }
            (least, greatest) = (least.min(high), greatest.max(high));
            before = Some(state);
            pole_stretch += step;
            step *= STEP_GROWTH;
        }
        let stretch = |state: &Graded<S>| state.solution.parameters[POLE];
        match (crossings, quantity) {
            ([None, _], _) => Err(RestFailure::OutOfReach {
                quantity,
                least,
                greatest,
            }),
            ([Some(only), None], _) => Ok((only, Branch::Only)),
            ([Some(lower), Some(upper)], Quantity::Pressure) => {
                let other = stretch(&upper);
                Ok((lower, Branch::Lower { other }))
            }
            ([Some(lower), Some(upper)], _) => {
                let other = stretch(&lower);
                Ok((upper, Branch::Upper { other }))
            }
        }
    }
}
