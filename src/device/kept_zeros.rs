//! The zeros of a hand's tips, in memory that survives a reset, beside the
//! [`CrashRecord`](crate::device::task_monitor::CrashRecord), which holds one zero only.

use crate::signal::zero::Zero;
use crate::units::Pressure;
use crc::{CRC_32_ISO_HDLC, Crc, NoTable};

const MAGIC: u32 = 0x465A_4831;

const CHECK: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);

/// The words in memory. For each tip: the zero, its bound, and a state. State 0 means no zero, 1 an unverified zero, 3 a verified zero.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct ZeroWords<const TIPS: usize> {
    /// Magic number, the hand's hash in two words, and the CRC-32/ISO-HDLC of all other words.
    head: [u32; 4],
    tips: [[u32; 3]; TIPS],
}

impl<const TIPS: usize> ZeroWords<TIPS> {
    /// The words for the zeros in use of the hand with this hash.
    pub fn of(hand: u64, zeros: [Option<Zero>; TIPS]) -> Self {
        let tips = zeros.map(|zero| {
            zero.map_or([0; 3], |zero| {
                [
                    zero.pressure.0 as u32,
                    zero.bound as u32,
                    1 | u32::from(zero.verified) << 1,
                ]
            })
        });
        let mut words = Self {
            head: [MAGIC, hand as u32, (hand >> 32) as u32, 0],
            tips,
        };
        words.head[3] = words.check();
        words
    }

    /// The kept zeros of this hand. Every tip has `None` if [`ZeroWords::of`] did not write the words, or if they belong to
    /// another hand.
    pub fn zeros(&self, hand: u64) -> [Option<Zero>; TIPS] {
        let [magic, low, high, check] = self.head;
        let whole = magic == MAGIC && check == self.check();
        let own = u64::from(high) << 32 | u64::from(low) == hand;
        self.tips.map(|[pressure, bound, flags]| {
            (whole && own && flags & 1 == 1).then_some(Zero {
                pressure: Pressure(pressure as i32),
                bound: bound as i32,
                verified: flags & 2 == 2,
            })
        })
    }

    fn check(&self) -> u32 {
        let mut digest = CHECK.digest();
        let [magic, low, high, _] = self.head;
        for word in [magic, low, high].iter().chain(self.tips.as_flattened()) {
            digest.update(&word.to_le_bytes());
        }
        digest.finalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ZEROS: [Option<Zero>; 3] = [
        Some(Zero {
            pressure: Pressure(-5),
            bound: 7,
            verified: true,
        }),
        None,
        Some(Zero {
            pressure: Pressure(i32::MAX),
            bound: i32::MAX,
            verified: false,
        }),
    ];

    #[test]
    fn each_tips_zero_survives_and_another_hand_has_none() {
        let words = ZeroWords::of(0x0123_4567_89AB_CDEF, ZEROS);
        assert_eq!(words.zeros(0x0123_4567_89AB_CDEF), ZEROS);
        assert_eq!(words.zeros(0x0123_4567_89AB_CDEE), [None; 3]);
        assert_eq!(words.zeros(0x1123_4567_89AB_CDEF), [None; 3]);
    }

    #[test]
    fn no_flipped_bit_and_no_fresh_memory_is_a_zero() {
        let words = ZeroWords::of(1, ZEROS);
        for bit in 0..32 * 13 {
            let mut flipped = words;
            match bit / 32 {
                word @ 0..4 => flipped.head[word] ^= 1 << (bit % 32),
                word => flipped.tips[(word - 4) / 3][(word - 4) % 3] ^= 1 << (bit % 32),
            }
            assert_eq!(flipped.zeros(1), [None; 3], "{bit}");
        }
        for word in [0, u32::MAX, 0xA5A5_A5A5] {
            let fresh = ZeroWords {
                head: [word; 4],
                tips: [[word; 3]; 3],
            };
            assert_eq!(fresh.zeros(u64::from(word) << 32 | u64::from(word)), [None; 3]);
        }
    }
}
