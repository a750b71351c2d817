//! The lookup on the chip: pressure rise -> force and indentation, integers only.
//!
//! Segments widen geometrically. With `y = clamp(rise, 0, maximum) + bias`, one count of leading zeros names
//! the octave of `y`, one shift left brings its highest set bit to bit 31, and what is left of that word, read
//! as a signed number, *is* the place inside the octave: `t = 2^31 (f - 1)` for a fraction `0 <= f < 1`. Both
//! outputs share it, each a polynomial evaluated by Horner's rule in products that keep their upper 32 bits.
//! There is no search, no division and no branch on data, and no input can panic.
//!
//! The tables of a design are a constant, so the compiler folds everything but the coefficients.

use crate::units::{Micronewtons, Nanometres, PressureRise};

/// Coefficients of one segment, constant term first.
///
/// In units of `2^-shift` of the output. The argument is `u = (f - 1) / 2`, from -1/2 at the segment's lower
/// end to just below 0 at its upper end, so the constant term is the value at the upper end.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
#[repr(C)]
pub struct Segment<const FORCE: usize, const INDENTATION: usize> {
    /// Coefficients of the force, `2^-force_shift` micronewtons.
    pub force: [i32; FORCE],
    /// Coefficients of the indentation, `2^-indentation_shift` nanometres.
    pub indentation: [i32; INDENTATION],
}

/// Where the segments lie: everything of a design's tables but the coefficients.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Layout {
    /// `k`: a count of pressure rise is `1 / 2^k` pascal.
    pub pressure_fraction_bits: u32,
    /// Last input covered, counts; inputs above it read as it does, flagged. `maximum + bias < 2^31`.
    pub maximum: i32,
    /// Added to the input before its octave is taken, counts, >= 1: the first segment starts at zero input.
    pub bias: i32,
    /// Every octave is cut into `2^split_bits` equal segments; 0 or 1.
    pub split_bits: u32,
    /// Number of the first entry of the segments, counting all segments of a 32-bit word downwards from 0.
    pub first_index: u32,
    /// Bits of the force's coefficients below one micronewton.
    pub force_shift: u32,
    /// Bits of the indentation's coefficients below one nanometre.
    pub indentation_shift: u32,
}

/// The tables of one design: `SEGMENTS` segments, polynomials of `FORCE` and `INDENTATION` coefficients.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Tables<const SEGMENTS: usize, const FORCE: usize, const INDENTATION: usize> {
    /// Where the segments lie.
    pub layout: Layout,
    /// Segments downwards: the one of the largest inputs first.
    pub segments: [Segment<FORCE, INDENTATION>; SEGMENTS],
}

/// What the tables say of a pressure rise.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Reading {
    /// Force on the plate.
    pub force: Micronewtons,
    /// Indentation of the pole.
    pub indentation: Nanometres,
    /// The input lay above the tables: force and indentation are lower bounds.
    pub saturated: bool,
    /// The input was negative and read as zero.
    pub negative: bool,
}

/// An input's segment and its place in it.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) struct Place {
    /// Entry of the segments.
    pub(crate) index: usize,
    /// `2^31 (f - 1)` at the fraction `f` of the segment.
    pub(crate) t: i32,
    /// The input lay above [`Layout::maximum`].
    pub(crate) saturated: bool,
    /// The input lay below zero.
    pub(crate) negative: bool,
}

impl Layout {
    /// The pre-lookup that both outputs share.
    #[inline(always)]
    #[allow(clippy::inline_always)] // part of the lookup
    pub(crate) fn place(&self, rise: PressureRise) -> Place {
        // Neither sum of two positive `i32` leaves the `u32`.
        let top = (self.maximum as u32).wrapping_add(self.bias as u32);
        let shifted = (rise.0.max(0) as u32).wrapping_add(self.bias as u32);
        let y = shifted.min(top);
        // `y >= bias`, so its highest bit is not below the bias's: setting that bit changes nothing but what
        // the compiler can prove of the index.
        let lowest_octave = 0x8000_0000_u32.wrapping_shr(self.bias.leading_zeros());
        let leading_zeros = (y | lowest_octave).leading_zeros();
        let normalised = y.wrapping_shl(leading_zeros);
        let (number, place) = if self.split_bits == 0 {
            (leading_zeros, normalised)
        } else {
            let part = (!normalised & 0x7fff_ffff).wrapping_shr(31_u32.wrapping_sub(self.split_bits));
            let place = normalised.wrapping_shl(self.split_bits) | 0x8000_0000;
            (leading_zeros.wrapping_shl(self.split_bits) | part, place)
        };
        Place {
            index: number.wrapping_sub(self.first_index) as usize,
            t: place as i32,
            saturated: shifted > top,
            negative: rise.0 < 0,
        }
    }

    /// The outputs at a place, from its segment's coefficients.
    #[inline(always)]
    #[allow(clippy::inline_always)] // part of the lookup
    pub(crate) fn reading(&self, place: Place, force: &[i32], indentation: &[i32]) -> Reading {
        Reading {
            force: Micronewtons(horner(force, place.t).wrapping_shr(self.force_shift)),
            indentation: Nanometres(horner(indentation, place.t).wrapping_shr(self.indentation_shift)),
            saturated: place.saturated,
            negative: place.negative,
        }
    }
}

