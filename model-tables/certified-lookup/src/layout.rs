//! The lookup on the chip: one integer input -> two integer outputs, integers only.
//!
//! Segments widen geometrically. With `y = clamp(rise, 0, maximum) + bias`, one count of leading zeros names the octave of `y`, and
//! one shift left makes its mantissa `m` of it, a fraction of `2^32`. A segment is one octave (`1/2 <= m < 1`) or two (`1/4 <= m <
//! 1`). In it both outputs are `c0 + c1 s + c2 s^2 + ...` in the distance `s = 1 - m` from the segment's upper end, with gaps
//! between the powers: 1, 2, 4 or 1, 2, 6 instead of 1, 2, 3. Over two octaves, a response is often close to `m^p` with `p` from 0.3 to 1.3.
//! For such a curve, a third coefficient on `s^4` leaves half the error of one on `s^3` at the same cost, since `s^4` is one
//! squaring.
//!
//! Coefficients are 16-bit numbers, two to a word, and a product with one is a single instruction. A segment's sum
//! is scaled by the square root of the octave (the shift grows by one where `y` shrinks to a quarter), which is about how both
//! outputs fall, so that 16 bits suffice in every segment. There is no search, no division, no loop and no branch on
//! data, and no input can panic.
//!
//! The tables of a design are a constant, so the compiler folds everything except the coefficients.

/// Largest number of fraction bits of the input's unit.
pub(crate) const MAX_FRACTION_BITS: u32 = 16;

/// Powers of `s` beside 1 that a segment's sums are made of.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Powers {
    /// 1, 2.
    Two,
    /// 1, 2, 4.
    Four,
    /// 1, 2, 6.
    Six,
    /// 1, 2, 4, 8.
    Eight,
}

impl Powers {
    /// Number of powers.
    pub const fn terms(self) -> usize {
        match self {
            Self::Two => 2,
            Self::Four | Self::Six => 3,
            Self::Eight => 4,
        }
    }
}

/// Where the constant terms are kept.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Constant {
    /// In the upper half of a word; the lower half, which holds the linear coefficient, counts as its fraction.
    Half,
    /// In a word of their own.
    Whole,
}

/// Where the segments lie and how their words are read: everything of tables but the coefficients.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Layout {
    /// `k`: a count of the input is `1 / 2^k` of its unit, 0 to 16.
    pub fraction_bits: u32,
    /// Last input covered, counts; inputs above it read as it does, flagged.
    pub maximum: i32,
    /// Added to the input before its octave is taken, counts, >= 1: the first segment starts at zero input.
    pub bias: i32,
    /// Octaves of a segment: 1 or 2.
    pub octaves: u32,
    /// How often an octave is cut in halves: a segment is `2^-halvings` of one, and as if it were one. For curves that bend
    /// most at their end, as those of bench data do whose pressure saturates; only with one octave.
    pub halvings: u32,
    /// The powers of its sums.
    pub powers: Powers,
    /// Where its constant terms are.
    pub constant: Constant,
    /// Number of the first entry of the segments, counting all segments of a 32-bit word downwards from 0.
    pub first_index: u32,
    /// Bits of each output's sum below one of its units, beside those of the octave: 0 to 31.
    pub shifts: [u32; 2],
}

/// Tables of a size known when they are compiled: `SEGMENTS` segments of `WORDS` words, as [`Layout::words`] says.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Tables<const SEGMENTS: usize, const WORDS: usize> {
    /// Where the segments lie.
    pub layout: Layout,
    /// Segments in descending order: the one of the largest inputs first.
    pub segments: [[i32; WORDS]; SEGMENTS],
}

/// What the tables give for an input.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Outputs {
    /// Both outputs, each in its unit.
    pub values: [i32; 2],
    /// The input lay above the tables: the outputs are lower bounds.
    pub saturated: bool,
    /// The input was negative and read as zero.
    pub negative: bool,
}

/// An input's segment and its place in it.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Place {
    /// The segment, counting all segments of a 32-bit word downwards from 0.
    pub number: u32,
    /// The mantissa, a fraction of `2^32`.
    pub mantissa: u32,
    /// The input lay above [`Layout::maximum`].
    pub saturated: bool,
}

