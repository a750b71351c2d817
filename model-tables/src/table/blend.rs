//! Tables of an object between a flat plate and a reference ball: their coefficients, blended once.
//!
//! Plate and ball have tables of one layout. For another object each output is `plate + w (ball - plate)` at every pressure,
//! with its own weight `w` ([`law`](super::law)). The sum of a segment is linear in its coefficients, so the coefficients are
//! blended and not the outputs. A lookup then costs as much as with one table. Rounding could make an output fall between two
//! segments. To prevent this, a segment's constant is raised until the segment begins where the one below ends. The lowest
//! segment, first contact, is the same for plate and ball, and so for every blend: zero reads zero.

use super::law::{WEIGHT_BITS, Weights};
use super::{Constant, Layout, LoadedTables, Reading, TablesError};
use crate::units::PressureRise;
use certified_lookup::Segments;

/// Largest number of words of a table that is blended at run time: 40 segments with 6 words each. 40 is the largest number of
/// segments of one or two octaves.
pub const MAX_WORDS: usize = 240;

/// Blends the words of two tables of one layout, [`Layout::words`] a segment, the segment of the largest inputs first. Layouts
/// with halvings are not blended: the result has the plate's words.
pub fn blend(layout: &Layout, plate: &[i32], ball: &[i32], weights: &Weights, blended: &mut [i32]) {
    let width = layout.words();
    let count = plate.len() / width;
    let mut below = None;
    for index in (0..count).rev() {
        let range = index * width..(index + 1) * width;
        let (Some(plate), Some(ball), Some(own)) = (
            plate.get(range.clone()),
            ball.get(range.clone()),
            blended.get_mut(range),
        ) else {
            return;
        };
        own.copy_from_slice(plate);
        if layout.halvings > 0 {
            continue;
        }
        mix(layout.constant, ball, weights, own);
        let number = layout.first_index.wrapping_add(index as u32);
        // The first input of the segment, including the bias.
        let first = 1_u32 << (32_u32.saturating_sub(layout.octaves * (number + 1)) & 31);
        let at = |words: &[i32], number: u32, input: u32| {
            let mantissa = input.wrapping_shl(layout.octaves * number);
            let octave = layout.octave_shift(number);
            let [force, indentation] = layout.sums(words, mantissa);
            [
                force.wrapping_shr(octave + layout.shifts[0]),
                indentation.wrapping_shr(octave + layout.shifts[1]),
            ]
        };
        if let Some(ends) = below {
            let starts = at(own, number, first);
            let octave = layout.octave_shift(number);
            let shifts = [octave + layout.shifts[0], octave + layout.shifts[1]];
            raise(layout.constant, starts, ends, shifts, own);
        }
        // The output below which the segment above must not begin.
        let last = (u64::from(first) << layout.octaves) - 1;
        below = Some(at(own, number, last as u32));
    }
}

/// The words of a segment. They start as those of the plate.
fn mix(constant: Constant, ball: &[i32], weights: &Weights, own: &mut [i32]) {
    for (at, (word, &ball)) in own.iter_mut().zip(ball).enumerate() {
        let plate = *word;
        let weight = if at == 0 {
            weights.force
        } else {
            weights.indentation
        };
        *word = match (at, constant) {
            (0 | 1, Constant::Whole) => between(plate, ball, weight),
            (0 | 1, Constant::Half) => {
                let linear = half(plate as i16, ball as i16, weight) as u16;
                // The lower half is the linear coefficient and the constant's fraction.
                let above = between(plate, ball, weight).wrapping_sub(i32::from(linear));
                (above.saturating_add(0x8000) >> 16) << 16 | i32::from(linear)
            }
            _ => {
                let force = half((plate >> 16) as i16, (ball >> 16) as i16, weights.force);
                let indentation = half(plate as i16, ball as i16, weights.indentation);
                i32::from(force) << 16 | i32::from(indentation as u16)
            }
        };
    }
}

/// Raises the constants of a segment that would begin below the end of the previous one.
fn raise(constant: Constant, starts: [i32; 2], ends: [i32; 2], shifts: [u32; 2], own: &mut [i32]) {
    for (((word, start), end), shift) in own.iter_mut().zip(starts).zip(ends).zip(shifts) {
        let missing = end.saturating_sub(start);
        if missing > 0 {
            let sum = i64::from(missing) << shift.min(31);
            let sum = match constant {
                Constant::Half => (sum + 0xFFFF) & !0xFFFF,
                Constant::Whole => sum,
            };
            *word = held(i64::from(*word) + sum);
        }
    }
}

