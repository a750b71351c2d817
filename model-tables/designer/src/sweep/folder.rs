//! The folder of a sweep: a manifest, parts that appear whole or not at all, one run of a shard at a time.

use super::space::Space;
use model_tables::generate::TABLE_VERSION;
use output::{Refusal, files};
use parquet::file::reader::{FileReader as _, SerializedFileReader};
use std::fs::{self, File, TryLockError};
use std::io::{ErrorKind, Write as _};
use std::path::{Path, PathBuf};

/// Version of the rows: counts up when columns, their meaning or the way that points are drawn change.
const ROWS_VERSION: u32 = 1;
/// The manifest: readers of a folder of Parquet pass over names that begin with `_` or `.`.
const MANIFEST: &str = "_manifest.toml";
/// Digits of a part's number at least.
const DIGITS: usize = 5;

/// Which parts a run computes: those whose number leaves `index - 1` when divided by `of`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// 1 ..= `of`.
    pub index: u64,
    /// How many shards there are.
    pub of: u64,
}

impl Shard {
    /// The one shard of a sweep that is not split.
    pub const WHOLE: Self = Self { index: 1, of: 1 };

    /// Whether a part is this shard's.
    fn holds(self, part: u64) -> bool {
        part % self.of == self.index - 1
    }
}

/// A sweep's folder, held by this run.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    digits: usize,
    /// The system lets go of it when the program ends, in whatever way.
    _lock: File,
}

impl Folder {
    /// Opens the folder, or makes it; refuses that of another sweep, and one at which the same shard is at work.
    ///
    /// # Errors
    /// [`Refusal`]: the folder holds another sweep, or cannot be written.
    pub fn open(path: &Path, space: &Space, shard: Shard) -> Result<Self, Refusal> {
        let manifest = path.join(MANIFEST);
        let text = manifest_of(space);
        match fs::read_to_string(&manifest) {
            Ok(found) if found == text => {}
            Ok(found) => return Err(another(&manifest, &found, &text)),
            Err(_) => {
                files::expect_folder(path, &[MANIFEST])?;
                fs::create_dir_all(path).map_err(|error| cannot(path, &error))?;
                if let Some(part) = entries(path)?.iter().find(|name| name.starts_with("part-")) {
                    return Err(Refusal(format!(
                        "{}: there is {part} but no {MANIFEST}; choose another --out",
                        path.display()
                    )));
                }
                // By its shard's own name: what a kill leaves of it, the next run of that shard takes.
                let unready = path.join(unready_manifest(shard));
                File::create(&unready)
                    .and_then(|mut file| file.write_all(text.as_bytes()).and_then(|()| file.sync_all()))
                    .and_then(|()| fs::rename(&unready, &manifest))
                    .map_err(|error| {
                        let _ = fs::remove_file(&unready);
                        cannot(&manifest, &error)
                    })?;
            }
        }
        let name = format!(".shard-{}-of-{}.lock", shard.index, shard.of);
        let lock = path.join(name);
        let file = File::create(&lock).map_err(|error| cannot(&lock, &error))?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                return Err(Refusal(format!(
                    "{}: another run of --shard {}/{} is at work here; wait for it, or give this run another shard",
                    path.display(),
                    shard.index,
                    shard.of
                )));
            }
            Err(TryLockError::Error(error)) => return Err(cannot(&lock, &error)),
        }
        let digits = space.parts().saturating_sub(1).to_string().len().max(DIGITS);
        let folder = Self {
            path: path.to_owned(),
            digits,
            _lock: file,
        };
        folder.clear_away(space, shard)?;
        Ok(folder)
    }

    /// Removes what a run of this shard left half-written.
    fn clear_away(&self, space: &Space, shard: Shard) -> Result<(), Refusal> {
        for name in entries(&self.path)? {
            let part = name
                .strip_prefix(".part-")
                .and_then(|rest| rest.split('.').next())
                .and_then(|number| number.parse::<u64>().ok());
            let is_part = part.is_some_and(|part| part < space.parts() && shard.holds(part));
            if is_part || name == unready_manifest(shard) || files::is_probe(&name) {
                let path = self.path.join(name);
                match fs::remove_file(&path) {
                    // A probe of another shard, which has removed it itself.
                    Err(error) if error.kind() == ErrorKind::NotFound => {}
                    removed => removed.map_err(|error| cannot(&path, &error))?,
                }
            }
        }
        Ok(())
    }

    /// A part's file.
    fn part(&self, part: u64) -> PathBuf {
        self.path
            .join(format!("part-{part:0digits$}.parquet", digits = self.digits))
    }

    /// The shard's parts that are not there yet.
    ///
    /// # Errors
    /// [`Refusal`]: one that is there is damaged.
    pub fn left(&self, space: &Space, shard: Shard) -> Result<Vec<u64>, Refusal> {
        let mut left = Vec::new();
        for part in (0..space.parts()).filter(|&part| shard.holds(part)) {
            let path = self.part(part);
            if !path.exists() {
                left.push(part);
                continue;
            }
            let wanted = designs(space, part).count() as i64;
            let rows = File::open(&path)
                .map_err(|error| error.to_string())
                .and_then(|file| SerializedFileReader::new(file).map_err(|error| error.to_string()))
                .map(|reader| reader.metadata().file_metadata().num_rows());
            if rows.as_ref() != Ok(&wanted) {
                let found = rows.map_or_else(|error| error, |rows| format!("{rows} rows"));
                return Err(Refusal(format!(
                    "{}: found {found}, must hold {wanted} rows; delete it, and it is computed again",
                    path.display()
                )));
            }
        }
        Ok(left)
    }

    /// Moves a whole part in.
    ///
    /// # Errors
    /// [`Refusal`]: it cannot be written; nothing half-written is left.
    pub fn write(&self, part: u64, content: &[u8]) -> Result<(), Refusal> {
        files::write_durably(&self.part(part), content)
    }
}

