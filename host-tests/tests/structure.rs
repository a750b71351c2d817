//! The layout of the sources: rooms that show the way, and no two of them that lead into each other.

use host_tests::workspace;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The crates, by the folder of their sources, with the files that may lie directly in it.
const CRATES: [(&str, usize); 11] = [
    ("src", 6),
    ("model-tables/src", 10),
    ("model-tables/certified-lookup/src", 10),
    ("model-tables/designer/src", 10),
    ("model-tables/compare/src", 10),
    ("model-tables/output/src", 10),
    ("host-tests/src", 10),
    ("host-tests/monitor/src", 10),
    ("host-tests/emulator/src", 20),
    ("host-tests/probes/src", 10),
    ("host-tests/emulator/src/bin/demo", 10),
];
/// Lines of a file, its tests aside.
const LONGEST: usize = 450;
/// Circles that are left, by folder.
const CIRCLES_LEFT: [(&str, usize); 0] = [];
/// Names that more than one public type has, each for one reason.
const SHARED_NAMES: [&str; 5] = [
    // What one fingertip differs by: in a design's file in its units, on the chip in the integers that are stored.
    "Calibration",
    // Force and indentation at a pressure rise: of a model in floating point, of the chip in integers with warnings.
    "Contact",
    // What is solved, and what the signal path asks of it.
    "Design",
    // The same press of either model, behind the same methods.
    "Press",
    "PressedState",
];

fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("a folder of sources") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// The text before its tests.
fn without_tests(text: &str) -> &str {
    text.split("\n#[cfg(test)]\nmod ").next().unwrap_or_default()
}

fn is_test(path: &Path) -> bool {
    path.file_stem()
        .is_some_and(|stem| stem == "tests" || stem == "test_design")
}

/// The module of a file, from the crate's root: `["membrane", "press"]`; empty for the root itself.
fn module(root: &Path, path: &Path) -> Vec<String> {
    let within = path
        .strip_prefix(root)
        .expect("below the root")
        .with_extension("");
    let mut parts: Vec<String> = within
        .components()
        .map(|part| part.as_os_str().to_string_lossy().into_owned())
        .collect();
    if parts
        .last()
        .is_some_and(|last| last == "mod" || last == "lib" || last == "main")
    {
        parts.pop();
    }
    parts
}

/// The module paths that a file names after `crate::` or `super::`, from the root.
fn named(text: &str, of: &[String]) -> Vec<Vec<String>> {
    let mut found = Vec::new();
    for line in text.lines().filter(|line| !line.trim_start().starts_with("//")) {
        for start in ["crate::", "super::"] {
            let mut rest = line;
            while let Some(at) = rest.find(start) {
                let before = rest[..at].chars().last();
                rest = &rest[at..];
                if before.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == ':') {
                    rest = &rest[start.len()..];
                    continue;
                }
                let mut path = if start == "crate::" {
                    Vec::new()
                } else {
                    of.to_vec()
                };
                let mut words = rest;
                if start == "crate::" {
                    words = &words[start.len()..];
                }
                while let Some(above) = words.strip_prefix("super::") {
                    path.pop();
                    words = above;
                }
                // As far as names are modules: those in lower case.
                let names = words.split(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':'));
                let names = names.into_iter().next().unwrap_or_default();
                path.extend(
                    names
                        .split("::")
                        .take_while(|name| name.chars().next().is_some_and(char::is_lowercase))
                        .map(str::to_owned),
                );
                found.push(path);
                rest = words;
            }
        }
    }
    found
}

