//! `designer report`: everything about a design on one page of HTML that needs no network.

mod charts;
mod cost;
mod feedback;
mod figures;
mod findings;
mod in_time;
mod inputs;
mod labels;
mod logarithmic;
mod page;
mod shapes;
mod tips;

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
    /// Write the figures too, each as SVG, and the numbers behind them as CSV
    #[arg(long)]
    figures: bool,
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
    // The page last: it stands for the whole set.
    let mut contents = if arguments.figures {
        figures::files(&found)?
    } else {
        Vec::new()
    };
    contents.push((name, text.into_bytes()));
    files::write_all(&arguments.out, &contents)?;
    let mut rows = Rows::new(COLUMNS);
    for (name, content) in contents.iter().rev() {
        rows.push(vec![
            Cell::Text(arguments.out.join(name).display().to_string()),
            Cell::Count(content.len()),
        ]);
    }
    Ok(CommandAnswer {
        rows,
        notes: found.note.into_iter().collect(),
    })
}
