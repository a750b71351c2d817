//! The rest state: inflated, not pressed.

use crate::material::Hyperelastic;
use crate::membrane::adapt::{Adaptive, Graded, REST_FINENESS, Unsolved};
use crate::membrane::closure::{Closure, NewtonOutcome, RestControl};
use crate::membrane::equations::{POLE, PRESSURE, TensionField};
use crate::membrane::inflation::End;
use crate::membrane::mesh::{Breaks, Depth};
use crate::membrane::solution::Pole;
use core::f64::consts::FRAC_PI_2;

/// The quantity that gives the rest state, for messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RestQuantity {
    /// Stretch of the pole.
    PoleStretch,
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
        quantity: RestQuantity,
        /// The least value found.
        least: f64,
        /// The greatest value found.
        greatest: f64,
    },
    /// The solver failed.
    Solver(Unsolved),
}

/// Largest pole stretch at which a rest state of given pressure, radius or height is looked for.
pub const LARGEST_POLE_STRETCH: f64 = 6.0;
/// First step of the scan, in pole stretch over 1.
const FIRST_STEP: f64 = 2e-3;
/// The golden section.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
/// Pole stretch within which an extreme is located; the quantity is flat there.
const EXTREME_TOLERANCE: f64 = 1e-6;
/// A root whose last correction is this small, relative to the pole stretch, is found.
const ROOT_TOLERANCE: f64 = 1e-14;
/// Corrections of a root at most.
const MAX_ROOT_STEPS: usize = 60;
/// Growth of the scan's steps.
const STEP_GROWTH: f64 = 1.15;

impl<L: Hyperelastic, const S: usize> Adaptive<L, S> {
    /// Makes `state` a guess: uniformly stretched, the tangent of the undeformed membrane.
    pub(crate) fn guess_inflated(&self, pole_stretch: f64, state: &mut Graded<S>) {
        let membrane = &self.equilibrium.membrane;
        state.depth = Depth {
            contact_parameter: 0.0,
            bend: 0.5,
        };
        state.breaks = Breaks::default();
        state.outcome = NewtonOutcome::Stalled { step: f64::INFINITY };
        let solution = &mut state.solution;
        let fractions = &mut solution.fractions;
        fractions[..2].fill(0.0);
        let mut count = 0;
        let fineness = REST_FINENESS * self.resolution.density;
        let free_elements = state.depth.spread(0.0, FRAC_PI_2, fineness, |t| {
            count += 1;
            fractions[1 + count] = t / FRAC_PI_2;
        });
        let tension = membrane.law.derivatives(pole_stretch, pole_stretch).w1;
        solution.pole = Pole::Taut;
        solution.contact_elements = 0;
        solution.free_elements = free_elements;
        solution.stretches.fill([pole_stretch; S]);
        // Exact for a sphere; of an ellipsoid, the curvature at the pole is b0 / a0^2.
        let pressure = 2.0 * tension / (pole_stretch * pole_stretch) * membrane.aspect;
        solution.parameters = [pole_stretch, pressure, 0.0, 0.0];
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
    }

    /// Makes `state` the rest state of a pole stretch. Of its content nothing is used.
    ///
    /// # Errors
    /// [`End`] of inflation, when even the slow ways do not arrive; `state` is then no equilibrium.
    pub fn rest_by_pole_stretch(&mut self, pole_stretch: f64, state: &mut Graded<S>) -> Result<(), End> {
        let direct = self.rest_from_sphere(pole_stretch, state);
        if direct.is_ok() && !self.softens(state) {
            return Ok(());
        }
        // Perhaps a state that inflation does not reach.
        match self.inflate_to(pole_stretch, state) {
            Err(End::Lost(_)) if direct.is_ok() => {
                self.rest_from_sphere(pole_stretch, state).map_err(End::Lost)
            }
            inflated => inflated,
        }
    }

