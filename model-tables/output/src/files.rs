//! Files that appear whole or not at all, also when the program is interrupted.

use crate::Refusal;
use std::fs::{self, File};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Exit status after an interrupt, as shells have it: 128 and the number of the signal.
const INTERRUPTED: i32 = 130;

/// Files on their way.
static PARTIAL: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());
/// Files that were read, and are not to be written over.
static KEPT: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Keeps a file that was read: nothing is written over it from now on.
pub fn keep(path: &Path) {
    if let Ok(path) = path.canonicalize() {
        KEPT.lock().unwrap_or_else(PoisonError::into_inner).push(path);
    }
}

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

/// Ends what one writer had on its way; what others have on theirs stays.
fn clear(own: &[PathBuf]) {
    let mut partial = PARTIAL.lock().unwrap_or_else(PoisonError::into_inner);
    partial.retain(|path| !own.contains(path));
    remove(&mut own.to_vec());
}

/// Writes one file, as [`write_all`] does.
///
/// # Errors
/// [`Refusal`] with the file and the reason.
pub fn write_one(path: &Path, content: Vec<u8>) -> Result<(), Refusal> {
    let (folder, name) = place(path)?;
    write_all(folder, &[(name, content)])
}

/// Writes one file so that it is there whole or not at all also after the machine loses its power: beside its place, to the
/// disc, then moved in.
///
/// # Errors
/// [`Refusal`] with the file and the reason; nothing half-written is left.
pub fn write_durably(path: &Path, content: &[u8]) -> Result<(), Refusal> {
    let (folder, name) = place(path)?;
    expect_replaceable(path)?;
    let temporary = folder.join(format!(".{name}.{}", std::process::id()));
    PARTIAL
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .push(temporary.clone());
    let written = File::create(&temporary)
        .and_then(|mut file| file.write_all(content).and_then(|()| file.sync_all()))
        .and_then(|()| fs::rename(&temporary, path))
        .and_then(|()| sync_folder(folder))
        .map_err(|error| cannot(path, &error));
    clear(&[temporary]);
    written
}

/// Has the disc know the names of a folder, where the system lets a folder be opened.
#[cfg(unix)]
fn sync_folder(folder: &Path) -> std::io::Result<()> {
    File::open(folder)?.sync_all()
}

#[cfg(not(unix))]
fn sync_folder(_: &Path) -> std::io::Result<()> {
    Ok(())
}

/// Refuses a file that could not be written, before the work for it starts.
///
/// # Errors
/// [`Refusal`] with the file or folder and the reason.
pub fn expect_room(path: &Path) -> Result<(), Refusal> {
    let (folder, name) = place(path)?;
    expect_folder(folder, &[name])
}

/// Refuses a folder that could not take these files, before the work for them starts. The folder need not be there yet.
///
/// # Errors
/// [`Refusal`] with the file or folder and the reason.
pub fn expect_folder(folder: &Path, names: &[&str]) -> Result<(), Refusal> {
    for name in names {
        expect_replaceable(&folder.join(name))?;
    }
    let there = folder.ancestors().find(|ancestor| ancestor.exists());
    let there = there
        .filter(|there| *there != Path::new(""))
        .unwrap_or(Path::new("."));
    let probe = there.join(format!(".{PROBE}.{}", std::process::id()));
    PARTIAL
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .push(probe.clone());
    let written = fs::write(&probe, PROBE).map_err(|error| cannot(there, &error));
    clear(&[probe]);
    written
}

/// Whether a name is that of a file that a killed program had written to see whether one can be.
pub fn is_probe(name: &str) -> bool {
    name.strip_prefix('.')
        .and_then(|rest| rest.strip_prefix(PROBE))
        .is_some_and(|rest| rest.starts_with('.'))
}

/// Content and part of the name of a file that is written to see whether one can be.
const PROBE: &str = "room";

fn cannot(path: &Path, error: &dyn std::fmt::Display) -> Refusal {
    Refusal(format!(
        "{} cannot be written: {error}; choose another --out",
        path.display()
    ))
}

