//! Pressure rise -> is the fingertip touched? Two thresholds, so that noise between them changes nothing.

use crate::status::Touch;
use crate::units::Pressure;
use model_tables::constants::DesignConstants;
use model_tables::units::PressureRise;

/// A touch begins above this rise, in grains of the transducer (its noise or its resolution): a filtered report
/// gets there by noise alone less than once in 10^15.
const TOUCH_GRAINS: i64 = 6;

/// And ends below this one.
const RELEASE_GRAINS: i64 = 3;

/// Where a touch begins and ends, counts.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Thresholds {
    /// Above: touched.
    pub touch: PressureRise,
    /// Below: no longer.
    pub release: PressureRise,
}

impl Thresholds {
    /// The thresholds of a design.
    pub const fn of(constants: &DesignConstants, fraction_bits: u32) -> Self {
        let grain = constants.transducer.grain();
        Self {
            touch: PressureRise(Pressure::from_millipascals(grain * TOUCH_GRAINS, fraction_bits).0),
            release: PressureRise(Pressure::from_millipascals(grain * RELEASE_GRAINS, fraction_bits).0),
        }
    }
}

/// Remembers on which side of the thresholds it was last.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct TouchDetector {
    thresholds: Thresholds,
    touched: bool,
}

impl TouchDetector {
    /// Nothing has touched yet.
    pub const fn new(thresholds: Thresholds) -> Self {
        Self {
            thresholds,
            touched: false,
        }
    }

    /// Whether the fingertip is touched at a filtered rise.
    #[inline]
    pub fn step(&mut self, rise: PressureRise, zero_is_verified: bool) -> Touch {
        let threshold = if self.touched {
            self.thresholds.release
        } else {
            self.thresholds.touch
        };
        self.touched = rise > threshold;
        if self.touched {
            Touch::Touched
        } else if zero_is_verified {
            Touch::Untouched
        } else {
            Touch::Unknown
        }
    }

    /// The zero moved: what was known of the side is void.
    pub fn forget(&mut self) {
        self.touched = false;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::test_design::Linear;
    use proptest::prelude::*;

    const THRESHOLDS: Thresholds = Thresholds {
        touch: PressureRise(60),
        release: PressureRise(30),
    };

    #[test]
    fn the_thresholds_are_six_and_three_grains() {
        // 10 Pa at 1/256 Pa.
        assert_eq!(
            Thresholds::of(&Linear::CONSTANTS, 8),
            Thresholds {
                touch: PressureRise(15_360),
                release: PressureRise(7_680)
            }
        );
    }

    #[test]
    fn between_the_thresholds_nothing_changes() {
        let mut detector = TouchDetector::new(THRESHOLDS);
        let states = [0, 60, 61, 31, 30, 60, 61].map(|rise| detector.step(PressureRise(rise), true));
        let (on, off) = (Touch::Touched, Touch::Untouched);
        assert_eq!(states, [off, off, on, on, off, off, on]);
    }

    #[test]
    fn without_a_verified_zero_no_touch_is_not_claimed() {
        let mut detector = TouchDetector::new(THRESHOLDS);
        assert_eq!(detector.step(PressureRise(0), false), Touch::Unknown);
        assert_eq!(detector.step(PressureRise(61), false), Touch::Touched);
    }

    proptest! {
        #[test]
        fn noise_narrower_than_the_gap_toggles_at_most_once(centre in -200..200_i32, noise in prop::collection::vec(-14..=14_i32, 1..200)) {
            let mut detector = TouchDetector::new(THRESHOLDS);
            let states: Vec<Touch> =
                noise.iter().map(|noise| detector.step(PressureRise(centre + noise), true)).collect();
            prop_assert!(states.windows(2).filter(|pair| pair[0] != pair[1]).count() <= 1);
        }
    }
}
