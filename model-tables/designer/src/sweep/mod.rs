//! Sweeps: many designs of one space, to Parquet.
//!
//! [`space`] (what is computed, and what of a design varies: [`vary`]) -> [`sample`] (points, each a function of its number; [`sobol`] among
//! them) -> `evaluate` (a design's row, on every core) -> `columns` (rows to Parquet) -> [`folder`] (parts that appear
//! whole, a manifest, shards).
//!
//! A part holds a fixed number of designs and is written at once. What was there when a run was killed stays, what was
//! not is computed again, and both are the same bytes as those of an unbroken run.

mod columns;
mod evaluate;
pub mod folder;
pub mod inline;
pub mod sample;
pub mod sobol;
pub mod space;
pub mod vary;

use columns::{Columns, Datum};
use folder::{Folder, Shard};
use output::Refusal;
use output::progress::Ticks;
use rayon::prelude::*;
use space::Space;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// How often progress is told.
const TELL_EVERY: Duration = Duration::from_secs(2);

/// What a run of a sweep did.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Swept {
    /// Designs of this shard.
    pub designs: u64,
    /// Of those, what an earlier run had left ready.
    pub before: u64,
    /// Designs computed by this run.
    pub computed: u64,
    /// Of those, refused: rows with a reason.
    pub refused: u64,
    /// The line that refused the first of them; `None` where none was refused.
    pub first_reason: Option<String>,
    /// Files of this shard.
    pub parts: u64,
}

/// Computes the parts of a shard that are not there yet.
///
/// # Errors
/// [`Refusal`]: the folder holds another sweep, or cannot be written. Parts that are there stay.
pub fn run(space: &Space, out: &Path, shard: Shard) -> Result<Swept, Refusal> {
    let columns = columns(space)?;
    let folder = Folder::open(out, space, shard)?;
    let left = folder.left(space, shard)?;
    let parts = (space.parts() + shard.of - shard.index) / shard.of;
    let of_shard: u64 = (0..parts)
        .map(|place| folder::designs(space, place * shard.of + shard.index - 1))
        .map(|designs| designs.end - designs.start)
        .sum();
    let of_this: u64 = left
        .iter()
        .map(|&part| folder::designs(space, part))
        .map(|designs| designs.end - designs.start)
        .sum();
    let mut swept = Swept {
        designs: of_shard,
        before: of_shard - of_this,
        parts,
        ..Swept::default()
    };
    let done = Arc::new(AtomicU64::new(0));
    eprintln!("progress: {} of {of_shard} designs are there", swept.before);
    let (begun, counted) = (Instant::now(), done.clone());
    let _ticks = Ticks::every(TELL_EVERY, move || tell(&counted, of_this, begun));
    for part in left {
        let made = part_of(space, &columns, part, &done)?;
        swept.computed += made.designs;
        swept.refused += made.refused;
        if swept.first_reason.is_none() {
            swept.first_reason = made.first_reason;
        }
        folder.write(part, &made.content)?;
    }
    Ok(swept)
}

/// A part of a sweep.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SweptPart {
    /// The bytes of its file.
    pub content: Vec<u8>,
    /// Its designs.
    pub designs: u64,
    /// Of those, refused: rows with a reason.
    pub refused: u64,
    /// The line that refused the first of them; `None` where none was refused.
    pub first_reason: Option<String>,
}

/// Computes one part, as [`run`] does, and gives its bytes in place of writing them.
///
/// # Errors
/// [`Refusal`]: there is no such part.
pub fn part(space: &Space, part: u64) -> Result<SweptPart, Refusal> {
    if part >= space.parts() {
        return Err(Refusal(format!(
            "there is no part {part}: the sweep has parts 0 to {}",
            space.parts() - 1
        )));
    }
    part_of(space, &columns(space)?, part, &AtomicU64::new(0))
}

fn columns(space: &Space) -> Result<Columns, Refusal> {
    Columns::of(space, &[("fingertip.space_sha256", space.hash().as_str())]).map_err(Refusal::of)
}

/// Solves the designs of a part on the threads of the pool; `done` counts them.
fn part_of(space: &Space, columns: &Columns, part: u64, done: &AtomicU64) -> Result<SweptPart, Refusal> {
    let numbers: Vec<u64> = folder::designs(space, part).collect();
    let rows: Vec<(Vec<Datum>, Option<String>)> = numbers
        .into_par_iter()
        .with_max_len(1)
        .map(|number| {
            let row = evaluate::row(space, number);
            done.fetch_add(1, Ordering::Relaxed);
            row
        })
        .collect();
    let (designs, refused) = (
        rows.len(),
        rows.iter().filter(|(_, reason)| reason.is_some()).count(),
    );
    let first_reason = rows.iter().find_map(|(_, reason)| reason.clone());
    let rows: Vec<Vec<Datum>> = rows.into_iter().map(|(row, _)| row).collect();
    Ok(SweptPart {
        content: columns.encode(&rows).map_err(Refusal::of)?,
        designs: designs as u64,
        refused: refused as u64,
        first_reason,
    })
}

/// One line of progress.
fn tell(done: &AtomicU64, of: u64, begun: Instant) -> String {
    let (done, seconds) = (done.load(Ordering::Relaxed), begun.elapsed().as_secs_f64());
    let rate = done as f64 / seconds;
    let left = if done == 0 {
        "?".to_owned()
    } else {
        format!("{:.0}", (of - done.min(of)) as f64 / rate)
    };
    format!("{done} of {of} designs, {rate:.1} a second, {left} s left")
}
