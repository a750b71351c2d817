//! Calibration of a design to bench data.

use crate::{FitError, about, bytes, design};
use designer::fit::check::Misfit;
use designer::fit::data::{Data, DataChoice, Direction};
use designer::fit::findings::{findings, state};
use designer::fit::parameter::Parameter;
use designer::fit::trial_zeros::{zero_name, zero_named};
use designer::fit::{DataQuantity, Fit, Measured, fit_per_trial, write};
use model_tables::design_file::DesignFile;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

/// Columns of what is left: line, indentation, measured, design, fitted, standardised.
const COLUMNS: usize = 6;

type FittedParameter = (&'static str, &'static str, f64, f64, f64, &'static str);
/// Trial, name, value, standard error.
type Zero = (String, &'static str, f64, f64);
type Left<'py> = (Bound<'py, PyBytes>, Vec<bool>, Vec<bool>, Vec<String>);
type Calibrated<'py> = (
    String,
    Vec<FittedParameter>,
    Vec<Zero>,
    Bound<'py, PyBytes>,
    Left<'py>,
    [f64; 4],
    [f64; 4],
    Vec<String>,
);

/// Fits parameters of a design to the bytes of a CSV file: the calibrated design, the parameters, the zeros of trials, correlations of the fitted ones,
/// what is left of each measured number, misfits of design and fit, noise, and notes.
#[pyfunction]
#[allow(clippy::too_many_arguments)] // the options of the command
pub(crate) fn fit<'py>(
    python: Python<'py>,
    text: &str,
    name: &str,
    data: Vec<u8>,
    data_name: &str,
    parameters: Vec<String>,
    per_trial: Vec<String>,
    columns: Vec<(String, String)>,
    only: Vec<(String, String)>,
    direction: Option<&str>,
) -> PyResult<Calibrated<'py>> {
    let file = design(text, name)?;
    let direction = direction
        .map(|word| match word {
            "loading" => Ok(Direction::Loading),
            "unloading" => Ok(Direction::Unloading),
            _ => Err(FitError::new_err(format!(
                "direction is {word:?}: must be \"loading\" or \"unloading\""
            ))),
        })
        .transpose()?;
    let choice = DataChoice {
        columns,
        only,
        direction,
    };
    let chosen = if parameters.is_empty() {
        Parameter::USUAL.to_vec()
    } else {
        parameters
            .iter()
            .map(|name| parameter(name))
            .collect::<PyResult<_>>()?
    };
    let zeros = per_trial
        .iter()
        .map(|name| zero(name))
        .collect::<PyResult<Vec<_>>>()?;
    let (data, fit, calibrated) = python
        .detach(|| fitted(&file, text, &data, data_name, &choice, &chosen, &zeros))
        .map_err(|reason| FitError::new_err(about(data_name, reason)))?;
    let estimates = fit.estimates.iter().map(|estimate| {
        (
            estimate.parameter.name(),
            estimate.parameter.key(),
            estimate.start,
            estimate.value,
            estimate.standard_error.unwrap_or(f64::NAN),
            state(estimate.held),
        )
    });
    let zeros = fit.trial_zeros.iter().map(|zero| {
        (
            data.trials[zero.trial].clone(),
            zero_name(zero.quantity),
            zero.value,
            zero.standard_error.unwrap_or(f64::NAN),
        )
    });
    let count = fit.fitted.len();
    let correlations: Vec<f64> = fit.correlations.as_ref().map_or_else(
        || vec![f64::NAN; count * count],
        |matrix| matrix.iter().copied().collect(),
    );
    let rms = |misfit: Option<Misfit>, factor: f64| misfit.map_or(f64::NAN, |misfit| factor * misfit.rms);
    let misfits = [
        rms(fit.before[0], 1.0),
        rms(fit.after[0], 1.0),
        rms(fit.before[1], 1e-3),
        rms(fit.after[1], 1e-3),
    ];
    let noise = |k: usize, factor: f64| {
        fit.noise[k].map_or([f64::NAN; 2], |noise| {
            [factor * noise.floor, 100.0 * noise.of_reading()]
        })
    };
    let ([force, of_force], [rise, of_rise]) = (noise(0, 1.0), noise(1, 1e-3));
    let mut notes = data.notes.clone();
    notes.extend(findings(&file, &data, &fit));
    Ok((
        calibrated,
        estimates.collect(),
        zeros.collect(),
        bytes(python, &correlations),
        left(python, &data, &fit),
        misfits,
        [force, of_force, rise, of_rise],
        notes,
    ))
}

fn parameter(name: &str) -> PyResult<Parameter> {
    Parameter::named(name).ok_or_else(|| {
        let names: Vec<&str> = Parameter::ALL.iter().map(|parameter| parameter.name()).collect();
        FitError::new_err(format!(
            "parameters has {name:?}: must be of {}",
            names.join(", ")
        ))
    })
}

fn zero(name: &str) -> PyResult<Measured> {
    zero_named(name).ok_or_else(|| {
        let names: Vec<&str> = Measured::ALL
            .iter()
            .map(|&quantity| zero_name(quantity))
            .collect();
        FitError::new_err(format!("per_trial has {name:?}: must be of {}", names.join(", ")))
    })
}

fn fitted(
    file: &DesignFile,
    text: &str,
    bytes: &[u8],
    name: &str,
    choice: &DataChoice,
    chosen: &[Parameter],
    zeros: &[Measured],
) -> Result<(Data, Fit, String), String> {
    let data = Data::read(bytes, name, choice).map_err(|error| error.to_string())?;
    let fit = fit_per_trial(file, &data, chosen, zeros).map_err(|error| error.to_string())?;
    let calibrated = write::calibrated(text, file, &data, &fit)?;
    Ok((data, fit, calibrated))
}

/// Columns of what is left, whether each is a force, whether it did not count, and its trial.
fn left<'py>(python: Python<'py>, data: &Data, fit: &Fit) -> Left<'py> {
    let count = fit.residuals.len();
    let mut columns = vec![0.0; COLUMNS * count];
    let (mut forces, mut outliers, mut trials) = (Vec::new(), Vec::new(), Vec::new());
    for (place, residual) in fit.residuals.iter().enumerate() {
        let row = &data.rows[residual.row];
        let is_force = residual.quantity == DataQuantity::Force;
        let factor = if is_force { 1.0 } else { 1e-3 };
        let numbers = [
            row.line as f64,
            row.indentation.map_or(f64::NAN, |depth| 1e3 * depth),
            factor * residual.measured,
            factor * residual.before,
            factor * residual.fitted,
            residual.standardised,
        ];
        for (column, number) in numbers.into_iter().enumerate() {
            columns[column * count + place] = number;
        }
        forces.push(is_force);
        outliers.push(residual.outlier);
        trials.push(data.trials[row.trial].clone());
    }
    (bytes(python, &columns), forces, outliers, trials)
}
