//! How late a frame came: what a line or a host held back is not the fingertip's state of now.

use std::time::Duration;

/// A silence longer than this may hold frames back, microseconds; a backlog is through sooner.
const HELD: i64 = 500_000;

/// What a silence held back: after it the board's clock has advanced by less than the host's, and catches up in a burst. A board
/// whose clock only runs slower, as an emulated one may, is not late.
#[derive(Clone, Debug, Default)]
pub(crate) struct BoardClock {
    /// Board and host time of the latest frame, microseconds.
    latest: Option<[i64; 2]>,
    /// How late it was, microseconds.
    late: i64,
    /// Host time at which that changed last, microseconds.
    changed: i64,
}

impl BoardClock {
    /// How late the frame of the board's `time` (microseconds) is, which came at `now`, since the start of the host's watch.
    pub(crate) fn lateness(&mut self, time: u64, now: Duration) -> Duration {
        let now = i64::try_from(now.as_micros()).unwrap_or(i64::MAX);
        let time = i64::try_from(time).unwrap_or(i64::MAX);
        if let Some([board, host]) = self.latest.replace([time, now]) {
            let silence = now.saturating_sub(host);
            let behind = silence.saturating_sub(time.saturating_sub(board));
            if silence > HELD || (self.late > 0 && behind < 0) {
                self.late = self.late.saturating_add(behind).max(0);
                self.changed = now;
            } else if now.saturating_sub(self.changed) > HELD {
                // No backlog takes so long: the board stood still.
                self.late = 0;
            }
        }
        Duration::from_micros(self.late.unsigned_abs())
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
        assert_eq!(heard(300, 5_307), Duration::ZERO);
        assert_eq!(heard(400, 10_402), Duration::from_millis(4_995));
        assert_eq!(heard(5_400, 10_402), Duration::ZERO);
    }

    #[test]
    fn a_board_that_runs_at_a_third_of_the_pace_is_not_late_for_long() {
        let mut clock = BoardClock::default();
        let mut late = Duration::ZERO;
        for i in 0..300_u64 {
            // It stands still for 0.8 s in the middle.
            let pause = if i < 150 { 0 } else { 800 };
            let now = Duration::from_millis(30 * i + pause);
            let one = clock.lateness(10_000 * i, now);
            if !(150..=170).contains(&i) {
                late = late.max(one);
            }
        }
        assert_eq!(late, Duration::ZERO);
    }
}
