//! The latest states of a press, and the prediction of the next one from them.

use crate::membrane::adapt::Graded;
use crate::membrane::equations::{CONTACT_PARAMETER, CONTACT_RADIUS, POLE, PRESSURE};
use crate::membrane::solution::{Pole, Solution};
use crate::solver::collocation::{Gauss, STATES};
use core::f64::consts::FRAC_PI_2;

/// States that take part in a prediction: extrapolation of fourth order.
const DEPTH: usize = 5;
const SLOTS: usize = DEPTH + 1;
/// Largest sum of the weights of an extrapolation.
const LARGEST_WEIGHT: f64 = 40.0;

/// The latest states, and one being worked on.
#[derive(Clone, Debug)]
pub struct Predictor<const S: usize> {
    slots: [Graded<S>; SLOTS],
    /// Logarithm of the indentation of each.
    places: [f64; SLOTS],
    newest: usize,
    count: usize,
}

impl<const S: usize> Default for Predictor<S> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const S: usize> Predictor<S> {
    /// No states yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            slots: [const { Graded::BLANK }; SLOTS],
            places: [0.0; SLOTS],
            newest: 0,
            count: 0,
        }
    }

    /// Forgets all states.
    pub fn clear(&mut self) {
        self.newest = 0;
        self.count = 0;
    }

    fn slot(&self, age: usize) -> usize {
        (self.newest + SLOTS - age) % SLOTS
    }

    fn working_slot(&self) -> usize {
        (self.newest + 1) % SLOTS
    }

    /// The newest state.
    pub fn latest(&self) -> Option<&Graded<S>> {
        (self.count > 0).then(|| &self.slots[self.newest])
    }

    /// The state being worked on.
    pub fn working(&mut self) -> &mut Graded<S> {
        &mut self.slots[self.working_slot()]
    }

    /// Makes the state being worked on the newest, at an indentation. Older states are put on its mesh, so that they
    /// go on telling what comes next.
    #[inline(never)] // its copies of a solution stay off the caller's stack
    pub fn accept(&mut self, indentation: f64, gauss: &Gauss<S>) {
        self.newest = self.working_slot();
        self.places[self.newest] = libm::log(indentation);
        self.count = (self.count + 1).min(DEPTH);
        for age in 1..self.count {
            let (slot, newest) = (self.slot(age), self.newest);
            let (older, latest) = (&self.slots[slot].solution, &self.slots[newest].solution);
            if older.pole != latest.pole {
                self.count = age;
                return;
            }
            if !older.has_nearly_the_mesh_of(latest) {
                let mut moved = latest.clone();
                moved.parameters = older.parameters;
                moved.height = older.height;
                moved.volume = older.volume;
                older.resample(gauss, &mut moved);
                self.slots[slot].solution = moved;
            }
        }
    }

    /// Works on a copy of the newest state.
    pub fn repeat(&mut self) {
        let work = self.working_slot();
        self.slots[work] = self.slots[self.newest].clone();
    }

    /// Works on the extrapolation of the latest states in the logarithm of the indentation.
    pub fn predict(&mut self, indentation: f64) {
        let target = libm::log(indentation);
        let mut count = 1;
        while count < self.count
            && (0..count)
                .all(|age| (self.places[self.slot(age)] - self.places[self.slot(count)]).abs() > 1e-9)
        {
            count += 1;
        }
        let weights = loop {
            let weights = self.weights(target, count);
            // Far from states that lie close together, fewer of them say more.
            if count == 1 || weights.iter().map(|w| w.abs()).sum::<f64>() < LARGEST_WEIGHT {
                break weights;
            }
            count -= 1;
        };
        let sources: [usize; DEPTH] = core::array::from_fn(|age| self.slot(age));
        let work = self.working_slot();
        let (latest, newest) = (self.newest, &self.slots[self.newest]);
        let parameters = self.blend_parameters(&sources[..count], &weights);
        let sane = parameters[CONTACT_PARAMETER] < FRAC_PI_2
            && parameters[POLE] > 0.0
            && (newest.solution.pole == Pole::Taut || parameters[POLE] < parameters[CONTACT_PARAMETER]);
        if !sane || count == 1 {
            self.repeat();
            return;
        }
        let (depth, breaks, outcome) = (newest.depth, newest.breaks, newest.outcome);
        let elements = newest.solution.elements();
        self.slots[work].depth = depth;
        self.slots[work].breaks = breaks;
        self.slots[work].outcome = outcome;
        let (contact_elements, free_elements, pole) = {
            let s = &self.slots[latest].solution;
            (s.contact_elements, s.free_elements, s.pole)
        };
        let (before, rest) = self.slots.split_at_mut(work);
        let Some((target, after)) = rest.split_first_mut() else {
            return;
        };
        let source = |slot: usize| -> &Solution<S> {
            if slot < work {
                &before[slot].solution
            } else {
                &after[slot - work - 1].solution
            }
        };
        let guess = &mut target.solution;
        guess.pole = pole;
        guess.contact_elements = contact_elements;
        guess.free_elements = free_elements;
        guess.parameters = parameters;
        guess.stretches[..elements].copy_from_slice(&source(latest).stretches[..elements]);
        for x in &mut guess.fractions[..elements + 2] {
            *x = 0.0;
        }
        for e in 0..=elements {
            guess.nodes[e] = [0.0; STATES];
            if e < elements {
                guess.stages[e] = [[0.0; STATES]; S];
            }
        }
        for (&slot, &weight) in sources[..count].iter().zip(&weights) {
            let from = source(slot);
            for (x, y) in guess.fractions[..elements + 2].iter_mut().zip(&from.fractions) {
                *x += weight * y;
            }
            for (x, y) in guess.nodes[..=elements].iter_mut().zip(&from.nodes) {
                x[0] += weight * y[0];
                x[1] += weight * y[1];
            }
            for (x, y) in guess.stages[..elements].iter_mut().zip(&from.stages) {
                for (x, y) in x.iter_mut().zip(y) {
                    x[0] += weight * y[0];
                    x[1] += weight * y[1];
                }
            }
        }
        // Zones end where they end, whatever rounding says.
        guess.fractions[0] = 0.0;
        guess.fractions[contact_elements] = 1.0;
        guess.fractions[contact_elements + 1] = 0.0;
        guess.fractions[elements + 1] = 1.0;
    }

    fn weights(&self, target: f64, count: usize) -> [f64; DEPTH] {
        let mut weights = [0.0; DEPTH];
        for i in 0..count {
            let place = self.places[self.slot(i)];
            weights[i] = (0..count)
                .filter(|&j| j != i)
                .map(|j| (target - self.places[self.slot(j)]) / (place - self.places[self.slot(j)]))
                .product();
        }
        weights
    }

    /// Pole and pressure as they are, contact radius and parameter by their logarithms.
    fn blend_parameters(&self, sources: &[usize], weights: &[f64; DEPTH]) -> [f64; 4] {
        let mut parameters = [0.0; 4];
        for (&slot, weight) in sources.iter().zip(weights) {
            let of = &self.slots[slot].solution.parameters;
            for p in [POLE, PRESSURE] {
                parameters[p] += weight * of[p];
            }
            for p in [CONTACT_RADIUS, CONTACT_PARAMETER] {
                parameters[p] += weight * libm::log(of[p]);
            }
        }
        for p in [CONTACT_RADIUS, CONTACT_PARAMETER] {
            parameters[p] = libm::exp(parameters[p]);
        }
        parameters
    }
}
