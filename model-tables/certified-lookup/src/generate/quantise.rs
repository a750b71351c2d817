//! From a sum of least largest error to 16-bit coefficients that keep it.
//!
//! The coefficient of the highest power is rounded first, both up and down. For each, the other coefficients are fitted again to
//! the remainder, and so on down. The rounding with the smallest maximum error is kept.

use super::minimax::{FitSample, MAX_COEFFICIENTS, fit};
use crate::layout::Constant;

/// How many integers on either side of the best real coefficient are tried, one after the other until one is exact enough: of the two
/// highest powers, which over a short segment are worth little, so that what is best for them may be any number. What they
/// leave is fitted again, and there the nearest two do.
const REACHES: [i32; 3] = [1, 2, 5];

/// The integers of one segment's sum: the constant in units of the sum, then the coefficients.
pub type Coefficients = [i32; MAX_COEFFICIENTS];

/// The best integers with which every sample's error stays below `limit` half widths.
pub(super) fn round(
    samples: &[FitSample],
    terms: usize,
    constant: Constant,
    limit: f64,
) -> Option<Coefficients> {
    for reach in REACHES {
        let mut search = Search {
            samples,
            constant,
            terms,
            reach,
            best: None,
            error: limit,
        };
        search.descend(1 + terms, [0.0; MAX_COEFFICIENTS]);
        if search.best.is_some() {
            return search.best;
        }
    }
    None
}

struct Search<'a> {
    samples: &'a [FitSample],
    constant: Constant,
    terms: usize,
    reach: i32,
    best: Option<Coefficients>,
    error: f64,
}

impl Search<'_> {
    /// Rounds the last of the `free` coefficients and goes on with those before it.
    fn descend(&mut self, free: usize, given: [f64; MAX_COEFFICIENTS]) {
        let found = fit(self.samples, free, &given);
        if found.error >= self.error {
            return;
        }
        let last = free - 1;
        let real = found.coefficients[last];
        if last == 0 {
            self.finish(real, given);
            return;
        }
        let reach = if last + 2 > self.terms { self.reach } else { 1 };
        let below = libm::floor(real.clamp(f64::from(i16::MIN), f64::from(i16::MAX)));
        let mut nearest: Vec<f64> = (1 - reach..=reach)
            .map(|step| below + f64::from(step))
            .filter(|&integer| integer >= f64::from(i16::MIN) && integer <= f64::from(i16::MAX))
            .collect();
        nearest.sort_by(|a, b| (a - real).abs().total_cmp(&(b - real).abs()));
        for integer in nearest {
            let mut given = given;
            given[last] = integer;
            self.descend(last, given);
        }
    }

    /// The constant term: with [`Constant::Half`] a multiple of 2^16 and what the linear coefficient adds to it.
    fn finish(&mut self, real: f64, given: [f64; MAX_COEFFICIENTS]) {
        let (unit, fraction) = match self.constant {
            Constant::Half => (65536.0, f64::from(given[1] as i16 as u16)),
            Constant::Whole => (1.0, 0.0),
        };
        let below = libm::floor((real - fraction) / unit);
        for multiple in [below, below + 1.0] {
            let constant = multiple * unit + fraction;
            if constant < f64::from(i32::MIN) || constant > f64::from(i32::MAX) {
                continue;
            }
            let mut coefficients = given;
            coefficients[0] = constant;
            let mut error = 0.0_f64;
            for sample in self.samples {
                error = error.max(sample.error(&coefficients).abs());
                if error >= self.error {
                    break;
                }
            }
            if error < self.error {
                self.error = error;
                self.best = Some(coefficients.map(|coefficient| coefficient as i32));
            }
        }
    }
}

/// The chip's arithmetic for one output.
#[inline]
pub(super) fn evaluate(sum: &Coefficients, factors: [i32; 4]) -> i32 {
    let mut value = sum[0];
    for (coefficient, factor) in sum[1..].iter().zip(factors) {
        value = value.wrapping_add(((i64::from(*coefficient) * i64::from(factor)) >> 16) as i32);
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(f: impl Fn(f64) -> f64, half: f64) -> Vec<FitSample> {
        (0..=40)
            .map(|i| {
                let x = f64::from(i) / 40.0;
                FitSample {
                    factors: [1.0, 32768.0 * x, 32768.0 * x * x, 0.0, 0.0],
                    middle: f(x),
                    half,
                }
            })
            .collect()
    }

    #[test]
    fn coefficients_that_are_integers_already_are_found() {
        let exact = |x: f64| 5.0 * 65536.0 + 300.0 + 32768.0 * (300.0 * x - 77.0 * x * x);
        let found = round(&samples(exact, 1.0), 2, Constant::Half, 1.0);
        assert_eq!(found, Some([5 * 65536 + 300, 300, -77, 0, 0]));
    }

    /// A constant in the upper half of a word carries the linear coefficient as its fraction, whatever its sign.
    #[test]
    fn the_fraction_of_a_constant_is_the_linear_coefficient() {
        let falling = |x: f64| 1e6 - 32768.0 * 40.3 * x;
        let [constant, linear, ..] =
            round(&samples(falling, 1e5), 2, Constant::Half, 1.0).expect("coarse enough");
        assert_eq!(constant & 0xffff, i32::from(linear as i16 as u16));
        let [constant, ..] = round(&samples(falling, 2e4), 2, Constant::Whole, 1.0).expect("fine enough");
        assert!((f64::from(constant) - 1e6).abs() < 2e4);
    }

    #[test]
    fn what_sixteen_bits_cannot_hold_is_refused() {
        let steep = |x: f64| 32768.0 * 40_000.0 * x;
        assert_eq!(round(&samples(steep, 1e3), 2, Constant::Whole, 1.0), None);
    }
}
