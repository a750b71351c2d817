//! Codes of the converter -> the sum of one block of codes, or the reason why the transducer cannot be read.
//!
//! The sum replaces the average, so that no division is needed: later scale factors are per block. Averaging improves the
//! resolution of the 12-bit converter and reduces the transducer's noise. It has no gain error, and delays by half a block.
//!
//! A block is read in place, where the converter's DMA wrote it, two codes a word. A copy would cost more than the sum.

use crate::status::Fault;
use core::sync::atomic::{AtomicU32, Ordering};
use model_tables::constants::{TransducerKind, period};

/// Highest code of the 12-bit converter, at its reference.
pub const FULL_SCALE: u16 = 4095;

/// Codes in a block; every board delivers one block a [`PERIOD`].
pub const BLOCK_LENGTH: usize = 100;

/// Time from one block to the next, microseconds.
pub const PERIOD: u32 = period::CONVERTER;

/// A block as DMA writes it: the earlier code of two in the lower half of a word, 12 bits each. Atomic, because the DMA may
/// write a word while it is read. [`Ring::still_holds`] detects this.
pub type Block = [AtomicU32; BLOCK_LENGTH / 2];

/// Sum of the codes of one block: 0 to 100 * 4095 = 409 500, which is below 2^19.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub struct CountSum(pub u32);

impl CountSum {
    /// The sum when every code of the block is [`FULL_SCALE`].
    pub const FULL_SCALE: u32 = FULL_SCALE as u32 * BLOCK_LENGTH as u32;
}

/// Range of codes of a connected transducer, the ends excluded.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Window {
    /// At or below: short to ground, or no supply.
    pub short: u16,
    /// At or above: broken wire, held up by the pull-up on the board.
    pub open: u16,
}

impl Window {
    /// The window of a transducer. Each limit is half way between an end of its output and the rail.
    ///
    /// # Panics
    /// At compile time, for a transducer that the converter cannot read.
    pub const fn of(kind: &TransducerKind) -> Self {
        let TransducerKind::Ratiometric {
            output: [low, high], ..
        } = kind
        else {
            panic!("only a ratiometric transducer has a window of codes")
        };
        Self {
            short: code_of(*low / 2),
            open: code_of(*high + (65536 - *high) / 2),
        }
    }
}

/// The code of a share of the reference in `1 / 65536`; intermediate values are at most 65536 * 4095 < 2^28.
const fn code_of(share: u32) -> u16 {
    (share * FULL_SCALE as u32 / 65536) as u16
}

/// The codes of a supply between half the reference and all of it. The window of the output is still valid at such a supply,
/// because a share of the supply is at least half of that share of the reference.
const SUPPLY: Window = Window {
    short: FULL_SCALE / 2,
    open: FULL_SCALE,
};

/// Two halves of a word.
const fn halves_of([low, high]: [u16; 2]) -> u32 {
    (high as u32) << 16 | low as u32
}

/// Number of words that are added before the halves of their sum are separated: 10 * 4095 stays below 2^16.
const WORDS: usize = 10;

/// Bit 15 of the half-words of the earlier and the later codes.
pub(super) const EARLIER: u32 = 1 << 15;
pub(super) const LATER: u32 = 1 << 31;

/// The windows of the earlier and the later codes of a block's words, prepared for one pass over the block. Added to a code,
/// each constant sets bit 15 exactly if the code reaches the window's edge. Codes have 12 bits, so the sum of the lower half
/// cannot carry into the upper half.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Edges {
    from_open: u32,
    above_short: u32,
}

impl Edges {
    /// All codes measure the output.
    pub const fn of_output(window: Window) -> Self {
        Self::of([window, window])
    }

    /// The later one of every two codes measures the supply.
    pub const fn of_output_and_supply(window: Window) -> Self {
        Self::of([window, SUPPLY])
    }

