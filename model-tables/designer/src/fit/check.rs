//! What to believe of a fit: misfit, order in what is left, hysteresis, cross-validation.

use super::Residual;
use super::data::{Data, Direction};
use super::model::{DataQuantity, Model, Target};
use super::parameter::ParameterValues;
use super::robust;
use super::solve::{Task, Weighting, index};
use model_tables::design_file::DesignFile;
use rayon::prelude::*;
use std::sync::Arc;

/// How far predictions are from measurements, in their unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Misfit {
    /// Numbers compared.
    pub count: usize,
    /// Root mean square, in the unit of its quantity (newtons or pascals).
    pub rms: f64,
    /// Largest magnitude, in the unit of its quantity (newtons or pascals).
    pub largest: f64,
    /// Largest measured magnitude, in the unit of its quantity (newtons or pascals).
    pub full_scale: f64,
}

impl Misfit {
    /// Of pairs measured, predicted; `None` of none.
    pub fn of(pairs: impl IntoIterator<Item = [f64; 2]>) -> Option<Self> {
        let (mut count, mut squares, mut largest, mut full_scale) = (0_usize, 0.0, 0.0_f64, 0.0_f64);
        for [measured, predicted] in pairs {
            count += 1;
            let error = predicted - measured;
            squares += error * error;
            largest = largest.max(error.abs());
            full_scale = full_scale.max(measured.abs());
        }
        (count > 0).then(|| Self {
            count,
            rms: libm::sqrt(squares / count as f64),
            largest,
            full_scale,
        })
    }

    /// Root mean square in percent of full scale.
    pub fn rms_percent(&self) -> f64 {
        100.0 * self.rms / self.full_scale
    }

    /// Largest in percent of full scale.
    pub fn largest_percent(&self) -> f64 {
        100.0 * self.largest / self.full_scale
    }
}

/// Order in the signs of what is left, from shallow to deep, in standard deviations; negative where they cluster.
pub(super) fn order(data: &Data, residuals: &[&Residual]) -> Option<f64> {
    let mut sorted: Vec<&&Residual> = residuals.iter().filter(|residual| !residual.outlier).collect();
    sorted.sort_by(|a, b| data.rows[a.row].depth().total_cmp(&data.rows[b.row].depth()));
    let left: Vec<f64> = sorted.iter().map(|residual| residual.standardised).collect();
    robust::runs(&left)
}

/// Numbers of one sign so unlikely by chance, both sides together, are no chance.
const BY_CHANCE: f64 = 1e-3;

/// The share of what is left that is positive, where that is no chance (the sign test).
pub(super) fn one_sided(residuals: &[&Residual]) -> Option<f64> {
    let signs: Vec<bool> = residuals
        .iter()
        .filter(|residual| !residual.outlier)
        .map(|residual| residual.standardised > 0.0)
        .collect();
    let positive = signs.iter().filter(|sign| **sign).count();
    let count = signs.len();
    (robust::sign_chance(positive, count) < BY_CHANCE).then(|| positive as f64 / count as f64)
}

/// Unloading less loading at equal depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hysteresis {
    /// Mean difference, in the unit of the quantity.
    pub mean: f64,
    /// Largest magnitude, in the unit of its quantity (newtons or pascals).
    pub largest: f64,
    /// Largest measured magnitude, in the unit of its quantity (newtons or pascals).
    pub full_scale: f64,
    /// Bins of depth that have both.
    pub bins: usize,
}

/// Bins of depth.
const BINS: usize = 8;

impl Hysteresis {
    /// Of what is left after a fit: the fit takes the slope within a bin away. `None` without both directions.
    pub(super) fn of(data: &Data, residuals: &[&Residual]) -> Option<Self> {
        let rows: Vec<(f64, Direction, f64, f64)> = residuals
            .iter()
            .map(|residual| {
                let row = &data.rows[residual.row];
                (
                    row.depth(),
                    row.direction,
                    residual.measured - residual.fitted,
                    residual.measured,
                )
            })
            .collect();
        Self::of_rows(&rows)
    }

    /// Of rows of depth, direction, what is left, what was measured.
    pub fn of_rows(rows: &[(f64, Direction, f64, f64)]) -> Option<Self> {
        let deepest = rows.iter().map(|row| row.0).fold(0.0, f64::max);
        let full_scale = rows.iter().map(|row| row.3.abs()).fold(0.0, f64::max);
        let mean = |bin: usize, direction: Direction| {
            let of: Vec<f64> = rows
                .iter()
                .filter(|row| {
                    let place = libm::floor(BINS as f64 * row.0 / deepest).max(0.0) as usize;
                    row.1 == direction && place.min(BINS - 1) == bin
                })
                .map(|row| row.2)
                .collect();
            (!of.is_empty()).then(|| of.iter().sum::<f64>() / of.len() as f64)
        };
        let differences: Vec<f64> = (0..BINS)
            .filter_map(|bin| Some(mean(bin, Direction::Unloading)? - mean(bin, Direction::Loading)?))
            .collect();
        let largest = differences
            .iter()
            .copied()
            .max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
        Some(Self {
            mean: differences.iter().sum::<f64>() / differences.len() as f64,
            largest,
            full_scale,
            bins: differences.len(),
        })
    }

