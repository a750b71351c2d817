//! Bench data: rows of indentation, force and pressure rise from a CSV file, checked before anything is fitted.

pub use super::data_error::DataError;

use super::data_error::{FORCE, INDENTATION, PRESSURE};
use crate::table_text;

/// Which way the plate moved.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Direction {
    /// Deeper.
    Loading,
    /// Back.
    Unloading,
    /// Not said, and not to be seen.
    Unknown,
}

/// One row; SI units, `None` where the cell is empty or the column missing.
#[derive(Clone, Debug, PartialEq)]
pub struct DataRow {
    /// Line of the file, counted from 1.
    pub line: u64,
    /// Index of its trial, in the order of first appearance.
    pub trial: usize,
    /// Which way the plate moved.
    pub direction: Direction,
    /// Indentation as the stage reads it, metres.
    pub indentation: Option<f64>,
    /// Force, newtons.
    pub force: Option<f64>,
    /// Pressure rise over rest as the transducer reads it, pascals.
    pub rise: Option<f64>,
}

impl DataRow {
    /// How deep it is pressed, for an order: its indentation or, without, its pressure rise.
    pub fn depth(&self) -> f64 {
        self.indentation.or(self.rise).unwrap_or(0.0)
    }
}

/// What was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Data {
    /// Where it comes from, for reports.
    pub name: String,
    /// Rows with at least two of the three quantities, in the order of the file.
    pub rows: Vec<DataRow>,
    /// Names of the trials; one, empty, where there is no such column.
    pub trials: Vec<String>,
    /// Rows left out because fewer than two quantities were there.
    pub incomplete: usize,
}

/// How columns are found and rows chosen.
#[derive(Clone, Debug, PartialEq)]
pub struct DataChoice {
    /// Name of the column with the pressure rise, kilopascals.
    pub pressure_column: String,
    /// Only rows whose column has this value.
    pub only: Vec<(String, String)>,
    /// Only rows of this direction.
    pub direction: Option<Direction>,
}

impl Default for DataChoice {
    fn default() -> Self {
        Self {
            pressure_column: PRESSURE.to_owned(),
            only: Vec::new(),
            direction: None,
        }
    }
}

/// Rows that a fit takes at least.
const LEAST_ROWS: usize = 3;
/// Rank correlation under which a quantity does not grow with another.
const LEAST_CORRELATION: f64 = 0.5;
/// A turn back by more than this part of the range of a trial changes the direction.
const TURN: f64 = 0.15;

