//! What a record tells: errors of the terms, whether depths agree, and how far the relaxed modulus is open.

use super::forward::Forward;
use super::least_squares::{self, Series, Settled, Varied};
use super::record::HoldRecord;
use crate::fit::non_negative::non_negative;
use nalgebra::{DMatrix, DVector};

/// Standard error, of a logarithm, from which on a number is not told.
pub(super) const UNIDENTIFIABLE_FROM: f64 = 0.25;
/// Depths within this part of each other are one.
const SAME_DEPTH: f64 = 0.05;
/// Times at which the depths' curves are compared.
const COMPARED: u32 = 40;
/// Difference that the solid's own error in time may make.
const RESOLVED: f64 = 0.005;
/// A chance of one in a thousand, in standard deviations.
const RARE: f64 = 3.09;
/// Relaxed moduli that are tried, over the design's.
const MODULI: u32 = 60;
const LARGEST_MODULUS: f64 = 3.0;
/// Growth of the sum of squares, in squares of the noise, up to which a value is as good (95 %).
const AS_GOOD: f64 = 3.84;
/// Longest relaxation time that a design takes, seconds.
pub(super) const LONGEST: f64 = 1e4;

/// What a record tells of a term.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Identifiability {
    /// Time and weight.
    Both,
    /// The product of time and weight alone: it relaxes faster than the record shows.
    Product,
    /// The weight alone: it relaxes more slowly than the record shows, and stands for all such terms.
    Weight,
    /// Neither.
    Neither,
}

impl Identifiability {
    /// In words.
    pub fn label(self) -> &'static str {
        match self {
            Self::Both => "both",
            Self::Product => "g times tau only",
            Self::Weight => "g only",
            Self::Neither => "neither",
        }
    }
}

/// A term, with standard errors of its logarithms; `None` of a time that is held at the end of what is looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FittedTerm {
    /// `tau`, seconds.
    pub time: f64,
    /// Standard error of `ln tau`, dimensionless; `None` of a time that is held.
    pub time_error: Option<f64>,
    /// `g`, over the relaxed modulus.
    pub weight: f64,
    /// Standard error of `ln g`, dimensionless.
    pub weight_error: f64,
    /// What the record tells of it.
    pub identifiability: Identifiability,
}

/// Standard error, of a logarithm, beyond which there is no interval.
const WIDEST: f64 = 1.0;
/// Limits of 95 % of a normal distribution, in standard deviations.
const TWO_SIDED: f64 = 1.96;

impl FittedTerm {
    /// Ends of the 95 % interval of the time, seconds; `None` where it is wider than a factor of fifty.
    pub fn time_interval(&self) -> Option<[f64; 2]> {
        interval(self.time, self.time_error?)
    }

    /// Ends of the 95 % interval of the weight; `None` where it is wider than a factor of fifty.
    pub fn weight_interval(&self) -> Option<[f64; 2]> {
        interval(self.weight, self.weight_error)
    }
}

fn interval(value: f64, error: f64) -> Option<[f64; 2]> {
    let ends = [-TWO_SIDED, TWO_SIDED].map(|deviations| value * libm::exp(deviations * error));
    (error < WIDEST).then_some(ends)
}

/// Errors of all that was varied.
pub(super) struct Errors {
    varied: Vec<Varied>,
    covariance: Option<DMatrix<f64>>,
}

impl Errors {
    pub(super) fn of(forward: &Forward, settled: &Settled) -> Self {
        let precision = least_squares::precision(forward, &settled.noise);
        let slopes = least_squares::slopes(forward, &settled.series, &precision);
        Self {
            varied: settled.series.varied(),
            covariance: (slopes.transpose() * &slopes).try_inverse(),
        }
    }

    /// Variance of a sum of parameters; infinite where the record does not tell it.
    fn variance(&self, of: &[Varied]) -> f64 {
        let Some(covariance) = &self.covariance else {
            return f64::INFINITY;
        };
        let places: Option<Vec<usize>> = of
            .iter()
            .map(|which| self.varied.iter().position(|known| known == which))
            .collect();
        let Some(places) = places else {
            return f64::INFINITY;
        };
        let pairs = places.iter().flat_map(|&i| places.iter().map(move |&j| (i, j)));
        let sum: f64 = pairs.map(|pair| covariance[pair]).sum();
        if sum >= 0.0 { sum } else { f64::INFINITY }
    }

