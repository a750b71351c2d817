//! The `designer` binary on walls that relax.

mod program;

use program::{designer, header_and_rows, refusal};
use serde_json::Value;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

/// The printed fingertip; `{}` is its series.
const PRINTED: &str = "name = \"printed\"\n\
    [membrane]\nradial_semi_axis_mm = 9\naxial_semi_axis_mm = 7\nthickness_mm = 1\n\
    [material]\npreset = \"agilus30\"\n[material.relaxation]\n{}\n\
    [model]\nkind = \"solid\"\nthrough = 1\nalong = 24\n\
    [press]\nmax_indentation_mm = 2.2\n\
    [transducer]\nkind = \"ratiometric\"\nrange_kpa = [-10, 900]\nresolution_pa = 100\n\
    [accuracy]\nforce_percent_of_reading = 1\nindentation_percent_of_reading = 1\nfrom_percent_of_full_scale = 1\n";
const AGILUS30: &str = "preset = \"agilus30\"";
const NEARLY_ELASTIC: &str = "tau_s = [0.05, 0.5, 5.0]\ng = [0.04, 0.06, 0.05]";

fn write(name: &str, text: &str) -> String {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("time-{name}"));
    fs::write(&path, text).expect("the test folder");
    path.display().to_string()
}

fn design(name: &str, series: &str, more: &str) -> String {
    write(&format!("{name}.toml"), &(PRINTED.replace("{}", series) + more))
}

fn number(text: &str) -> f64 {
    text.parse().expect("a number")
}

/// A press of an independent finite-element code, of the printed fingertip.
struct Case {
    seconds: Vec<f64>,
    indentation: Vec<f64>,
    pressure: Vec<f64>,
    force: Vec<f64>,
}

fn case(id: &str) -> Case {
    let file: Value =
        serde_json::from_str(include_str!("../../tests/reference/relaxation.json")).expect("the file's form");
    let cases = file["cases"].as_array().expect("cases");
    let case = cases.iter().find(|case| case["id"] == id).expect("its case");
    let column = |name: &str| -> Vec<f64> {
        let values = case[name].as_array().expect("a column");
        values.iter().map(|x| x.as_f64().expect("a number")).collect()
    };
    Case {
        seconds: column("t_s"),
        indentation: column("H_mm"),
        pressure: column("P_kPa"),
        force: column("F_N"),
    }
}

impl Case {
    fn row(&self, seconds: f64) -> usize {
        self.seconds.partition_point(|t| *t < seconds)
    }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, f64::max)
}

/// A press of 2 mm in 1 s, a hold of 10 s and a release in 1 s.
#[test]
fn history_gives_a_row_for_a_row_as_an_independent_code_has_it() {
    let case = case("A_AG_R1");
    // Rows where the reference has one, and the plate's turns.
    let places = [0.5, 2.4427, 11.9].map(|seconds| case.row(seconds));
    let [loading, holding, released] = places;
    let mut asked = vec![[0.0, 0.0], [1.0, 2.0], [11.0, 2.0], [12.0, 0.0], [20.0, 0.0]];
    asked.extend(places.map(|i| [case.seconds[i], case.indentation[i]]));
    asked.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut csv = "time_s,indentation_mm\n".to_owned();
    for [seconds, millimetres] in &asked {
        writeln!(csv, "{seconds},{millimetres}").expect("a string");
    }
    let (header, rows) = header_and_rows(&[
        "history",
        &design("press", AGILUS30, ""),
        "--history",
        &write("press.csv", &csv),
    ]);
    assert_eq!(
        header,
        "time_s,indentation_mm,pressure_rise_kpa,force_n,contact,apex_depression_mm"
    );
    assert_eq!(rows.len(), asked.len());
    let most = [largest(&case.pressure), largest(&case.force)];
    for (row, [seconds, millimetres]) in rows.iter().zip(&asked) {
        assert!((number(&row[0]) - seconds).abs() < 1e-9 && (number(&row[1]) - millimetres).abs() < 1e-9);
        let touches = (0.1..11.5).contains(seconds);
        assert_eq!(row[4], if touches { "yes" } else { "no" }, "{row:?}");
        if *seconds > 11.5 {
            assert!(number(&row[2]) < 0.0 && number(&row[3]).abs() < 1e-300, "{row:?}");
            assert!(number(&row[5]) > 0.5, "{row:?}");
        }
    }
    for i in [loading, holding, released] {
        let row = rows
            .iter()
            .find(|row| (number(&row[0]) - case.seconds[i]).abs() < 1e-9);
        let row = row.expect("asked");
        for (found, (truth, most)) in row[2..4]
            .iter()
            .zip([(case.pressure[i], most[0]), (case.force[i], most[1])])
        {
            let error = number(found) - truth;
            // Of the reading too where the wall is pressed.
            let all = if truth > 0.0 { truth } else { most };
            assert!(error.abs() < 0.015 * all, "{row:?}: {truth}");
        }
    }
    // Pushed back to the first touch it recovers.
    let [before, after] = [&rows[rows.len() - 2], &rows[rows.len() - 1]];
    assert!(number(&after[2]) > number(&before[2]) && number(&after[5]) < number(&before[5]));
}

