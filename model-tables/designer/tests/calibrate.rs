//! Materials by name and `[calibration]`, from outside: what every subcommand makes of them.

use designer::size::target::Target;
use designer::size::{Sized, size};
use std::fmt::Write as _;
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

const PAPER: &str = include_str!(concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../designs/paper-prestretched.toml"
));

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

/// What `solve` gives of a design, as bench data.
fn bench(design: &Path, depths: &str) -> String {
    let mut text = String::from("indentation_mm,force_n,pressure_rise_kpa\n");
    for row in rows(&[
        "solve",
        design.to_str().expect("text"),
        "--indentation-mm",
        depths,
    ]) {
        let _ = writeln!(text, "{},{},{}", row[0], row[3], row[2]);
    }
    text
}

const DEPTHS: &str = "0.1,0.2,0.35,0.5,0.7,0.9,1.1,1.3,1.5,1.7,1.9,2.1,2.3,2.5";

#[test]
fn fit_writes_a_design_that_reads_as_the_bench() {
    let drawn = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/src/commands/stand-in.toml"));
    let truth = scratch(
        "fit-truth.toml",
        &format!("{drawn}\n[calibration]\nmaterial_factor = 1.4\npole_stretch = 1.04\n"),
    );
    let data = scratch("fit-bench.csv", &bench(&truth, DEPTHS));
    let design = scratch("fit-drawn.toml", drawn);
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fit-out");
    let _ = fs::remove_dir_all(&out);
    let fitted = rows(&[
        "fit",
        design.to_str().expect("text"),
        data.to_str().expect("text"),
        "--fit",
        "material,pole-stretch",
        "--out",
        out.to_str().expect("text"),
    ]);
    close(fitted[0][3], 1.4, 1e-3);
    close(fitted[1][3], 1.04, 1e-3);
    let written = out.join("stand-in-calibrated.toml");
    let text = fs::read_to_string(&written).expect("the design");
    // The design as it was, comments and all, and a section more.
    assert!(text.starts_with(drawn.trim_end()), "{text}");
    assert!(text.contains("# Fitted by `designer fit` to fit-bench.csv: 14 rows"));
    let solve = |path: &Path| rows(&["solve", path.to_str().expect("text"), "--indentation-mm", "1,2"]);
    for (found, expected) in solve(&written).iter().zip(solve(&truth)) {
        close(found[3], expected[3], 1e-3);
        close(found[2], expected[2], 1e-3);
    }
    let report = fs::read_to_string(out.join("fit.md")).expect("the report");
    for word in [
        "| material | `material_factor` |",
        "13 % per kelvin",
        "cross-validation",
        "hysteresis",
    ] {
        assert!(report.contains(word), "{report}");
    }
    assert!(
        fs::read_to_string(out.join("fit.svg"))
            .expect("the chart")
            .ends_with("</svg>\n")
    );
    let residuals = fs::read_to_string(out.join("residuals.csv")).expect("the residuals");
    assert_eq!(residuals.lines().count(), 29);
}

