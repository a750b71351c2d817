//! Where knots go, and the least squares of lines through them.

/// Errors of reading are taken from this share of full scale up, and in its units below.
pub(super) const FROM: f64 = 0.01;

/// The place of a function's least value between two, by thirds.
pub(super) fn least(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..32 {
        let third = (high - low) / 3.0;
        if f(low + third) < f(high - third) {
            high -= third;
        } else {
            low += third;
        }
    }
    0.5 * (low + high)
}

/// `count` places at equal steps of `sums`, which grows along `places`.
pub(super) fn spread(places: &[f64], sums: &[f64], count: usize) -> Vec<f64> {
    let total = sums[sums.len() - 1];
    (0..count)
        .map(|i| {
            let wanted = total * i as f64 / (count - 1) as f64;
            let at = sums.partition_point(|&sum| sum < wanted).clamp(1, sums.len() - 1);
            let t = (wanted - sums[at - 1]) / (sums[at] - sums[at - 1]);
            places[at - 1] + t * (places[at] - places[at - 1])
        })
        .collect()
}

/// Values at knots of weighted least squares: tridiagonal normal equations.
pub(super) fn weighted_lines(
    count: usize,
    samples: &[(usize, f64, [f64; 2])],
    output: usize,
    weights: &[f64],
) -> Vec<f64> {
    let mut diagonal = vec![1e-12; count];
    let mut beside = vec![0.0; count];
    let mut right = vec![0.0; count];
    for ((at, t, truth), weight) in samples.iter().zip(weights) {
        let scale = 1.0 / truth[output].max(FROM);
        let weight = weight * scale * scale;
        diagonal[*at] += weight * (1.0 - t) * (1.0 - t);
        beside[*at] += weight * t * (1.0 - t);
        diagonal[at + 1] += weight * t * t;
        right[*at] += weight * (1.0 - t) * truth[output];
        right[at + 1] += weight * t * truth[output];
    }
    for i in 1..count {
        let factor = beside[i - 1] / diagonal[i - 1];
        diagonal[i] -= factor * beside[i - 1];
        right[i] -= factor * right[i - 1];
    }
    for i in (0..count).rev() {
        let above = if i + 1 < count {
            beside[i] * right[i + 1]
        } else {
            0.0
        };
        right[i] = (right[i] - above) / diagonal[i];
    }
    right
}
