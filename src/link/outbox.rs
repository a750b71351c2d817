//! Frames waiting for the line. They are numbered and built in place, and handed over without a copy. If there is no room, the
//! oldest frame is dropped and counted.

use crate::link::telemetry::{self, Message};
use crate::link::wire::Encoded;

/// A queue of `FRAMES` waiting frames, at least one. `OBJECT`: the design of the board has `[object]`.
#[derive(Debug)]
pub struct Outbox<'a, const FRAMES: usize, const OBJECT: bool = true> {
    frames: [&'a mut Encoded; FRAMES],
    /// Index of the oldest waiting frame.
    oldest: usize,
    waiting: usize,
    sequence: u16,
    dropped: u32,
}

impl<'a, const FRAMES: usize, const OBJECT: bool> Outbox<'a, FRAMES, OBJECT> {
    /// An empty queue.
    pub const fn new(frames: [&'a mut Encoded; FRAMES]) -> Self {
        Self {
            frames,
            oldest: 0,
            waiting: 0,
            sequence: 0,
            dropped: 0,
        }
    }

    /// Appends a message to the queue.
    #[inline(never)] // several places speak; one copy of the encoder is enough
    pub fn put(&mut self, message: &Message) {
        self.put_by(|frame, sequence, dropped| telemetry::write::<OBJECT>(frame, sequence, dropped, message));
    }

    /// Appends a frame that `write` writes. `write` takes the frame, its number, and the number of frames dropped before it.
    #[inline]
    pub fn put_by(&mut self, write: impl FnOnce(&mut Encoded, u16, u16)) {
        if self.waiting == FRAMES {
            self.oldest = (self.oldest + 1) % FRAMES;
            self.waiting -= 1;
            self.dropped = self.dropped.saturating_add(1);
        }
        let place = (self.oldest + self.waiting) % FRAMES;
        if let Some(frame) = self.frames.get_mut(place) {
            write(frame, self.sequence, self.dropped as u16);
            self.sequence = self.sequence.wrapping_add(1);
            self.waiting += 1;
        }
    }

    /// Exchanges `frame`, which was sent, for the oldest waiting frame. Returns whether a frame was waiting.
    #[allow(clippy::mut_mut)] // frames change hands, not their bytes
    pub fn take(&mut self, frame: &mut &'a mut Encoded) -> bool {
        if self.waiting == 0 {
            return false;
        }
        if let Some(oldest) = self.frames.get_mut(self.oldest) {
            core::mem::swap(oldest, frame);
        }
        self.oldest = (self.oldest + 1) % FRAMES;
        self.waiting -= 1;
        true
    }

    /// Whether no frame waits.
    pub const fn is_empty(&self) -> bool {
        self.waiting == 0
    }

    /// Frames dropped since reset.
    pub const fn dropped(&self) -> u32 {
        self.dropped
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::telemetry::{Frame, decode};
    use crate::signal::report::Report;
    use crate::status::Fault;
    use crate::units::Microseconds;
    use proptest::prelude::*;
    use std::collections::VecDeque;

    fn message(time: u64) -> Message {
        Message::Report {
            report: Report {
                time: Microseconds(time),
                outcome: Err(Fault::Zeroing),
            },
            pressure_fraction_bits: 0,
        }
    }

    proptest! {
        /// Beside a queue of whole frames with the same rule.
        #[test]
        fn frames_come_out_in_order_whole_and_numbered_the_oldest_dropped(taken in prop::collection::vec(any::<bool>(), 1..200)) {
            let mut bytes: [Encoded; 5] = core::array::from_fn(|_| Encoded::NOTHING);
            let [a, b, c, d, mut hand] = bytes.each_mut();
            let mut outbox = Outbox::<4>::new([a, b, c, d]);
            let (mut expected, mut put, mut dropped) = (VecDeque::new(), 0_u16, 0_u16);
            for take in taken {
                if take {
                    prop_assert_eq!(outbox.is_empty(), expected.is_empty());
                    prop_assert_eq!(outbox.take(&mut hand), !expected.is_empty());
                    if let Some(frame) = expected.pop_front() {
                        let (_, stuffed) = hand.as_slice().split_last().expect("never empty");
                        prop_assert_eq!(decode(stuffed), Ok(frame));
                    }
                } else {
                    outbox.put(&message(u64::from(put)));
                    if expected.len() == 4 {
                        let _ = expected.pop_front();
                        dropped += 1;
                    }
                    expected.push_back(Frame { sequence: put, dropped, message: message(u64::from(put)) });
                    put += 1;
                }
                prop_assert_eq!(outbox.dropped(), u32::from(dropped));
            }
        }
    }
}
