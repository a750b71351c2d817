//! `designer sweep` from outside: rows, refusals, kills, shards, what is refused.

mod killed;
mod program;

use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::record::{Field, Row};
use program::{designer, header_and_rows, refusal};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// An empty folder of its own for a test.
fn scratch(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("the test folder");
    folder
}

/// The base of most spaces here.
const BASE: &str = r#"
[base]
name = "dome"
[base.membrane]
radial_semi_axis_mm = 4.5
axial_semi_axis_mm = 2.7
thickness_mm = 0.3
[base.material]
preset = "agilus30"
[base.rest]
pole_stretch = 1.5
[base.press]
max_indentation_mm = 1.0
"#;

/// Writes a space of [`BASE`]; gives its path.
fn space(folder: &Path, sweep: &str) -> String {
    let path = folder.join("space.toml");
    fs::write(&path, format!("{BASE}\n{sweep}")).expect("the space");
    path.display().to_string()
}

/// The parts of a folder, by name.
fn names(folder: &Path) -> Vec<String> {
    fs::read_dir(folder)
        .expect("the folder")
        .map(|entry| {
            entry
                .expect("an entry")
                .file_name()
                .into_string()
                .expect("a name")
        })
        .filter(|name| name.starts_with("part-"))
        .collect()
}

fn parts(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    names(folder)
        .into_iter()
        .map(|name| (name.clone(), fs::read(folder.join(name)).expect("a part")))
        .collect()
}

/// Every row of a folder, in the order of its parts.
fn rows(folder: &Path) -> Vec<Row> {
    parts(folder)
        .keys()
        .flat_map(|name| {
            let file = fs::File::open(folder.join(name)).expect("a part");
            let reader = SerializedFileReader::new(file).expect("Parquet");
            let rows: Vec<Row> = reader
                .get_row_iter(None)
                .expect("rows")
                .map(|row| row.expect("a row"))
                .collect();
            rows
        })
        .collect()
}

fn cell<'a>(row: &'a Row, name: &str) -> &'a Field {
    row.get_column_iter()
        .find(|(column, _)| *column == name)
        .unwrap_or_else(|| panic!("no column {name}"))
        .1
}

fn number(row: &Row, name: &str) -> f64 {
    match cell(row, name) {
        Field::Double(number) => *number,
        Field::Long(number) => *number as f64,
        other => panic!("{name} is {other}"),
    }
}

fn text<'a>(row: &'a Row, name: &str) -> &'a str {
    match cell(row, name) {
        Field::Str(text) => text,
        other => panic!("{name} is {other}"),
    }
}

fn list(row: &Row, name: &str) -> Vec<f64> {
    match cell(row, name) {
        Field::ListInternal(list) => list
            .elements()
            .iter()
            .map(|field| match field {
                Field::Double(number) => *number,
                other => panic!("{name} holds {other}"),
            })
            .collect(),
        other => panic!("{name} is {other}"),
    }
}

fn run(space: &str, out: &Path) -> String {
    let output = designer(&["sweep", space, "--out", &out.display().to_string()]);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{stderr}");
    assert!(stderr.starts_with("progress: "), "{stderr}");
    String::from_utf8(output.stdout).expect("text")
}

#[test]
fn rows_are_what_rest_and_solve_give() {
    let folder = scratch("sweep-rows");
    let space = space(
        &folder,
        r#"
[sweep]
method = "grid"
compute = ["rest", "curve"]
curve_states = 4
[vary]
membrane.thickness_mm = { from = 0.1, to = 0.4, steps = 3, scale = "log" }
"material.preset" = ["agilus30", "ecoflex-00-30"]
"#,
    );
    let out = folder.join("out");
    assert_eq!(
        run(&space, &out),
        "designs,ready_before,computed,refused,parts\n6,0,6,0,1\n"
    );
    let rows = rows(&out);
    assert_eq!(rows.len(), 6);
    for (place, row) in rows.iter().enumerate() {
        assert!((number(row, "design_number") - place as f64).abs() < 1e-9);
        let (thickness, preset) = (number(row, "membrane.thickness_mm"), text(row, "material.preset"));
        // The last key changes fastest; 0.2 is between 0.1 and 0.4 in the logarithm.
        let wanted = [0.1, 0.2, 0.4][place / 2];
        assert!(
            (thickness / wanted - 1.0).abs() < 1e-12,
            "{thickness} for {wanted}"
        );
        assert_eq!(preset, ["agilus30", "ecoflex-00-30"][place % 2]);
        assert_eq!(cell(row, "reason"), &Field::Null);

        let design = folder.join("one.toml");
        let body = BASE
            .replace("[base]", "")
            .replace("base.", "")
            .replace("0.3", &thickness.to_string())
            .replace("\"agilus30\"", &format!("{preset:?}"));
        fs::write(&design, body).expect("a design");
        let design = design.display().to_string();
        let (header, rest) = header_and_rows(&["rest", &design]);
        for (name, value) in header.split(',').zip(&rest[0]) {
            if name == "ends_by" {
                assert_eq!(text(row, name), value);
            } else {
                let value: f64 = value.parse().expect("a number");
                assert!((number(row, name) / value - 1.0).abs() < 1e-8, "{name}");
            }
        }
        let (header, states) = header_and_rows(&["solve", &design, "--indentation-mm", "0.25,0.5,0.75,1"]);
        let column = |name: &str| header.split(',').position(|other| other == name).expect("there");
        for name in [
            "indentation_mm",
            "pressure_rise_kpa",
            "force_n",
            "contact_radius_mm",
            "min_tension_n_per_m",
        ] {
            let swept = list(row, &format!("curve_{name}"));
            assert_eq!(swept.len(), 4);
            for (swept, state) in swept.iter().zip(&states) {
                let value: f64 = state[column(name)].parse().expect("a number");
                assert!((swept / value - 1.0).abs() < 1e-7, "{name}: {swept}, {value}");
            }
        }
        // F = P pi rc^2, whatever the solver does.
        let rest_pressure = number(row, "rest_pressure_kpa");
        for ((rise, force), radius) in list(row, "curve_pressure_rise_kpa")
            .iter()
            .zip(list(row, "curve_force_n"))
            .zip(list(row, "curve_contact_radius_mm"))
        {
            let balance = (rest_pressure + rise) * 1e-3 * core::f64::consts::PI * radius * radius;
            assert!((force / balance - 1.0).abs() < 1e-12, "{force} for {balance}");
        }
    }
}

