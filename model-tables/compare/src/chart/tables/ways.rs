//! Other ways to look force and indentation up, fitted to a press as well as they can be: their errors and bytes.
//!
//! A press is scaled to 0 .. 1 in the pressure rise and in both outputs. Knots that may lie anywhere are moved to where the
//! curve bends until every interval errs alike; values are fitted to least largest error (Lawson's weights), polynomials by
//! exchange. Errors are those of the arithmetic as it would run, at [`Press::places`].

use super::placing::{FROM, least, spread, weighted_lines};
use crate::lookups;
use certified_lookup::generate::minimax::{self, FitSample, MAX_COEFFICIENTS};
use micromath::F32Ext;
use model_tables::curve::{Contact, Curve};
use nalgebra::{SMatrix, SVector};

/// Samples of an interval that a fit sees.
const SAMPLES: usize = 8;
/// Rounds of weighting.
const ROUNDS: usize = 30;
/// Rounds of moving knots.
const MOVES: usize = 8;
/// Sizes tried.
const KNOTS: [usize; 17] = [
    6, 8, 11, 16, 23, 32, 45, 64, 91, 128, 181, 256, 362, 512, 724, 1024, 2048,
];
const SEGMENTS: std::ops::RangeInclusive<u32> = 2..=22;

/// A way at a size.
#[derive(Clone, Debug)]
pub(super) struct Point {
    pub(super) way: &'static str,
    /// Knots where they are searched, else 0.
    pub(super) size: usize,
    pub(super) bytes: usize,
    pub(super) errors: Errors,
}

/// The larger of both outputs' largest errors.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Errors {
    /// Percent of reading from 1 % of full scale up, and percent of that below.
    pub(super) of_reading: f64,
    /// Percent of full scale.
    pub(super) of_full_scale: f64,
}

/// A press scaled to its end.
pub(super) struct Press<'a> {
    curve: &'a Curve,
    end: Contact,
    places: Vec<(f64, [f64; 2])>,
}

impl<'a> Press<'a> {
    pub(super) fn new(curve: &'a Curve, end: Contact) -> Self {
        let mut press = Self {
            curve,
            end,
            places: Vec::new(),
        };
        let even = (0..=16_384).map(|i| f64::from(i) / 16_384.0);
        let geometric = (0..4096).map(|i| libm::exp2(-20.0 * f64::from(i) / 4096.0));
        press.places = even.chain(geometric).map(|x| (x, press.at(x))).collect();
        press
    }

    /// Force and indentation at a share of the pressure rise, as shares of their ends.
    fn at(&self, x: f64) -> [f64; 2] {
        let contact = self.curve.at_pressure_rise(x * self.end.pressure_rise);
        [
            contact.force / self.end.force,
            contact.indentation / self.end.indentation,
        ]
    }

    /// Local exponents of both.
    fn exponents(&self, x: f64) -> [f64; 2] {
        let (low, high) = (self.at(0.99 * x), self.at(1.01 * x));
        [0, 1].map(|output| libm::log(high[output] / low[output]) / libm::log(1.01 / 0.99))
    }

    /// The largest errors of a way.
    fn errors(&self, way: impl Fn(f64) -> [f64; 2]) -> Errors {
        let mut found = Errors::default();
        for &(x, truth) in &self.places {
            for (got, truth) in way(x).into_iter().zip(truth) {
                let error = 100.0 * (got - truth).abs();
                found.of_reading = found.of_reading.max(error / truth.max(FROM));
                found.of_full_scale = found.of_full_scale.max(error);
            }
        }
        found
    }

    /// Every way at every size.
    pub(super) fn points(&self) -> Vec<Point> {
        let mut points = Vec::new();
        let mut add = |way, size, bytes, errors| {
            points.push(Point {
                way,
                size,
                bytes,
                errors,
            });
        };
        for knots in KNOTS {
            let [narrow, wide] = self.uniform(knots);
            add("uniform_q15", 0, 4 * knots, narrow);
            add("uniform_q31", 0, 8 * knots, wide);
            if knots <= 512 {
                add("linear_f32", knots, 12 * knots, self.lines(knots));
                add("cubic_f32", knots, 20 * knots, self.cubics(knots));
            }
            add("warped_f32", 0, 8 * knots, self.warped(knots));
        }
        for segments in SEGMENTS {
            let count = segments as usize;
            add("octave_linear", 0, 16 * count, self.octaves::<2>(segments));
            add("octave_quadratic", 0, 24 * count, self.octaves::<3>(segments));
            add("octave_cubic", 0, 32 * count, self.octaves::<4>(segments));
        }
        add("rational_f32", 0, 40, self.rational());
        let powers = self.powers();
        add("power_libm", 0, 16, self.power(&powers, libm::powf));
        add("power_micromath", 0, 16, self.power(&powers, F32Ext::powf));
        points
    }

