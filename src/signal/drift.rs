//! How far the zero has drifted since it was taken: followed while nothing touches, frozen in contact.
//!
//! Drift is slow and a touch is not: the follower moves by no more than `Pace::rate`, only after a second untouched,
//! and only while the rise is within [`Pace::band`], where force is not to be trusted anyway. So a sustained grasp
//! is never eaten, whatever its length, and a press so slow and so light that it passes for drift costs at most the
//! band. Beyond [`Pace::reach`] it does not go.
//!
//! While it may not follow, what it misses grows with time: that is part of every reading's 1-sigma, and once it
//! could pass for a touch the reading says "zero aged".

use crate::signal::touch::Thresholds;
use crate::status::Touch;
use crate::units::Microseconds;
use model_tables::constants::{DesignConstants, Quantity};
use model_tables::units::PressureRise;

/// Untouched for this long before it follows, microseconds: a release is over by then.
const SETTLE: u64 = 1_000_000;

/// Neither touched nor near zero for this long, microseconds: drift that is too fast to be followed.
const DOUBT: u64 = 60_000_000;

/// The share of the rise that is taken as drift at each step: with a millisecond to a step, a time constant of 1 s.
const SHARE_SHIFT: u32 = 10;

/// Longest step that is followed, microseconds: what happened in a gap is not known.
const LONGEST_STEP: u64 = 20_000;

/// Fraction bits of the offset.
const FRACTION: u32 = 32;

/// Fastest drift that is followed, millipascals a second, for a gauge transducer: ten times the wandering of a
/// bridge that is held in the hand (0.5 % of 100 kPa in 10 min).
const GAUGE_RATE: i64 = 500;

/// And for an absolute one: 8 m of stairs in 25 s.
const ABSOLUTE_RATE: i64 = 4_000;

/// One standard deviation of what is left of drift after compensation, millipascals an hour: a gauge bridge at a
/// steady temperature.
pub const GAUGE_SIGMA: i64 = 2_000;

/// And for an absolute transducer: the weather, 1 hPa an hour as a front passes.
pub const ABSOLUTE_SIGMA: i64 = 100_000;

/// How fast and how far drift is followed.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Pace {
    /// Rises between which it follows, counts. Nothing presses with less than nothing, so the lower end is further.
    pub band: [i32; 2],
    /// Fastest, `2^-32` counts a microsecond.
    rate: i64,
    /// Furthest from the zero, counts.
    pub reach: i32,
    /// Missed while not following, one standard deviation, `2^-32` counts a microsecond.
    sigma: i64,
    /// Missed by so much, it could pass for a touch: counts.
    touch: i32,
}

impl Pace {
    /// The pace for a design; `reach` is how far the zero may move, counts.
    pub const fn of(constants: &DesignConstants, fraction_bits: u32, reach: i32) -> Self {
        // A step more stays within the word of the offset.
        let longest = i32::MAX / 2;
        let (rate, sigma) = match constants.transducer.quantity {
            Quantity::Gauge => (GAUGE_RATE, GAUGE_SIGMA),
            Quantity::Absolute => (ABSOLUTE_RATE, ABSOLUTE_SIGMA),
        };
        let thresholds = Thresholds::of(constants, fraction_bits);
        let lowest = constants.transducer.lowest_rest(fraction_bits).0;
        Self {
            band: [lowest, thresholds.release.0],
            rate: per_microsecond(rate, fraction_bits, 1_000_000),
            reach: if reach < longest { reach } else { longest },
            sigma: per_microsecond(sigma, fraction_bits, 3_600_000_000),
            touch: thresholds.touch.0,
        }
    }
}

/// Millipascals in `microseconds` to `2^-32` counts in one. At most 10^5 * 2^16 * 2^32 on the way: 128 bits, by
/// the compiler alone.
const fn per_microsecond(millipascals: i64, fraction_bits: u32, microseconds: i128) -> i64 {
    (((millipascals as i128) << (fraction_bits + FRACTION)) / 1000 / microseconds) as i64
}

/// The follower.
#[derive(Clone, Debug)]
pub struct Drift {
    pace: Pace,
    /// Counts with [`FRACTION`] more bits; |offset| <= reach.
    offset: i64,
    last: Microseconds,
    /// Since when nothing touches.
    untouched: Option<Microseconds>,
    /// When it followed last.
    followed: Option<Microseconds>,
}

impl Drift {
    /// No drift yet.
    pub const fn new(pace: Pace) -> Self {
        Self {
            pace,
            offset: 0,
            last: Microseconds(0),
            untouched: None,
            followed: None,
        }
    }

    /// Drift since the zero was taken, counts.
    #[inline]
    pub const fn counts(&self) -> i32 {
        (self.offset >> FRACTION) as i32
    }

    /// The zero was taken at this instant.
    pub fn reset(&mut self, time: Microseconds) {
        *self = Self::new(self.pace);
        self.last = time;
        self.followed = Some(time);
    }

    /// One filtered rise later; whether it is followed.
    #[inline]
    pub fn step(&mut self, time: Microseconds, rise: PressureRise, touch: Touch) {
        let passed = time.0.saturating_sub(self.last.0).min(LONGEST_STEP);
        self.last = time;
        let [lowest, highest] = self.pace.band;
        if touch != Touch::Untouched {
            self.untouched = None;
            return;
        }
        let untouched = *self.untouched.get_or_insert(time);
        if time.0.saturating_sub(untouched.0) < SETTLE || rise.0 < lowest || rise.0 > highest {
            return;
        }
        self.followed = Some(time);
        // |rise| < 2^24 here (the band), rate * passed < 2^45.
        let most = self.pace.rate * passed as i64;
        let step = (i64::from(rise.0) << (FRACTION - SHARE_SHIFT)).clamp(-most, most);
        let reach = i64::from(self.pace.reach) << FRACTION;
        self.offset = (self.offset + step).clamp(-reach, reach);
    }

