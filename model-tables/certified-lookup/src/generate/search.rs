//! The search: the fewest bytes that meet the accuracy within the instructions wanted, and among equals the fewest instructions.

use super::AccuracyGoal;
use super::candidate::{Candidate, Shifts, Tolerance, Work, counts, factors};
use super::minimax::{FitSample, MAX_COEFFICIENTS, fit};
use super::owned::OwnedTables;
use super::shape::{Segmentation, Shape, biases, instructions};
use super::truth::Truth;

/// Largest number of segments.
const MAX_SEGMENTS: usize = 32;
/// Tables of so many bytes are small, and a lookup of so many instructions is quick. Where small tables can meet the
/// accuracy with a quick lookup they are taken before smaller ones with a slower; beyond, bytes alone count.
const SMALL: usize = 192;
const QUICK: u32 = 28;
/// A first look above this share of the tolerance leaves nothing for rounding.
const HOPEFUL: f64 = 0.97;
/// Limits of the search at one size of tables.
struct Effort {
    /// Segmentations of a size whose coefficients are rounded, those first that leave it most room.
    rounded: usize,
    /// Tables of a size that are offered for acceptance, which evaluates every input.
    offered: usize,
    /// Sizes of a shape that fail in these before it is given up: 16 bits are then too few for it, however short its segments.
    patience: usize,
    /// Whether an output's sums are tried with every shift that their word has room for, not only the largest: coefficients, too,
    /// must fit theirs.
    every_shift: bool,
}

/// Limits for small tables with a quick lookup, which are preferred.
const EVERYTHING: Effort = Effort {
    rounded: usize::MAX,
    offered: usize::MAX,
    patience: usize::MAX,
    every_shift: false,
};
/// Limits for all other tables.
const USUAL: Effort = Effort {
    rounded: 8,
    offered: 2,
    patience: 4,
    every_shift: true,
};
/// Sums that a search rounds before it looks at no further size. Most designs that get tables take some dozens; those that are hardly
/// stretched, or have a transducer of 0.01 Pa, up to 2400; one measured curve of the tests more than 8000, in a second. What has no
/// tables ends after minutes at the worst.
const MAX_ROUNDED: u32 = 16_000;
/// Part of a unit that rounding can add to an error.
const ROUNDING: f64 = 0.6;

/// Tables that were accepted, and what was tried.
pub(super) struct Found<T> {
    pub(super) tables: OwnedTables,
    /// What accepted them.
    pub(super) accepted: T,
    /// Segmentations that were looked at before.
    pub(super) tried: usize,
}

/// The smallest tables that meet the accuracy and that `accept` takes, over inputs in the units of `truths`. `Err` holds the
/// smallest share of the tolerance that was reached.
pub(super) fn smallest<T>(
    truths: &[Truth],
    goal: &AccuracyGoal,
    work: &Work,
    mut accept: impl FnMut(&OwnedTables, &Truth) -> Option<T>,
) -> Result<Found<T>, f64> {
    let sizes = |shapes: &[Shape]| {
        let of = |&shape: &Shape| {
            let most = MAX_SEGMENTS << shape.halvings;
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
            if work.rounded() > MAX_ROUNDED {
                break;
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
                        work,
                    };
                    if candidate.segmentation.spans.len() != segments || !candidate.fits() {
                        continue;
                    }
                    tried += 1;
                    let look = first_look(&candidate.segmentation, truth, goal);
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
            let shifted = if effort.every_shift {
                Shifts::Every
            } else {
                Shifts::Largest
            };
            let finished = [Shifts::None, shifted].into_iter().flat_map(|shifts| {
                hopeful.iter().filter_map(move |candidate| {
                    if candidate.instructions() + u32::from(shifts != Shifts::None) > most_instructions {
                        return None;
                    }
                    let tables = candidate.finish(goal, shifts)?;
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
fn first_look(segmentation: &Segmentation, truth: &Truth, goal: &AccuracyGoal) -> Look {
    let free = 1 + segmentation.layout.powers.terms();
    let tolerances = Tolerance::both(truth, goal);
    let mut worst = 0.0_f64;
    let last = segmentation.spans.len() - 1;
    // The first segment has the logarithm of first contact, the last one the strongest bend.
    let order = [0].into_iter().chain((1..=last).rev());
    for at in order {
        let span = &segmentation.spans[at];
        let counts = counts(span, segmentation.layout.bias);
        for output in [1, 0] {
            let samples: Vec<FitSample> = counts
                .iter()
                .map(|&count| {
                    let value = truth.at(count)[output];
                    let allowed = tolerances[output].at(value);
                    FitSample {
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
            worst = worst.max(fit(&samples, free, &[0.0; MAX_COEFFICIENTS]).error);
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
