//! How late a frame came: what a line or a host held back is not the fingertip's state of now.

use std::time::Duration;

/// How long the quickest frame counts, microseconds. The clocks of board and host drift apart by a percent at most: 0.1 s in it.
const WINDOW: i64 = 10_000_000;

/// The board's clock against the host's: the quickest frame of the last two windows sets the difference, any other is late by what it
/// is over. The first frame of a connection cannot be known to be late.
#[derive(Clone, Debug, Default)]
pub(crate) struct BoardClock {
    /// Host less board, microseconds, least in the window before and in this one.
    least: [Option<i64>; 2],
    /// Host time at which this window began, microseconds.
    began: i64,
}

impl BoardClock {
    /// How late the frame of the board's `time` is, which came at `now`, since the start of the host's watch.
    pub(crate) fn lateness(&mut self, time: u64, now: Duration) -> Duration {
        let now = i64::try_from(now.as_micros()).unwrap_or(i64::MAX);
        let difference = now.saturating_sub(i64::try_from(time).unwrap_or(i64::MAX));
        if now.saturating_sub(self.began) > WINDOW {
            self.least = [self.least[1], None];
            self.began = now;
        }
        let here = self.least[1].map_or(difference, |least| least.min(difference));
        self.least[1] = Some(here);
        let least = self.least[0].map_or(here, |before| before.min(here));
        Duration::from_micros(difference.saturating_sub(least).unsigned_abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_that_was_held_back_is_late_by_that() {
        let mut clock = BoardClock::default();
        let mut heard = |time_ms: u64, now_ms| clock.lateness(1000 * time_ms, Duration::from_millis(now_ms));
        assert_eq!(heard(100, 5_103), Duration::ZERO);
        assert_eq!(heard(200, 5_202), Duration::ZERO);
        assert_eq!(heard(300, 5_307), Duration::from_millis(5));
        assert_eq!(heard(400, 10_402), Duration::from_secs(5));
        assert_eq!(heard(5_400, 10_402), Duration::ZERO);
    }

    #[test]
    fn clocks_that_drift_apart_by_a_percent_do_not_make_it_late() {
        let mut clock = BoardClock::default();
        let late = (0..600_u64)
            .map(|i| clock.lateness(99_000 * i, Duration::from_millis(100 * i)))
            .max();
        assert!(late < Some(Duration::from_millis(250)), "{late:?}");
    }
}
