//! The sum of a block -> gauge pressure, for a transducer whose voltage is a share of the supply that is also
//! the converter's reference: the supply cancels.

use crate::counts::CountSum;
use crate::report::Warnings;
use model_tables::constants::{Transducer, TransducerKind};

/// Gauge pressure, counts of `1 / 2^k` pascal with the design's `k`. Any `i32` is valid.
#[derive(Clone, Copy, Debug, Default, Eq, Ord, PartialEq, PartialOrd)]
pub struct Pressure(pub i32);

impl Pressure {
    /// The nearest count to a pressure in millipascals, held at the ends of the word.
    pub const fn from_millipascals(millipascals: i64, fraction_bits: u32) -> Self {
        // |millipascals| <= 2^31 * 1000 < 2^41 and k <= 16: below 2^57.
        let scaled = millipascals * (1 << fraction_bits);
        Self(saturate((scaled + if scaled < 0 { -500 } else { 500 }) / 1000))
    }

    /// The nearest count to a pressure in pascals, held at the ends of the word.
    pub const fn from_pascals(pascals: i32, fraction_bits: u32) -> Self {
        Self::from_millipascals(pascals as i64 * 1000, fraction_bits)
    }
}

/// The `i32` nearest to a number.
pub(crate) const fn saturate(number: i64) -> i32 {
    if number > i32::MAX as i64 {
        i32::MAX
    } else if number < i32::MIN as i64 {
        i32::MIN
    } else {
        number as i32
    }
}

/// `pressure = (gain * sum + offset) / 2^shift`.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Conversion {
    /// Below 2^31.
    gain: i32,
    /// Half a count for rounding included; |offset| < 2^62.
    offset: i64,
    /// 0 to 40, so that the gain has 31 bits: times a sum of 19 bits, its rounding moves no result by more
    /// than 2^19 / 2^31 = 2^-12 of what one unit of the sum is worth.
    shift: u32,
    /// Above: beyond the transducer's range.
    range_end: Pressure,
}

impl Conversion {
    /// The conversion for a ratiometric transducer in counts of `1 / 2^fraction_bits` pascal.
    ///
    /// # Panics
    /// At compile time, for a transducer that the converter cannot read, or figures out of all reason.
    pub const fn of(transducer: &Transducer, fraction_bits: u32) -> Self {
        let TransducerKind::Ratiometric { output: [low, high] } = transducer.kind else {
            panic!("the converter reads ratiometric transducers only")
        };
        let [start, end] = transducer.range;
        assert!(
            low < high && high <= 65536,
            "outputs are increasing shares of the supply"
        );
        assert!(
            start < end && fraction_bits <= 16,
            "the range or its unit is out of reason"
        );
        // Counts for one unit of the sum: span / (output share * full scale). Below 2^32 * 2^16 * 2^16 = 2^64
        // over at least 511 875; widened to 128 bits because it is evaluated by the compiler alone.
        let span = (end as i128 - start as i128) << (fraction_bits + 16);
        let sums = (high - low) as i128 * CountSum::FULL_SCALE as i128;
        let mut shift = 40;
        while rounded(span << shift, sums) > i32::MAX as i128 {
            assert!(shift > 0, "the range has too many counts");
            shift -= 1;
        }
        let gain = rounded(span << shift, sums);
        let at_start = (start as i128) << (fraction_bits + shift);
        let sum_at_start = rounded(gain * low as i128 * CountSum::FULL_SCALE as i128, 65536);
        let half = if shift == 0 { 0 } else { 1_i128 << (shift - 1) };
        Self {
            gain: gain as i32,
            offset: (at_start - sum_at_start + half) as i64,
            shift,
            range_end: Pressure::from_pascals(end, fraction_bits),
        }
    }