#[test]
fn a_refused_design_is_a_row_with_the_line_of_its_command() {
    let folder = scratch("sweep-refusals");
    let space = space(
        &folder,
        r#"
[sweep]
method = "grid"
compute = ["rest", "curve"]
curve_states = 2
[vary]
"membrane.thickness_mm" = [0.3, 2.9]
"press.max_indentation_mm" = [1.0, 40.0]
"#,
    );
    let out = folder.join("out");
    run(&space, &out);
    let rows = rows(&out);
    let design = folder.join("one.toml");
    let line = |thickness: &str, arguments: &[&str]| {
        let body = BASE
            .replace("[base]", "")
            .replace("base.", "")
            .replace("0.3", thickness);
        fs::write(&design, body).expect("a design");
        let path = design.display().to_string();
        refusal(&[&arguments[..1], &[path.as_str()], &arguments[1..]].concat())
    };
    // A press that is too deep has its rest state; no wall of that thickness has one.
    assert_eq!(cell(&rows[0], "reason"), &Field::Null);
    let deep = &rows[1];
    assert_eq!(text(deep, "refused_by"), "curve");
    let command = line("0.3", &["solve", "--indentation-mm", "20"]);
    assert!(
        command.trim_end().ends_with(text(deep, "reason")),
        "{command}{}",
        text(deep, "reason")
    );
    assert!(number(deep, "max_indentation_mm") > 1.0);
    assert_eq!(cell(deep, "curve_force_n"), &Field::Null);
    for row in &rows[2..] {
        assert_eq!(text(row, "refused_by"), "design");
        let command = line("2.9", &["rest"]);
        assert!(command.trim_end().ends_with(text(row, "reason")), "{command}");
        assert_eq!(cell(row, "rest_pressure_kpa"), &Field::Null);
    }
}

#[test]
fn tables_come_with_their_errors_and_their_bytes() {
    let folder = scratch("sweep-tables");
    let path = folder.join("space.toml");
    let design = format!(
        "{}/../designs/paper-prestretched.toml",
        env!("CARGO_MANIFEST_DIR")
    );
    let sweep = format!(
        "design = {design:?}\n[sweep]\nmethod = \"grid\"\ncompute = [\"tables\"]\n[vary]\n\"rest.pole_stretch\" = [2.3]\n\
         \"transducer.range_kpa\" = [[0, 400], [0, 200]]\n"
    );
    fs::write(&path, sweep).expect("the space");
    let (space, out) = (path.display().to_string(), folder.join("out"));
    run(&space, &out);
    let rows = rows(&out);
    let tables = folder.join("tables");
    header_and_rows(&["table", &design, "--out", &tables.display().to_string()]);
    match cell(&rows[0], "tables_bin") {
        Field::Bytes(bytes) => {
            let file = fs::read(tables.join("tables.bin")).expect("the tables");
            assert_eq!(bytes.data(), file);
        }
        other => panic!("{other}"),
    }
    // Within what the design asks.
    assert!(number(&rows[0], "table_force_error_percent") <= 0.1);
    assert!(number(&rows[0], "table_indentation_error_percent") <= 0.1);
    // A transducer of half the range does not reach the end of the press.
    assert_eq!(text(&rows[1], "refused_by"), "tables");
    assert!(
        text(&rows[1], "reason").contains("range_kpa"),
        "{}",
        text(&rows[1], "reason")
    );
    assert_eq!(text(&rows[1], "transducer.range_kpa"), "[0, 200]");
}

/// A space whose run takes some seconds.
const LONG: &str = r#"
[sweep]
method = "latin-hypercube"
count = 150
seed = 3
designs_per_part = 7
compute = ["rest", "curve"]
curve_states = 8
[vary]
"membrane.thickness_mm" = { from = 0.1, to = 0.6, scale = "log" }
"rest.pole_stretch" = { from = 1.1, to = 2.2 }
"press.max_indentation_mm" = { from = 0.5, to = 4.5 }
"#;