impl Layout {
    /// Words of a segment at most.
    pub const MAX_WORDS: usize = 6;

    /// Words of a segment. The first two hold the constant terms of the outputs (with [`Constant::Half`] also their linear
    /// coefficients), each of the others the coefficients of one power: the first output's in the upper half, the second's in the
    /// lower.
    pub const fn words(&self) -> usize {
        match self.constant {
            Constant::Half => 1 + self.powers.terms(),
            Constant::Whole => 2 + self.powers.terms(),
        }
    }

    /// The pre-lookup that both outputs share, for an input of at least `-(2^31 - 1)` counts.
    #[inline(always)]
    #[allow(clippy::inline_always)] // part of the lookup
    pub fn place(&self, input: i32) -> Place {
        let held = input.clamp(0, self.maximum);
        // The sign of a difference, as a comparison costs an instruction more. An input is -(2^31 - 1) at least: no overflow.
        let saturated = held.wrapping_sub(input) < 0;
        // Neither of two positive `i32` leaves the `u32` in their sum.
        let y = (held as u32).wrapping_add(self.bias as u32);
        let zeros = y.leading_zeros();
        let number = if self.octaves == 2 { zeros >> 1 } else { zeros };
        let mantissa = y.wrapping_shl(if self.octaves == 2 { number << 1 } else { number });
        if self.halvings == 0 {
            return Place {
                number,
                mantissa,
                saturated,
            };
        }
        // The bits after the first name the part of the octave, downwards as octaves are numbered.
        let part = !(mantissa << 1) >> (32 - self.halvings);
        Place {
            number: (number << self.halvings) + part,
            mantissa: mantissa << self.halvings | 0x8000_0000,
            saturated,
        }
    }

    /// Shift of a segment's sums for their octave.
    #[inline(always)]
    #[allow(clippy::inline_always)] // part of the lookup
    pub const fn octave_shift(&self, number: u32) -> u32 {
        if self.octaves == 2 {
            number
        } else {
            number >> self.halvings >> 1
        }
    }

    /// What the coefficients are multiplied with, fractions of `2^32`: `1/2 - s`, `s^2 / 2`, and as [`Powers`] has
    /// them `s^4 / 4`, `s^6 / 8`, `s^8 / 16`; the rest is 0.
    #[inline(always)]
    #[allow(clippy::inline_always)] // part of the lookup
    pub const fn factors(&self, mantissa: u32) -> [i32; 4] {
        // m - 1/2 = 1/2 - s. Unsigned products: a compiler that knows a square is not negative takes three
        // instructions for its product with a coefficient.
        let linear = (mantissa ^ 0x8000_0000) as i32;
        // m^2 / 2 - (m - 1/2) = s^2 / 2, at most 9/32.
        let second = ((high(mantissa, mantissa) >> 1) as i32).wrapping_sub(linear);
        let fourth = high(second as u32, second as u32);
        match self.powers {
            Powers::Two => [linear, second, 0, 0],
            Powers::Four => [linear, second, fourth as i32, 0],
            Powers::Six => [linear, second, high(fourth, second as u32) as i32, 0],
            Powers::Eight => [linear, second, fourth as i32, high(fourth, fourth) as i32],
        }
    }

    /// The sums of both outputs from a segment's words, before their shifts.
    #[inline(always)]
    #[allow(clippy::inline_always)] // part of the lookup
    pub fn sums(&self, words: &[i32], mantissa: u32) -> [i32; 2] {
        let [linear, second, third, fourth] = self.factors(mantissa);
        // Nothing is ever missing in generated tables; this keeps panics out.
        let word = |at: usize| words.get(at).copied().unwrap_or(0);
        let pair = |[first, second]: [i32; 2], factor: i32, at: usize| {
            let word = word(at);
            [
                first.wrapping_add(product(factor, (word >> 16) as i16)),
                second.wrapping_add(product(factor, word as i16)),
            ]
        };
        let (upper, lower) = (word(0), word(1));
        let (mut sums, mut at) = match self.constant {
            // Written out, as `map` would stay a loop where the compiler is told to save space.
            Constant::Half => (
                [
                    upper.wrapping_add(product(linear, upper as i16)),
                    lower.wrapping_add(product(linear, lower as i16)),
                ],
                2,
            ),
            Constant::Whole => (pair([upper, lower], linear, 2), 3),
        };
        sums = pair(sums, second, at);
        at += 1;
        if self.powers.terms() > 2 {
            sums = pair(sums, third, at);
            at += 1;
        }
        if self.powers.terms() > 3 {
            sums = pair(sums, fourth, at);
        }
        sums
    }

