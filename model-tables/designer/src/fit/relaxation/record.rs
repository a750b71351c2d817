//! Press-and-hold records: indentation, pressure rise and force over time.

use super::error::HoldError;
use super::hold::{HoldRow, HoldTrial, RawTrial, trial};
use crate::fit::columns::{self, Columns};
use crate::fit::data::DataChoice;
use crate::fit::heading::Measured;
use crate::table_text::{Decimal, Sheet, SheetRow, is_missing};

const TIME: &str = "time_s";
const TEMPERATURE: &str = "temperature_c";
/// Numbers of no bench, SI.
const LARGEST: f64 = 1e12;
/// Temperatures that a fingertip stands, degrees Celsius.
const TEMPERATURES: [f64; 2] = [-60.0, 150.0];
/// What was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct HoldRecord {
    /// Where it comes from, for reports.
    pub name: String,
    /// At least one.
    pub trials: Vec<HoldTrial>,
    /// How the file was read, and what was left out, one line each.
    pub notes: Vec<String>,
}

impl HoldRecord {
    /// Reads the bytes of a file; `name` is what reports call it.
    ///
    /// # Errors
    /// [`HoldError`] for the first thing that is wrong.
    pub fn read(bytes: &[u8], name: &str, choice: &DataChoice) -> Result<Self, HoldError> {
        let sheet = Sheet::read(bytes).map_err(HoldError::Unreadable)?;
        let places = Places::find(&sheet, choice)?;
        let decimal = places.decimal(&sheet)?;
        let mut raw: Vec<RawTrial> = Vec::new();
        let mut incomplete = 0;
        for row in &sheet.rows {
            if places.only.iter().all(|(at, value)| row.cell(*at) == value)
                && !places.take(&sheet, row, decimal, &mut raw)?
            {
                incomplete += 1;
            }
        }
        let mut notes: Vec<String> = sheet.notes.iter().chain(&places.found.notes).cloned().collect();
        if decimal == Decimal::Comma {
            notes.push("numbers have decimal commas".to_owned());
        }
        if incomplete > 0 {
            notes.push(format!(
                "{incomplete} rows without time, indentation or a reading were left out"
            ));
        }
        let trials = raw
            .into_iter()
            .map(|raw| trial(raw, &mut notes))
            .collect::<Result<Vec<_>, _>>()?;
        if trials.is_empty() {
            return Err(HoldError::Unreadable(if incomplete > 0 {
                format!(
                    "none of the {incomplete} rows has a time, an indentation and a force or pressure: a record needs the three in \
                     each row"
                )
            } else {
                "has no rows: needs a press and its hold".to_owned()
            }));
        }
        Ok(Self {
            name: name.to_owned(),
            trials,
            notes,
        })
    }
}

/// Where a sheet has what a record needs.
struct Places {
    found: Columns,
    time: usize,
    temperature: Option<usize>,
    /// Columns and the value that a row must have there.
    only: Vec<(usize, String)>,
}

impl Places {
    fn find(sheet: &Sheet, choice: &DataChoice) -> Result<Self, HoldError> {
        let (named, rest): (Vec<_>, Vec<_>) = choice
            .columns
            .iter()
            .cloned()
            .partition(|(name, _)| name == TIME || name == TEMPERATURE);
        let of_name = |name: &str| {
            let given = named.iter().find(|(known, _)| known == name);
            given.map_or(name, |(_, found)| found.as_str()).to_owned()
        };
        let time = columns::place(sheet, &of_name(TIME))?;
        let asked = of_name(TEMPERATURE);
        let given = asked != TEMPERATURE || sheet.header.iter().any(|h| h.eq_ignore_ascii_case(TEMPERATURE));
        let temperature = given.then(|| columns::place(sheet, &asked)).transpose()?;
        let only: Vec<(usize, String)> = choice
            .only
            .iter()
            .map(|(column, value)| Ok((columns::place(sheet, column)?, value.clone())))
            .collect::<Result<_, HoldError>>()?;
        let mut used: Vec<usize> = only.iter().map(|(at, _)| *at).collect();
        used.push(time);
        used.extend(temperature);
        let found = Columns::find(sheet, &rest, &used)?;
        if found.quantities[Measured::Indentation as usize].is_none() {
            return Err(HoldError::NoIndentation {
                found: sheet.header.join(", "),
            });
        }
        Ok(Self {
            found,
            time,
            temperature,
            only,
        })
    }

    /// How the sheet writes numbers.
    fn decimal(&self, sheet: &Sheet) -> Result<Decimal, HoldError> {
        let quantities = self.found.quantities.iter().flatten().map(|column| column.at);
        let places: Vec<usize> = quantities.chain([self.time]).chain(self.temperature).collect();
        let numbers = sheet
            .rows
            .iter()
            .flat_map(|row| places.iter().map(|&at| (row.line, row.number_text(at))));
        Decimal::of(numbers).map_err(HoldError::Unreadable)
    }

    /// Takes a row to its trial; false where it is incomplete.
    fn take(
        &self,
        sheet: &Sheet,
        row: &SheetRow,
        decimal: Decimal,
        raw: &mut Vec<RawTrial>,
    ) -> Result<bool, HoldError> {
        let cell = |at: usize, unit: f64| -> Result<Option<f64>, HoldError> {
            let text = row.number_text(at);
            if is_missing(text) {
                return Ok(None);
            }
            match decimal.number(text).map(|number| number * unit) {
                Some(number) if number.abs() < LARGEST => Ok(Some(number)),
                _ => Err(HoldError::Cell {
                    line: row.line,
                    column: sheet.header[at].clone(),
                    found: text.to_owned(),
                    allowed: "a finite number of a bench, or empty".to_owned(),
                }),
            }
        };
        let of = |quantity: Measured| match self.found.quantities[quantity as usize] {
            Some(column) => cell(column.at, column.unit),
            None => Ok(None),
        };
        let [indentation, force, rise] = [
            of(Measured::Indentation)?,
            of(Measured::Force)?,
            of(Measured::PressureRise)?,
        ];
        let (Some(seconds), Some(indentation)) = (cell(self.time, 1.0)?, indentation) else {
            return Ok(false);
        };
        if force.is_none() && rise.is_none() {
            return Ok(false);
        }
        let name = self.found.trial.map_or("", |at| row.cell(at));
        let at = raw
            .iter()
            .position(|trial| trial.name == name)
            .unwrap_or_else(|| {
                raw.push(RawTrial {
                    name: name.to_owned(),
                    rows: Vec::new(),
                    temperatures: Vec::new(),
                });
                raw.len() - 1
            });
        if let Some(before) = raw[at].rows.last()
            && seconds <= before.time
        {
            return Err(HoldError::Cell {
                line: row.line,
                column: TIME.to_owned(),
                found: format!("{seconds}"),
                allowed: format!("after the {} s of the row before it in its trial", before.time),
            });
        }
        if let Some(celsius) = self.temperature.map(|at| cell(at, 1.0)).transpose()?.flatten() {
            let [lowest, highest] = TEMPERATURES;
            if !(lowest..=highest).contains(&celsius) {
                return Err(HoldError::Cell {
                    line: row.line,
                    column: TEMPERATURE.to_owned(),
                    found: format!("{celsius}"),
                    allowed: format!("from {lowest} to {highest} degrees Celsius"),
                });
            }
            raw[at].temperatures.push(celsius);
        }
        raw[at].rows.push(HoldRow {
            line: row.line,
            time: seconds,
            indentation,
            rise,
            force,
            count: 1.0,
        });
        Ok(true)
    }
}
