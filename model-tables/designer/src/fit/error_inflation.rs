//! By how much estimates scatter more than the formula of least squares says.
//!
//! The formula takes the weights as given. They are found in the same data: readings that happen to lie near the fit come
//! to count for more, and the formula then promises too much, the more the fewer data there are. How much is simulated (a
//! parametric bootstrap): noise as it was found, the linearised fit with its weights found anew each time, and the
//! scatter of the estimates over the standard errors that the formula gave them.

use super::noise::{NoiseModel, ROUNDING};
use model_tables::random::Random;
use nalgebra::{DMatrix, DVector};

/// Simulated benches: the scatter is known to 5 %.
const REPEATS: usize = 200;
/// Rounds of weights; more change nothing.
const ROUNDS: usize = 3;
/// Readings from which on the weights are as good as known.
const MANY: usize = 400;
/// Of the simulated noise; any will do.
const SEED: u64 = 20_260;

/// The readings of one quantity.
pub(super) struct Group {
    /// Their rows in the Jacobian; outliers are left out.
    pub(super) members: Vec<usize>,
    /// The largest of them.
    pub(super) largest: f64,
}

/// A factor for each standard error, >= 1; of a Jacobian in standard deviations `sigma`.
pub(super) fn factors(
    jacobian: &DMatrix<f64>,
    sigma: &[f64],
    predicted: &[f64],
    groups: &[Group; 2],
) -> Vec<f64> {
    let parameters = jacobian.ncols();
    let count: usize = groups.iter().map(|group| group.members.len()).sum();
    if count > MANY || count < parameters + 2 {
        return vec![1.0; parameters];
    }
    let bench = Bench {
        slopes: DMatrix::from_fn(jacobian.nrows(), parameters, |i, j| jacobian[(i, j)] * sigma[i]),
        predicted,
        groups,
        count: count as f64,
    };
    let mut random = Random(SEED);
    let (mut scatter, mut stated) = (vec![0.0; parameters], vec![0.0; parameters]);
    for _ in 0..REPEATS {
        let noise: Vec<f64> = sigma.iter().map(|sigma| sigma * random.normal()).collect();
        let Some(found) = bench.weights(&noise).and_then(|sigma| bench.fit(&noise, &sigma)) else {
            continue;
        };
        for j in 0..parameters {
            scatter[j] += found.estimates[j] * found.estimates[j];
            stated[j] += found.variances[j];
        }
    }
    let ratio = |(scatter, stated): (&f64, &f64)| libm::sqrt(scatter / stated);
    scatter
        .iter()
        .zip(&stated)
        .map(ratio)
        .map(|ratio| if ratio.is_finite() { ratio.max(1.0) } else { 1.0 })
        .collect()
}

/// The linearised fit.
struct Bench<'a> {
    slopes: DMatrix<f64>,
    predicted: &'a [f64],
    groups: &'a [Group; 2],
    count: f64,
}

/// A linearised fit to noise alone: estimates that should be zero.
struct Linear {
    estimates: DVector<f64>,
    /// What the formula of least squares gives them.
    variances: Vec<f64>,
    /// What the fit makes of each reading.
    fitted: DVector<f64>,
}

