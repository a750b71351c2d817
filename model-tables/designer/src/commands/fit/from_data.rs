//! `designer fit --from-data`: tables from a monotone curve through the data alone.

use super::super::bench;
use super::Arguments;
use crate::fit;
use crate::fit::data::Data;
use crate::fit::spline::{DataBranch, FromData, from_data};
use crate::fit::write;
use model_tables::design_file::{Calibration, DataCurve, DesignFile};
use model_tables::generate::{self, GenerateError};
use model_tables::model::Fingertip;
use output::drawing::{Anchor, BLACK, BLUE, Drawing, GREY, Marker};
use output::files;
use output::linear::{LinearAxis, LinearPanel};
use output::rows::{Cell, Rows, significant};
use output::{CommandAnswer, Refusal};
use std::fmt::Write as _;

const COLUMNS: &[&str] = &[
    "quantity",
    "rows",
    "outliers",
    "knots",
    "full_scale",
    "rms",
    "largest_error",
    "held_out_rms",
    "held_out_rms_percent",
    "held_out_largest_error",
    "held_out_refused",
];

/// What is written beside the design.
const FILES: [&str; 2] = ["from-data.md", "from-data.svg"];
/// Knots of a curve as it is written, and the power by which they crowd towards zero.
const KNOTS: usize = 60;
const CROWDING: f64 = 1.6;
/// Part of the range that may lie between zero and the first data.
const EMPTY: f64 = 0.1;
/// Tables are so many times as exact as the data, or less where no tables are.
const FINER: [f64; 3] = [5.0, 3.0, 2.0];
/// Difference between loading and unloading, in percent of full scale, that is worth a warning.
const HYSTERESIS: f64 = 2.0;

fn digits(number: f64) -> String {
    significant(number, 4)
}

pub(super) fn run(arguments: &Arguments, file: &DesignFile, data: &Data) -> Result<CommandAnswer, Refusal> {
    let stem = format!("{}-from-data.toml", file.name);
    if let Some(out) = &arguments.out {
        files::expect_folder(out, &[FILES[0], FILES[1], &stem])?;
    }
    fit::check_shape(file, data).map_err(|error| Refusal::about(&arguments.data, &error))?;
    let found = from_data(data).map_err(|error| Refusal::about(&arguments.data, &error))?;
    let branches = branches(&found);
    let mut rows = Rows::new(COLUMNS);
    for (name, branch, factor) in &branches {
        rows.push(vec![
            Cell::word(name),
            Cell::Count(branch.rows),
            Cell::Count(branch.outliers),
            Cell::Count(branch.knots),
            Cell::Number(factor * branch.misfit.full_scale),
            Cell::Number(factor * branch.misfit.rms),
            Cell::Number(factor * branch.misfit.largest),
            Cell::Number(factor * branch.held_out.rms),
            Cell::Number(branch.held_out.rms_percent()),
            Cell::Number(factor * branch.held_out.largest),
            Cell::Count(branch.refused),
        ]);
    }
    let mut notes = data.notes.clone();
    notes.extend(findings(&found, data));
    notes.extend(fit::lag(file, data).map(|lag| lag.to_string()));
    notes.extend(bench::caution(file));
    if let Some(out) = &arguments.out {
        if found.start > EMPTY * found.end && !arguments.to_zero {
            let reason = format!(
                "the data begin at a pressure rise of {} kPa, and nothing is known of lighter presses: measure them, or let \
                 the curve run to the origin all the same with --to-zero",
                digits(1e-3 * found.start)
            );
            return Err(Refusal::about(&arguments.data, &reason));
        }
        let (rest, whence) = rest_pressure(arguments, file)?;
        notes.push(whence);
        let curve = knots(&found, rest).ok_or_else(|| {
            Refusal::about(
                &arguments.data,
                &"tables give force and indentation, and too few rows have indentation_mm beside the pressure: \
                  measure it, or leave --out away",
            )
        })?;
        let text = std::fs::read_to_string(&arguments.design)
            .map_err(|error| Refusal::about(&arguments.design, &error))?;
        let deepest = curve.indentation_mm.last().copied().unwrap_or_default();
        let calibration = Calibration {
            curve: Some(curve),
            ..Calibration::default()
        };
        let comment = format!(
            "By `designer fit --from-data` from {}: {} rows, pressure rises of {} to {} kPa.\n\
             Tables come from this curve alone; the design's model plays no part in them.\n\
             Predicted from the others, a row's force is met to {} N RMS ({:.2} % of the largest).",
            data.name,
            found.force.rows,
            digits(1e-3 * found.start),
            digits(1e-3 * found.end),
            digits(found.force.held_out.rms),
            found.force.held_out.rms_percent(),
        );
        let refuse = |reason: String| Refusal::about(&arguments.design, &reason);
        let text = write::with_calibration(&text, &calibration, &comment).map_err(refuse)?;
        let (text, note) = with_tables(&text, &stem, deepest, &found)
            .map_err(|Refusal(reason)| Refusal::about(&arguments.design, &reason))?;
        notes.push(note);
        let mut page = format!(
            "# A curve from {} alone\n\n![chart](from-data.svg)\n\n",
            data.name
        );
        for line in &notes {
            let _ = writeln!(page, "- {line}");
        }
        // The design last: it stands for the set.
        let contents = [
            (FILES[0], page.into_bytes()),
            (FILES[1], draw(data, &found).into_bytes()),
            (stem.as_str(), text.into_bytes()),
        ];
        files::write_all(out, &contents)?;
        notes.push(format!(
            "wrote {stem}, from-data.md and from-data.svg to {}",
            out.display()
        ));
    }
    Ok(CommandAnswer { rows, notes })
}