    /// Values at knots between which lines err least, in the variable `place` of which `x` is a function.
    fn fitted(&self, knots: &[f64], x: impl Fn(f64) -> f64) -> [Vec<f64>; 2] {
        let samples: Vec<(usize, f64, [f64; 2])> = (0..knots.len() - 1)
            .flat_map(|at| (0..SAMPLES).map(move |i| (at, (i as f64 + 0.5) / SAMPLES as f64)))
            // Towards first contact there are as many again.
            .flat_map(|(at, t)| [Some((at, t)), (at == 0).then_some((at, t * t * t))])
            .flatten()
            .map(|(at, t)| {
                let place = knots[at] + t * (knots[at + 1] - knots[at]);
                (at, t, self.at(x(place)))
            })
            .collect();
        [0, 1].map(|output| {
            let mut best = (f64::INFINITY, vec![0.0; knots.len()]);
            let mut weights = vec![1.0; samples.len()];
            for _ in 0..ROUNDS {
                let values = weighted_lines(knots.len(), &samples, output, &weights);
                let mut largest = 0.0_f64;
                let mut sum = 0.0;
                for ((at, t, truth), weight) in samples.iter().zip(&mut weights) {
                    let got = values[*at] + t * (values[at + 1] - values[*at]);
                    let error = (got - truth[output]).abs() / truth[output].max(FROM);
                    largest = largest.max(error);
                    *weight *= error + 1e-12;
                    sum += *weight;
                }
                let scale = samples.len() as f64 / sum;
                for weight in &mut weights {
                    *weight = (*weight * scale).max(1e-9);
                }
                if largest < best.0 {
                    best = (largest, values);
                }
            }
            best.1
        })
    }

    fn uniform(&self, count: usize) -> [Errors; 2] {
        let last = (count - 1) as f64;
        let knots: Vec<f64> = (0..count).map(|i| i as f64 / last).collect();
        let values = self.fitted(&knots, |place| place);
        // The last value may lie a little above 1.
        let scaled = |scale: f64| {
            let round = |value: f64| libm::round(value * scale);
            values
                .each_ref()
                .map(|values| values.iter().copied().map(round).collect::<Vec<_>>())
        };
        let (narrow_scale, wide_scale) = (32_000.0, 2_100_000_000.0);
        let narrow = scaled(narrow_scale).map(|values| values.iter().map(|&v| v as i16).collect::<Vec<_>>());
        let wide = scaled(wide_scale).map(|values| values.iter().map(|&v| v as i32).collect::<Vec<_>>());
        let input = |x: f64| libm::round(x * last * f64::from(1 << 20)) as i32;
        [
            self.errors(|x| {
                let mut out = [0; 2];
                lookups::uniform_q15([&narrow[0], &narrow[1]], input(x), &mut out);
                out.map(|value| f64::from(value) / narrow_scale)
            }),
            self.errors(|x| {
                let mut out = [0; 2];
                lookups::uniform_q31([&wide[0], &wide[1]], input(x), &mut out);
                out.map(|value| f64::from(value) / wide_scale)
            }),
        ]
    }

    fn warped(&self, count: usize) -> Errors {
        let last = (count - 1) as f64;
        let knots: Vec<f64> = (0..count).map(|i| i as f64 / last).collect();
        let [force, indentation] = self.fitted(&knots, |root| root * root);
        let knots: Vec<[f32; 2]> = force
            .iter()
            .zip(&indentation)
            .map(|(&a, &b)| [a as f32, b as f32])
            .collect();
        self.errors(|x| {
            let mut out = [0.0; 2];
            lookups::warped_f32(&knots, last as f32, x as f32, &mut out);
            out.map(f64::from)
        })
    }

