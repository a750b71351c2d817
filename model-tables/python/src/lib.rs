//! What the Python package `fingertip` calls. Designs come in as TOML, numbers go out as bytes that numpy takes as they
//! are; names, units and dataclasses are in `fingertip/__init__.py`. Every function lets go of Python's lock while it solves.
#![forbid(unsafe_code)]
// PyO3 takes arguments by value.
#![allow(clippy::needless_pass_by_value)]

mod calibration;
mod many;
mod sizing;
mod states;
mod time;

use model_tables::design_file::DesignFile;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

pyo3::import_exception!(fingertip.errors, DesignError);
pyo3::import_exception!(fingertip.errors, FitError);
pyo3::import_exception!(fingertip.errors, ModelError);
pyo3::import_exception!(fingertip.errors, SweepError);
pyo3::import_exception!(fingertip.errors, TableError);

/// Reads a design; `name` is what its errors call it.
fn design(text: &str, name: &str) -> PyResult<DesignFile> {
    DesignFile::parse(text, name).map_err(|error| DesignError::new_err(error.to_string()))
}

/// A line of an error, with the design's name before it as on the command line.
fn about(name: &str, reason: impl std::fmt::Display) -> String {
    format!("{name}: {reason}")
}

/// Numbers as numpy takes them: native 64-bit floats.
fn bytes<'py>(python: Python<'py>, numbers: &[f64]) -> Bound<'py, PyBytes> {
    let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_ne_bytes()).collect();
    PyBytes::new(python, &bytes)
}

/// Checks a design; gives its canonical text, every value written out.
#[pyfunction]
fn canonical(text: &str, name: &str) -> PyResult<String> {
    Ok(design(text, name)?.canonical())
}

#[pymodule]
mod _fingertip {
    #[pymodule_export]
    use super::calibration::fit;
    #[pymodule_export]
    use super::canonical;
    #[pymodule_export]
    use super::many::{SweepFolder, sweep, sweep_part, sweep_text};
    #[pymodule_export]
    use super::sizing::size;
    #[pymodule_export]
    use super::states::{estimate, rest, solve, table};
    #[pymodule_export]
    use super::time::history;
}
