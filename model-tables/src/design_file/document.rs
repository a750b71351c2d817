//! A TOML file as every reader of this project uses it: its text, its tables and the name in it.

use super::error::{DesignFileError, Problem};
use super::section::{KeyFault, Section, line_at};
use std::path::Path;
use toml::Spanned;
use toml::de::DeTable;

/// What the name of a design, a target or a hand may be: [`Section::name`] with 64 letters.
pub const NAME: &str =
    "1 to 64 letters, digits, `-` or `_` in quotes, as it names files and is held by the chip";

/// The text of a file.
///
/// # Errors
/// [`DesignFileError`] with the file's name where it cannot be read.
pub fn read(path: &Path) -> Result<String, DesignFileError> {
    let unreadable = |error: std::io::Error| {
        let problem = Problem::Unreadable(error.to_string());
        DesignFileError::at(&path.display().to_string(), (None, problem))
    };
    std::fs::read_to_string(path).map_err(unreadable)
}

/// The tables of a text.
///
/// # Errors
/// [`KeyFault`] with the line where the text is not TOML.
pub fn tables(text: &str) -> Result<Spanned<DeTable<'_>>, KeyFault> {
    DeTable::parse(text).map_err(|error| {
        let line = error.span().map(|span| line_at(text, span.start));
        (line, Problem::Syntax(error.message().to_owned()))
    })
}

impl Section<'_> {
    /// The key `name`: 1 to `most` letters, digits, `-` and `_`, which `allowed` says.
    ///
    /// # Errors
    /// [`KeyFault`] with the key, what was found and what is allowed.
    pub fn name(&mut self, most: usize, allowed: &str) -> Result<String, KeyFault> {
        let name = self.needed_text("name", allowed)?;
        let plain = name
            .chars()
            .all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_');
        if plain && (1..=most).contains(&name.len()) {
            Ok(name.to_owned())
        } else {
            Err(self.refuse("name", allowed))
        }
    }
}
