//! What the tests across the crates share: documents, whose figures they hold to what the code gives, and the
//! simulated flash, and a board that takes a tip's data.

pub mod budget;
pub mod hand_device;
pub mod nor_flash;
pub mod real_use;
pub mod tip_device;
pub mod world;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The page of measured figures.
const MEASURED: &str = "host-tests/MEASURED.md";

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

/// Python of 3.11 or newer; `None` where there is none, as these tests need nothing but Rust.
///
/// # Panics
/// If there is none and `FINGERTIP_REQUIRE_PYTHON` is set, as in `.ci/run`.
pub fn python3() -> Option<Command> {
    let new = Command::new("python3")
        .args(["-c", "import sys; sys.exit(sys.version_info < (3, 11))"])
        .status();
    if new.is_ok_and(|status| status.success()) {
        return Some(Command::new("python3"));
    }
    assert!(
        std::env::var_os("FINGERTIP_REQUIRE_PYTHON").is_none(),
        "there is no python3 of 3.11 or newer"
    );
    eprintln!("no python3 of 3.11 or newer: not tested");
    None
}

/// Asserts that the README says `line`.
///
/// # Panics
/// If it does not, with the line as it should be.
pub fn assert_readme_says(line: &str) {
    assert_says("README.md", line);
}

/// Asserts that the page of measured figures has `line`.
///
/// # Panics
/// If it does not, with the line as it should be.
pub fn assert_measured_says(line: &str) {
    assert_says(MEASURED, line);
}

/// Asserts that the table of faults says `line`.
///
/// # Panics
/// If it does not, with the line as it should be.
pub fn assert_faults_says(line: &str) {
    assert_says("host-tests/FAULTS.md", line);
}

fn assert_says(document: &str, line: &str) {
    let text = fs::read_to_string(workspace().join(document)).expect("the document is there");
    let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        words(&text).contains(&words(line)),
        "{document} is stale; it should say\n{line}"
    );
}

/// The number beside `label` in a table of the page of measured figures: the last column, its unit left out.
///
/// # Panics
/// If there is no such row, or no number in it.
pub fn measured_figure(label: &str) -> f64 {
    let page = fs::read_to_string(workspace().join(MEASURED)).expect("the page is there");
    let row = page
        .lines()
        .find(|line| line.starts_with(&format!("| {label} |")))
        .unwrap_or_else(|| panic!("{MEASURED} has no row \"{label}\""));
    let last = row.trim_end_matches('|').rsplit('|').next().unwrap_or_default();
    let number: String = last.chars().filter(|c| c.is_ascii_digit() || *c == '.').collect();
    number
        .parse()
        .unwrap_or_else(|_| panic!("{MEASURED}: no number in the row \"{label}\""))
}

/// Asserts that the figure on the page is the measured one, to `share` of it (0: exactly).
///
/// # Panics
/// If it is not, with the figure as it should be.
pub fn assert_measured_figure(label: &str, measured: f64, share: f64) {
    let quoted = measured_figure(label);
    assert!(
        (quoted - measured).abs() <= share * measured.abs(),
        "{MEASURED} is stale: \"{label}\" is {measured}, not {quoted}"
    );
}
