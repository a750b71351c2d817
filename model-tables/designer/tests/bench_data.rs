//! Files of a bench as they come: what `designer fit` recognises, and says, and what it refuses, and why.

mod program;

use program::designer;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

const DESIGN: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/src/commands/stand-in.toml"));

/// A folder of its own for a test, with the design in it.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("bench-data-{name}"));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("the test folder");
    fs::write(folder.join("tip.toml"), DESIGN).expect("the design");
    folder
}

/// Indentation (mm), force (N), rise (kPa): `F = 1.5 H^2.1`, `P = 10 H^1.9`, much as the stand-in reads.
fn rows() -> Vec<[f64; 3]> {
    (1..=25)
        .map(|k| 0.1 * f64::from(k))
        .map(|h| [h, 1.5 * h.powf(2.1), 10.0 * h.powf(1.9)])
        .collect()
}

fn csv(header: &str, separator: &str, rows: &[[f64; 3]]) -> String {
    let mut text = format!("{header}\n");
    for [a, b, c] in rows {
        let _ = writeln!(text, "{a:.6}{separator}{b:.6}{separator}{c:.6}");
    }
    text
}

/// Status, standard output and standard error of a fit of one parameter.
fn fit(folder: &Path, bytes: &[u8], extra: &[&str]) -> (bool, String, String) {
    let data = folder.join("data.csv");
    fs::write(&data, bytes).expect("the data");
    let design = folder.join("tip.toml");
    let mut arguments = vec![
        "fit",
        design.to_str().expect("text"),
        data.to_str().expect("text"),
        "--fit",
        "material",
    ];
    arguments.extend(extra);
    let output = designer(&arguments);
    let text = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes).into_owned();
    (output.status.success(), text(output.stdout), text(output.stderr))
}

const PLAIN: &str = "indentation_mm,force_n,pressure_rise_kpa";

#[test]
fn the_same_bench_is_read_however_it_is_written() {
    let folder = folder("formats");
    let rows = rows();
    let (_, plain, _) = fit(&folder, csv(PLAIN, ",", &rows).as_bytes(), &[]);
    let factor = |answer: &str| -> f64 {
        let line = answer.lines().nth(1).expect("a row");
        line.split(',')
            .nth(3)
            .expect("a value")
            .parse()
            .expect("a number")
    };
    let scaled = |[a, b, c]: [f64; 3]| -> Vec<[f64; 3]> {
        rows.iter().map(|[x, y, z]| [a * x, b * y, c * z]).collect()
    };
    let sixteen: Vec<u8> = csv(
        "Depth (mm)\tFORCE_N\tPressure (in bar)",
        "\t",
        &scaled([1.0, 1.0, 0.01]),
    )
    .encode_utf16()
    .flat_map(u16::to_le_bytes)
    .collect();
    let latin: Vec<u8> = csv(
        "Depth (\u{b5}m);Force (mN);Pressure [Pa]",
        ";",
        &scaled([1e3, 1e3, 1e3]),
    )
    .chars()
    .map(|c| u32::from(c) as u8)
    .collect();
    let quoted = csv(PLAIN, ",", &rows)
        .replace('\n', "\"\n\"")
        .replace(',', "\",\"");
    let quoted = format!("\"{}", quoted.trim_end_matches('"'));
    for (bytes, extra, note) in [
        (
            csv(PLAIN, ";", &rows)
                .replace(',', ";")
                .replace('.', ",")
                .into_bytes(),
            &[][..],
            "decimal commas",
        ),
        (sixteen, &[], "read as UTF-16LE text"),
        (latin, &[], "read as Latin-1 text"),
        (quoted.into_bytes(), &[], ""),
        (
            csv("Depth,Force,Pressure\nmm,N,kPa", ",", &rows).into_bytes(),
            &[],
            "`Force` is taken as the force, in N",
        ),
        (
            csv(
                "Indentation_mm,Force_N,pressure_rise_pa",
                ",",
                &scaled([1.0, 1.0, 1e3]),
            )
            .into_bytes(),
            &[],
            "`pressure_rise_pa`",
        ),
        (
            csv(PLAIN, ",", &scaled([-1.0, -1.0, 1.0])).into_bytes(),
            &[],
            "its sign was turned",
        ),
        (
            csv("indentation_mm,Fz,pressure_rise_kpa", ",", &rows).into_bytes(),
            &["--columns", "force_n=Fz"],
            "",
        ),
        (
            csv("1,0.2,0.3", ",", &rows)
                .replacen("1,0.2,0.3\n", "", 1)
                .into_bytes(),
            &["--columns", "indentation_mm=1,force_n=2,pressure_rise_kpa=3"],
            "",
        ),
    ] {
        let (ok, answer, notes) = fit(&folder, &bytes, extra);
        assert!(ok, "{note}: {notes}");
        assert!(
            (factor(&answer) / factor(&plain) - 1.0).abs() < 1e-3,
            "{note}: {answer} for {plain}"
        );
        assert!(notes.contains(note), "{notes}");
    }
}

