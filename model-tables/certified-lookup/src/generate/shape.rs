//! Shapes that tables can take: how a segment is made, and where the segments lie.

use crate::layout::{Constant, Layout, Powers};

/// Candidate biases in an octave: multiples of an eighth of it, so that the bias fits one instruction.
const BIASES_PER_OCTAVE: i32 = 8;
/// Inputs a segment needs, so that its sum is determined by them.
const MIN_COUNTS: i32 = 12;
/// Significant bits of a constant that fits one instruction.
const IMMEDIATE_BITS: u32 = 8;

/// How the segments of a layout are made.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) struct Shape {
    pub(super) octaves: u32,
    pub(super) halvings: u32,
    pub(super) powers: Powers,
    pub(super) constant: Constant,
}

impl Shape {
    /// Every shape, in the order of their cost: words of a segment, then instructions.
    pub(super) const ALL: [Self; 10] = [
        Self::new(1, Powers::Two, Constant::Half),
        Self::new(2, Powers::Two, Constant::Half),
        Self::new(1, Powers::Four, Constant::Half),
        Self::new(2, Powers::Four, Constant::Half),
        Self::new(2, Powers::Six, Constant::Half),
        Self::new(2, Powers::Four, Constant::Whole),
        Self::new(2, Powers::Eight, Constant::Half),
        Self::new(1, Powers::Four, Constant::Whole),
        Self::new(2, Powers::Eight, Constant::Whole),
        Self::new(1, Powers::Eight, Constant::Whole),
    ];

    /// For curves that no other fits: octaves cut into halves, quarters and eighths.
    pub(super) const CUT: [Self; 3] = [
        Self::new(1, Powers::Four, Constant::Whole).cut(1),
        Self::new(1, Powers::Four, Constant::Whole).cut(2),
        Self::new(1, Powers::Four, Constant::Whole).cut(3),
    ];

    const fn new(octaves: u32, powers: Powers, constant: Constant) -> Self {
        Self {
            octaves,
            halvings: 0,
            powers,
            constant,
        }
    }

    const fn cut(self, halvings: u32) -> Self {
        Self { halvings, ..self }
    }

    /// The layout of this shape for a unit, a last input and a bias, the rest still zero.
    pub(super) const fn layout(self, fraction_bits: u32, maximum: i32, bias: i32) -> Layout {
        Layout {
            fraction_bits,
            maximum,
            bias,
            octaves: self.octaves,
            halvings: self.halvings,
            powers: self.powers,
            constant: self.constant,
            first_index: 0,
            shifts: [0; 2],
        }
    }

    /// Bytes of a segment.
    pub(super) const fn bytes(self) -> usize {
        4 * self.layout(0, 0, 1).words()
    }
}

/// Instructions from an input to both outputs and the flag, inlined, as rustc makes them for the chip: counted from its
/// listings, without what the code around them makes it spill.
pub(super) fn instructions(layout: &Layout) -> u32 {
    let maximum = i64::from(layout.maximum);
    let held = if power_of_two(layout.maximum) == maximum {
        1
    } else if immediate(layout.maximum) == maximum {
        4
    } else {
        6
    };
    // Bias, flag, zeros, mantissa, its factors 1 and 2; the sums' constants and the shifts of both.
    let common = 1 + 2 + 1 + 1 + 3 + 2;
    let octaves = if layout.octaves == 2 { 2 } else { 1 } + if layout.halvings > 0 { 5 } else { 0 };
    let powers = match layout.powers {
        Powers::Two => 0,
        Powers::Four => 1,
        Powers::Six | Powers::Eight => 2,
    };
    let words = layout.words();
    // The address of a segment, then loads of two words at a time.
    let loads = if words == 4 { 3 } else { 4 } + words.div_ceil(2) as u32;
    let products = 2 * layout.powers.terms() as u32;
    let shifts: u32 = layout.shifts.map(|shift| u32::from(shift > 0)).iter().sum();
    held + common + octaves + powers + loads + products + shifts
}

/// One way to cut `0..=maximum` into segments.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Segmentation {
    /// The layout, its shifts still zero.
    pub(super) layout: Layout,
    /// Segments upwards.
    pub(super) spans: Vec<Span>,
}

/// One segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Span {
    /// Its number.
    pub(super) number: u32,
    /// First count in it.
    pub(super) start: i32,
    /// First count after it (one past the maximum in the last).
    pub(super) end: i32,
}

impl Segmentation {
    /// The segments of a layout, if each holds enough counts.
    pub(super) fn of(mut layout: Layout) -> Option<Self> {
        let number = |count: i32| layout.place(count).number;
        let (first, last) = (number(0), number(layout.maximum));
        let mut spans = Vec::with_capacity((first - last + 1) as usize);
        let mut start = 0;
        for number in (last..=first).rev() {
            let end = if number == last {
                i64::from(layout.maximum) + 1
            } else {
                upper(&layout, number)? - i64::from(layout.bias)
            };
            if end - i64::from(start) < i64::from(MIN_COUNTS) {
                return None;
            }
            let end = end as i32;
            spans.push(Span { number, start, end });
            start = end;
        }
        layout.first_index = last;
        Some(Self { layout, spans })
    }
}

