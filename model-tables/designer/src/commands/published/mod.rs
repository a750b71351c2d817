//! `designer published`: the source paper's numbers beside what its stated inputs give, and the page about them.

mod actuator;
mod lifted;
mod markdown;
mod page;
pub(super) mod paper;
pub(super) mod quoted;
mod readings;
pub(super) mod solid;

use actuator::OfPaper;
use model_tables::design_file::DesignFile;
use output::files;
use output::rows::{Cell, Rows};
use output::{CommandAnswer, Refusal};
use paper::Paper;
use solid::Solid;
use std::path::PathBuf;

const COLUMNS: &[&str] = &["quantity", "published", "here", "ratio"];

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The page to write (Markdown)
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

pub(super) fn run(arguments: &Arguments) -> Result<CommandAnswer, Refusal> {
    if let Some(out) = &arguments.out {
        files::expect_room(out)?;
    }
    let paper = Paper::solve()?;
    let mut notes = Vec::new();
    if let Some(out) = &arguments.out {
        let printed = shipped(
            "index-fingertip-elastic",
            include_str!("../../../../designs/index-fingertip-elastic.toml"),
        )?;
        let text = page::markdown(&paper, &Solid::solve()?, &OfPaper::solve(&printed)?)?;
        files::write_one(out, text.into_bytes())?;
        notes.push(format!("wrote {}", out.display()));
    }
    let mut rows = Rows::new(COLUMNS);
    for row in &paper.rows {
        rows.push(vec![
            Cell::word(row.quantity),
            Cell::Number(row.published),
            Cell::Number(row.here),
            Cell::Number(row.here / row.published),
        ]);
    }
    Ok(CommandAnswer { rows, notes })
}

/// A shipped design; its text is part of the program.
fn shipped(name: &str, text: &str) -> Result<DesignFile, Refusal> {
    DesignFile::parse(text, name).map_err(Refusal::of)
}