#[test]
fn fit_from_data_makes_tables_that_read_as_the_data_and_end_with_them() {
    // No membrane: F = H^1.5, and a pressure that saturates.
    let mut text = String::from("indentation_mm,force_n,pressure_rise_kpa\n");
    for k in 1..=60 {
        let depth = 0.05 * f64::from(k);
        let _ = writeln!(
            text,
            "{depth},{},{}",
            depth.powf(1.5),
            3.0 * (1.0 - (-depth).exp())
        );
    }
    let data = scratch("pad.csv", &text);
    let design = scratch(
        "pad.toml",
        include_str!(concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../designs/skin-analogue.toml"
        )),
    );
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("from-data-out");
    let _ = fs::remove_dir_all(&out);
    let found = designer(&[
        "fit",
        design.to_str().expect("text"),
        data.to_str().expect("text"),
        "--from-data",
        "--rest-pressure-kpa",
        "0.5",
        "--out",
        out.to_str().expect("text"),
    ]);
    let notes = String::from_utf8_lossy(&found.stderr).into_owned();
    assert!(found.status.success(), "{notes}");
    for word in [
        "the pressure saturates from",
        "calibrated for pressure rises of",
        "bytes and end at 2.500 mm",
    ] {
        assert!(notes.contains(word), "{notes}");
    }
    let written = out.join("skin-analogue-from-data.toml");
    let path = written.to_str().expect("text");
    // At 1 mm the rise is 3 (1 - 1/e) kPa = 1896.36 Pa.
    let read = rows(&["estimate", path, "--pressure-rise-pa", "1896.36"]);
    close(read[0][1], 1.0, 0.01);
    close(read[0][2], 1.0, 0.01);
    let beyond = designer(&["estimate", path, "--pressure-rise-pa", "2990"]);
    assert!(String::from_utf8_lossy(&beyond.stdout).contains("saturated"));
    // Deeper than the data: refused.
    let text = fs::read_to_string(&written).expect("the design");
    let deeper = scratch(
        "pad-deeper.toml",
        &text.replace("max_indentation_mm = 2.5", "max_indentation_mm = 3.5"),
    );
    let refused = designer(&[
        "estimate",
        deeper.to_str().expect("text"),
        "--pressure-rise-pa",
        "1",
    ]);
    assert_eq!(refused.status.code(), Some(1));
    assert!(
        String::from_utf8_lossy(&refused.stderr)
            .contains("is beyond the data in [calibration], which end at"),
        "{}",
        String::from_utf8_lossy(&refused.stderr)
    );
}

/// The design that the emulated board is built for is what the command makes of the data beside it.
#[test]
fn the_measured_design_of_the_emulated_board_is_what_its_data_give() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../host-tests/emulator/tests/measured");
    let drawn = Path::new(env!("CARGO_MANIFEST_DIR")).join("../designs/skin-analogue.toml");
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("measured-out");
    let _ = fs::remove_dir_all(&out);
    rows(&[
        "fit",
        drawn.to_str().expect("text"),
        folder.join("pad.csv").to_str().expect("text"),
        "--from-data",
        "--rest-pressure-kpa",
        "2",
        "--out",
        out.to_str().expect("text"),
    ]);
    let name = "skin-analogue-from-data.toml";
    let text = |folder: &Path| fs::read_to_string(folder.join(name)).expect("the design");
    assert_eq!(text(&out), text(&folder));
}

#[test]
fn a_refused_fit_is_one_line_and_writes_nothing() {
    let design = scratch("refused.toml", PAPER);
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("refused-out");
    let _ = fs::remove_dir_all(&out);
    for (name, text, extra, reason) in [
        (
            "pascals",
            "indentation_mm,pressure_rise_kpa\n0.5,250\n1,800\n2,4000\n",
            "",
            "check the units",
        ),
        (
            "words",
            "indentation_mm,force_n\n0.5,much\n",
            "",
            "line 2: `force_n` is `much`",
        ),
        (
            "falling",
            "indentation_mm,force_n\n0.5,3\n1,2\n2,1\n",
            "",
            "falls as it should grow with",
        ),
        (
            "parameter",
            "indentation_mm,force_n\n0.5,1\n1,2\n2,3\n",
            "stiffness",
            "material, pole-stretch, compliance",
        ),
    ] {
        let data = scratch(&format!("{name}.csv"), text);
        let mut arguments = vec![
            "fit",
            design.to_str().expect("text"),
            data.to_str().expect("text"),
        ];
        arguments.extend(["--out", out.to_str().expect("text")]);
        if !extra.is_empty() {
            arguments.extend(["--fit", extra]);
        }
        let output = designer(&arguments);
        let line = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{name}");
        assert!(
            output.stdout.is_empty() && line.lines().count() == 1 && line.contains(reason),
            "{line}"
        );
        assert!(!out.exists());
    }
}

