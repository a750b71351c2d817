//! Least squares over the free parameters: Levenberg and Marquardt's method, with noise and outliers taken from what is
//! left, until nothing moves.

use super::data::Data;
use super::heading::Measured;
use super::model::{DataQuantity, Model, Target};
use super::noise::{NoiseModel, ROUNDING};
use super::parameter::{Parameter, ParameterValues, Units};
use super::robust;
use super::trial_zeros;
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use model_tables::model::ModelError;
use nalgebra::storage::Owned;
use nalgebra::{DMatrix, DVector, Dyn};

/// Step of the differences that stand for derivatives, in coordinates.
const STEP: f64 = 1e-4;
/// Relative change of the sum of squares, and of the coordinates, at which the method stops.
const TOLERANCES: [f64; 2] = [1e-9, 1e-7];
/// Evaluations of one minimisation, over parameters and one more.
const PATIENCE: usize = 25;
/// Rounds of reweighting at most.
const MAX_ROUNDS: usize = 12;
/// A round that moves no coordinate by more than this has settled.
const SETTLED: f64 = 1e-4;
/// Residual that stands for a place where there is no model, in standard deviations.
const NOWHERE: f64 = 1e6;

/// What is fitted to what.
pub(super) struct Task<'a> {
    pub(super) model: &'a Model,
    pub(super) data: &'a Data,
    pub(super) targets: &'a [Target],
    pub(super) free: &'a [Parameter],
    pub(super) units: Units,
}

/// How the targets count.
#[derive(Clone, Debug)]
pub(super) struct Weighting {
    /// Noise of force and of rise.
    pub(super) noise: [NoiseModel; 2],
    /// Standard deviation of each target.
    pub(super) sigma: Vec<f64>,
    /// Which targets are outliers, and do not count.
    pub(super) outliers: Vec<bool>,
}

/// Index of a quantity.
pub(super) fn index(quantity: DataQuantity) -> usize {
    match quantity {
        DataQuantity::Force => 0,
        DataQuantity::Rise => 1,
    }
}

impl Weighting {
    /// Before anything is known.
    pub(super) fn unknown(targets: &[Target]) -> Self {
        let noise = [DataQuantity::Force, DataQuantity::Rise]
            .map(|quantity| NoiseModel::unknown(largest(targets, quantity)));
        Self {
            sigma: targets
                .iter()
                .map(|target| noise[index(target.quantity)].at(target.measured))
                .collect(),
            outliers: vec![false; targets.len()],
            noise,
        }
    }

    /// From what is left of the targets after a fit of `spent` parameters.
    pub(super) fn from_residuals(data: &Data, targets: &[Target], predicted: &[f64], spent: usize) -> Self {
        let mut weighting = Self::unknown(targets);
        for quantity in [DataQuantity::Force, DataQuantity::Rise] {
            let mut members: Vec<usize> = (0..targets.len())
                .filter(|&i| targets[i].quantity == quantity)
                .collect();
            let depth = |i: &usize| data.rows[targets[*i].row].depth();
            members.sort_by(|a, b| depth(a).total_cmp(&depth(b)));
            if members.is_empty() {
                continue;
            }
            let residuals: Vec<f64> = members
                .iter()
                .map(|&i| targets[i].measured - predicted[i])
                .collect();
            let readings: Vec<f64> = members.iter().map(|&i| predicted[i]).collect();
            let largest = largest(targets, quantity);
            let share = spent as f64 * members.len() as f64 / targets.len() as f64;
            let noise = NoiseModel::estimate(&residuals, &readings, largest, share, ROUNDING * largest);
            weighting.noise[index(quantity)] = noise;
            for &i in &members {
                weighting.sigma[i] = noise.at(predicted[i]);
            }
            let standardised: Vec<f64> = members
                .iter()
                .zip(&residuals)
                .map(|(&i, residual)| residual / weighting.sigma[i])
                .collect();
            for (&i, outlier) in members.iter().zip(robust::outliers(&standardised)) {
                weighting.outliers[i] = outlier;
            }
        }
        weighting
    }

    /// What a residual is multiplied by.
    pub(super) fn factors(&self) -> Vec<f64> {
        self.sigma
            .iter()
            .zip(&self.outliers)
            .map(|(sigma, outlier)| if *outlier { 0.0 } else { 1.0 / sigma })
            .collect()
    }
}

fn largest(targets: &[Target], quantity: DataQuantity) -> f64 {
    let of = targets.iter().filter(|target| target.quantity == quantity);
    of.map(|target| target.measured.abs()).fold(0.0, f64::max)
}