    /// The earlier and the later codes have a window each.
    pub(super) const fn of([earlier, later]: [Window; 2]) -> Self {
        // Limits the edges to values for which the addition is valid.
        const fn open(window: Window) -> u16 {
            let end = FULL_SCALE + 1;
            0x8000 - if window.open < end { window.open } else { end }
        }
        const fn short(window: Window) -> u16 {
            let end = FULL_SCALE;
            0x7FFF - if window.short < end { window.short } else { end }
        }
        Self {
            from_open: halves_of([open(earlier), open(later)]),
            above_short: halves_of([short(earlier), short(later)]),
        }
    }
}

/// Result of a pass over a block, separately for the earlier and the later codes of its words.
pub(super) struct Found {
    /// Sums of the codes.
    pub(super) totals: [u32; 2],
    /// [`EARLIER`], [`LATER`]: at least one of these codes is at or above the end of its window.
    pub(super) open: u32,
    /// [`EARLIER`], [`LATER`]: at least one of these codes is at or below the start of its window.
    pub(super) short: u32,
}

/// Adds up a block, two codes at a time, each against its own window.
#[inline]
fn add_up(block: &Block, edges: Edges) -> Found {
    let (mut totals, mut open, mut inside) = ([0_u32; 2], 0_u32, u32::MAX);
    for words in block.as_chunks::<WORDS>().0 {
        let mut halves = 0_u32;
        let mut take = |word: &AtomicU32| {
            let codes = word.load(Ordering::Relaxed);
            halves = halves.wrapping_add(codes);
            open |= codes.wrapping_add(edges.from_open);
            inside &= codes.wrapping_add(edges.above_short);
        };
        // Written out, because a compiler that optimises for size does not unroll a loop.
        let [a, b, c, d, e, f, g, h, i, j] = words;
        take(a);
        take(b);
        take(c);
        take(d);
        take(e);
        take(f);
        take(g);
        take(h);
        take(i);
        take(j);
        totals[0] += halves & 0xFFFF;
        totals[1] += halves >> 16;
    }
    Found {
        totals,
        open: open & (EARLIER | LATER),
        short: !inside & (EARLIER | LATER),
    }
}

/// Adds up one column of words of a block of rows, as [`add_up`] does a block.
#[cfg(tips)]
#[inline]
pub(super) fn add_up_column<const ROW: usize>(rows: &[[AtomicU32; ROW]], word: usize, edges: Edges) -> Found {
    const AT_ONCE: usize = 5;
    // 15 * 4095 stays below 2^16.
    const ROWS: usize = 3 * AT_ONCE;
    let (mut totals, mut open, mut inside) = ([0_u32; 2], 0_u32, u32::MAX);
    for rows in rows.chunks(ROWS) {
        let mut halves = 0_u32;
        let mut take = |row: &[AtomicU32; ROW]| {
            let codes = row[word].load(Ordering::Relaxed);
            halves = halves.wrapping_add(codes);
            open |= codes.wrapping_add(edges.from_open);
            inside &= codes.wrapping_add(edges.above_short);
        };
        let (fives, rest) = rows.as_chunks::<AT_ONCE>();
        // Written out, because a compiler that optimises for size does not unroll a loop.
        for [a, b, c, d, e] in fives {
            take(a);
            take(b);
            take(c);
            take(d);
            take(e);
        }
        for row in rest {
            take(row);
        }
        totals[0] += halves & 0xFFFF;
        totals[1] += halves >> 16;
    }
    Found {
        totals,
        open: open & (EARLIER | LATER),
        short: !inside & (EARLIER | LATER),
    }
}

/// The sum of a block.
///
/// # Errors
/// [`Fault::SensorOpen`] or [`Fault::SensorShort`] if even one code is outside the window. Otherwise a wire with a loose
/// contact could change the average undetected (one code at the rail changes it by 1/100 of the range).
#[inline]
pub fn sum(block: &Block, edges: Edges) -> Result<CountSum, Fault> {
    let Found { totals, open, short } = add_up(block, edges);
    if open != 0 {
        Err(Fault::SensorOpen)
    } else if short != 0 {
        Err(Fault::SensorShort)
    } else {
        Ok(CountSum(totals[0] + totals[1]))
    }
}

