//! The way out for frames. A dedicated line may be used at any time; on a shared line of one pair (RS-485, half duplex) the
//! board is silent until the host gives it the turn.
//!
//! The rule of the shared line:
//!
//! - The host gives the turn with an empty frame (one zero byte behind its last frame) or with a command.
//! - The board then sends what waits, at most [`Turn::FRAMES`], and is silent again. It begins within [`Turn::LAPSE`] and pauses no
//!   longer between two frames: otherwise its turn is over, and what waits is sent in the next one.
//! - The host sends again when it has heard nothing for [`Turn::QUIET`].
//! - A byte of the host that does not give the turn takes it back.

use crate::units::Microseconds;

/// A line that sends frames.
pub trait FrameSink {
    /// Result that the driver returns for a frame.
    type Outcome;

    /// Whether the next one may be sent.
    fn has_turn(&mut self) -> bool {
        true
    }

    /// Sends one. A failure shows as a gap in the sequence: the line has no receiver that could refuse.
    // Not an `async fn`, so that an implementation can return the driver's own future. Another state machine around it takes 200 bytes of flash.
    fn send(&mut self, frame: &[u8]) -> impl Future<Output = Self::Outcome>;

    /// Ends the turn: nothing more is sent in it.
    fn end_turn(&mut self) {}
}

/// Keeps track of the turn on a shared line, in the board.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Turn {
    /// The last received byte.
    last: u8,
    /// Time when the board's turn ends, microseconds. 0 means that it is the host's turn.
    ends: u64,
    /// Number of frames that the board may still send in this turn.
    left: u8,
}

impl Turn {
    /// Largest number of frames in one turn of the board: all that can wait in the queue.
    pub const FRAMES: u8 = 16;

    /// The board starts its turn, and continues after a frame, within this time, microseconds.
    pub const LAPSE: u64 = 500;

    /// The host's turn begins when it has received nothing for this time, microseconds: the lapse, a byte of 10 us, and time
    /// for the drivers to change direction.
    pub const QUIET: u64 = 1_000;

    /// The state before the first byte: it is the host's turn.
    pub const HOSTS: Self = Self {
        last: 0,
        ends: 0,
        left: 0,
    };

    /// Takes a byte of the host, and whether it ended a command. Returns whether it gives the board the turn.
    pub fn hear(&mut self, byte: u8, ends_command: bool, now: Microseconds) -> bool {
        let gives = ends_command || byte == 0 && self.last == 0;
        self.last = byte;
        self.left = Self::FRAMES;
        self.ends = if gives { now.0 + Self::LAPSE } else { 0 };
        gives
    }

    /// Whether the board may send a frame now.
    pub const fn is_boards(&self, now: Microseconds) -> bool {
        now.0 < self.ends && self.left > 0
    }

    /// The board has sent a frame; a turn that was taken back meanwhile stays the host's.
    pub fn sent(&mut self, now: Microseconds) {
        self.left = self.left.saturating_sub(1);
        if self.ends != 0 {
            self.ends = now.0 + Self::LAPSE;
        }
    }

    /// The board has sent its last frame of the turn.
    pub fn end(&mut self) {
        self.ends = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::outbox::Outbox;
    use crate::link::telemetry::Message;
    use crate::link::wire::Encoded;
    use crate::signal::report::Report;
    use crate::status::Fault;
    use embassy_futures::block_on;
    use proptest::prelude::*;

    /// A byte at 1 000 000 baud, microseconds.
    const BYTE: u64 = 10;

    #[test]
    fn an_empty_frame_or_a_command_gives_the_turn_and_nothing_else() {
        let now = Microseconds(7);
        let mut turn = Turn::HOSTS;
        assert!(!turn.is_boards(now));
        assert!(turn.hear(0, false, now) && turn.is_boards(now));
        // The next byte of the host takes it back, as does a frame that is no command.
        assert!(!turn.hear(5, false, now) && !turn.is_boards(now));
        assert!(!turn.hear(0, false, now) && !turn.is_boards(now));
        assert!(turn.hear(0, false, now));
        assert!(!turn.hear(5, false, now));
        assert!(turn.hear(0, true, now));
    }

    #[test]
    fn a_turn_lapses_unless_a_frame_is_sent() {
        let mut turn = Turn::HOSTS;
        turn.hear(0, false, Microseconds(1_000));
        assert!(turn.is_boards(Microseconds(1_499)) && !turn.is_boards(Microseconds(1_500)));
        turn.sent(Microseconds(1_400));
        assert!(turn.is_boards(Microseconds(1_899)));
        turn.end();
        turn.sent(Microseconds(1_401));
        assert!(!turn.is_boards(Microseconds(1_402)));
    }

    /// The host polls; what is sent goes at once, and each frame takes its time.
    struct Shared<'a> {
        turn: Turn,
        now: u64,
        /// How late the board is before each frame, microseconds.
        late: std::vec::IntoIter<u64>,
        /// When each frame began and ended.
        sent: &'a mut Vec<(u64, u64)>,
    }