/// The blend of two words. The weight is in units of `2^-WEIGHT_BITS`.
fn between(plate: i32, ball: i32, weight: i32) -> i32 {
    // At most 2^32 times 2^31.
    let apart = (i64::from(ball) - i64::from(plate)).saturating_mul(i64::from(weight));
    held(i64::from(plate) + (apart.saturating_add(1 << (WEIGHT_BITS - 1)) >> WEIGHT_BITS))
}

/// The blend of two coefficients.
fn half(plate: i16, ball: i16, weight: i32) -> i16 {
    let value = between(i32::from(plate), i32::from(ball), weight);
    value.clamp(i32::from(i16::MIN), i32::from(i16::MAX)) as i16
}

fn held(value: i64) -> i32 {
    value.clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32
}

/// The last input of a blend. It is at most the end of the weights. Its indentation is at most that of the plate's tables plus
/// a thirty-second, which is the error of the blend. A ball reaches that depth at a lower pressure than the plate.
pub fn last_answered(
    layout: &Layout,
    weights: &Weights,
    plate: impl Fn(PressureRise) -> Reading,
    blended: impl Fn(PressureRise) -> Reading,
) -> i32 {
    let deepest = plate(PressureRise(layout.maximum)).indentation.0;
    let deepest = deepest.saturating_add(deepest / 32);
    let is_within = |input| blended(PressureRise(input)).indentation.0 <= deepest;
    let last = weights.maximum.min(layout.maximum);
    if is_within(last) {
        return last;
    }
    // Indentations do not fall.
    let (mut within, mut beyond) = (0, last);
    while beyond - within > 1 {
        let middle = i32::midpoint(within, beyond);
        if is_within(middle) {
            within = middle;
        } else {
            beyond = middle;
        }
    }
    within
}

/// Blended tables of a design that is known at run time only.
#[derive(Clone, Copy, Debug)]
pub struct BlendedTables {
    layout: Layout,
    words: [[u8; 4]; MAX_WORDS],
    length: usize,
}

impl BlendedTables {
    /// Blends two tables of one layout, and checks the result like [`LoadedTables`].
    ///
    /// # Errors
    /// [`TablesError`] if the blend may give wrong values.
    pub fn new(
        layout: &Layout,
        plate: &[[u8; 4]],
        ball: &[[u8; 4]],
        weights: &Weights,
    ) -> Result<Self, TablesError> {
        let (mut from, mut to, mut blended) = ([0; MAX_WORDS], [0; MAX_WORDS], [0; MAX_WORDS]);
        let length = plate.len();
        let (Some(own), true) = (blended.get_mut(..length), ball.len() == length) else {
            return Err(TablesError::Words {
                needed: length.min(MAX_WORDS),
                found: ball.len(),
            });
        };
        for (words, bytes) in [(&mut from, plate), (&mut to, ball)] {
            for (word, bytes) in words.iter_mut().zip(bytes) {
                *word = i32::from_le_bytes(*bytes);
            }
        }
        blend(
            layout,
            from.get(..length).unwrap_or(&[]),
            to.get(..length).unwrap_or(&[]),
            weights,
            own,
        );
        let words = blended.map(i32::to_le_bytes);
        LoadedTables::new(*layout, words.get(..length).unwrap_or(&[]))?;
        let plate = Segments {
            layout: *layout,
            words: plate,
        };
        let mut blended = Self {
            layout: *layout,
            words,
            length,
        };
        blended.layout.maximum = last_answered(
            layout,
            weights,
            |rise| plate.lookup(rise.0).into(),
            |rise| blended.lookup(rise),
        );
        Ok(blended)
    }

    /// Force and indentation at a pressure rise. Total: every `i32` has an answer.
    pub fn lookup(&self, rise: PressureRise) -> Reading {
        let words = self.words.get(..self.length).unwrap_or(&[]);
        Segments {
            layout: self.layout,
            words,
        }
        .lookup(rise.0)
        .into()
    }

    /// The last rise at which the outputs are values and not bounds.
    pub const fn last_rise(&self) -> PressureRise {
        PressureRise(self.layout.maximum)
    }
}