/// A column's name, its values and the factor to its unit.
type Column = (&'static str, fn(&DataRow) -> Option<f64>, f64);

impl Data {
    /// Reads CSV text; `name` is what reports call it.
    ///
    /// # Errors
    /// [`DataError`] for the first thing that is wrong.
    pub fn parse(text: &str, name: &str, choice: &DataChoice) -> Result<Self, DataError> {
        let mut reader = table_text::reader(text);
        let unreadable = |error: csv::Error| DataError::Unreadable(table_text::one_line(&error.to_string()));
        let header = table_text::header(&mut reader).map_err(unreadable)?;
        let place = |name: &str| header.iter().position(|column| column == name);
        let needed = |name: &str| {
            place(name).ok_or_else(|| DataError::Column {
                missing: name.to_owned(),
                found: header.join(", "),
            })
        };
        let pressure = if choice.pressure_column == PRESSURE {
            place(PRESSURE)
        } else {
            Some(needed(&choice.pressure_column)?)
        };
        let columns = [place(INDENTATION), place(FORCE), pressure];
        if columns.iter().flatten().count() < 2 {
            return Err(DataError::TooFewColumns {
                found: header.join(", "),
            });
        }
        let only: Vec<(usize, &str)> = choice
            .only
            .iter()
            .map(|(column, value)| Ok((needed(column)?, value.as_str())))
            .collect::<Result<_, DataError>>()?;
        let (trial_column, direction_column) = (place("trial"), place("direction"));
        let mut data = Self {
            name: name.to_owned(),
            rows: Vec::new(),
            trials: Vec::new(),
            incomplete: 0,
        };
        for record in reader.records() {
            let record = record.map_err(unreadable)?;
            let line = record.position().map_or(0, csv::Position::line);
            let cell = |column: usize| record.get(column).unwrap_or_default();
            if !only.iter().all(|&(column, value)| same(cell(column), value)) {
                continue;
            }
            let number = |which: usize, factor: f64| -> Result<Option<f64>, DataError> {
                let Some(column) = columns[which] else {
                    return Ok(None);
                };
                let text = cell(column);
                if text.is_empty() {
                    return Ok(None);
                }
                match text.parse::<f64>() {
                    Ok(value) if value.is_finite() => Ok(Some(factor * value)),
                    _ => Err(DataError::Cell {
                        line,
                        column: header[column].clone(),
                        found: text.to_owned(),
                        allowed: "a finite number or empty",
                    }),
                }
            };
            let row = DataRow {
                line,
                trial: data.trial(trial_column.map_or("", cell)),
                direction: direction(direction_column.map_or("", cell), line)?,
                indentation: number(0, 1e-3)?,
                force: number(1, 1.0)?,
                rise: number(2, 1e3)?,
            };
            if [row.indentation, row.force, row.rise].iter().flatten().count() < 2 {
                data.incomplete += 1;
            } else {
                data.rows.push(row);
            }
        }
        data.infer_directions();
        if let Some(direction) = choice.direction {
            data.rows.retain(|row| row.direction == direction);
        }
        data.check()?;
        Ok(data)
    }

    fn trial(&mut self, name: &str) -> usize {
        self.trials
            .iter()
            .position(|known| known == name)
            .unwrap_or_else(|| {
                self.trials.push(name.to_owned());
                self.trials.len() - 1
            })
    }

    /// Fills in the directions that the file does not give, trial by trial, from the order of the rows: a zigzag with
    /// [`TURN`]. Rows in no order at all turn too often, and stay unknown.
    fn infer_directions(&mut self) {
        if self.rows.iter().any(|row| row.direction != Direction::Unknown) {
            return;
        }
        for trial in 0..self.trials.len() {
            let members: Vec<usize> = (0..self.rows.len())
                .filter(|&i| self.rows[i].trial == trial)
                .collect();
            let drive: Vec<f64> = members
                .iter()
                .filter_map(|&i| self.rows[i].indentation.or(self.rows[i].force))
                .collect();
            if drive.len() < members.len() {
                continue;
            }
            for (i, direction) in members.iter().zip(zigzag(&drive)) {
                self.rows[*i].direction = direction;
            }
        }
    }

    fn check(&self) -> Result<(), DataError> {
        if self.rows.len() < LEAST_ROWS {
            return Err(DataError::TooFewRows {
                found: self.rows.len(),
                needed: LEAST_ROWS,
            });
        }
        let columns: [Column; 3] = [
            (INDENTATION, |row| row.indentation, 1e3),
            (FORCE, |row| row.force, 1.0),
            (PRESSURE, |row| row.rise, 1e-3),
        ];
        for (column, of, unit) in columns {
            let values: Vec<f64> = self.rows.iter().filter_map(of).collect();
            if let Some(&first) = values.first()
                && values.iter().all(|value| value.to_bits() == first.to_bits())
            {
                return Err(DataError::Constant {
                    column: column.to_owned(),
                    value: first * unit,
                });
            }
        }
        for (a, b) in [(1, 0), (2, 0), (1, 2)] {
            let pairs: Vec<[f64; 2]> = self
                .rows
                .iter()
                .filter_map(|row| Some([columns[b].1(row)?, columns[a].1(row)?]))
                .collect();
            if pairs.len() < LEAST_ROWS {
                continue;
            }
            let correlation = rank_correlation(&pairs);
            if correlation < LEAST_CORRELATION {
                return Err(DataError::NotGrowing {
                    column: columns[a].0.to_owned(),
                    with: columns[b].0.to_owned(),
                    correlation,
                });
            }
        }
        Ok(())
    }
}

/// The direction that a cell names.
fn direction(cell: &str, line: u64) -> Result<Direction, DataError> {
    match cell {
        "" => Ok(Direction::Unknown),
        "loading" => Ok(Direction::Loading),
        "unloading" => Ok(Direction::Unloading),
        other => Err(DataError::Cell {
            line,
            column: "direction".to_owned(),
            found: other.to_owned(),
            allowed: "`loading`, `unloading` or empty",
        }),
    }
}

/// Whether a cell has a value: as a number if both are, else letter by letter.
fn same(cell: &str, value: &str) -> bool {
    match (cell.parse::<f64>(), value.parse::<f64>()) {
        (Ok(a), Ok(b)) => (a - b).abs() <= 1e-9 * a.abs().max(b.abs()),
        _ => cell == value,
    }
}

/// Directions along a sequence of depths.
fn zigzag(drive: &[f64]) -> Vec<Direction> {
    let (low, high) = drive
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &value| {
            (low.min(value), high.max(value))
        });
    let turn = TURN * (high - low);
    let mut directions = vec![Direction::Unknown; drive.len()];
    // Whether it rises, since which row, and where the extreme of that run is.
    let (mut rising, mut since, mut extreme, mut turns) = (None, 0, 0, 0);
    let name = |rising: Option<bool>| match rising {
        Some(true) => Direction::Loading,
        Some(false) => Direction::Unloading,
        None => Direction::Unknown,
    };
    let (mut lowest, mut highest) = (0, 0);
    for i in 1..drive.len() {
        match rising {
            None => {
                lowest = if drive[i] < drive[lowest] { i } else { lowest };
                highest = if drive[i] > drive[highest] { i } else { highest };
                if drive[i] - drive[lowest] > turn {
                    (rising, extreme) = (Some(true), i);
                } else if drive[highest] - drive[i] > turn {
                    (rising, extreme) = (Some(false), i);
                }
            }
            Some(up) => {
                let ahead = if up {
                    drive[i] >= drive[extreme]
                } else {
                    drive[i] <= drive[extreme]
                };
                if ahead {
                    extreme = i;
                } else if (drive[i] - drive[extreme]).abs() > turn {
                    directions[since..=extreme].fill(name(rising));
                    (rising, since, extreme) = (Some(!up), extreme + 1, i);
                    turns += 1;
                }
            }
        }
    }
    directions[since..].fill(name(rising));
    if 4 * turns > drive.len() {
        directions.fill(Direction::Unknown);
    }
    directions
}

/// Spearman's rank correlation; ties share their mean rank.
fn rank_correlation(pairs: &[[f64; 2]]) -> f64 {
    let [a, b] = [0, 1].map(|k| ranks(&pairs.iter().map(|pair| pair[k]).collect::<Vec<_>>()));
    let mean = 0.5 * (pairs.len() as f64 - 1.0);
    let product =
        |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| (a - mean) * (b - mean)).sum() };
    product(&a, &b) / libm::sqrt(product(&a, &a) * product(&b, &b))
}

fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let mut ranks = vec![0.0; values.len()];
    let mut start = 0;
    while start < order.len() {
        let mut end = start;
        while end < order.len() && values[order[end]].to_bits() == values[order[start]].to_bits() {
            end += 1;
        }
        for &i in &order[start..end] {
            ranks[i] = 0.5 * (start + end - 1) as f64;
        }
        start = end;
    }
    ranks
}

#[cfg(test)]
mod tests;
