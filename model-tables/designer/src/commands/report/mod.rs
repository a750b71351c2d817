//! `designer report`: everything about a design on one page of HTML that needs no network.

mod charts;
mod cost;
mod feedback;
mod findings;
mod in_time;
mod inputs;
mod labels;
mod page;
mod shapes;

use output::files;
use output::progress::Progress;
use output::rows::{Cell, Rows};
use output::{CommandAnswer, Refusal};
use std::path::PathBuf;

const COLUMNS: &[&str] = &["file", "size_bytes"];

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The design file
    design: PathBuf,
    /// The folder to write to; made if it is not there
    #[arg(long, value_name = "DIR", default_value = "target/report")]
    out: PathBuf,
}

pub(super) fn run(arguments: &Arguments) -> Result<CommandAnswer, Refusal> {
    files::keep(&arguments.design);
    files::expect_folder(&arguments.out, &[])?;
    let progress = Progress::new("report");
    let found = findings::gather(&arguments.design, &progress);
    progress.finish();
    let found = found?;
    let name = format!("{}.html", found.file.name);
    let text = page::html(&found, &arguments.design);
    let size = text.len();
    files::write_all(&arguments.out, &[(&name, text.into_bytes())])?;
    let mut rows = Rows::new(COLUMNS);
    rows.push(vec![
        Cell::Text(arguments.out.join(name).display().to_string()),
        Cell::Count(size),
    ]);
    Ok(CommandAnswer {
        rows,
        notes: found.note.into_iter().collect(),
    })
}