#[test]
fn what_can_mean_two_things_is_refused_by_its_reason() {
    let folder = folder("refused");
    let rows = rows();
    let plain = csv(PLAIN, ",", &rows);
    let stage: Vec<[f64; 3]> = rows.iter().map(|[h, f, p]| [h + 12.7, *f, *p]).collect();
    for (text, reason) in [
        (
            plain.replacen("force_n", "forse_n", 1),
            "is the column `forse_n` meant to be `force_n`?",
        ),
        (
            plain.replacen("force_n", "Force", 1),
            "the column `Force` has no unit",
        ),
        (
            plain.replacen("force_n", "Force (MN)", 1),
            "`MN` of the column `Force (MN)` is no unit of the force",
        ),
        (
            plain.replacen("pressure_rise_kpa", "force_n", 1),
            "column 2, `force_n`, or column 3, `force_n`, and they differ",
        ),
        (plain.replacen(PLAIN, "", 1), "the first line is all numbers"),
        (
            plain.replacen(PLAIN, "indentation_mm,force_n,absolute pressure (kPa)", 1),
            "is an absolute pressure",
        ),
        (
            "indentation_mm,force_n\n# a comment\n0.5,1\n1,x\n".to_owned(),
            "line 4: `force_n` is `x`",
        ),
        (
            "indentation_mm,force_n\n0.5,1\n1,-1e308\n2,3\n3,4\n".to_owned(),
            "line 3: `force_n` is `-1e308`",
        ),
        (
            "indentation_mm;force_n\n1;1,234\n2;2,345\n3;3,456\n".to_owned(),
            "may have a decimal comma or a group",
        ),
        (
            "a,b,c\n0,1,0,2,0,3\n0,2,0,3,0,4\n".to_owned(),
            "decimal commas and commas between cells",
        ),
        (csv(PLAIN, ",", &stage), "not the stage's position"),
    ] {
        let (ok, answer, notes) = fit(&folder, text.as_bytes(), &[]);
        assert!(!ok && answer.is_empty(), "{reason}");
        let last = notes.lines().last().unwrap_or_default();
        assert!(last.contains(reason), "{notes}");
    }
    let (ok, _, notes) = fit(&folder, csv(PLAIN, ",", &stage).as_bytes(), &[]);
    assert!(
        !ok && !notes.contains("must be a number of at least 0"),
        "{notes}"
    );
}

#[test]
fn a_curve_from_data_alone_is_held_against_the_shape_of_the_design_too() {
    let folder = folder("shape");
    let micrometres: Vec<[f64; 3]> = rows().iter().map(|[h, f, p]| [1e3 * h, *f, *p]).collect();
    let data = folder.join("data.csv");
    fs::write(&data, csv(PLAIN, ",", &micrometres)).expect("the data");
    let design = folder.join("tip.toml");
    let line = program::refusal(&[
        "fit",
        design.to_str().expect("text"),
        data.to_str().expect("text"),
        "--from-data",
    ]);
    assert!(line.contains("are these micrometres?"), "{line}");
}

