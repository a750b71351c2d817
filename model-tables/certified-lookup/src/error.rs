//! The reasons why loaded tables are refused.

use core::fmt;

/// Why tables are not used.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum TablesError {
    /// A field of the layout is not in its range.
    Layout(&'static str),
    /// The words are not those of the segments that the layout needs.
    Words {
        /// Words needed.
        needed: usize,
        /// Words found.
        found: usize,
    },
    /// An input of zero does not read as two zeros.
    Zero,
    /// An output falls after this input, counts.
    Falls(i32),
    /// An output grows so little up to this input, counts, that the work allowed does not show whether it ever falls.
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
