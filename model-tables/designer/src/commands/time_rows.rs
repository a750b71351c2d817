//! Rows of a quantity over time, from a CSV file.

use crate::table_text::{Decimal, Sheet, one_line};
use output::Refusal;
use std::path::Path;

const TIME: &str = "time_s";
const TEMPERATURE: &str = "temperature_c";
/// Temperatures that a row may state, degrees Celsius.
const TEMPERATURES: [f64; 2] = [-60.0, 150.0];

/// A row of the file.
#[derive(Clone, Copy, Debug)]
pub(super) struct TimeRow {
    /// Seconds.
    pub(super) time: f64,
    /// In the unit of its column.
    pub(super) value: f64,
    /// Degrees Celsius, where the file has the column.
    pub(super) temperature: Option<f64>,
}

/// Rows whose times increase.
#[derive(Clone, Debug)]
pub(super) struct TimeRows {
    /// The column that the values come from.
    pub(super) column: &'static str,
    /// At least one.
    pub(super) rows: Vec<TimeRow>,
}

/// Columns that the tool's own rows in time have, and a trial: left out where they are not asked for.
const OWN: [&str; 9] = [
    "indentation_mm",
    "force_n",
    "pressure_rise_kpa",
    "pressure_rise_pa",
    "elastic_pressure_pa",
    "contact",
    "apex_depression_mm",
    "status",
    "trial",
];

/// Columns that are there twice, or that nobody knows: a slip in a name would else leave a column out without a word.
fn check_columns(header: &[String], given: &[&'static str]) -> Result<(), String> {
    let known: Vec<&str> = [TIME, TEMPERATURE]
        .into_iter()
        .chain(given.iter().copied())
        .chain(OWN)
        .collect();
    for (place, column) in header.iter().enumerate() {
        if let Some(before) = header[..place].iter().position(|other| other == column) {
            return Err(format!(
                "columns {} and {} are both `{column}`: leave one of them out",
                before + 1,
                place + 1
            ));
        }
        if !known.contains(&column.as_str()) {
            let lower = column.to_lowercase();
            let nearest = known
                .iter()
                .map(|name| (strsim::jaro_winkler(&lower, name), name))
                .filter(|(likeness, _)| *likeness > ALIKE)
                .max_by(|a, b| a.0.total_cmp(&b.0));
            return Err(match nearest {
                Some((_, name)) => format!("`{column}` is no column of rows in time: did you mean `{name}`?"),
                None => format!(
                    "`{column}` is no column of rows in time: leave it out; there are {TIME}, {}, {TEMPERATURE}",
                    given.join(", ")
                ),
            });
        }
    }
    Ok(())
}

/// Likeness of names from which on one may be a slip for the other.
const ALIKE: f64 = 0.8;

/// Reads `time_s` and exactly one of the columns that may be given, and `temperature_c` where it is there; other columns that the tool
/// writes are left out.
pub(super) fn read(file: &Path, given: &[&'static str]) -> Result<TimeRows, Refusal> {
    let about = |reason: &str| Refusal::about(file, &one_line(reason));
    let bytes = std::fs::read(file).map_err(|error| about(&format!("cannot be read: {error}")))?;
    let sheet = Sheet::read(&bytes).map_err(|reason| about(&reason))?;
    let header = &sheet.header;
    if header.iter().any(|column| column == TIME) {
        check_columns(header, given).map_err(|reason| about(&reason))?;
    }
    let place = |name: &str| header.iter().position(|column| column == name);
    let time = place(TIME).ok_or_else(|| {
        about(&format!(
            "there is no column `{TIME}`: there are {}",
            header.join(", ")
        ))
    })?;
    let present: Vec<(&'static str, usize)> = given
        .iter()
        .filter_map(|&name| Some((name, place(name)?)))
        .collect();
    let (column, at) = match present[..] {
        [only] => only,
        [] => {
            return Err(about(&format!(
                "needs one of the columns {}: there are {}",
                given.join(", "),
                header.join(", ")
            )));
        }
        [(first, _), (second, _), ..] => {
            return Err(about(&format!(
                "has both `{first}` and `{second}`: leave one of them out, as one follows from the other"
            )));
        }
    };
    let temperature = place(TEMPERATURE);
    let places: Vec<usize> = [Some(time), Some(at), temperature]
        .into_iter()
        .flatten()
        .collect();
    let numbers = sheet
        .rows
        .iter()
        .flat_map(|row| places.iter().map(|&at| (row.line, row.number_text(at))));
    let decimal = Decimal::of(numbers).map_err(|reason| about(&reason))?;
    let mut rows: Vec<TimeRow> = Vec::new();
    for record in &sheet.rows {
        let line = record.line;
        let number = |at: usize, column: &str| {
            let text = record.number_text(at);
            decimal.number(text).ok_or_else(|| {
                about(&format!(
                    "line {line}: `{column}` is {text:?}: must be a finite number"
                ))
            })
        };
        let row = TimeRow {
            time: number(time, TIME)?,
            value: number(at, column)?,
            temperature: temperature.map(|at| number(at, TEMPERATURE)).transpose()?,
        };
        if let Some(before) = rows.last()
            && row.time <= before.time
        {
            return Err(about(&format!(
                "line {line}: `{TIME}` is {}, not after the {} of the row before: rows follow in time",
                row.time, before.time
            )));
        }
        let [lowest, highest] = TEMPERATURES;
        if row.temperature.is_some_and(|t| !(lowest..=highest).contains(&t)) {
            return Err(about(&format!(
                "line {line}: `{TEMPERATURE}` must be from {lowest} to {highest}"
            )));
        }
        rows.push(row);
    }
    if rows.is_empty() {
        return Err(about("has no rows: needs at least one"));
    }
    Ok(TimeRows { column, rows })
}