#[test]
fn concave_data_end_soon() {
    let folder = folder("concave");
    let text = "indentation_mm,force_n\n0.1,0.5\n1.0,0.8\n2.0,1.1\n2.4,1.2\n";
    let data = folder.join("data.csv");
    fs::write(&data, text).expect("the data");
    let design = folder.join("tip.toml");
    let begun = std::time::Instant::now();
    let output = designer(&[
        "fit",
        design.to_str().expect("text"),
        data.to_str().expect("text"),
    ]);
    // Without a bound it took minutes of one core; with it less than a second, on a busy machine a few.
    assert!(begun.elapsed().as_secs() < 60, "{:?}", output.status);
}

#[test]
fn a_bias_of_the_force_and_a_clipped_channel_are_told() {
    let folder = folder("told");
    let truth = folder.join("truth.toml");
    fs::write(
        &truth,
        format!("{DESIGN}\n[calibration]\nmaterial_factor = 1.3\n"),
    )
    .expect("the truth");
    let depths: Vec<String> = (1..=25).map(|k| format!("{}", 0.1 * f64::from(k))).collect();
    let (_, solved) = program::header_and_rows(&[
        "solve",
        truth.to_str().expect("text"),
        "--indentation-mm",
        &depths.join(","),
    ]);
    let number = |row: &[String], column: usize| row[column].parse::<f64>().expect("a number");
    // A ripple of 0.2 % stands for noise.
    let bench: Vec<[f64; 3]> = solved
        .iter()
        .enumerate()
        .map(|(k, row)| {
            let ripple = 1.0 + 0.002 * (2.399 * k as f64).sin();
            [number(row, 0), number(row, 3) * ripple, number(row, 2) / ripple]
        })
        .collect();
    let told = |rows: &[[f64; 3]], extra: &[&str]| {
        let (ok, answer, notes) = fit(&folder, csv(PLAIN, ",", rows).as_bytes(), extra);
        assert!(ok, "{notes}");
        (answer, notes)
    };
    let (_, clean) = told(&bench, &[]);
    assert!(
        !clean.contains("looks") && !clean.contains("stands at") && !clean.contains("one sign"),
        "{clean}"
    );
    let biased: Vec<[f64; 3]> = bench.iter().map(|[h, f, p]| [*h, f + 0.5, *p]).collect();
    let (_, notes) = told(&biased, &[]);
    assert!(
        notes.contains("the force looks offset by 0.5") || notes.contains("the force looks offset by 0.4"),
        "{notes}"
    );
    let (answer, _) = told(&biased, &["--fit", "force-offset"]);
    let offset = answer
        .lines()
        .find(|line| line.starts_with("force-offset"))
        .expect("a row");
    let offset: f64 = offset
        .split(',')
        .nth(3)
        .expect("a value")
        .parse()
        .expect("a number");
    assert!((offset - 0.5).abs() < 0.02, "{offset}");
    let swapped: Vec<[f64; 3]> = bench.iter().map(|[h, f, p]| [*h, *p, *f]).collect();
    let (ok, _, notes) = fit(&folder, csv(PLAIN, ",", &swapped).as_bytes(), &[]);
    assert!(!ok && notes.contains("the two columns are swapped"), "{notes}");
    let most = bench[24][1];
    let clipped: Vec<[f64; 3]> = bench
        .iter()
        .map(|[h, f, p]| [*h, f.min(0.4 * most), *p])
        .collect();
    let (answer, notes) = told(&clipped, &[]);
    assert!(notes.contains("the force stands at"), "{notes}");
    let factor: f64 = answer
        .lines()
        .nth(1)
        .expect("a row")
        .split(',')
        .nth(3)
        .expect("a value")
        .parse()
        .expect("a number");
    assert!((factor / 1.3 - 1.0).abs() < 0.01, "{factor}");
}

