//! Exact bounds of a segment's sum, of its growth from count to count and of its error, over ranges of counts.
//!
//! Over a range both the sum of real factors and the curve's local polynomial are polynomials in the place, 0 at the first count
//! and 1 at the last. Their coefficients in Bernstein's basis enclose their values (Farin, Curves and Surfaces for CAGD, chapter
//! 5: the convex hull property). What the integers add to the sum is bounded by [`Sum::rounding`].

use super::owned::OwnedTables;
use super::quantise::{Coefficients, evaluate};
use crate::layout::{Constant, Layout, Powers};

/// Coefficients of a polynomial: degree eight, as the highest power of a sum.
pub(super) const TERMS: usize = 9;
/// Ranges of so many counts are evaluated one by one.
const FEW: i32 = 256;
/// The whole that mantissas and factors are fractions of.
const WHOLE: f64 = 4_294_967_296.0;
/// What floating point adds to a bound, relative to the largest coefficient.
const FLOATING: f64 = 1e-13;

/// A polynomial in the place, the constant term first.
pub(super) type Polynomial = [f64; TERMS];

/// Counts from `first` to `last`, both included.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) struct Range {
    pub(super) first: i32,
    pub(super) last: i32,
}

impl Range {
    /// How many there are.
    pub(super) fn counts(self) -> i32 {
        self.last - self.first + 1
    }

    /// Whether evaluating every count is cheaper than a bound.
    pub(super) fn is_short(self) -> bool {
        self.counts() <= FEW
    }

    /// Two ranges that share the count in the middle.
    pub(super) fn halves(self) -> [Self; 2] {
        let middle = self.first + (self.last - self.first) / 2;
        [
            Self { last: middle, ..self },
            Self {
                first: middle,
                ..self
            },
        ]
    }
}

/// The sum of one output in one segment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sum<'a> {
    pub(super) layout: &'a Layout,
    /// The constant in units of the sum, then the coefficients.
    pub(super) coefficients: Coefficients,
    /// Bits of the sum below a unit of the output.
    pub(super) shift: u32,
}

impl<'a> Sum<'a> {
    /// Of an output (0, 1) in a segment of tables, from its words.
    pub(super) fn of(tables: &'a OwnedTables, index: usize, number: u32, output: usize) -> Self {
        let layout = &tables.layout;
        let words = tables.segment(index);
        let half = |word: i32| {
            i32::from(if output == 0 {
                (word >> 16) as i16
            } else {
                word as i16
            })
        };
        let constant = words[output];
        let mut coefficients = [0; super::minimax::MAX_COEFFICIENTS];
        coefficients[0] = constant;
        let mut at = 2;
        for (power, coefficient) in coefficients[1..=layout.powers.terms()].iter_mut().enumerate() {
            if power == 0 && layout.constant == Constant::Half {
                *coefficient = i32::from(constant as i16);
            } else {
                *coefficient = half(words[at]);
                at += 1;
            }
        }
        let own = layout.shifts[output];
        Self {
            layout,
            coefficients,
            shift: layout.octave_shift(number) + own,
        }
    }

    /// The output at a count of the segment, as the chip has it.
    pub(super) fn at(&self, count: i32) -> i32 {
        let mantissa = self.layout.place(count).mantissa;
        evaluate(&self.coefficients, self.layout.factors(mantissa)) >> self.shift
    }

    /// A unit of the output, in units of the sum.
    pub(super) fn unit(&self) -> f64 {
        libm::ldexp(1.0, self.shift as i32)
    }

    /// How far the integer sum is from that of real factors, at most, in units of the sum; and how much less, or more, it grows from
    /// one count to the next.
    ///
    /// A product is rounded down, by less than 1; a factor is up to 1.6 too small (`s^2 / 2` by less than 1, and the powers of it by
    /// twice 9/32 of that and 1 more).
    pub(super) fn rounding(&self) -> f64 {
        let terms = &self.coefficients[1..=self.layout.powers.terms()];
        terms
            .iter()
            .map(|&coefficient| 1.0 + 1.6 / 65536.0 * f64::from(coefficient).abs())
            .sum()
    }

