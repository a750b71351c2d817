//! Outputs that hold whole rows: what a full disk took of a row is taken back.

use std::fs::{self, File};
use std::io::{self, Seek as _, SeekFrom, Stdout, Write as _};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// From one look for the file's name to the next.
const LOOK: Duration = Duration::from_secs(1);

/// Takes rows, each whole or not at all.
pub trait WholeRows {
    /// Puts a row behind those that are there.
    ///
    /// # Errors
    /// What the output answers; nothing of the row is left where it can be taken back.
    fn put(&mut self, row: &[u8]) -> io::Result<()>;
}

impl WholeRows for &mut Vec<u8> {
    fn put(&mut self, row: &[u8]) -> io::Result<()> {
        self.extend_from_slice(row);
        Ok(())
    }
}

/// Rows behind what a file holds.
#[derive(Debug)]
struct Appended {
    file: File,
    /// Bytes of whole rows.
    length: u64,
}

impl Appended {
    fn put(&mut self, row: &[u8]) -> io::Result<()> {
        match self.file.write_all(row) {
            Ok(()) => {
                self.length += row.len() as u64;
                Ok(())
            }
            Err(error) => {
                // A row that ends early reads as other numbers than were measured.
                self.file.set_len(self.length)?;
                self.file.seek(SeekFrom::Start(self.length))?;
                Err(error)
            }
        }
    }
}

/// A new file of rows. One without a row is removed when it is dropped.
#[derive(Debug)]
pub struct RowFile {
    path: PathBuf,
    rows: Appended,
    /// Rows so far, a header among them.
    count: u64,
    looked: Instant,
}

impl RowFile {
    /// Makes the file, which must not be there.
    ///
    /// # Errors
    /// What the file system answers.
    pub fn create(path: &Path) -> io::Result<Self> {
        Ok(Self {
            path: path.to_owned(),
            rows: Appended {
                file: File::create_new(path)?,
                length: 0,
            },
            count: 0,
            looked: Instant::now(),
        })
    }
}

impl WholeRows for RowFile {
    fn put(&mut self, row: &[u8]) -> io::Result<()> {
        if self.looked.elapsed() > LOOK {
            self.looked = Instant::now();
            if !self.path.exists() {
                return Err(io::Error::new(
                    io::ErrorKind::NotFound,
                    format!("{} was removed while it was written", self.path.display()),
                ));
            }
        }
        self.rows.put(row)?;
        self.count += 1;
        Ok(())
    }
}

impl Drop for RowFile {
    fn drop(&mut self) {
        if self.count <= 1 {
            // Nothing was measured; what remains is at worst a header.
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// Standard output; where it is a file, rows are whole there too.
#[derive(Debug)]
pub struct RowOutput {
    file: Option<Appended>,
    stream: Stdout,
}

impl RowOutput {
    /// Of this program.
    pub fn new() -> Self {
        Self {
            file: own_file(),
            stream: io::stdout(),
        }
    }
}

impl Default for RowOutput {
    fn default() -> Self {
        Self::new()
    }
}

impl WholeRows for RowOutput {
    fn put(&mut self, row: &[u8]) -> io::Result<()> {
        if let Some(file) = &mut self.file {
            return file.put(row);
        }
        self.stream.write_all(row)?;
        self.stream.flush()
    }
}

/// Standard output as a file, if it is one.
#[cfg(unix)]
fn own_file() -> Option<Appended> {
    use std::os::fd::AsFd as _;
    let mut file = File::from(io::stdout().as_fd().try_clone_to_owned().ok()?);
    if !file.metadata().ok()?.is_file() {
        return None;
    }
    // Also what `>>` opened stands at its end.
    let length = file.seek(SeekFrom::End(0)).ok()?;
    Some(Appended { file, length })
}

#[cfg(not(unix))]
fn own_file() -> Option<Appended> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(name: &str) -> PathBuf {
        std::env::temp_dir().join(format!("fingertip-{name}-{}", std::process::id()))
    }

    #[test]
    fn a_file_without_a_row_does_not_stay() {
        let path = place("header-only");
        let mut file = RowFile::create(&path).expect("a new file");
        file.put(b"time_ms\n").expect("room");
        drop(file);
        assert!(!path.exists());
        let mut file = RowFile::create(&path).expect("a new file");
        file.put(b"time_ms\n").expect("room");
        file.put(b"1\n").expect("room");
        drop(file);
        assert_eq!(fs::read(&path).expect("it stays"), b"time_ms\n1\n");
        fs::remove_file(&path).expect("it is there");
    }

    #[test]
    fn a_file_that_was_removed_is_told() {
        let path = place("removed");
        let mut file = RowFile::create(&path).expect("a new file");
        file.put(b"time_ms\n").expect("room");
        fs::remove_file(&path).expect("it is there");
        file.looked = Instant::now()
            .checked_sub(2 * LOOK)
            .expect("the clock runs for longer");
        let error = file.put(b"1\n").expect_err("it is gone").to_string();
        assert!(error.contains("was removed while it was written"), "{error}");
    }
}
