//! Temperature of the transducer -> offset of the zero, for a transducer that measures its temperature.
//!
//! The coefficient comes from the calibration record, where two saved zeros at different temperatures give it. In contact the
//! correction is held, so that only pressure changes the force. The error of the held correction is part of the 1-sigma, and is
//! reported if it is as large as a touch.

use crate::status::Touch;
use crate::units::{Centidegrees, Millipascals, saturate};

/// Largest coefficient that is accepted, millipascals a kelvin: 0.1 % of 100 kPa.
pub const LARGEST_COEFFICIENT: i32 = 100_000;

/// Largest coefficient from two zeros, millionths of the transducer's range a kelvin. The offset of an NXP MPX5100 may move by
/// 2.5 % of its range over 85 K. A day's weather in a blocked vent gives a larger value.
const LARGEST_SHARE: i64 = 300;

/// Smallest temperature difference at which two saved zeros give a coefficient, hundredths of a kelvin.
const APART: i32 = 500;

/// The compensation.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Temperature {
    /// In `2^-16` counts for a hundredth of a kelvin.
    coefficient: i64,
    /// Temperature at which the correction is 0: that of the stored zero.
    reference: Option<Centidegrees>,
    correction: i32,
    missed: i32,
}

impl Temperature {
    /// No compensation.
    pub const NONE: Self = Self {
        coefficient: 0,
        reference: None,
        correction: 0,
        missed: 0,
    };

    /// The compensation for `coefficient` millipascals a kelvin around the temperature of the stored zero, in counts of
    /// `1 / 2^fraction_bits` pascal.
    pub const fn new(coefficient: i32, reference: Option<Centidegrees>, fraction_bits: u32) -> Self {
        // 2^17 * 2^16 * 2^16 / 10^5.
        let coefficient = ((coefficient as i64) << (fraction_bits + 16)) / 100_000;
        Self {
            coefficient,
            reference,
            ..Self::NONE
        }
    }

    /// Offset of the zero by temperature, counts.
    pub const fn correction(&self) -> i32 {
        self.correction
    }

    /// Error of the held correction, counts.
    pub const fn missed(&self) -> i32 {
        self.missed
    }

    /// Takes the next temperature.
    #[inline]
    pub fn step(&mut self, temperature: Option<Centidegrees>, touch: Touch) {
        let (Some(temperature), Some(reference)) = (temperature, self.reference) else {
            return;
        };
        let over = i64::from(temperature.0) - i64::from(reference.0);
        // 2^17 * 2^34.
        let due = saturate((over * self.coefficient) >> 16);
        if touch == Touch::Touched {
            self.missed = due.saturating_sub(self.correction).saturating_abs();
        } else {
            self.correction = due;
            self.missed = 0;
        }
    }
}

/// The coefficient from two zeros at two temperatures, millipascals a kelvin. `None` if the temperatures are too close, or if
/// the coefficient is larger than temperature alone can cause in a transducer of this range in pascals.
pub fn coefficient(
    [before, after]: [Millipascals; 2],
    [then, now]: [Centidegrees; 2],
    [from, to]: [i32; 2],
) -> Option<i32> {
    let apart = i64::from(now.0) - i64::from(then.0);
    if apart.abs() < i64::from(APART) {
        return None;
    }
    // 2^32 * 100 over at least 500.
    let coefficient = ((i64::from(after.0) - i64::from(before.0)) * 100).checked_div(apart)?;
    // In thousandths of a pascal, as the share is.
    let largest = (i64::from(to) - i64::from(from)) * LARGEST_SHARE / 1000;
    i32::try_from(coefficient).ok().filter(|coefficient| {
        i64::from(coefficient.abs()) <= largest && coefficient.abs() <= LARGEST_COEFFICIENT
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Pascals.
    const RANGE: [i32; 2] = [0, 100_000];

    #[test]
    fn the_correction_is_the_coefficient_times_the_difference() {
        // 2 Pa/K around 25 degC, at 1/256 Pa: 10 K are 5120 counts.
        let mut temperature = Temperature::new(2_000, Some(Centidegrees(2_500)), 8);
        temperature.step(Some(Centidegrees(3_500)), Touch::Untouched);
        assert!((temperature.correction() - 5_120).abs() <= 1);
        temperature.step(Some(Centidegrees(2_000)), Touch::Unknown);
        assert!((temperature.correction() + 2_560).abs() <= 1);
    }

    #[test]
    fn in_contact_it_is_held_and_what_it_misses_is_known() {
        let mut temperature = Temperature::new(2_000, Some(Centidegrees(2_500)), 8);
        temperature.step(Some(Centidegrees(2_500)), Touch::Untouched);
        temperature.step(Some(Centidegrees(3_500)), Touch::Touched);
        assert_eq!(temperature.correction(), 0);
        assert!((temperature.missed() - 5_120).abs() <= 1);
        temperature.step(Some(Centidegrees(3_500)), Touch::Untouched);
        assert!((temperature.correction() - 5_120).abs() <= 1);
        assert_eq!(temperature.missed(), 0);
    }

    #[test]
    fn without_a_temperature_or_a_reference_there_is_no_correction() {
        let mut temperature = Temperature::new(2_000, None, 8);
        temperature.step(Some(Centidegrees(3_500)), Touch::Untouched);
        assert_eq!(temperature.correction(), 0);
        let mut temperature = Temperature::new(2_000, Some(Centidegrees(0)), 8);
        temperature.step(None, Touch::Untouched);
        assert_eq!(temperature.correction(), 0);
    }

    #[test]
    fn two_zeros_far_enough_apart_give_the_coefficient() {
        let zeros = [Millipascals(0), Millipascals(10_000)];
        let at = |cold, warm| [Centidegrees(cold), Centidegrees(warm)];
        assert_eq!(coefficient(zeros, at(2_000, 2_500), RANGE), Some(2_000));
        assert_eq!(coefficient(zeros, at(2_500, 2_000), RANGE), Some(-2_000));
        assert_eq!(coefficient(zeros, at(2_000, 2_499), RANGE), None);
        // 5 kPa in 5 K is no temperature.
        assert_eq!(
            coefficient(
                [Millipascals(0), Millipascals(5_000_000)],
                at(2_000, 2_500),
                RANGE
            ),
            None
        );
    }

    proptest! {
        #[test]
        fn nothing_overflows(
            coefficient in any::<i32>(), bits in 0..17_u32, a in any::<i16>(), b in any::<i16>(), p in any::<[i32; 2]>(),
        ) {
            let mut temperature = Temperature::new(coefficient, Some(Centidegrees(a)), bits);
            temperature.step(Some(Centidegrees(b)), Touch::Untouched);
            temperature.step(Some(Centidegrees(a)), Touch::Touched);
            let _ = super::coefficient(p.map(Millipascals), [Centidegrees(a), Centidegrees(b)], RANGE);
        }
    }
}