    /// The sum of real factors over a range, in units of the sum.
    pub(super) fn over(&self, range: Range) -> Polynomial {
        let [constant, rest @ ..] = self.coefficients.map(f64::from);
        // Factors are fractions of 2^32, products of 2^16: 1/2 - s, s^2/2, then s^4/4, s^6/8 and s^8/16.
        let mut powers = [0.0; TERMS];
        powers[0] = constant + 32768.0 * rest[0];
        powers[1] = -65536.0 * rest[0];
        powers[2] = 32768.0 * rest[1];
        match self.layout.powers {
            Powers::Two => {}
            Powers::Four => powers[4] = 16384.0 * rest[2],
            Powers::Six => powers[6] = 8192.0 * rest[2],
            Powers::Eight => {
                powers[4] = 16384.0 * rest[2];
                powers[8] = 4096.0 * rest[3];
            }
        }
        let distance = |count: i32| {
            let mantissa = self.layout.place(count).mantissa;
            1.0 - f64::from(mantissa) / WHOLE
        };
        let first = distance(range.first);
        compose(&powers, first, distance(range.last) - first)
    }

    /// Least and largest growth of the sum from a count of a range to the next, in units of the sum: the narrower of what the slope
    /// of the whole sum and what each product alone allow.
    pub(super) fn growth(&self, range: Range) -> [f64; 2] {
        let steps = f64::from(range.last - range.first);
        let powers = self.over(range);
        let mut slope = [0.0; TERMS];
        for power in 1..TERMS {
            slope[power - 1] = power as f64 * powers[power] / steps;
        }
        let rounding = self.rounding();
        // The mean of the slope over a count lies between its bounds.
        let [least, largest] = bounds(&slope);
        let [apart_least, apart_largest] = self.growth_of_products(range);
        [
            apart_least.max(least - rounding),
            apart_largest.min(largest + rounding),
        ]
    }

    /// The same from each product's own bounds, added: factors never change direction within a segment, and neither do products
    /// with them, however they are rounded.
    fn growth_of_products(&self, range: Range) -> [f64; 2] {
        let mantissa = |count: i32| self.layout.place(count).mantissa;
        let [near, far] = [range.first, range.last].map(|count| 1.0 - f64::from(mantissa(count)) / WHOLE);
        // What the mantissa, and so the linear factor, grows by at a count.
        let growth = f64::from(mantissa(range.first + 1) - mantissa(range.first));
        let exponents: &[i32] = match self.layout.powers {
            Powers::Two => &[2],
            Powers::Four => &[2, 4],
            Powers::Six => &[2, 6],
            Powers::Eight => &[2, 4, 8],
        };
        let product = |coefficient: i32, [low, high]: [f64; 2]| {
            let ends = [low, high].map(|factor| factor * f64::from(coefficient) / 65536.0);
            [
                libm::floor(ends[0].min(ends[1])),
                libm::ceil(ends[0].max(ends[1])),
            ]
        };
        let mut total = product(self.coefficients[1], [growth; 2]);
        for (&exponent, &coefficient) in exponents.iter().zip(&self.coefficients[2..]) {
            // d/ds (s^p / 2^(p / 2)), and it falls as the mantissa grows. Square, fourth, ...: each rounds what is rounded already.
            let slope = |s: f64| {
                growth * f64::from(exponent) * libm::pow(s, f64::from(exponent - 1))
                    / libm::ldexp(1.0, exponent / 2)
            };
            let already = if exponent == 2 { 0.0 } else { 1.0 };
            let falls = [
                -libm::ceil(slope(near) * (1.0 + FLOATING)) - already,
                -(libm::floor(slope(far) * (1.0 - FLOATING)) - already).max(0.0),
            ];
            let [least, largest] = product(coefficient, falls);
            total = [total[0] + least, total[1] + largest];
        }
        total
    }

    /// Whether the output falls anywhere in a range.
    pub(super) fn falls(&self, range: Range) -> bool {
        if range.first == range.last {
            return false;
        }
        // An integer above -1 is not negative.
        if self.growth(range)[0] > -1.0 {
            return false;
        }
        if range.is_short() {
            return (range.first..range.last).any(|count| self.at(count + 1) < self.at(count));
        }
        range.halves().into_iter().any(|half| self.falls(half))
    }
}

/// The polynomial in `offset + scale u` as one in `u`: Horner's rule.
pub(super) fn compose<const N: usize>(powers: &[f64; N], offset: f64, scale: f64) -> Polynomial {
    let mut out = [0.0; TERMS];
    for &power in powers.iter().rev() {
        for at in (1..TERMS).rev() {
            out[at] = out[at] * offset + out[at - 1] * scale;
        }
        out[0] = out[0] * offset + power;
    }
    out
}

