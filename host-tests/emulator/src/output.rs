//! Files that are opened before the work starts and appear only when they are whole.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// The files on their way.
static PARTIAL: Mutex<Vec<PathBuf>> = Mutex::new(vec![]);

/// Removes what is on its way: for a process that ends without dropping anything.
pub fn abandon() {
    for partial in PARTIAL.lock().unwrap_or_else(PoisonError::into_inner).drain(..) {
        // Nothing better can be done about a file that does not go away.
        let _ = fs::remove_file(partial);
    }
}

/// It is on its way no more.
fn forget(partial: &Path) {
    PARTIAL
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .retain(|one| one != partial);
}

/// A file on its way. Dropped unfinished, it leaves nothing behind.
#[derive(Debug)]
pub struct Output {
    path: PathBuf,
    partial: PathBuf,
    writer: BufWriter<File>,
    finished: bool,
}

impl Output {
    /// Opens it, the folders above it included.
    ///
    /// # Errors
    /// What the operating system answers, with the path before it.
    pub fn create(path: &Path) -> io::Result<Self> {
        let named = |error: io::Error| io::Error::new(error.kind(), format!("{}: {error}", path.display()));
        if path.is_dir() {
            return Err(named(io::ErrorKind::IsADirectory.into()));
        }
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).map_err(named)?;
        }
        let mut partial = path.as_os_str().to_owned();
        partial.push(".partial");
        let partial = PathBuf::from(partial);
        let writer = BufWriter::new(File::create(&partial).map_err(named)?);
        PARTIAL
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push(partial.clone());
        Ok(Self {
            path: path.to_owned(),
            partial,
            writer,
            finished: false,
        })
    }

    /// Gives it its name, replacing what had it.
    ///
    /// # Errors
    /// What the operating system answers.
    pub fn finish(mut self) -> io::Result<PathBuf> {
        self.writer.flush()?;
        fs::rename(&self.partial, &self.path)?;
        self.finished = true;
        forget(&self.partial);
        Ok(self.path.clone())
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.writer.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer.flush()
    }
}

impl Drop for Output {
    fn drop(&mut self) {
        if !self.finished {
            // Nothing better can be done about a file that does not go away.
            let _ = fs::remove_file(&self.partial);
            forget(&self.partial);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("fingertip-output-{}-{name}", std::process::id()));
        fs::create_dir_all(&folder).expect("the temporary folder takes one more");
        folder
    }

    #[test]
    fn appears_only_when_it_is_whole() {
        let folder = folder("whole");
        let path = folder.join("deeper/file.csv");
        let mut output = Output::create(&path).expect("it can be made");
        output.write_all(b"all").expect("it can be written");
        assert!(!path.exists());
        output.finish().expect("it can be named");
        assert_eq!(fs::read(&path).expect("it is there"), b"all");
        fs::remove_dir_all(folder).expect("it goes away");
    }

    #[test]
    fn leaves_what_was_there_when_it_is_given_up() {
        let folder = folder("given-up");
        let path = folder.join("file.csv");
        fs::write(&path, b"before").expect("it can be written");
        let mut output = Output::create(&path).expect("it can be made");
        output.write_all(b"half").expect("it can be written");
        drop(output);
        assert_eq!(fs::read(&path).expect("it is there"), b"before");
        assert_eq!(fs::read_dir(&folder).expect("it is there").count(), 1);
        fs::remove_dir_all(folder).expect("it goes away");
    }

    #[test]
    fn says_which_path_is_refused() {
        let error = Output::create(&std::env::temp_dir())
            .expect_err("it is a folder")
            .to_string();
        assert!(
            error.contains(&*std::env::temp_dir().to_string_lossy()),
            "{error}"
        );
    }
}
