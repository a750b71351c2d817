//! The search: the fewest bytes that meet the accuracy within the instructions wanted, and among equals the fewest instructions.

use super::minimax::{MOST, Sample, fit};
use super::owned::OwnedTables;
use super::quantise::{Coefficients, round};
use super::shape::{Segmentation, Shape, Span, biases, instructions};
use super::truth::Truth;
use crate::design_file::Accuracy;
use crate::table::{Constant, Layout};
use crate::units::PressureRise;

/// Segments at most.
const MOST_SEGMENTS: usize = 32;
/// Tables of so many bytes are small, and a lookup of so many instructions is quick. Where small tables can meet the
/// accuracy with a quick lookup they are taken before smaller ones with a slower; beyond, bytes alone count.
const SMALL: usize = 192;
const QUICK: u32 = 28;
/// Samples of a segment that a fit sees; the certificate sees every input.
const SAMPLES: usize = 41;
/// A first look above this share of the tolerance leaves nothing for rounding.
const HOPEFUL: f64 = 0.97;
/// How much is tried before larger tables are.
struct Effort {
    /// Segmentations of a size whose coefficients are rounded, those first that leave it most room.
    rounded: usize,
    /// Tables of a size that are offered for acceptance, which evaluates every input.
    offered: usize,
    /// Sizes of a shape that fail in these before it is given up: 16 bits are then too few for it, however short its segments.
    patience: usize,
}

/// For small tables with a quick lookup, which are what is wanted.
const EVERYTHING: Effort = Effort {
    rounded: usize::MAX,
    offered: usize::MAX,
    patience: usize::MAX,
};
/// For the others.
const USUAL: Effort = Effort {
    rounded: 8,
    offered: 2,
    patience: 4,
};
/// Samples lie between inputs: integers must stay this far inside the tolerance.
const MARGIN: f64 = 0.985;
/// Part of a unit that rounding can add to an error.
const ROUNDING: f64 = 0.6;
/// Sums stay below this share of 2^31.
const FULL: f64 = 0.98;

/// Tables that were accepted, and what was tried.
pub(super) struct Found<T> {
    pub(super) tables: OwnedTables,
    /// What accepted them.
    pub(super) accepted: T,
    /// Segmentations that were looked at before.
    pub(super) tried: usize,
}

/// One way to cut the input, its samples in both outputs, and how close sums of real coefficients come.
struct Candidate<'a> {
    truth: &'a Truth,
    segmentation: Segmentation,
    error: f64,
}

/// The smallest tables that meet the accuracy and that `accept` takes, over inputs in the units of `truths`. `Err` holds the
/// smallest share of the tolerance that was reached.
pub(super) fn smallest<T>(
    truths: &[Truth],
    accuracy: &Accuracy,
    mut accept: impl FnMut(&OwnedTables, &Truth) -> Option<T>,
) -> Result<Found<T>, f64> {
    let sizes = |shapes: &[Shape]| {
        let of = |&shape: &Shape| {
            let most = MOST_SEGMENTS << shape.halvings;
            (1..=most).map(move |segments| (segments * shape.bytes(), segments, shape))
        };
        let mut sizes: Vec<(usize, usize, Shape)> = shapes.iter().flat_map(of).collect();
        // Stable: shapes stay in the order of their cost.
        sizes.sort_by_key(|&(bytes, ..)| bytes);
        sizes
    };
    let (usual, cut) = (sizes(&Shape::ALL), sizes(&Shape::CUT));
    let (mut tried, mut closest) = (0, f64::INFINITY);
    // Octaves are cut where coefficients do not round; where sums of real ones are too far off it is not tried.
    for (sizes, most_bytes, most_instructions, within, effort) in [
        (&usual, SMALL, QUICK, f64::INFINITY, EVERYTHING),
        (&usual, usize::MAX, u32::MAX, f64::INFINITY, USUAL),
        (&cut, usize::MAX, u32::MAX, HOPEFUL, USUAL),
    ] {
        if closest > within {
            break;
        }
        // Sizes of each shape that real coefficients would have done for, and integers did not.
        let mut unrounded: Vec<Shape> = Vec::new();
        for &(bytes, segments, shape) in sizes.iter().take_while(|(bytes, ..)| *bytes <= most_bytes) {
            if unrounded.iter().filter(|&&other| other == shape).count() >= effort.patience {
                continue;
            }
            let mut hopeful = Vec::new();
            for truth in truths {
                for bias in biases(shape, truth.maximum, segments as u32) {
                    let layout = shape.layout(truth.fraction_bits, truth.maximum, bias);
                    if instructions(&layout) > most_instructions {
                        break;
                    }
                    let Some(segmentation) = Segmentation::of(layout) else {
                        continue;
                    };
                    let mut candidate = Candidate {
                        truth,
                        segmentation,
                        error: 0.0,
                    };
                    if candidate.segmentation.spans.len() != segments || !candidate.fits() {
                        continue;
                    }
                    tried += 1;
                    let look = first_look(&candidate.segmentation, truth, accuracy);
                    closest = closest.min(look.error);
                    candidate.error = look.error;
                    if look.error < HOPEFUL {
                        hopeful.push(candidate);
                    } else if look.in_first {
                        // A larger bias only widens the first segment.
                        break;
                    }
                }
            }
            // What leaves rounding most room, and of those the quickest first.
            hopeful.sort_by(|a, b| a.error.total_cmp(&b.error));
            hopeful.truncate(effort.rounded);
            hopeful.sort_by_key(Candidate::instructions);
            if !hopeful.is_empty() {
                unrounded.push(shape);
            }
            // A shift of its own for an output costs an instruction: first without.
            let finished = [false, true].into_iter().flat_map(|shifts| {
                hopeful.iter().filter_map(move |candidate| {
                    let tables = candidate.finish(accuracy, shifts)?;
                    (instructions(&tables.layout) <= most_instructions).then_some((tables, candidate.truth))
                })
            });
            for (tables, truth) in finished.take(effort.offered) {
                if let Some(accepted) = accept(&tables, truth) {
                    debug_assert_eq!(tables.bytes(), bytes);
                    return Ok(Found {
                        tables,
                        accepted,
                        tried,
                    });
                }
            }
        }
    }
    Err(closest)
}

