//! Codes of the converter -> the sum of one block of them, or why the transducer cannot be read.
//!
//! The sum is the block's average without a division: later scales are per block. Averaging is what brings
//! the converter's 12 bits and the transducer's noise down to the resolution wanted, and it has no gain error
//! and a delay of half a block.

use crate::report::Fault;
use model_tables::constants::TransducerKind;

/// Highest code of the 12-bit converter, at its reference.
pub const FULL_SCALE: u16 = 4095;

/// Codes in a block; every board delivers one block a [`PERIOD`].
pub const BLOCK_LENGTH: usize = 125;

/// From one block to the next, microseconds.
pub const PERIOD: u32 = 1000;

/// Codes of one block added up: 0 to 125 * 4095 = 511 875, which is below 2^19.
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

/// Adds up a block.
///
/// # Errors
/// [`Fault::SensorOpen`] or [`Fault::SensorShort`] when even one code lies outside the window: a wire that
/// comes and goes within a block would otherwise pull the average without a trace (one code at the rail by
/// 1/125 of the range).
pub fn sum(codes: &[u16; BLOCK_LENGTH], window: Window) -> Result<CountSum, Fault> {
    let mut total = 0_u32;
    let mut outside = 0_u32;
    let inside = u32::from(window.open.wrapping_sub(window.short)).wrapping_sub(1);
    for &code in codes {
        let code = u32::from(code.min(FULL_SCALE));
        total += code;
        // Below the window the difference wraps to above any width: one comparison for both ends.
        outside += u32::from(code.wrapping_sub(u32::from(window.short) + 1) >= inside);
    }
    if outside == 0 {
        return Ok(CountSum(total));
    }
    if codes.iter().any(|&code| code >= window.open) {
        Err(Fault::SensorOpen)
    } else {
        Err(Fault::SensorShort)
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
        assert_eq!(sum(&[4095; BLOCK_LENGTH], everything), Ok(CountSum(511_875)));
    }

    #[test]
    fn one_code_at_a_rail_is_enough_for_a_fault() {
        let window = Window::of(&MPX5100);
        let mut codes = [2000; BLOCK_LENGTH];
        assert_eq!(sum(&codes, window), Ok(CountSum(250_000)));
        codes[BLOCK_LENGTH - 1] = 81;
        assert_eq!(sum(&codes, window), Err(Fault::SensorShort));
        codes[BLOCK_LENGTH - 1] = 82;
        assert!(sum(&codes, window).is_ok());
        codes[0] = 3971;
        assert!(sum(&codes, window).is_ok());
        codes[0] = 3972;
        assert_eq!(sum(&codes, window), Err(Fault::SensorOpen));
    }

    proptest! {
        #[test]
        fn every_block_has_a_sum_or_a_reason(codes in prop::array::uniform32(any::<u16>())) {
            let mut block = [1000; BLOCK_LENGTH];
            block[40..72].copy_from_slice(&codes);
            let window = Window::of(&MPX5100);
            match sum(&block, window) {
                Ok(CountSum(total)) => {
                    prop_assert_eq!(total, block.iter().map(|&code| u32::from(code)).sum::<u32>());
                    prop_assert!(block.iter().all(|&code| code > window.short && code < window.open));
                }
                Err(fault) => {
                    let high = block.iter().any(|&code| code >= window.open);
                    prop_assert_eq!(fault, if high { Fault::SensorOpen } else { Fault::SensorShort });
                    prop_assert!(high || block.iter().any(|&code| code <= window.short));
                }
            }
        }
    }
}
