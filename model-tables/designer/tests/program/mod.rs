//! The `designer` binary, run from outside: what the tests of its commands share.

use std::process::{Command, Output};

pub(crate) fn designer(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_designer"))
        .args(arguments)
        .output()
        .expect("the binary runs")
}

/// Header and rows of a run that must succeed.
pub(crate) fn header_and_rows(arguments: &[&str]) -> (String, Vec<Vec<String>>) {
    let output = designer(arguments);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{stderr}");
    let mut reader = csv::Reader::from_reader(output.stdout.as_slice());
    let header = reader
        .headers()
        .expect("a header")
        .iter()
        .collect::<Vec<_>>()
        .join(",");
    let rows = reader
        .records()
        .map(|row| row.expect("a row").iter().map(str::to_owned).collect())
        .collect();
    (header, rows)
}

/// The one line of a run that must fail, with nothing on standard output.
pub(crate) fn refusal(arguments: &[&str]) -> String {
    let output = designer(arguments);
    assert_eq!(output.status.code(), Some(1), "{arguments:?}");
    assert!(output.stdout.is_empty(), "{arguments:?}");
    let text = String::from_utf8(output.stderr).expect("text");
    // On a loaded machine what takes a moment tells its progress each second.
    let lines = text.split_inclusive('\n');
    let text: String = lines.filter(|line| !line.starts_with("progress: ")).collect();
    assert_eq!(text.lines().count(), 1, "{text}");
    text
}