/// Bounds of a polynomial over `0 ..= 1`: the least and the largest of its coefficients in Bernstein's basis.
pub(super) fn bounds(powers: &Polynomial) -> [f64; 2] {
    const DEGREE: usize = TERMS - 1;
    let (mut least, mut largest) = (f64::INFINITY, f64::NEG_INFINITY);
    let size = powers.iter().fold(0.0_f64, |size, power| size.max(power.abs()));
    for i in 0..=DEGREE {
        // Sum of C(i, j) / C(8, j) times the coefficients up to i.
        let (mut ratio, mut value) = (1.0, 0.0);
        for j in 0..=i {
            value += ratio * powers[j];
            ratio *= (i - j) as f64 / (DEGREE - j).max(1) as f64;
        }
        least = least.min(value);
        largest = largest.max(value);
    }
    [least - FLOATING * size, largest + FLOATING * size]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const LAYOUT: Layout = Layout {
        fraction_bits: 5,
        maximum: 1_000_000,
        bias: 64,
        octaves: 2,
        halvings: 0,
        powers: Powers::Eight,
        constant: Constant::Whole,
        first_index: 6,
        shifts: [0; 2],
    };

    /// `(1 - u)^2 (1 + u)` on `2 + 3 u`, by hand: the values agree, and the bounds enclose them.
    #[test]
    fn bounds_enclose_and_composition_keeps_values() {
        let powers = [1.0, -1.0, -1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let at = |powers: &Polynomial, u: f64| powers.iter().rev().fold(0.0, |sum, power| sum * u + power);
        let composed = compose(&powers, 2.0, 3.0);
        let [least, largest] = bounds(&composed);
        for k in 0..=100 {
            let u = f64::from(k) / 100.0;
            let (x, value) = (2.0 + 3.0 * u, at(&composed, u));
            assert!((value - (1.0 - x) * (1.0 - x) * (1.0 + x)).abs() < 1e-11 * value.abs().max(1.0));
            assert!(least <= value && value <= largest);
        }
        // It grows throughout: its ends are the bounds.
        assert!((least - 3.0).abs() < 1e-9 && (largest - 96.0).abs() < 1e-9);
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

        /// Sums and growth of drawn coefficients, at every count of drawn ranges.
        #[test]
        fn the_integers_stay_within_the_bounds(
            powers in prop::sample::select(vec![Powers::Two, Powers::Four, Powers::Six, Powers::Eight]),
            first in 10_000..390_000,
            constant in -(1 << 27)..(1 << 27),
            others in prop::array::uniform4(-32767..=32767),
        ) {
            let layout = Layout { powers, ..LAYOUT };
            let number = layout.place(first).number;
            let last = (first..first + 900)
                .take_while(|&count| layout.place(count).number == number)
                .last()
                .expect("its own");
            let mut coefficients = [0; 5];
            coefficients[0] = constant;
            coefficients[1..=powers.terms()].copy_from_slice(&others[..powers.terms()]);
            let sum = Sum {
                layout: &layout,
                coefficients,
                shift: 0,
            };
            let range = Range { first, last };
            let [least, largest] = bounds(&sum.over(range));
            let [slowest, fastest] = if first < last { sum.growth(range) } else { [0.0; 2] };
            let mut before = None;
            for count in first..=last {
                let value = f64::from(sum.at(count));
                prop_assert!(value > least - sum.rounding() && value < largest + sum.rounding());
                if let Some(before) = before.replace(value) {
                    prop_assert!(value - before >= slowest && value - before <= fastest, "{}", count);
                }
            }
        }
    }

    #[test]
    fn a_fall_of_one_is_found() {
        // -s^2 grows towards the segment's end; with a linear coefficient against it, it falls there.
        for (linear, expected) in [(0, false), (-400, true)] {
            let sum = Sum {
                layout: &LAYOUT,
                coefficients: [1 << 20, linear, -4000, 0, 0],
                shift: 8,
            };
            let range = Range {
                first: 70_000,
                last: 262_079,
            };
            let every = (range.first..range.last).any(|count| sum.at(count + 1) < sum.at(count));
            assert_eq!((sum.falls(range), every), (expected, expected));
        }
    }
}
