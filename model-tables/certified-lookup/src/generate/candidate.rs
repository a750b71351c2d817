//! Makes the integers of one segmentation: the sums of each segment are rounded, close enough to the curve to rise with it.

use super::AccuracyGoal;
use super::bounds::{Range, Sum};
use super::minimax::{FitSample, MAX_COEFFICIENTS, fit};
use super::owned::OwnedTables;
use super::quantise::{Coefficients, round};
use super::shape::{Segmentation, Span, instructions};
use super::truth::Truth;
use crate::layout::{Constant, Layout};
use std::cell::Cell;

/// Number of samples of a segment that a fit uses. The certificate checks every input.
const SAMPLES: usize = 41;
/// The samples do not cover every input, so the integers must stay this far inside the tolerance.
const MARGIN: f64 = 0.985;
/// Sums stay below this share of 2^31.
const FULL: f64 = 0.98;
/// Parts of the tolerance that a sum may be fitted to. Where the tolerance is much of the output, as at first contact, a sum that
/// merely keeps to it may fall, or leave the next one no room to rise; the curve rises, and so does what is near enough to it.
const CLOSER: [f64; 5] = [1.0, 0.25, 0.0625, 0.015_625, 0.003_906_25];

/// Shifts of an output's own that are tried, beside none.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Shifts {
    None,
    Largest,
    Every,
}

/// One segmentation of the input, its samples in both outputs, and the error of sums with real coefficients.
pub(super) struct Candidate<'a> {
    pub(super) truth: &'a Truth,
    pub(super) segmentation: Segmentation,
    pub(super) error: f64,
    pub(super) work: &'a Work,
}

/// Sums that a search rounded so far, one segment of one output each.
#[derive(Default)]
pub(super) struct Work(Cell<u32>);

impl Work {
    pub(super) fn rounded(&self) -> u32 {
        self.0.get()
    }
}

