//! A monotone curve through data alone: pressure rise -> force, pressure rise -> indentation.
//!
//! Cubic B-splines whose coefficients grow from zero at zero, so that the curve does: non-negative least squares (Lawson
//! and Hanson 1974) on their tail sums. The number of knots is the one that predicts best what was left out. Noise and
//! outliers are taken from what is left, as in a fit of the model. The pressure rise is taken as exact.

use super::check::{Hysteresis, Misfit, cross_validation_parts};
use super::data::{Data, DataRow};
use super::noise::NoiseModel;
use super::non_negative::non_negative;
use super::robust;
use nalgebra::{DMatrix, DVector};
use std::fmt;

/// Numbers of inner knots that are tried.
const KNOTS: [usize; 7] = [0, 1, 2, 3, 5, 8, 12];
/// Rounds of taking outliers out.
const ROUNDS: usize = 4;
/// Rows that a curve takes at least.
const MIN_ROWS: usize = 8;
/// The least growth of a coefficient over the largest reading, so that the curve grows strictly.
const MIN_GROWTH: f64 = 1e-4;
/// A slope so many times the median one: the pressure says little there.
const STEEP: f64 = 5.0;
/// Places at which a slope is looked at.
const PLACES: usize = 200;

/// A monotone spline from the origin.
#[derive(Clone, Debug, PartialEq)]
struct Spline {
    /// Knots with their ends repeated.
    knots: Vec<f64>,
    /// Growth of the coefficients.
    growth: Vec<f64>,
}

const DEGREE: usize = 3;

impl Spline {
    /// Values of the tail sums of the B-splines at a place.
    fn tails(knots: &[f64], place: f64) -> Vec<f64> {
        let count = knots.len() - DEGREE - 1;
        let end = knots[knots.len() - 1];
        let place = place.clamp(0.0, end);
        let span = (knots.partition_point(|&knot| knot <= place))
            .saturating_sub(1)
            .clamp(DEGREE, count - 1);
        // de Boor's triangle: the four B-splines that are not zero.
        let mut basis = [1.0, 0.0, 0.0, 0.0];
        for degree in 1..=DEGREE {
            let mut saved = 0.0;
            for r in 0..degree {
                let (right, left) = (knots[span + r + 1], knots[span + r + 1 - degree]);
                let part = basis[r] / (right - left);
                basis[r] = saved + (right - place) * part;
                saved = (place - left) * part;
            }
            basis[degree] = saved;
        }
        let mut tails = vec![0.0; count - 1];
        for (k, tail) in tails.iter_mut().enumerate() {
            // All B-splines from the (k+1)-th on.
            *tail = (0..=DEGREE)
                .filter(|r| span - DEGREE + r > k)
                .map(|r| basis[r])
                .sum();
        }
        tails
    }

    fn at(&self, place: f64) -> f64 {
        Self::tails(&self.knots, place)
            .iter()
            .zip(&self.growth)
            .map(|(tail, growth)| tail * growth)
            .sum()
    }

    /// Least squares of values with weights; inner knots at quantiles of the places.
    fn fit(places: &[f64], values: &[f64], weights: &[f64], inner: usize, end: f64) -> Option<Self> {
        let mut sorted: Vec<f64> = places
            .iter()
            .copied()
            .filter(|&place| place > 0.0 && place < end)
            .collect();
        sorted.sort_by(f64::total_cmp);
        sorted.dedup();
        if sorted.len() < 2 * (inner + 1) {
            return None;
        }
        let mut knots = vec![0.0; DEGREE + 1];
        for k in 1..=inner {
            knots.push(sorted[k * sorted.len() / (inner + 1)]);
        }
        knots.extend([end; DEGREE + 1]);
        let width = knots.len() - DEGREE - 2;
        let mut basis = DMatrix::zeros(places.len(), width);
        let mut target = DVector::zeros(places.len());
        let largest = values.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        let least = MIN_GROWTH * largest;
        for (i, &place) in places.iter().enumerate() {
            let tails = Self::tails(&knots, place);
            let floor: f64 = least * tails.iter().sum::<f64>();
            for (j, tail) in tails.iter().enumerate() {
                basis[(i, j)] = weights[i] * tail;
            }
            target[i] = weights[i] * (values[i] - floor);
        }
        let growth = non_negative(&basis, &target)?;
        Some(Self {
            knots,
            growth: growth.iter().map(|growth| growth + least).collect(),
        })
    }
}

/// One quantity as a function of the pressure rise.
#[derive(Clone, Debug, PartialEq)]
pub struct DataBranch {
    spline: Spline,
    /// Inner knots.
    pub knots: usize,
    /// Rows.
    pub rows: usize,
    /// Rows that did not count.
    pub outliers: usize,
    /// How noisy the quantity is.
    pub noise: NoiseModel,
    /// What is left, outliers apart.
    pub misfit: Misfit,
    /// What is left of rows that were predicted from the others, outliers apart.
    pub held_out: Misfit,
    /// Rows that would not have been predicted, because they lay beyond the range of the others.
    pub refused: usize,
    /// Parts of the cross-validation, and whether a part is a trial.
    pub cross_validation: (usize, bool),
    /// Unloading less loading at equal pressure; `None` where the data have one direction.
    pub hysteresis: Option<Hysteresis>,
}

