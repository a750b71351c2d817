//! Values that belong to one fingertip and not to its design. The calibration record stores them.

use crate::signal::scale::Scale;
use crate::signal::temperature;
use crate::units::{Centidegrees, Millipascals, Pressure};
use model_tables::block::StoredCalibration;
use model_tables::constants::{Quantity, Transducer};
use model_tables::units::PressureRise;

/// Largest gain trim that is accepted, parts in a million: 10 %.
pub const LARGEST_GAIN: i32 = 100_000;

/// The calibration of one fingertip. The default is no calibration.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Calibration {
    /// The zero, measured on the untouched fingertip, in the transducer's own quantity. `None` uses the zero of the design.
    pub zero: Option<Millipascals>,
    /// The transducer's temperature when that zero was stored; `None` where the part does not measure it.
    pub temperature: Option<Centidegrees>,
    /// Temperature coefficient of the zero, millipascals a kelvin, at most
    /// [`LARGEST_COEFFICIENT`](temperature::LARGEST_COEFFICIENT) either way.
    pub coefficient: i32,
    /// Gain trim: the share added to the pressure rise, parts in a million, at most [`LARGEST_GAIN`] either way.
    pub gain: i32,
}

impl Calibration {
    /// Whether every value is within its limits, for a transducer of this range in pascals.
    pub fn is_plausible(&self, range: [i32; 2]) -> bool {
        let span = i64::from(range[1]) - i64::from(range[0]);
        // A gauge part rests within its range. An absolute part may have an atmosphere in addition.
        let beyond = 1000 * (span + 110_000);
        self.zero.is_none_or(|zero| i64::from(zero.0).abs() <= beyond)
            && self.coefficient.unsigned_abs() <= temperature::LARGEST_COEFFICIENT.unsigned_abs()
            && self.gain.unsigned_abs() <= LARGEST_GAIN.unsigned_abs()
    }

    /// Reads the calibration in a block of a tip's data, for a transducer of this range in pascals. `None` if a value is outside its limits.
    pub fn stored(stored: &StoredCalibration, range: [i32; 2]) -> Option<Self> {
        let temperature = match stored.temperature {
            i32::MIN => None,
            found => Some(Centidegrees(i16::try_from(found).ok()?)),
        };
        let calibration = Self {
            zero: (stored.zero != i32::MIN).then_some(Millipascals(stored.zero)),
            temperature,
            coefficient: stored.coefficient,
            gain: stored.gain,
        };
        calibration.is_plausible(range).then_some(calibration)
    }

    /// This calibration with a new zero. If the old zero was measured at another temperature, the two zeros give the
    /// temperature coefficient. An absolute transducer gives no coefficient, because the air pressure changed between the two
    /// zeros as well. A difference larger than temperature can cause gives none either.
    #[must_use]
    pub fn rezeroed(
        self,
        zero: Millipascals,
        temperature: Option<Centidegrees>,
        transducer: &Transducer,
    ) -> Self {
        let coefficient = match (self.zero, self.temperature, temperature) {
            (Some(before), Some(then), Some(now)) if matches!(transducer.quantity, Quantity::Gauge) => {
                temperature::coefficient([before, zero], [then, now], transducer.range)
                    .unwrap_or(self.coefficient)
            }
            _ => self.coefficient,
        };
        Self {
            zero: Some(zero),
            temperature,
            coefficient,
            ..self
        }
    }

    /// The zero in counts of `1 / 2^fraction_bits` pascal. `None` if no zero is stored.
    pub fn zero_counts(&self, scale: Scale) -> Option<Pressure> {
        self.zero.map(|zero| scale.pressure(zero))
    }
}

/// The gain trim, ready to be applied.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Gain(i32);

impl Gain {
    /// A gain of `1 + trim / 10^6`, `trim` at most [`LARGEST_GAIN`] either way.
    pub const fn new(trim: i32) -> Self {
        // 1.1 * 2^24.
        Self((((1_000_000 + trim as i64) << 24) / 1_000_000) as i32)
    }