    /// Both outputs at an input, from the segments of this layout.
    #[inline(always)]
    #[allow(clippy::inline_always)] // so that the layout folds into the code of the one call site
    pub fn lookup_in<const SEGMENTS: usize, const WORDS: usize>(
        &self,
        segments: &[[i32; WORDS]; SEGMENTS],
        input: i32,
    ) -> Outputs {
        let place = self.place(input);
        // The index is in range for every input of a generated table, as the compiler sees; the limit keeps panics out.
        let index = place.number.wrapping_sub(self.first_index) as usize;
        self.outputs(input, place, &segments[index.min(SEGMENTS - 1)])
    }

    /// The outputs at a place, from its segment's words.
    #[inline(always)]
    #[allow(clippy::inline_always)] // part of the lookup
    pub fn outputs(&self, input: i32, place: Place, words: &[i32]) -> Outputs {
        let [first, second] = self.sums(words, place.mantissa);
        let octave = self.octave_shift(place.number);
        Outputs {
            values: [
                first.wrapping_shr(octave).wrapping_shr(self.shifts[0]),
                second.wrapping_shr(octave).wrapping_shr(self.shifts[1]),
            ],
            saturated: place.saturated,
            negative: input < 0,
        }
    }
}

/// The upper half of a product.
#[inline(always)]
#[allow(clippy::inline_always)] // one instruction
const fn high(a: u32, b: u32) -> u32 {
    ((a as u64 * b as u64) >> 32) as u32
}

/// `factor * coefficient / 2^16`, rounded down: SMLAWB or SMLAWT with the addition that follows.
#[inline(always)]
#[allow(clippy::inline_always)] // one instruction
pub fn product(factor: i32, coefficient: i16) -> i32 {
    ((i64::from(factor) * i64::from(coefficient)) >> 16) as i32
}

impl<const SEGMENTS: usize, const WORDS: usize> Tables<SEGMENTS, WORDS> {
    /// Bytes of the coefficients; the layout becomes immediates of the code.
    pub const BYTES: usize = size_of::<[[i32; WORDS]; SEGMENTS]>();

