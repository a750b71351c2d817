//! `designer sweep`: many designs to Parquet.

use crate::sweep::folder::Shard;
use crate::sweep::space::Space;
use crate::sweep::{Swept, run as compute};
use output::rows::{Cell, Rows};
use output::{CommandAnswer, Refusal};
use std::path::PathBuf;

const COLUMNS: &[&str] = &["designs", "ready_before", "computed", "refused", "parts"];

pub(super) const HELP: &str = "Example:\n  cargo designer sweep model-tables/spaces/domes.toml --out target/domes\n\n\
                               After an interruption, run the same command again to continue. model-tables/SWEEP.md has the format.";

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The file of the sweep: base design, varied keys, and computed columns
    space: PathBuf,
    /// Folder for the parts; created if it does not exist, continued if it belongs to this sweep
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Compute only every N-th part, from the I-th on (1 ..= N); shards may share a folder
    #[arg(long, value_name = "I/N", value_parser = shard)]
    shard: Option<Shard>,
}

fn shard(text: &str) -> Result<Shard, String> {
    text.split_once('/')
        .and_then(|(index, of)| {
            Some(Shard {
                index: index.parse().ok()?,
                of: of.parse().ok()?,
            })
        })
        .filter(|shard| (1..=shard.of).contains(&shard.index))
        .ok_or_else(|| "must be I/N with 1 <= I <= N, as 2/8".to_owned())
}

pub(super) fn run(arguments: &Arguments) -> Result<CommandAnswer, Refusal> {
    let space = Space::read(&arguments.space).map_err(Refusal::of)?;
    let Swept {
        designs,
        before,
        computed,
        refused,
        first_reason,
        parts,
    } = compute(&space, &arguments.out, arguments.shard.unwrap_or(Shard::WHOLE))?;
    let mut rows = Rows::new(COLUMNS);
    let counts = [designs, before, computed, refused, parts];
    rows.push(counts.map(|count| Cell::Count(count as usize)).to_vec());
    let notes = first_reason
        .map(|reason| format!("{refused} of {computed} designs are refused, the first as: {reason}"));
    Ok(CommandAnswer {
        rows,
        notes: notes.into_iter().collect(),
    })
}
