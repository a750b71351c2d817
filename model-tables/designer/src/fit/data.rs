//! Bench data: rows of indentation, force and pressure rise from a CSV file, checked before anything is fitted.

pub use super::data_error::DataError;
pub use super::record::{Data, DataRow, Direction};

use super::clipping;
use super::columns::{self, Columns};
use super::heading::Measured;
use crate::table_text::{Decimal, Sheet, SheetRow, is_missing};

/// How columns are found and rows chosen.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DataChoice {
    /// Pairs of a name of the contract and the file's name or number of that column.
    pub columns: Vec<(String, String)>,
    /// Only rows whose column has this value.
    pub only: Vec<(String, String)>,
    /// Only rows of this direction; `None`: all rows.
    pub direction: Option<Direction>,
}

/// Rows that a fit takes at least.
const MIN_ROWS: usize = 3;
/// Numbers of no bench, SI: a logger's mark of a missing value, or a slip.
const LARGEST: f64 = 1e12;
/// Pressures of the air, pascals, and the part of the deepest press up to which one is light.
const AIR: [f64; 2] = [8e4, 1.1e5];
const LIGHT: f64 = 0.3;
/// Nines from this number on that are so many times as large as all else are a logger's mark.
const NINES: f64 = 999.0;
const FAR: f64 = 3.0;
/// Rank correlation under which a quantity does not grow with another.
const MIN_CORRELATION: f64 = 0.5;
/// A turn back by more than this part of the range of a trial changes the direction.
const TURN: f64 = 0.15;

/// A quantity of the negative sign is so many times as large there as on the positive side.
const NEGATIVE: f64 = 4.0;

/// How the cells of a file become numbers.
struct Cells<'a> {
    sheet: &'a Sheet,
    columns: &'a Columns,
    decimal: Decimal,
}

impl Cells<'_> {
    /// A quantity of a row, SI; `None` where its cell is empty.
    fn number(&self, row: &SheetRow, quantity: Measured) -> Result<Option<f64>, DataError> {
        let Some(column) = self.columns.quantities[quantity as usize] else {
            return Ok(None);
        };
        let text = row.number_text(column.at);
        if is_missing(text) {
            return Ok(None);
        }
        match self.decimal.number(text).map(|number| number * column.unit) {
            Some(number) if number.abs() < LARGEST => Ok(Some(number)),
            _ => Err(DataError::Cell {
                line: row.line,
                column: self.sheet.header[column.at].clone(),
                found: text.to_owned(),
                allowed: "a finite number of a bench, or empty",
            }),
        }
    }
}

impl Data {
    /// Reads text; `name` is what reports call it.
    ///
    /// # Errors
    /// [`DataError`] for the first thing that is wrong.
    pub fn parse(text: &str, name: &str, choice: &DataChoice) -> Result<Self, DataError> {
        Self::read(text.as_bytes(), name, choice)
    }

    /// Reads the bytes of a file; `name` is what reports call it.
    ///
    /// # Errors
    /// [`DataError`] for the first thing that is wrong.
    pub fn read(bytes: &[u8], name: &str, choice: &DataChoice) -> Result<Self, DataError> {
        let sheet = Sheet::read(bytes).map_err(DataError::Unreadable)?;
        let only: Vec<(usize, &str)> = choice
            .only
            .iter()
            .map(|(column, value)| Ok((columns::place(&sheet, column)?, value.as_str())))
            .collect::<Result<_, DataError>>()?;
        let filters: Vec<usize> = only.iter().map(|(at, _)| *at).collect();
        let columns = Columns::find(&sheet, &choice.columns, &filters)?;
        let places: Vec<usize> = columns
            .quantities
            .iter()
            .flatten()
            .map(|column| column.at)
            .collect();
        let numbers = sheet
            .rows
            .iter()
            .flat_map(|row| places.iter().map(|&at| (row.line, row.number_text(at))));
        let decimal = Decimal::of(numbers).map_err(DataError::Unreadable)?;
        let mut data = Self {
            name: name.to_owned(),
            rows: Vec::new(),
            trials: Vec::new(),
            incomplete: 0,
            notes: sheet.notes.iter().chain(&columns.notes).cloned().collect(),
        };
        if decimal == Decimal::Comma {
            data.notes.push("numbers have decimal commas".to_owned());
        }
        let cells = Cells {
            sheet: &sheet,
            columns: &columns,
            decimal,
        };
        for row in &sheet.rows {
            if !only
                .iter()
                .all(|&(column, value)| same(row.cell(column), value, decimal))
            {
                continue;
            }
            let of = |at: Option<usize>| at.map_or("", |at| row.cell(at));
            let row = DataRow {
                line: row.line,
                trial: data.trial(of(columns.trial)),
                direction: direction(of(columns.direction), row.line)?,
                indentation: cells.number(row, Measured::Indentation)?,
                force: cells.number(row, Measured::Force)?,
                rise: cells.number(row, Measured::PressureRise)?,
            };
            if row.quantities() < 2 {
                data.incomplete += 1;
            } else {
                data.rows.push(row);
            }
        }
        if let Some((column, value)) = choice.only.first()
            && data.rows.is_empty()
            && data.incomplete == 0
            && !sheet.rows.is_empty()
        {
            return Err(DataError::NoneChosen {
                choice: format!("--only {column}={value}"),
                rows: sheet.rows.len(),
            });
        }
        data.check_marks(&sheet.header, &columns)?;
        data.turn_signs();
        data.infer_directions();
        if let Some(direction) = choice.direction {
            let before = data.rows.len();
            data.rows.retain(|row| row.direction == direction);
            if data.rows.is_empty() && before > 0 {
                return Err(DataError::NoneChosen {
                    choice: "--direction".to_owned(),
                    rows: before,
                });
            }
        }
        data.check()?;
        let clipped = clipping::take_out(&mut data);
        if !clipped.is_empty() {
            data.notes.extend(clipped);
            data.check()?;
        }
        Ok(data)
    }