impl Task<'_> {
    pub(super) fn predict(&self, values: &ParameterValues) -> Result<Vec<f64>, ModelError> {
        self.model.predict(values, self.data, self.targets)
    }

    /// The place of values on the scale of the fit. The compliance counts by what it does to a membrane, which goes with
    /// the stiffness: one curve then covers all stiffnesses.
    fn coordinates(&self, values: &ParameterValues) -> DVector<f64> {
        let mut scaled = *values;
        scaled.set(
            Parameter::Compliance,
            values.get(Parameter::Compliance) * self.model.stiffness(values),
        );
        DVector::from_iterator(
            self.free.len(),
            self.free
                .iter()
                .map(|&parameter| parameter.coordinate(scaled.get(parameter), &self.units)),
        )
    }

    fn place(&self, values: &ParameterValues, coordinates: &DVector<f64>) -> ParameterValues {
        let mut placed = *values;
        for (&parameter, &coordinate) in self.free.iter().zip(coordinates) {
            placed.set(parameter, parameter.value(coordinate, &self.units));
        }
        if self.free.contains(&Parameter::Compliance) {
            let scaled = placed.get(Parameter::Compliance) / self.model.stiffness(&placed);
            placed.set(Parameter::Compliance, scaled);
        }
        placed
    }

    /// Derivatives of the values of the free parameters by their coordinates.
    pub(super) fn slopes(&self, values: &ParameterValues) -> DMatrix<f64> {
        let at = self.coordinates(values);
        let here = self.place(values, &at);
        DMatrix::from_fn(self.free.len(), self.free.len(), |i, j| {
            let mut there = at.clone();
            there[j] += STEP;
            let moved = self.place(values, &there);
            (moved.get(self.free[i]) - here.get(self.free[i])) / STEP
        })
    }

    /// Derivatives of the predictions by the coordinates of the free parameters, over the standard deviations.
    pub(super) fn jacobian(
        &self,
        values: &ParameterValues,
        predicted: &[f64],
        factors: &[f64],
    ) -> Result<DMatrix<f64>, ModelError> {
        let mut jacobian = DMatrix::zeros(self.targets.len(), self.free.len());
        let at = self.coordinates(values);
        for column in 0..self.free.len() {
            let mut moved = |step: f64| {
                let mut there = at.clone();
                there[column] += step;
                self.predict(&self.place(values, &there)).map(|moved| {
                    for (row, (moved, before)) in moved.iter().zip(predicted).enumerate() {
                        jacobian[(row, column)] = factors[row] * (moved - before) / step;
                    }
                })
            };
            moved(STEP).or_else(|_| moved(-STEP))?;
        }
        Ok(jacobian)
    }

    /// The derivatives without what the zeros of the trials take up: what the data tell of the parameters.
    pub(super) fn told(
        &self,
        values: &ParameterValues,
        predicted: &[f64],
        factors: &[f64],
    ) -> Result<DMatrix<f64>, ModelError> {
        let columns = self.zero_columns(values, predicted, factors)?;
        Ok(trial_zeros::off(
            &columns,
            self.jacobian(values, predicted, factors)?,
        ))
    }

    /// Derivatives of the predictions by the zeros of the trials, SI, over the standard deviations.
    pub(super) fn zero_columns(
        &self,
        values: &ParameterValues,
        predicted: &[f64],
        factors: &[f64],
    ) -> Result<DMatrix<f64>, ModelError> {
        let zeros = self.model.zeros();
        let units = self.units.of_zeros();
        let moved = |quantity: Measured| {
            let step = STEP * units[quantity as usize];
            self.model.set_zeros(zeros.all_moved(quantity, step));
            let moved = self.predict(values);
            self.model.set_zeros(zeros.clone());
            Ok(moved?
                .iter()
                .zip(predicted)
                .zip(factors)
                .map(|((moved, before), factor)| factor * (moved - before) / step)
                .collect())
        };
        let trials: Vec<usize> = self
            .targets
            .iter()
            .map(|target| self.data.rows[target.row].trial)
            .collect();
        zeros.columns(&trials, moved)
    }

    /// Moves the zeros of the trials by a step of least squares over them and the parameters together; the largest one, over what would be a
    /// large change.
    fn move_zeros(&self, values: &ParameterValues, weighting: &Weighting) -> Result<f64, ModelError> {
        let mut zeros = self.model.zeros();
        if zeros.count() == 0 {
            return Ok(0.0);
        }
        let predicted = self.predict(values)?;
        let factors = weighting.factors();
        let columns = self.zero_columns(values, &predicted, &factors)?;
        let jacobian = self.jacobian(values, &predicted, &factors)?;
        let left = DVector::from_iterator(
            factors.len(),
            self.targets
                .iter()
                .zip(&predicted)
                .zip(&factors)
                .map(|((target, predicted), factor)| factor * (target.measured - predicted)),
        );
        let moved = zeros.advance(&jacobian, &columns, &left, &self.units.of_zeros());
        self.model.set_zeros(zeros);
        Ok(moved)
    }

    /// Change of the predictions by a bench whose stage reads more, SI per metre; `None` where no row has an indentation.
    pub(super) fn by_indentation(&self, values: &ParameterValues, predicted: &[f64]) -> Option<Vec<f64>> {
        let offset = Parameter::IndentationOffset;
        if self.data.rows.iter().all(|row| row.indentation.is_none()) {
            return None;
        }
        let step = STEP * self.units.indentation;
        let mut moved = *values;
        moved.set(offset, values.get(offset) + step);
        let moved = self.predict(&moved).ok()?;
        Some(
            moved
                .iter()
                .zip(predicted)
                .map(|(moved, before)| (moved - before) / (1e-3 * step))
                .collect(),
        )
    }

    /// The values of least squares from a start, with these weights.
    pub(super) fn minimise(
        &self,
        start: &ParameterValues,
        weighting: &Weighting,
    ) -> Result<ParameterValues, ModelError> {
        let problem = Problem {
            task: self,
            start: *start,
            factors: weighting.factors(),
            at: self.coordinates(start),
            predicted: self.predict(start)?,
        };
        let (problem, _) = LevenbergMarquardt::new()
            .with_ftol(TOLERANCES[0])
            .with_xtol(TOLERANCES[1])
            .with_gtol(0.0)
            .with_patience(PATIENCE)
            .minimize(problem);
        Ok(self.place(start, &problem.at))
    }

    /// Minimises, takes noise and outliers from what is left, and again until nothing moves.
    pub(super) fn settle(&self, start: &ParameterValues) -> Result<(ParameterValues, Weighting), ModelError> {
        let mut weighting = Weighting::unknown(self.targets);
        let mut values = self.minimise(start, &weighting)?;
        for _ in 0..MAX_ROUNDS {
            if self.model.is_spent() {
                break;
            }
            let shifted = self.move_zeros(&values, &weighting)?;
            let spent = self.free.len() + self.model.zeros().count();
            weighting = Weighting::from_residuals(self.data, self.targets, &self.predict(&values)?, spent);
            let next = self.minimise(&values, &weighting)?;
            let moved = (self.coordinates(&next) - self.coordinates(&values)).amax();
            values = next;
            if moved.max(shifted) < SETTLED {
                break;
            }
        }
        Ok((values, weighting))
    }
}

