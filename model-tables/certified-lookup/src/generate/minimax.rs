//! Sums with the smallest maximum error, by exchange: Remez's algorithm over samples.
//!
//! Powers of `s >= 0` with gaps between them are a Chebyshev system as those without are (Descartes' rule of
//! signs), so the best sum is the one whose error alternates between its extremes once more than it has coefficients.

/// Largest number of coefficients of a sum.
pub const MAX_COEFFICIENTS: usize = 5;
/// Largest number of exchanges. A few are usual.
const EXCHANGES: usize = 30;
/// The largest error this close to that of the alternation is taken for it.
const CLOSE: f64 = 1.002;

/// The wanted value of a sum at one input: `middle`, plus or minus `half`.
#[derive(Clone, Copy, Debug)]
pub struct FitSample {
    /// Factors of its coefficients, dimensionless.
    pub factors: [f64; MAX_COEFFICIENTS],
    /// The middle of the window, in the unit of the output.
    pub middle: f64,
    /// Half the width of the window, in the unit of the output, > 0.
    pub half: f64,
}

impl FitSample {
    /// How far a sum with these coefficients lies from the middle, in half widths.
    pub fn error(&self, coefficients: &[f64; MAX_COEFFICIENTS]) -> f64 {
        let mut sum = 0.0;
        for (coefficient, factor) in coefficients.iter().zip(self.factors) {
            sum += coefficient * factor;
        }
        (sum - self.middle) / self.half
    }
}

/// A sum and its largest error over the samples, in half widths.
#[derive(Clone, Copy, Debug)]
pub struct MinimaxFit {
    /// The coefficients, in the unit of the output.
    pub coefficients: [f64; MAX_COEFFICIENTS],
    /// The largest error over its window's half width, dimensionless.
    pub error: f64,
}

/// The best sum whose coefficients from `free` on are those `given`. The samples are in the order of their inputs.
pub fn fit(samples: &[FitSample], free: usize, given: &[f64; MAX_COEFFICIENTS]) -> MinimaxFit {
    let count = samples.len();
    let mut best = MinimaxFit {
        coefficients: *given,
        error: f64::INFINITY,
    };
    if count <= free {
        return best;
    }
    // Chebyshev's points to begin with.
    let mut reference: Vec<usize> = (0..=free)
        .map(|i| {
            let place = 0.5 - 0.5 * libm::cos(core::f64::consts::PI * i as f64 / free as f64);
            libm::round(place * (count - 1) as f64) as usize
        })
        .collect();
    let mut errors = vec![0.0; count];
    for _ in 0..EXCHANGES {
        let Some((coefficients, level)) = alternating(samples, &reference, free, given) else {
            break;
        };
        let mut error = 0.0_f64;
        for (slot, sample) in errors.iter_mut().zip(samples) {
            *slot = sample.error(&coefficients);
            error = error.max(slot.abs());
        }
        if error < best.error {
            best = MinimaxFit { coefficients, error };
        }
        if error <= CLOSE * level.abs() || !exchange(&mut reference, &errors) {
            break;
        }
    }
    best
}

/// The sum whose errors at the reference are equal and of alternating sign, and that error.
fn alternating(
    samples: &[FitSample],
    reference: &[usize],
    free: usize,
    given: &[f64; MAX_COEFFICIENTS],
) -> Option<([f64; MAX_COEFFICIENTS], f64)> {
    // Unknowns: the free coefficients and the level; last column: the right-hand side.
    let mut rows = [[0.0; MAX_COEFFICIENTS + 2]; MAX_COEFFICIENTS + 1];
    let size = free + 1;
    let mut scales = [1.0; MAX_COEFFICIENTS + 1];
    for (column, scale) in scales.iter_mut().enumerate().take(free) {
        let largest = reference.iter().fold(0.0_f64, |largest, &at| {
            largest.max(samples[at].factors[column].abs() / samples[at].half)
        });
        *scale = if largest > 0.0 { 1.0 / largest } else { return None };
    }
    for (i, &at) in reference.iter().enumerate() {
        let sample = &samples[at];
        let mut rest = sample.middle;
        for column in free..MAX_COEFFICIENTS {
            rest -= given[column] * sample.factors[column];
        }
        for column in 0..free {
            rows[i][column] = sample.factors[column] / sample.half * scales[column];
        }
        rows[i][free] = if i % 2 == 0 { -1.0 } else { 1.0 };
        rows[i][size] = rest / sample.half;
    }
    for column in 0..size {
        let pivot =
            (column..size).max_by(|&a, &b| rows[a][column].abs().total_cmp(&rows[b][column].abs()))?;
        rows.swap(column, pivot);
        if rows[column][column].abs() < 1e-13 {
            return None;
        }
        for row in 0..size {
            if row != column {
                let factor = rows[row][column] / rows[column][column];
                for k in column..=size {
                    rows[row][k] -= factor * rows[column][k];
                }
            }
        }
    }
    let mut coefficients = *given;
    for column in 0..free {
        coefficients[column] = rows[column][size] / rows[column][column] * scales[column];
    }
    Some((coefficients, rows[free][size] / rows[free][free]))
}