    /// Standard error of a parameter.
    pub(super) fn of_one(&self, which: Varied) -> f64 {
        libm::sqrt(self.variance(&[which]))
    }

    /// The terms. `hold` is the length of the longest hold, seconds. Where a term moves by more than noise as one more is fitted,
    /// `more`, its
    /// errors have that move in them.
    pub(super) fn terms(&self, settled: &Settled, more: Option<&Settled>, hold: f64) -> Vec<FittedTerm> {
        let series = &settled.series;
        let terms = series.terms().enumerate().map(|(i, [time, weight])| {
            let [moved_time, moved_weight] = more.map_or([0.0; 2], |more| moves(&more.series, time, weight));
            let time_error = (!series.times[i].1).then(|| widened(self.of_one(Varied::Time(i)), moved_time));
            let weight_error = widened(self.of_one(Varied::Weight(i)), moved_weight);
            let product = if series.times[i].1 {
                weight_error
            } else {
                libm::sqrt(self.variance(&[Varied::Time(i), Varied::Weight(i)]))
            };
            let is_identifiable = |error: f64| error < UNIDENTIFIABLE_FROM;
            let identifiability = if time > hold {
                if is_identifiable(weight_error) {
                    Identifiability::Weight
                } else {
                    Identifiability::Neither
                }
            } else if time_error.is_some_and(is_identifiable) && is_identifiable(weight_error) {
                Identifiability::Both
            } else if is_identifiable(product) {
                Identifiability::Product
            } else {
                Identifiability::Neither
            };
            FittedTerm {
                time,
                time_error,
                weight,
                weight_error,
                identifiability,
            }
        });
        terms.collect()
    }
}

/// Moves of the logarithms of a term's time and weight to the nearest term of another series.
fn moves(other: &Series, time: f64, weight: f64) -> [f64; 2] {
    let off = |a: f64, b: f64| libm::fabs(libm::log(a / b));
    let nearest = other
        .terms()
        .min_by(|a, b| off(a[0], time).total_cmp(&off(b[0], time)));
    nearest.map_or([0.0; 2], |[other_time, other_weight]| {
        [off(other_time, time), off(other_weight, weight)]
    })
}

/// A standard error and a move that is more than noise.
fn widened(error: f64, moved: f64) -> f64 {
    if moved > TWO_SIDED * error {
        libm::hypot(error, moved)
    } else {
        error
    }
}

/// Reduced curves of the depths beside each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthComparison {
    /// The shallowest and the deepest, metres.
    pub depths: [f64; 2],
    /// Largest difference of a depth's `g(t)` from that of all, over it.
    pub difference: f64,
    /// Standard error of that difference, dimensionless.
    pub error: f64,
    /// Whether the depths differ by more than their noise (by chance once in a thousand) and than the solid's own error.
    pub differs: bool,
}