struct Look {
    error: f64,
    /// The first segment is why.
    in_first: bool,
}

/// How close sums of real coefficients come: the largest error as a share of the tolerance. Looks no further once that rules
/// the segmentation out.
fn first_look(segmentation: &Segmentation, truth: &Truth, accuracy: &Accuracy) -> Look {
    let free = 1 + segmentation.layout.powers.terms();
    let tolerances = Tolerance::both(truth, accuracy);
    let mut worst = 0.0_f64;
    let last = segmentation.spans.len() - 1;
    // The first segment has the logarithm of first contact, the last one the strongest bend.
    let order = [0].into_iter().chain((1..=last).rev());
    for at in order {
        let span = &segmentation.spans[at];
        let counts = counts(span, segmentation.layout.bias);
        for output in [1, 0] {
            let samples: Vec<Sample> = counts
                .iter()
                .map(|&count| {
                    let value = truth.at(count)[output];
                    let allowed = tolerances[output].at(value);
                    Sample {
                        factors: factors(&segmentation.layout, count),
                        middle: value,
                        // Finer than its own rounding nothing can be: half the tolerance is then the aim.
                        half: if count == 0 {
                            0.5
                        } else {
                            (allowed - ROUNDING).max(0.5 * allowed)
                        },
                    }
                })
                .collect();
            worst = worst.max(fit(&samples, free, &[0.0; MOST]).error);
            if worst >= HOPEFUL {
                return Look {
                    error: worst,
                    in_first: at == 0,
                };
            }
        }
    }
    Look {
        error: worst,
        in_first: false,
    }
}

