//! Zeros of single trials: what the stage, the load cell and the transducer read of an untouched tip, found trial by trial with the parameters
//! of the device.
//!
//! Each round moves the zeros by a step of Gauss and Newton over zeros and parameters together, and then the parameters go to their least
//! squares. What the zeros can take up is projected off before the data are asked what they tell of the parameters.

use super::FitError;
use super::data::{Data, DataRow};
use super::heading::Measured;
use super::parameter::Parameter;
use super::touch;
use model_tables::model::ModelError;
use nalgebra::{DMatrix, DVector};

/// A singular value under this part of the largest is none.
const DEPENDENT: f64 = 1e-9;

/// A zero of a trial.
#[derive(Clone, Debug, PartialEq)]
pub struct TrialZero {
    /// Index of the trial in [`Data::trials`].
    pub trial: usize,
    /// Which channel.
    pub quantity: Measured,
    /// What it reads of the untouched tip, in millimetres, newtons or kilopascals.
    pub value: f64,
    /// Its standard error, in the same unit; `None` with as many parameters as data.
    pub standard_error: Option<f64>,
}

impl TrialZero {
    /// Its name for people: the channel's, and the trial's where that has a name.
    pub fn title(&self, data: &Data) -> String {
        match data.trials[self.trial].as_str() {
            "" => zero_name(self.quantity).to_owned(),
            name => format!("{} of trial {name}", zero_name(self.quantity)),
        }
    }
}

/// The name of a channel's zero on the command line.
pub fn zero_name(quantity: Measured) -> &'static str {
    parameter(quantity).name()
}

/// The channel whose zero has a name.
pub fn zero_named(name: &str) -> Option<Measured> {
    Measured::ALL
        .into_iter()
        .find(|&quantity| zero_name(quantity) == name)
}

/// The zero of all trials together.
fn parameter(quantity: Measured) -> Parameter {
    match quantity {
        Measured::Indentation => Parameter::IndentationOffset,
        Measured::Force => Parameter::ForceOffset,
        Measured::PressureRise => Parameter::PressureOffset,
    }
}

/// The zeros of all trials, SI; none by default.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct TrialZeros {
    /// The channels that have zeros of their own.
    free: Vec<Measured>,
    /// The trials that have rows.
    trials: Vec<usize>,
    /// Of every trial: indentation, force, pressure rise.
    values: Vec<[f64; 3]>,
}

impl TrialZeros {
    /// Where the search begins: at first touch, where rows before it tell where that is.
    pub(super) fn begin(data: &Data, per_trial: &[Measured]) -> Self {
        let free: Vec<Measured> = Measured::ALL
            .into_iter()
            .filter(|quantity| per_trial.contains(quantity))
            .collect();
        if free.is_empty() {
            return Self::default();
        }
        let mut values = vec![[0.0; 3]; data.trials.len()];
        for (trial, zeros) in values.iter_mut().enumerate() {
            if let Some(touch) = touch::find(data, trial) {
                for &quantity in &free {
                    zeros[quantity as usize] = match quantity {
                        Measured::Indentation => touch.indentation,
                        Measured::Force | Measured::PressureRise => {
                            touch::level(data, trial, quantity, &touch)
                        }
                    };
                }
            }
        }
        Self {
            trials: (0..values.len())
                .filter(|&trial| data.rows.iter().any(|row| row.trial == trial))
                .collect(),
            free,
            values,
        }
    }

    /// # Errors
    /// [`FitError::ZeroTwice`] where a zero is asked of all trials together too.
    pub(super) fn check(&self, chosen: &[Parameter]) -> Result<(), FitError> {
        let twice = self
            .free
            .iter()
            .find(|quantity| chosen.contains(&parameter(**quantity)));
        twice.map_or(Ok(()), |quantity| Err(FitError::ZeroTwice(parameter(*quantity))))
    }

    /// How many there are.
    pub(super) fn count(&self) -> usize {
        self.free.len() * self.trials.len()
    }

    /// The zero of a row's trial, SI.
    pub(super) fn of(&self, row: &DataRow, quantity: Measured) -> f64 {
        self.values
            .get(row.trial)
            .map_or(0.0, |zeros| zeros[quantity as usize])
    }

    /// Indentation of a row from its trial's zero on, metres.
    pub(super) fn indentation(&self, row: &DataRow) -> Option<f64> {
        row.indentation
            .map(|read| read - self.of(row, Measured::Indentation))
    }

    /// The deepest indentation of the data, metres.
    pub(super) fn deepest(&self, data: &Data) -> f64 {
        data.rows
            .iter()
            .filter_map(|row| self.indentation(row))
            .fold(0.0, f64::max)
    }

    /// With the zeros of a channel moved, in every trial.
    pub(super) fn all_moved(&self, quantity: Measured, step: f64) -> Self {
        let mut moved = self.clone();
        for zeros in &mut moved.values {
            zeros[quantity as usize] += step;
        }
        moved
    }

    /// Every zero: its trial and channel, in the order of the columns.
    fn each(&self) -> impl Iterator<Item = (usize, Measured)> {
        let free = &self.free;
        self.trials
            .iter()
            .flat_map(move |&trial| free.iter().map(move |&quantity| (trial, quantity)))
    }