impl Bench<'_> {
    /// Least squares with given standard deviations; a row of an infinite one does not count.
    fn fit(&self, noise: &[f64], sigma: &[f64]) -> Option<Linear> {
        let (rows, parameters) = self.slopes.shape();
        let weighted = DMatrix::from_fn(rows, parameters, |i, j| self.slopes[(i, j)] / sigma[i]);
        let values = DVector::from_fn(rows, |i, _| noise[i] / sigma[i]);
        let inverse = (weighted.transpose() * &weighted).try_inverse()?;
        let estimates = &inverse * (weighted.transpose() * &values);
        let left = values - weighted * &estimates;
        let square = left.norm_squared() / (self.count - parameters as f64);
        Some(Linear {
            variances: (0..parameters).map(|j| inverse[(j, j)] * square).collect(),
            fitted: &self.slopes * &estimates,
            estimates,
        })
    }

    /// Standard deviations as a fit finds them in its data.
    fn weights(&self, noise: &[f64]) -> Option<Vec<f64>> {
        let mut sigma = vec![f64::INFINITY; noise.len()];
        for Group { members, largest } in self.groups {
            for &i in members {
                sigma[i] = NoiseModel::unknown(*largest).at(self.predicted[i]);
            }
        }
        for _ in 0..ROUNDS {
            let fitted = self.fit(noise, &sigma)?.fitted;
            for Group { members, largest } in self.groups {
                if members.is_empty() {
                    continue;
                }
                let residuals: Vec<f64> = members.iter().map(|&i| noise[i] - fitted[i]).collect();
                let readings: Vec<f64> = members.iter().map(|&i| self.predicted[i] + fitted[i]).collect();
                let spent = self.slopes.ncols() as f64 * members.len() as f64 / self.count;
                let noise = NoiseModel::estimate(&residuals, &readings, *largest, spent, ROUNDING * largest);
                for (&i, reading) in members.iter().zip(readings) {
                    sigma[i] = noise.at(reading);
                }
            }
        }
        Some(sigma)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A straight line through readings of both quantities, each over a range of 50.
    struct Line {
        predicted: Vec<f64>,
        groups: [Group; 2],
    }

    impl Line {
        fn new(count: usize) -> Self {
            let group = |from: usize| Group {
                members: (from..from + count).collect(),
                largest: 1.02,
            };
            Self {
                predicted: (0..2 * count)
                    .map(|i| 0.02 + (i % count) as f64 / count as f64)
                    .collect(),
                groups: [group(0), group(count)],
            }
        }

        /// Noise of reading, 1 %.
        fn sigma(&self) -> Vec<f64> {
            self.predicted.iter().map(|reading| 0.01 * reading).collect()
        }

        fn slopes(&self) -> DMatrix<f64> {
            DMatrix::from_fn(self.predicted.len(), 2, |i, j| [1.0, self.predicted[i]][j])
        }

        fn factors(&self, sigma: &[f64]) -> Vec<f64> {
            let slopes = self.slopes();
            let jacobian = DMatrix::from_fn(slopes.nrows(), 2, |i, j| slopes[(i, j)] / sigma[i]);
            factors(&jacobian, sigma, &self.predicted, &self.groups)
        }
    }

    #[test]
    fn few_readings_widen_more_than_many_and_very_many_not_at_all() {
        let widened = |count: usize| {
            let line = Line::new(count);
            line.factors(&line.sigma())
        };
        let (few, many) = (widened(12), widened(150));
        for j in 0..2 {
            assert!(few[j] > 1.05 && few[j] < 2.0, "{few:?}");
            assert!(many[j] < few[j] && many[j] < 1.12, "{many:?} {few:?}");
        }
        assert!(
            widened(201)
                .iter()
                .all(|factor| factor.to_bits() == 1.0_f64.to_bits())
        );
    }

    /// Benches whose truth is known, each widened by what was found in it alone.
    #[test]
    fn widened_errors_cover_the_truth_as_often_as_they_should() {
        const BENCHES: usize = 300;
        /// The inflation takes long: every so many-th.
        const EVERY: usize = 5;
        let line = Line::new(15);
        let bench = Bench {
            slopes: line.slopes(),
            predicted: &line.predicted,
            groups: &line.groups,
            count: line.predicted.len() as f64,
        };
        let truth = line.sigma();
        let mut random = Random(7);
        let (mut plain, mut widened) = ([0.0; 2], [[0.0; 2]; 2]);
        for repeat in 0..BENCHES {
            let noise: Vec<f64> = truth.iter().map(|sigma| sigma * random.normal()).collect();
            let sigma = bench.weights(&noise).expect("a line");
            let found = bench.fit(&noise, &sigma).expect("a line");
            let off = |j: usize| found.estimates[j].abs() / libm::sqrt(found.variances[j]);
            let share = |within: bool| f64::from(u8::from(within)) / BENCHES as f64;
            for (j, plain) in plain.iter_mut().enumerate() {
                *plain += share(off(j) < 1.0);
            }
            if repeat % EVERY == 0 {
                for (j, factor) in line.factors(&sigma).into_iter().enumerate() {
                    for (k, widened) in widened[j].iter_mut().enumerate() {
                        *widened += EVERY as f64 * share(off(j) < factor * (k + 1) as f64);
                    }
                }
            }
        }
        println!(
            "within one error as least squares has it {plain:.3?}, within one and two widened {widened:.3?}"
        );
        // Three standard deviations of a binomial share.
        let chance = |share: f64| 3.0 * libm::sqrt(share * (1.0 - share) * EVERY as f64 / BENCHES as f64);
        assert!(plain.iter().sum::<f64>() < 2.0 * 0.65, "{plain:?}");
        for [one, two] in widened {
            assert!((one - 0.683).abs() < chance(0.683), "{widened:?}");
            assert!((two - 0.954).abs() < chance(0.954), "{widened:?}");
        }
    }
}
