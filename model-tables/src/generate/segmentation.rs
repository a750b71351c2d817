//! Where segments can lie: a bias, and octaves whole or in halves.

use crate::table::Layout;
use crate::units::PressureRise;

/// Candidate biases in an octave: multiples of an eighth of it, so that the bias fits one instruction.
const BIASES_PER_OCTAVE: i32 = 8;

/// Inputs a segment needs, so that a cubic is determined by them.
const LEAST_COUNTS: i32 = 4;

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
    /// First count in it.
    pub(super) start: i32,
    /// First count after it (one past the maximum in the last).
    pub(super) end: i32,
    /// Count at which the fraction reaches one; `end`, but in the last segment possibly beyond it.
    pub(super) upper: f64,
    /// Counts of the whole segment.
    pub(super) width: f64,
}

impl Span {
    /// The polynomial's argument at a (real) count: `(f - 1) / 2`.
    #[cfg(test)]
    pub(super) fn argument(&self, count: f64) -> f64 {
        0.5 * (count - self.upper) / self.width
    }
}

/// All candidates with at most `most` segments, fewest segments first.
pub(super) fn candidates(fraction_bits: u32, maximum: i32, most: usize) -> Vec<Segmentation> {
    let mut all = Vec::new();
    for split_bits in [0, 1] {
        for exponent in 3..30 {
            for part in 0..BIASES_PER_OCTAVE {
                let bias = (1 << exponent) + part * ((1 << exponent) / BIASES_PER_OCTAVE);
                if i64::from(maximum) + i64::from(bias) >= 1 << 31 {
                    continue;
                }
                let layout = Layout {
                    pressure_fraction_bits: fraction_bits,
                    maximum,
                    bias,
                    split_bits,
                    first_index: 0,
                    force_shift: 0,
                    indentation_shift: 0,
                };
                if let Some(segmentation) = cut(layout, most) {
                    all.push(segmentation);
                }
            }
        }
    }
    all.sort_by_key(|segmentation| segmentation.spans.len());
    all
}

/// The segments of a layout, found by asking the layout itself.
fn cut(mut layout: Layout, most: usize) -> Option<Segmentation> {
    let number = |count: i32| layout.place(PressureRise(count)).index;
    let (first, last) = (number(0), number(layout.maximum));
    if first - last >= most {
        return None;
    }
    let mut spans = Vec::with_capacity(first - last + 1);
    let mut start = 0;
    for index in (last..=first).rev() {
        // The octave's lowest value of y, and the segment's share of it.
        let zeros = (index >> layout.split_bits) as u32;
        let octave = f64::from(0x8000_0000_u32 >> zeros);
        let parts = 1_usize << layout.split_bits;
        let width = octave / parts as f64;
        let part = parts - 1 - (index & (parts - 1));
        let upper = octave + width * (part + 1) as f64 - f64::from(layout.bias);
        let end = if index == last {
            layout.maximum + 1
        } else {
            upper as i32
        };
        if end - start < LEAST_COUNTS {
            return None;
        }
        spans.push(Span {
            start,
            end,
            upper,
            width,
        });
        start = end;
    }
    layout.first_index = last as u32;
    Some(Segmentation { layout, spans })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_agree_with_the_lookup_on_every_count() {
        for segmentation in candidates(2, 3000, 12) {
            let segments = segmentation.spans.len();
            for (i, span) in segmentation.spans.iter().enumerate() {
                for count in span.start..span.end {
                    let place = segmentation.layout.place(PressureRise(count));
                    assert_eq!(place.index, segments - 1 - i);
                    // u = t / 2^32
                    let u = f64::from(place.t) / 4_294_967_296.0;
                    assert!((u - span.argument(f64::from(count))).abs() < 1e-9);
                }
            }
            assert_eq!(segmentation.spans[0].start, 0);
            assert_eq!(segmentation.spans[segments - 1].end, 3001);
        }
    }

    #[test]
    fn offers_few_segments_first() {
        let all = candidates(0, 100_000, 8);
        assert!(all.len() > 50);
        assert!(all.is_sorted_by_key(|segmentation| segmentation.spans.len()));
        assert!(all.iter().all(|segmentation| segmentation.spans.len() <= 8));
    }
}
