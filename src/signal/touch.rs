//! Pressure rise -> touched or not. There are two thresholds, so that noise between them changes nothing. Both are raised by the
//! largest error of the zero. Between them, touch is unknown.

use crate::status::Touch;
use crate::units::Pressure;
use model_tables::constants::DesignConstants;
use model_tables::units::PressureRise;

/// A touch begins above this rise, in noise floors of the transducer. Noise alone lifts fewer than one filtered report in 10^15
/// above it.
const TOUCH_FLOORS: i64 = 6;

/// A touch ends below this rise, in noise floors of the transducer.
const RELEASE_FLOORS: i64 = 3;

/// Thresholds at which a touch begins and ends, counts.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Thresholds {
    /// Above this rise the fingertip is touched.
    pub touch: PressureRise,
    /// Below this rise the touch has ended.
    pub release: PressureRise,
}

impl Thresholds {
    /// The thresholds of a design.
    pub const fn of(constants: &DesignConstants, fraction_bits: u32) -> Self {
        let floor = constants.transducer.noise_floor();
        Self {
            touch: PressureRise(Pressure::from_millipascals(floor * TOUCH_FLOORS, fraction_bits).0),
            release: PressureRise(Pressure::from_millipascals(floor * RELEASE_FLOORS, fraction_bits).0),
        }
    }
}

/// Holds the touch state between the two thresholds.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct TouchDetector {
    thresholds: Thresholds,
    touched: bool,
}

impl TouchDetector {
    /// A detector in the untouched state.
    pub const fn new(thresholds: Thresholds) -> Self {
        Self {
            thresholds,
            touched: false,
        }
    }

    /// Whether the fingertip is touched at a filtered rise over a zero that may be higher by `above` counts, >= 0.
    #[inline]
    pub fn step(&mut self, rise: PressureRise, above: i32, zero_is_verified: bool) -> Touch {
        let rise = rise.0.saturating_sub(above);
        let Thresholds { touch, release } = self.thresholds;
        self.touched = rise > if self.touched { release.0 } else { touch.0 };
        if self.touched {
            Touch::Touched
        } else if zero_is_verified && rise <= release.0 {
            Touch::Untouched
        } else {
            Touch::Unknown
        }
    }

    /// Forgets the touch. Called if the zero moved, or if a quiet window lay below the upper threshold, where a release may
    /// have ended.
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
    fn the_thresholds_are_six_and_three_noise_floors() {
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
        let states = [0, 60, 61, 31, 30, 60, 61].map(|rise| detector.step(PressureRise(rise), 0, true));
        let (on, off, unknown) = (Touch::Touched, Touch::Untouched, Touch::Unknown);
        assert_eq!(states, [off, unknown, on, on, off, unknown, on]);
    }

    #[test]
    fn what_the_zero_may_be_above_is_no_touch() {
        let mut detector = TouchDetector::new(THRESHOLDS);
        let states = [61, 110, 111, 81, 80].map(|rise| detector.step(PressureRise(rise), 50, true));
        let (on, off, unknown) = (Touch::Touched, Touch::Untouched, Touch::Unknown);
        assert_eq!(states, [off, unknown, on, on, off]);
    }

    #[test]
    fn a_still_stretch_between_the_thresholds_is_not_known_to_be_a_touch() {
        let mut detector = TouchDetector::new(THRESHOLDS);
        assert_eq!(detector.step(PressureRise(61), 0, true), Touch::Touched);
        assert_eq!(detector.step(PressureRise(45), 0, true), Touch::Touched);
        detector.forget();
        assert_eq!(detector.step(PressureRise(45), 0, true), Touch::Unknown);
    }

    #[test]
    fn without_a_verified_zero_no_touch_is_not_claimed() {
        let mut detector = TouchDetector::new(THRESHOLDS);
        assert_eq!(detector.step(PressureRise(0), 0, false), Touch::Unknown);
        assert_eq!(detector.step(PressureRise(61), 0, false), Touch::Touched);
    }

    proptest! {
        #[test]
        fn noise_narrower_than_the_gap_toggles_at_most_once(centre in -200..200_i32, noise in prop::collection::vec(-14..=14_i32, 1..200)) {
            let mut detector = TouchDetector::new(THRESHOLDS);
            let states: Vec<Touch> =
                noise.iter().map(|noise| detector.step(PressureRise(centre + noise), 0, true)).collect();
            let touched: Vec<bool> = states.iter().map(|state| *state == Touch::Touched).collect();
            prop_assert!(touched.windows(2).filter(|pair| pair[0] != pair[1]).count() <= 1);
        }
    }
}
