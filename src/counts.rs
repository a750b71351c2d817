//! Codes of the converter -> the sum of one block of them, or why the transducer cannot be read.
//!
//! The sum is the block's average without a division: later scales are per block. Averaging is what brings
//! the converter's 12 bits and the transducer's noise down to the resolution wanted, and it has no gain error
//! and a delay of half a block.
//!
//! A block is read where the converter's DMA wrote it, two codes a word: copying it would cost more than adding it up.

use crate::report::Fault;
use core::sync::atomic::{AtomicU32, Ordering};
use model_tables::constants::TransducerKind;

/// Highest code of the 12-bit converter, at its reference.
pub const FULL_SCALE: u16 = 4095;

/// Codes in a block; every board delivers one block a [`PERIOD`].
pub const BLOCK_LENGTH: usize = 100;

/// From one block to the next, microseconds.
pub const PERIOD: u32 = 1000;

/// A block as DMA writes it: the earlier code of two in the lower half of a word. Atomic, because the DMA may write
/// while it is read; then [`Ring::still_holds`] says so.
pub type Block = [AtomicU32; BLOCK_LENGTH / 2];

/// Codes of one block added up: 0 to 100 * 4095 = 409 500, which is below 2^19.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub struct CountSum(pub u32);

impl CountSum {
    /// The sum when every code of the block is [`FULL_SCALE`].
    pub const FULL_SCALE: u32 = FULL_SCALE as u32 * BLOCK_LENGTH as u32;
}

/// Codes between which a connected transducer stays, the ends excluded.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Window {
    /// At or below: short to ground, or no supply.
    pub short: u16,
    /// At or above: broken wire, held up by the pull-up on the board.
    pub open: u16,
}

impl Window {
    /// Half way from each end of the transducer's output to its rail.
    ///
    /// # Panics
    /// At compile time, for a transducer that the converter cannot read.
    pub const fn of(kind: &TransducerKind) -> Self {
        let TransducerKind::Ratiometric { output: [low, high] } = kind else {
            panic!("only a ratiometric transducer has a window of codes")
        };
        Self {
            short: code_of(*low / 2),
            open: code_of(*high + (65536 - *high) / 2),
        }
    }
}

/// The code of a share of the reference in `1 / 65536`; at most 65536 * 4095 < 2^28 on the way.
const fn code_of(share: u32) -> u16 {
    (share * FULL_SCALE as u32 / 65536) as u16
}

/// Both halves of a word.
const fn both(half: u16) -> u32 {
    (half as u32) << 16 | half as u32
}

/// Words added up before the halves of their sum are taken apart: 5 * 4095 stays below 2^16.
const WORDS: usize = 5;

/// Adds up a block, two codes at a time.
///
/// # Errors
/// [`Fault::SensorOpen`] or [`Fault::SensorShort`] when even one code lies outside the window: a wire that
/// comes and goes within a block would otherwise pull the average without a trace (one code at the rail by
/// 1/100 of the range).
#[inline]
pub fn sum(block: &Block, window: Window) -> Result<CountSum, Fault> {
    const CODES_END: u16 = 1 << 12;
    const SIGN: u32 = both(1 << 15);
    // Added to a code, each sets bit 15 exactly from the window's edge on: codes have 12 bits, so no half reaches the
    // next. The edges are held where the addition makes sense.
    let from_open = both(0x8000 - window.open.min(CODES_END));
    let above_short = both(0x8000 - (window.short.min(CODES_END - 1) + 1));
    let (mut total, mut any, mut open, mut inside) = (0_u32, 0_u32, 0_u32, u32::MAX);
    for words in block.as_chunks::<WORDS>().0 {
        let mut halves = 0_u32;
        let mut take = |word: &AtomicU32| {
            let codes = word.load(Ordering::Relaxed);
            any |= codes;
            halves = halves.wrapping_add(codes);
            open |= codes.wrapping_add(from_open);
            inside &= codes.wrapping_add(above_short);
        };
        // Written out, as a loop would stay one where the compiler is told to save space.
        let [a, b, c, d, e] = words;
        take(a);
        take(b);
        take(c);
        take(d);
        take(e);
        total += (halves & 0xFFFF) + (halves >> 16);
    }
    // Bits that no code has make the rest meaningless; no converter sets them.
    if any & both(!(CODES_END - 1)) != 0 || open & SIGN != 0 {
        Err(Fault::SensorOpen)
    } else if inside & SIGN != SIGN {
        Err(Fault::SensorShort)
    } else {
        Ok(CountSum(total))
    }
}

/// Where a converter is in a ring of two blocks that its DMA fills for ever from the front, and which of them can be
/// read.
#[derive(Clone, Debug, Default)]
pub struct Ring {
    /// Codes written at the last look, below [`Ring::LENGTH`].
    last: usize,
}

/// A block that is complete.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Complete {
    /// Its place in the ring, 0 or 1.
    pub half: usize,
    /// Conversions since.
    pub since: u32,
}

impl Ring {
    /// Codes in the ring.
    pub const LENGTH: usize = 2 * BLOCK_LENGTH;

    /// A block must be begun to be read before the next one is this far, conversions: what remains of a [`PERIOD`] is
    /// for the reading.
    const LATEST: usize = BLOCK_LENGTH * 3 / 4;