    /// Largest difference in percent of full scale, without sign.
    pub fn percent(&self) -> f64 {
        100.0 * self.largest.abs() / self.full_scale
    }
}

/// What fits to a part of the data predict of the rest. Outliers are left out of the count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Validation {
    /// Parts.
    pub parts: usize,
    /// Whether a part is a trial.
    pub by_trial: bool,
    /// Of the force; `None` where no force was measured.
    pub force: Option<Misfit>,
    /// Of the pressure rise; `None` where none was measured.
    pub rise: Option<Misfit>,
}

/// A number measured and predicted.
type Pair = (DataQuantity, [f64; 2]);

/// Trials from which on each is predicted from the others.
const MIN_TRIALS: usize = 3;
/// Parts at most.
const MAX_CROSS_VALIDATION_PARTS: usize = 10;
/// Parts of data without so many trials: every so many-th row in the order of depth.
const INTERLEAVED: usize = 5;

/// The part that each row belongs to, and how many there are.
pub(super) fn cross_validation_parts(data: &Data) -> (Vec<usize>, usize, bool) {
    if data.trials.len() >= MIN_TRIALS {
        let parts = data.trials.len().min(MAX_CROSS_VALIDATION_PARTS);
        return (
            data.rows.iter().map(|row| row.trial % parts).collect(),
            parts,
            true,
        );
    }
    let mut order: Vec<usize> = (0..data.rows.len()).collect();
    order.sort_by(|&a, &b| data.rows[a].depth().total_cmp(&data.rows[b].depth()));
    let mut parts = vec![0; data.rows.len()];
    for (place, &row) in order.iter().enumerate() {
        parts[row] = place % INTERLEAVED;
    }
    (parts, INTERLEAVED, false)
}

/// Fits to all but one part, from the whole fit on with its weights, and predicts that part. `None` where a part would
/// leave too little.
pub(super) fn validate(
    file: &DesignFile,
    task: &Task<'_>,
    values: &ParameterValues,
    weighting: &Weighting,
) -> Option<Validation> {
    let Task {
        data,
        targets,
        free,
        units,
        ..
    } = *task;
    let kind = task.model.kind;
    let work = task.model.work();
    let zeros = task.model.zeros();
    let (part_of, parts, by_trial) = cross_validation_parts(data);
    let pick = |fold: usize, held_out: bool| -> Vec<usize> {
        (0..targets.len())
            .filter(|&i| (part_of[targets[i].row] == fold) == held_out)
            .collect()
    };
    let predicted: Option<Vec<Vec<Pair>>> = (0..parts)
        .into_par_iter()
        .map(|fold| {
            let model = Model::sharing(kind, file, data, free, zeros.clone(), Arc::clone(&work));
            let kept = pick(fold, false);
            if kept.len() <= free.len() || model.is_spent() {
                return None;
            }
            let part = |members: &[usize]| -> Vec<Target> { members.iter().map(|&i| targets[i]).collect() };
            let (training, held) = (part(&kept), pick(fold, true));
            let training = Task {
                model: &model,
                data,
                targets: &training,
                free,
                units,
            };
            let weights = Weighting {
                noise: weighting.noise,
                sigma: kept.iter().map(|&i| weighting.sigma[i]).collect(),
                outliers: kept.iter().map(|&i| weighting.outliers[i]).collect(),
            };
            let fitted = training.minimise(values, &weights).ok()?;
            let targets = part(&held);
            let predicted = model.predict(&fitted, data, &targets).ok()?;
            Some(
                held.iter()
                    .zip(targets)
                    .zip(predicted)
                    .filter(|((i, _), _)| !weighting.outliers[**i])
                    .map(|((_, target), predicted)| (target.quantity, [target.measured, predicted]))
                    .collect(),
            )
        })
        .collect();
    let predicted: Vec<Pair> = predicted?.into_iter().flatten().collect();
    let [force, rise] = [0, 1].map(|which| {
        Misfit::of(
            predicted
                .iter()
                .filter(|(quantity, _)| index(*quantity) == which)
                .map(|(_, pair)| *pair),
        )
    });
    Some(Validation {
        parts,
        by_trial,
        force,
        rise,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn misfit_is_root_mean_square_and_largest() {
        let misfit = Misfit::of([[1.0, 1.3], [-2.0, -2.4]]).expect("two pairs");
        assert!((misfit.rms - 0.125_f64.sqrt()).abs() < 1e-12);
        assert!((misfit.largest - 0.4).abs() < 1e-12 && (misfit.largest_percent() - 20.0).abs() < 1e-9);
        assert_eq!(Misfit::of([]), None);
    }

    #[test]
    fn hysteresis_is_unloading_less_loading() {
        let rows: Vec<_> = (0..40)
            .map(|i| {
                let depth = 0.1 * f64::from(i % 20);
                if i < 20 {
                    (depth, Direction::Loading, 0.05, 2.0)
                } else {
                    (depth, Direction::Unloading, -0.05, 2.0)
                }
            })
            .collect();
        let found = Hysteresis::of_rows(&rows).expect("both directions");
        assert!((found.mean + 0.1).abs() < 1e-12 && (found.percent() - 5.0).abs() < 1e-9);
        assert_eq!(Hysteresis::of_rows(&rows[..20]), None);
    }
}
