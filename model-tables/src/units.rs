//! The quantities between the chip's stages: one integer newtype each.

/// Pressure over the rest pressure, in counts of `1 / 2^k` pascal.
///
/// `k` belongs to a design and is [`crate::table::Layout::fraction_bits`]. From `-(2^31 - 1)` to `2^31 - 1`, so that the
/// lookup can take a rise from any that is not negative and stay in the word.
#[derive(Clone, Copy, Debug, Default, Eq, Ord, PartialEq, PartialOrd)]
pub struct PressureRise(pub i32);

impl PressureRise {
    /// The nearest rise to a number of counts.
    #[inline]
    pub const fn held(counts: i64) -> Self {
        const MAX_COUNTS: i64 = i32::MAX as i64;
        Self(if counts > MAX_COUNTS {
            i32::MAX
        } else if counts < -MAX_COUNTS {
            -i32::MAX
        } else {
            counts as i32
        })
    }

    /// The nearest count to a pressure rise in pascals, held at the ends of what a rise can be (NaN gives 0).
    pub fn from_pascals(pascals: f64, fraction_bits: u32) -> Self {
        // A float to integer cast saturates.
        Self::held(libm::round(libm::ldexp(pascals, fraction_bits as i32)) as i64)
    }

    /// The pressure rise in pascals.
    pub fn pascals(self, fraction_bits: u32) -> f64 {
        libm::ldexp(f64::from(self.0), -(fraction_bits as i32))
    }
}

/// Force, micronewtons; a table gives 0 up to its last value.
#[derive(Clone, Copy, Debug, Default, Eq, Ord, PartialEq, PartialOrd)]
pub struct Micronewtons(pub i32);

impl Micronewtons {
    /// Micronewtons in a newton.
    pub const PER_NEWTON: f64 = 1e6;

    /// The force in newtons.
    pub fn newtons(self) -> f64 {
        f64::from(self.0) / Self::PER_NEWTON
    }
}

/// Indentation of the fingertip's pole, nanometres; a table gives 0 up to its last value.
#[derive(Clone, Copy, Debug, Default, Eq, Ord, PartialEq, PartialOrd)]
pub struct Nanometres(pub i32);

impl Nanometres {
    /// Nanometres in a metre.
    pub const PER_METRE: f64 = 1e9;

    /// The indentation in metres.
    pub fn metres(self) -> f64 {
        f64::from(self.0) / Self::PER_METRE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rise_is_counted_in_fractions_of_a_pascal() {
        assert_eq!(PressureRise::from_pascals(642.0, 8), PressureRise(164_352));
        assert_eq!(PressureRise::from_pascals(-0.26, 2), PressureRise(-1));
        assert!((PressureRise(-3).pascals(1) + 1.5).abs() < 1e-15);
    }

    #[test]
    fn a_rise_beyond_the_word_is_held() {
        assert_eq!(PressureRise::from_pascals(1e300, 8), PressureRise(i32::MAX));
        assert_eq!(
            PressureRise::from_pascals(f64::NEG_INFINITY, 0),
            PressureRise(-i32::MAX)
        );
        assert_eq!(PressureRise::from_pascals(f64::NAN, 8), PressureRise(0));
    }
}
