//! A press in time.

use crate::{DesignError, ModelError, about, bytes, design};
use model_tables::design_file::DesignFile;
use model_tables::material::relaxation::Relaxation;
use model_tables::model::choice::elements_in_time;
use model_tables::solid::history::{Drive, History};
use model_tables::solid::mesh::Elements;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

/// Rounding of a first touch, metres.
const TOUCH: f64 = 1e-12;

/// Indentation, pressure rise, force and apex depression column after column, and whether each instant touches.
#[pyfunction]
pub(crate) fn history<'py>(
    python: Python<'py>,
    text: &str,
    name: &str,
    time_s: Vec<f64>,
    driven: Vec<f64>,
    by_force: bool,
) -> PyResult<(Bound<'py, PyBytes>, Vec<bool>)> {
    let design = design(text, name)?;
    let elements = elements_in_time(design.model).ok_or_else(|| {
        DesignError::new_err(about(
            name,
            "a press in time needs a wall that bends, model.kind is \"membrane\": set it to \"solid\" or \"auto\", with \
             the semi-axes of the outer surface and no [rest]",
        ))
    })?;
    let (columns, contact) = python
        .detach(|| advance(&design, elements, &time_s, &driven, by_force))
        .map_err(|reason| ModelError::new_err(about(name, reason)))?;
    Ok((bytes(python, &columns), contact))
}

fn advance(
    design: &DesignFile,
    elements: Elements,
    times: &[f64],
    driven: &[f64],
    by_force: bool,
) -> Result<(Vec<f64>, Vec<bool>), String> {
    let calibration = &design.calibration;
    let drive = |value: f64| {
        if by_force {
            Drive::Force(value)
        } else {
            Drive::Indentation(calibration.indentation_of(1e-3 * value))
        }
    };
    let (Some(&start), Some(&first)) = (times.first(), driven.first()) else {
        return Err("time_s is empty: give the untouched fingertip's instant at least".to_owned());
    };
    let begin = match drive(first) {
        Drive::Indentation(metres) => metres,
        Drive::Force(0.0) => 0.0,
        Drive::Force(newtons) => {
            return Err(format!(
                "the first force_n is {newtons}: it has to be the untouched fingertip, with 0"
            ));
        }
    };
    if begin > TOUCH {
        return Err(format!(
            "the first indentation_mm is {first}: it has to be the untouched fingertip, with 0"
        ));
    }
    if by_force && let Some(pulled) = driven.iter().find(|newtons| **newtons < 0.0) {
        return Err(format!(
            "force_n is {pulled}: a plate does not pull, give 0 or more"
        ));
    }
    let relaxation = design.relaxation.unwrap_or(Relaxation::new(&[], 20.0, 0.0));
    let mut history = History::new(&design.design(), &relaxation, elements, start, begin.min(0.0))
        .map_err(|error| error.to_string())?;
    let count = times.len();
    let mut columns = vec![0.0; 4 * count];
    let mut contact = Vec::with_capacity(count);
    for (place, (&time, &value)) in times.iter().zip(driven).enumerate() {
        let instant = if place == 0 {
            history.now()
        } else {
            history
                .advance(time, drive(value))
                .map_err(|error| error.to_string())?
        };
        let row = [
            calibration.indentation_read(instant.indentation) * 1e3,
            calibration.pressure_read(instant.pressure_rise) * 1e-3,
            instant.force,
            instant.apex_depression * 1e3,
        ];
        for (column, number) in row.into_iter().enumerate() {
            columns[column * count + place] = number;
        }
        contact.push(instant.in_contact());
    }
    Ok((columns, contact))
}