/// Refuses what is no file, and a file that was read.
fn expect_replaceable(path: &Path) -> Result<(), Refusal> {
    let Ok(there) = path.canonicalize() else {
        return Ok(());
    };
    if KEPT
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .contains(&there)
    {
        return Err(cannot(path, &"it is what was read"));
    }
    if !there.is_file() {
        return Err(cannot(path, &"there is something of that name that is no file"));
    }
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
/// The last file is the mark of a whole set: an older one is taken away before anything is moved in and the new one is moved
/// in last, so that it never stands beside files of another set, whenever the program is killed.
///
/// # Errors
/// [`Refusal`] with the file and the reason; nothing half-written is left.
pub fn write_all<N: AsRef<str>>(folder: &Path, contents: &[(N, Vec<u8>)]) -> Result<(), Refusal> {
    for (name, _) in contents {
        expect_replaceable(&folder.join(name.as_ref()))?;
    }
    fs::create_dir_all(folder).map_err(|error| cannot(folder, &error))?;
    let places: Vec<(PathBuf, PathBuf)> = contents
        .iter()
        .map(|(name, _)| {
            let name = name.as_ref();
            let temporary = format!(".{name}.{}", std::process::id());
            (folder.join(temporary), folder.join(name))
        })
        .collect();
    let temporaries: Vec<PathBuf> = places.iter().map(|(temporary, _)| temporary.clone()).collect();
    PARTIAL
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .extend_from_slice(&temporaries);
    let written = places
        .iter()
        .zip(contents)
        .try_for_each(|((temporary, _), (_, content))| {
            fs::write(temporary, content).map_err(|error| cannot(temporary, &error))
        })
        .and_then(|()| move_in(&places));
    clear(&temporaries);
    written
}

/// Moves the files of a set to their places, the last one last.
fn move_in(places: &[(PathBuf, PathBuf)]) -> Result<(), Refusal> {
    if let [_, .., (_, mark)] = places
        && mark.exists()
    {
        fs::remove_file(mark).map_err(|error| cannot(mark, &error))?;
    }
    places.iter().try_for_each(|(temporary, place)| {
        fs::rename(temporary, place).map_err(|error| cannot(place, &error))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scratch(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("output-files-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).expect("a folder");
        folder
    }

    #[test]
    fn a_set_that_cannot_be_moved_in_whole_has_no_mark() {
        let folder = scratch("mark");
        let set = |text: &str| {
            [
                ("a", text.as_bytes().to_vec()),
                ("b", text.into()),
                ("mark", text.into()),
            ]
        };
        write_all(&folder, &set("old")).expect("a first set");
        // Its place is taken while the new set is on its way: the moves stop before the mark.
        let place = |name: &str| (folder.join(format!(".{name}")), folder.join(name));
        fs::write(folder.join(".a"), "new").expect("a file");
        let moved = move_in(&[place("a"), place("b"), place("mark")]);
        assert!(moved.is_err());
        assert_eq!(fs::read_to_string(folder.join("a")).expect("moved in"), "new");
        assert!(!folder.join("mark").exists(), "an old mark beside a new file");
        fs::remove_dir_all(&folder).expect("cleared away");
    }

    /// Writers side by side in one program: none takes away what another has on its way.
    #[test]
    fn writers_side_by_side_do_not_disturb_each_other() {
        let folder = scratch("many");
        std::thread::scope(|scope| {
            for writer in 0..4 {
                let own = folder.join(writer.to_string());
                scope.spawn(move || {
                    for round in 0..200 {
                        expect_folder(&own, &["a"]).expect("room");
                        let text = format!("{writer} {round}").into_bytes();
                        write_all(&own, &[("a", text.clone()), ("mark", text)]).expect("a set");
                    }
                });
            }
        });
        for writer in 0..4 {
            let text = fs::read_to_string(folder.join(writer.to_string()).join("mark")).expect("the last");
            assert_eq!(text, format!("{writer} 199"));
        }
        fs::remove_dir_all(&folder).expect("cleared away");
    }

    #[test]
    fn what_was_read_is_not_written_over_and_what_is_no_file_is_left_alone() {
        let folder = scratch("kept");
        let kept = folder.join("design.toml");
        fs::write(&kept, "mine").expect("a file");
        keep(&kept);
        fs::create_dir(folder.join("sub")).expect("a folder");
        for (place, reason) in [
            (&folder, "it is what was read"),
            (&folder.join("sub").join(".."), "it is what was read"),
        ] {
            let set = [("other", Vec::new()), ("design.toml", Vec::new())];
            let Refusal(found) = write_all(place, &set).expect_err("refused");
            assert!(found.contains(reason), "{found}");
            assert!(expect_folder(place, &["design.toml"]).is_err());
        }
        assert!(expect_folder(&folder, &["sub"]).is_err());
        assert!(expect_folder(&folder.join("new").join("deeper"), &["a"]).is_ok());
        assert!(!folder.join("new").exists());
        // A file where a folder would have to be.
        assert!(expect_folder(&kept, &["a"]).is_err());
        assert_eq!(fs::read_to_string(&kept).expect("there"), "mine");
        assert_eq!(
            fs::read_dir(&folder).expect("there").count(),
            2,
            "nothing is left behind"
        );
        fs::remove_dir_all(&folder).expect("cleared away");
    }
}
