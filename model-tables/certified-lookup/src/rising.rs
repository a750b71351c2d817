//! Proves that tables never fall, without evaluating every input. A part of a segment is accepted at once if its sum grows by more
//! at each count than rounding can take away. Otherwise it is checked count by count.
//!
//! Within a segment an output is its sum `S`, shifted, and shifting keeps the order. With `s` the distance from the segment's
//! upper end and `c` its coefficients,
//! `S = c0 + 2^16 (c1 (1/2 - s) + c2 s^2/2 + c3 s^4/4 + c4 s^8/16)` up to rounding (or `c3 s^6/8`), so that towards that end it
//! grows by `2^16 (c1 - c2 s - c3 s^3 - c4 s^7/2)` for the whole of `s` (or `c3 s^5 3/4`).

use crate::error::TablesError;
use crate::layout::{Constant, Layout, Powers};
use crate::segments::Segments;

/// From one count to the next, rounding takes less than this from a sum: four products rounded down lose below 1 each, and
/// their factors, rounded down by less than 1, 1.6 and 1.6 units of `2^-32`, at most half of that each.
const ROUNDING: i64 = 7;

/// Stretches looked at in one segment, of one output, at most: it bounds the work.
const MAX_STRETCHES: u32 = 1 << 12;

/// Room at either end of the word that a sum keeps, for what rounding adds.
const ROOM: i64 = 16;

/// Shows that these outputs (0, 1) fall nowhere.
///
/// # Errors
/// [`TablesError::Falls`], [`TablesError::Flat`].
pub fn rises(tables: &Segments, outputs: &[usize]) -> Result<(), TablesError> {
    let maximum = tables.layout.maximum;
    let mut start = 0;
    loop {
        let end = last_of_segment(&tables.layout, start);
        for &output in outputs {
            if start > 0 && at(tables, output, start) < at(tables, output, start - 1) {
                return Err(TablesError::Falls(start - 1));
            }
            rises_in_segment(tables, output, start, end)?;
        }
        if end >= maximum {
            return Ok(());
        }
        start = end + 1;
    }
}

/// The last count in the segment of this one, by bisection: the number never rises with the count.
fn last_of_segment(layout: &Layout, count: i32) -> i32 {
    let number = |count: i32| layout.place(count).number;
    let own = number(count);
    let (mut within, mut beyond) = (count, layout.maximum + 1);
    while beyond - within > 1 {
        let middle = within + (beyond - within) / 2;
        if number(middle) == own {
            within = middle;
        } else {
            beyond = middle;
        }
    }
    within
}

/// An output at a count.
fn at(tables: &Segments, output: usize, count: i32) -> i32 {
    let [first, second] = tables.lookup(count).values;
    if output == 0 { first } else { second }
}

/// In one segment, from its first count to its last.
fn rises_in_segment(tables: &Segments, output: usize, start: i32, end: i32) -> Result<(), TablesError> {
    let layout = &tables.layout;
    let number = layout.place(start).number;
    let segment = tables.segment(number.wrapping_sub(layout.first_index) as usize);
    let sum = Sum::of(layout, &segment, output);
    let (mut from, mut length) = (start, end - start);
    for _ in 0..MAX_STRETCHES {
        if from >= end {
            return Ok(());
        }
        let to = from.saturating_add(length).min(end);
        if at(tables, output, to) < at(tables, output, from) {
            return Err(TablesError::Falls(from));
        }
        if to - from == 1 || sum.grows(layout, from, to) {
            from = to;
            length = length.saturating_mul(2);
        } else {
            length = (to - from) / 2;
        }
    }
    Err(TablesError::Flat(end))
}

/// One output's sum in a segment.
struct Sum {
    constant: i32,
    /// Of `1/2 - s`, `s^2 / 2`, and the powers beyond as [`Powers`] has them.
    coefficients: [i64; 4],
}

impl Sum {
    fn of(layout: &Layout, segment: &[i32; Layout::MAX_WORDS], output: usize) -> Self {
        let half = |word: i32| {
            i64::from(if output == 0 {
                (word >> 16) as i16
            } else {
                word as i16
            })
        };
        let [upper, lower, pairs @ ..] = *segment;
        let constant = if output == 0 { upper } else { lower };
        let [first, second, third, fourth] = pairs.map(half);
        let coefficients = match layout.constant {
            Constant::Half => [i64::from(constant as i16), first, second, third],
            Constant::Whole => [first, second, third, fourth],
        };
        Self {
            constant,
            coefficients,
        }
    }

    /// Whether the sum grows at each count from one to another of the segment, by more than rounding takes, and stays
    /// within its word.
    fn grows(&self, layout: &Layout, from: i32, to: i32) -> bool {
        let mantissa = |count: i32| layout.place(count).mantissa;
        let (low, high) = (mantissa(from), mantissa(to));
        if high <= low {
            return false;
        }
        let fits = |mantissa: u32| {
            let sum = self.at(layout, mantissa);
            i64::from(i32::MIN) + ROOM < sum && sum < i64::from(i32::MAX) - ROOM
        };
        // Of the mantissa for one count: it is linear in the count.
        let step = i64::from(high - low) / i64::from(to - from);
        // Below 2^33 units of 2^-16 of a coefficient; a count is `step` of 2^32.
        let slope = self.least_slope(layout.powers, [distance(high, 0), distance(low, 0xFFFF)]);
        step > 0 && slope > (ROUNDING << 32) / step && fits(low) && fits(high)
    }

    /// The sum at a mantissa, in as many bits as it takes.
    fn at(&self, layout: &Layout, mantissa: u32) -> i64 {
        let products = layout
            .factors(mantissa)
            .into_iter()
            .zip(self.coefficients)
            // 2^31 * 2^15.
            .map(|(factor, coefficient)| (i64::from(factor) * coefficient) >> 16);
        i64::from(self.constant) + products.sum::<i64>()
    }

    /// The least of `c1 - c2 s - ...` between two distances in units of `2^-16`, in the same units.
    fn least_slope(&self, powers: Powers, distances: [i64; 2]) -> i64 {
        let [first, second, third, fourth] = self.coefficients;
        // Rounded outwards; at most 2^16 each.
        let product = |[a, b]: [i64; 2], [c, d]: [i64; 2]| [(a * c) >> 16, ((b * d) >> 16) + 1];
        let square = product(distances, distances);
        let cube = product(square, distances);
        let fifth = product(cube, square);
        let seventh = product(fifth, square);
        let largest = |coefficient: i64, [low, high]: [i64; 2]| (coefficient * low).max(coefficient * high);
        let beyond = match powers {
            Powers::Two => 0,
            Powers::Four => largest(third, cube),
            Powers::Six => largest(third, [fifth[0] * 3 / 4, fifth[1] * 3 / 4 + 1]),
            Powers::Eight => largest(third, cube) + largest(fourth, [seventh[0] / 2, seventh[1] / 2 + 1]),
        };
        (first << 16) - largest(second, distances) - beyond
    }
}

/// `1 - m` in units of `2^-16`, with `round` of `2^-32` added before it is cut off.
fn distance(mantissa: u32, round: i64) -> i64 {
    ((1 << 32) - i64::from(mantissa) + round) >> 16
}
