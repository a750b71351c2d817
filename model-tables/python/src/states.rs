//! States at rest and pressed, and tables.

use crate::{ModelError, TableError, about, bytes, design};
use model_tables::design_file::DesignFile;
use model_tables::generate::{Generated, from_design, from_design_or_worse};
use model_tables::membrane::state::Wrinkling;
use model_tables::model::{self, Fingertip};
use model_tables::table::ContactLookup as _;
use model_tables::units::PressureRise;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

/// Columns of a pressed state.
const COLUMNS: usize = 7;

type RestState = (String, [f64; 6], String);

/// The rest state and the limits.
#[pyfunction]
pub(crate) fn rest(python: Python<'_>, text: &str, name: &str) -> PyResult<RestState> {
    let design = design(text, name)?;
    python
        .detach(|| {
            let mut tip = Fingertip::new(&design)?;
            let (rest, limit) = (tip.rest(), tip.limit()?);
            let calibration = &design.calibration;
            let numbers = [
                calibration.pressure_read(rest.pressure) * 1e-3,
                rest.pole_stretch,
                rest.edge_radius * 1e3,
                rest.height * 1e3,
                rest.volume * 1e9,
                calibration.indentation_read(limit.indentation) * 1e3,
            ];
            Ok((tip.kind().to_string(), numbers, limit.ends_by.word().to_owned()))
        })
        .map_err(|error: model::ModelError| ModelError::new_err(about(name, error)))
}

/// Pressed states, in the order asked, column after column.
#[pyfunction]
pub(crate) fn solve<'py>(
    python: Python<'py>,
    text: &str,
    name: &str,
    indentation_mm: Vec<f64>,
) -> PyResult<(String, Bound<'py, PyBytes>, Vec<&'static str>)> {
    let design = design(text, name)?;
    let (kind, columns, words) =
        python
            .detach(|| solve_states(&design, &indentation_mm))
            .map_err(|error| {
                let read = error.read_by(|metres| design.calibration.indentation_read(metres));
                ModelError::new_err(about(name, read))
            })?;
    Ok((kind, bytes(python, &columns), words))
}

fn solve_states(
    design: &DesignFile,
    asked: &[f64],
) -> Result<(String, Vec<f64>, Vec<&'static str>), model::ModelError> {
    let calibration = &design.calibration;
    let mut tip = Fingertip::new(design)?;
    let count = asked.len();
    // From shallow to deep: each state starts from the one before it.
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|&a, &b| asked[a].total_cmp(&asked[b]));
    let mut columns = vec![0.0; COLUMNS * count];
    let mut words = vec![""; count];
    for place in order {
        let read = asked[place] / 1e3;
        let depth = if read < 0.0 {
            read
        } else {
            calibration.indentation_of(read).max(0.0)
        };
        let state = tip.at_indentation(depth)?;
        words[place] = state.wrinkling.map_or("", Wrinkling::word);
        let row = [
            asked[place],
            calibration.pressure_read(tip.rest_pressure() + state.pressure_rise) * 1e-3,
            calibration.pressure_read(state.pressure_rise) * 1e-3,
            state.force,
            state.contact_radius * 1e3,
            state.pole_stretch,
            state.least_tension.unwrap_or(f64::NAN),
        ];
        for (column, value) in row.into_iter().enumerate() {
            columns[column * count + place] = value;
        }
    }
    Ok((tip.kind().to_string(), columns, words))
}

fn generated(python: Python<'_>, text: &str, name: &str, allow_worse: bool) -> PyResult<Generated> {
    let design = design(text, name)?;
    let made = python.detach(|| {
        if allow_worse {
            from_design_or_worse(design)
        } else {
            from_design(design)
        }
    });
    let generated = made.map_err(|error| TableError::new_err(about(name, error)))?;
    match generated.shortfall().filter(|_| !allow_worse) {
        Some(shortfall) => Err(TableError::new_err(about(
            name,
            format_args!("{shortfall}; or take these with allow_worse=True"),
        ))),
        None => Ok(generated),
    }
}

type Made<'py> = (Bound<'py, PyBytes>, String, String, String, usize, u64, [f64; 4]);

/// The tables: binary, certificate, Rust source, CSV, bytes, inputs, errors.
#[pyfunction]
pub(crate) fn table<'py>(
    python: Python<'py>,
    text: &str,
    name: &str,
    allow_worse: bool,
) -> PyResult<Made<'py>> {
    let generated = generated(python, text, name, allow_worse)?;
    let certificate = &generated.certified.certificate;
    let own = generated.own_error().and_then(|error| error.percent());
    let numbers = [
        certificate.force.of_reading.max,
        certificate.indentation.of_reading.max,
        own.unwrap_or(f64::NAN),
        generated.end.pressure_rise,
    ];
    Ok((
        PyBytes::new(python, &generated.binary()),
        generated.certificate(),
        generated.rust_source(),
        generated.csv(),
        generated.certified.tables.bytes(),
        certificate.inputs,
        numbers,
    ))
}

/// What the chip's tables say at pressure rises: force and indentation column after column, then the feedback force where the design's
/// actuator presses; and whether each is beyond them.
#[pyfunction]
pub(crate) fn estimate<'py>(
    python: Python<'py>,
    text: &str,
    name: &str,
    pressure_rise_pa: Vec<f64>,
    allow_worse: bool,
) -> PyResult<(Bound<'py, PyBytes>, Vec<bool>)> {
    let generated = generated(python, text, name, allow_worse)?;
    if generated.certified.object.is_some() {
        return Err(TableError::new_err(about(
            name,
            "[object] is given: its tables are blended; ask `cargo designer estimate`, or leave it out",
        )));
    }
    let tables = &generated.certified.tables;
    let bits = tables.layout.fraction_bits;
    let readings: Vec<_> = pressure_rise_pa
        .iter()
        .map(|&pascals| tables.contact_at(PressureRise::from_pascals(pascals, bits)))
        .collect();
    let force = readings.iter().map(|reading| reading.force.newtons());
    let indentation = readings.iter().map(|reading| reading.indentation.metres() * 1e3);
    let mut columns: Vec<f64> = force.chain(indentation).collect();
    if let Some(feedback) = &generated.certified.feedback {
        let forces = pressure_rise_pa
            .iter()
            .map(|&pascals| feedback.lookup(PressureRise::from_pascals(pascals, bits)).newtons());
        columns.extend(forces);
    }
    let saturated = readings.iter().map(|reading| reading.saturated).collect();
    Ok((bytes(python, &columns), saturated))
}
