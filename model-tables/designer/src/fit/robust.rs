//! Statistics that single outliers do not move.

/// Residuals from which on outliers can be told from noise; under that all count alike.
pub(super) const MIN_RESIDUALS: usize = 10;
/// Median absolute deviation -> standard deviation of a normal distribution.
const TO_DEVIATION: f64 = 1.482_602_218_505_602;
/// An outlier is so many standard deviations from its neighbours, and as many of the whole from the fit.
const OUTLYING: f64 = 4.0;
/// Neighbours on each side at most.
const NEIGHBOURS: usize = 3;
/// Standard deviation of a value less the median of so many independent neighbours on each side (none: less the line
/// through the next two).
const OF_DIFFERENCE: [f64; NEIGHBOURS + 1] = [2.45, 1.22, 1.13, 1.09];

/// Middle of the values; 0 of none.
pub(super) fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len();
    match n {
        0 => 0.0,
        _ if n % 2 == 1 => sorted[n / 2],
        _ => 0.5 * (sorted[n / 2 - 1] + sorted[n / 2]),
    }
}

/// Standard deviation about zero: from the median of the magnitudes, or of a few values from their squares.
pub(super) fn deviation(values: &[f64]) -> f64 {
    if values.len() < MIN_RESIDUALS {
        let squares: f64 = values.iter().map(|value| value * value).sum();
        return libm::sqrt(squares / values.len().max(1) as f64);
    }
    let magnitudes: Vec<f64> = values.iter().map(|value| value.abs()).collect();
    TO_DEVIATION * median(&magnitudes)
}

/// Which residuals are outliers, of residuals in standard deviations from shallow to deep: those far from the fit that
/// their neighbours do not share. What a model leaves in order is no outlier, however large.
pub(super) fn outliers(residuals: &[f64]) -> Vec<bool> {
    let mut flags = vec![false; residuals.len()];
    if residuals.len() < MIN_RESIDUALS {
        return flags;
    }
    for _ in 0..residuals.len() / 4 {
        let kept: Vec<usize> = (0..residuals.len()).filter(|&i| !flags[i]).collect();
        let difference = |place: usize| {
            let (left, right) = (place, kept.len() - 1 - place);
            let sides = left.min(right).min(NEIGHBOURS);
            let at = |place: usize| residuals[kept[place]];
            let expected = if sides > 0 {
                let around = (place - sides..=place + sides).filter(|&other| other != place);
                median(&around.map(at).collect::<Vec<_>>())
            } else if left == 0 {
                2.0 * at(place + 1) - at(place + 2)
            } else {
                2.0 * at(place - 1) - at(place - 2)
            };
            (at(place) - expected) / OF_DIFFERENCE[sides]
        };
        let differences: Vec<f64> = (0..kept.len()).map(difference).collect();
        let limit = OUTLYING * deviation(&differences);
        let worst = (0..kept.len())
            .filter(|&place| residuals[kept[place]].abs() > OUTLYING && differences[place].abs() > limit)
            .max_by(|&a, &b| differences[a].abs().total_cmp(&differences[b].abs()));
        let Some(worst) = worst else { break };
        flags[kept[worst]] = true;
    }
    flags
}

/// The part of the variance of the second numbers that a straight line in the first ones leaves.
pub(super) fn left_of_line(pairs: &[[f64; 2]]) -> f64 {
    let count = pairs.len() as f64;
    let mean = [0, 1].map(|k| pairs.iter().map(|pair| pair[k]).sum::<f64>() / count);
    let product = |a: usize, b: usize| -> f64 {
        pairs
            .iter()
            .map(|pair| (pair[a] - mean[a]) * (pair[b] - mean[b]))
            .sum()
    };
    let square = product(0, 1) * product(0, 1) / (product(0, 0) * product(1, 1));
    if square.is_finite() { 1.0 - square } else { 1.0 }
}

/// How likely it is by chance that so many of `count` signs are positive, or a split as uneven: twice the tail of the binomial
/// distribution of equal shares.
pub(super) fn sign_chance(positive: usize, count: usize) -> f64 {
    let fewer = positive.min(count - positive);
    let mut term = libm::exp2(-(count as f64));
    let mut tail = term;
    for k in 1..=fewer {
        term *= (count - k + 1) as f64 / k as f64;
        tail += term;
    }
    (2.0 * tail).min(1.0)
}

/// How unlike chance the order of signs is: the runs test of Wald and Wolfowitz, in standard deviations; negative where
/// signs cluster. `None` where there are too few of one sign.
pub(super) fn runs(residuals: &[f64]) -> Option<f64> {
    let signs: Vec<bool> = residuals.iter().map(|residual| *residual > 0.0).collect();
    let positive = signs.iter().filter(|sign| **sign).count() as f64;
    let count = signs.len() as f64;
    let negative = count - positive;
    if positive.min(negative) < 3.0 || count < MIN_RESIDUALS as f64 {
        return None;
    }
    let runs = 1.0 + signs.windows(2).filter(|pair| pair[0] != pair[1]).count() as f64;
    let product = 2.0 * positive * negative;
    let mean = product / count + 1.0;
    let variance = product * (product - count) / (count * count * (count - 1.0));
    Some((runs - mean) / libm::sqrt(variance))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_outlier_moves_nothing() {
        let mut values: Vec<f64> = (-10..=10).map(|i| 0.1 * f64::from(i)).collect();
        let before = deviation(&values);
        values[20] = 1e6;
        assert!((deviation(&values) / before - 1.0).abs() < 0.1);
    }

    #[test]
    fn outliers_stand_alone() {
        let noise = |i: usize| [0.3, -0.9, 0.5, 1.1, -0.4, -1.2, 0.8][i % 7];
        let mut residuals: Vec<f64> = (0..30).map(noise).collect();
        residuals[12] = 9.0;
        residuals[13] = -8.0;
        residuals[29] = 15.0;
        let found = outliers(&residuals);
        let places: Vec<usize> = (0..30).filter(|&i| found[i]).collect();
        assert_eq!(places, [12, 13, 29]);
        // A misfit that grows steadily is the model's, not the data's.
        let misfit: Vec<f64> = (0..30).map(|i| 0.1 * noise(i) + 0.01 * (i * i) as f64).collect();
        assert!(outliers(&misfit).iter().all(|outlier| !outlier));
    }

    #[test]
    fn signs_of_one_kind_are_no_chance() {
        // 2 (1 + 10 + 45) / 1024.
        assert!((sign_chance(2, 10) - 112.0 / 1024.0).abs() < 1e-12);
        assert!((sign_chance(8, 10) - 112.0 / 1024.0).abs() < 1e-12);
        assert!((sign_chance(25, 25) / libm::exp2(-24.0) - 1.0).abs() < 1e-12);
        assert!((sign_chance(5, 10) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn runs_tell_a_trend_from_chance() {
        let trend: Vec<f64> = (0..20).map(|i| f64::from(i) - 9.5).collect();
        assert!(runs(&trend).expect("enough") < -3.0);
        let signs = [
            1.0, -1.0, -1.0, 1.0, 1.0, -1.0, 1.0, -1.0, -1.0, -1.0, 1.0, 1.0, -1.0, 1.0,
        ];
        assert!(runs(&signs).expect("enough").abs() < 1.5);
        assert_eq!(runs(&[1.0; 20]), None);
    }
}
