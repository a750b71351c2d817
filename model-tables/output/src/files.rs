//! Files that appear whole or not at all, also when the program is interrupted.

use crate::Refusal;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Exit status after an interrupt, as shells have it: 128 and the number of the signal.
const INTERRUPTED: i32 = 130;

/// Files on their way.
static PARTIAL: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Has an interrupt remove what is on its way and end the program.
pub fn clear_away_on_interrupt() {
    let handler = || {
        // Kept to the end: no file can begin after this.
        let mut partial = PARTIAL.lock().unwrap_or_else(PoisonError::into_inner);
        remove(&mut partial);
        std::process::exit(INTERRUPTED);
    };
    if let Err(error) = ctrlc::set_handler(handler) {
        eprintln!("note: an interrupt may leave temporary files behind ({error})");
    }
}

fn remove(partial: &mut Vec<PathBuf>) {
    for path in partial.drain(..) {
        // What was moved or never written is not there any more.
        let _ = fs::remove_file(path);
    }
}

/// Writes one file, as [`write_all`] does.
///
/// # Errors
/// [`Refusal`] with the file and the reason.
pub fn write_one(path: &Path, content: Vec<u8>) -> Result<(), Refusal> {
    let (folder, name) = place(path)?;
    write_all(folder, &[(name, content)])
}

/// Refuses a file that could not be written, before the work for it starts.
///
/// # Errors
/// [`Refusal`] with the file or folder and the reason.
pub fn expect_room(path: &Path) -> Result<(), Refusal> {
    let (folder, name) = place(path)?;
    let probe = format!(".{name}.{}", std::process::id());
    write_all(folder, &[(&probe, Vec::new())])?;
    remove(&mut vec![folder.join(probe)]);
    Ok(())
}

fn place(path: &Path) -> Result<(&Path, &str), Refusal> {
    let name = path
        .file_name()
        .and_then(std::ffi::OsStr::to_str)
        .ok_or_else(|| {
            Refusal(format!(
                "{} does not name a file; choose another path",
                path.display()
            ))
        })?;
    match path.parent() {
        Some(folder) if folder != Path::new("") => Ok((folder, name)),
        _ => Ok((Path::new("."), name)),
    }
}

/// Writes every file beside its place first, then moves them all in; on failure removes what it wrote.
///
/// # Errors
/// [`Refusal`] with the file and the reason; nothing half-written is left.
pub fn write_all(folder: &Path, contents: &[(&str, Vec<u8>)]) -> Result<(), Refusal> {
    let cannot = |path: &Path, error: std::io::Error| {
        Refusal(format!(
            "{} cannot be written: {error}; choose another --out",
            path.display()
        ))
    };
    fs::create_dir_all(folder).map_err(|error| cannot(folder, error))?;
    let places: Vec<(PathBuf, PathBuf)> = contents
        .iter()
        .map(|(name, _)| {
            let temporary = format!(".{name}.{}", std::process::id());
            (folder.join(temporary), folder.join(name))
        })
        .collect();
    PARTIAL
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .extend(places.iter().map(|(temporary, _)| temporary.clone()));
    let written = places
        .iter()
        .zip(contents)
        .try_for_each(|((temporary, _), (_, content))| {
            fs::write(temporary, content).map_err(|error| cannot(temporary, error))
        })
        .and_then(|()| {
            places.iter().try_for_each(|(temporary, place)| {
                fs::rename(temporary, place).map_err(|error| cannot(place, error))
            })
        });
    remove(&mut PARTIAL.lock().unwrap_or_else(PoisonError::into_inner));
    written
}