/// Upper end of a segment, exclusive, bias included; `None` where it has less than a count.
fn upper(layout: &Layout, number: u32) -> Option<i64> {
    let end = 1_i64 << (32 - (number >> layout.halvings) * layout.octaves);
    let parts = 2_i64 << layout.halvings;
    // Parts of the octave above this segment's, of the `parts` below its end.
    let above = i64::from(number & ((1 << layout.halvings) - 1));
    (end >= parts).then(|| end - above * (end / parts))
}

/// The biases with which a shape may have `segments` segments up to `maximum`, increasing.
pub(super) fn biases(shape: Shape, maximum: i32, segments: u32) -> impl Iterator<Item = i32> {
    let Shape {
        octaves, halvings, ..
    } = shape;
    // Octaves are counted here; the topmost may lack some of its parts.
    let segments = segments.div_ceil(1 << halvings);
    // The lowest segment of so many, if the bias does not lift the highest input into another: it hardly does.
    let last = (maximum as u32).leading_zeros() / octaves;
    let number = last + segments - 1;
    let exponents = (0..octaves).filter_map(move |octave| {
        let exponent = 32_u32.checked_sub((number + 1) * octaves)? + octave;
        (3..30).contains(&exponent).then_some(exponent)
    });
    exponents.flat_map(|exponent| {
        (0..BIASES_PER_OCTAVE).map(move |part| (1 << exponent) + part * ((1 << exponent) / BIASES_PER_OCTAVE))
    })
}

/// The least count at or above `count` up to which the chip holds an input in one instruction (USAT): `2^n - 1`.
pub(super) const fn power_of_two(count: i32) -> i64 {
    (1 << (64 - (count as i64).leading_zeros())) - 1
}

/// The least count at or above `count` that fits one instruction of the chip.
pub(super) const fn immediate(count: i32) -> i64 {
    let count = count as i64;
    let bits = 64 - count.leading_zeros();
    let low = bits.saturating_sub(IMMEDIATE_BITS);
    ((count + (1 << low) - 1) >> low) << low
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_agree_with_the_lookup_on_every_count() {
        let shape = |octaves, halvings| Shape::new(octaves, Powers::Four, Constant::Half).cut(halvings);
        for shape in [shape(1, 0), shape(2, 0), shape(1, 1), shape(1, 2)] {
            for segments in 1..12 {
                for bias in biases(shape, 3000, segments) {
                    let Some(segmentation) = Segmentation::of(shape.layout(2, 3000, bias)) else {
                        continue;
                    };
                    assert_eq!(segmentation.spans[0].start, 0);
                    assert_eq!(segmentation.spans[segmentation.spans.len() - 1].end, 3001);
                    for span in &segmentation.spans {
                        for count in span.start..span.end {
                            let place = segmentation.layout.place(count);
                            assert_eq!(place.number, span.number);
                            // As far below the segment's upper end as its mantissa is below one; a part of an octave
                            // counts as the upper half of one.
                            let upper =
                                2_f64.powi(32 - ((span.number >> shape.halvings) * shape.octaves) as i32);
                            let part = f64::from(span.number & ((1 << shape.halvings) - 1));
                            let parts = f64::from(1_u32 << shape.halvings);
                            let below = 1.0 - f64::from(place.mantissa) / 4_294_967_296.0;
                            let y = upper * (1.0 - (below + 0.5 * part) / parts);
                            assert!((y - f64::from(count + bias)).abs() < 1e-9, "{y} {count} {bias}");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn biases_give_as_many_segments_as_asked() {
        for segments in 2..6 {
            let shape = Shape::new(2, Powers::Four, Constant::Half);
            let all: Vec<i32> = biases(shape, 600_000, segments).collect();
            assert_eq!(all.len(), 16);
            assert!(all.is_sorted());
            for bias in all {
                let found = Segmentation::of(shape.layout(4, 600_000, bias)).expect("wide enough");
                assert_eq!(found.spans.len(), segments as usize);
            }
        }
    }

    #[test]
    fn a_power_of_two_less_one_is_never_below() {
        assert_eq!(power_of_two(1_036_247), (1 << 20) - 1);
        assert_eq!(power_of_two((1 << 20) - 1), (1 << 20) - 1);
        assert_eq!(power_of_two(1 << 20), (1 << 21) - 1);
    }

    #[test]
    fn immediates_have_eight_significant_bits_and_are_never_below() {
        assert_eq!(immediate(255), 255);
        assert_eq!(immediate(257), 258);
        assert_eq!(immediate(1_036_247), 0xfd << 12);
        for count in [1, 255, 256, 257, 70_000, 1_036_247, i32::MAX] {
            let found = immediate(count);
            assert!(found >= i64::from(count) && found as f64 <= f64::from(count) * (1.0 + 1.0 / 128.0));
            assert!(64 - found.leading_zeros() - found.trailing_zeros() <= 8);
        }
    }
}