    /// Turns the sign of indentations and forces that are negative in compression.
    fn turn_signs(&mut self) {
        for quantity in [Measured::Indentation, Measured::Force] {
            let values = || self.rows.iter().filter_map(|row| row.get(quantity));
            let (low, high) = (values().fold(0.0, f64::min), values().fold(0.0, f64::max));
            if -low > NEGATIVE * high && values().count() >= MIN_ROWS {
                for row in &mut self.rows {
                    let turned = row.get(quantity).map(|value| -value);
                    row.set(quantity, turned);
                }
                self.notes.push(format!(
                    "the {quantity} is negative in compression: its sign was turned"
                ));
            }
        }
    }

    /// Refuses a logger's mark of a missing value, `-9999` and the like, far from all readings.
    fn check_marks(&self, header: &[String], columns: &Columns) -> Result<(), DataError> {
        for quantity in Measured::ALL {
            let Some(column) = columns.quantities[quantity as usize] else {
                continue;
            };
            let read = |row: &DataRow| row.get(quantity).map(|value| value / column.unit);
            let (marks, readings): (Vec<_>, Vec<_>) = self
                .rows
                .iter()
                .filter_map(|row| Some((row.line, read(row)?)))
                .partition(|(_, value): &(u64, f64)| is_nines(value.abs()));
            let largest = readings.iter().map(|(_, value)| value.abs()).fold(0.0, f64::max);
            if let Some(&(line, value)) = marks.iter().find(|(_, value)| value.abs() > FAR * largest)
                && !readings.is_empty()
            {
                return Err(DataError::Cell {
                    line,
                    column: header[column.at].clone(),
                    found: format!("{}", value.round()),
                    allowed: "a reading: nines far from all others are a logger's mark of a missing value, so leave the cell empty",
                });
            }
        }
        Ok(())
    }

    /// Refuses pressures that begin at that of the air.
    fn check_air(&self) -> Result<(), DataError> {
        let drive = |row: &DataRow| row.indentation.or(row.force);
        let pressed = self.rows.iter().filter_map(|row| Some([drive(row)?, row.rise?]));
        let deepest = pressed.clone().map(|[drive, _]| drive).fold(0.0, f64::max);
        let lightest = pressed.clone().min_by(|a, b| a[0].total_cmp(&b[0]));
        let least = pressed.map(|[_, rise]| rise).fold(f64::INFINITY, f64::min);
        match lightest {
            Some([drive, rise])
                if drive < LIGHT * deepest && (AIR[0]..=AIR[1]).contains(&rise) && least > AIR[0] =>
            {
                Err(DataError::BeginsAtAir { least: rise })
            }
            _ => Ok(()),
        }
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
        use Measured::{Force, Indentation, PressureRise};
        if self.rows.len() < MIN_ROWS {
            return Err(DataError::TooFewRows {
                found: self.rows.len(),
                needed: MIN_ROWS,
            });
        }
        for quantity in Measured::ALL {
            let values: Vec<f64> = self.rows.iter().filter_map(|row| row.get(quantity)).collect();
            if let Some(&first) = values.first()
                && values.iter().all(|value| value.to_bits() == first.to_bits())
            {
                return Err(DataError::Constant {
                    column: quantity.column().to_owned(),
                    value: first * quantity.per_si(),
                });
            }
        }
        self.check_air()?;
        for (a, b) in [
            (Force, Indentation),
            (PressureRise, Indentation),
            (Force, PressureRise),
        ] {
            let pairs: Vec<[f64; 2]> = self
                .rows
                .iter()
                .filter_map(|row| Some([row.get(b)?, row.get(a)?]))
                .collect();
            if pairs.len() < MIN_ROWS {
                continue;
            }
            let correlation = rank_correlation(&pairs);
            if correlation < MIN_CORRELATION {
                return Err(DataError::NotGrowing {
                    column: a.column().to_owned(),
                    with: b.column().to_owned(),
                    correlation,
                });
            }
        }
        Ok(())
    }
}

/// 999, 9999 and so on.
fn is_nines(value: f64) -> bool {
    let whole = value.round();
    let digits = format!("{whole}");
    value >= NINES && (value - whole).abs() < 1e-6 * whole && digits.bytes().all(|digit| digit == b'9')
}

/// The direction that a cell names.
fn direction(cell: &str, line: u64) -> Result<Direction, DataError> {
    match cell.to_lowercase().as_str() {
        "" => Ok(Direction::Unknown),
        "loading" => Ok(Direction::Loading),
        "unloading" => Ok(Direction::Unloading),
        _ => Err(DataError::Cell {
            line,
            column: "direction".to_owned(),
            found: cell.to_owned(),
            allowed: "`loading`, `unloading` or empty",
        }),
    }
}

/// Whether a cell has a value: as a number if both are, else letter by letter.
fn same(cell: &str, value: &str, decimal: Decimal) -> bool {
    match (decimal.number(cell), Decimal::Point.number(value)) {
        (Some(a), Some(b)) => (a - b).abs() <= 1e-9 * a.abs().max(b.abs()),
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
