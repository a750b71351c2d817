//! Detects a code that does not change for too long: noise would change it if the transducer still measured.
//!
//! This applies only to codes so fine that noise must change them (24 bits). An averaged converter of 12 bits can repeat a code.

use crate::status::Fault;
use crate::units::Microseconds;

/// A word that is unchanged for this long is stuck, microseconds: 35 samples of the slowest part. Every 24-bit part has noise
/// of more than two counts. With two counts, a word repeats by chance once in seven samples, and 35 times in a row less than
/// once in 10^24.
pub const LIMIT: u64 = 500_000;

/// Holds the last word and the time of its first sample.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct StuckDetector {
    last: Option<(u32, Microseconds)>,
}

impl StuckDetector {
    /// A detector without any sample yet.
    pub const NEW: Self = Self { last: None };

    /// Checks the word of a sample. `word` is `None` for a transducer that has none.
    ///
    /// # Errors
    /// [`Fault::Stuck`] from [`LIMIT`] after the word last changed until it changes again.
    #[inline]
    pub fn step(&mut self, time: Microseconds, word: Option<u32>) -> Result<(), Fault> {
        let Some(word) = word else { return Ok(()) };
        match self.last {
            Some((last, since)) if last == word => {
                if time.0.saturating_sub(since.0) >= LIMIT {
                    return Err(Fault::Stuck);
                }
            }
            _ => self.last = Some((word, time)),
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn half_a_second_of_the_same_word_is_stuck_and_a_new_word_is_not() {
        let mut detector = StuckDetector::NEW;
        let mut at = |ms: u64, word| detector.step(Microseconds(ms * 1000), Some(word));
        assert_eq!(at(0, 7), Ok(()));
        assert_eq!(at(499, 7), Ok(()));
        assert_eq!(at(500, 7), Err(Fault::Stuck));
        assert_eq!(at(9_000, 7), Err(Fault::Stuck));
        assert_eq!(at(9_007, 8), Ok(()));
        assert_eq!(at(9_506, 8), Ok(()));
        assert_eq!(at(9_507, 8), Err(Fault::Stuck));
    }

    #[test]
    fn a_transducer_without_a_fine_word_is_never_stuck() {
        let mut detector = StuckDetector::NEW;
        assert!((0..100).all(|s| detector.step(Microseconds(s * 1_000_000), None).is_ok()));
    }

    proptest! {
        #[test]
        fn a_word_that_changes_in_time_is_never_stuck(steps in prop::collection::vec((0..LIMIT, 1_u32..9), 0..100)) {
            let (mut detector, mut time, mut word) = (StuckDetector::NEW, 0, 0_u32);
            for (later, change) in steps {
                time += later;
                word = word.wrapping_add(change);
                prop_assert_eq!(detector.step(Microseconds(time), Some(word)), Ok(()));
            }
        }
    }
}
