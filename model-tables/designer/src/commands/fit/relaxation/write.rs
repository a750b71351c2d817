//! The files of a fitted series: the design with it, and what is left.

use crate::fit::Measured;
use crate::fit::relaxation::RelaxationFit;
use crate::fit::relaxation::record::HoldRecord;
use model_tables::design_file::DesignFile;
use std::fmt::Write as _;
use toml_edit::{Array, DocumentMut, Item, Table, value};

/// Six significant digits: more than any record tells.
fn digits(number: f64) -> f64 {
    format!("{number:.5e}").parse().unwrap_or(number)
}

fn table(fit: &RelaxationFit) -> Table {
    let column = |of: fn(&model_tables::material::relaxation::Term) -> f64| -> Array {
        fit.series.terms().iter().map(|term| digits(of(term))).collect()
    };
    let mut table = Table::new();
    table.insert("tau_s", value(column(|term| term.time)));
    table.insert("g", value(column(|term| term.weight)));
    table.insert("temperature_c", value(digits(fit.series.temperature)));
    if fit.series.shift > 0.0 {
        table.insert("shift_per_kelvin", value(digits(fit.series.shift)));
    }
    table
}

/// The section as text.
pub(super) fn block(fit: &RelaxationFit) -> String {
    let mut document = DocumentMut::new();
    let mut material = Table::new();
    material.set_implicit(true);
    material.insert("relaxation", Item::Table(table(fit)));
    document.insert("material", Item::Table(material));
    let mut text = document.to_string();
    if fit.modulus_error.is_some() {
        let _ = write!(
            text,
            "\n# The relaxed modulus: calibration.material_factor times {}\n",
            digits(fit.modulus)
        );
    }
    text
}

/// The design's text with the series, and everything else as it was written.
pub(super) fn with_series(
    text: &str,
    file: &DesignFile,
    record: &HoldRecord,
    fit: &RelaxationFit,
) -> Result<String, String> {
    let mut document: DocumentMut = text.parse().map_err(|error| format!("{error}"))?;
    let mut series = table(fit);
    series.decor_mut().set_prefix(format!(
        "\n# Fitted by `designer fit --relaxation` to {}: {} trials, {} terms.\n",
        record.name,
        record.trials.len(),
        fit.terms.len()
    ));
    let material = document
        .get_mut("material")
        .and_then(Item::as_table_mut)
        .ok_or("material is not a section [material]: write it so, for [material.relaxation] below it")?;
    material.remove("relaxation");
    material.insert("relaxation", Item::Table(series));
    if fit.modulus_error.is_some() {
        let factor = digits(file.calibration.material_factor * fit.modulus);
        if document.get("calibration").is_none() {
            let mut calibration = Table::new();
            calibration.set_position(Some(isize::MAX));
            document.insert("calibration", Item::Table(calibration));
        }
        document["calibration"]["material_factor"] = value(factor);
    }
    Ok(document.to_string())
}

/// Every reading beside the settled wall's and the fit's.
pub(super) fn residuals(record: &HoldRecord, fit: &RelaxationFit) -> String {
    let mut text = String::from(
        "line,trial,time_s,indentation_mm,quantity,measured,settled,fitted,residual_percent,residual_in_standard_deviations\n",
    );
    for residual in &fit.residuals {
        let trial = &record.trials[residual.trial];
        let row = &trial.rows[residual.row];
        let factor = residual.quantity.per_si();
        let percent = if residual.measured.abs() > 0.0 {
            format!(
                "{:.4}",
                100.0 * (residual.measured - residual.fitted) / residual.measured
            )
        } else {
            String::new()
        };
        let _ = writeln!(
            text,
            "{},\"{}\",{},{},{},{},{},{},{percent},{:.3}",
            row.line,
            trial.name.replace('"', "\"\""),
            row.time,
            digits(1e3 * row.indentation),
            match residual.quantity {
                Measured::Force => "force_n",
                _ => "pressure_rise_kpa",
            },
            digits(factor * residual.measured),
            digits(factor * residual.settled),
            digits(factor * residual.fitted),
            residual.standardised,
        );
    }
    text
}