    /// The block that is complete, at a look once a [`PERIOD`]; `position` is how many codes of the ring are written.
    ///
    /// # Errors
    /// [`Fault::ConverterStalled`] when it stands still, [`Fault::SamplesLost`] when the last look was too long ago or
    /// this one comes too late.
    pub fn look(&mut self, position: usize) -> Result<Complete, Fault> {
        let position = position % Self::LENGTH;
        let last = core::mem::replace(&mut self.last, position);
        let (before, now) = (last / BLOCK_LENGTH, position / BLOCK_LENGTH);
        let since = position % BLOCK_LENGTH;
        if position == last {
            Err(Fault::ConverterStalled)
        } else if before == now || since > Self::LATEST {
            Err(Fault::SamplesLost)
        } else {
            Ok(Complete {
                half: before,
                since: since as u32,
            })
        }
    }

    /// Whether the block of the last look is not being written again, at a `position` less than a ring later.
    pub fn still_holds(&self, position: usize) -> bool {
        self.last / BLOCK_LENGTH == position % Self::LENGTH / BLOCK_LENGTH
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// NXP MPX5100: 4 % to 94 % of the supply.
    const MPX5100: TransducerKind = TransducerKind::Ratiometric {
        output: [2621, 61604],
    };

    fn block(codes: &[u16; BLOCK_LENGTH]) -> Block {
        core::array::from_fn(|i| AtomicU32::new(u32::from(codes[2 * i]) | u32::from(codes[2 * i + 1]) << 16))
    }

    #[test]
    fn the_window_lies_half_way_to_the_rails() {
        // 2 % and 97 % of 4095: 81.9 and 3972.2.
        assert_eq!(
            Window::of(&MPX5100),
            Window {
                short: 81,
                open: 3972
            }
        );
    }

    #[test]
    fn a_block_at_full_scale_is_the_documented_sum() {
        let everything = Window { short: 0, open: 4096 };
        assert_eq!(
            sum(&block(&[4095; BLOCK_LENGTH]), everything),
            Ok(CountSum(409_500))
        );
    }

    #[test]
    fn one_code_at_a_rail_is_enough_for_a_fault() {
        let window = Window::of(&MPX5100);
        let mut codes = [2000; BLOCK_LENGTH];
        assert_eq!(sum(&block(&codes), window), Ok(CountSum(200_000)));
        for place in 0..BLOCK_LENGTH {
            for (code, expected) in [
                (81, Err(Fault::SensorShort)),
                (82, Ok(CountSum(198_082))),
                (3971, Ok(CountSum(201_971))),
                (3972, Err(Fault::SensorOpen)),
            ] {
                codes[place] = code;
                assert_eq!(sum(&block(&codes), window), expected, "{code} at {place}");
            }
            codes[place] = 2000;
        }
    }

    proptest! {
        #[test]
        fn every_block_has_a_sum_or_a_reason(
            codes in prop::array::uniform32(any::<u16>()),
            mask in prop_oneof![Just(0xFFFF_u16), Just(0x0FFF)],
            short in 0_u16..5000,
            open in 0_u16..5000,
        ) {
            let window = Window { short, open };
            let mut values = [1000; BLOCK_LENGTH];
            for (value, code) in values[40..72].iter_mut().zip(codes) {
                *value = code & mask;
            }
            let is_open = |code: &u16| *code >= open.min(4096);
            let is_short = |code: &u16| *code <= short.min(4095);
            match sum(&block(&values), window) {
                Ok(CountSum(total)) => {
                    prop_assert_eq!(total, values.iter().map(|&code| u32::from(code)).sum::<u32>());
                    prop_assert!(!values.iter().any(|code| is_open(code) || is_short(code)));
                }
                Err(Fault::SensorOpen) => prop_assert!(values.iter().any(is_open)),
                Err(fault) => {
                    prop_assert_eq!(fault, Fault::SensorShort);
                    prop_assert!(values.iter().any(is_short) && !values.iter().any(is_open));
                }
            }
        }

        /// A converter that runs, or stops now and then, under a reader that looks at any time.
        #[test]
        fn a_block_is_complete_and_new_or_there_is_a_reason(
            looks in prop::collection::vec((0_usize..450, 0_usize..80), 1..200),
        ) {
            let mut ring = Ring::default();
            let (mut position, mut read) = (0_usize, None);
            for (step, reading) in looks {
                let before = position;
                position += step;
                match ring.look(position) {
                    Ok(Complete { half, since }) => {
                        // The block that ended last: whole, and never handed out before.
                        let number = position / BLOCK_LENGTH - 1;
                        prop_assert_eq!(half, number % 2);
                        prop_assert_eq!(since as usize, position % BLOCK_LENGTH);
                        prop_assert!(read.is_none_or(|read| read < number));
                        read = Some(number);
                        // Its first code is overwritten one block after its last was written.
                        prop_assert_eq!(ring.still_holds(position + reading), position + reading < (number + 2) * BLOCK_LENGTH);
                    }
                    Err(Fault::ConverterStalled) => prop_assert_eq!((position - before) % Ring::LENGTH, 0),
                    Err(fault) => prop_assert_eq!(fault, Fault::SamplesLost),
                }
            }
        }
    }

    #[test]
    fn a_look_a_period_never_loses_a_block() {
        let mut ring = Ring::default();
        // The looks jitter by 50 conversions.
        let looks = (1..1000).map(|n| n * BLOCK_LENGTH + 10 + n * 7919 % 50);
        assert!(looks.into_iter().all(|position| ring.look(position).is_ok()));
    }
}