impl Candidate<'_> {
    pub(super) fn instructions(&self) -> u32 {
        instructions(&self.segmentation.layout)
    }

    /// Whether the sums of both outputs fit a word.
    pub(super) fn fits(&self) -> bool {
        self.spare_bits(0).is_some() && self.spare_bits(1).is_some()
    }

    /// Integers for it, if rounding leaves it within the tolerance and never falling: without shifts of the outputs' own, or with
    /// one at least.
    pub(super) fn finish(&self, goal: &AccuracyGoal, shifts: Shifts) -> Option<OwnedTables> {
        let mut layout = self.segmentation.layout;
        let spare = [0, 1].map(|output| self.spare_bits(output));
        let [Some(first), Some(second)] = spare else {
            return None;
        };
        let mut found = Vec::new();
        for (output, most) in [first, second].into_iter().enumerate() {
            let least = match shifts {
                Shifts::None => most + 1,
                Shifts::Largest => most.max(1),
                Shifts::Every => 1,
            };
            let (shift, sums) = std::iter::once(0).chain((least..=most).rev()).find_map(|shift| {
                let spans = &self.segmentation.spans;
                Some((shift, self.integers(&layout, output, shift, goal, spans, 0)?))
            })?;
            found.push((shift, sums));
        }
        if shifts != Shifts::None && found.iter().all(|&(shift, _)| shift == 0) {
            return None;
        }
        layout.shifts = [found[0].0, found[1].0];
        Some(assemble(layout, &found[0].1, &found[1].1))
    }

    /// The sums of the first output alone and their shift, segments upwards: without a shift of its own, or with one that lets
    /// rounding keep to the tolerance.
    pub(super) fn first_alone(&self, goal: &AccuracyGoal) -> Option<(u32, Vec<Coefficients>)> {
        let Segmentation { layout, spans } = &self.segmentation;
        let most = self.spare_bits(0)?;
        std::iter::once(0)
            .chain((1..=most).rev())
            .find_map(|shift| Some((shift, self.integers(layout, 0, shift, goal, spans, 0)?)))
    }

    /// Tables of this candidate's curve in the layout of others, with their lowest segment; beyond it from these outputs on.
    pub(super) fn beside(
        &self,
        others: &OwnedTables,
        before: [i32; 2],
        goal: &AccuracyGoal,
    ) -> Option<OwnedTables> {
        let layout = others.layout;
        let (_, spans) = self.segmentation.spans.split_first()?;
        let integers = |output: usize, shift: u32, before: i32| {
            if self.spare_bits(output)? < shift {
                return None;
            }
            self.integers(&layout, output, shift, goal, spans, before)
        };
        let first = integers(0, layout.shifts[0], before[0])?;
        let second = integers(1, layout.shifts[1], before[1])?;
        let mut tables = assemble(layout, &first, &second);
        tables.words.extend(others.segment(spans.len()));
        Some(tables)
    }

    /// Bits that an output's sums could be larger by, `None` if they do not fit a word as they are.
    fn spare_bits(&self, output: usize) -> Option<u32> {
        let largest = self
            .segmentation
            .spans
            .iter()
            .map(|span| {
                let shift = self.segmentation.layout.octave_shift(span.number);
                // Both outputs grow, so that a segment's largest value is its last.
                libm::ldexp(self.truth.at(span.end - 1)[output] + 1.0, shift as i32)
            })
            .fold(0.0, f64::max);
        let room = FULL * 2_147_483_648.0 / largest;
        (room >= 1.0).then(|| libm::floor(libm::log2(room)) as u32)
    }

    /// The integers of one output, segments upwards, from an output of at least `before` on.
    fn integers(
        &self,
        layout: &Layout,
        output: usize,
        shift: u32,
        goal: &AccuracyGoal,
        spans: &[Span],
        before: i32,
    ) -> Option<Vec<Coefficients>> {
        let tolerance = Tolerance::both(self.truth, goal)[output];
        let rising = Rising {
            layout,
            output,
            shift,
            tolerance,
            spans,
            before,
        };
        // Where real coefficients are not exact enough, rounding is not tried: the last segment's are the largest, those of the first have
        // the fewest digits.
        for span in [spans.last()?, spans.first()?] {
            let samples = self.windows(layout, output, shift, tolerance, span, 0)?;
            if fit(&samples, 1 + layout.powers.terms(), &[0.0; MAX_COEFFICIENTS]).error >= MARGIN {
                return None;
            }
        }
        let mut found = Err(Failed::Falls);
        for closest in 0..CLOSER.len() {
            found = self.rising(&rising, closest);
            if !matches!(found, Err(Failed::Falls)) {
                break;
            }
        }
        found.ok()
    }

    /// The same, each segment fitted to a part of the tolerance, a closer one or else a wider one, with which it rises on from the
    /// segment below.
    fn rising(&self, rising: &Rising<'_>, first: usize) -> Result<Vec<Coefficients>, Failed> {
        let &Rising {
            layout,
            output,
            shift,
            tolerance,
            spans,
            mut before,
        } = rising;
        let mut all = Vec::with_capacity(spans.len());
        for span in spans {
            let fitted = |closer: &f64, before: i32| {
                let tolerance = Tolerance {
                    share: closer * tolerance.share,
                    ..tolerance
                };
                let samples = self.windows(layout, output, shift, tolerance, span, before)?;
                self.work.0.set(self.work.rounded() + 1);
                round(&samples, layout.powers.terms(), layout.constant, MARGIN)
            };
            let (closer, wider) = (CLOSER[first..].iter(), CLOSER[..first].iter().rev());
            // If a share of the tolerance cannot be met, a smaller share cannot be met either.
            let mut fits = closer
                .map_while(|closer| fitted(closer, before))
                .chain(wider.filter_map(|wider| fitted(wider, before)));
            let range = Range {
                first: span.start,
                last: span.end - 1,
            };
            let rises = |coefficients: Coefficients| {
                let sum = Sum {
                    layout,
                    coefficients,
                    shift: layout.octave_shift(span.number) + shift,
                };
                (!sum.falls(range)).then(|| (coefficients, sum.at(range.last)))
            };
            let Some((sum, last)) = fits.find_map(rises) else {
                // Digits enough, at least?
                return Err(match fitted(&1.0, 0) {
                    Some(_) => Failed::Falls,
                    None => Failed::Inaccurate,
                });
            };
            before = last;
            all.push(sum);
        }
        Ok(all)
    }

    /// The windows of integers near enough to an output in one segment, in units of the sum; `None` where one holds none.
    fn windows(
        &self,
        layout: &Layout,
        output: usize,
        shift: u32,
        tolerance: Tolerance,
        span: &Span,
        before: i32,
    ) -> Option<Vec<FitSample>> {
        let unit = libm::ldexp(1.0, (layout.octave_shift(span.number) + shift) as i32);
        let mut samples = Vec::with_capacity(SAMPLES);
        for count in counts(span, layout.bias) {
            let value = self.truth.at(count)[output];
            let allowed = tolerance.at(value);
            // Input zero gives zero, and the output does not fall from the segment below.
            let (mut low, mut high) = (libm::ceil(value - allowed), libm::floor(value + allowed));
            if count == 0 {
                (low, high) = (0.0, 0.0);
            } else if count == span.start {
                low = low.max(f64::from(before));
            }
            if low > high {
                return None;
            }
            samples.push(FitSample {
                factors: factors(layout, count),
                middle: 0.5 * (low + high + 1.0) * unit,
                half: 0.5 * (high + 1.0 - low) * unit,
            });
        }
        Some(samples)
    }
}