/// The sum of a block in which every second code measures the transducer's supply. It is scaled as if the supply were the
/// converter's reference, so that the supply cancels.
///
/// # Errors
/// As [`sum`]; [`Fault::SensorSupply`] if even one code of the supply is not between half the reference and the reference.
#[inline]
pub fn sum_of_supply(block: &Block, edges: Edges) -> Result<CountSum, Fault> {
    let Found {
        totals: [output, supply],
        open,
        short,
    } = add_up(block, edges);
    if (open | short) & LATER != 0 {
        Err(Fault::SensorSupply)
    } else if open & EARLIER != 0 || output >= supply {
        Err(Fault::SensorOpen)
    } else if short & EARLIER != 0 {
        Err(Fault::SensorShort)
    } else {
        // Below 50 * 4095 * 409 500 < 2^37, and the supply is above 50 * 2047.
        let scaled = u64::from(output) * u64::from(CountSum::FULL_SCALE) + u64::from(supply / 2);
        Ok(CountSum((scaled / u64::from(supply)) as u32))
    }
}

/// Position of a converter in a ring of two blocks that its DMA fills continuously from the front. It determines which block
/// can be read.
#[derive(Clone, Debug, Default)]
pub struct Ring {
    /// Number of codes written at the last look, below [`Ring::LENGTH`].
    last: usize,
}

/// A block that is complete.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Complete {
    /// Index of the block in the ring, 0 or 1.
    pub half: usize,
    /// Number of conversions since it was complete.
    pub since: u32,
}

impl Ring {
    /// Codes in the ring.
    pub const LENGTH: usize = 2 * BLOCK_LENGTH;

    /// The complete block. This is called once each [`PERIOD`]. `position` is the number of codes written in the ring. Reading
    /// must start before the next block is three quarters written; the rest of the [`PERIOD`] is for the reading.
    ///
    /// # Errors
    /// [`Fault::ConverterStalled`] if the converter has stopped, [`Fault::SamplesLost`] if the last look was too long ago or
    /// this one is too late.
    pub fn look(&mut self, position: usize) -> Result<Complete, Fault> {
        look(&mut self.last, position, BLOCK_LENGTH)
    }

    /// Whether the block of the last look is still intact. `position` is less than one ring after that look.
    pub fn still_holds(&self, position: usize) -> bool {
        self.last / BLOCK_LENGTH == position % Self::LENGTH / BLOCK_LENGTH
    }
}