#[test]
fn nothing_is_written_over_what_was_read_and_no_work_is_done_for_nothing() {
    let folder = folder("over");
    let text = csv(PLAIN, ",", &rows());
    // The data have a name that the fit would write.
    let data = folder.join("residuals.csv");
    fs::write(&data, &text).expect("the data");
    let design = folder.join("tip.toml");
    let paths = [&design, &data, &folder].map(|path| path.to_str().expect("text").to_owned());
    let line = program::refusal(&["fit", &paths[0], &paths[1], "--out", &paths[2]]);
    assert!(
        line.contains("residuals.csv cannot be written: it is what was read"),
        "{line}"
    );
    assert_eq!(fs::read_to_string(&data).expect("there"), text);
    // A file where the folder would have to be.
    for arguments in [
        &["table", &paths[0], "--out", &paths[1]][..],
        &["report", &paths[0], "--out", &paths[1]],
        &["fit", &paths[0], &paths[1], "--out", &paths[1]],
        &["chart", "paper", "--out", &paths[1]],
        &["atlas", "--out", &paths[1]],
        &["ladder", "--out", &paths[1]],
    ] {
        let begun = std::time::Instant::now();
        let line = program::refusal(arguments);
        assert!(line.contains("cannot be written"), "{line}");
        assert!(begun.elapsed().as_secs() < 10, "{arguments:?} worked first");
    }
}

#[test]
fn misspelt_names_and_swapped_axes_are_named() {
    let folder = folder("names");
    assert!(program::refusal(&["slove", "x"]).contains("'solve'"));
    let swapped = DESIGN.replace("radial_semi_axis_mm = 8.5", "radial_semi_axis_mm = 6.5");
    let swapped = swapped.replace(
        "axial_semi_axis_mm = 6.5\nthick",
        "axial_semi_axis_mm = 8.5\nthick",
    );
    let path = folder.join("swapped.toml");
    fs::write(&path, swapped).expect("a design");
    let output = designer(&["rest", path.to_str().expect("text")]);
    assert!(String::from_utf8_lossy(&output.stderr).contains("are the two swapped?"));
    // A refusal is one line alone.
    let deep = program::refusal(&["solve", path.to_str().expect("text"), "--indentation-mm", "50"]);
    assert!(
        deep.contains("50 mm") && !deep.contains("are the two swapped"),
        "{deep}"
    );
    let misspelt = folder.join("misspelt.toml");
    fs::write(&misspelt, DESIGN.replace("thickness_mm", "thicknes_mm")).expect("a design");
    let line = program::refusal(&["rest", misspelt.to_str().expect("text")]);
    assert!(
        line.contains("`membrane.thicknes_mm` is not a known key, did you mean `thickness_mm`?"),
        "{line}"
    );
}

