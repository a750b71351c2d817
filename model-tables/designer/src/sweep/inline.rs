//! The file of a sweep and its design as one text, for a machine that has neither file.

use super::space::Space;
use model_tables::design_file::{DesignFileError, Problem, document};
use std::path::Path;
use toml_edit::{DocumentMut, Item, Table};

/// The text of a sweep's file with the design that it names as `[base]`: the same designs, and the same [`Space::hash`].
///
/// # Errors
/// [`DesignFileError`] for the first thing that is wrong with either file.
pub fn whole(path: &Path) -> Result<String, DesignFileError> {
    let space = Space::read(path)?;
    let text = document::read(path)?;
    let mut document: DocumentMut = text.parse().map_err(|error: toml_edit::TomlError| {
        let problem = Problem::Syntax(error.message().to_owned());
        DesignFileError::at(&path.display().to_string(), (None, problem))
    })?;
    if document.remove("design").is_some() {
        let mut base = Table::new();
        for (key, item) in space.base() {
            base.insert(key, unplaced(item.clone()));
        }
        document.insert("base", Item::Table(base));
    }
    Ok(document.to_string())
}

/// A section that is written where its parent is, not where it stood in its own file.
fn unplaced(item: Item) -> Item {
    let Item::Table(mut table) = item else {
        return item;
    };
    table.set_position(None);
    for (_, item) in table.iter_mut() {
        *item = unplaced(std::mem::take(item));
    }
    Item::Table(table)
}
