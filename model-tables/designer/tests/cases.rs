//! The pages of hard cases: every test that they name is there.

use std::fs;
use std::path::{Path, PathBuf};

fn workspace() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .ancestors()
        .nth(2)
        .expect("the package lies in the workspace")
}

/// Every source file but what was built.
fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        let name = entry.file_name().to_string_lossy().into_owned();
        if path.is_dir() && name != "target" && !name.starts_with('.') {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// What stands between backticks.
fn quoted(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

/// Names in the last column of the tables of a page.
fn named(page: &str) -> Vec<String> {
    let text = fs::read_to_string(workspace().join("model-tables").join(page)).expect("the page");
    let mut names = Vec::new();
    for line in text.lines().filter(|line| line.starts_with('|')) {
        let cells: Vec<&str> = line.trim_end_matches('|').rsplitn(2, " | ").collect();
        names.extend(quoted(cells[0]).map(str::to_owned));
    }
    names
}

#[test]
fn every_test_that_a_page_names_is_there() {
    let mut files = Vec::new();
    sources(workspace(), &mut files);
    let texts: Vec<(&PathBuf, String)> = files
        .iter()
        .filter_map(|path| Some((path, fs::read_to_string(path).ok()?)))
        .collect();
    for (page, least) in [("BENCH_DATA.md", 10), ("HARD_CASES.md", 25)] {
        let names = named(page);
        assert!(names.len() >= least, "{page}: {names:?}");
        for name in names {
            let is_there = match name.strip_suffix("::tests") {
                // A module's tests.
                Some(module) => texts.iter().any(|(path, text)| {
                    path.file_stem().is_some_and(|stem| stem == module) && text.contains("mod tests")
                }),
                None if name.contains('_') => {
                    let (function, module) = (format!("fn {name}("), format!("{name}/mod.rs"));
                    let is_test = |text: &str| {
                        text.find(&function).is_some_and(|at| {
                            text[..at]
                                .lines()
                                .rev()
                                .take(6)
                                .any(|line| line.trim() == "#[test]")
                        })
                    };
                    texts
                        .iter()
                        .any(|(path, text)| is_test(text) || path.ends_with(&module))
                }
                None => workspace().join("model-tables").join(&name).is_dir(),
            };
            assert!(is_there, "{page} names {name}, which is no test");
        }
    }
}
