//! Where a frame stands among those before it: the next one, behind a gap, repeated, late, or of another run of the board.

/// How many frames back a late one may be. A serial line keeps their order; what carries TCP frames may not.
const LATE: u16 = 64;
/// So many late frames in a row are a board that was reset within its first `LATE` frames.
const MANY: u32 = 32;
/// A hello carries the time of its making, a report the middle of its samples: how far two frames in order may be apart, microseconds.
const TOLERANCE: u64 = 1_000_000;
/// Half of what sequence numbers count to.
const HALF: u16 = 1 << 15;

/// What the number and the time of a frame tell.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Order {
    /// It follows, with so many missing between.
    Next {
        /// Frames that never came.
        missing: u64,
    },
    /// It was here before.
    Repeated,
    /// It was overtaken by later ones.
    Late,
    /// The board was reset: its clock began anew.
    Restarted,
}

/// Follows the numbers of frames.
#[derive(Clone, Debug, Default)]
pub(crate) struct FrameOrder {
    /// Number and board time, microseconds, of the frame that came furthest.
    last: Option<(u16, u64)>,
    /// Late frames since the last that followed.
    late: u32,
}

impl FrameOrder {
    /// Takes the number and the board's time, microseconds, of a frame.
    pub(crate) fn place(&mut self, sequence: u16, time: u64) -> Order {
        let Some((before, latest)) = self.last else {
            self.last = Some((sequence, time));
            return Order::Next { missing: 0 };
        };
        let ahead = sequence.wrapping_sub(before);
        let behind = before.wrapping_sub(sequence);
        let close = time.abs_diff(latest) <= TOLERANCE;
        if ahead == 0 && close {
            return Order::Repeated;
        }
        if (1..=LATE).contains(&behind) && time <= latest && close && self.late < MANY {
            self.late += 1;
            return Order::Late;
        }
        self.late = 0;
        let back = time.saturating_add(TOLERANCE) < latest || (ahead >= HALF && time <= latest);
        self.last = Some((sequence, if back { time } else { time.max(latest) }));
        if back {
            return Order::Restarted;
        }
        // A number that comes again after a while has been round once.
        let missing = if ahead == 0 { u16::MAX } else { ahead - 1 };
        Order::Next {
            missing: missing.into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MILLISECOND: u64 = 1000;

    fn after(sequence: u16, milliseconds: u64) -> FrameOrder {
        let mut order = FrameOrder::default();
        assert_eq!(
            order.place(sequence, milliseconds * MILLISECOND),
            Order::Next { missing: 0 }
        );
        order
    }

    #[test]
    fn a_gap_counts_what_is_missing_also_over_the_end_of_the_numbers() {
        let mut order = after(u16::MAX - 1, 10);
        assert_eq!(
            order.place(u16::MAX, 11 * MILLISECOND),
            Order::Next { missing: 0 }
        );
        assert_eq!(order.place(2, 14 * MILLISECOND), Order::Next { missing: 2 });
        // A minute of silence at 500 frames a second.
        assert_eq!(
            order.place(30_002, 60_014 * MILLISECOND),
            Order::Next { missing: 29_999 }
        );
    }

    #[test]
    fn a_reset_a_repeated_and_a_reordered_frame_are_no_gap() {
        let mut order = after(40_000, 3_600_000);
        assert_eq!(order.place(40_000, 3_600_000 * MILLISECOND), Order::Repeated);
        assert_eq!(
            order.place(40_002, 3_600_002 * MILLISECOND),
            Order::Next { missing: 1 }
        );
        assert_eq!(order.place(40_001, 3_600_001 * MILLISECOND), Order::Late);
        assert_eq!(
            order.place(40_003, 3_600_003 * MILLISECOND),
            Order::Next { missing: 0 }
        );
        assert_eq!(order.place(0, 5 * MILLISECOND), Order::Restarted);
        assert_eq!(order.place(1, 6 * MILLISECOND), Order::Next { missing: 0 });
    }

    #[test]
    fn a_board_that_is_reset_again_and_again_is_not_late_for_ever() {
        let mut order = after(50, 50);
        let told: Vec<Order> = (0..40)
            .map(|i| order.place(i, u64::from(i) * MILLISECOND))
            .collect();
        assert!(told.contains(&Order::Restarted), "{told:?}");
        assert_eq!(told[39], Order::Next { missing: 0 });
    }
}