    /// Makes `state` the rest state of a pole stretch, at once or by way of the sphere, whose state is known.
    pub(crate) fn rest_from_sphere(
        &mut self,
        pole_stretch: f64,
        state: &mut Graded<S>,
    ) -> Result<(), Unsolved> {
        let closure = Closure::Rest(RestControl::PoleStretch(pole_stretch));
        self.guess_inflated(pole_stretch, state);
        if self.settle(state, &closure).is_ok() {
            return Ok(());
        }
        // Continuation in the aspect, from the sphere; a plain membrane first, so that kinks come last.
        let (aspect, field) = (
            self.equilibrium.membrane.aspect,
            self.equilibrium.membrane.tension_field,
        );
        let mut result: Result<(), Unsolved> = Err(Unsolved::Unsettled);
        for steps in [4, 16, 64] {
            self.equilibrium.membrane.tension_field = TensionField::Plain;
            self.equilibrium.membrane.aspect = 1.0;
            self.guess_inflated(pole_stretch, state);
            result = self.settle(state, &closure);
            for k in 1..=steps {
                if result.is_err() {
                    break;
                }
                self.equilibrium.membrane.aspect = libm::pow(aspect, f64::from(k) / f64::from(steps));
                result = self.settle(state, &closure);
            }
            self.equilibrium.membrane.aspect = aspect;
            self.equilibrium.membrane.tension_field = field;
            result = result.and_then(|()| self.settle(state, &closure));
            if result.is_ok() {
                return Ok(());
            }
        }
        result
    }

    /// The rest state of a pressure, equator radius or height, all dimensionless.
    ///
    /// None of the three is one-to-one. The pole stretch is scanned upward from 1; of two states of one pressure the
    /// less stretched is taken (inflation reaches it first), of two states of one radius or height the more
    /// stretched (the other lies where the membrane still shrinks as it is inflated). Roots are found in the pole
    /// stretch, which stays well posed at a limit point.
    ///
    /// # Errors
    /// [`RestFailure`] with the reachable values if there is no such state.
    #[inline(never)] // its copies of a solution stay off the caller's stack
    pub fn rest_by(
        &mut self,
        quantity: RestQuantity,
        value: f64,
    ) -> Result<(Graded<S>, Branch), RestFailure> {
        let mut scan = Scan {
            quantity,
            value,
            before: [None, None],
            roots: [None, None],
        };
        let (mut least, mut greatest) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut step = FIRST_STEP;
        let mut pole_stretch = 1.0 + FIRST_STEP;
        while pole_stretch <= LARGEST_POLE_STRETCH && scan.roots[1].is_none() {
            let Ok(state) = self.rest_near(scan.before[1].as_ref(), pole_stretch) else {
                break;
            };
            scan.visit(self, state, &mut least, &mut greatest);
            pole_stretch += step;
            step *= STEP_GROWTH;
        }
        let stretch = |state: &Graded<S>| state.solution.parameters[POLE];
        match (scan.roots, quantity) {
            ([None, _], _) => Err(RestFailure::OutOfReach {
                quantity,
                least,
                greatest,
            }),
            ([Some(only), None], _) => Ok((only, Branch::Only)),
            ([Some(lower), Some(upper)], RestQuantity::Pressure) => {
                let other = stretch(&upper);
                Ok((lower, Branch::Lower { other }))
            }
            ([Some(lower), Some(upper)], _) => {
                let other = stretch(&lower);
                Ok((upper, Branch::Upper { other }))
            }
        }
    }

    /// The rest state of a pole stretch, from a neighbour if there is one.
    fn rest_near(&mut self, from: Option<&Graded<S>>, pole_stretch: f64) -> Result<Graded<S>, Unsolved> {
        let closure = Closure::Rest(RestControl::PoleStretch(pole_stretch));
        let mut state = Graded::BLANK;
        if let Some(from) = from {
            state.clone_from(from);
            if self.settle(&mut state, &closure).is_ok() {
                return Ok(state);
            }
        }
        self.rest_from_sphere(pole_stretch, &mut state).map(|()| state)
    }
}

/// A scan of the pole stretch for a value of a quantity.
struct Scan<const S: usize> {
    quantity: RestQuantity,
    value: f64,
    /// The last two states, newest last.
    before: [Option<Graded<S>>; 2],
    roots: [Option<Graded<S>>; 2],
}

impl<const S: usize> Scan<S> {
    /// The quantity of a state, less the value looked for.
    fn excess(&self, state: &Graded<S>) -> f64 {
        let solution = &state.solution;
        let found = match self.quantity {
            RestQuantity::PoleStretch => solution.parameters[POLE],
            RestQuantity::Pressure => solution.parameters[PRESSURE],
            RestQuantity::EquatorRadius => solution.nodes[solution.elements()][0],
            RestQuantity::Height => solution.height,
        };
        found - self.value
    }