    /// The pressure of a block, and whether it is beyond the transducer's range. Held at the ends of the word.
    #[inline]
    pub fn pressure(&self, sum: CountSum) -> (Pressure, Warnings) {
        // gain < 2^31 and sum < 2^19: the product is below 2^50, and the offset leaves it a 63-bit word.
        let sum = i64::from(sum.0.min(CountSum::FULL_SCALE));
        let pressure = Pressure(saturate((i64::from(self.gain) * sum + self.offset) >> self.shift));
        (pressure, Warnings::SATURATED.when(pressure > self.range_end))
    }
}

/// `a / b` to the nearest, for `a >= 0 < b`.
const fn rounded(a: i128, b: i128) -> i128 {
    (a + b / 2) / b
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn mpx5100(range: [i32; 2]) -> Transducer {
        Transducer {
            range,
            resolution: 10_000,
            noise: 10_000,
            kind: TransducerKind::Ratiometric {
                output: [2621, 61604],
            },
        }
    }

    /// The line through both ends, in real numbers.
    fn line(sum: u32, transducer: &Transducer, fraction_bits: u32) -> f64 {
        let TransducerKind::Ratiometric { output } = transducer.kind else {
            unreachable!()
        };
        let share = f64::from(sum) / 511_875.0;
        let [low, high] = output.map(|output| f64::from(output) / 65536.0);
        let [start, end] = transducer.range.map(f64::from);
        (start + (end - start) * (share - low) / (high - low)) * f64::from(1 << fraction_bits)
    }

    #[test]
    fn half_the_supply_is_51_kilopascals() {
        // Vout = Vs (0.009 P + 0.04): 0.5 of the supply is P = 51.11 kPa.
        let conversion = Conversion::of(&mpx5100([0, 100_000]), 8);
        let (Pressure(counts), warnings) = conversion.pressure(CountSum(255_938));
        assert!((f64::from(counts) / 256.0 - 51_111.0).abs() < 2.0, "{counts}");
        assert_eq!(warnings, Warnings::NONE);
    }

    #[test]
    fn every_sum_is_converted_to_the_nearest_count() {
        for (range, fraction_bits) in [
            ([0, 100_000], 8),
            ([0, 400_000], 12),
            ([-50_000, 50_000], 4),
            ([0, 1_000], 0),
        ] {
            let transducer = mpx5100(range);
            let conversion = Conversion::of(&transducer, fraction_bits);
            let tolerance =
                0.501 + (line(1, &transducer, fraction_bits) - line(0, &transducer, fraction_bits)) / 4096.0;
            for sum in (0..=511_875).step_by(7) {
                let got = f64::from(conversion.pressure(CountSum(sum)).0.0);
                let exact = line(sum, &transducer, fraction_bits);
                assert!((got - exact).abs() <= tolerance, "{sum}: {got} for {exact}");
            }
        }
    }

    #[test]
    fn beyond_the_range_is_flagged() {
        let conversion = Conversion::of(&mpx5100([0, 100_000]), 8);
        // 94 % of 511 875 is 481 163; 0.95 of it is beyond.
        assert_eq!(conversion.pressure(CountSum(481_000)).1, Warnings::NONE);
        assert_eq!(conversion.pressure(CountSum(486_281)).1, Warnings::SATURATED);
    }

    #[test]
    fn millipascals_are_rounded_to_counts_and_held() {
        assert_eq!(Pressure::from_millipascals(1500, 1), Pressure(3));
        assert_eq!(Pressure::from_millipascals(-1500, 1), Pressure(-3));
        assert_eq!(Pressure::from_pascals(i32::MAX, 16), Pressure(i32::MAX));
        assert_eq!(Pressure::from_pascals(i32::MIN, 16), Pressure(i32::MIN));
    }

    proptest! {
        #[test]
        fn no_sum_panics_and_pressure_never_falls_with_it(sum in any::<u32>(), step in 0_u32..1000) {
            let conversion = Conversion::of(&mpx5100([0, 400_000]), 16);
            let (low, _) = conversion.pressure(CountSum(sum));
            let (high, _) = conversion.pressure(CountSum(sum.saturating_add(step)));
            prop_assert!(low <= high);
        }
    }
}