#[test]
fn history_refuses_in_a_line() {
    let printed = design("refusing", AGILUS30, "");
    let rubbed = design("rubbed", AGILUS30, "[object]\nradius_mm = 8\nfriction = 0.3\n");
    let stretched = PRINTED
        .replace("{}", AGILUS30)
        .replace("\"solid\"\nthrough = 1\nalong = 24", "\"membrane\"")
        + "[rest]\npole_stretch = 1.1\n";
    let membrane = write("membrane.toml", &stretched);
    let plain = "time_s,indentation_mm\n0,0\n1,1\n";
    for (name, file, csv, reason) in [
        (
            "pressed",
            &printed,
            "time_s,indentation_mm\n0,0.2\n1,1\n",
            "untouched fingertip",
        ),
        (
            "pushed",
            &printed,
            "time_s,force_n\n0,0.2\n1,1\n",
            "untouched fingertip",
        ),
        (
            "back",
            &printed,
            "time_s,indentation_mm\n0,0\n1,1\n0.5,1\n",
            "line 4: `time_s` is 0.5",
        ),
        (
            "same",
            &printed,
            "time_s,indentation_mm\n0,0\n0,1\n",
            "line 3: `time_s` is 0",
        ),
        (
            "column",
            &printed,
            "time_s,depth\n0,0\n",
            "indentation_mm, force_n",
        ),
        ("timeless", &printed, "indentation_mm\n0\n", "no column `time_s`"),
        (
            "both",
            &printed,
            "time_s,indentation_mm,force_n\n0,0,0\n",
            "leave one of them out",
        ),
        (
            "word",
            &printed,
            "time_s,indentation_mm\n0,0\n1,deep\n",
            "line 3: `indentation_mm` is \"deep\"",
        ),
        ("empty", &printed, "time_s,indentation_mm\n", "no rows"),
        (
            "pulled",
            &printed,
            "time_s,force_n\n0,0\n1,-1\n",
            "a plate does not pull",
        ),
        (
            "deep",
            &printed,
            "time_s,indentation_mm\n0,0\n1,8\n",
            "press less deep",
        ),
        (
            "misspelt",
            &printed,
            "time_s,indentation_mm,Temperatur_C\n0,0,20\n1,1,20\n",
            "did you mean `temperature_c`?",
        ),
        (
            "twice",
            &printed,
            "time_s,indentation_mm,indentation_mm\n0,0,0\n1,1,2\n",
            "columns 2 and 3 are both `indentation_mm`",
        ),
        (
            "unknown",
            &printed,
            "time_s,indentation_mm,speed\n0,0,0\n1,1,2\n",
            "`speed` is no column of rows in time: leave it out",
        ),
        ("membrane", &membrane, plain, "model.kind is \"membrane\""),
        ("rubbed", &rubbed, plain, "without friction"),
    ] {
        let csv = write(&format!("{name}.csv"), csv);
        let text = refusal(&["history", file, "--history", &csv]);
        assert!(text.contains(reason), "{name}: {text}");
    }
    let csv = write("missing.csv", "time_s,depth\n0,0\n");
    let text = refusal(&["estimate", &printed, "--history", &csv]);
    assert!(text.contains("pressure_rise_kpa, pressure_rise_pa"), "{text}");
    let csv = write("plain.csv", "time_s,pressure_rise_pa\n0,0\n1,1\n");
    let text = refusal(&["estimate", &membrane, "--history", &csv]);
    assert!(text.contains("model.kind is \"membrane\""), "{text}");
}

/// A megaton on a fingertip, and a record of thirty years: one line, within a minute of processor time.
#[test]
fn what_has_no_end_is_refused() {
    let printed = design("endless", AGILUS30, "");
    let csv = write("megaton.csv", "time_s,force_n\n0,0\n1,1e6\n");
    let text = refusal(&["history", &printed, "--history", &csv]);
    assert!(text.contains("press less deep"), "{text}");
    let csv = write("decades.csv", "time_s,pressure_rise_kpa\n0,0\n1e9,1\n");
    let text = refusal(&["estimate", &printed, "--history", &csv, "--allow-worse"]);
    assert!(
        text.contains("its rows span 1e9 s") && text.contains("cut the record"),
        "{text}"
    );
}

