//! What the commands give: rows, charts, files, or one line that says why not.
//!
//! [`rows`] (columns of an answer, printed as table, CSV or JSON), [`drawing`] and [`linear`] (charts as SVG), [`files`]
//! (whole or not at all), [`progress`] (a bar for work that takes a while).
#![forbid(unsafe_code)]

pub mod drawing;
pub mod files;
pub mod linear;
pub mod progress;
pub mod rows;

use rows::Rows;
use std::fmt::Display;
use std::path::Path;

/// What a subcommand gives.
#[derive(Clone, Debug)]
pub struct CommandAnswer {
    /// For standard output.
    pub rows: Rows,
    /// Remarks for a person, one line each, on standard error.
    pub notes: Vec<String>,
}

/// One line that says what is wrong and what to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal(pub String);

impl Refusal {
    /// An error that says everything itself.
    pub fn of(error: impl Display) -> Self {
        Self(error.to_string())
    }

    /// About a file.
    pub fn about(file: &Path, reason: &dyn Display) -> Self {
        Self(format!("{}: {reason}", file.display()))
    }
}
