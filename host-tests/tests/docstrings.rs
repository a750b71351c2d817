//! What the documentation of a public field has to give: the unit of a number, and when an option is `None`.

use host_tests::workspace;
use std::fs;
use std::path::{Path, PathBuf};

/// Where public fields are looked for.
const PLACES: [&str; 3] = ["src", "host-tests", "model-tables"];
/// Units, and words of a number without one.
const UNITS: [&str; 68] = [
    "metre",
    "metres",
    "millimetres",
    "micrometres",
    "nanometres",
    "pascals",
    "kilopascals",
    "kPa",
    "Pa",
    "newtons",
    "N",
    "joules",
    "seconds",
    "milliseconds",
    "microseconds",
    "nanoseconds",
    "second",
    "hours",
    "hour",
    "radians",
    "degrees",
    "kelvins",
    "kelvin",
    "hertz",
    "volts",
    "ohms",
    "mm",
    "pixels",
    "counts",
    "codes",
    "instructions",
    "bytes",
    "percent",
    "cubic",
    "relative",
    "ratio",
    "share",
    "Share",
    "shares",
    "over",
    "Over",
    "dimensionless",
    "factor",
    "Factor",
    "per",
    "part",
    "parts",
    "Part",
    "times",
    "Times",
    "logarithm",
    "Logarithm",
    "fraction",
    "Fraction",
    "deviations",
    "stretch",
    "correlation",
    "Correlation",
    "number",
    "Number",
    "unit",
    "units",
    "deviation",
    "factors",
    "joule",
    "1",
    "metre's",
    "million",
];

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        if path.is_dir() {
            if !["tests", "target", "benches", "probes"].contains(&name.as_str()) {
                sources(&path, found);
            }
        } else if path.extension().is_some_and(|kind| kind == "rs") && name != "tests.rs" {
            found.push(path);
        }
    }
}

/// A public field: its name, its type, its documentation.
fn field(lines: &[&str], at: usize) -> Option<(String, String, String)> {
    let (name, kind) = lines[at].trim().strip_prefix("pub ")?.split_once(": ")?;
    if !name
        .bytes()
        .all(|byte| byte.is_ascii_alphanumeric() || byte == b'_')
    {
        return None;
    }
    let above = lines[..at].iter().rev().map(|line| line.trim());
    let mut documentation: Vec<&str> = above
        .take_while(|line| line.starts_with("///") || line.starts_with("#["))
        .filter_map(|line| line.strip_prefix("///"))
        .collect();
    documentation.reverse();
    Some((
        name.to_owned(),
        kind.trim_end_matches(',').to_owned(),
        documentation.join(" "),
    ))
}

fn is_number(kind: &str) -> bool {
    kind == "f64" || kind == "Option<f64>" || kind == "Vec<f64>" || kind.starts_with("[f64; ")
}

fn has_unit(documentation: &str) -> bool {
    let mut words = documentation.split(|letter: char| !(letter.is_alphanumeric() || letter == '\''));
    words.any(|word| UNITS.contains(&word))
}

#[test]
fn a_public_field_has_its_unit_and_says_when_it_is_none() {
    let mut files = Vec::new();
    for place in PLACES {
        sources(&workspace().join(place), &mut files);
    }
    let (mut numbers, mut options, mut found) = (0, 0, Vec::new());
    for file in files {
        let text = fs::read_to_string(&file).expect("a source");
        let lines: Vec<&str> = text
            .split("\n#[cfg(test)]\nmod ")
            .next()
            .unwrap_or_default()
            .lines()
            .collect();
        for at in 0..lines.len() {
            let Some((name, kind, documentation)) = field(&lines, at) else {
                continue;
            };
            let place = format!("{}:{}: {name}:", file.display(), at + 1);
            if is_number(&kind) {
                numbers += 1;
                if !has_unit(&documentation) {
                    found.push(format!("{place} no unit in \"{documentation}\""));
                }
            }
            if kind.starts_with("Option<") {
                options += 1;
                if !documentation.contains("`None`") {
                    found.push(format!("{place} when is it `None`? \"{documentation}\""));
                }
            }
        }
    }
    assert!(
        numbers > 300 && options > 60,
        "{numbers} numbers, {options} options"
    );
    assert!(found.is_empty(), "{}", found.join("\n"));
}
