//! `designer loop --diameter-mm`: the loop over diameters of the actuator.

use super::super::bench;
use super::{COLUMNS, Solving, at_rest, cells, of_constant_compliance, state_at};
use model_tables::design_file::DesignFile;
use output::rows::{Cell, Rows};
use output::{CommandAnswer, Refusal};
use std::path::Path;

/// The diameter, and the columns of the loop.
const BY_DIAMETER: &[&str] = &[
    "diameter_mm",
    COLUMNS[0],
    COLUMNS[1],
    COLUMNS[2],
    COLUMNS[3],
    COLUMNS[4],
    COLUMNS[5],
    COLUMNS[6],
];

/// The indentations of each diameter, in the order asked.
pub(super) fn run(
    file: &Path,
    design_file: &DesignFile,
    diameters: &[f64],
    indentations: &[f64],
) -> Result<CommandAnswer, Refusal> {
    let mut rows = Rows::new(BY_DIAMETER);
    let mut notes = Vec::new();
    let solving = Solving::begin(diameters.len() * indentations.len());
    for (i, &diameter) in diameters.iter().enumerate() {
        let disc = super::disc(file, &design_file.with_actuator_diameter(diameter))?;
        let refuse = |error: &dyn std::fmt::Display| {
            Refusal::about(file, &format_args!("with --diameter-mm {diameter}: {error}"))
        };
        let (mut haptic, note) = at_rest(file, design_file, &disc)
            .map_err(|Refusal(reason)| Refusal(format!("{reason} (with --diameter-mm {diameter})")))?;
        if i == 0 {
            notes.extend(note);
        }
        let mut deepest = None;
        for &asked in indentations {
            let indentation = bench::depth(&design_file.calibration, asked);
            let state = state_at(&mut haptic, indentation).map_err(|error| refuse(&error))?;
            solving.is_done();
            let mut row = vec![Cell::Number(diameter), Cell::Number(asked)];
            row.extend(cells(&state));
            rows.push(row);
            if deepest.is_none_or(|(depth, _)| indentation > depth) {
                deepest = Some((indentation, state));
            }
        }
        if let Some((indentation, state)) = deepest.filter(|(_, state)| state.touch.pressure_rise > 0.0) {
            let told = of_constant_compliance(&haptic, indentation, &state);
            notes.push(format!("diameter {diameter} mm: {told}"));
        }
    }
    Ok(CommandAnswer { rows, notes })
}