    impl FrameSink for Shared<'_> {
        type Outcome = ();

        fn has_turn(&mut self) -> bool {
            self.now += self.late.next().unwrap_or(0);
            self.turn.is_boards(Microseconds(self.now))
        }

        async fn send(&mut self, frame: &[u8]) {
            let begins = self.now;
            self.now += BYTE * frame.len() as u64;
            self.sent.push((begins, self.now));
            self.turn.sent(Microseconds(self.now));
        }

        fn end_turn(&mut self) {
            self.turn.end();
        }
    }

    /// A line of its own.
    struct Own(Vec<Vec<u8>>);

    impl FrameSink for Own {
        type Outcome = ();

        async fn send(&mut self, frame: &[u8]) {
            self.0.push(frame.to_vec());
        }
    }

    fn fault(time: u64) -> Message {
        Message::Report {
            report: Report {
                time: Microseconds(time),
                outcome: Err(Fault::Zeroing),
            },
            pressure_fraction_bits: 0,
        }
    }

    /// As the firmware's task does.
    #[allow(clippy::mut_mut)] // frames change hands, not their bytes
    fn use_turn<'a>(sink: &mut impl FrameSink, outbox: &mut Outbox<'a, 20>, frame: &mut &'a mut Encoded) {
        while sink.has_turn() && outbox.take(frame) {
            block_on(sink.send(frame.as_slice()));
        }
        sink.end_turn();
    }

    fn frames() -> [Encoded; 20] {
        core::array::from_fn(|_| Encoded::NOTHING)
    }

    #[test]
    fn both_lines_get_the_same_frames() {
        let (mut bytes, mut one) = (frames(), Encoded::NOTHING);
        let mut frame = &mut one;
        let mut outbox = Outbox::<20>::new(bytes.each_mut());
        let (mut own, mut sent) = (Own(vec![]), vec![]);
        for time in 0..20 {
            outbox.put(&fault(time));
        }
        use_turn(&mut own, &mut outbox, &mut frame);
        assert_eq!((own.0.len(), outbox.is_empty()), (20, true));
        for time in 0..20 {
            outbox.put(&fault(time));
        }
        // Until the host gives the turn, nothing is sent; then sixteen frames, and the rest in the next turn.
        let mut turn = Turn::HOSTS;
        let mut given = vec![];
        for poll in [false, true, true] {
            if poll {
                turn.hear(0, false, Microseconds(0));
            }
            let late = vec![].into_iter();
            let mut shared = Shared {
                turn,
                now: 0,
                late,
                sent: &mut sent,
            };
            use_turn(&mut shared, &mut outbox, &mut frame);
            turn = shared.turn;
            given.push(sent.len());
        }
        assert_eq!(given, [0, 16, 20]);
        // A frame of a fault has 19 bytes.
        assert_eq!(sent[0], (0, 190));
    }

    proptest! {
        /// The host polls, waits until it has heard nothing for [`Turn::QUIET`], and polls again. Whatever the board is late by, the two
        /// never send at once.
        #[test]
        fn the_two_never_send_at_once(late in prop::collection::vec(prop_oneof![0..480_u64, 0..40_000_u64], 0..60), waiting in 0..20_u64) {
            let (mut bytes, mut one) = (frames(), Encoded::NOTHING);
            let mut frame = &mut one;
            let mut outbox = Outbox::<20>::new(bytes.each_mut());
            let mut late = late.into_iter();
            let (mut turn, mut polled) = (Turn::HOSTS, 0);
            for _ in 0..20 {
                for time in 0..waiting {
                    outbox.put(&fault(time));
                }
                let mut sent = vec![];
                let mut heard = polled + BYTE;
                turn.hear(0, false, Microseconds(heard));
                let mut shared = Shared { turn, now: heard, late, sent: &mut sent };
                use_turn(&mut shared, &mut outbox, &mut frame);
                (turn, late) = (shared.turn, shared.late);
                // What the host hears tells it when it may send again: no frame begins after that.
                for &(begins, ends) in &sent {
                    prop_assert!(begins < heard + Turn::QUIET, "{begins} after {heard}");
                    heard = ends;
                }
                polled = heard + Turn::QUIET;
            }
        }
    }
}