#[test]
fn shards_share_a_folder_and_make_the_whole() {
    let folder = scratch("sweep-shards");
    let sweep = LONG
        .replace("count = 150", "count = 20")
        .replace("latin-hypercube", "sobol");
    let space = space(&folder, &sweep);
    let (whole, split) = (folder.join("whole"), folder.join("split"));
    run(&space, &whole);
    let out = split.display().to_string();
    let shard = |shard: &str| {
        let (_, rows) = header_and_rows(&["sweep", &space, "--out", &out, "--shard", shard]);
        rows.concat().join(",")
    };
    // Parts of 7, 7 and 6 designs.
    let second = shard("2/2");
    assert!(second.starts_with("7,0,7,") && second.ends_with(",1"), "{second}");
    assert_eq!(parts(&split).len(), 1);
    assert!(shard("1/2").starts_with("13,0,13,"));
    assert!(shard("1/2").starts_with("13,13,0,0,2"));
    assert_eq!(shard("4/9"), "0,0,0,0,0");
    assert_eq!(parts(&split), parts(&whole));
}

#[test]
fn a_folder_of_another_sweep_is_refused() {
    let folder = scratch("sweep-another");
    let sweep = LONG.replace("count = 150", "count = 3");
    let path = space(&folder, &sweep);
    let out = folder.join("out").display().to_string();
    run(&path, &folder.join("out"));
    // A comment is no other sweep.
    space(&folder, &sweep.replace("seed = 3", "seed = 3 # the third"));
    run(&path, &folder.join("out"));
    for change in [
        ("seed = 3", "seed = 4"),
        ("to = 2.2", "to = 2.3"),
        ("\"rest\", ", ""),
    ] {
        space(&folder, &sweep.replace(change.0, change.1));
        let line = refusal(&["sweep", &path, "--out", &out]);
        assert!(line.contains("another sweep: found space_sha256"), "{line}");
        assert!(line.contains("choose another --out"), "{line}");
    }
    space(&folder, &sweep);
    fs::write(folder.join("out").join("part-00000.parquet"), "PAR1").expect("spoilt");
    let line = designer(&["sweep", &path, "--out", &out]);
    let line = String::from_utf8_lossy(&line.stderr).into_owned();
    assert!(line.contains("must hold 3 rows; delete it"), "{line}");
}

#[test]
fn a_bad_space_gets_one_line() {
    let folder = scratch("sweep-bad");
    let good = LONG.replace("count = 150", "count = 2");
    let out = folder.join("out").display().to_string();
    for (change, to, expected) in [
        (
            "latin-hypercube",
            "sobel",
            "`sweep.method` is \"sobel\": must be \"grid\",",
        ),
        ("count = 2\n", "", "`sweep.count` is missing"),
        (
            "count = 2",
            "count = 2.5",
            "`sweep.count` is 2.5: must be a whole number",
        ),
        ("\"rest\", ", "\"rests\", ", "must be one or more of \"rest\""),
        (
            "to = 2.2",
            "to = 1.0",
            "`vary.rest.pole_stretch.to` is 1: must be more than from, 1.1",
        ),
        (
            "to = 2.2",
            "to = 2.2, step = 4",
            "`vary.rest.pole_stretch.step` is not a known key, did you mean `steps`?",
        ),
        (
            "to = 2.2",
            "to = 2.2, steps = 4",
            "must be left out: only a grid has steps",
        ),
        (
            "from = 0.1,",
            "from = 0.0,",
            "`vary.membrane.thickness_mm.from` is 0: must be above 0",
        ),
        (
            "membrane.thickness_mm",
            "membrane.thicknes_mm",
            "`vary.membrane.thicknes_mm` is not a known key, did you mean",
        ),
        (
            "{ from = 1.1, to = 2.2 }",
            "1.1",
            "`vary.rest.pole_stretch` is 1.1: must be a list of values",
        ),
        ("{ from = 1.1, to = 2.2 }", "[]", "a list with one value at least"),
        ("designs_per_part = 7", "designs_per_part = 900000", "at most"),
        (
            "compute = [\"rest\", \"curve\"]\ncurve_states = 8",
            "compute = [\"tables\"]",
            "`[transducer]` is missing",
        ),
        ("[sweep]", "[base.prss]\n[sweep]", "`prss` is not a known key"),
        (
            "[sweep]",
            "[sweeps]\n[sweep]",
            "`sweeps` is not a known key, did you mean `sweep`?",
        ),
    ] {
        assert!(good.contains(change), "{change}");
        let path = space(&folder, &good.replace(change, to));
        let line = refusal(&["sweep", &path, "--out", &out]);
        assert!(line.contains(expected), "{line}for {expected}");
        assert!(!folder.join("out").exists(), "{line}");
    }
    let path = space(&folder, &good);
    let line = refusal(&["sweep", &path, "--out", &out, "--shard", "3/2"]);
    assert!(line.contains("--shard") && line.contains("1 <= I <= N"), "{line}");
}
