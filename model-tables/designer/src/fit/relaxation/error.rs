//! Why a record gives no series, in words.

use crate::fit::data_error::DataError;
use output::rows::significant;
use std::fmt;

/// Why a record gives no series. `Display` is one line with the remedy.
#[derive(Clone, Debug, PartialEq)]
pub enum HoldError {
    /// The file is no table of numbers, or has no rows; the reason.
    Unreadable(String),
    /// Its columns.
    Columns(DataError),
    /// There is no indentation.
    NoIndentation {
        /// The columns that are there.
        found: String,
    },
    /// A cell is not what it has to be.
    Cell {
        /// Line of the file.
        line: u64,
        /// The column.
        column: String,
        /// The cell.
        found: String,
        /// What it has to be.
        allowed: String,
    },
    /// A trial does not begin untouched.
    NotUntouched {
        /// Which trial.
        title: String,
        /// Its first line.
        line: u64,
        /// Indentation there, metres.
        indentation: f64,
    },
    /// The untouched tip reads something.
    NotZero {
        /// Which trial.
        title: String,
        /// The column.
        column: &'static str,
        /// Its mean over the untouched rows, in its unit.
        mean: f64,
    },
    /// A trial is not held long enough.
    NoHold {
        /// Which trial.
        title: String,
        /// Its depth, metres.
        depth: f64,
        /// Length of the press, seconds.
        pressed: f64,
        /// Length of the hold, seconds.
        held: f64,
        /// Its rows.
        rows: usize,
    },
    /// Deeper than the design's press.
    TooDeep {
        /// Which trial.
        title: String,
        /// Its depth, metres.
        depth: f64,
        /// Why there is no state.
        reason: String,
    },
    /// The hold ends below what the settled wall reads.
    BelowSettled {
        /// Which trial.
        title: String,
        /// Name and unit of what was measured.
        quantity: &'static str,
        /// Measured over settled.
        ratio: f64,
    },
    /// The model has no answer.
    Model(String),
    /// Nothing relaxes.
    Elastic,
    /// Fewer readings than a term and its noise take.
    TooFew(usize),
}

impl From<DataError> for HoldError {
    fn from(error: DataError) -> Self {
        Self::Columns(error)
    }
}

impl fmt::Display for HoldError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable(reason) | Self::Model(reason) => f.write_str(reason),
            Self::Columns(error) => error.fmt(f),
            Self::NoIndentation { found } => write!(
                f,
                "--relaxation needs the column indentation_mm beside pressure_rise_kpa or force_n: there are {found}"
            ),
            Self::Cell {
                line,
                column,
                found,
                allowed,
            } => write!(f, "line {line}: `{column}` is `{found}`: must be {allowed}"),
            Self::NotUntouched {
                title,
                line,
                indentation,
            } => write!(
                f,
                "line {line}: {title} begins at an indentation of {} mm: its first row has to be the untouched tip, at 0 or less, and a \
                 deeper one has to follow",
                significant(1e3 * indentation, 4)
            ),
            Self::NotZero { title, column, mean } => write!(
                f,
                "{title}: `{column}` is {} on average while the tip is untouched: subtract that from the column",
                significant(*mean, 4)
            ),
            Self::NoHold {
                title,
                depth,
                pressed,
                held,
                rows,
            } => write!(
                f,
                "{title} presses to {} mm in {} s and holds for {} s ({rows} rows): hold at least twice as long as the press takes, with \
                 10 rows or more; a minute is better",
                significant(1e3 * depth, 4),
                significant(*pressed, 3),
                significant(*held, 3)
            ),
            Self::TooDeep { title, depth, reason } => write!(
                f,
                "{title} is {} mm deep, and the design has no state there: {reason}",
                significant(1e3 * depth, 4)
            ),
            Self::BelowSettled {
                title,
                quantity,
                ratio,
            } => write!(
                f,
                "{title}: the {quantity} at the end of the hold is {} times that of the settled wall, and a wall that relaxes stays above \
                 it: the constants of [material] are not the relaxed ones; fit them too, with --free-modulus",
                significant(*ratio, 3)
            ),
            Self::Elastic => f.write_str(
                "nothing relaxes in it: the readings of the hold stay at those of the settled wall; hold longer, read faster, or leave \
                 [material.relaxation] out",
            ),
            Self::TooFew(count) => write!(
                f,
                "{count} readings cannot tell a series: log the press and the hold, at 20 rows or more"
            ),
        }
    }
}

impl core::error::Error for HoldError {}