    /// Multiplies a rise by the gain. The result saturates at the largest and smallest rise.
    #[inline]
    pub const fn apply_to(self, rise: PressureRise) -> PressureRise {
        // 2^31 * 2^25.
        PressureRise::held((rise.0 as i64 * self.0 as i64) >> 24)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::test_design::TRANSDUCERS;

    #[test]
    fn the_gain_is_a_trim_in_parts_per_million() {
        let apply = |trim, rise| Gain::new(trim).apply_to(PressureRise(rise)).0;
        assert_eq!(apply(0, 123_456_789), 123_456_789);
        assert_eq!(apply(0, i32::MIN), -i32::MAX);
        assert!((apply(25_000, 1_000_000) - 1_025_000).abs() <= 1);
        assert_eq!(apply(LARGEST_GAIN, i32::MAX), i32::MAX);
    }

    #[test]
    fn a_second_zero_at_another_temperature_gives_the_coefficient() {
        let rezeroed = |calibration: Calibration, zero, temperature| {
            calibration.rezeroed(
                Millipascals(zero),
                Some(Centidegrees(temperature)),
                &TRANSDUCERS[0],
            )
        };
        let cold = rezeroed(Calibration::default(), 2_000_000, 2_000);
        assert_eq!(cold.coefficient, 0);
        let warm = rezeroed(cold, 2_020_000, 3_000);
        assert_eq!(
            (warm.coefficient, warm.temperature),
            (2_000, Some(Centidegrees(3_000)))
        );
        let same = rezeroed(warm, 2_021_000, 3_010);
        assert_eq!(same.coefficient, 2_000);
    }

    /// A gauge part has no weather in it but where its vent is blocked. 62.5 Pa/K are twice what the worst part of 100 kPa has.
    #[test]
    fn what_is_too_much_for_temperature_is_no_coefficient_of_a_gauge_part_either() {
        let known = Calibration {
            zero: Some(Millipascals(1_500_000)),
            temperature: Some(Centidegrees(2_000)),
            coefficient: 2_000,
            gain: 0,
        };
        for (zero, coefficient) in [(1_000_000, 2_000), (2_000_000, 2_000), (1_740_000, 30_000)] {
            let warm = known.rezeroed(Millipascals(zero), Some(Centidegrees(2_800)), &TRANSDUCERS[0]);
            assert_eq!(warm.coefficient, coefficient, "{zero}");
            assert_eq!(warm.zero, Some(Millipascals(zero)));
        }
    }

    #[test]
    fn two_zeros_of_an_absolute_transducer_say_nothing_of_temperature() {
        let zeroed = |calibration: Calibration, zero, temperature| {
            calibration.rezeroed(
                Millipascals(zero),
                Some(Centidegrees(temperature)),
                &TRANSDUCERS[3],
            )
        };
        // 8 K and 5 hPa of weather apart.
        let cold = zeroed(Calibration::default(), 101_300_000, 2_000);
        let warm = zeroed(cold, 100_800_000, 2_800);
        assert_eq!(warm.coefficient, 0);
        assert_eq!(warm.zero, Some(Millipascals(100_800_000)));
    }

    #[test]
    fn a_blocks_calibration_is_read_with_its_range() {
        let stored = StoredCalibration {
            zero: 20_000_000,
            temperature: -1_550,
            coefficient: 7,
            gain: -LARGEST_GAIN,
        };
        let read = |stored| Calibration::stored(&stored, [0, 100_000]);
        let expected = Calibration {
            zero: Some(Millipascals(20_000_000)),
            temperature: Some(Centidegrees(-1_550)),
            coefficient: 7,
            gain: -LARGEST_GAIN,
        };
        assert_eq!(read(stored), Some(expected));
        let none = StoredCalibration {
            zero: i32::MIN,
            temperature: i32::MIN,
            ..stored
        };
        let read_none = read(none).expect("it is plausible");
        assert_eq!((read_none.zero, read_none.temperature), (None, None));
        for wrong in [
            StoredCalibration {
                temperature: 40_000,
                ..stored
            },
            StoredCalibration {
                gain: LARGEST_GAIN + 1,
                ..stored
            },
        ] {
            assert_eq!(read(wrong), None, "{wrong:?}");
        }
    }

    #[test]
    fn values_that_cannot_be_are_not_believed() {
        let range = [0, 100_000];
        let calibration = Calibration::default();
        assert!(calibration.is_plausible(range));
        for wrong in [
            Calibration {
                zero: Some(Millipascals(211_000_000)),
                ..calibration
            },
            Calibration {
                gain: LARGEST_GAIN + 1,
                ..calibration
            },
            Calibration {
                coefficient: i32::MIN,
                ..calibration
            },
        ] {
            assert!(!wrong.is_plausible(range), "{wrong:?}");
        }
    }
}