/// Groups of modules beside each other in one folder that lead into each other, by folder.
fn circles(root: &Path) -> BTreeMap<Vec<String>, Vec<BTreeSet<String>>> {
    let mut edges: BTreeMap<Vec<String>, BTreeMap<String, BTreeSet<String>>> = BTreeMap::new();
    for path in sources(root).iter().filter(|path| !is_test(path)) {
        let own = module(root, path);
        let text = fs::read_to_string(path).expect("a source");
        for other in named(without_tests(&text), &own) {
            let shared = own.iter().zip(&other).take_while(|(a, b)| a == b).count();
            if let (Some(from), Some(to)) = (own.get(shared), other.get(shared)) {
                let folder = edges.entry(own[..shared].to_vec()).or_default();
                folder.entry(from.clone()).or_default().insert(to.clone());
            }
        }
    }
    let mut circles = BTreeMap::new();
    for (folder, edges) in edges {
        let reached = |from: &String| {
            let mut all: BTreeSet<String> = BTreeSet::new();
            let mut next = vec![from.clone()];
            while let Some(at) = next.pop() {
                for to in edges.get(&at).into_iter().flatten() {
                    if all.insert(to.clone()) {
                        next.push(to.clone());
                    }
                }
            }
            all
        };
        let reach: BTreeMap<&String, BTreeSet<String>> =
            edges.keys().map(|name| (name, reached(name))).collect();
        let mut groups: BTreeSet<BTreeSet<String>> = BTreeSet::new();
        for (name, to) in &reach {
            if to.contains(*name) {
                let group = to
                    .iter()
                    .filter(|other| reach.get(other).is_some_and(|back| back.contains(*name)));
                groups.insert(group.cloned().collect());
            }
        }
        if !groups.is_empty() {
            circles.insert(folder, groups.into_iter().collect());
        }
    }
    circles
}

#[test]
fn no_module_leads_back_into_itself() {
    for (root, _) in CRATES {
        for (folder, groups) in circles(&workspace().join(root)) {
            let place = [&[root.to_owned()], folder.as_slice()].concat().join("/");
            let left = CIRCLES_LEFT
                .iter()
                .find(|(folder, _)| *folder == place)
                .map_or(0, |(_, count)| *count);
            assert!(groups.len() <= left, "{place}: {groups:?}");
        }
    }
}

#[test]
fn a_folder_of_sources_holds_few_files() {
    for (root, most) in CRATES {
        let files = fs::read_dir(workspace().join(root))
            .expect("a folder of sources")
            .filter(|entry| entry.as_ref().is_ok_and(|entry| entry.path().is_file()))
            .count();
        assert!(files <= most, "{root}: {files} files");
    }
}

#[test]
fn no_file_is_long() {
    for (root, _) in CRATES {
        for path in sources(&workspace().join(root))
            .iter()
            .filter(|path| !is_test(path))
        {
            let text = fs::read_to_string(path).expect("a source");
            let lines = without_tests(&text).lines().count();
            let named = path
                .strip_prefix(workspace())
                .expect("below it")
                .to_string_lossy()
                .into_owned();
            assert!(lines <= LONGEST, "{named}: {lines} lines");
        }
    }
}

#[test]
fn a_public_type_has_its_name_alone() {
    let mut homes: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for (root, _) in CRATES {
        for path in sources(&workspace().join(root))
            .iter()
            .filter(|path| !is_test(path))
        {
            let text = fs::read_to_string(path).expect("a source");
            for line in without_tests(&text).lines().map(str::trim_start) {
                let Some(rest) = line.strip_prefix("pub ").or(line.strip_prefix("pub(crate) ")) else {
                    continue;
                };
                let mut words = rest.split(|c: char| !(c.is_alphanumeric() || c == '_'));
                if matches!(words.next(), Some("struct" | "enum" | "trait" | "type" | "union"))
                    // A macro names its types where it is called.
                    && let Some(name) = words.next().filter(|name| !name.is_empty())
                {
                    homes
                        .entry(name.to_owned())
                        .or_default()
                        .insert(path.display().to_string());
                }
            }
        }
    }
    let shared: Vec<&str> = homes
        .iter()
        .filter(|(_, homes)| homes.len() > 1)
        .map(|(name, _)| name.as_str())
        .collect();
    assert_eq!(shared, SHARED_NAMES);
}