/// Rows of depth, force and pressure rise as other programs export them, read as the plain file is.
#[test]
#[expect(clippy::too_many_lines, reason = "a list of files")]
fn exports_of_test_machines_and_loggers_are_read() {
    let folder = folder("exports");
    let rows = rows();
    let (_, plain, _) = fit(&folder, csv(PLAIN, ",", &rows).as_bytes(), &[]);
    let (_, two, _) = fit(
        &folder,
        csv(
            PLAIN,
            ",",
            &rows
                .iter()
                .map(|[h, f, _]| [*h, *f, f64::NAN])
                .collect::<Vec<_>>(),
        )
        .as_bytes(),
        &[],
    );
    let factor = |answer: &str| -> f64 {
        let cell = answer.lines().nth(1).and_then(|line| line.split(',').nth(3));
        cell.and_then(|cell| cell.parse().ok()).unwrap_or(f64::NAN)
    };
    let lines = |line: &dyn Fn(usize, [f64; 3]) -> String| -> String {
        rows.iter().enumerate().map(|(k, row)| line(k, *row)).collect()
    };
    let comma = |text: String| text.replace('.', ",");
    let with_pressure =
        |head: &str, line: &dyn Fn(usize, [f64; 3]) -> String| (format!("{head}{}", lines(line)), true);
    let without =
        |head: &str, line: &dyn Fn(usize, [f64; 3]) -> String| (format!("{head}{}", lines(line)), false);
    let grouped = |value: f64, group: char, mark: char| -> String {
        let text = format!("{value:.3}");
        let (whole, part) = text.split_once('.').expect("decimals");
        let split = whole.len().saturating_sub(3);
        let group = if split > 0 {
            group.to_string()
        } else {
            String::new()
        };
        format!("{}{group}{}{mark}{part}", &whole[..split], &whole[split..])
    };
    for ((text, pressure), note) in [
        (
            without(
                "Mark,M5\nCapacity,50\nRate,100,Hz\nReading,Travel (mm),Load (N)\n",
                &|k, [h, f, _]| format!("{k},{h:.6},{f:.6}\n"),
            ),
            "the 3 lines before the header",
        ),
        (
            without(
                "\"Specimen label\",\"tip 1\"\n\n\"Time\",\"Extension\",\"Load\"\n\"(s)\",\"(mm)\",\"(N)\"\n",
                &|k, [h, f, _]| format!("\"{k}\",\"-{h:.6}\",\"-{f:.6}\"\n"),
            ),
            "its sign was turned",
        ),
        (
            without(
                "Results\n,Maximum Load (N),Modulus (MPa)\n1,10.3,0.5\nMean,10.3,0.5\n\nTime (s),Extension (mm),Load (kN)\n",
                &|k, [h, f, _]| format!("{k},{h:.6},{:.9}\n", f / 1e3),
            ),
            "`Load (kN)` is taken as the force, in kN",
        ),
        (
            without(
                "\"Vorkraft\";0,05;\"N\"\n\"Pr\u{fc}fzeit\";\"Standardweg\";\"Standardkraft\"\n\"s\";\"mm\";\"N\"\n",
                &|k, [h, f, _]| comma(format!("{k};{h:.6};{f:.6}\n")),
            ),
            "`Standardkraft` is taken as the force, in N",
        ),
        (
            without(
                "MTS793|MPT|ENU|1|2\nStation Name: a.cfg\nAxial Displacement\tAxial Force\tRunning Time\nmm\tN\tsec\n",
                &|k, [h, f, _]| format!("{h:.6}\t{f:.6}\t{k}\n"),
            ),
            "`Axial Force`",
        ),
        (
            with_pressure(
                "Channels\t3\t\t\nSamples\t25\t25\t25\n***End***\t\t\t\nDepth (mm)\tForce (N)\tPressure (kPa)\tComment\n",
                &|_, [h, f, p]| format!("{h:.6}\t{f:.6}\t{p:.6}\t\n"),
            ),
            "the 3 lines before the header",
        ),
        (
            with_pressure(
                "# run 7\n# indentation_mm,force_n,pressure_rise_kpa\n",
                &|_, [h, f, p]| format!("{h:.6},{f:.6},{p:.6}\n"),
            ),
            "the names of the columns are those of the comment",
        ),
        (
            with_pressure("indentation_mm,force_n,pressure_rise_kpa\n", &|_, [h, f, p]| {
                format!("{h:.6},{f:.6},{p:.6},\n")
            }),
            "",
        ),
        (
            with_pressure("Tiefe (\u{b5}m);Kraft (mN);Druck (Pa)\n", &|_, row| {
                let [h, f, p] = row.map(|value| grouped(1e3 * value, '\'', '.'));
                format!("{h};{f};{p}\n")
            }),
            "`Kraft (mN)` is taken as the force",
        ),
        (
            with_pressure("Depth (um);Force (mN);Pressure (Pa)\n", &|_, row| {
                let [h, f, p] = row.map(|value| grouped(1e3 * value, '\u{202f}', ','));
                format!("{h};{f};{p}\n")
            }),
            "decimal commas",
        ),
        (
            with_pressure("Depth (mm);Force (N);Pressure (bar(g))\n", &|_, [h, f, p]| {
                format!("{h:.6};{f:.6};{:.9}\n", p / 100.0)
            }),
            "`Pressure (bar(g))`",
        ),
        (
            with_pressure(
                "Depth (mm);Force (N);Pressure (kgf/cm\u{b2})\n",
                &|_, [h, f, p]| format!("{h:.6};{f:.6};{:.9}\n", p / 98.0665),
            ),
            "`Pressure (kgf/cm\u{b2})`",
        ),
        (
            with_pressure(
                "\"Depth\n(mm)\",\"Force\n(N)\",\"Pressure\n(kPa)\"\n",
                &|_, [h, f, p]| format!("{h:.5}D+00,{f:.6},{p:.6}\n"),
            ),
            "`Pressure (kPa)` is taken",
        ),
        (
            {
                let (text, pressure) =
                    with_pressure("indentation_mm,force_n,pressure_rise_kpa\n", &|k, [h, f, p]| {
                        let again = if k == 12 {
                            "indentation_mm,force_n,pressure_rise_kpa\n"
                        } else {
                            ""
                        };
                        format!("{again}{h:.6},{f:.6},{p:.6}\n")
                    });
                (text + "\0\0\0\0\0\0", pressure)
            },
            "6 zero bytes at the end",
        ),
    ] {
        let (ok, answer, notes) = fit(&folder, text.as_bytes(), &[]);
        assert!(ok, "{text}: {notes}");
        let right = factor(if pressure { &plain } else { &two });
        assert!(
            (factor(&answer) / right - 1.0).abs() < 1e-3,
            "{text}: {answer} for {right}"
        );
        assert!(notes.contains(note), "{note}: {notes}");
        assert!(notes.lines().all(|line| line.contains(": ")), "{notes}");
    }
}