/// Fits the weights depth by depth, with the times of all; `None` of a single depth.
pub(super) fn compare_depths(
    record: &HoldRecord,
    forward: &Forward,
    settled: &Settled,
) -> Option<DepthComparison> {
    let mut depths: Vec<f64> = Vec::new();
    let groups: Vec<usize> = record
        .trials
        .iter()
        .map(|trial| {
            let same = depths
                .iter()
                .position(|depth| (depth / trial.depth - 1.0).abs() < SAME_DEPTH);
            same.unwrap_or_else(|| {
                depths.push(trial.depth);
                depths.len() - 1
            })
        })
        .collect();
    if depths.len() < 2 {
        return None;
    }
    let series = &settled.series;
    let precision = least_squares::precision(forward, &settled.noise);
    let modulus = libm::exp(series.modulus.0);
    let terms: Vec<[f64; 2]> = series.terms().collect();
    let columns: Vec<DVector<f64>> = terms
        .iter()
        .map(|[time, _]| {
            let term = forward.term(*time, series.shift.0) * modulus;
            term.component_mul(&forward.factors).component_mul(&precision)
        })
        .collect();
    let joint =
        least_squares::left(forward, &least_squares::readings(forward, series)).component_mul(&precision);
    let (mut before, mut after) = (0.0, 0.0);
    let mut worst: Option<(f64, f64)> = None;
    for group in 0..depths.len() {
        let rows: Vec<usize> = (0..joint.len())
            .filter(|&i| groups[forward.targets[i].trial] == group)
            .collect();
        let matrix = DMatrix::from_fn(rows.len(), columns.len(), |i, j| columns[j][rows[i]]);
        let target = DVector::from_fn(rows.len(), |i, _| -joint[rows[i]]);
        // Changes of the weights.
        let covariance = (matrix.transpose() * &matrix).try_inverse()?;
        let change = &covariance * matrix.transpose() * &target;
        before += target.norm_squared();
        after += (&matrix * &change - &target).norm_squared();
        let trial = groups
            .iter()
            .position(|of| *of == group)
            .map(|at| &record.trials[at])?;
        let pressed = (trial.rows[trial.held_from].time - trial.rows[0].time).max(1e-3);
        for k in 0..=COMPARED {
            let time = pressed * libm::pow(trial.hold() / pressed, f64::from(k) / f64::from(COMPARED));
            let decay =
                DVector::from_iterator(terms.len(), terms.iter().map(|[tau, _]| libm::exp(-time / tau)));
            let whole = series.stiffness(time);
            let difference = decay.dot(&change).abs() / whole;
            let error = libm::sqrt(decay.dot(&(&covariance * &decay)).max(0.0)) / whole;
            if worst.is_none_or(|(most, _)| difference > most) {
                worst = Some((difference, error));
            }
        }
    }
    let added = (terms.len() * (depths.len() - 1)) as f64;
    let freedom = joint.len() as f64 - series.varied().len() as f64 - added;
    if freedom < 1.0 {
        return None;
    }
    let ratio = (before - after) / added / (after / freedom);
    // A mean of squares against its chance (Wilson and Hilferty).
    let limit = {
        let v = 2.0 / (9.0 * added);
        libm::pow(1.0 - v + RARE * libm::sqrt(v), 3.0)
    };
    let (difference, error) = worst?;
    Some(DepthComparison {
        depths: [
            depths.iter().copied().fold(f64::INFINITY, f64::min),
            depths.iter().copied().fold(0.0, f64::max),
        ],
        difference,
        error,
        differs: ratio > limit && difference > RESOLVED,
    })
}

/// Relaxed moduli, over the design's, with which a series of times up to [`LONGEST`] fits as well: 95 % interval.
pub(super) fn open_moduli(forward: &Forward, settled: &Settled, hold: f64) -> Option<[f64; 2]> {
    let series = &settled.series;
    let precision = least_squares::precision(forward, &settled.noise);
    let mut times: Vec<f64> = series.terms().map(|[time, _]| time).collect();
    let mut time = 0.03 * hold;
    while time < LONGEST {
        times.push(time);
        time *= 1.5;
    }
    times.push(LONGEST);
    let columns: Vec<DVector<f64>> = times
        .iter()
        .map(|&time| {
            let term = forward.term(time, series.shift.0);
            term.component_mul(&forward.factors).component_mul(&precision)
        })
        .collect();
    let scales: Vec<f64> = columns
        .iter()
        .map(|column| column.norm().max(f64::MIN_POSITIVE))
        .collect();
    let scaled: Vec<DVector<f64>> = columns
        .iter()
        .zip(&scales)
        .map(|(column, scale)| column / *scale)
        .collect();
    let matrix = DMatrix::from_columns(&scaled);
    let still = forward.settled.component_mul(&forward.factors);
    let squares = |modulus: f64| -> Option<f64> {
        let target = -least_squares::left(forward, &(&still * modulus)).component_mul(&precision);
        let weights = non_negative(&matrix, &target)?;
        Some((&matrix * weights - target).norm_squared())
    };
    let found: Vec<(f64, f64)> = (0..=MODULI)
        .filter_map(|i| {
            let modulus = LARGEST_MODULUS * f64::from(i) / f64::from(MODULI);
            Some((modulus, squares(modulus)?))
        })
        .collect();
    let least = found
        .iter()
        .map(|(_, squares)| *squares)
        .fold(f64::INFINITY, f64::min);
    let mut good = found
        .iter()
        .filter(|(_, squares)| *squares < least + AS_GOOD)
        .map(|(modulus, _)| *modulus);
    let first = good.next()?;
    Some([first, good.next_back().unwrap_or(first)])
}
