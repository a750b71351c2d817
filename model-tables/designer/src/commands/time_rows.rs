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

/// Reads `time_s` and exactly one of the columns that may be given, and `temperature_c` where it is there; other columns are left out.
pub(super) fn read(file: &Path, given: &[&'static str]) -> Result<TimeRows, Refusal> {
    let about = |reason: &str| Refusal::about(file, &one_line(reason));
    let bytes = std::fs::read(file).map_err(|error| about(&format!("cannot be read: {error}")))?;
    let sheet = Sheet::read(&bytes).map_err(|reason| about(&reason))?;
    let header = &sheet.header;
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