/// Segments of an output that are to rise from an output of at least `before` on.
struct Rising<'a> {
    layout: &'a Layout,
    output: usize,
    shift: u32,
    tolerance: Tolerance,
    spans: &'a [Span],
    before: i32,
}

/// Why there are no integers for a segmentation.
enum Failed {
    /// Rounding takes a segment out of its tolerance.
    Inaccurate,
    /// A segment falls, or has to begin below the end of the one before.
    Falls,
}

/// Allowed error of an output.
#[derive(Clone, Copy)]
pub(super) struct Tolerance {
    share: f64,
    from: f64,
}

impl Tolerance {
    pub(super) fn both(truth: &Truth, goal: &AccuracyGoal) -> [Self; 2] {
        [0, 1].map(|output| Self {
            share: goal.percent_of_reading[output] / 100.0,
            from: truth.full_scale[output] * goal.from_percent_of_full_scale / 100.0,
        })
    }

    pub(super) fn at(&self, value: f64) -> f64 {
        self.share * value.max(self.from)
    }
}

/// What the coefficients are multiplied with at a count, in units of the sum.
pub(super) fn factors(layout: &Layout, count: i32) -> [f64; MAX_COEFFICIENTS] {
    let [a, b, c, d] = layout
        .factors(layout.place(count).mantissa)
        .map(|factor| f64::from(factor) / 65536.0);
    [1.0, a, b, c, d]
}

/// Counts of a segment, both ends included, denser towards the ends as the extremes of an error are, on a scale of its octaves;
/// the segment of first contact is graded towards zero, where an output may have a logarithm.
pub(super) fn counts(span: &Span, bias: i32) -> Vec<i32> {
    let last = span.end - 1;
    let length = f64::from(last - span.start);
    let ratio = f64::from(last + bias) / f64::from(span.start + bias);
    let mut counts: Vec<i32> = (0..SAMPLES)
        .map(|i| {
            let place = i as f64 / (SAMPLES - 1) as f64;
            let dense = 0.5 - 0.5 * libm::cos(core::f64::consts::PI * place);
            let offset = if span.start == 0 {
                length * dense * dense * dense
            } else {
                f64::from(span.start + bias) * (libm::pow(ratio, dense) - 1.0)
            };
            span.start + (libm::round(offset) as i32).clamp(0, last - span.start)
        })
        .collect();
    counts.dedup();
    counts
}

/// Tables with these sums of the first output, and the second of others.
pub(super) fn with_first(others: &OwnedTables, shift: u32, first: &[Coefficients]) -> OwnedTables {
    let mut layout = others.layout;
    layout.shifts[0] = shift;
    let none = vec![[0; MAX_COEFFICIENTS]; first.len()];
    let mut tables = assemble(layout, first, &none);
    for (at, (own, other)) in tables.words.iter_mut().zip(&others.words).enumerate() {
        match at % layout.words() {
            0 => {}
            1 => *own = *other,
            _ => *own |= i32::from(*other as u16),
        }
    }
    tables
}

/// The words of the tables, the segment of the largest inputs first.
fn assemble(layout: Layout, first: &[Coefficients], second: &[Coefficients]) -> OwnedTables {
    let pair = |upper: i32, lower: i32| upper << 16 | i32::from(lower as i16 as u16);
    let mut words = Vec::new();
    for (upper, lower) in first.iter().zip(second).rev() {
        words.extend([upper[0], lower[0]]);
        // With halves, a constant's fraction is the linear coefficient already.
        let lowest = match layout.constant {
            Constant::Half => 2,
            Constant::Whole => 1,
        };
        for power in lowest..=layout.powers.terms() {
            words.push(pair(upper[power], lower[power]));
        }
    }
    OwnedTables { layout, words }
}
