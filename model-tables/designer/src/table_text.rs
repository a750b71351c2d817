//! Tables of numbers as text, as bench programs write them: bytes -> [`encoding`] -> [`layout`] (separator, header, row of
//! units; [`header`] finds them) -> cells -> [`decimal`] (numbers).

mod decimal;
mod encoding;
mod header;
mod layout;

pub(crate) use decimal::Decimal;
pub(crate) use layout::{Sheet, SheetRow};

/// A message of several lines as one.
pub(crate) fn one_line(message: &str) -> String {
    message.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Cells that stand for a missing number, in lower case.
const MISSING: [&str; 17] = [
    "",
    "nan",
    "+nan",
    "-nan",
    "nan(ind)",
    "-nan(ind)",
    "1.#qnan",
    "-1.#qnan",
    "1.#ind",
    "-1.#ind",
    "na",
    "n/a",
    "null",
    "none",
    "nil",
    "-",
    "--",
];

/// Whether a cell stands for a missing number.
pub(crate) fn is_missing(cell: &str) -> bool {
    MISSING.contains(&cell.to_lowercase().as_str())
}
