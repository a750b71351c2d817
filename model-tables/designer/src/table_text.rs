//! Tables of numbers as text, as bench programs write them: bytes -> [`encoding`] -> [`layout`] (separator, header, row of
//! units) -> cells -> [`decimal`] (numbers).

mod decimal;
mod encoding;
mod layout;

pub(crate) use decimal::Decimal;
pub(crate) use layout::{Sheet, SheetRow};

/// A message of several lines as one.
pub(crate) fn one_line(message: &str) -> String {
    message.split_whitespace().collect::<Vec<_>>().join(" ")
}
