//! The page of a fit.

use super::super::bench;
use crate::fit::Fit;
use crate::fit::data::Data;
use crate::fit::findings::{QUANTITIES, findings, state};
use model_tables::design_file::DesignFile;
use output::rows::significant;
use std::fmt::Write as _;

fn digits(number: f64) -> String {
    significant(number, 4)
}

/// The page.
pub(super) fn markdown(file: &DesignFile, data: &Data, fit: &Fit) -> String {
    let mut text = format!(
        "# Calibration of `{}` to {}\n\n{} rows in {} trial(s). ![chart](fit.svg)\n\n\
         | parameter | key | design | value | standard error | state |\n|---|---|---|---|---|---|\n",
        file.name,
        data.name,
        data.rows.len(),
        data.trials.len().max(1),
    );
    for estimate in &fit.estimates {
        let _ = writeln!(
            text,
            "| {} | `{}` | {} | {} | {} | {} |",
            estimate.parameter,
            estimate.parameter.key(),
            significant(estimate.start, 5),
            significant(estimate.value, 6),
            estimate
                .standard_error
                .map_or_else(|| "-".to_owned(), |error| significant(error, 2)),
            state(estimate.held),
        );
    }
    for zero in &fit.trial_zeros {
        let _ = writeln!(
            text,
            "| {} | | 0 | {} | {} | fitted |",
            zero.title(data),
            significant(zero.value, 6),
            zero.standard_error
                .map_or_else(|| "-".to_owned(), |error| significant(error, 2)),
        );
    }
    let _ = writeln!(
        text,
        "\nStandard errors are those of the noise alone: they hold if the model does.\n"
    );
    if let Some(correlations) = &fit.correlations
        && fit.fitted.len() > 1
    {
        let names: Vec<&str> = fit.fitted.iter().map(|parameter| parameter.name()).collect();
        let _ = writeln!(
            text,
            "| correlation | {} |\n|---|{}",
            names.join(" | "),
            "---|".repeat(names.len())
        );
        for (i, name) in names.iter().enumerate() {
            let row: Vec<String> = (0..names.len())
                .map(|j| format!("{:.3}", correlations[(i, j)]))
                .collect();
            let _ = writeln!(text, "| {name} | {} |", row.join(" | "));
        }
        text.push('\n');
    }
    for (k, (name, unit, factor)) in QUANTITIES.into_iter().enumerate() {
        if let Some(noise) = fit.noise[k] {
            let _ = writeln!(
                text,
                "- noise of the {name} (what the fit leaves): {} {unit} and {:.2} % of reading",
                digits(factor * noise.floor),
                100.0 * noise.of_reading()
            );
        }
    }
    for line in data.notes.iter().cloned().chain(findings(file, data, fit)) {
        let _ = writeln!(text, "- {line}");
    }
    if let Some(caution) = bench::caution(file) {
        let _ = writeln!(text, "- material: {caution}");
    }
    let _ = writeln!(
        text,
        "- a press that is faster, slower or warmer than this bench's is another calibration where the material creeps\n\
         - on the chip the zero takes the pressure offset away, and the indentation counts from first touch"
    );
    text
}
