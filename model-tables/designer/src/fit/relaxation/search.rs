//! How many terms: one more as long as the Bayesian information criterion falls.

use super::forward::Forward;
use super::least_squares::{self, Series, Settled};
use crate::fit::non_negative::non_negative;
use model_tables::material::relaxation::MAX_TERMS;
use nalgebra::DMatrix;

/// Trial times in a decade.
const BY_DECADE: f64 = 3.0;
/// The best of the trial times that a next term starts from.
const STARTS: usize = 3;
/// Times closer than this factor are one term.
const APART: f64 = 1.3;
/// A weight below this part of the largest is none.
const NONE: f64 = 1e-6;
/// Numbers of terms that may be worse before the search ends.
const WORSE: usize = 2;

/// The series of a record: from none on, with times in `bounds` (logarithms of seconds).
pub(super) fn search(forward: &Forward, start: Series, bounds: [f64; 2]) -> Settled {
    let mut best = least_squares::begin(forward, start);
    let mut latest = best.clone();
    let mut worse = 0;
    for _ in 0..MAX_TERMS {
        let Some(next) = next(forward, &latest, bounds) else {
            break;
        };
        if next.criterion < best.criterion {
            (best, worse) = (next.clone(), 0);
        } else {
            worse += 1;
        }
        if worse == WORSE || next.series.varied().len() + 2 > forward.targets.len() {
            break;
        }
        latest = next;
    }
    best
}

/// A series of one term more.
pub(super) fn next(forward: &Forward, latest: &Settled, bounds: [f64; 2]) -> Option<Settled> {
    let count = libm::ceil(BY_DECADE * (bounds[1] - bounds[0]) / core::f64::consts::LN_10).max(1.0);
    let mut starts: Vec<(f64, Series)> = (0..=count as u32)
        .filter_map(|i| {
            with(
                forward,
                latest,
                bounds[0] + f64::from(i) / count * (bounds[1] - bounds[0]),
            )
        })
        .collect();
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    starts
        .iter()
        .take(STARTS)
        .map(|(_, start)| least_squares::settle(forward, start, &latest.noise, bounds))
        .filter(|settled| sound(&settled.series))
        .min_by(|a, b| a.criterion.total_cmp(&b.criterion))
}

/// The latest series with a term at a time, and the squares that are left; `None` where least squares give a term a weight of none.
fn with(forward: &Forward, latest: &Settled, time: f64) -> Option<(f64, Series)> {
    let precision = least_squares::precision(forward, &latest.noise);
    let mut series = latest.series.clone();
    let modulus = libm::exp(series.modulus.0);
    series.times.push((time, false));
    let mut columns: Vec<_> = series
        .times
        .iter()
        .map(|(time, _)| {
            let term = forward.term(libm::exp(*time), series.shift.0) * modulus;
            term.component_mul(&forward.factors).component_mul(&precision)
        })
        .collect();
    let mut still = forward.settled.component_mul(&forward.factors) * modulus;
    if series.modulus.1 {
        columns.push(still.component_mul(&precision));
        still.fill(0.0);
    }
    let target = -least_squares::left(forward, &still).component_mul(&precision);
    let scales: Vec<f64> = columns
        .iter()
        .map(|column| column.norm().max(f64::MIN_POSITIVE))
        .collect();
    let matrix = DMatrix::from_columns(
        &columns
            .iter()
            .zip(&scales)
            .map(|(column, scale)| column / *scale)
            .collect::<Vec<_>>(),
    );
    let weights = non_negative(&matrix, &target)?;
    let left = (&matrix * &weights - target).norm_squared();
    // Least squares find the weights themselves, from where none is negative.
    series.weights.push(0.0);
    let terms = series.times.len();
    if weights.iter().take(terms).any(|weight| *weight <= 0.0) {
        return None;
    }
    Some((left, series))
}

/// Whether its terms are told apart at all.
fn sound(series: &Series) -> bool {
    let largest = series.weights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let apart = series
        .times
        .windows(2)
        .all(|pair| pair[1].0 - pair[0].0 > libm::log(APART));
    apart
        && series
            .weights
            .iter()
            .all(|weight| *weight > largest + libm::log(NONE))
}