    /// What may have been missed since it followed last: one standard deviation, counts; and whether that is no
    /// longer negligible.
    #[inline]
    pub fn missed(&self, time: Microseconds, touch: Touch) -> (i32, bool) {
        let Some(followed) = self.followed else {
            return (0, false);
        };
        let unfollowed = time.0.saturating_sub(followed.0);
        if unfollowed < SETTLE {
            return (0, false);
        }
        // Below 2^37 (38 h) * 2^26.
        let missed = (unfollowed.min(1 << 37) as i64 * self.pace.sigma) >> FRACTION;
        let missed = missed.min(i64::from(i32::MAX)) as i32;
        let doubtful = touch == Touch::Untouched && unfollowed >= DOUBT;
        (missed, missed >= self.pace.touch || doubtful)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::test_design::Linear;
    use proptest::prelude::*;

    /// 1/256 Pa a count; follows between -80 and 30 Pa at 0.5 Pa/s, to 2500 Pa.
    fn drift() -> Drift {
        Drift::new(Pace::of(&Linear::CONSTANTS, 8, 2_500 << 8))
    }

    fn run(drift: &mut Drift, from: u64, to: u64, rise: impl Fn(u64) -> i32, touch: Touch) {
        for ms in from..to {
            drift.step(
                Microseconds(ms * 1000),
                PressureRise(rise(ms) - drift.counts()),
                touch,
            );
        }
    }

    #[test]
    fn slow_drift_is_followed() {
        let mut drift = drift();
        drift.reset(Microseconds(0));
        // 0.3 Pa/s for 100 s; the first second is not followed.
        run(
            &mut drift,
            0,
            100_000,
            |ms| (ms as i32 * 77) / 1000,
            Touch::Untouched,
        );
        let pascals = f64::from(drift.counts()) / 256.0;
        assert!((pascals - 30.0).abs() < 1.0, "{pascals}");
    }

    #[test]
    fn it_is_never_faster_than_its_rate() {
        let mut drift = drift();
        drift.reset(Microseconds(0));
        run(&mut drift, 0, 11_000, |_| 29 << 8, Touch::Untouched);
        // 10 s at 0.5 Pa/s.
        assert!((f64::from(drift.counts()) / 256.0 - 5.0).abs() < 0.1);
    }

    #[test]
    fn a_touch_of_any_length_is_never_eaten() {
        let mut drift = drift();
        drift.reset(Microseconds(0));
        run(&mut drift, 0, 100_000, |_| 20 << 8, Touch::Touched);
        run(&mut drift, 100_000, 200_000, |_| 31 << 8, Touch::Untouched);
        assert_eq!(drift.counts(), 0);
    }

    #[test]
    fn a_gap_counts_as_twenty_milliseconds() {
        let mut drift = drift();
        drift.reset(Microseconds(0));
        drift.step(Microseconds(0), PressureRise(0), Touch::Untouched);
        drift.step(
            Microseconds(3_600_000_000),
            PressureRise(29 << 8),
            Touch::Untouched,
        );
        // 0.5 Pa/s for 20 ms are 2.56 counts.
        assert!(drift.counts() <= 3);
    }

    #[test]
    fn what_is_missed_grows_with_time_and_is_said_once_it_could_be_a_touch() {
        let mut drift = drift();
        drift.reset(Microseconds(0));
        let at = |hours: u64| drift.missed(Microseconds(hours * 3_600_000_000), Touch::Touched);
        // 2 Pa an hour; a touch is 60 Pa, so 30 h.
        assert!((at(8).0 - (16 << 8)).abs() <= 8, "{:?}", at(8));
        assert!(!at(29).1 && at(31).1);
    }

    #[test]
    fn an_offset_that_is_no_touch_and_not_followed_is_doubted_after_a_minute() {
        let mut drift = drift();
        drift.reset(Microseconds(0));
        run(&mut drift, 0, 61_000, |_| 40 << 8, Touch::Untouched);
        assert_eq!(drift.counts(), 0);
        assert!(drift.missed(Microseconds(61_000_000), Touch::Untouched).1);
        assert!(!drift.missed(Microseconds(59_000_000), Touch::Untouched).1);
    }

    proptest! {
        #[test]
        fn it_keeps_to_its_reach_and_its_rate_whatever_comes(
            steps in prop::collection::vec((0..100_000_u64, any::<i32>(), 0..3_usize), 1..400),
        ) {
            let mut drift = drift();
            let mut time = 0;
            for (passed, rise, touch) in steps {
                time += passed;
                let before = drift.offset;
                let touch = Touch::CODES[touch].0;
                drift.step(Microseconds(time), PressureRise(rise), touch);
                let most = drift.pace.rate * passed.min(LONGEST_STEP) as i64;
                prop_assert!((drift.offset - before).abs() <= most);
                prop_assert!(touch == Touch::Untouched || drift.offset == before);
                prop_assert!(drift.counts().abs() <= drift.pace.reach);
                let _ = drift.missed(Microseconds(time), touch);
            }
        }
    }
}
