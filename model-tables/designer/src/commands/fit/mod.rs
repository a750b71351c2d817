//! `designer fit`: calibrates a design to bench data.

mod chart;
mod from_data;
mod relaxation;
mod report;

use super::numbers::finite;
use super::{bench, read};
use crate::fit::data::{Data, DataChoice, Direction};
use crate::fit::findings::{findings, state};
use crate::fit::parameter::Parameter;
use crate::fit::trial_zeros::{zero_name, zero_named};
use crate::fit::write;
use crate::fit::{self, Fit, Measured};
use model_tables::design_file::DesignFile;
use model_tables::model::Fingertip;
use output::files;
use output::progress::Ticks;
use output::rows::{Cell, Rows};
use output::{CommandAnswer, Refusal};
use std::path::PathBuf;
use std::time::Instant;

const COLUMNS: &[&str] = &["parameter", "key", "start", "value", "standard_error", "state"];

/// What is written beside the calibrated design.
const FILES: [&str; 3] = ["fit.md", "fit.svg", "residuals.csv"];

/// What `--help` says after the options.
pub(super) const HELP: &str = "\
DATA.csv has the columns indentation_mm, force_n and pressure_rise_kpa. Any two of them are enough. The columns trial and
direction (loading, unloading) are optional. The command recognises and reports headings like `Force (kN)` or
`Pressure (in bar)`, separators `;` and tab, decimal commas, a row of units, UTF-16 and Latin-1. Use --columns to name other
columns. Lines that begin with # are comments. The indentation is assumed to be exact.

Parameters: material and thickness (factors), pole-stretch, compliance, pressure-gain, pressure-offset,
indentation-offset, force-offset. A parameter that the data cannot determine is held at the design's value, and reported.
With --per-trial each trial has its own zeros, fitted with the parameters. First touch is found from the rows before it.

With --relaxation DATA.csv is a record in time of one or more trials, each from the untouched tip to the end of a hold. Its
columns are time_s, indentation_mm, pressure_rise_kpa or force_n or both, and, for several of them, trial and temperature_c.
Press in a second or less and hold for a minute or more, to two depths. The result is [material.relaxation] with the interval
of each term, and a list of what the record cannot determine.

Examples:
  cargo designer fit index-fingertip.toml bench.csv --out calibrated/
  cargo designer fit index-fingertip.toml bench.csv --fit material,compliance,pressure-gain
  cargo designer fit index-fingertip.toml bench.csv --per-trial indentation-offset,force-offset
  cargo designer fit tip.toml bench.csv --from-data --rest-pressure-kpa 0 --out calibrated/
  cargo designer fit tip.toml bench.csv --columns force_n=Fz,pressure_rise_kpa=3 --only position_mm=50
  cargo designer fit index-fingertip.toml hold.csv --relaxation --out relaxing/";

#[derive(Debug, clap::Args)]
#[allow(clippy::struct_excessive_bools)] // each is a switch of the command line
pub(super) struct Arguments {
    /// The design file
    design: PathBuf,
    /// The bench data (CSV)
    data: PathBuf,
    /// Parameters to fit, separated by commas
    #[arg(long = "fit", value_name = "LIST", value_delimiter = ',', value_parser = parameter,
          default_values_t = Parameter::USUAL)]
    parameters: Vec<Parameter>,
    /// Zeros to fit for each trial, separated by commas: indentation-offset, force-offset, pressure-offset
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = zero,
          conflicts_with_all = ["from_data", "relaxation"])]
    per_trial: Vec<Measured>,
    /// Folder for the calibrated design, the report, a chart and the residuals; created if it does not exist
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Make the tables without the model, from a monotone curve through the data
    #[arg(long, conflicts_with = "parameters")]
    from_data: bool,
    /// Fit the relaxation series to press-and-hold records: `time_s`, `indentation_mm`, `pressure_rise_kpa` or `force_n`
    #[arg(long, conflicts_with_all = ["parameters", "from_data", "direction"])]
    relaxation: bool,
    /// With --relaxation, also fit the relaxed modulus
    #[arg(long, requires = "relaxation")]
    free_modulus: bool,
    /// With --from-data, extend the curve to the origin even if the data begin at a larger indentation
    #[arg(long, requires = "from_data")]
    to_zero: bool,
    /// Rest pressure, kilopascals, for --from-data [default: the model's]
    #[arg(long, value_name = "P", requires = "from_data", value_parser = finite, allow_hyphen_values = true)]
    rest_pressure_kpa: Option<f64>,
    /// Columns of the file by name or number, as in `force_n=Fz,pressure_rise_kpa=3`
    #[arg(long, value_name = "NAME=COLUMN", value_delimiter = ',', value_parser = pair)]
    columns: Vec<(String, String)>,
    /// Column with the pressure rise, in kilopascals: `--columns pressure_rise_kpa=NAME`
    #[arg(long, value_name = "NAME")]
    pressure_column: Option<String>,
    /// Use only rows whose column has this value; may be given several times
    #[arg(long, value_name = "COLUMN=VALUE", value_parser = pair)]
    only: Vec<(String, String)>,
    /// Use only rows of this direction
    #[arg(long, value_enum)]
    direction: Option<Way>,
}

/// A direction by name.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum Way {
    Loading,
    Unloading,
}