#[test]
fn size_finds_membranes_that_feel_like_a_fingertip() {
    let target = format!("{}/../targets/human-fingertip.toml", env!("CARGO_MANIFEST_DIR"));
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("size-out");
    let _ = fs::remove_dir_all(&out);
    // Whatever the law: the list of the target has some that lose their stability before the press ends.
    let wanted = Target::read(Path::new(&target)).expect("the shipped target");
    let sizing = size(&wanted, &|_| ());
    for preset in &wanted.materials {
        let is_it = |sized: &Sized| sized.material.name == preset.name;
        assert!(sizing.designs.iter().any(is_it), "{}", preset.name);
    }
    let output = designer(&[
        "size",
        &target,
        "--best",
        "3",
        "--out",
        out.to_str().expect("text"),
    ]);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let mut reader = csv::Reader::from_reader(output.stdout.as_slice());
    let found: Vec<csv::StringRecord> = reader.records().map(|row| row.expect("a row")).collect();
    assert_eq!(found.len(), 3);
    // Whatever is written has tables.
    for rank in 1..=3 {
        let design = out.join(format!("human-fingertip-{rank}.toml"));
        let tables = out.join(format!("tables-{rank}"));
        let made = designer(&[
            "table",
            design.to_str().expect("text"),
            "--out",
            tables.to_str().expect("text"),
        ]);
        assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    }
    let number = |row: &csv::StringRecord, column: usize| row[column].parse::<f64>().expect("a number");
    for row in &found {
        assert!((4.0..=10.0).contains(&number(row, 2)) && (2.0..=9.0).contains(&number(row, 3)));
        assert!((0.3..=1.5).contains(&number(row, 4)) && (1.02..=2.0).contains(&number(row, 5)));
        assert!(number(row, 9) <= 100.0 && number(row, 15) > 1.0);
    }
    // The best design, solved by the full model from its file.
    let best = out.join("human-fingertip-1.toml");
    let solved = rows(&["solve", best.to_str().expect("text"), "--indentation-mm", "0.5,2"]);
    let misfit = |k: usize, wanted: f64| (solved[k][3] / wanted - 1.0) / 2.0_f64.sqrt();
    let rms = misfit(0, 0.32).hypot(misfit(1, 1.94));
    assert!(
        (100.0 * rms - number(&found[0], 6)).abs() < 0.5,
        "{rms} {:?}",
        found[0]
    );
    // What a tenth of a millimetre more of wall does: the same design with that wall, solved.
    let text = fs::read_to_string(&best).expect("the design");
    let thickness = text
        .lines()
        .find_map(|line| line.strip_prefix("thickness_mm = ")?.parse::<f64>().ok())
        .expect("a wall");
    let thicker = text.replace(
        &format!("thickness_mm = {thickness}"),
        &format!("thickness_mm = {}", thickness + 0.1),
    );
    assert_ne!(thicker, text);
    let thicker_file = out.join("thicker.toml");
    fs::write(&thicker_file, thicker).expect("written");
    let thicker = rows(&[
        "solve",
        thicker_file.to_str().expect("text"),
        "--indentation-mm",
        "0.5,2",
    ]);
    for (thicker, solved) in thicker.iter().zip(&solved) {
        close(
            number(&found[0], 18),
            100.0 * (thicker[3] / solved[3] - 1.0),
            0.02,
        );
    }
}

#[test]
fn calibration_writes_the_page_of_this_crate() {
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("CALIBRATION.md");
    let found = rows(&["calibration", "--out", out.to_str().expect("text")]);
    // After a fit less is left than before it.
    for row in &found {
        assert!(row[2] < row[1], "{row:?}");
    }
    let written = fs::read_to_string(&out).expect("the page");
    let mut now = written.lines();
    for line in include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../CALIBRATION.md")).lines() {
        assert_eq!(
            Some(line),
            now.next(),
            "the page is stale: run `cargo designer calibration --out model-tables/CALIBRATION.md`"
        );
    }
    assert_eq!(now.next(), None, "the page is stale");
}