/// The name of a manifest that a shard is about to move in.
fn unready_manifest(shard: Shard) -> String {
    format!(".shard-{}-of-{}.manifest", shard.index, shard.of)
}

/// Numbers of a part's designs.
pub fn designs(space: &Space, part: u64) -> std::ops::Range<u64> {
    let first = part * space.designs_per_part;
    first..(first + space.designs_per_part).min(space.sample.count)
}

/// What the folder of a sweep states: the space, and the version of program and rows.
pub fn manifest_of(space: &Space) -> String {
    format!(
        "# The sweep of this folder. A run of another sweep, or of another version, is refused here.\nspace_sha256 = \"{}\"\n\
         program = \"designer {}\"\ntables_version = {TABLE_VERSION}\nrows_version = {ROWS_VERSION}\ndesigns = {}\n\
         designs_per_part = {}\nparts = {}\n",
        space.hash(),
        env!("CARGO_PKG_VERSION"),
        space.sample.count,
        space.designs_per_part,
        space.parts(),
    )
}

/// The first line in which two manifests differ, as a refusal.
fn another(manifest: &Path, found: &str, wanted: &str) -> Refusal {
    let differs = found
        .lines()
        .zip(wanted.lines())
        .find(|(found, wanted)| found != wanted);
    let (found, wanted) = differs.unwrap_or(("another text", "this sweep's"));
    Refusal(format!(
        "{}: the folder holds another sweep: found {found}, this one has {wanted}; choose another --out, or the space and program \
         that began it",
        manifest.display()
    ))
}

/// Names of what is in a folder.
fn entries(path: &Path) -> Result<Vec<String>, Refusal> {
    let names = fs::read_dir(path).map_err(|error| cannot(path, &error))?;
    Ok(names
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .collect())
}

fn cannot(path: &Path, error: &dyn std::fmt::Display) -> Refusal {
    Refusal(format!("{}: {error}; choose another --out", path.display()))
}
