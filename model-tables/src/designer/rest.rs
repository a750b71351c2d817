//! `designer rest`: the rest state and the limits.

use super::rows::{Cell, Rows};
use super::{Answer, Refusal, read, warn_of_instability};
use crate::membrane::TensionField;
use crate::press::Press;
use crate::rest::Branch;
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

pub(super) fn run(file: &Path) -> Result<Answer, Refusal> {
    let design = read(file)?.design();
    let mut press =
        Press::new(&design, TensionField::Relaxed).map_err(|error| Refusal::about(file, &error))?;
    let rest = *press.rest();
    let limit = press.limit().map_err(|error| Refusal::about(file, &error))?;
    warn_of_instability(file, "at rest", press.rest_stability());
    if press.rest_stability().is_stable() {
        warn_of_instability(file, "at the end of the press", press.stability());
    }
    let mut rows = Rows::new(COLUMNS);
    rows.push(vec![
        Cell::Number(rest.pressure * 1e-3),
        Cell::Number(rest.pole_stretch),
        Cell::Number(rest.edge_radius * 1e3),
        Cell::Number(rest.height * 1e3),
        Cell::Number(rest.volume * 1e9),
        Cell::Number(limit.indentation * 1e3),
        Cell::word(limit.ends_by.word()),
    ]);
    let notes = match press.branch() {
        Branch::Only => Vec::new(),
        Branch::Lower { other } => vec![format!(
            "two rest states: this is the less stretched, the other has a pole stretch of {other:.6}"
        )],
        Branch::Upper { other } => vec![format!(
            "two rest states: this is the more stretched, the other has a pole stretch of {other:.6}"
        )],
    };
    Ok(Answer { rows, notes })
}
