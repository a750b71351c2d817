//! Bench data: rows of indentation, force and pressure rise from a CSV file, checked before anything is fitted.

use std::fmt;

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

/// Why data cannot be used. `Display` is one line with the remedy.
#[derive(Clone, Debug, PartialEq)]
pub enum DataError {
    /// The file is no CSV file.
    Unreadable(String),
    /// A column is missing.
    Column {
        /// The column.
        missing: String,
        /// Those that are there.
        found: String,
    },
    /// Fewer than two of the three quantities have a column.
    TooFewColumns {
        /// The columns that are there.
        found: String,
    },
    /// A cell is no finite number, or no direction.
    Cell {
        /// Line of the file.
        line: u64,
        /// The column.
        column: String,
        /// The cell.
        found: String,
        /// What it has to be.
        allowed: &'static str,
    },
    /// Not enough rows are left.
    TooFewRows {
        /// How many there are.
        found: usize,
        /// How many it takes.
        needed: usize,
    },
    /// A quantity does not vary.
    Constant {
        /// The column.
        column: String,
        /// Its value.
        value: f64,
    },
    /// A quantity does not grow with another.
    NotGrowing {
        /// The column.
        column: String,
        /// The other.
        with: String,
        /// Rank correlation of the two.
        correlation: f64,
    },
}

/// Rows that a fit takes at least.
const LEAST_ROWS: usize = 3;
/// Rank correlation under which a quantity does not grow with another.
const LEAST_CORRELATION: f64 = 0.5;
/// A turn back by more than this part of the range of a trial changes the direction.
const TURN: f64 = 0.15;

const INDENTATION: &str = "indentation_mm";
const FORCE: &str = "force_n";
const PRESSURE: &str = "pressure_rise_kpa";

/// A column's name, its values and the factor to its unit.
type Column = (&'static str, fn(&DataRow) -> Option<f64>, f64);

impl Data {
    /// Reads CSV text; `name` is what reports call it.
    ///
    /// # Errors
    /// [`DataError`] for the first thing that is wrong.
    pub fn parse(text: &str, name: &str, choice: &DataChoice) -> Result<Self, DataError> {
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .from_reader(text.as_bytes());
        let unreadable = |error: csv::Error| {
            DataError::Unreadable(error.to_string().split_whitespace().collect::<Vec<_>>().join(" "))
        };
        let header: Vec<String> = reader
            .headers()
            .map_err(unreadable)?
            .iter()
            .map(|name| name.trim_start_matches('\u{feff}').to_owned())
            .collect();
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

impl fmt::Display for DataError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable(reason) => write!(f, "not a CSV file: {reason}"),
            Self::Column { missing, found } => {
                write!(f, "there is no column `{missing}`: there are {found}")
            }
            Self::TooFewColumns { found } => write!(
                f,
                "needs at least two of the columns {INDENTATION}, {FORCE}, {PRESSURE}: there are {found}; rename them, or \
                 name the pressure's with --pressure-column"
            ),
            Self::Cell {
                line,
                column,
                found,
                allowed,
            } => write!(f, "line {line}: `{column}` is `{found}`: must be {allowed}"),
            Self::TooFewRows { found, needed } => write!(
                f,
                "{found} rows have two of the three quantities, and a fit needs at least {needed}: measure more, or \
                 choose other rows"
            ),
            Self::Constant { column, value } => write!(
                f,
                "`{column}` is {value} in every row, which shows nothing: press to several depths"
            ),
            Self::NotGrowing {
                column,
                with,
                correlation,
            } => write!(
                f,
                "`{column}` does not grow with `{with}` (rank correlation {correlation:.2}): check signs, units and \
                 columns"
            ),
        }
    }
}

impl core::error::Error for DataError {}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = "trial,indentation_mm,force_n,pressure_rise_kpa\n\
        a,0.1,0.01,0.1\na,0.5,0.1,0.6\na,1.0,0.3,1.5\na,0.5,0.08,0.5\na,0.1,0.01,0.1\n\
        b,1.0,0.31,1.4\nb,,0.1,0.6\nb,0.2,,\n";

    fn parse(text: &str) -> Result<Data, DataError> {
        Data::parse(text, "data.csv", &DataChoice::default())
    }

    #[test]
    fn reads_rows_trials_and_directions() {
        use Direction::{Loading, Unloading};
        let data = parse(GOOD).expect("good data");
        assert_eq!((data.rows.len(), data.incomplete), (7, 1));
        assert_eq!(data.trials, ["a", "b"]);
        assert_eq!(data.rows[6].indentation, None);
        assert!((data.rows[0].rise.expect("given") - 100.0).abs() < 1e-9);
        let of_a: Vec<Direction> = data.rows[..5].iter().map(|row| row.direction).collect();
        assert_eq!(of_a, [Loading, Loading, Loading, Unloading, Unloading]);
    }

    #[test]
    fn rows_in_no_order_have_no_direction() {
        let depths = [0.5, 2.0, 0.1, 1.5, 0.2, 1.9, 0.3, 1.2];
        assert!(zigzag(&depths).iter().all(|&d| d == Direction::Unknown));
        // Noise is no turn.
        let noisy = [0.0, 0.4, 0.38, 0.8, 1.2, 1.15, 1.6];
        assert!(zigzag(&noisy).iter().all(|&d| d == Direction::Loading));
    }

    #[test]
    fn chooses_rows_and_the_pressure_column() {
        let text = "position_mm,indentation_mm,p\n10,0.1,1\n50.0,0.2,2\n50,0.4,4\n50,0.6,6\n";
        let choice = DataChoice {
            pressure_column: "p".to_owned(),
            only: vec![("position_mm".to_owned(), "50".to_owned())],
            direction: None,
        };
        let data = Data::parse(text, "d", &choice).expect("good data");
        assert_eq!(data.rows.len(), 3);
        assert!((data.rows[0].rise.expect("given") - 2000.0).abs() < 1e-9);
    }

    #[test]
    fn nonsense_is_refused_with_its_reason() {
        for (text, reason) in [
            ("a,b\n1,2\n", "needs at least two of the columns"),
            ("indentation_mm,force_n\n0.1,x\n", "line 2: `force_n` is `x`"),
            ("indentation_mm,force_n\n0.1,inf\n", "must be a finite number"),
            (
                "indentation_mm,force_n\n0.1,1\n0.2,2\n",
                "2 rows have two of the three",
            ),
            (
                "indentation_mm,force_n\n0.1,1\n0.1,2\n0.1,3\n",
                "`indentation_mm` is 0.1 in every row",
            ),
            (
                "indentation_mm,force_n\n0.1,-1\n0.2,-2\n0.3,-3\n",
                "`force_n` does not grow with `indentation_mm` (rank correlation -1.00)",
            ),
            ("indentation_mm,force_n\n0.1,1\n0.2\n", "not a CSV file"),
            (
                "indentation_mm,force_n,direction\n0.1,1,sideways\n",
                "`direction` is `sideways`",
            ),
        ] {
            let error = parse(text).expect_err(text).to_string();
            assert!(error.contains(reason), "{error}");
            assert_eq!(error.lines().count(), 1);
        }
    }
}