/// The design's text with an accuracy that tables meet, and what to say of them.
fn with_tables(
    text: &str,
    stem: &str,
    deepest_mm: f64,
    found: &FromData,
) -> Result<(String, String), Refusal> {
    let mut refused = String::new();
    for finer in FINER {
        let percent = found.force.held_out.rms_percent() / finer;
        let text = write::with_reachable_tables(text, deepest_mm, percent).map_err(Refusal)?;
        match generate::from_design(DesignFile::parse(&text, stem).map_err(Refusal::of)?) {
            Ok(generated) => {
                let note = format!(
                    "tables from this curve take {} bytes and end at {} mm, a pressure rise of {} kPa and {} N: beyond, the chip \
                     reports `saturated`",
                    generated.certified.tables.bytes(),
                    digits(1e3 * generated.end.indentation),
                    digits(1e-3 * generated.end.pressure_rise),
                    digits(generated.end.force)
                );
                return Ok((text, note));
            }
            Err(error @ GenerateError::MissingSection { .. }) => {
                return Ok((text, format!("no tables were tried: {error}")));
            }
            Err(GenerateError::NoTables(error)) => refused = error.to_string(),
            Err(error) => return Err(Refusal(error.to_string())),
        }
    }
    Err(Refusal(refused))
}

fn branches(found: &FromData) -> Vec<(&'static str, &DataBranch, f64)> {
    let mut branches = vec![("force_n", &found.force, 1.0)];
    branches.extend(
        found
            .indentation
            .as_ref()
            .map(|branch| ("indentation_mm", branch, 1e3)),
    );
    branches
}

/// What the transducer reads at rest, kilopascals, and where that comes from.
fn rest_pressure(arguments: &Arguments, file: &DesignFile) -> Result<(f64, String), Refusal> {
    if let Some(given) = arguments.rest_pressure_kpa {
        return Ok((given, format!("the rest pressure is {given} kPa, as given")));
    }
    let rest = Fingertip::new(file)
        .map_err(|error| Refusal::about(&arguments.design, &error))?
        .rest_pressure();
    let rest = 1e-3 * file.calibration.pressure_read(rest);
    Ok((
        rest,
        format!(
            "the rest pressure, {} kPa, is the model's: give the measured one with --rest-pressure-kpa",
            digits(rest)
        ),
    ))
}

/// The knots of the curve; `None` without the indentation.
fn knots(found: &FromData, rest_pressure_kpa: f64) -> Option<DataCurve> {
    let depth = found.indentation.as_ref()?;
    let rises: Vec<f64> = (1..=KNOTS)
        .map(|k| found.end * libm::pow(k as f64 / KNOTS as f64, CROWDING))
        .collect();
    let of = |at: &dyn Fn(f64) -> f64| -> Vec<f64> { rises.iter().map(|&rise| at(rise)).collect() };
    Some(DataCurve {
        rest_pressure_kpa,
        pressure_rise_kpa: of(&|rise| 1e-3 * rise),
        force_n: of(&|rise| found.force.at(rise)),
        indentation_mm: of(&|rise| 1e3 * depth.at(rise)),
    })
}

