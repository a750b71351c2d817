//! Numbers and tables in Markdown.

use output::rows::{plain, significant};
use std::fmt::Write as _;

/// Digits of a number.
const DIGITS: i32 = 4;
/// Digits of a ratio.
const RATIO_DIGITS: i32 = 3;

pub(super) fn number(value: f64) -> String {
    significant(value, DIGITS)
}

pub(super) fn ratio(value: f64) -> String {
    significant(value, RATIO_DIGITS)
}

/// A number as it was published: no digits added.
pub(super) fn published(value: f64) -> String {
    plain(value, DIGITS)
}

pub(super) fn table(header: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let mut text = format!("| {} |\n|{}\n", header.join(" | "), "---|".repeat(header.len()));
    for row in rows {
        let _ = writeln!(text, "| {} |", row.join(" | "));
    }
    text
}