    /// Knots where an interval's error, which goes with the `power`-th power of its width, is about the same everywhere; the
    /// best of some rounds of moving them, by what `errors` makes of them.
    fn placed(
        &self,
        count: usize,
        power: f64,
        bend: impl Fn(f64) -> f64,
        fit: impl Fn(&[f64]) -> Box<dyn Fn(f64) -> [f64; 2]>,
    ) -> Errors {
        // How densely knots are wanted, from the local exponents.
        let grid: Vec<f64> = std::iter::once(0.0)
            .chain((0..=1200).map(|i| libm::exp2(-24.0 * (1.0 - f64::from(i) / 1200.0))))
            .collect();
        let mut sums = vec![0.0];
        for pair in grid.windows(2) {
            let middle = 0.5 * (pair[0] + pair[1]);
            let (values, exponents) = (self.at(middle), self.exponents(middle));
            let density = [0, 1].map(|output| {
                let derivative = values[output] * bend(exponents[output]).abs().max(0.01);
                libm::pow(derivative / values[output].max(FROM), 1.0 / power) / middle
            });
            sums.push(sums[sums.len() - 1] + density[0].max(density[1]) * (pair[1] - pair[0]));
        }
        let mut knots = spread(&grid, &sums, count);
        let mut best = Errors {
            of_reading: f64::INFINITY,
            of_full_scale: f64::INFINITY,
        };
        for _ in 0..MOVES {
            let way = fit(&knots);
            let errors = self.errors(&way);
            if errors.of_reading < best.of_reading {
                best = errors;
            }
            // Where an interval errs more than another it gets more of them.
            let mut sums = vec![0.0];
            for pair in knots.windows(2) {
                let worst = (0..SAMPLES)
                    .map(|i| {
                        let x = pair[0] + (pair[1] - pair[0]) * (i as f64 + 0.5) / SAMPLES as f64;
                        let share = |(got, truth): (f64, f64)| (got - truth).abs() / truth.max(FROM);
                        let errors = way(x).into_iter().zip(self.at(x)).map(share);
                        errors.fold(0.0, f64::max)
                    })
                    .fold(0.0, f64::max);
                sums.push(sums[sums.len() - 1] + libm::pow(worst + 1e-9, 0.5 / power));
            }
            knots = spread(&knots, &sums, count);
        }
        best
    }

    fn lines(&self, count: usize) -> Errors {
        self.placed(
            count,
            2.0,
            |p| p * (p - 1.0),
            |knots| {
                let [force, indentation] = self.fitted(knots, |place| place);
                let table: Vec<[f32; 3]> = (0..knots.len())
                    .map(|i| [knots[i] as f32, force[i] as f32, indentation[i] as f32])
                    .collect();
                let way = move |x: f64| {
                    let mut out = [0.0; 2];
                    lookups::linear_f32(&table, x as f32, &mut out);
                    out.map(f64::from)
                };
                Box::new(way)
            },
        )
    }

    fn cubics(&self, count: usize) -> Errors {
        let fourth = |p: f64| p * (p - 1.0) * (p - 2.0) * (p - 3.0);
        self.placed(count, 4.0, fourth, |knots| {
            let table: Vec<[f32; 5]> = knots
                .iter()
                .map(|&x| {
                    // At first contact the indentation's slope has no bound: there it is that a little further on.
                    let near = if x > 0.0 { x } else { 0.05 * knots[1] };
                    let (at, values, exponents) = (self.at(x), self.at(near), self.exponents(near));
                    let slope = |output: usize| (values[output] * exponents[output] / near) as f32;
                    [x as f32, at[0] as f32, slope(0), at[1] as f32, slope(1)]
                })
                .collect();
            let way = move |x: f64| {
                let mut out = [0.0; 2];
                lookups::cubic_f32(&table, x as f32, &mut out);
                out.map(f64::from)
            };
            Box::new(way)
        })
    }