struct Problem<'a, 'b> {
    task: &'a Task<'b>,
    start: ParameterValues,
    factors: Vec<f64>,
    at: DVector<f64>,
    predicted: Vec<f64>,
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Problem<'_, '_> {
    type ParameterStorage = Owned<f64, Dyn>;
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;

    fn set_params(&mut self, at: &DVector<f64>) {
        self.at.copy_from(at);
        let values = self.task.place(&self.start, at);
        let possible = self.task.free.iter().all(|&parameter| {
            let [low, high] = parameter.bounds();
            // A compliance may be asked for below zero: the model continues there.
            parameter == Parameter::Compliance || (low..=high).contains(&values.get(parameter))
        });
        // Only then is there a device to solve: the way to a stretch of any size would have no end.
        self.predicted = match possible.then(|| self.task.predict(&values)) {
            Some(Ok(predicted)) => predicted,
            // Far away: the method comes back with a shorter step.
            _ => self
                .task
                .targets
                .iter()
                .zip(&self.factors)
                .map(|(target, factor)| target.measured + if *factor > 0.0 { NOWHERE / factor } else { 0.0 })
                .collect(),
        };
    }

    fn params(&self) -> DVector<f64> {
        self.at.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        if self.task.model.is_spent() {
            return None;
        }
        Some(DVector::from_iterator(
            self.factors.len(),
            self.task
                .targets
                .iter()
                .zip(&self.predicted)
                .zip(&self.factors)
                .map(|((target, predicted), factor)| factor * (predicted - target.measured)),
        ))
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let values = self.task.place(&self.start, &self.at);
        self.task.jacobian(&values, &self.predicted, &self.factors).ok()
    }
}
