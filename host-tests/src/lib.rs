//! What the tests across the crates share: the README, whose figures they hold to what the code gives.

use std::fs;
use std::path::{Path, PathBuf};

/// The folder of the workspace.
///
/// # Panics
/// Never: this package lies in it.
pub fn workspace() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .expect("the package lies in the workspace")
}

/// A shipped design.
pub fn design(name: &str) -> PathBuf {
    workspace()
        .join("model-tables/designs")
        .join(name)
        .with_extension("toml")
}

/// Asserts that the README says `line`.
///
/// # Panics
/// If it does not, with the line as it should be.
pub fn assert_readme_says(line: &str) {
    let readme = fs::read_to_string(workspace().join("README.md")).expect("the README is there");
    let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        words(&readme).contains(&words(line)),
        "README.md is stale; it should say\n{line}"
    );
}
