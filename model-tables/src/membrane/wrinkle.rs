//! Where hoop wrinkles begin and end: the kinks of a relaxed membrane, at which the mesh needs a node.
//!
//! The margin `u^2 l1 - 1`, with `l1` the stretch of uniaxial tension, is positive where the membrane is taut both ways and
//! negative where hoop wrinkles stand. It is sampled at nodes and Gauss points, and more densely where its curve turns close to
//! zero. Otherwise a zone that begins between two samples would be missed, and with it about 1e-6 of the force.

use crate::material::Hyperelastic;
use crate::membrane::adapt::Adaptive;
use crate::membrane::mesh::Breaks;
use crate::membrane::solution::Solution;
use crate::membrane::{TensionField, Zone};
use core::f64::consts::FRAC_PI_2;

/// A kink this close to a node is on it: misplaced by `d`, it costs `d^2`.
const KINK_TOLERANCE: f64 = 1e-8;
/// The golden section.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

impl<L: Hyperelastic, const S: usize> Adaptive<L, S> {
    /// Where hoop wrinkles begin or end.
    pub(crate) fn kinks(&self, solution: &Solution<S>) -> Breaks {
        let mut kinks = Breaks::default();
        if self.equilibrium.membrane.tension_field == TensionField::Plain {
            return kinks;
        }
        // The last two samples: place and margin.
        let mut before: [Option<(f64, f64)>; 2] = [None, None];
        let mut take = |t: f64, margin: f64| {
            if let [Some(oldest), Some(middle)] = before
                && let Some(turn) = self.thin_zone(solution, oldest, middle, (t, margin))
            {
                kinks.push(self.kink_between(solution, oldest.0, turn, middle.1 < 0.0));
                kinks.push(self.kink_between(solution, turn, t, middle.1 >= 0.0));
            }
            if let Some((left, was)) = before[1]
                && (was < 0.0) != (margin < 0.0)
            {
                kinks.push(self.kink_between(solution, left, t, was < 0.0));
            }
            before = [before[1], Some((t, margin))];
        };
        for e in 0..solution.elements() {
            let span = solution.span(e);
            // From the polynomial of this element: on the node itself the stretch of a stage would be a poor guess.
            take(
                span.start,
                self.margin_of(
                    solution,
                    e,
                    span.start,
                    solution.nodes[e],
                    solution.stretches[e][0],
                ),
            );
            for j in 0..S {
                let t = span.start + self.equilibrium.gauss.nodes[j] * span.length;
                take(
                    t,
                    self.margin_of(solution, e, t, solution.stages[e][j], solution.stretches[e][j]),
                );
            }
        }
        let last = solution.elements() - 1;
        let guess = solution.stretches[last][S - 1];
        take(
            FRAC_PI_2,
            self.margin_of(solution, last, FRAC_PI_2, solution.nodes[last + 1], guess),
        );
        kinks
    }

    /// The place between three samples of one kind where the membrane is of the other kind, if their curve turns there.
    fn thin_zone(
        &self,
        solution: &Solution<S>,
        (left, of_left): (f64, f64),
        (_, of_middle): (f64, f64),
        (right, of_right): (f64, f64),
    ) -> Option<f64> {
        let sign = if of_middle < 0.0 { -1.0 } else { 1.0 };
        let [a, m, b] = [of_left, of_middle, of_right].map(|margin| sign * margin);
        // A parabola through the three goes below the middle one by at most an eighth of their second difference.
        if a <= m || b < m || m >= a + b - 2.0 * m {
            return None;
        }
        let of = |t: f64| sign * self.margin_at(solution, t);
        let (mut left, mut right) = (left, right);
        let (mut low, mut high) = (right - GOLDEN * (right - left), left + GOLDEN * (right - left));
        let (mut of_low, mut of_high) = (of(low), of(high));
        while right - left > KINK_TOLERANCE {
            if of_low < 0.0 {
                return Some(low);
            }
            if of_high < 0.0 {
                return Some(high);
            }
            if of_low < of_high {
                (right, high, of_high) = (high, low, of_low);
                low = right - GOLDEN * (right - left);
                of_low = of(low);
            } else {
                (left, low, of_low) = (low, high, of_high);
                high = left + GOLDEN * (right - left);
                of_high = of(high);
            }
        }
        None
    }

    /// [`Self::wrinkle_margin`] of a state in element `e`; 1 where the membrane is not narrower than undeformed.
    fn margin_of(&self, solution: &Solution<S>, e: usize, t: f64, state: [f64; 2], stretch: f64) -> f64 {
        let [_, pressure, contact_radius, _] = solution.parameters;
        if state[0] < 1.0 {
            self.wrinkle_margin(solution.zone(e), t, state, pressure, contact_radius, stretch)
        } else {
            1.0
        }
    }

    /// The same at `t`.
    fn margin_at(&self, solution: &Solution<S>, t: f64) -> f64 {
        let [_, pressure, contact_radius, contact_parameter] = solution.parameters;
        let (state, stretch) = solution.at(&self.equilibrium.gauss, t);
        let zone = if t < contact_parameter {
            Zone::Contact
        } else {
            Zone::Free
        };
        if state[0] < 1.0 {
            self.wrinkle_margin(zone, t, state, pressure, contact_radius, stretch)
        } else {
            1.0
        }
    }

    /// Positive where the membrane is taut both ways, negative where hoop wrinkles stand.
    fn wrinkle_margin(
        &self,
        zone: Zone,
        t: f64,
        state: [f64; 2],
        pressure: f64,
        contact_radius: f64,
        stretch: f64,
    ) -> f64 {
        let [u, _] = state;
        let tension = self
            .equilibrium
            .membrane
            .tension_measure(zone, t, state, pressure, contact_radius);
        match self.equilibrium.membrane.uniaxial(tension.max(0.0), stretch) {
            Some((l1, _)) => u * u * l1 - 1.0,
            None => 1.0,
        }
    }

    /// The kink between two points of different kind, the left one wrinkled or not, by bisection.
    fn kink_between(
        &self,
        solution: &Solution<S>,
        mut left: f64,
        mut right: f64,
        left_wrinkled: bool,
    ) -> f64 {
        while right - left > 1e-3 * KINK_TOLERANCE {
            let middle = 0.5 * (left + right);
            if (self.margin_at(solution, middle) < 0.0) == left_wrinkled {
                left = middle;
            } else {
                right = middle;
            }
        }
        0.5 * (left + right)
    }

    /// Whether every kink has its node.
    pub(crate) fn kinks_are_nodes(solution: &Solution<S>, kinks: &Breaks) -> bool {
        kinks.positions().iter().all(|&kink| {
            (0..solution.elements()).any(|e| (solution.span(e).start - kink).abs() < KINK_TOLERANCE)
        })
    }
}
