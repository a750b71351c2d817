//! The series of a relaxing wall over a step of time, in the integers that the chip computes with.

use super::relaxation::{MAX_TERMS, Relaxation};

/// A factor from 0 up: `mantissa / 2^shift`.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Factor {
    /// 32 bits.
    pub mantissa: u32,
    /// 0 to [`Factor::MOST_SHIFT`].
    pub shift: u32,
}

impl Factor {
    /// Largest shift.
    pub const MOST_SHIFT: u32 = 95;

    /// The nearest factor to a value >= 0; one too small for the word is 0.
    pub fn nearest(value: f64) -> Self {
        let (mantissa, exponent) = libm::frexp(value);
        let scaled = libm::round(libm::ldexp(mantissa, 32));
        // Rounded up to the next power of two.
        let (scaled, exponent) = if scaled < 4_294_967_296.0 {
            (scaled, exponent)
        } else {
            (2_147_483_648.0, exponent + 1)
        };
        match u32::try_from(32 - exponent) {
            Ok(shift @ 0..=Self::MOST_SHIFT) if value > 0.0 => Self {
                mantissa: scaled as u32,
                shift,
            },
            _ => Self::default(),
        }
    }

    /// Its product with a number, within one unit, or for a factor above 1 within one unit times the next power of two; saturates.
    pub fn of(self, x: i64) -> i64 {
        // The product over 2^32, rounded down: at most 2^63 (1 - 2^-32).
        let high = (x >> 32) * i64::from(self.mantissa);
        let low = (u64::from(x as u32) * u64::from(self.mantissa)) >> 32;
        let upper = high + low as i64;
        match self.shift.checked_sub(32) {
            Some(0) => upper,
            Some(right) => upper.saturating_add(1 << (right - 1)) >> right,
            None => {
                let left = 32 - self.shift;
                upper.clamp(i64::MIN >> left, i64::MAX >> left) << left
            }
        }
    }

    /// Whether it is at most 1 and the chip computes with it.
    pub(crate) const fn is_a_part(self) -> bool {
        self.shift <= Self::MOST_SHIFT && self.mantissa as u128 <= 1 << self.shift
    }
}

/// What a term does in a step of time.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct TermStep {
    /// `k = 1 - exp(-dt / tau)`: what is lost of it.
    pub lost: Factor,
    /// `c = g tau / dt k`: what it takes of a change.
    pub taken: Factor,
}

/// A series over a step of time.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct SeriesStep {
    /// `1 / (1 + sum c_i)`.
    pub inverse: Factor,
    /// How many terms it has.
    pub count: usize,
    /// The terms, the slowest last; those beyond the count are 0.
    pub terms: [TermStep; MAX_TERMS],
}

impl SeriesStep {
    /// A series over a step of so many seconds, > 0.
    pub fn over(relaxation: &Relaxation, seconds: f64) -> Self {
        let mut step = Self {
            count: relaxation.terms().len(),
            ..Self::default()
        };
        let mut sum = 1.0;
        for (step, term) in step.terms.iter_mut().zip(relaxation.terms()) {
            let decay = term.over(seconds);
            *step = TermStep {
                lost: Factor::nearest(-libm::expm1(-seconds / term.time)),
                taken: Factor::nearest(decay.taken),
            };
            sum += decay.taken;
        }
        step.inverse = Factor::nearest(1.0 / sum);
        step
    }

    /// Its terms.
    pub fn terms(&self) -> &[TermStep] {
        self.terms.get(..self.count).unwrap_or(&self.terms)
    }
}

/// A wall in time, as the chip knows it.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct WallSeries {
    /// Its series over the time from one report to the next, at its own temperature.
    pub step: SeriesStep,
    /// Force that the wall may still bear where none is read, permille of the peak before.
    pub remaining_permille: u32,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_product_is_the_nearest_and_saturates() {
        let x = 123_456_789_012_345_678;
        for value in [1e-7, 0.25, 0.632, 1.0 - 1e-12, 3.0, 440.8, 5.7e4] {
            let factor = Factor::nearest(value);
            let exact = x as f64 * value;
            for (found, exact) in [(factor.of(x), exact), (factor.of(-x), -exact)] {
                let exact = exact.clamp(i64::MIN as f64, i64::MAX as f64);
                // The mantissa is within 2^-32 of the value.
                assert!(
                    (found as f64 - exact).abs() <= exact.abs() * 3e-10 + 1.0,
                    "{value}: {found} for {exact}"
                );
            }
        }
        assert_eq!(Factor::nearest(440.8).of(i64::MAX), i64::MAX >> 9 << 9);
        assert_eq!(Factor::nearest(0.0).of(i64::MAX), 0);
        assert_eq!(Factor::nearest(0.5).of(3), 2);
    }
}
