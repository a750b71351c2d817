//! Tables of a third output: the force of the feedback actuator.
//!
//! They use the segments, the powers and therefore the pre-lookup of the tables of force and indentation, with their own words. A
//! segment has the constant term in its first word (with [`Constant::Half`] also the linear coefficient). Then two coefficients
//! follow per word, the lower power in the upper half. The table has the force gained since rest; the force at rest is added.

use super::{Constant, Layout, TablesError};
use crate::units::{Micronewtons, PressureRise};
use certified_lookup::{Place, Segments, product, rises};

/// Largest number of words of the tables with which these are used.
pub const MAX_WORDS: usize = super::blend::MAX_WORDS;

/// The layout of the tables of a feedback force: everything except the coefficients.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct FeedbackScale {
    /// Fraction bits of a sum in micronewtons, in addition to those of the octave: 0 to 31.
    pub shift: u32,
    /// Force at rest, micronewtons: 0 to 2^30 - 1.
    pub at_rest: i32,
}

/// Tables of a feedback force: `SEGMENTS` segments of `WORDS` words, as [`words_per_segment`] says.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct FeedbackTables<const SEGMENTS: usize, const WORDS: usize> {
    /// Layout of the sums.
    pub scale: FeedbackScale,
    /// Segments in descending order: the one of the largest inputs first.
    pub segments: [[i32; WORDS]; SEGMENTS],
}

impl<const SEGMENTS: usize, const WORDS: usize> FeedbackTables<SEGMENTS, WORDS> {
    /// Bytes of the coefficients.
    pub const BYTES: usize = size_of::<[[i32; WORDS]; SEGMENTS]>();

    /// The force at a pressure rise, from the shared layout. Every rise has a value. Beyond an end it is the value at that end.
    #[inline(always)]
    #[allow(clippy::inline_always)] // so that the layout folds into the code, and one pre-lookup is enough for all outputs
    pub fn lookup(&self, layout: &Layout, rise: PressureRise) -> Micronewtons {
        let place = layout.place(rise.0);
        let index = place.number.wrapping_sub(layout.first_index) as usize;
        force_at(layout, self.scale, &self.segments[index.min(SEGMENTS - 1)], place)
    }
}

/// Words of a segment of a feedback force.
pub const fn words_per_segment(layout: &Layout) -> usize {
    // Coefficients beside the first word.
    let coefficients = match layout.constant {
        Constant::Half => layout.powers.terms() - 1,
        Constant::Whole => layout.powers.terms(),
    };
    1 + coefficients.div_ceil(2)
}

/// The force at a place, from its segment's words.
#[inline(always)]
#[allow(clippy::inline_always)] // part of the lookup
pub(crate) fn force_at(layout: &Layout, scale: FeedbackScale, words: &[i32], place: Place) -> Micronewtons {
    let [linear, second, third, fourth] = layout.factors(place.mantissa);
    // Generated tables have all words. The default value only avoids a panic.
    let word = |at: usize| words.get(at).copied().unwrap_or(0);
    let coefficient = |n: usize| beside(word(1 + n / 2), n);
    let constant = word(0);
    let (mut sum, first) = match layout.constant {
        Constant::Half => (constant.wrapping_add(product(linear, constant as i16)), 0),
        Constant::Whole => (constant.wrapping_add(product(linear, coefficient(0))), 1),
    };
    sum = sum.wrapping_add(product(second, coefficient(first)));
    if layout.powers.terms() > 2 {
        sum = sum.wrapping_add(product(third, coefficient(first + 1)));
    }
    if layout.powers.terms() > 3 {
        sum = sum.wrapping_add(product(fourth, coefficient(first + 2)));
    }
    let octave = layout.octave_shift(place.number);
    let gained = sum.wrapping_shr(octave).wrapping_shr(scale.shift);
    Micronewtons(gained.saturating_add(scale.at_rest))
}

/// The coefficient of this number in its word.
#[inline(always)]
#[allow(clippy::inline_always)] // one instruction
const fn beside(word: i32, number: usize) -> i16 {
    if number.is_multiple_of(2) {
        (word >> 16) as i16
    } else {
        word as i16
    }
}

/// Tables of a feedback force whose words are little-endian bytes in memory, at any address. They give exactly the values of [`FeedbackTables`].
#[derive(Clone, Copy, Debug)]
pub struct LoadedFeedback<'a> {
    scale: FeedbackScale,
    layout: Layout,
    words: &'a [[u8; 4]],
}

impl<'a> LoadedFeedback<'a> {
    /// Tables beside checked ones of this layout, [`words_per_segment`] words a segment, the segment of the largest inputs first.
    ///
    /// # Errors
    /// [`TablesError`]: such tables may answer wrongly.
    pub fn new(
        layout: &Layout,
        segments: usize,
        scale: FeedbackScale,
        words: &'a [[u8; 4]],
    ) -> Result<Self, TablesError> {
        if scale.shift > 31 {
            return Err(TablesError::Layout("feedback_shift"));
        }
        let (needed, found) = (segments * words_per_segment(layout), words.len());
        if needed != found || segments * layout.words() > MAX_WORDS {
            return Err(TablesError::Words { needed, found });
        }
        let loaded = Self {
            scale,
            layout: *layout,
            words,
        };
        let at_zero = loaded.lookup(PressureRise(0));
        if at_zero.0 != scale.at_rest {
            return Err(TablesError::Zero);
        }
        // Checked like the force of tables without an indentation.
        let mut paired = [[0; 4]; MAX_WORDS];
        for (index, own) in paired.chunks_mut(layout.words()).take(segments).enumerate() {
            let segment = loaded.segment(index);
            for (at, word) in own.iter_mut().enumerate() {
                let value = match at.checked_sub(2) {
                    None if at == 0 => segment[0],
                    None => 0,
                    Some(n) => i32::from(beside(segment.get(1 + n / 2).copied().unwrap_or(0), n)) << 16,
                };
                *word = value.to_le_bytes();
            }
        }
        let paired = Segments {
            layout: Layout {
                shifts: [scale.shift, layout.shifts[1]],
                ..*layout
            },
            words: paired.get(..segments * layout.words()).unwrap_or(&[]),
        };
        rises(&paired, &[0])?;
        Ok(loaded)
    }