    /// A column for each zero, of numbers whose trials are given; `derivatives` gives those by a channel's zeros in all trials at once.
    ///
    /// # Errors
    /// Those of `derivatives`.
    pub(super) fn columns(
        &self,
        trials: &[usize],
        derivatives: impl Fn(Measured) -> Result<Vec<f64>, ModelError>,
    ) -> Result<DMatrix<f64>, ModelError> {
        let mut by: [Vec<f64>; 3] = Default::default();
        for &quantity in &self.free {
            by[quantity as usize] = derivatives(quantity)?;
        }
        let mut columns = DMatrix::zeros(trials.len(), self.count());
        for (column, (trial, quantity)) in self.each().enumerate() {
            for (row, &of) in trials.iter().enumerate() {
                if of == trial {
                    columns[(row, column)] = by[quantity as usize][row];
                }
            }
        }
        Ok(columns)
    }

    /// Moves by a step of least squares over parameters and zeros together, no zero by more than its unit; the largest step in units.
    pub(super) fn advance(
        &mut self,
        jacobian: &DMatrix<f64>,
        columns: &DMatrix<f64>,
        left: &DVector<f64>,
        units: &[f64; 3],
    ) -> f64 {
        let all: Vec<(usize, Measured)> = self.each().collect();
        let mut scaled = columns.clone();
        for (mut column, (_, quantity)) in scaled.column_iter_mut().zip(&all) {
            column *= units[*quantity as usize];
        }
        let svd = beside(jacobian, &scaled).svd(true, true);
        let Ok(step) = svd.solve(left, DEPENDENT * svd.singular_values.max()) else {
            return 0.0;
        };
        let mut largest = 0.0_f64;
        for (&(trial, quantity), step) in all.iter().zip(step.iter().skip(jacobian.ncols())) {
            let step = step.clamp(-1.0, 1.0);
            self.values[trial][quantity as usize] += step * units[quantity as usize];
            largest = largest.max(step.abs());
        }
        largest
    }

    /// What was found, of the derivatives and of what is left in standard deviations, outliers left out.
    pub(super) fn found(
        &self,
        data: &Data,
        jacobian: &DMatrix<f64>,
        columns: &DMatrix<f64>,
        standardised: &[f64],
    ) -> Vec<TrialZero> {
        let all = beside(jacobian, columns);
        let freedom = standardised.len() as f64 - all.ncols() as f64;
        let scale = standardised.iter().map(|left| left * left).sum::<f64>() / freedom;
        // The columns are in SI: brought to one size, so that none is lost.
        let sizes: Vec<f64> = all.column_iter().map(|column| column.norm()).collect();
        let unit = DMatrix::from_fn(all.nrows(), all.ncols(), |i, j| {
            all[(i, j)] / sizes[j].max(f64::MIN_POSITIVE)
        });
        let variances = (unit.transpose() * &unit).pseudo_inverse(DEPENDENT).ok();
        self.each()
            .enumerate()
            .filter_map(|(column, (trial, quantity))| {
                let place = jacobian.ncols() + column;
                let measured = data
                    .rows
                    .iter()
                    .any(|row| row.trial == trial && row.get(quantity).is_some());
                let error = variances
                    .as_ref()
                    .filter(|_| freedom >= 1.0)
                    .map(|variances| libm::sqrt(scale * variances[(place, place)]) / sizes[place]);
                (measured && sizes[place] > 0.0).then(|| TrialZero {
                    trial,
                    quantity,
                    value: self.values[trial][quantity as usize] * quantity.per_si(),
                    standard_error: error.map(|error| error * quantity.per_si()),
                })
            })
            .collect()
    }
}

/// Two matrices side by side.
pub(super) fn beside(left: &DMatrix<f64>, right: &DMatrix<f64>) -> DMatrix<f64> {
    let mut both = left
        .clone()
        .resize_horizontally(left.ncols() + right.ncols(), 0.0);
    both.columns_mut(left.ncols(), right.ncols()).copy_from(right);
    both
}

/// A matrix less what some columns reach of it.
pub(super) fn off(columns: &DMatrix<f64>, matrix: DMatrix<f64>) -> DMatrix<f64> {
    if columns.ncols() == 0 {
        return matrix;
    }
    let mut sized = columns.clone();
    for mut column in sized.column_iter_mut() {
        let size = column.norm();
        column /= if size > 0.0 { size } else { 1.0 };
    }
    let svd = sized.svd(true, false);
    let most = svd.singular_values.max();
    let Some(directions) = svd.u else { return matrix };
    let mut left = matrix;
    for (direction, value) in directions.column_iter().zip(&svd.singular_values) {
        if *value > DEPENDENT * most {
            let shares = direction.transpose() * &left;
            left -= direction * shares;
        }
    }
    left
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_columns_reach_is_taken_off_and_the_rest_stays() {
        let columns = DMatrix::from_fn(6, 2, |i, j| if (i < 3) == (j == 0) { 5.0 } else { 0.0 });
        let matrix = DMatrix::from_fn(6, 1, |i, _| i as f64);
        let left = off(&columns, matrix);
        // Each half less its mean.
        let expected = [-1.0, 0.0, 1.0, -1.0, 0.0, 1.0];
        assert!(
            left.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12),
            "{left}"
        );
        let zero = DMatrix::zeros(6, 2);
        let kept = off(&zero, DMatrix::from_element(6, 1, 2.0));
        assert!(kept.iter().all(|value| (value - 2.0).abs() < 1e-12));
    }

    #[test]
    fn names_are_those_of_the_zeros_of_all_trials() {
        for quantity in Measured::ALL {
            assert_eq!(zero_named(zero_name(quantity)), Some(quantity));
        }
        assert_eq!(zero_named("material"), None);
    }
}
