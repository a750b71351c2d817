//! The search: the fewest bytes that meet the accuracy.

use super::certify::{Certificate, certify};
use super::fit::{Fit, MOST, Sample, fit};
use super::owned::OwnedTables;
use super::segmentation::{Segmentation, candidates};
use super::truth::Truth;
use crate::design_file::Accuracy;

/// Segments at most.
const MOST_SEGMENTS: usize = 32;
/// Samples of a segment that a fit sees; the certificate sees every input.
const SAMPLES: usize = 33;
/// Lawson iterations of a first look and of a fit that is used.
const SCREENING: usize = 30;
const FINAL: usize = 300;
/// A first look this far above the tolerance may still come below it.
const HOPEFUL: f64 = 1.1;
/// Samples lie between inputs and integers are rounded: the fit must stay this far inside the tolerance.
const MARGIN: f64 = 0.99;
/// Part of a unit that rounding can add to an error.
const ROUNDING: f64 = 0.6;
/// Coefficients stay below `2^30`, so that no sum of the evaluation leaves 32 bits.
const LARGEST: f64 = 1_073_741_824.0;
/// Most fraction bits that a coefficient gets.
const MOST_SHIFT: u32 = 12;

/// Tables that passed, and what was tried.
pub(super) struct Found {
    pub(super) tables: OwnedTables,
    pub(super) certificate: Certificate,
    /// Candidates that were fitted before this one passed.
    pub(super) tried: usize,
}

/// One segmentation and the fits made for it so far.
struct Candidate {
    segmentation: Segmentation,
    samples: Option<[Vec<Vec<Sample>>; 2]>,
    /// First-look errors by output and order.
    errors: [[Option<f64>; MOST + 1]; 2],
}

/// The tables of fewest bytes; among equals whole octaves, then the smallest error of a first look.
/// `Err` holds the smallest share of the tolerance that the largest tables reached.
pub(super) fn smallest(truth: &Truth, fraction_bits: u32, accuracy: &Accuracy) -> Result<Found, f64> {
    let mut all: Vec<Candidate> = candidates(fraction_bits, truth.maximum, MOST_SEGMENTS)
        .into_iter()
        .map(|segmentation| Candidate {
            segmentation,
            samples: None,
            errors: [[None; MOST + 1]; 2],
        })
        .collect();
    let mut shapes: Vec<(usize, usize, usize)> = (1..=MOST_SEGMENTS)
        .flat_map(|segments| {
            (2..=MOST)
                .flat_map(move |force| (2..=MOST).map(move |indentation| (segments, force, indentation)))
        })
        .collect();
    shapes.sort_by_key(|&(segments, force, indentation)| (segments * (force + indentation), segments));
    let (mut tried, mut closest) = (0, f64::INFINITY);
    for (segments, force, indentation) in shapes {
        let mut hopeful = Vec::new();
        for (i, candidate) in all.iter_mut().enumerate() {
            if candidate.segmentation.spans.len() == segments {
                let error = candidate.first_look(truth, accuracy, [force, indentation], &mut tried);
                closest = closest.min(error);
                if error < HOPEFUL {
                    hopeful.push((candidate.segmentation.layout.split_bits, error, i));
                }
            }
        }
        hopeful.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        for (_, _, i) in hopeful {
            if let Some((tables, certificate)) = all[i].finish(truth, accuracy, [force, indentation]) {
                return Ok(Found {
                    tables,
                    certificate,
                    tried,
                });
            }
        }
    }
    Err(closest)
}

impl Candidate {
    /// The larger of both outputs' errors; the second is not looked at when the first already rules it out.
    fn first_look(
        &mut self,
        truth: &Truth,
        accuracy: &Accuracy,
        orders: [usize; 2],
        tried: &mut usize,
    ) -> f64 {
        let mut worst = 0.0_f64;
        for (output, order) in orders.into_iter().enumerate() {
            if self.errors[output][order].is_none() {
                *tried += 1;
                let fit = self.fit(truth, accuracy, output, order, SCREENING);
                self.errors[output][order] = Some(fit.error);
            }
            worst = worst.max(self.errors[output][order].unwrap_or(f64::INFINITY));
            if worst >= HOPEFUL {
                break;
            }
        }
        worst
    }