    /// The words of the segment of this index, the last one's for any higher.
    fn segment(&self, index: usize) -> [i32; Layout::MAX_WORDS] {
        let width = words_per_segment(&self.layout);
        let last = (self.words.len() / width).saturating_sub(1);
        let mut words = [0; Layout::MAX_WORDS];
        let segment = self.words.iter().skip(index.min(last) * width).take(width);
        for (word, bytes) in words.iter_mut().zip(segment) {
            *word = i32::from_le_bytes(*bytes);
        }
        words
    }

    /// Layout of the sums.
    pub const fn scale(&self) -> FeedbackScale {
        self.scale
    }

    /// The force at a pressure rise. Total: every `i32` has an answer.
    pub fn lookup(&self, rise: PressureRise) -> Micronewtons {
        let place = self.layout.place(rise.0);
        let index = place.number.wrapping_sub(self.layout.first_index) as usize;
        force_at(&self.layout, self.scale, &self.segment(index), place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::Powers;

    /// `y = rise + 4` in octaves [8, 16) and [4, 8), 14 bits below the unit; the force is `7 + rise + rise^2 / 2`, by hand: with an octave that ends at
    /// `U`, `y = U (1/2 + h)` and `q = s^2 / 2`, `rise = U/2 - 4 + U h` and `rise^2 = (U - 4)^2 - U (U - 4) + 2 U (U - 4) h + 2 U^2 q`.
    const fn hand_made(upper: i32) -> [i32; 2] {
        let (unit, coefficient) = (18, 2);
        let constant = (upper / 2 - 4) * 2 + (upper - 4) * (upper - 4) - upper * (upper - 4);
        let linear = (2 * upper + 2 * upper * (upper - 4)) << (coefficient - 1);
        let second = (2 * upper * upper) << (coefficient - 1);
        [constant << (unit - 1), linear << 16 | second]
    }

    const LAYOUT: Layout = Layout {
        fraction_bits: 2,
        maximum: 11,
        bias: 4,
        octaves: 1,
        halvings: 0,
        powers: Powers::Two,
        constant: Constant::Whole,
        first_index: 28,
        shifts: [0; 2],
    };
    const SCALE: FeedbackScale = FeedbackScale { shift: 4, at_rest: 7 };
    const TABLES: FeedbackTables<2, 2> = FeedbackTables {
        scale: SCALE,
        segments: [hand_made(16), hand_made(8)],
    };

    fn bytes(words: &[[i32; 2]; 2]) -> [[u8; 4]; 4] {
        let mut bytes = [[0; 4]; 4];
        for (bytes, word) in bytes.iter_mut().zip(words.as_flattened()) {
            *bytes = word.to_le_bytes();
        }
        bytes
    }

    #[test]
    fn the_sum_of_the_segment_is_added_to_the_force_at_rest() {
        let bytes = bytes(&TABLES.segments);
        let loaded = LoadedFeedback::new(&LAYOUT, 2, SCALE, &bytes).expect("sound tables");
        for rise in -3..=14 {
            let held = rise.clamp(0, 11);
            let force = Micronewtons(7 + held + held * held / 2);
            assert_eq!(TABLES.lookup(&LAYOUT, PressureRise(rise)), force);
            assert_eq!(loaded.lookup(PressureRise(rise)), force);
        }
    }

    #[test]
    fn tables_that_may_answer_wrongly_are_refused() {
        let words = bytes(&TABLES.segments);
        let refused = |scale: FeedbackScale, words: &[[u8; 4]]| {
            LoadedFeedback::new(&LAYOUT, 2, scale, words).expect_err("refused")
        };
        let shifted = FeedbackScale { shift: 32, ..SCALE };
        assert_eq!(refused(shifted, &words), TablesError::Layout("feedback_shift"));
        let short = TablesError::Words { needed: 4, found: 3 };
        assert_eq!(refused(SCALE, &words[..3]), short);
        let mut lifted = TABLES.segments;
        lifted[1][0] += 1 << 18;
        assert_eq!(refused(SCALE, &bytes(&lifted)), TablesError::Zero);
        // The upper segment begins below the end of the lower one.
        let mut fallen = TABLES.segments;
        fallen[0][0] -= 6 << 18;
        assert_eq!(refused(SCALE, &bytes(&fallen)), TablesError::Falls(3));
        let mut falling = TABLES.segments;
        falling[0][1] = -1 << 16;
        assert!(matches!(refused(SCALE, &bytes(&falling)), TablesError::Falls(_)));
    }

    #[test]
    fn two_coefficients_share_a_word() {
        let words = |powers, constant| {
            words_per_segment(&Layout {
                powers,
                constant,
                ..LAYOUT
            })
        };
        let counts = [Powers::Two, Powers::Four, Powers::Six, Powers::Eight]
            .map(|powers| [words(powers, Constant::Half), words(powers, Constant::Whole)]);
        assert_eq!(counts, [[2, 2], [2, 3], [2, 3], [3, 3]]);
    }
}
