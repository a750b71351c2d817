//! How noisy a measurement is: one part that grows with the reading, one that does not.
//!
//! `sigma^2 = s^2 (1 + (r y / y_max)^2)`: the ratio `r` is chosen for the largest likelihood of the residuals under
//! Student's distribution, in whose tails single outliers do not decide.

use super::robust::deviation;

/// Ratios of the growing part to the constant one at the largest reading.
const RATIOS: [f64; 10] = [0.0, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 100.0, 300.0];
/// Degrees of freedom of Student's distribution.
const STUDENT: f64 = 4.0;
/// Steps to its scale.
const STEPS: usize = 30;
/// What is taken before anything is known: a hundredth of full scale and as much of reading at full scale.
const FIRST_RATIO: f64 = 10.0;
/// Standard deviations, roughly known, beyond which a value does not count.
const OUTLYING: f64 = 4.5;
/// Size of rounding, over the largest reading.
pub(super) const ROUNDING: f64 = 1e-9;
/// Residuals under which a ratio is not worth estimating.
const MIN_RESIDUALS: usize = 12;

/// Noise of one quantity, in its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseModel {
    /// Standard deviation of a reading of zero.
    pub floor: f64,
    /// Largest reading of the data, by magnitude, newtons or pascals.
    pub largest: f64,
    ratio: f64,
}

impl NoiseModel {
    /// Before anything is known; the scale does not matter yet.
    pub(super) fn unknown(largest: f64) -> Self {
        Self {
            floor: 1e-3 * largest,
            largest,
            ratio: FIRST_RATIO,
        }
    }

    /// From residuals and the readings they belong to, `spent` parameters having been fitted to them. Never under
    /// `least`, the size of rounding.
    pub(super) fn estimate(
        residuals: &[f64],
        readings: &[f64],
        largest: f64,
        spent: f64,
        least: f64,
    ) -> Self {
        let count = residuals.len() as f64;
        let lost = libm::sqrt(count / (count - spent).max(1.0));
        let with = |ratio: f64| {
            let shape = |reading: f64| shape(ratio, reading / largest);
            let scaled: Vec<f64> = residuals
                .iter()
                .zip(readings)
                .map(|(residual, &reading)| residual / shape(reading))
                .collect();
            let floor = (lost * spread(&scaled)).max(least);
            let logarithms: f64 = readings.iter().map(|&reading| libm::log(shape(reading))).sum();
            (student(&scaled, least) + logarithms, floor)
        };
        let ratio = if residuals.len() < MIN_RESIDUALS {
            FIRST_RATIO
        } else {
            let cost = |ratio: &f64| with(*ratio).0;
            RATIOS
                .into_iter()
                .min_by(|a, b| cost(a).total_cmp(&cost(b)))
                .unwrap_or(FIRST_RATIO)
        };
        Self {
            floor: with(ratio).1,
            largest,
            ratio,
        }
    }

    /// Standard deviation at a reading.
    pub fn at(&self, reading: f64) -> f64 {
        self.floor * shape(self.ratio, reading / self.largest)
    }

    /// The part that grows with the reading, as a fraction of it.
    pub fn of_reading(&self) -> f64 {
        self.floor * self.ratio / self.largest
    }
}

/// Root mean square of all but the outliers: of normal values as sure as can be, which what weighs force against pressure
/// has to be.
fn spread(values: &[f64]) -> f64 {
    let limit = OUTLYING * deviation(values);
    let kept = values.iter().filter(|value| value.abs() <= limit);
    let (count, squares) = kept.fold((0.0, 0.0), |(count, squares), value| {
        (count + 1.0, squares + value * value)
    });
    if count > 0.0 {
        libm::sqrt(squares / count)
    } else {
        0.0
    }
}

/// Negative logarithm of the likelihood of values under Student's distribution, at its best scale.
fn student(values: &[f64], least: f64) -> f64 {
    let count = values.len() as f64;
    let mut square = deviation(values).max(least).max(f64::MIN_POSITIVE);
    square *= square;
    for _ in 0..STEPS {
        let weighted = values
            .iter()
            .map(|value| value * value * (STUDENT + 1.0) / (STUDENT + value * value / square));
        square = (weighted.sum::<f64>() / count)
            .max(least * least)
            .max(f64::MIN_POSITIVE);
    }
    let tails = values
        .iter()
        .map(|value| libm::log(1.0 + value * value / (STUDENT * square)));
    0.5 * count * libm::log(square) + 0.5 * (STUDENT + 1.0) * tails.sum::<f64>()
}

fn shape(ratio: f64, part: f64) -> f64 {
    libm::sqrt(1.0 + ratio * ratio * part * part)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quantiles of the normal distribution by a sum of twelve uniform places: what matters is their spread.
    fn normal(i: usize) -> f64 {
        (0..12)
            .map(|k| libm::modf(0.618_033_988_749_895 * (i * 12 + k) as f64 + 0.37 * k as f64 * i as f64).0)
            .sum::<f64>()
            - 6.0
    }

    #[test]
    fn tells_noise_of_reading_from_noise_of_full_scale() {
        let readings: Vec<f64> = (1..=200).map(|i| 0.05 * f64::from(i)).collect();
        let constant: Vec<f64> = (0..200).map(|i| 0.1 * normal(i)).collect();
        let growing: Vec<f64> = (0..200).map(|i| 0.01 * readings[i] * normal(i)).collect();
        let flat = NoiseModel::estimate(&constant, &readings, 10.0, 0.0, 0.0);
        assert!(flat.at(10.0) < 1.3 * flat.at(0.1), "{flat:?}");
        let steep = NoiseModel::estimate(&growing, &readings, 10.0, 0.0, 0.0);
        assert!(steep.at(10.0) > 8.0 * steep.at(0.1), "{steep:?}");
        assert!((steep.at(10.0) / 0.1 - 1.0).abs() < 0.3, "{}", steep.at(10.0));
    }
}
