//! Continuous piecewise polynomials of least largest error.
//!
//! A segment's polynomial is written by its values at both ends, shared with its neighbours, and one or two
//! bubbles that vanish there. Lawson's iteration (weighted least squares, weights multiplied by the errors
//! they leave) drives the weighted squares towards the minimax fit. The bubbles are eliminated segment by
//! segment, which leaves a tridiagonal system for the shared values. The value at zero input is exactly zero.

use super::segmentation::Span;

/// Coefficients of a polynomial at most: cubic.
pub(super) const MOST: usize = 4;
/// Weights are kept above this share of the largest, so that no segment's equations become singular.
const LEAST_WEIGHT: f64 = 1e-10;

/// What is to be fitted at one count.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    /// The count.
    pub(super) count: f64,
    /// The output there.
    pub(super) value: f64,
    /// The error allowed there, > 0.
    pub(super) tolerance: f64,
}

/// A fit: one polynomial a segment in the argument of [`Span::argument`], constant term first.
#[derive(Clone, Debug)]
pub(super) struct Fit {
    /// Coefficients, segments upwards; those beyond the order are zero.
    pub(super) coefficients: Vec<[f64; MOST]>,
    /// Largest error over the samples, as a fraction of the tolerance.
    pub(super) error: f64,
}

/// Values at the ends of the segments, and bubbles in them.
struct Unknowns {
    knots: Vec<f64>,
    bubbles: Vec<[f64; 2]>,
}

/// One segment's samples, mapped to `0 <= z <= 1`.
struct Piece<'a> {
    samples: &'a [Sample],
    start: f64,
    length: f64,
}

impl Piece<'_> {
    /// The four basis functions at a sample: both ends, both bubbles.
    fn basis(&self, sample: &Sample) -> [f64; 4] {
        let z = (sample.count - self.start) / self.length;
        let bubble = 4.0 * z * (1.0 - z);
        [1.0 - z, z, bubble, bubble * (2.0 * z - 1.0)]
    }
}

/// Fits polynomials of `order` (2 to 4) coefficients; `samples` holds each segment's, both its ends included.
pub(super) fn fit(spans: &[Span], samples: &[Vec<Sample>], order: usize, iterations: usize) -> Fit {
    let pieces: Vec<Piece<'_>> = samples
        .iter()
        .map(|samples| {
            let start = samples[0].count;
            Piece {
                samples,
                start,
                length: samples[samples.len() - 1].count - start,
            }
        })
        .collect();
    let mut weights: Vec<Vec<f64>> = samples.iter().map(|piece| vec![1.0; piece.len()]).collect();
    let mut best: Option<(f64, Unknowns)> = None;
    for _ in 0..iterations {
        let unknowns = least_squares(&pieces, &weights, order - 2);
        let (mut worst, mut heaviest) = (0.0_f64, 0.0_f64);
        for (i, piece) in pieces.iter().enumerate() {
            for (sample, weight) in piece.samples.iter().zip(&mut weights[i]) {
                let error = (unknowns.at(i, piece.basis(sample)) - sample.value).abs() / sample.tolerance;
                *weight *= error;
                worst = worst.max(error);
                heaviest = heaviest.max(*weight);
            }
        }
        if best.as_ref().is_none_or(|(error, _)| worst < *error) {
            best = Some((worst, unknowns));
        }
        if heaviest <= 0.0 {
            break;
        }
        for weight in weights.iter_mut().flatten() {
            *weight = (*weight / heaviest).max(LEAST_WEIGHT);
        }
    }
    let (error, unknowns) = best.expect("there is at least one iteration");
    let coefficients = (0..pieces.len())
        .map(|i| unknowns.coefficients(i, &pieces[i], &spans[i]))
        .collect();
    Fit { coefficients, error }
}

