//! `designer chart --tables`: what the tables cost over designs and accuracies, as a page and CSV.

mod fronts;
mod page;

use super::super::Refusal;

/// What is written: names and contents.
pub(super) fn contents() -> Result<Vec<(&'static str, Vec<u8>)>, Refusal> {
    eprintln!("tables of nine designs at {} accuracies", fronts::PERCENTS.len());
    let fronts = fronts::measure(&fronts::PERCENTS)?;
    Ok(vec![
        ("README.md", page::markdown(&fronts).into_bytes()),
        ("designs.csv", fronts::csv(&fronts).into_bytes()),
    ])
}
