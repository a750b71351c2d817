//! The reasons why loaded tables are refused.

use core::fmt;

/// Reasons for refusing tables.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum TablesError {
    /// A field of the layout is out of its range.
    Layout(&'static str),
    /// The number of words does not fit the segments of the layout.
    Words {
        /// Words needed.
        needed: usize,
        /// Words found.
        found: usize,
    },
    /// The outputs at input zero are not both zero.
    Zero,
    /// An output falls after this input, counts.
    Falls(i32),
    /// Up to this input, counts, an output grows so little that the allowed work cannot show whether it falls.
    Flat(i32),
}

impl fmt::Display for TablesError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Layout(field) => write!(f, "the tables' {field} is out of its range"),
            Self::Words { needed, found } => {
                write!(
                    f,
                    "the tables have {found} words where their layout needs {needed}"
                )
            }
            Self::Zero => f.write_str("the tables do not read zero at zero"),
            Self::Falls(count) => write!(f, "an output of the tables falls after input {count}"),
            Self::Flat(count) => write!(f, "an output of the tables hardly grows up to input {count}"),
        }
    }
}

impl core::error::Error for TablesError {}
