//! Materials by name and `[calibration]`, from outside: what every subcommand makes of them.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn designer(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_designer"))
        .args(arguments)
        .output()
        .expect("the binary runs")
}

/// Rows of a run that must succeed, as numbers where they are.
fn rows(arguments: &[&str]) -> Vec<Vec<f64>> {
    let output = designer(arguments);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let mut reader = csv::Reader::from_reader(output.stdout.as_slice());
    reader
        .records()
        .map(|row| {
            row.expect("a row")
                .iter()
                .map(|cell| cell.parse().unwrap_or(f64::NAN))
                .collect()
        })
        .collect()
}

/// A file of its own for a test.
fn scratch(name: &str, text: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::write(&path, text).expect("the test folder");
    path
}

const PAPER: &str = include_str!("../designs/paper-prestretched.toml");

fn close(found: f64, expected: f64, tolerance: f64) {
    assert!(
        (found - expected).abs() <= tolerance * expected.abs(),
        "{found} for {expected}"
    );
}

#[test]
fn solve_answers_as_the_bench_reads() {
    let text = format!(
        "{PAPER}\n[calibration]\nmaterial_factor = 1.5\nthickness_factor = 0.8\npressure_gain = 1.1\n\
         pressure_offset_kpa = 0.25\nindentation_offset_mm = 0.1\n"
    );
    let (plain, calibrated) = (scratch("plain.toml", PAPER), scratch("calibrated.toml", &text));
    let solve =
        |path: &Path, at: &str| rows(&["solve", path.to_str().expect("text"), "--indentation-mm", at]);
    let truth = solve(&plain, "0.5,1.5");
    let read = solve(&calibrated, "0.6,1.6,0.05");
    for (truth, read) in truth.iter().zip(&read) {
        // A membrane's pressure and force are proportional to modulus times wall.
        close(read[2], 1.1 * 1.2 * truth[2] + 0.25, 1e-9);
        close(read[1], 1.1 * 1.2 * truth[1] + 0.25, 1e-9);
        close(read[3], 1.2 * truth[3], 1e-9);
        close(read[4], truth[4], 1e-9);
    }
    // Before first touch.
    assert!(read[2][3].abs() < 1e-12);
    close(read[2][2], 0.25, 1e-9);
    let limit = |path: &Path| rows(&["rest", path.to_str().expect("text")])[0][5];
    close(limit(&calibrated), limit(&plain) + 0.1, 1e-9);
    let beyond = designer(&[
        "solve",
        calibrated.to_str().expect("text"),
        "--indentation-mm",
        "5",
    ]);
    let line = String::from_utf8_lossy(&beyond.stderr).into_owned();
    assert!(
        line.contains("indentation 5 mm is beyond the limit of 4.266107 mm"),
        "{line}"
    );
}

#[test]
fn tables_carry_the_gain_and_the_zero_takes_the_offset() {
    let text = format!("{PAPER}\n[calibration]\npressure_gain = 1.1\npressure_offset_kpa = 2\n");
    let (plain, calibrated) = (scratch("plain-tables.toml", PAPER), scratch("gain.toml", &text));
    let estimate = |path: &Path, rises: &str| {
        rows(&[
            "estimate",
            path.to_str().expect("text"),
            "--pressure-rise-pa",
            rises,
        ])
    };
    let truth = estimate(&plain, "1000,10000");
    let read = estimate(&calibrated, "1100,11000");
    for (truth, read) in truth.iter().zip(&read) {
        // Both tables are within 0.1 % of the curve.
        close(read[1], truth[1], 3e-3);
        close(read[2], truth[2], 3e-3);
    }
}

#[test]
fn a_material_by_name_solves_as_its_constants_and_is_described() {
    let named = PAPER.replace(
        "law = \"mooney-rivlin\"\nc1_pa = 160355.0\nc2_pa = 46559.0",
        "preset = \"agilus30\"",
    );
    assert_ne!(named, PAPER);
    let path = scratch("named.toml", &named);
    let rest = designer(&["rest", path.to_str().expect("text")]);
    let words = String::from_utf8_lossy(&rest.stderr).into_owned();
    for word in ["Soft Matter 18 (2022) 9076", "rate relaxed", "13 % per kelvin"] {
        assert!(words.contains(word), "{words}");
    }
    let plain = scratch("constants.toml", PAPER);
    assert_eq!(
        rest.stdout,
        designer(&["rest", plain.to_str().expect("text")]).stdout
    );
    assert_eq!(rows(&["materials"]).len(), 13);
}

#[test]
fn leaving_the_fitted_strain_is_warned_of() {
    let soft = PAPER.replace(
        "law = \"mooney-rivlin\"\nc1_pa = 160355.0\nc2_pa = 46559.0",
        "preset = \"ecoflex-00-30\"",
    );
    let warned = |stretch: &str| {
        let text = soft.replace("pole_stretch = 2.3", &format!("pole_stretch = {stretch}"));
        let path = scratch(&format!("soft-{stretch}.toml"), &text);
        let output = designer(&["solve", path.to_str().expect("text"), "--indentation-mm", "0.5"]);
        assert!(output.status.success());
        String::from_utf8_lossy(&output.stderr)
            .contains("beyond 2.00 up to which the constants of Ecoflex 00-30")
    };
    // Equal stretches l both ways have I1 - 3 = 2 l^2 + 1/l^4 - 3: 0.1 at 1.1 and 3.6 at 1.8; pressing takes some of it off.
    assert!(!warned("1.1"));
    assert!(warned("1.8"));
}

#[test]
fn completions_know_the_subcommands() {
    let output = designer(&["completions", "bash"]);
    assert!(output.status.success());
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    for word in ["estimate", "materials", "completions", "--indentation-mm"] {
        assert!(text.contains(word), "{word}");
    }
}