/// [`Ring::look`] for a ring of two blocks of any length.
#[inline(always)] // the length is a constant wherever it is called
#[allow(clippy::inline_always)]
pub(super) fn look(last: &mut usize, position: usize, block: usize) -> Result<Complete, Fault> {
    let position = position % (2 * block);
    let last = core::mem::replace(last, position);
    let (before, now) = (last / block, position / block);
    let since = position % block;
    if position == last {
        Err(Fault::ConverterStalled)
    } else if before == now || since > block * 3 / 4 {
        Err(Fault::SamplesLost)
    } else {
        Ok(Complete {
            half: before,
            since: since as u32,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// NXP MPX5100: 4 % to 94 % of the supply.
    const MPX5100: TransducerKind = TransducerKind::Ratiometric {
        output: [2621, 61604],
        supply_measured: false,
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
            sum(&block(&[4095; BLOCK_LENGTH]), Edges::of_output(everything)),
            Ok(CountSum(409_500))
        );
    }

    #[test]
    fn one_code_at_a_rail_is_enough_for_a_fault() {
        let edges = Edges::of_output(Window::of(&MPX5100));
        let mut codes = [2000; BLOCK_LENGTH];
        assert_eq!(sum(&block(&codes), edges), Ok(CountSum(200_000)));
        for place in 0..BLOCK_LENGTH {
            for (code, expected) in [
                (81, Err(Fault::SensorShort)),
                (82, Ok(CountSum(198_082))),
                (3971, Ok(CountSum(201_971))),
                (3972, Err(Fault::SensorOpen)),
            ] {
                codes[place] = code;
                assert_eq!(sum(&block(&codes), edges), expected, "{code} at {place}");
            }
            codes[place] = 2000;
        }
    }

    #[test]
    fn a_supply_that_is_off_or_beyond_the_reference_is_a_reason() {
        let mut codes = [1000; BLOCK_LENGTH];
        for (supply, expected) in [
            (0, Err(Fault::SensorSupply)),
            (2047, Err(Fault::SensorSupply)),
            (2048, Ok(CountSum(199_951))),
            (4094, Ok(CountSum(100_024))),
            (4095, Err(Fault::SensorSupply)),
        ] {
            codes
                .iter_mut()
                .skip(1)
                .step_by(2)
                .for_each(|code| *code = supply);
            let sum = sum_of_supply(&block(&codes), Edges::of_output_and_supply(Window::of(&MPX5100)));
            // 1000 / 2048 and 1000 / 4094 of 409 500.
            assert_eq!(sum, expected, "{supply}");
        }
    }

    proptest! {
        /// A supply that moves takes the output with it, and nothing is left of it.
        #[test]
        fn a_measured_supply_cancels(share in 0.05_f64..0.95, supply in 0.51_f64..0.99, sag in 0.0_f64..0.01) {
            let mut codes = [0; BLOCK_LENGTH];
            for (i, pair) in codes.chunks_exact_mut(2).enumerate() {
                let supply = 4095.0 * (supply - sag * i as f64 / 50.0);
                pair[0] = (share * supply).round() as u16;
                pair[1] = supply.round() as u16;
            }
            let edges = Edges::of_output_and_supply(Window::of(&MPX5100));
                let CountSum(sum) = sum_of_supply(&block(&codes), edges).expect("all is within");
            // Half a code of each, of at least half the reference.
            let off = f64::from(sum) / f64::from(CountSum::FULL_SCALE) - share;
            prop_assert!(off.abs() <= 1.01 / (0.5 * 4095.0), "{off}");
        }

        #[test]
        fn a_block_with_supply_has_a_sum_or_a_reason(
            codes in prop::array::uniform32((0_u16..4096, 0_u16..4096)),
        ) {
            let mut values = [2000; BLOCK_LENGTH];
            values.iter_mut().skip(1).step_by(2).for_each(|supply| *supply = 3000);
            for (pair, (output, supply)) in values.chunks_exact_mut(2).zip(codes) {
                pair.copy_from_slice(&[output, supply]);
            }
            let window = Window::of(&MPX5100);
            let of = |half: usize| values.iter().skip(half).step_by(2).copied();
            let total = |half| of(half).map(u64::from).sum::<u64>();
            match sum_of_supply(&block(&values), Edges::of_output_and_supply(window)) {
                Ok(CountSum(sum)) => {
                    prop_assert!(of(1).all(|code| code > 2047 && code < 4095));
                    prop_assert!(of(0).all(|code| code > window.short && code < window.open));
                    prop_assert_eq!(u64::from(sum), (total(0) * 409_500 + total(1) / 2) / total(1));
                }
                Err(Fault::SensorSupply) => prop_assert!(of(1).any(|code| code <= 2047 || code >= 4095)),
                Err(Fault::SensorOpen) => {
                    prop_assert!(of(0).any(|code| code >= window.open) || total(0) >= total(1));
                }
                Err(fault) => {
                    prop_assert_eq!(fault, Fault::SensorShort);
                    prop_assert!(of(0).any(|code| code <= window.short));
                }
            }
        }

        #[test]
        fn every_block_has_a_sum_or_a_reason(
            codes in prop::array::uniform32(0_u16..4096),
            short in 0_u16..5000,
            open in 0_u16..5000,
        ) {
            let window = Window { short, open };
            let mut values = [1000; BLOCK_LENGTH];
            for (value, code) in values[40..72].iter_mut().zip(codes) {
                *value = code;
            }
            let is_open = |code: &u16| *code >= open.min(4096);
            let is_short = |code: &u16| *code <= short.min(4095);
            match sum(&block(&values), Edges::of_output(window)) {
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