    fn fit(
        &mut self,
        truth: &Truth,
        accuracy: &Accuracy,
        output: usize,
        order: usize,
        iterations: usize,
    ) -> Fit {
        let samples = self
            .samples
            .get_or_insert_with(|| samples(&self.segmentation, truth, accuracy));
        fit(&self.segmentation.spans, &samples[output], order, iterations)
    }

    /// The full fit, in integers, and its certificate if that holds.
    fn finish(
        &mut self,
        truth: &Truth,
        accuracy: &Accuracy,
        orders: [usize; 2],
    ) -> Option<(OwnedTables, Certificate)> {
        let fits = [0, 1].map(|output| self.fit(truth, accuracy, output, orders[output], FINAL));
        if fits.iter().any(|fit| fit.error > MARGIN) {
            return None;
        }
        let tables = quantise(&self.segmentation, &fits, orders)?;
        let certificate = certify(&tables, truth, accuracy)?;
        certificate.holds().then_some((tables, certificate))
    }
}

/// What the fits must meet: values and tolerances at the samples, for force and indentation.
fn samples(segmentation: &Segmentation, truth: &Truth, accuracy: &Accuracy) -> [Vec<Vec<Sample>>; 2] {
    let full_scale = truth.at(truth.maximum);
    let percents = [
        accuracy.force_percent_of_reading,
        accuracy.indentation_percent_of_reading,
    ];
    [0, 1].map(|output| {
        let from = full_scale[output] * accuracy.from_percent_of_full_scale / 100.0;
        let share = percents[output] / 100.0;
        segmentation
            .spans
            .iter()
            .map(|span| {
                counts(span.start, span.end.min(truth.maximum))
                    .into_iter()
                    .map(|count| {
                        let value = truth.at(count)[output];
                        let allowed = share * value.max(from);
                        Sample {
                            count: f64::from(count),
                            value,
                            // Finer than its own rounding nothing can be: half the tolerance is then the aim,
                            // and the certificate says whether it was reached.
                            tolerance: (allowed - ROUNDING).max(0.5 * allowed),
                        }
                    })
                    .collect()
            })
            .collect()
    })
}

/// Counts of a segment, both ends included, denser towards the ends as the errors of a minimax fit are; the
/// segment of first contact is graded towards zero, where the indentation has a logarithm.
fn counts(start: i32, end: i32) -> Vec<i32> {
    let length = f64::from(end - start);
    let mut counts: Vec<i32> = (0..SAMPLES)
        .map(|i| {
            let s = i as f64 / (SAMPLES - 1) as f64;
            let z = s * s * (3.0 - 2.0 * s);
            let z = if start == 0 { z * z } else { z };
            start + libm::round(z * length) as i32
        })
        .collect();
    counts.dedup();
    counts
}

/// Rounds the coefficients to integers with as many fraction bits as they have room for.
fn quantise(segmentation: &Segmentation, fits: &[Fit; 2], orders: [usize; 2]) -> Option<OwnedTables> {
    let shifts = [0, 1].map(|output| {
        let largest = fits[output]
            .coefficients
            .iter()
            .flatten()
            .fold(0.0_f64, |largest, c| largest.max(c.abs()));
        (0..=MOST_SHIFT)
            .rev()
            .find(|&shift| libm::ldexp(largest + 1.0, shift as i32) < LARGEST)
    });
    let [Some(force_shift), Some(indentation_shift)] = shifts else {
        return None;
    };
    let mut layout = segmentation.layout;
    layout.force_shift = force_shift;
    layout.indentation_shift = indentation_shift;
    let mut words = Vec::new();
    for segment in (0..segmentation.spans.len()).rev() {
        for (output, shift) in [force_shift, indentation_shift].into_iter().enumerate() {
            let coefficients = &fits[output].coefficients[segment][..orders[output]];
            for (power, &coefficient) in coefficients.iter().enumerate() {
                // Half a unit makes the last shift round to nearest; half a bit offsets the last product,
                // which is rounded down.
                let rounding = if power > 0 {
                    0.0
                } else if shift > 0 {
                    0.5 + libm::ldexp(0.5, -(shift as i32))
                } else {
                    0.5
                };
                words.push(libm::round(libm::ldexp(coefficient + rounding, shift as i32)) as i32);
            }
        }
    }
    Some(OwnedTables {
        layout,
        force_order: orders[0],
        indentation_order: orders[1],
        words,
    })
}