/// Where a pascal means so much more force than elsewhere that the pressure says little.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Saturation {
    /// From this pressure rise on, pascals.
    pub from: f64,
    /// Force there, newtons.
    pub force: f64,
    /// Largest slope, newtons per pascal.
    pub slope: f64,
    /// Slope over the median slope, dimensionless.
    pub ratio: f64,
}

/// A press from data alone.
#[derive(Clone, Debug, PartialEq)]
pub struct FromData {
    /// Force, newtons.
    pub force: DataBranch,
    /// Indentation, metres; `None` where it was not measured.
    pub indentation: Option<DataBranch>,
    /// Largest pressure rise of the data, pascals: what is beyond is refused.
    pub end: f64,
    /// Least positive pressure rise, pascals: below it the curve goes straight to the origin.
    pub start: f64,
    /// Where the pressure saturates; `None` where it does not.
    pub saturation: Option<Saturation>,
    /// Steps to a deeper row at which the pressure falls, and all such steps; `None` where the rows have no depth.
    pub falls: Option<[usize; 2]>,
}

/// Why there is no curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NoCurve {
    /// Pressure rise and force are both needed.
    NoPressure,
    /// Too few rows.
    TooFew {
        /// Rows with both.
        found: usize,
    },
    /// Least squares failed.
    Lost,
}

impl fmt::Display for NoCurve {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoPressure => write!(
                f,
                "a curve from data alone needs the pressure rise beside the force: measure both"
            ),
            Self::TooFew { found } => write!(
                f,
                "{found} rows have pressure rise and force, and a curve from data alone needs at least {MIN_ROWS}: measure more"
            ),
            Self::Lost => write!(
                f,
                "no monotone curve comes near the data: check columns and units"
            ),
        }
    }
}

impl core::error::Error for NoCurve {}

impl DataBranch {
    /// The quantity at a pressure rise in pascals, held at the end.
    pub fn at(&self, rise: f64) -> f64 {
        self.spline.at(rise)
    }

    fn of(data: &Data, quantity: fn(&DataRow) -> Option<f64>, end: f64) -> Option<Self> {
        let members: Vec<usize> = (0..data.rows.len())
            .filter(|&i| data.rows[i].rise.is_some() && quantity(&data.rows[i]).is_some())
            .collect();
        if members.len() < MIN_ROWS {
            return None;
        }
        let mut order = members;
        let place = |i: usize| data.rows[i].rise.unwrap_or(0.0);
        order.sort_by(|&a, &b| place(a).total_cmp(&place(b)));
        let places: Vec<f64> = order.iter().map(|&i| place(i)).collect();
        let values: Vec<f64> = order.iter().filter_map(|&i| quantity(&data.rows[i])).collect();
        let (part_of, part_count, by_trial) = cross_validation_parts(data);
        let parts: Vec<usize> = order.iter().map(|&i| part_of[i]).collect();
        let mut best: Option<(f64, Self)> = None;
        for inner in KNOTS {
            let Some(Counted {
                spline,
                noise,
                outliers,
            }) = counted(&places, &values, inner, end)
            else {
                continue;
            };
            let weights = |i: usize| {
                if outliers[i] {
                    0.0
                } else {
                    1.0 / noise.at(values[i])
                }
            };
            let (mut pairs, mut refused, mut lost) = (Vec::new(), 0, false);
            for fold in 0..part_count {
                let kept: Vec<usize> = (0..places.len()).filter(|&i| parts[i] != fold).collect();
                if kept.len() == places.len() {
                    continue;
                }
                let pick = |of: &dyn Fn(usize) -> f64| -> Vec<f64> { kept.iter().map(|&i| of(i)).collect() };
                let seen = kept.iter().map(|&i| places[i]).fold(0.0, f64::max);
                let Some(part) = Spline::fit(
                    &pick(&|i| places[i]),
                    &pick(&|i| values[i]),
                    &pick(&weights),
                    inner,
                    seen,
                ) else {
                    lost = true;
                    break;
                };
                for i in (0..places.len()).filter(|&i| parts[i] == fold && !outliers[i]) {
                    if places[i] > seen {
                        refused += 1;
                    } else {
                        pairs.push([values[i], part.at(places[i])]);
                    }
                }
            }
            if lost {
                // Too many knots for what a part leaves.
                continue;
            }
            let kept = |i: &usize| !outliers[*i];
            let (Some(held_out), Some(misfit)) = (
                Misfit::of(pairs),
                Misfit::of(
                    (0..places.len())
                        .filter(kept)
                        .map(|i| [values[i], spline.at(places[i])]),
                ),
            ) else {
                continue;
            };
            // More knots have to earn their keep.
            let cost = held_out.rms * (1.0 + 0.005 * inner as f64);
            if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                let rows: Vec<_> = (0..places.len())
                    .filter(kept)
                    .map(|i| {
                        let direction = data.rows[order[i]].direction;
                        (places[i], direction, values[i] - spline.at(places[i]), values[i])
                    })
                    .collect();
                let branch = Self {
                    knots: inner,
                    rows: places.len(),
                    outliers: outliers.iter().filter(|outlier| **outlier).count(),
                    noise,
                    misfit,
                    held_out,
                    refused,
                    cross_validation: (part_count, by_trial),
                    hysteresis: Hysteresis::of_rows(&rows),
                    spline,
                };
                best = Some((cost, branch));
            }
        }
        best.map(|(_, branch)| branch)
    }
}

