//! Membranes for a wanted force over the indentation.

use crate::{DesignError, ModelError, about, bytes};
use designer::size::target::Target;
use designer::size::{NOTHING_FOUND, Sized, size as find};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

/// A design: its file, its material, whether nothing is better in all, how it wrinkles, numbers, forces.
type SizedDesign<'py> = (
    String,
    &'static str,
    bool,
    &'static str,
    [f64; 15],
    Bound<'py, PyBytes>,
);

/// Designs for a target, the best first; the presses that were solved, and the name and indentations of the target, mm.
#[pyfunction]
pub(crate) fn size<'py>(
    python: Python<'py>,
    text: &str,
    name: &str,
) -> PyResult<(Vec<SizedDesign<'py>>, usize, Vec<f64>)> {
    let target = Target::parse(text, name).map_err(|error| DesignError::new_err(error.to_string()))?;
    let found = python.detach(|| find(&target, &|_| ()));
    if found.designs.is_empty() {
        return Err(ModelError::new_err(about(name, NOTHING_FOUND)));
    }
    let rows = found.designs.iter().enumerate().map(|(rank, sized)| {
        let name = format!("{}-{}", target.name, rank + 1);
        let front = !found.designs.iter().any(|other| other.dominates(sized));
        (
            sized.design_file(&name, &target),
            sized.material.name,
            front,
            sized.wrinkling.word(),
            numbers(sized, &target),
            bytes(python, &sized.forces),
        )
    });
    let indentations = target.indentations.iter().map(|metres| 1e3 * metres).collect();
    Ok((rows.collect(), found.solved, indentations))
}

/// The numbers of a row of the command, in its order and units.
fn numbers(sized: &Sized, target: &Target) -> [f64; 15] {
    let membrane = &sized.design.membrane;
    let [radial, axial, wall] = sized.by_tolerance.map(|part| 100.0 * part);
    [
        1e3 * membrane.radial_semi_axis,
        1e3 * membrane.axial_semi_axis,
        1e3 * membrane.thickness,
        sized.stretch(),
        100.0 * sized.misfit,
        1e-3 * sized.rest_pressure,
        1e-3 * sized.peak_pressure,
        sized.largest_stretch,
        sized.strain_share.unwrap_or(f64::NAN),
        sized.least_tension,
        1e3 * sized.limit,
        sized.limit_margin(target),
        radial,
        axial,
        wall,
    ]
}
