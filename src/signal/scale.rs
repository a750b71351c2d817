//! Millipascals -> pressure in the design's own unit, in which its tables are indexed.

use crate::units::{Millipascals, Pressure, saturate};

/// From millipascals to counts without a division: `counts = (gain * millipascals + half) / 2^shift`.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Scale {
    /// `2^(k + shift) / 1000`, rounded to nearest: 30 bits and the sign. The rounding changes a result by at most 2^-30 of
    /// itself.
    gain: i32,
    /// 23 to 39 for `k` of 16 to 0.
    shift: u32,
}

impl Scale {
    /// To counts of `1 / 2^fraction_bits` pascal.
    ///
    /// # Panics
    /// At compile time, for more than 16 bits.
    pub const fn of(fraction_bits: u32) -> Self {
        assert!(fraction_bits <= 16, "the unit is out of reason");
        // 2^39 / 1000 = 549 755 814 is below 2^30 and above 2^29.
        Self {
            gain: (((1_i64 << 39) + 500) / 1000) as i32,
            shift: 39 - fraction_bits,
        }
    }

    /// The nearest count. It saturates at the ends of the word.
    #[inline]
    pub const fn pressure(self, millipascals: Millipascals) -> Pressure {
        // Below 2^30 * 2^31 = 2^61.
        let scaled = self.gain as i64 * millipascals.0 as i64 + (1 << (self.shift - 1));
        Pressure(saturate(scaled >> self.shift))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn millipascals_are_rounded_to_counts_and_held() {
        assert_eq!(Pressure::from_millipascals(1500, 1), Pressure(3));
        assert_eq!(Pressure::from_millipascals(-1500, 1), Pressure(-3));
        assert_eq!(Pressure::from_pascals(i32::MAX, 16), Pressure(i32::MAX));
        assert_eq!(Pressure::from_pascals(i32::MIN, 16), Pressure(i32::MIN));
        assert_eq!(Scale::of(16).pressure(Millipascals(i32::MAX)), Pressure(i32::MAX));
        assert_eq!(Scale::of(8).pressure(Millipascals(1_000_000)), Pressure(256_000));
    }

    proptest! {
        #[test]
        fn every_pressure_becomes_the_nearest_count(millipascals in any::<i32>(), fraction_bits in 0_u32..=16) {
            let exact = f64::from(millipascals) * f64::from(1_u32 << fraction_bits) / 1000.0;
            let Pressure(counts) = Scale::of(fraction_bits).pressure(Millipascals(millipascals));
            let held = exact.clamp(f64::from(i32::MIN), f64::from(i32::MAX));
            // Half a count, and the gain's rounding: 2^-30 of the result.
            let allowed = 0.500_001 + exact.abs() / f64::from(1 << 30);
            prop_assert!((f64::from(counts) - held).abs() <= allowed, "{counts} for {exact}");
        }
    }
}