struct Counted {
    spline: Spline,
    noise: NoiseModel,
    outliers: Vec<bool>,
}

/// A spline with outliers and noise from what is left.
fn counted(places: &[f64], values: &[f64], inner: usize, end: f64) -> Option<Counted> {
    let largest = values.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    let mut noise = NoiseModel::unknown(largest);
    let mut outliers = vec![false; places.len()];
    let mut spline = None;
    for _ in 0..ROUNDS {
        let weights: Vec<f64> = values
            .iter()
            .zip(&outliers)
            .map(|(&value, &outlier)| if outlier { 0.0 } else { 1.0 / noise.at(value) })
            .collect();
        let fitted = Spline::fit(places, values, &weights, inner, end)?;
        let predicted: Vec<f64> = places.iter().map(|&place| fitted.at(place)).collect();
        let residuals: Vec<f64> = values.iter().zip(&predicted).map(|(a, b)| a - b).collect();
        noise = NoiseModel::estimate(
            &residuals,
            &predicted,
            largest,
            (inner + DEGREE) as f64,
            1e-9 * largest,
        );
        let standardised: Vec<f64> = residuals
            .iter()
            .zip(&predicted)
            .map(|(residual, &reading)| residual / noise.at(reading))
            .collect();
        outliers = robust::outliers(&standardised);
        spline = Some(fitted);
    }
    Some(Counted {
        spline: spline?,
        noise,
        outliers,
    })
}

/// Curves through the data alone.
///
/// # Errors
/// [`NoCurve`].
pub fn from_data(data: &Data) -> Result<FromData, NoCurve> {
    let both = |row: &&DataRow| row.rise.is_some() && row.force.is_some();
    let found = data.rows.iter().filter(both).count();
    if found == 0 {
        return Err(NoCurve::NoPressure);
    }
    if found < MIN_ROWS {
        return Err(NoCurve::TooFew { found });
    }
    let rises = || {
        data.rows
            .iter()
            .filter(both)
            .filter_map(|row| row.rise)
            .filter(|&rise| rise > 0.0)
    };
    let (start, end) = (rises().fold(f64::INFINITY, f64::min), rises().fold(0.0, f64::max));
    let force = DataBranch::of(data, |row| row.force, end).ok_or(NoCurve::Lost)?;
    Ok(FromData {
        saturation: saturation(&force, end),
        indentation: DataBranch::of(data, |row| row.indentation, end),
        falls: falls(data),
        force,
        end,
        start,
    })
}

fn saturation(force: &DataBranch, end: f64) -> Option<Saturation> {
    let step = end / PLACES as f64;
    let slopes: Vec<f64> = (0..PLACES)
        .map(|k| (force.at(step * (k + 1) as f64) - force.at(step * k as f64)) / step)
        .collect();
    let median = robust::median(&slopes);
    let first = slopes.iter().position(|slope| *slope > STEEP * median)?;
    let slope = slopes.iter().copied().fold(0.0, f64::max);
    let from = step * first as f64;
    Some(Saturation {
        from,
        force: force.at(from),
        slope,
        ratio: slope / median,
    })
}

/// Steps of the mean pressure from one depth to the next that go down.
fn falls(data: &Data) -> Option<[usize; 2]> {
    let mut rows: Vec<[f64; 2]> = data
        .rows
        .iter()
        .filter_map(|row| Some([row.indentation?, row.rise?]))
        .collect();
    if rows.len() < MIN_ROWS {
        return None;
    }
    rows.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let depth = rows[rows.len() - 1][0];
    let mut levels: Vec<(f64, f64, f64)> = Vec::new();
    for [indentation, rise] in rows {
        match levels.last_mut() {
            Some((at, sum, count)) if indentation - *at < 1e-3 * depth => {
                *sum += rise;
                *count += 1.0;
            }
            _ => levels.push((indentation, rise, 1.0)),
        }
    }
    let means: Vec<f64> = levels.iter().map(|(_, sum, count)| sum / count).collect();
    let steps = means.windows(2);
    Some([
        steps.clone().filter(|pair| pair[1] < pair[0]).count(),
        steps.count(),
    ])
}

#[cfg(test)]
mod tests;
