//! `designer rest`: the rest state and the limits.

use super::model::{self, Model};
use super::{bench, read, warn_of_instability};
use model_tables::design_file::DesignFile;
use model_tables::membrane::TensionField;
use model_tables::membrane::press::Press;
use model_tables::membrane::rest::Branch;
use model_tables::model::ModelError;
use model_tables::model::{Fingertip, Kind};
use model_tables::solid;
use model_tables::solid::mesh::Elements;
use output::rows::{Cell, Rows};
use output::{CommandAnswer, Refusal};
use std::path::Path;

const COLUMNS: &[&str] = &[
    "rest_pressure_kpa",
    "pole_stretch",
    "equator_radius_mm",
    "height_mm",
    "volume_mm3",
    "max_indentation_mm",
    "ends_by",
];

pub(super) fn run(file: &Path) -> Result<CommandAnswer, Refusal> {
    let design_file = read(file)?;
    let calibration = &design_file.calibration;
    let model = model::of(file, &design_file)?;
    if let Kind::Solid(elements) = model.kind {
        return solid(file, &design_file, &model, elements);
    }
    let mut press =
        Press::new(&model.design, TensionField::Relaxed).map_err(|error| Refusal::about(file, &error))?;
    let rest = *press.rest();
    let limit = press.limit().map_err(|error| Refusal::about(file, &error))?;
    warn_of_instability(file, "at rest", press.rest_stability());
    if press.rest_stability().is_stable() {
        warn_of_instability(file, "at the end of the press", press.stability());
    }
    let mut rows = Rows::new(COLUMNS);
    rows.push(vec![
        Cell::Number(calibration.pressure_read(rest.pressure) * 1e-3),
        Cell::Number(rest.pole_stretch),
        Cell::Number(rest.edge_radius * 1e3),
        Cell::Number(rest.height * 1e3),
        Cell::Number(rest.volume * 1e9),
        Cell::Number(calibration.indentation_read(limit.indentation) * 1e3),
        Cell::word(limit.ends_by.word()),
    ]);
    let mut notes = match press.branch() {
        Branch::Only => Vec::new(),
        Branch::Lower { other } => vec![format!(
            "two rest states: this is the less stretched, the other has a pole stretch of {other:.6}"
        )],
        Branch::Upper { other } => vec![format!(
            "two rest states: this is the more stretched, the other has a pole stretch of {other:.6}"
        )],
    };
    let mut tip = Fingertip::Membrane(Box::new(press));
    bench::warn_of_strain(file, &design_file, &mut tip, 0.0);
    notes.extend(model.note);
    notes.push(model::note_of_error(&design_file, &mut tip, 0.0));
    notes.extend(bench::caution(&design_file));
    Ok(CommandAnswer { rows, notes })
}

/// The rest state of a solid.
fn solid(
    file: &Path,
    design_file: &DesignFile,
    model: &Model,
    elements: Elements,
) -> Result<CommandAnswer, Refusal> {
    let calibration = &design_file.calibration;
    let refuse = |error: ModelError| Refusal::about(file, &error);
    let mut press = solid::press::Press::new(&model.design, elements).map_err(refuse)?;
    let rest = *press.rest();
    let limit = press.limit().map_err(|error| refuse(error.into()))?;
    let mut rows = Rows::new(COLUMNS);
    rows.push(vec![
        Cell::Number(calibration.pressure_read(rest.pressure) * 1e-3),
        Cell::Number(rest.pole_stretch),
        Cell::Number(rest.edge_radius * 1e3),
        Cell::Number(rest.height * 1e3),
        Cell::Number(rest.volume * 1e9),
        Cell::Number(calibration.indentation_read(limit.indentation) * 1e3),
        Cell::word(limit.ends_by.word()),
    ]);
    let mut tip = Fingertip::Solid(Box::new(press));
    bench::warn_of_strain(file, design_file, &mut tip, 0.0);
    let error = model::note_of_error(design_file, &mut tip, 0.0);
    Ok(CommandAnswer {
        rows,
        notes: model
            .note
            .iter()
            .cloned()
            .chain([error])
            .chain(bench::caution(design_file))
            .collect(),
    })
}
