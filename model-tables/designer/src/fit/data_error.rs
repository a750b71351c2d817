//! Why data cannot be used, in words.

use std::fmt;

// Columns of the file.
pub(super) const INDENTATION: &str = "indentation_mm";
pub(super) const FORCE: &str = "force_n";
pub(super) const PRESSURE: &str = "pressure_rise_kpa";

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
