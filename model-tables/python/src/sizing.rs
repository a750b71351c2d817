//! Membranes for a wanted force over the indentation.

use crate::{DesignError, ModelError, about, bytes};
use designer::size::Sized;
use designer::size::confirm::ConfirmedSizing;
use designer::size::target::Target;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

/// A design: its file, its material, the model of its wall, whether nothing is better in all, how it wrinkles, numbers, forces.
type SizedDesign<'py> = (
    String,
    &'static str,
    String,
    bool,
    &'static str,
    [f64; 15],
    Bound<'py, PyBytes>,
);

/// Designs that get tables, those of the command: the best first; why others are left out, the presses that were solved, and the
/// indentations of the target, mm.
type Sizing<'py> = (Vec<SizedDesign<'py>>, Vec<String>, usize, Vec<f64>);

/// At most `best` designs for a target.
#[pyfunction]
pub(crate) fn size<'py>(python: Python<'py>, text: &str, name: &str, best: usize) -> PyResult<Sizing<'py>> {
    let target = Target::parse(text, name).map_err(|error| DesignError::new_err(error.to_string()))?;
    let sizing = python
        .detach(|| ConfirmedSizing::of(&target, best, &|_| ()))
        .map_err(|reason| ModelError::new_err(about(name, reason)))?;
    let rows = sizing.designs.iter().enumerate().map(|(rank, design)| {
        let sized = &design.sized;
        (
            design.design_file(&format!("{}-{}", target.name, rank + 1)),
            sized.material.name,
            design.kind.map_or_else(String::new, |kind| kind.to_string()),
            sizing.is_non_dominated(design),
            sized.wrinkling.word(),
            numbers(sized, &target),
            bytes(python, &sized.forces),
        )
    });
    let indentations = target.indentations.iter().map(|metres| 1e3 * metres).collect();
    Ok((
        rows.collect(),
        sizing.left_out.clone(),
        sizing.found.solved,
        indentations,
    ))
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