    /// Takes the next state of the scan: looks for a crossing, or an extreme between samples that crosses.
    fn visit<L: Hyperelastic>(
        &mut self,
        solver: &mut Adaptive<L, S>,
        state: Graded<S>,
        least: &mut f64,
        greatest: &mut f64,
    ) {
        let excess = self.excess(&state);
        let mut note = |excess: f64, value: f64| {
            *least = least.min(excess + value);
            *greatest = greatest.max(excess + value);
        };
        note(excess, self.value);
        if let [Some(oldest), Some(middle)] = &self.before {
            let (first, second) = (self.excess(oldest), self.excess(middle));
            let same_side = first * second > 0.0 && second * excess > 0.0;
            let turns = (second - first) * (excess - second) < 0.0;
            if same_side && turns && (second - first) * second < 0.0 {
                // The extreme points towards the value: does it reach it?
                let (oldest, middle) = (oldest.clone(), middle.clone());
                if let Some(extreme) = self.extreme(solver, &oldest, &state) {
                    let reached = self.excess(&extreme);
                    note(reached, self.value);
                    if reached * second <= 0.0 {
                        self.root_between(solver, oldest, extreme.clone());
                        self.root_between(solver, extreme, state.clone());
                        self.before = [Some(middle), Some(state)];
                        return;
                    }
                }
            }
        }
        match &self.before[1] {
            Some(middle) if self.excess(middle) * excess <= 0.0 => {
                let middle = middle.clone();
                self.root_between(solver, middle, state.clone());
            }
            // Below the first stretch looked at, pressure falls to nothing.
            None if self.quantity == RestQuantity::Pressure && excess >= 0.0 => {
                let closure = Closure::Rest(RestControl::Pressure(self.value));
                let mut root = state.clone();
                if solver.settle(&mut root, &closure).is_ok() {
                    self.roots[0] = Some(root);
                }
            }
            _ => {}
        }
        self.before.swap(0, 1);
        self.before[1] = Some(state);
    }

    /// Extreme of the quantity between two states, by golden section in the pole stretch.
    fn extreme<L: Hyperelastic>(
        &self,
        solver: &mut Adaptive<L, S>,
        from: &Graded<S>,
        to: &Graded<S>,
    ) -> Option<Graded<S>> {
        let sign = self.excess(from).signum();
        let (mut left, mut right) = (from.solution.parameters[POLE], to.solution.parameters[POLE]);
        let mut best: Option<Graded<S>> = None;
        let mut take = |solver: &mut Adaptive<L, S>, stretch: f64| {
            let state = solver.rest_near(Some(from), stretch).ok()?;
            let depth = sign * self.excess(&state);
            if best.as_ref().is_none_or(|b| depth < sign * self.excess(b)) {
                best = Some(state);
            }
            Some(depth)
        };
        let (mut a, mut b) = (right - GOLDEN * (right - left), left + GOLDEN * (right - left));
        let (mut of_a, mut of_b) = (take(solver, a)?, take(solver, b)?);
        while right - left > EXTREME_TOLERANCE {
            if of_a < of_b {
                (right, b, of_b) = (b, a, of_a);
                a = right - GOLDEN * (right - left);
                of_a = take(solver, a)?;
            } else {
                (left, a, of_a) = (a, b, of_b);
                b = left + GOLDEN * (right - left);
                of_b = take(solver, b)?;
            }
        }
        best
    }

    /// Root between two states of opposite excess, by the Illinois method in the pole stretch.
    fn root_between<L: Hyperelastic>(
        &mut self,
        solver: &mut Adaptive<L, S>,
        mut low: Graded<S>,
        mut high: Graded<S>,
    ) {
        let stretch = |state: &Graded<S>| state.solution.parameters[POLE];
        let (mut of_low, mut of_high) = (self.excess(&low), self.excess(&high));
        for _ in 0..MAX_ROOT_STEPS {
            let (a, b) = (stretch(&low), stretch(&high));
            let next = (a * of_high - b * of_low) / (of_high - of_low);
            let Ok(state) = solver.rest_near(Some(&low), next) else {
                return;
            };
            let of_next = self.excess(&state);
            let arrived = of_next.abs() < 1e-15 * self.value.abs() || (b - a).abs() < 1e-14 * b;
            let moved = (next - a).abs().min((next - b).abs());
            if of_next * of_high <= 0.0 {
                (low, of_low) = (core::mem::replace(&mut high, state), of_high);
            } else {
                of_low *= 0.5;
                high = state;
            }
            of_high = of_next;
            if arrived || moved < ROOT_TOLERANCE * b {
                break;
            }
        }
        let slot = usize::from(self.roots[0].is_some());
        self.roots[slot] = Some(high);
    }
}