/// Files and notes of `table`: eight terms of which three relax within a report every 7 ms are fewer on the chip, and Agilus30 at 1 ms is whole.
#[test]
fn table_has_the_fewest_terms_for_accuracy_and_rate() {
    const DENSE: &str =
        "tau_s = [1e-4, 1e-3, 3e-3, 0.01, 0.1, 1, 10, 100]\ng = [400, 100, 40, 20, 5, 2, 1, 0.3]";
    let every_7_ms = PRINTED.replace("{}", DENSE).replace(
        "kind = \"ratiometric\"\nrange_kpa = [-10, 900]",
        "kind = \"ms5837-02ba\"\nrange_kpa = [-8, 90]",
    );
    for (name, file, note, count, certified) in [
        (
            "fewer",
            write("fewer.toml", &every_7_ms),
            "6 of 8 terms of the series are enough for a report every 7 ms: they add 0.07 %",
            "count: 6,",
            true,
        ),
        (
            "whole",
            design("whole", AGILUS30, ""),
            "7 of 7 terms of the series are enough for a report every 1 ms: 6 would add 10.23 %, and [accuracy] allows 1 %",
            "count: 7,",
            false,
        ),
    ] {
        let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("time-terms-{name}"));
        let output = designer(&["table", &file, "--out", &out.display().to_string()]);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success() && stderr.contains(note), "{stderr}");
        let written = |file: &str| fs::read_to_string(out.join(file)).expect("it was written");
        assert!(written("tables.rs").contains(count), "{name}");
        let certificate = written("certificate.toml");
        assert_eq!(
            certificate.contains("terms = 6\nof = 8\n"),
            certified,
            "{certificate}"
        );
    }
}

/// While pressed and held force within 4 % and indentation within 2 % of the largest; from then on no force that pulls, and none where contact
/// is lost.
#[test]
fn estimate_reads_force_and_indentation_from_the_pressure_of_an_independent_code() {
    for (id, end) in [("A_AG_R1", 11.0), ("A_AG_R30", 40.0)] {
        let case = case(id);
        let mut csv = "time_s,pressure_rise_kpa\n".to_owned();
        for (seconds, kilopascals) in case.seconds.iter().zip(&case.pressure) {
            writeln!(csv, "{seconds},{kilopascals}").expect("a string");
        }
        let (header, rows) = header_and_rows(&[
            "estimate",
            &design(id, AGILUS30, ""),
            "--history",
            &write(&format!("{id}.csv"), &csv),
        ]);
        assert_eq!(
            header,
            "time_s,pressure_rise_pa,elastic_pressure_pa,force_n,indentation_mm,status"
        );
        assert_eq!(rows.len(), case.seconds.len());
        let (force, indentation) = (largest(&case.force), largest(&case.indentation));
        let mut recovering = 0;
        for (i, row) in rows.iter().enumerate() {
            let [found, depth] = [number(&row[3]), number(&row[4])];
            assert!(found >= 0.0, "{row:?}");
            if case.seconds[i] <= end {
                assert!(
                    (found - case.force[i]).abs() < 0.04 * force,
                    "{row:?}: {}",
                    case.force[i]
                );
                assert!(
                    (depth - case.indentation[i]).abs() < 0.02 * indentation,
                    "{row:?}"
                );
                assert_eq!(row[5], "ok", "{row:?}");
            } else if case.pressure[i] < 0.0 {
                assert_eq!(row[5], "warning: recovering", "{row:?}");
                assert!(found.abs() < 1e-300, "{row:?}");
                recovering += 1;
            } else {
                assert_eq!(row[5], "ok", "{row:?}");
            }
        }
        assert!(recovering > 20, "{id}: {recovering}");
    }
}

/// A press of an hour leaves what the settled wall bears, against a ball as against a plate.
#[test]
fn a_slow_history_against_a_ball_is_the_press_of_solve() {
    let csv = write("slow.csv", "time_s,indentation_mm\n0,0\n2000,1\n4000,2\n");
    let [on_ball, on_plate] =
        [("ball", "[object]\nradius_mm = 8.0\n"), ("plate", "")].map(|(name, object)| {
            let file = design(name, NEARLY_ELASTIC, object);
            let (_, slow) = header_and_rows(&["history", &file, "--history", &csv]);
            let (_, still) = header_and_rows(&["solve", &file, "--indentation-mm", "1,2"]);
            for (slow, still) in slow[1..].iter().zip(&still) {
                for (slow, still) in [(&slow[2], &still[2]), (&slow[3], &still[3])] {
                    assert!(
                        (number(slow) / number(still) - 1.0).abs() < 0.005,
                        "{slow} {still}"
                    );
                }
            }
            number(&slow[2][3])
        });
    assert!(on_ball < 0.5 * on_plate, "{on_ball} {on_plate} N");
}