fn findings(found: &FromData, data: &Data) -> Vec<String> {
    let mut lines = vec![format!(
        "calibrated for pressure rises of {} to {} kPa: below, the curve runs to the origin, where nothing was measured",
        digits(1e-3 * found.start),
        digits(1e-3 * found.end)
    )];
    for (name, branch, factor) in branches(found) {
        let (name, unit) = match name {
            "force_n" => ("force", "N"),
            _ => ("indentation", "mm"),
        };
        let (parts, by_trial) = branch.cross_validation;
        lines.push(format!(
            "{name}: predicted from the others ({parts} parts{}), a row is met to {} {unit} RMS ({:.2} % of the largest) and \
             {} {unit} at most; {} rows were refused as beyond the others' range, {} of {} are outliers",
            if by_trial { ", whole trials" } else { "" },
            digits(factor * branch.held_out.rms),
            branch.held_out.rms_percent(),
            digits(factor * branch.held_out.largest),
            branch.refused,
            branch.outliers,
            branch.rows,
        ));
        if let Some(hysteresis) = branch.hysteresis {
            let warning = if hysteresis.percent() > HYSTERESIS {
                ": one curve cannot meet both, and a reading is that uncertain"
            } else {
                ""
            };
            lines.push(format!(
                "hysteresis: at equal pressure, unloading less loading, the {name} differs by {} {unit} on average and {} \
                 {unit} ({:.2} % of the largest) at most{warning}",
                digits(factor * hysteresis.mean),
                digits(factor * hysteresis.largest),
                hysteresis.percent()
            ));
        }
    }
    if found.force.hysteresis.is_none() {
        lines.push("hysteresis is not known: the data have no loading and unloading to compare".to_owned());
    }
    if let Some(saturation) = found.saturation {
        lines.push(format!(
            "the pressure saturates from {} kPa ({} N) on: a pascal there means up to {:.0} times as much force as in the \
             middle of the range, {} N",
            digits(1e-3 * saturation.from),
            digits(saturation.force),
            saturation.ratio,
            digits(saturation.slope),
        ));
    }
    if let Some([falls, steps]) = found.falls
        && falls > 0
    {
        lines.push(format!(
            "the mean pressure falls at {falls} of {steps} steps to a deeper indentation: there it does not tell the depth"
        ));
    }
    if data.incomplete > 0 {
        lines.push(format!(
            "{} rows with fewer than two quantities were left out",
            data.incomplete
        ));
    }
    lines
}

const WIDTH: f64 = 960.0;
const HEIGHT: f64 = 430.0;

fn draw(data: &Data, found: &FromData) -> String {
    let mut drawing = Drawing::new(WIDTH, HEIGHT);
    let title = format!("{}: a monotone curve through the data", data.name);
    drawing.text([20.0, 26.0], Anchor::Start, 16.0, BLACK, &title);
    let branches = branches(found);
    let width = (WIDTH - 30.0) / branches.len() as f64;
    for (i, (name, branch, factor)) in branches.iter().enumerate() {
        let left = 75.0 + width * i as f64;
        let panel = LinearPanel {
            x: LinearAxis::from_zero(1e-3 * found.end, [left, left + width - 90.0]),
            y: LinearAxis::from_zero(factor * branch.misfit.full_scale, [HEIGHT - 60.0, 60.0]),
        };
        panel.draw(&mut drawing);
        let middle = 0.5 * (panel.x.pixels[0] + panel.x.pixels[1]);
        drawing.text(
            [middle, HEIGHT - 22.0],
            Anchor::Middle,
            13.0,
            BLACK,
            "pressure rise, kPa",
        );
        drawing.upward(
            [left - 52.0, 0.5 * HEIGHT],
            13.0,
            if *name == "force_n" {
                "force, N"
            } else {
                "indentation, mm"
            },
        );
        for row in &data.rows {
            let value = if *name == "force_n" {
                row.force
            } else {
                row.indentation
            };
            if let (Some(rise), Some(value)) = (row.rise, value) {
                let at = panel.at([1e-3 * rise, factor * value]);
                drawing.marker(Marker::Circle, at, GREY, true);
            }
        }
        let line: Vec<[f64; 2]> = (0..=200)
            .map(|k| found.end * f64::from(k) / 200.0)
            .map(|rise| panel.at([1e-3 * rise, factor * branch.at(rise)]))
            .collect();
        drawing.path(&line, BLUE, 2.2);
    }
    drawing.finish()
}