    /// Polynomials of degree `N - 1` in so many octaves of the input and a bias.
    fn octaves<const N: usize>(&self, segments: u32) -> Errors {
        let bias = 1_i32 << (30 - segments);
        let end = f64::from((1 << 30) - 1 - bias);
        let scale = f64::from(1 << 30);
        let table: Vec<[[i32; N]; 2]> = (0..segments)
            .map(|segment| {
                let first = f64::from(1 << (29 - segment));
                let samples = |output: usize| -> Vec<FitSample> {
                    (0..64)
                        .map(|i| {
                            let dense = 0.5 - 0.5 * libm::cos(core::f64::consts::PI * f64::from(i) / 63.0);
                            // Graded towards first contact.
                            let t = if segment + 1 == segments {
                                dense * dense * dense
                            } else {
                                dense
                            };
                            let x = ((first * (1.0 + t) - f64::from(bias)) / end).clamp(0.0, 1.0);
                            let mut factors = [0.0; MAX_COEFFICIENTS];
                            for (power, factor) in factors.iter_mut().enumerate().take(N) {
                                *factor = libm::pow(t, power as f64);
                            }
                            let middle = self.at(x)[output];
                            FitSample {
                                factors,
                                middle,
                                half: middle.max(FROM),
                            }
                        })
                        .collect()
                };
                [0, 1].map(|output| {
                    let found = minimax::fit(&samples(output), N, &[0.0; MAX_COEFFICIENTS]).coefficients;
                    std::array::from_fn(|power| libm::round(found[power] * scale) as i32)
                })
            })
            .collect();
        self.errors(|x| {
            let mut out = [0; 2];
            let count = libm::round(x * end) as i32;
            lookups::octave_i32::<N>(&table, bias as u32, 2, count, &mut out);
            out.map(|value| f64::from(value) / scale)
        })
    }

    /// Linear least squares for the product with the denominator, weighted towards the quotient and the largest error.
    fn rational(&self) -> Errors {
        let samples: Vec<(f64, [f64; 2])> = (1..=600)
            .map(|i| f64::from(i) / 600.0)
            .map(|z| (z, self.at(z * z)))
            .collect();
        let both = [0, 1].map(|output| {
            let mut best = (f64::INFINITY, [0.0; 5]);
            let mut weights = vec![1.0; samples.len()];
            let mut denominators = vec![1.0; samples.len()];
            for _ in 0..200 {
                let mut matrix = SMatrix::<f64, 5, 5>::zeros();
                let mut right = SVector::<f64, 5>::zeros();
                for ((z, truth), (weight, denominator)) in
                    samples.iter().zip(weights.iter().zip(&denominators))
                {
                    let y = truth[output];
                    let scale = 1.0 / (denominator * y.max(FROM));
                    let row = SVector::from([*z, z * z, z * z * z, -y * z, -y * z * z]) * scale;
                    matrix += row * row.transpose() * *weight;
                    right += row * (y * scale * weight);
                }
                let Some(found) = matrix.lu().solve(&right) else {
                    break;
                };
                let found: [f64; 5] = found.into();
                let [a, b, c, d, e] = found;
                let (mut largest, mut sum) = (0.0_f64, 0.0);
                for ((z, truth), (weight, denominator)) in
                    samples.iter().zip(weights.iter_mut().zip(&mut denominators))
                {
                    *denominator = 1.0 + z * (d + z * e);
                    let got = z * (a + z * (b + z * c)) / *denominator;
                    let error = (got - truth[output]).abs() / truth[output].max(FROM);
                    largest = largest.max(error);
                    *weight *= error + 1e-9;
                    sum += *weight;
                }
                for weight in &mut weights {
                    *weight = (*weight * samples.len() as f64 / sum).max(1e-9);
                }
                if largest < best.0 {
                    best = (largest, found);
                }
            }
            best.1.map(|coefficient| coefficient as f32)
        });
        self.errors(|x| {
            let mut out = [0.0; 2];
            lookups::rational_f32(&both, x as f32, &mut out);
            out.map(f64::from)
        })
    }

    /// Factors and exponents of least largest error.
    fn powers(&self) -> [[f32; 2]; 2] {
        [0, 1].map(|output| {
            let samples: Vec<(f64, f64)> = self
                .places
                .iter()
                .step_by(16)
                .map(|(x, truth)| (*x, truth[output]))
                .collect();
            let error = |factor: f64, exponent: f64| {
                samples.iter().fold(0.0_f64, |largest, (x, truth)| {
                    largest.max((factor * libm::pow(*x, exponent) - truth).abs() / truth.max(FROM))
                })
            };
            let factor = |exponent: f64| least(0.3, 2.0, |factor| error(factor, exponent));
            let exponent = least(0.3, 2.0, |exponent| error(factor(exponent), exponent));
            [factor(exponent) as f32, exponent as f32]
        })
    }

    fn power(&self, both: &[[f32; 2]; 2], power: impl Fn(f32, f32) -> f32 + Copy) -> Errors {
        self.errors(|x| {
            let mut out = [0.0; 2];
            lookups::power_f32(both, power, x as f32, &mut out);
            out.map(f64::from)
        })
    }
}

#[cfg(test)]
mod tests;