/// The weighted least-squares solution with `bubbles` bubbles a segment.
fn least_squares(pieces: &[Piece<'_>], weights: &[Vec<f64>], bubbles: usize) -> Unknowns {
    let count = pieces.len();
    // Tridiagonal system of the values at the upper ends; the lowest value is zero.
    let (mut diagonal, mut off, mut right) = (vec![0.0; count], vec![0.0; count], vec![0.0; count]);
    let mut reduced = Vec::with_capacity(count);
    for (i, piece) in pieces.iter().enumerate() {
        // Upper triangle of the normal equations: columns are the basis, the last is the right-hand side.
        let mut normal = [[0.0; 5]; 4];
        for (sample, &weight) in piece.samples.iter().zip(&weights[i]) {
            let scale = weight / (sample.tolerance * sample.tolerance);
            let basis = piece.basis(sample);
            let row = [basis[0], basis[1], basis[2], basis[3], sample.value];
            for a in 0..4 {
                for b in 0..5 {
                    normal[a][b] += scale * basis[a] * row[b];
                }
            }
        }
        // Eliminate the bubbles, the last first.
        for bubble in (2..2 + bubbles).rev() {
            for a in 0..bubble {
                let factor = normal[a][bubble] / normal[bubble][bubble];
                for b in 0..5 {
                    normal[a][b] -= factor * normal[bubble][b];
                }
            }
        }
        diagonal[i] += normal[1][1];
        right[i] += normal[1][4];
        if i > 0 {
            diagonal[i - 1] += normal[0][0];
            right[i - 1] += normal[0][4];
            off[i] = normal[0][1];
        }
        reduced.push(normal);
    }
    for i in 1..count {
        let factor = off[i] / diagonal[i - 1];
        diagonal[i] -= factor * off[i];
        right[i] -= factor * right[i - 1];
    }
    let mut knots = vec![0.0; count + 1];
    for i in (0..count).rev() {
        let above = if i + 1 < count {
            off[i + 1] * knots[i + 2]
        } else {
            0.0
        };
        knots[i + 1] = (right[i] - above) / diagonal[i];
    }
    let bubbles = reduced
        .iter()
        .enumerate()
        .map(|(i, normal)| {
            let mut found = [0.0; 2];
            for bubble in 2..2 + bubbles {
                let row = &normal[bubble];
                let mut rest = row[4] - row[0] * knots[i] - row[1] * knots[i + 1];
                for lower in 2..bubble {
                    rest -= row[lower] * found[lower - 2];
                }
                found[bubble - 2] = rest / row[bubble];
            }
            found
        })
        .collect();
    Unknowns { knots, bubbles }
}

impl Unknowns {
    fn at(&self, segment: usize, basis: [f64; 4]) -> f64 {
        basis[0] * self.knots[segment]
            + basis[1] * self.knots[segment + 1]
            + basis[2] * self.bubbles[segment][0]
            + basis[3] * self.bubbles[segment][1]
    }

    /// Powers of the argument `u` from values and bubbles in `z`.
    fn coefficients(&self, segment: usize, piece: &Piece<'_>, span: &Span) -> [f64; MOST] {
        let (low, high) = (self.knots[segment], self.knots[segment + 1]);
        let [even, odd] = self.bubbles[segment];
        // 4 z (1 - z) (even + odd (2 z - 1)) in powers of z.
        let in_z = [
            low,
            high - low + 4.0 * (even - odd),
            4.0 * (3.0 * odd - even),
            -8.0 * odd,
        ];
        // z = offset + slope u
        let offset = (span.upper - piece.start) / piece.length;
        let slope = 2.0 * span.width / piece.length;
        let mut in_u = [0.0; MOST];
        for &power in in_z.iter().rev() {
            for i in (1..MOST).rev() {
                in_u[i] = offset * in_u[i] + slope * in_u[i - 1];
            }
            in_u[0] = offset * in_u[0] + power;
        }
        in_u
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One segment from 0 to 1, and its samples of a function.
    fn sampled(f: impl Fn(f64) -> f64) -> (Vec<Span>, Vec<Vec<Sample>>) {
        let span = Span {
            start: 0,
            end: 1,
            upper: 1.0,
            width: 1.0,
        };
        let samples = (0..=400)
            .map(|i| {
                let count = f64::from(i) / 400.0;
                Sample {
                    count,
                    value: f(count),
                    tolerance: 1.0,
                }
            })
            .collect();
        (vec![span], vec![samples])
    }

    fn value(fit: &Fit, span: &Span, count: f64) -> f64 {
        let u = span.argument(count);
        fit.coefficients[0].iter().rev().fold(0.0, |sum, &c| sum * u + c)
    }

    #[test]
    fn gives_back_a_polynomial_of_its_own_order() {
        let cubic = |x: f64| 3.0 * x - 2.0 * x * x + 0.5 * x * x * x;
        let (spans, samples) = sampled(cubic);
        let fit = fit(&spans, &samples, 4, 5);
        assert!(fit.error < 1e-12, "{:e}", fit.error);
        for x in [0.0, 0.3, 1.0] {
            assert!((value(&fit, &spans[0], x) - cubic(x)).abs() < 1e-12);
        }
    }

    /// The line `c x` with least largest error on `x^2`: the error is equal and opposite at `x = c / 2` and at
    /// 1, so `c^2 / 4 = 1 - c`: `c = 2 sqrt 2 - 2`, error `3 - 2 sqrt 2`.
    #[test]
    fn comes_close_to_the_minimax_line_through_zero() {
        let (spans, samples) = sampled(|x| x * x);
        let fit = fit(&spans, &samples, 2, 200);
        let best = 3.0 - 2.0 * core::f64::consts::SQRT_2;
        assert!(
            fit.error >= best * 0.9999 && fit.error < best * 1.01,
            "{}",
            fit.error / best
        );
    }

    #[test]
    fn is_continuous_between_segments() {
        let spans: Vec<Span> = [(0.0, 1.0), (1.0, 2.0), (2.0, 4.0)]
            .iter()
            .map(|&(start, end)| Span {
                start: start as i32,
                end: end as i32,
                upper: end,
                width: end - start,
            })
            .collect();
        let samples: Vec<Vec<Sample>> = spans
            .iter()
            .map(|span| {
                (0..=50)
                    .map(|i| {
                        let count = f64::from(span.start) + span.width * f64::from(i) / 50.0;
                        Sample {
                            count,
                            value: libm::sqrt(count + 1.0) - 1.0,
                            tolerance: 1e-3,
                        }
                    })
                    .collect()
            })
            .collect();
        for order in 2..=4 {
            let fit = fit(&spans, &samples, order, 50);
            for pair in 0..2 {
                let below = fit.coefficients[pair][0];
                // The lower end of the next segment: u = -1/2.
                let above = fit.coefficients[pair + 1]
                    .iter()
                    .rev()
                    .fold(0.0, |sum, &c| sum * -0.5 + c);
                assert!((below - above).abs() < 1e-12);
            }
        }
    }
}