/// Moves the reference to the extremes of the error, one in each run of one sign; `false` when there are too few.
fn exchange(reference: &mut Vec<usize>, errors: &[f64]) -> bool {
    let mut extremes: Vec<usize> = Vec::new();
    for (at, error) in errors.iter().enumerate() {
        match extremes.last_mut() {
            Some(last) if (errors[*last] >= 0.0) == (*error >= 0.0) => {
                if error.abs() > errors[*last].abs() {
                    *last = at;
                }
            }
            _ => extremes.push(at),
        }
    }
    let size = |at: &usize| errors[*at].abs();
    while extremes.len() > reference.len() {
        let excess = extremes.len() - reference.len();
        if excess == 1 {
            // An end can go alone.
            let last = extremes.len() - 1;
            let drop = if size(&extremes[0]) < size(&extremes[last]) {
                0
            } else {
                last
            };
            extremes.remove(drop);
        } else {
            // Inside, only a pair can: the signs go on alternating.
            let pair = (0..extremes.len() - 1)
                .min_by(|&a, &b| {
                    let larger = |i: usize| size(&extremes[i]).max(size(&extremes[i + 1]));
                    larger(a).total_cmp(&larger(b))
                })
                .unwrap_or(0);
            extremes.drain(pair..pair + 2);
        }
    }
    if extremes.len() == reference.len() {
        let moved = extremes != *reference;
        *reference = extremes;
        return moved;
    }
    // Too few runs, as may happen while the level is next to nothing: the largest error takes its neighbour's place.
    let Some(worst) = (0..errors.len()).max_by(|&a, &b| size(&a).total_cmp(&size(&b))) else {
        return false;
    };
    let Some(nearest) = (0..reference.len()).min_by_key(|&i| reference[i].abs_diff(worst)) else {
        return false;
    };
    let moved = reference[nearest] != worst;
    reference[nearest] = worst;
    moved
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Samples of a function on [0, 1] with weight one, for sums of the given powers.
    fn sampled(powers: &[i32], f: impl Fn(f64) -> f64) -> Vec<FitSample> {
        (0..=400)
            .map(|i| {
                let x = f64::from(i) / 400.0;
                let mut factors = [0.0; MAX_COEFFICIENTS];
                for (factor, &power) in factors.iter_mut().zip(powers) {
                    *factor = x.powi(power);
                }
                FitSample {
                    factors,
                    middle: f(x),
                    half: 1.0,
                }
            })
            .collect()
    }

    /// The best line on `x^2` is `x - 1/8`, its error 1/8.
    #[test]
    fn finds_the_best_line_on_a_parabola() {
        let found = fit(&sampled(&[0, 1], |x| x * x), 2, &[0.0; MAX_COEFFICIENTS]);
        assert!((found.error - 0.125).abs() < 1e-6, "{found:?}");
        assert!((found.coefficients[0] + 0.125).abs() < 1e-5 && (found.coefficients[1] - 1.0).abs() < 1e-5);
    }

    /// The best polynomial of degree 3 on `x^4` over [0, 1] errs by `2 / 4^4 / 2 = 1/128` (Chebyshev).
    #[test]
    fn finds_the_best_cubic_on_a_quartic() {
        let found = fit(
            &sampled(&[0, 1, 2, 3], |x| x.powi(4)),
            4,
            &[0.0; MAX_COEFFICIENTS],
        );
        assert!((found.error * 128.0 - 1.0).abs() < 2e-3, "{found:?}");
    }

    #[test]
    fn gives_back_a_sum_of_its_own_powers() {
        let sum = |x: f64| 3.0 - 2.0 * x + 0.5 * x.powi(2) - 0.7 * x.powi(6);
        let found = fit(&sampled(&[0, 1, 2, 6], sum), 4, &[0.0; MAX_COEFFICIENTS]);
        assert!(found.error < 1e-12, "{found:?}");
        assert!((found.coefficients[3] + 0.7).abs() < 1e-9);
    }

    /// With the slope given as 1, the best constant on `x^2` is again -1/8; with slope 0 it is 1/2, error 1/2.
    #[test]
    fn keeps_the_coefficients_it_is_given() {
        let samples = sampled(&[0, 1], |x| x * x);
        for (slope, constant, error) in [(1.0, -0.125, 0.125), (0.0, 0.5, 0.5)] {
            let found = fit(&samples, 1, &[0.0, slope, 0.0, 0.0, 0.0]);
            assert!((found.coefficients[0] - constant).abs() < 1e-3, "{found:?}");
            assert!((found.error - error).abs() < 2e-3 * error, "{found:?}");
        }
    }

    /// Where a window is narrow the error in it is small: weights count.
    #[test]
    fn follows_the_windows() {
        let mut samples = sampled(&[0, 1], |x| x * x);
        samples[0].half = 1e-3;
        let found = fit(&samples, 2, &[0.0; MAX_COEFFICIENTS]);
        assert!(samples[0].error(&found.coefficients).abs() <= found.error * 1.001);
        assert!(found.coefficients[0].abs() < 1e-3);
    }
}