impl Candidate<'_> {
    fn instructions(&self) -> u32 {
        instructions(&self.segmentation.layout)
    }

    /// Whether the sums of both outputs fit a word.
    fn fits(&self) -> bool {
        self.spare_bits(0).is_some() && self.spare_bits(1).is_some()
    }

    /// Integers for it, if rounding leaves it within the tolerance and never falling.
    fn finish(&self, accuracy: &Accuracy, shifts: bool) -> Option<OwnedTables> {
        let mut layout = self.segmentation.layout;
        let spare = [0, 1].map(|output| self.spare_bits(output));
        let [Some(force), Some(indentation)] = spare else {
            return None;
        };
        if !shifts {
            let sums = [0, 1].map(|output| self.integers(&layout, output, 0, accuracy));
            let [Some(force), Some(indentation)] = sums else {
                return None;
            };
            return Some(assemble(layout, &force, &indentation));
        }
        let mut found = Vec::new();
        for (output, most) in [force, indentation].into_iter().enumerate() {
            let (shift, sums) = [0, most]
                .into_iter()
                .find_map(|shift| Some((shift, self.integers(&layout, output, shift, accuracy)?)))?;
            found.push((shift, sums));
        }
        (layout.force_shift, layout.indentation_shift) = (found[0].0, found[1].0);
        Some(assemble(layout, &found[0].1, &found[1].1))
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

    /// The integers of one output, segments upwards.
    fn integers(
        &self,
        layout: &Layout,
        output: usize,
        shift: u32,
        accuracy: &Accuracy,
    ) -> Option<Vec<Coefficients>> {
        let tolerance = Tolerance::both(self.truth, accuracy)[output];
        let mut before = 0;
        let mut all = Vec::with_capacity(self.segmentation.spans.len());
        for span in &self.segmentation.spans {
            let shift = layout.octave_shift(span.number) + shift;
            let unit = libm::ldexp(1.0, shift as i32);
            let mut samples = Vec::with_capacity(SAMPLES);
            for count in counts(span, layout.bias) {
                let value = self.truth.at(count)[output];
                let allowed = tolerance.at(value);
                // Integers that are near enough; zero input reads zero; and no fall from the segment below.
                let (mut low, mut high) = (libm::ceil(value - allowed), libm::floor(value + allowed));
                if count == 0 {
                    (low, high) = (0.0, 0.0);
                } else if count == span.start {
                    low = low.max(f64::from(before));
                }
                if low > high {
                    return None;
                }
                samples.push(Sample {
                    factors: factors(layout, count),
                    middle: 0.5 * (low + high + 1.0) * unit,
                    half: 0.5 * (high + 1.0 - low) * unit,
                });
            }
            let sum = round(&samples, layout.powers.terms(), layout.constant, MARGIN)?;
            let last = layout.factors(layout.place(PressureRise(span.end - 1)).mantissa);
            before = evaluate(&sum, last) >> shift;
            all.push(sum);
        }
        Some(all)
    }
}

/// The chip's arithmetic for one output.
fn evaluate(sum: &Coefficients, factors: [i32; 4]) -> i32 {
    let mut value = sum[0];
    for (coefficient, factor) in sum[1..].iter().zip(factors) {
        value = value.wrapping_add(((i64::from(*coefficient) * i64::from(factor)) >> 16) as i32);
    }
    value
}

/// The error an output is allowed.
#[derive(Clone, Copy)]
struct Tolerance {
    share: f64,
    from: f64,
}

impl Tolerance {
    fn both(truth: &Truth, accuracy: &Accuracy) -> [Self; 2] {
        let percents = [
            accuracy.force_percent_of_reading,
            accuracy.indentation_percent_of_reading,
        ];
        [0, 1].map(|output| Self {
            share: percents[output] / 100.0,
            from: truth.full_scale[output] * accuracy.from_percent_of_full_scale / 100.0,
        })
    }

    fn at(&self, value: f64) -> f64 {
        self.share * value.max(self.from)
    }
}

/// What the coefficients are multiplied with at a count, in units of the sum.
fn factors(layout: &Layout, count: i32) -> [f64; MOST] {
    let [a, b, c, d] = layout
        .factors(layout.place(PressureRise(count)).mantissa)
        .map(|factor| f64::from(factor) / 65536.0);
    [1.0, a, b, c, d]
}

/// Counts of a segment, both ends included, denser towards the ends as the extremes of an error are, on a scale of its octaves;
/// the segment of first contact is graded towards zero, where the indentation has a logarithm.
fn counts(span: &Span, bias: i32) -> Vec<i32> {
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

/// The words of the tables, the segment of the largest inputs first.
fn assemble(layout: Layout, force: &[Coefficients], indentation: &[Coefficients]) -> OwnedTables {
    let pair = |force: i32, indentation: i32| force << 16 | i32::from(indentation as i16 as u16);
    let mut words = Vec::new();
    for (force, indentation) in force.iter().zip(indentation).rev() {
        words.extend([force[0], indentation[0]]);
        // With halves, a constant's fraction is the linear coefficient already.
        let first = match layout.constant {
            Constant::Half => 2,
            Constant::Whole => 1,
        };
        for power in first..=layout.powers.terms() {
            words.push(pair(force[power], indentation[power]));
        }
    }
    OwnedTables { layout, words }
}
