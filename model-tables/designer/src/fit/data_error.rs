//! Why data cannot be used, in words.

use super::heading::Measured;
use std::fmt;

/// Why data cannot be used. `Display` is one line with the remedy.
#[derive(Clone, Debug, PartialEq)]
pub enum DataError {
    /// The file is no table of numbers; the reason.
    Unreadable(String),
    /// The file names no columns.
    NoHeader {
        /// How many columns there are.
        columns: usize,
    },
    /// A name that is none of the contract's.
    UnknownName {
        /// The name.
        name: String,
    },
    /// A column that is all but named like one that is missing.
    NearMiss {
        /// The column.
        found: String,
        /// The name that it resembles.
        meant: &'static str,
    },
    /// Absolute pressures, where a rise is needed.
    Absolute {
        /// The column.
        found: String,
    },
    /// Pressures that begin near that of the air.
    BeginsAtAir {
        /// The rise of the lightest press, pascals.
        least: f64,
    },
    /// Two columns of one quantity, which differ.
    Several {
        /// The name or quantity.
        what: String,
        /// The two.
        columns: [String; 2],
    },
    /// A unit is missing, or is none of the quantity.
    Unit {
        /// The column.
        column: String,
        /// The unit.
        unit: Option<String>,
        /// What the column holds.
        quantity: Measured,
    },
    /// Heading and row of units contradict each other.
    TwoUnits {
        /// The column.
        column: String,
        /// The unit of the heading, and of the row of units.
        units: [String; 2],
    },
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
    /// No row is as it was asked for.
    NoneChosen {
        /// The option that asks.
        choice: String,
        /// Rows that there are.
        rows: usize,
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

/// Rank correlation from which on, with a minus, a quantity falls with another.
const FALLS: f64 = 0.9;

impl fmt::Display for DataError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable(reason) => f.write_str(reason),
            Self::NoHeader { columns } => write!(
                f,
                "the first line is all numbers, so the {columns} columns have no names: add a header, or name them by number, \
                 as in --columns indentation_mm=1,force_n=2"
            ),
            Self::UnknownName { name } => write!(
                f,
                "--columns {name}=...: `{name}` is no quantity: name indentation_mm, force_n, pressure_rise_kpa, trial or \
                 direction"
            ),
            Self::NearMiss { found, meant } => write!(
                f,
                "is the column `{found}` meant to be `{meant}`? Rename it, or say --columns {meant}={found}"
            ),
            Self::Absolute { found } => write!(
                f,
                "`{found}` is an absolute pressure, and a fit needs the rise over the untouched tip: subtract the untouched \
                 reading, and name the column pressure_rise_kpa"
            ),
            Self::BeginsAtAir { least } => write!(
                f,
                "the pressure rise is {:.1} kPa at the lightest press, as much as the pressure of the air, so it is taken for an \
                 absolute pressure: subtract the untouched reading",
                1e-3 * least
            ),
            Self::Several {
                what,
                columns: [a, b],
            } => write!(
                f,
                "`{what}` can be {a}, or {b}, and they differ: leave one out, or name one with --columns by its number"
            ),
            Self::Unit {
                column,
                unit: None,
                quantity,
            } => write!(
                f,
                "the column `{column}` has no unit: write it into the header, or say --columns {}={column}",
                quantity.column()
            ),
            Self::Unit {
                column,
                unit: Some(unit),
                quantity,
            } => write!(
                f,
                "`{unit}` of the column `{column}` is no unit of the {quantity}: write one of {}",
                quantity.unit_names()
            ),
            Self::TwoUnits {
                column,
                units: [a, b],
            } => write!(
                f,
                "the heading `{column}` says {a} and the row of units {b}: correct one of them"
            ),
            Self::Column { missing, found } => {
                write!(f, "there is no column `{missing}`: there are {found}")
            }
            Self::TooFewColumns { found } => write!(
                f,
                "needs at least two of the columns indentation_mm, force_n, pressure_rise_kpa: there are {found}; rename them, \
                 or name them as in --columns force_n=Fz"
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
            Self::NoneChosen { choice, rows } => write!(
                f,
                "none of the {rows} rows is what {choice} asks for: leave the option out, or choose other rows"
            ),
            Self::Constant { column, value } => write!(
                f,
                "`{column}` is {value} in every row, which shows nothing: press to several depths"
            ),
            Self::NotGrowing {
                column,
                with,
                correlation,
            } => refuse_not_growing(f, column, with, *correlation),
        }
    }
}

/// That a quantity does not grow with another one, or falls.
fn refuse_not_growing(f: &mut fmt::Formatter<'_>, column: &str, with: &str, correlation: f64) -> fmt::Result {
    let (how, remedy) = if correlation < -FALLS {
        (
            "falls as it should grow with",
            "turn the sign of one of the two, or count the indentation from first touch on",
        )
    } else {
        ("does not grow with", "check signs, units and columns")
    };
    write!(
        f,
        "`{column}` {how} `{with}` (rank correlation {correlation:.2}): {remedy}"
    )
}

impl core::error::Error for DataError {}
