//! `designer fit --relaxation`: the series of a wall from press-and-hold records.

mod chart;
mod words;
mod write;

use super::Arguments;
use crate::fit::data::DataChoice;
use crate::fit::relaxation::record::HoldRecord;
use crate::fit::relaxation::{self, RelaxationFit};
use model_tables::design_file::DesignFile;
use output::files;
use output::rows::{Cell, Rows};
use output::{CommandAnswer, Refusal};

const COLUMNS: &[&str] = &[
    "term",
    "tau_s",
    "tau_standard_error_s",
    "tau_low_s",
    "tau_high_s",
    "g",
    "g_standard_error",
    "g_low",
    "g_high",
    "identifiable",
];

/// What is written beside the design.
const FILES: [&str; 2] = ["relaxation.svg", "residuals.csv"];

pub(super) fn run(
    arguments: &Arguments,
    file: &DesignFile,
    bytes: &[u8],
    choice: &DataChoice,
) -> Result<CommandAnswer, Refusal> {
    let about = |reason: &dyn std::fmt::Display| Refusal::about(&arguments.data, reason);
    let name = arguments
        .data
        .file_name()
        .map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let record = HoldRecord::read(bytes, &name, choice).map_err(|error| about(&error))?;
    let stem = format!("{}-relaxing.toml", file.name);
    if let Some(out) = &arguments.out {
        files::expect_folder(out, &[FILES[0], FILES[1], &stem])?;
    }
    let fit =
        relaxation::fit_relaxation(file, &record, arguments.free_modulus).map_err(|error| about(&error))?;
    let mut notes = record.notes.clone();
    notes.extend(words::findings(file, &record, &fit));
    if let Some(out) = &arguments.out {
        let text = std::fs::read_to_string(&arguments.design)
            .map_err(|error| Refusal::about(&arguments.design, &error))?;
        let design = write::with_series(&text, file, &record, &fit)
            .map_err(|reason| Refusal::about(&arguments.design, &reason))?;
        // The design last: it stands for the set.
        let contents = [
            (FILES[0], chart::draw(file, &record, &fit).into_bytes()),
            (FILES[1], write::residuals(&record, &fit).into_bytes()),
            (stem.as_str(), design.into_bytes()),
        ];
        files::write_all(out, &contents)?;
        notes.push(format!(
            "wrote {stem}, relaxation.svg and residuals.csv to {}",
            out.display()
        ));
    }
    notes.push(format!("for the design:\n\n{}", write::block(&fit)));
    Ok(CommandAnswer {
        rows: rows(&fit),
        notes,
    })
}

fn rows(fit: &RelaxationFit) -> Rows {
    let mut rows = Rows::new(COLUMNS);
    // Value, standard error and interval; those that the record does not tell are empty.
    let cells = |value: f64, error: Option<f64>, interval: Option<[f64; 2]>| match (error, interval) {
        (Some(error), Some([low, high])) => [value, error * value, low, high].map(Cell::Number),
        _ => [
            Cell::Number(value),
            Cell::word(""),
            Cell::word(""),
            Cell::word(""),
        ],
    };
    for (i, term) in fit.terms.iter().enumerate() {
        let mut row = vec![Cell::Text((i + 1).to_string())];
        row.extend(cells(term.time, term.time_error, term.time_interval()));
        row.extend(cells(
            term.weight,
            Some(term.weight_error),
            term.weight_interval(),
        ));
        row.push(Cell::word(term.identifiability.label()));
        rows.push(row);
    }
    rows
}
