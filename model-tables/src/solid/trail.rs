//! The states of a press found so far, and what they foretell.

use super::equilibrium::{Balance, State};

/// States kept at most.
const MOST: usize = 160;
/// States that take part in a prediction.
const DEPTH: usize = 3;
/// Largest weight of one of them.
const LARGEST_WEIGHT: f64 = 6.0;

/// A state of the press.
#[derive(Clone, Debug)]
pub struct Kept {
    /// Its indentation.
    pub indentation: f64,
    /// Its unknowns.
    pub state: State,
    /// What it came with.
    pub balance: Balance,
}

/// States in order of their indentation, the rest state first.
#[derive(Clone, Debug)]
pub struct Trail {
    kept: Vec<Kept>,
}

impl Trail {
    /// The rest state alone.
    pub fn new(rest: State, volume: f64) -> Self {
        let balance = Balance {
            volume,
            ..Balance::default()
        };
        Self {
            kept: vec![Kept {
                indentation: 0.0,
                state: rest,
                balance,
            }],
        }
    }

    /// The deepest indentation.
    pub fn deepest(&self) -> f64 {
        self.kept.last().map_or(0.0, |kept| kept.indentation)
    }

    fn nearest_index(&self, indentation: f64) -> usize {
        let after = self.kept.partition_point(|kept| kept.indentation < indentation);
        let distance = |i: usize| (self.kept[i].indentation - indentation).abs();
        if after == self.kept.len() || (after > 0 && distance(after - 1) < distance(after)) {
            after - 1
        } else {
            after
        }
    }

    /// The state nearest to an indentation.
    pub fn nearest(&self, indentation: f64) -> &Kept {
        &self.kept[self.nearest_index(indentation)]
    }

    /// A guess for the state at an indentation: the polynomial through the nearest states, of as high a degree as is
    /// trustworthy.
    pub fn predict(&self, indentation: f64, guess: &mut State) {
        let nearest = self.nearest_index(indentation);
        let (mut first, mut last) = (nearest, nearest + 1);
        while last - first < DEPTH && last - first < self.kept.len() {
            let below = first
                .checked_sub(1)
                .map(|i| (self.kept[i].indentation - indentation).abs());
            let above = self
                .kept
                .get(last)
                .map(|kept| (kept.indentation - indentation).abs());
            match (below, above) {
                (Some(below), Some(above)) if below > above => last += 1,
                (Some(_), _) => first -= 1,
                (None, _) => last += 1,
            }
        }
        let places: Vec<f64> = self.kept[first..last]
            .iter()
            .map(|kept| kept.indentation)
            .collect();
        let mut order: Vec<usize> = (first..last).collect();
        order.sort_by(|&a, &b| {
            let distance = |i: usize| (places[i - first] - indentation).abs();
            distance(a).total_cmp(&distance(b))
        });
        loop {
            let weights: Vec<f64> = order
                .iter()
                .map(|&i| {
                    order
                        .iter()
                        .filter(|&&j| j != i)
                        .map(|&j| (indentation - places[j - first]) / (places[i - first] - places[j - first]))
                        .product()
                })
                .collect();
            if weights.iter().all(|weight| weight.abs() < LARGEST_WEIGHT) {
                guess.clear();
                for (&i, weight) in order.iter().zip(weights) {
                    guess.add(weight, &self.kept[i].state);
                }
                return;
            }
            order.pop();
        }
    }

    /// Keeps a state; of too many, every other one goes.
    pub fn keep(&mut self, indentation: f64, state: &State, balance: Balance) {
        if self.kept.len() >= MOST {
            let mut index = 0;
            self.kept.retain(|_| {
                index += 1;
                index % 2 == 1
            });
        }
        let at = self.kept.partition_point(|kept| kept.indentation < indentation);
        self.kept.insert(
            at,
            Kept {
                indentation,
                state: state.clone(),
                balance,
            },
        );
    }
}