#[test]
fn what_is_no_reading_or_no_table_is_refused_by_its_true_name() {
    let folder = folder("true-names");
    let rows = rows();
    let plain = csv(PLAIN, ",", &rows);
    let scaled = |a: f64, b: f64, c: f64, d: f64| -> Vec<[f64; 3]> {
        rows.iter().map(|[h, f, p]| [a * h, b * f, c * p + d]).collect()
    };
    let column = |k: usize| {
        let cells: Vec<String> = rows.iter().map(|row| format!(",{:.4}", row[k])).collect();
        cells.concat()
    };
    for (text, reason) in [
        (
            csv(
                "indentation_mm,force_n,Pressure (mbar abs)",
                ",",
                &scaled(1.0, 1.0, 10.0, 1013.0),
            ),
            "`Pressure (mbar abs)` is an absolute pressure",
        ),
        (
            csv(
                "indentation_mm,force_n,Pressure (psia)",
                ",",
                &scaled(1.0, 1.0, 0.145, 14.7),
            ),
            "`Pressure (psia)` is an absolute pressure",
        ),
        (
            csv(
                "indentation_mm,force_n,pressure_kpa",
                ",",
                &scaled(1.0, 1.0, 1.0, 101.3),
            ),
            "as much as the pressure of the air",
        ),
        (
            csv(PLAIN, ",", &scaled(1.0, 1.0, -1.0, 0.0)),
            "`pressure_rise_kpa` falls as it should grow with `indentation_mm`",
        ),
        (
            csv(PLAIN, ",", &scaled(1.0 / 25.4, 1.0, 1.0, 0.0)),
            "is the indentation in inches, cm or m",
        ),
        (
            plain.replacen("0.300000,", "-9999,", 1),
            "is `-9999`: must be a reading: nines far from all others",
        ),
        (
            format!(
                "indentation_mm{}\nforce_n{}\npressure_rise_kpa{}\n",
                column(0),
                column(1),
                column(2)
            ),
            "turn rows into columns",
        ),
        (
            "[{\"indentation_mm\": 0.1, \"force_n\": 0.01}]".to_owned(),
            "is JSON",
        ),
        (
            "<html><table><tr><td>1</td></tr></table></html>".to_owned(),
            "is HTML or XML",
        ),
        (
            rows.iter()
                .fold("Depth,Force,Pressure\n".to_owned(), |text, [h, f, p]| {
                    text + &format!("{h:.3} mm,{f:.4} N,{p:.4} kPa\n")
                }),
            "has no unit",
        ),
    ] {
        let (ok, answer, notes) = fit(&folder, text.as_bytes(), &[]);
        assert!(!ok && answer.is_empty(), "{reason}: {notes}");
        let last = notes.lines().last().unwrap_or_default();
        assert!(last.contains(reason), "{reason}: {notes}");
    }
    let (ok, _, notes) = fit(&folder, plain.as_bytes(), &["--direction", "unloading"]);
    assert!(
        !ok && notes.contains("none of the 25 rows is what --direction asks for"),
        "{notes}"
    );
    let (ok, _, notes) = fit(&folder, plain.as_bytes(), &["--only", "force_n=99"]);
    assert!(
        !ok && notes.contains("is what --only force_n=99 asks for"),
        "{notes}"
    );
    // `1.#QNAN` is a missing number, and not 1.
    let missing = plain.replacen("0.300000,", "1.#QNAN,", 1);
    let (ok, _, notes) = fit(&folder, missing.as_bytes(), &[]);
    assert!(ok, "{notes}");
    let (_, _, notes) = fit(
        &folder,
        csv("Z position (mm),force_n,pressure_rise_kpa", ",", &rows).as_bytes(),
        &[],
    );
    assert!(notes.contains("--columns indentation_mm=1"), "{notes}");
}

