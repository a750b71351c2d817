//! The files of a fit: the calibrated design and what is left of the data.

use super::data::Data;
use super::{DataQuantity, Fit};
use model_tables::design_file::{Calibration, DataCurve, DesignFile};
use std::fmt::Write as _;
use toml_edit::{Array, DocumentMut, Item, Table, value};

/// The design's text with its `[calibration]` replaced; everything else stays as it is, comments too.
///
/// # Errors
/// The parser's line, where the text is no TOML.
pub fn with_calibration(text: &str, calibration: &Calibration, comment: &str) -> Result<String, String> {
    let mut document: DocumentMut = text.parse().map_err(|error| format!("{error}"))?;
    let mut table = Table::new();
    let default = Calibration::default();
    let rounded = |number: f64| value(nine_digits(number));
    let mut put = |key: &str, number: f64, unchanged: f64| {
        if number.to_bits() != unchanged.to_bits() {
            table.insert(key, rounded(number));
        }
    };
    put(
        "material_factor",
        calibration.material_factor,
        default.material_factor,
    );
    put(
        "thickness_factor",
        calibration.thickness_factor,
        default.thickness_factor,
    );
    put("pole_stretch", calibration.pole_stretch.unwrap_or(0.0), 0.0);
    if let Some(compliance) = calibration.compliance_mm3_per_kpa {
        put("compliance_mm3_per_kpa", compliance, f64::NAN);
    }
    put("pressure_gain", calibration.pressure_gain, default.pressure_gain);
    put(
        "pressure_offset_kpa",
        calibration.pressure_offset_kpa,
        default.pressure_offset_kpa,
    );
    put(
        "indentation_offset_mm",
        calibration.indentation_offset_mm,
        default.indentation_offset_mm,
    );
    if let Some(DataCurve {
        rest_pressure_kpa,
        pressure_rise_kpa,
        force_n,
        indentation_mm,
    }) = &calibration.curve
    {
        table.insert("rest_pressure_kpa", rounded(*rest_pressure_kpa));
        for (key, knots) in [
            ("curve_pressure_rise_kpa", pressure_rise_kpa),
            ("curve_force_n", force_n),
            ("curve_indentation_mm", indentation_mm),
        ] {
            let array: Array = knots.iter().map(|&knot| nine_digits(knot)).collect();
            table.insert(key, value(array));
        }
    }
    let mut lines = String::from("\n");
    for line in comment.lines() {
        let _ = writeln!(lines, "# {line}");
    }
    table.decor_mut().set_prefix(lines);
    document.remove("calibration");
    // After everything that is there.
    table.set_position(Some(isize::MAX));
    document.insert("calibration", Item::Table(table));
    Ok(document.to_string())
}

/// No bench is worth tables finer than this, percent.
const FINEST: f64 = 0.5;

/// The design's text with a press no deeper than its data, and tables that are allowed an error of `percent` of reading at least.
///
/// # Errors
/// The parser's line, where the text is no TOML.
pub fn with_reachable_tables(text: &str, deepest_mm: f64, percent: f64) -> Result<String, String> {
    let mut document: DocumentMut = text.parse().map_err(|error| format!("{error}"))?;
    let asked = document
        .get("press")
        .and_then(|press| press.get("max_indentation_mm"))
        .and_then(|asked| asked.as_float().or(asked.as_integer().map(|whole| whole as f64)));
    if asked.is_none_or(|asked| asked > deepest_mm) {
        // Down, so that it stays within.
        let within = libm::floor(1e6 * deepest_mm) / 1e6;
        if document.get("press").is_none() {
            document.insert("press", Item::Table(Table::new()));
        }
        document["press"]["max_indentation_mm"] = value(within);
    }
    for key in ["force_percent_of_reading", "indentation_percent_of_reading"] {
        let worth = (libm::ceil(100.0 * percent) / 100.0).clamp(FINEST, 10.0);
        if let Some(asked) = document
            .get_mut("accuracy")
            .and_then(|accuracy| accuracy.get_mut(key))
            && asked.as_float().is_some_and(|asked| asked < worth)
        {
            *asked = value(worth);
        }
    }
    Ok(document.to_string())
}

/// Nine significant digits: more than any bench, and a file that people can read.
fn nine_digits(number: f64) -> f64 {
    format!("{number:.8e}").parse().unwrap_or(number)
}

/// The text of the design with the `[calibration]` of a fit.
///
/// # Errors
/// The parser's line, where the text is no TOML.
pub fn calibrated(text: &str, file: &DesignFile, data: &Data, fit: &Fit) -> Result<String, String> {
    let calibration = fit.values.calibration(file, &fit.fitted);
    let mut comment = format!(
        "Fitted by `designer fit` to {}: {} rows, {} fitted parameters.",
        data.name,
        data.rows.len(),
        fit.fitted.len()
    );
    for (name, unit, factor, misfit) in [
        ("force", "N", 1.0, fit.after[0]),
        ("pressure rise", "kPa", 1e-3, fit.after[1]),
    ] {
        if let Some(misfit) = misfit {
            let _ = write!(
                comment,
                "\nLeft of the {name}: {:.4} {unit} RMS, {:.2} % of its largest.",
                factor * misfit.rms,
                misfit.rms_percent()
            );
        }
    }
    with_calibration(text, &calibration, &comment)
}

/// Every measured number beside what design and fit say.
pub fn residuals(data: &Data, fit: &Fit) -> String {
    let mut text = String::from(
        "line,trial,indentation_mm,quantity,measured,design,fitted,residual,residual_in_standard_deviations,outlier\n",
    );
    for residual in &fit.residuals {
        let row = &data.rows[residual.row];
        let (quantity, factor) = match residual.quantity {
            DataQuantity::Force => ("force_n", 1.0),
            DataQuantity::Rise => ("pressure_rise_kpa", 1e-3),
        };
        let depth = row
            .indentation
            .map_or_else(String::new, |depth| format!("{}", nine_digits(1e3 * depth)));
        let [measured, design, fitted] =
            [residual.measured, residual.before, residual.fitted].map(|number| nine_digits(factor * number));
        let trial = data.trials[row.trial].replace('"', "\"\"");
        let _ = writeln!(
            text,
            "{},\"{trial}\",{depth},{quantity},{measured},{design},{fitted},{},{:.3},{}",
            row.line,
            nine_digits(measured - fitted),
            residual.standardised,
            if residual.outlier { "yes" } else { "no" },
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rest_of_the_design_stays_as_it_was_written() {
        let text = "# my tip\nname = \"tip\" # short\n\n[membrane]\nthickness_mm = 1.00\n[calibration]\npressure_gain = 2\n";
        let calibration = Calibration {
            material_factor: 1.25,
            compliance_mm3_per_kpa: Some(0.0),
            ..Calibration::default()
        };
        let written = with_calibration(text, &calibration, "Fitted.").expect("TOML");
        assert_eq!(
            written,
            "# my tip\nname = \"tip\" # short\n\n[membrane]\nthickness_mm = 1.00\n\n# Fitted.\n[calibration]\n\
             material_factor = 1.25\ncompliance_mm3_per_kpa = 0.0\n"
        );
    }
}
