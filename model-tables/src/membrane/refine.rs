//! Estimates how well a mesh resolves the solution, and makes a finer mesh where it does not.
//!
//! The graded mesh knows the pole and the contact edge. It does not know two other cases: a law close to losing its stability, with
//! stretches that change within a few hundredths of the meridian, and the layer in which a plain membrane changes to compression.
//! There the last term of the collocation polynomial of an element is not small. It determines how many elements are needed,
//! because it falls with the power `S` of their length. Gauss collocation is superconvergent, so that a last term of `e` leaves an
//! error of the order of `e^2` at the nodes and in the integrals.

use crate::material::Hyperelastic;
use crate::membrane::adapt::Adaptive;
use crate::membrane::solution::{MAX_ELEMENTS, Solution};

/// Last term that is aimed at in a state of rest, over that of a pressed state: the first indentations are small
/// differences against it.
const REST_SHARE: f64 = 0.1;
/// Last term over the one aimed at from which a solved state is solved again on a finer mesh.
const COARSE: f64 = 3.0;
/// Most pieces an element is cut into at once.
const MAX_PIECES: f64 = 4.0;

impl<L: Hyperelastic, const S: usize> Adaptive<L, S> {
    /// The last term of the collocation polynomial of element `e`, relative to the solution.
    fn last_term(&self, solution: &Solution<S>, e: usize, largest_tension: f64) -> f64 {
        let [u, w] = self
            .equilibrium
            .gauss
            .last_term(solution.nodes[e], &solution.stages[e]);
        (u / solution.nodes[e][0]).abs().max(w.abs() / largest_tension)
    }

    fn largest_tension(solution: &Solution<S>) -> f64 {
        solution.nodes[..=solution.elements()]
            .iter()
            .fold(f64::MIN_POSITIVE, |largest, node| largest.max(node[1].abs()))
    }

    fn aimed_at(&self, solution: &Solution<S>) -> f64 {
        let share = if solution.contact_elements > 0 {
            1.0
        } else {
            REST_SHARE
        };
        share * self.resolution.last_term
    }

    /// Whether some element is too long for what the solution does on it.
    pub(crate) fn is_coarse(&self, solution: &Solution<S>) -> bool {
        let (largest, bound) = (Self::largest_tension(solution), COARSE * self.aimed_at(solution));
        solution.elements() < MAX_ELEMENTS
            && (0..solution.elements()).any(|e| self.last_term(solution, e, largest) > bound)
    }

    /// Cuts the elements of a mesh that are too long for `values` (a solution on any mesh of the same meridian, already
    /// sampled on this one), until they are short enough.
    pub(crate) fn cut(&self, values: &Solution<S>, mesh: &mut Solution<S>) {
        // Next to a singularity just off the meridian pieces are again too long.
        while self.cut_once(mesh) {
            values.resample(&self.equilibrium.gauss, mesh);
        }
    }

    /// Whether anything was cut.
    fn cut_once(&self, mesh: &mut Solution<S>) -> bool {
        let elements = mesh.elements();
        let largest = Self::largest_tension(mesh);
        let mut pieces = [1; MAX_ELEMENTS];
        let mut aim = self.aimed_at(mesh);
        let total = loop {
            for (e, count) in pieces[..elements].iter_mut().enumerate() {
                let over = self.last_term(mesh, e, largest) / aim;
                *count = if over > 1.0 {
                    libm::ceil(libm::pow(over, 1.0 / S as f64)).min(MAX_PIECES) as usize
                } else {
                    1
                };
            }
            let total: usize = pieces[..elements].iter().sum();
            if total <= MAX_ELEMENTS {
                break total;
            }
            aim *= 2.0;
        };
        if total == elements {
            return false;
        }
        let old = mesh.fractions;
        let contact_elements = mesh.contact_elements;
        // Next place in the list of fractions, which has one more than elements for each of the two zones.
        let mut next = usize::from(contact_elements == 0);
        for (e, &count) in pieces[..elements].iter().enumerate() {
            let at = if e < contact_elements { e } else { e + 1 };
            let (left, right) = (old[at], old[at + 1]);
            if e == 0 || e == contact_elements {
                mesh.fractions[next] = left;
                next += 1;
            }
            for k in 1..count {
                mesh.fractions[next] = left + (right - left) * k as f64 / count as f64;
                next += 1;
            }
            mesh.fractions[next] = right;
            next += 1;
        }
        mesh.contact_elements = pieces[..contact_elements].iter().sum();
        mesh.free_elements = total - mesh.contact_elements;
        true
    }
}