/// CPU seconds in the last line of the shell's `times`: `0m1.20s 0m0.03s`.
#[cfg(target_os = "linux")]
fn cpu_of_children(times: &str) -> f64 {
    let part = |text: &str| -> f64 {
        let (minutes, seconds) = text.trim_end_matches('s').split_once('m').expect("minutes");
        60.0 * minutes.parse::<f64>().expect("a number") + seconds.parse::<f64>().expect("a number")
    };
    let last = times.trim_end().lines().last().expect("two lines");
    last.split_whitespace().map(part).sum()
}

#[cfg(target_os = "linux")]
#[test]
fn a_thousand_rows_end_in_time_and_tell_their_progress_in_a_pipe() {
    let folder = folder("thousand");
    let mut text = format!("{PLAIN}\n");
    for k in 1..=1000 {
        let h = 0.0025 * f64::from(k);
        let ripple = 1.0 + 0.01 * (2.399 * f64::from(k)).sin();
        let _ = writeln!(
            text,
            "{h:.6},{:.6},{:.6}",
            1.1 * h.powf(2.1) * ripple,
            7.0 * h.powf(1.9) / ripple
        );
    }
    fs::write(folder.join("data.csv"), text).expect("the data");
    let solid = DESIGN.replace("[rest]\npole_stretch = 1.02\n", "[model]\nkind = \"solid\"\n");
    assert_ne!(solid, DESIGN);
    fs::write(folder.join("solid.toml"), solid).expect("a design");
    for (design, most) in [("tip.toml", 20.0), ("solid.toml", 60.0)] {
        let begun = std::time::Instant::now();
        let script = format!(
            "'{}' fit {design} data.csv >answer.csv; echo $?; times",
            env!("CARGO_BIN_EXE_designer")
        );
        let output = std::process::Command::new("sh")
            .current_dir(&folder)
            .args(["-c", &script])
            .output()
            .expect("sh is there");
        let elapsed = begun.elapsed().as_secs_f64();
        let [times, told] =
            [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
        assert!(times.starts_with("0\n"), "{design}: {told}");
        let cpu = cpu_of_children(&times);
        assert!(cpu > 0.0 && cpu < most, "{design}: {cpu} s of CPU");
        // A line a second while it works; reading and the end of the run have none.
        let lines = told
            .lines()
            .filter(|line| line.starts_with("progress: fit: "))
            .count() as f64;
        assert!(
            lines >= 0.5 * elapsed - 2.0,
            "{design}: {lines} lines in {elapsed} s"
        );
    }
}