impl<const SEGMENTS: usize, const FORCE: usize, const INDENTATION: usize>
    Tables<SEGMENTS, FORCE, INDENTATION>
{
    /// Bytes of the coefficients; the layout becomes immediates of the code.
    pub const BYTES: usize = size_of::<[Segment<FORCE, INDENTATION>; SEGMENTS]>();

    /// Force and indentation at a pressure rise. Total: every `i32` has an answer.
    #[inline(always)]
    #[allow(clippy::inline_always)] // so that the layout folds into the code of the one call site
    pub fn lookup(&self, rise: PressureRise) -> Reading {
        let place = self.layout.place(rise);
        // The index is in range for every input of a generated table; the limit keeps panics out.
        let segment = &self.segments[place.index.min(SEGMENTS - 1)];
        self.layout.reading(place, &segment.force, &segment.indentation)
    }
}

/// `c0 + u (c1 + u (c2 + u c3))` with `u = t / 2^32`, every product rounded down; up to four coefficients.
///
/// Generated coefficients stay below 2^30 in magnitude and `|u| <= 1/2`, so no sum leaves 32 bits.
#[inline(always)]
#[allow(clippy::inline_always)] // part of the lookup
fn horner(coefficients: &[i32], t: i32) -> i32 {
    let coefficient = |power: usize| coefficients.get(power).copied().unwrap_or(0);
    let times_u = |sum: i32| ((i64::from(sum) * i64::from(t)) >> 32) as i32;
    // Written out, as a loop would stay one where the compiler is told to save space.
    let mut sum = 0;
    if coefficients.len() > 3 {
        sum = coefficient(3);
    }
    if coefficients.len() > 2 {
        sum = coefficient(2).wrapping_add(times_u(sum));
    }
    if coefficients.len() > 1 {
        sum = coefficient(1).wrapping_add(times_u(sum));
    }
    coefficient(0).wrapping_add(times_u(sum))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Force `= rise` and indentation `= rise^2` on 0..=12 counts, in two octaves of `y = rise + 4`.
    ///
    /// Octave [4, 8): u = (y - 8) / 8, so y = 8 + 8 u. Octave [8, 16]: y = 16 + 16 u (the last, partial one
    /// ends at y = 15 with maximum 11).
    const HAND_MADE: Tables<2, 2, 3> = Tables {
        layout: Layout {
            pressure_fraction_bits: 2,
            maximum: 11,
            bias: 4,
            split_bits: 0,
            first_index: 28,
            force_shift: 4,
            indentation_shift: 6,
        },
        segments: [
            // rise = 12 + 16 u; rise^2 = 144 + 384 u + 256 u^2.
            Segment {
                force: [12 << 4, 16 << 4],
                indentation: [144 << 6, 384 << 6, 256 << 6],
            },
            // rise = 4 + 8 u; rise^2 = 16 + 64 u + 64 u^2.
            Segment {
                force: [4 << 4, 8 << 4],
                indentation: [16 << 6, 64 << 6, 64 << 6],
            },
        ],
    };

    #[test]
    fn evaluates_the_polynomial_of_the_segment() {
        for rise in 0..=11 {
            let reading = HAND_MADE.lookup(PressureRise(rise));
            assert_eq!(reading.force, Micronewtons(rise));
            assert_eq!(reading.indentation, Nanometres(rise * rise));
            assert!(!reading.saturated && !reading.negative);
        }
    }

    #[test]
    fn holds_and_flags_both_ends() {
        let last = HAND_MADE.lookup(PressureRise(11));
        for rise in [12, 13, 1 << 20, i32::MAX] {
            let reading = HAND_MADE.lookup(PressureRise(rise));
            assert_eq!(
                (reading.force, reading.indentation),
                (last.force, last.indentation)
            );
            assert!(reading.saturated && !reading.negative);
        }
        for rise in [-1, -1000, i32::MIN] {
            let reading = HAND_MADE.lookup(PressureRise(rise));
            assert_eq!(
                (reading.force, reading.indentation),
                (Micronewtons(0), Nanometres(0))
            );
            assert!(reading.negative && !reading.saturated);
        }
    }

    /// The same functions with every octave cut in two: [4, 6) [6, 8) [8, 12) [12, 16).
    #[test]
    fn cuts_octaves_into_equal_parts() {
        let line = |upper: i32, width: i32| Segment {
            force: [(upper - 4) << 4, (2 * width) << 4],
            indentation: [7, 0],
        };
        let tables = Tables::<4, 2, 2> {
            layout: Layout {
                pressure_fraction_bits: 2,
                maximum: 11,
                bias: 4,
                split_bits: 1,
                first_index: 56,
                force_shift: 4,
                indentation_shift: 0,
            },
            segments: [line(16, 4), line(12, 4), line(8, 2), line(6, 2)],
        };
        for rise in 0..=11 {
            assert_eq!(tables.lookup(PressureRise(rise)).force, Micronewtons(rise));
        }
    }

    #[test]
    fn counts_the_bytes_of_the_coefficients() {
        assert_eq!(Tables::<5, 3, 3>::BYTES, 120);
    }
}