fn parameter(name: &str) -> Result<Parameter, String> {
    Parameter::named(name).ok_or_else(|| {
        let names: Vec<&str> = Parameter::ALL.iter().map(|parameter| parameter.name()).collect();
        format!("must be of {}", names.join(", "))
    })
}

fn zero(name: &str) -> Result<Measured, String> {
    zero_named(name).ok_or_else(|| {
        let names: Vec<&str> = Measured::ALL
            .iter()
            .map(|&quantity| zero_name(quantity))
            .collect();
        format!("must be of {}", names.join(", "))
    })
}

fn pair(text: &str) -> Result<(String, String), String> {
    text.split_once('=')
        .map(|(column, value)| (column.trim().to_owned(), value.trim().to_owned()))
        .ok_or_else(|| "must be COLUMN=VALUE".to_owned())
}

pub(super) fn run(arguments: &Arguments) -> Result<CommandAnswer, Refusal> {
    let file = read(&arguments.design)?;
    let mut columns = arguments.columns.clone();
    columns.extend(
        arguments
            .pressure_column
            .iter()
            .map(|name| (Measured::PressureRise.column().to_owned(), name.clone())),
    );
    let choice = DataChoice {
        columns,
        only: arguments.only.clone(),
        direction: arguments.direction.map(|way| match way {
            Way::Loading => Direction::Loading,
            Way::Unloading => Direction::Unloading,
        }),
    };
    files::keep(&arguments.data);
    let bytes = std::fs::read(&arguments.data)
        .map_err(|error| Refusal::about(&arguments.data, &format!("the data cannot be read: {error}")))?;
    if arguments.relaxation {
        return relaxation::run(arguments, &file, &bytes, &choice);
    }
    let name = arguments
        .data
        .file_name()
        .map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let data = Data::read(&bytes, &name, &choice).map_err(|error| Refusal::about(&arguments.data, &error))?;
    if arguments.from_data {
        return from_data::run(arguments, &file, &data);
    }
    let stem = format!("{}-calibrated.toml", file.name);
    if let Some(out) = &arguments.out {
        files::expect_folder(out, &[FILES[0], FILES[1], FILES[2], &stem])?;
    }
    let start = Instant::now();
    let ticks = Ticks::begin(move || {
        format!(
            "fit: {:.0} s, {} states of the model solved",
            start.elapsed().as_secs_f64(),
            fit::states_solved()
        )
    });
    let fit = fit::fit_per_trial(&file, &data, &arguments.parameters, &arguments.per_trial)
        .map_err(|error| Refusal::about(&arguments.data, &error))?;
    let seconds = start.elapsed().as_secs_f64();
    let mut notes = data.notes.clone();
    notes.extend(findings(&file, &data, &fit));
    notes.extend(bench::caution(&file));
    // What is written is the calibrated design, and its limits count.
    let calibrated = DesignFile {
        calibration: fit.values.calibration(&file, &fit.fitted),
        ..file.clone()
    };
    let mut tip = Fingertip::new(&calibrated).map_err(|error| Refusal::about(&arguments.design, &error))?;
    let deepest = calibrated.calibration.indentation_of(fit.deepest);
    notes.extend(bench::beyond_strain(&calibrated, &mut tip, deepest));
    notes.push(super::model::note_of_error(&calibrated, &mut tip, 0.0));
    drop(ticks);
    if let Some(out) = &arguments.out {
        let design_text = std::fs::read_to_string(&arguments.design)
            .map_err(|error| Refusal::about(&arguments.design, &error))?;
        let calibrated = write::calibrated(&design_text, &file, &data, &fit)
            .map_err(|reason| Refusal::about(&arguments.design, &reason))?;
        // The design last: it stands for the set.
        let contents = [
            (FILES[0], report::markdown(&file, &data, &fit).into_bytes()),
            (FILES[1], chart::draw(&file, &data, &fit).into_bytes()),
            (FILES[2], write::residuals(&data, &fit).into_bytes()),
            (stem.as_str(), calibrated.into_bytes()),
        ];
        files::write_all(out, &contents)?;
        notes.push(format!(
            "wrote {}, fit.md, fit.svg and residuals.csv to {}",
            stem,
            out.display()
        ));
    }
    notes.push(format!("fitted and checked in {seconds:.2} s"));
    Ok(CommandAnswer {
        rows: rows(&data, &fit),
        notes,
    })
}

fn rows(data: &Data, fit: &Fit) -> Rows {
    let mut rows = Rows::new(COLUMNS);
    for estimate in &fit.estimates {
        rows.push(vec![
            Cell::word(estimate.parameter.name()),
            Cell::word(estimate.parameter.key()),
            Cell::Number(estimate.start),
            Cell::Number(estimate.value),
            estimate.standard_error.map_or(Cell::word(""), Cell::Number),
            Cell::word(state(estimate.held)),
        ]);
    }
    for zero in &fit.trial_zeros {
        rows.push(vec![
            Cell::Text(zero.title(data)),
            Cell::word(""),
            Cell::Number(0.0),
            Cell::Number(zero.value),
            zero.standard_error.map_or(Cell::word(""), Cell::Number),
            Cell::word(state(None)),
        ]);
    }
    rows
}