    /// Both outputs at an input of at least `-(2^31 - 1)` counts. Total: every input has an answer; `i32::MIN` is negative and
    /// saturated at once.
    #[inline(always)]
    #[allow(clippy::inline_always)] // so that the layout folds into the code of the one call site
    pub fn lookup(&self, input: i32) -> Outputs {
        self.layout.lookup_in(&self.segments, input)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One output `= x` on 0..=11 counts in two octaves of `y = x + 4`, the other `= x^2`.
    ///
    /// An octave that ends at `U` has `y = U (1 - s)`, so with `h = 1/2 - s` and `q = s^2 / 2`: `x = U/2 - 4 + U h`, and
    /// `x^2 = (U - 4)^2 - 2 U (U - 4) s + U^2 s^2 = (U - 4)^2 - U (U - 4) + 2 U (U - 4) h + 2 U^2 q`.
    const fn hand_made(upper: i32, octave: u32, shifts: [u32; 2]) -> [i32; 4] {
        let units = [octave + shifts[0], octave + shifts[1]];
        // A factor of 2^32 times a coefficient over 2^16: coefficients count 2^16 units of the sum.
        let first = [(upper / 2 - 4) << units[0], upper << (units[0] - 16)];
        let second = [
            ((upper - 4) * (upper - 4) - upper * (upper - 4)) << units[1],
            (2 * upper * (upper - 4)) << (units[1] - 16),
            (2 * upper * upper) << (units[1] - 16),
        ];
        [first[0], second[0], first[1] << 16 | second[1], second[2]]
    }

    /// Octaves [4, 8) and [8, 16): 29 and 28 leading zeros, both shifted by 14.
    const HAND_MADE: Tables<2, 4> = Tables {
        layout: Layout {
            fraction_bits: 2,
            maximum: 11,
            bias: 4,
            octaves: 1,
            halvings: 0,
            powers: Powers::Two,
            constant: Constant::Whole,
            first_index: 28,
            shifts: [4, 2],
        },
        segments: [hand_made(16, 14, [4, 2]), hand_made(8, 14, [4, 2])],
    };

    #[test]
    fn evaluates_the_sum_of_the_segment() {
        for input in 0..=11 {
            let outputs = HAND_MADE.lookup(input);
            assert_eq!(outputs.values, [input, input * input]);
            assert!(!outputs.saturated && !outputs.negative);
        }
    }

    #[test]
    fn holds_and_flags_both_ends() {
        let last = HAND_MADE.lookup(11);
        for input in [12, 13, 1 << 20, i32::MAX] {
            let outputs = HAND_MADE.lookup(input);
            assert_eq!(outputs.values, last.values);
            assert!(outputs.saturated && !outputs.negative);
        }
        for input in [-1, -1000, -i32::MAX] {
            let outputs = HAND_MADE.lookup(input);
            assert_eq!(outputs.values, [0, 0]);
            assert!(outputs.negative && !outputs.saturated);
        }
    }

    /// A layout of two octaves a segment.
    fn layout(powers: Powers, constant: Constant) -> Layout {
        Layout {
            octaves: 2,
            powers,
            constant,
            ..HAND_MADE.layout
        }
    }

    #[test]
    fn two_octaves_make_a_segment() {
        let layout = layout(Powers::Four, Constant::Half);
        // y = 4 .. 15: four bits, 28 or 29 zeros.
        for input in 0..=11 {
            let place = layout.place(input);
            assert_eq!(place.number, 14);
            assert_eq!(place.mantissa, ((input + 4) as u32) << 28);
        }
    }

    #[test]
    fn octaves_are_cut_into_halves_and_quarters() {
        let layout = Layout {
            halvings: 2,
            ..HAND_MADE.layout
        };
        // y = 8 .. 15 in quarters of two, counted downwards, after the four of the octave above; each as if it were an octave.
        for input in 4..=11 {
            let place = layout.place(input);
            let y = input as u32 + 4;
            assert_eq!(place.number, 28 * 4 + (15 - y) / 2);
            assert_eq!(place.mantissa, 0x8000_0000 | (y % 2) << 30);
            assert_eq!(layout.octave_shift(place.number), 14);
        }
        assert_eq!(layout.place(0).number, 29 * 4 + 3);
    }

    #[test]
    fn factors_are_the_powers_of_the_distance_from_the_upper_end() {
        let whole = 4_294_967_296.0;
        for mantissa in [1 << 30, 0x5555_5555, 0x8000_0000, 0xdead_beef, u32::MAX] {
            let s = 1.0 - f64::from(mantissa) / whole;
            let (fourth, sixth, eighth) = (s.powi(4) / 4.0, s.powi(6) / 8.0, s.powi(8) / 16.0);
            for (powers, third, last) in [
                (Powers::Two, 0.0, 0.0),
                (Powers::Four, fourth, 0.0),
                (Powers::Six, sixth, 0.0),
                (Powers::Eight, fourth, eighth),
            ] {
                let found = layout(powers, Constant::Whole).factors(mantissa);
                let expected = [0.5 - s, s * s / 2.0, third, last];
                for (found, expected) in found.into_iter().zip(expected) {
                    // Three roundings of one unit at most.
                    assert!(
                        (f64::from(found) - expected * whole).abs() <= 3.0,
                        "{mantissa:#x}"
                    );
                }
            }
        }
    }

    #[test]
    fn words_are_counted_by_constants_and_powers() {
        let words = |powers, constant| layout(powers, constant).words();
        assert_eq!(words(Powers::Four, Constant::Half), 4);
        assert_eq!(words(Powers::Eight, Constant::Whole), 6);
        assert_eq!(Tables::<8, 4>::BYTES, 128);
    }
}
