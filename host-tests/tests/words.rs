//! The words of the sources and documents: one name for one thing, and that the field's own.

use host_tests::workspace;
use std::fs;
use std::path::{Path, PathBuf};

/// A word that does not come back, where it is looked for, and what stands in its place.
const REPLACED: [(&str, &[&str], &str); 21] = [
    ("rung", ALL, "model, fidelity"),
    ("rungs", ALL, "models, fidelities"),
    ("Keeper", ALL, "TransducerSupervisor"),
    ("Patient", ALL, "RetryingFlash"),
    ("Station", ALL, "Device"),
    ("station", &["src", "host-tests"], "device"),
    ("Ears", ALL, "SerialRx"),
    ("ears", &["src"], "serial_rx"),
    ("MEALS", ALL, "WATCHDOG_PERIOD"),
    ("roster", ALL, "task_monitor"),
    ("Roster", ALL, "TaskMonitor"),
    ("crumb", ALL, "crash_record"),
    ("breadcrumb", ALL, "crash record"),
    ("blame", ALL, "record_fault"),
    ("contest", ALL, "benchmark"),
    ("untold", ALL, "unidentifiable"),
    ("widening", ALL, "inflation of standard errors"),
    ("leap", ALL, "step"),
    ("wild", ALL, "outlier"),
    ("said", ALL, "reported, emitted, stated"),
    ("serves", &["src", "model-tables"], "is in use, is valid"),
];
/// Beginnings of constants, and what stands in their place.
const BEGINNINGS: [(&str, &str); 3] = [
    ("MOST_", "MAX_ with the noun"),
    ("LEAST_", "MIN_ with the noun"),
    ("ENOUGH", "MIN_ with the noun"),
];
const ALL: &[&str] = &["src", "host-tests", "model-tables", "README.md", "build.rs"];
const KINDS: [&str; 4] = ["rs", "md", "py", "toml"];

fn texts(place: &Path, found: &mut Vec<PathBuf>) {
    if place.is_dir() {
        if place.file_name().is_some_and(|name| name == "target") {
            return;
        }
        for entry in fs::read_dir(place).expect("a folder") {
            texts(&entry.expect("an entry").path(), found);
        }
    } else if place
        .extension()
        .is_some_and(|extension| KINDS.iter().any(|kind| extension == *kind))
    {
        found.push(place.to_owned());
    }
}

/// The words of a line: runs of letters, so that each part of `last_rung` is one, with the case it is written in.
fn words(line: &str) -> impl Iterator<Item = &str> {
    line.split(|letter: char| !letter.is_ascii_alphabetic())
}

#[test]
fn a_replaced_word_does_not_come_back() {
    let own = Path::new(file!()).file_name().expect("this file");
    let mut found = Vec::new();
    for (word, places, instead) in REPLACED {
        for place in places {
            let mut files = Vec::new();
            texts(&workspace().join(place), &mut files);
            assert!(!files.is_empty(), "{place}");
            for file in files.iter().filter(|file| file.file_name() != Some(own)) {
                let text = fs::read_to_string(file).expect("a text");
                for (number, line) in text.lines().enumerate() {
                    if words(line).any(|part| part == word) {
                        found.push(format!(
                            "{}:{}: {word}, better {instead}",
                            file.display(),
                            number + 1
                        ));
                    }
                }
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn a_limit_is_a_minimum_or_a_maximum_of_something() {
    let mut files = Vec::new();
    for place in ["src", "host-tests", "model-tables"] {
        texts(&workspace().join(place), &mut files);
    }
    let mut found = Vec::new();
    for file in &files {
        let text = fs::read_to_string(file).expect("a text");
        for line in text.lines() {
            for (beginning, instead) in BEGINNINGS {
                if line.contains(&format!("const {beginning}"))
                    || line.contains(&format!("static {beginning}"))
                {
                    found.push(format!("{}: {line}: better {instead}", file.display()));
                }
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn a_word_is_found_within_a_name() {
    assert!(words("let last_rung = 3;").any(|word| word == "rung"));
    assert!(words("    runge_kutta(flat)").all(|word| word != "rung"));
}
