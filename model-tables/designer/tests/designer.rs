//! The `designer` binary from outside: columns, values, errors, exit status, files.

mod program;

use program::{designer, header_and_rows, refusal};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

fn shipped(name: &str) -> String {
    format!("{}/../designs/{name}.toml", env!("CARGO_MANIFEST_DIR"))
}

fn near(text: &str, truth: f64, tolerance: f64) {
    let number: f64 = text.parse().expect("a number");
    assert!((number / truth - 1.0).abs() < tolerance, "{number} for {truth}");
}

/// An empty folder of its own for a test.
fn scratch(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("the test folder");
    folder
}

#[test]
fn rest_gives_the_reference_state_and_its_limit() {
    let (header, rows) = header_and_rows(&["rest", &shipped("paper-prestretched")]);
    assert_eq!(
        header,
        "rest_pressure_kpa,pole_stretch,equator_radius_mm,height_mm,volume_mm3,max_indentation_mm,ends_by"
    );
    // Independent reference: collocation cross-checked by shooting.
    let reference = [
        179.061_844_088_872,
        2.3,
        8.575_201_058_739,
        8.081_810_613_014,
        1_242.150_374_427,
        4.166_107_072,
    ];
    for (text, truth) in rows[0].iter().zip(reference) {
        near(text, truth, 1e-8);
    }
    assert_eq!(rows[0][6], "bulge-touches-base");
}

#[test]
fn solve_gives_reference_states_in_the_order_asked() {
    let design = shipped("paper-prestretched");
    let (header, rows) =
        header_and_rows(&["solve", &design, "--indentation-mm", "2.083053536,0.208305354,0"]);
    assert_eq!(
        header,
        "indentation_mm,pressure_kpa,pressure_rise_kpa,force_n,contact_radius_mm,contact_area_mm2,pole_stretch,\
         edge_angle_deg,min_tension_n_per_m,wrinkled"
    );
    for (row, pressure, force) in [
        (&rows[0], 245.419_207_392_746, 16.492_035_788_469),
        (&rows[1], 181.027_546_477_086, 0.459_166_627_275),
    ] {
        near(&row[1], pressure, 1e-7);
        near(&row[3], force, 1e-6);
        // F = P pi rc^2.
        let [pressure, radius] = [1, 4].map(|i| row[i].parse::<f64>().expect("a number"));
        near(
            &row[3],
            pressure * 1e-3 * core::f64::consts::PI * radius * radius,
            1e-12,
        );
        assert_eq!(row[9], "no");
    }
    near(&rows[2][1], 179.061_844_088_872, 1e-9);
    assert!(rows[2][3].parse::<f64>().expect("a number").abs() < 1e-300);
}

#[test]
fn profile_is_the_state_that_solve_gives() {
    let design = shipped("paper-prestretched");
    let (header, rows) = header_and_rows(&[
        "profile",
        &design,
        "--indentation-mm",
        "2.083053536",
        "--points",
        "41",
    ]);
    assert_eq!(
        header,
        "parameter_rad,radius_mm,height_mm,meridional_stretch,hoop_stretch,meridional_tension_n_per_m,\
         hoop_tension_n_per_m,angle_deg,zone,wrinkled"
    );
    assert_eq!(rows.len(), 41);
    let number = |row: usize, column: usize| rows[row][column].parse::<f64>().expect("a number");
    // The independent reference: height at rest less the indentation, and the edge held at its rest radius.
    near(&rows[0][2], 8.081_810_613_014 - 2.083_053_536, 1e-9);
    near(&rows[40][1], 8.575_201_058_739, 1e-9);
    assert!(number(0, 1).abs() < 1e-300 && number(40, 2).abs() < 1e-11);
    near(&rows[40][0], core::f64::consts::FRAC_PI_2, 1e-14);
    // F = P pi rc^2 at the last point under the plate.
    let edge = rows
        .iter()
        .rposition(|row| row[8] == "contact")
        .expect("a contact");
    let radius = number(edge, 1);
    near(
        &(245.419_207_392_746e-3 * core::f64::consts::PI * radius * radius).to_string(),
        16.492_035_788_469,
        1e-6,
    );
    assert!(rows[edge + 1..].iter().all(|row| row[8] == "free"));
    assert!(rows.iter().all(|row| row[9] == "no"));

    let (_, rest) = header_and_rows(&["profile", &design, "--indentation-mm", "0"]);
    assert_eq!(rest.len(), 101);
    assert!(rest.iter().all(|row| row[8] == "free"));
    near(&rest[0][2], 8.081_810_613_014, 1e-9);
    near(&rest[100][7], 90.0, 1e-9);
}

#[test]
fn actuator_has_the_values_worked_by_hand() {
    let (header, rows) = header_and_rows(&[
        "actuator",
        &shipped("index-fingertip-elastic"),
        "--pressure-kpa",
        "0,17.9,17.935",
    ]);
    assert_eq!(
        header,
        "pressure_kpa,contact_diameter_mm,blocked_force_n,volume_change_mm3"
    );
    // d_f = 9 mm, E = 1241.484 kPa: d = 9 mm / (1 - P/E).
    near(&rows[0][1], 9.0, 1e-14);
    near(&rows[1][1], 9.131_662, 1e-6);
    near(&rows[1][2], 1.172_31, 1e-5);
    near(&rows[2][3], 1.8248, 1e-4);
}

#[test]
fn actuator_takes_its_diameter_from_the_design() {
    let folder = scratch("actuator");
    let file = folder.join("wide.toml");
    let text = fs::read_to_string(shipped("index-fingertip-elastic")).expect("the design");
    fs::write(&file, text + "\n[actuator]\ndiameter_mm = 18.0\n").expect("written");
    let (_, rows) = header_and_rows(&[
        "actuator",
        file.to_str().expect("utf-8"),
        "--pressure-kpa",
        "17.9",
    ]);
    // Twice the diameter, four times the force of 9 mm.
    near(&rows[0][2], 4.0 * 1.172_31, 1e-5);
}

#[test]
fn published_writes_the_page_of_this_crate() {
    let out = scratch("published").join("PUBLISHED.md");
    let (header, rows) = header_and_rows(&["published", "--out", out.to_str().expect("utf-8")]);
    assert_eq!(header, "quantity,published,here,ratio");
    // The independent reference again.
    assert_eq!(rows[0][0], "rest_pressure_kpa");
    near(&rows[0][2], 179.061_844_088_872, 1e-9);
    let written = fs::read_to_string(&out).expect("the page");
    let mut now = written.lines();
    for line in include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../PUBLISHED.md")).lines() {
        assert_eq!(
            Some(line),
            now.next(),
            "the page is stale: run `cargo designer published --out model-tables/PUBLISHED.md`"
        );
    }
    assert_eq!(now.next(), None, "the page is stale");
}

#[test]
fn solve_knows_both_tension_fields() {
    let folder = scratch("wrinkled");
    let file = folder.join("oblate.toml");
    let text = fs::read_to_string(shipped("skin-analogue"))
        .expect("the design")
        .replace("kind = \"auto\"", "kind = \"membrane\"")
        .replace("axial_semi_axis_mm = 7.0", "axial_semi_axis_mm = 4.05")
        .replace("pole_stretch = 1.1", "pole_stretch = 1.05")
        .replace("c1_pa = 13400.0", "c1_pa = 160355.0")
        .replace("c2_pa = 29500.0", "c2_pa = 46559.0");
    fs::write(&file, text).expect("written");
    let at = |field: &str| {
        let arguments = [
            "solve",
            file.to_str().expect("utf-8"),
            "--indentation-mm",
            "0.5",
            "--tension-field",
            field,
        ];
        header_and_rows(&arguments).1[0].clone()
    };
    // Rest pressures of the two differ: 17919 Pa relaxed, 17659 Pa plain (9 x 4.05 mm at 1.05).
    let (relaxed, plain) = (at("relaxed"), at("plain"));
    assert_eq!(relaxed[9], "wrinkled");
    assert_eq!(plain[9], "wrinkled");
    let force = |row: &[String]| row[3].parse::<f64>().expect("a number");
    assert!(force(&relaxed) < 0.98 * force(&plain));
}

#[test]
fn numbers_have_twelve_significant_digits() {
    let (_, rows) = header_and_rows(&["rest", &shipped("skin-analogue")]);
    for text in &rows[0][..6] {
        let digits = text
            .trim_start_matches(['0', '.'])
            .chars()
            .filter(char::is_ascii_digit)
            .count();
        assert!(digits >= 12, "{text}");
    }
}

#[test]
fn estimate_agrees_with_the_model_and_flags_both_ends() {
    let design = shipped("index-fingertip-elastic");
    let (_, solved) = header_and_rows(&["solve", &design, "--indentation-mm", "0.3,1.0,2.4"]);
    let rises: Vec<f64> = solved
        .iter()
        .map(|row| 1e3 * row[2].parse::<f64>().expect("a number"))
        .collect();
    // The transducer tells 10 Pa apart: eight times that below zero is noise still.
    let list = format!("{},{},{},1e6,-5,-79,-81,-1e12", rises[0], rises[1], rises[2]);
    let (header, rows) = header_and_rows(&["estimate", &design, "--pressure-rise-pa", &list]);
    assert_eq!(header, "pressure_rise_pa,force_n,indentation_mm,status");
    for (row, solved) in rows.iter().zip(&solved) {
        near(&row[1], solved[3].parse().expect("a number"), 1.2e-3);
        near(&row[2], solved[0].parse().expect("a number"), 1.2e-3);
        assert_eq!(row[3], "ok");
    }
    assert_eq!(rows[3][3], "warning: saturated");
    // The last input is the next round number: up to 1/64 more of pressure, which is less of indentation.
    let held: f64 = rows[3][2].parse().expect("a number");
    assert!((2.4975..2.5 * (1.0 + 1.0 / 64.0)).contains(&held), "{held}");
    assert_eq!([&rows[4][3], &rows[5][3]], ["ok", "ok"]);
    assert_eq!([&rows[6][3], &rows[7][3]], ["warning: below zero"; 2]);
}

#[test]
fn table_writes_four_files_and_the_same_ones_again() {
    let folder = scratch("tables");
    let run = |name: &str| {
        let out = folder.join(name);
        let (_, rows) = header_and_rows(&[
            "table",
            &shipped("skin-analogue"),
            "--out",
            out.to_str().expect("utf-8"),
        ]);
        assert_eq!(rows.len(), 4);
        let mut files: Vec<_> = fs::read_dir(&out)
            .expect("the folder")
            .map(|entry| entry.expect("an entry").path())
            .collect();
        files.sort();
        files
            .iter()
            .map(|file| {
                let name = file.file_name().expect("a name").to_owned();
                (name, fs::read(file).expect("the file"))
            })
            .collect::<Vec<_>>()
    };
    let first = run("first");
    let names: Vec<_> = first
        .iter()
        .map(|(name, _)| name.to_str().expect("utf-8"))
        .collect();
    assert_eq!(
        names,
        ["certificate.toml", "tables.bin", "tables.csv", "tables.rs"]
    );
    assert_eq!(first, run("second"));
}

#[test]
fn a_refused_table_leaves_nothing_behind() {
    let folder = scratch("refused");
    let file = folder.join("narrow.toml");
    let text = fs::read_to_string(shipped("paper-prestretched"))
        .expect("the design")
        .replace("range_kpa = [0.0, 400.0]", "range_kpa = [0.0, 200.0]");
    fs::write(&file, text).expect("written");
    let out = folder.join("out");
    let line = refusal(&[
        "table",
        file.to_str().expect("utf-8"),
        "--out",
        out.to_str().expect("utf-8"),
    ]);
    assert!(
        line.contains("narrow.toml") && line.contains("kPa above transducer.range_kpa = [0, 200]"),
        "{line}"
    );
    assert!(!out.exists());
}

/// A shipped design with a line of it replaced, in a file.
fn changed(folder: &str, name: &str, from: &str, to: &str) -> String {
    let file = scratch(folder).join("changed.toml");
    let text = fs::read_to_string(shipped(name)).expect("the design");
    assert!(text.contains(from));
    fs::write(&file, text.replace(from, to)).expect("written");
    file.to_str().expect("utf-8").to_owned()
}

/// Half of 200 Pa is 0.4 % of the reading where that is least: more than the 0.1 % asked for.
#[test]
fn an_accuracy_that_is_not_reached_is_refused_unless_worse_is_allowed() {
    let design = changed(
        "worse",
        "skin-analogue",
        "resolution_pa = 5.0",
        "resolution_pa = 200.0",
    );
    let out = scratch("worse_out").join("tables");
    let out = out.to_str().expect("utf-8");
    let table: [&str; 4] = ["table", &design, "--out", out];
    let estimate: [&str; 4] = ["estimate", &design, "--pressure-rise-pa", "2000"];
    for arguments in [&table[..], &estimate[..]] {
        let line = refusal(arguments);
        for part in [
            "[accuracy] asks 0.1 % and 0.1 %, but half of transducer.resolution_pa = 200 is",
            "choose a finer transducer",
            "--allow-worse",
        ] {
            assert!(line.contains(part), "{line}");
        }
    }
    assert!(!fs::exists(out).expect("readable"));
    assert_eq!(
        header_and_rows(&[&table[..], &["--allow-worse"][..]].concat())
            .1
            .len(),
        4
    );
    assert_eq!(
        header_and_rows(&[&estimate[..], &["--allow-worse"][..]].concat()).1[0][3],
        "ok"
    );
}

/// No tables of 16-bit coefficients keep to a hundred-thousandth of the reading; a transducer of 1 mPa would tell it.
#[test]
fn an_accuracy_that_integers_do_not_reach_is_refused_unless_worse_is_allowed() {
    let design = changed(
        "integers",
        "skin-analogue",
        "_percent_of_reading = 0.1",
        "_percent_of_reading = 0.001",
    );
    let text = fs::read_to_string(&design).expect("just written");
    fs::write(
        &design,
        text.replace("resolution_pa = 5.0", "resolution_pa = 0.001"),
    )
    .expect("written");
    let out = scratch("integers_out").join("tables");
    let out = out.to_str().expect("utf-8");
    let table: [&str; 4] = ["table", &design, "--out", out];
    let line = refusal(&table);
    assert!(line.contains("allow"), "{line}");
    assert!(!fs::exists(out).expect("readable"));
    header_and_rows(&[&table[..], &["--allow-worse"][..]].concat());
    let certificate = fs::read_to_string(Path::new(out).join("certificate.toml")).expect("written");
    assert!(
        certificate.contains("asked_percent_of_reading = 0.001"),
        "{certificate}"
    );
    assert!(certificate.contains("held_to = \"integers\""), "{certificate}");
}

/// The whole press of 8.1 kPa stays within eight times 2 kPa.
#[test]
fn a_press_that_the_transducer_cannot_feel_is_refused() {
    let design = changed(
        "unfelt",
        "skin-analogue",
        "resolution_pa = 5.0",
        "resolution_pa = 2000.0",
    );
    let out = scratch("unfelt_out").join("tables");
    let folder = out.to_str().expect("utf-8");
    let estimate: [&str; 5] = ["estimate", &design, "--pressure-rise-pa", "2000", "--allow-worse"];
    let table: [&str; 5] = ["table", &design, "--out", folder, "--allow-worse"];
    for arguments in [&estimate[..], &table[..]] {
        let line = refusal(arguments);
        for part in [
            "the whole press raises the pressure by",
            "up to 16000.000 Pa is noise",
            "transducer.resolution_pa = 2000",
            "choose a finer transducer",
        ] {
            assert!(line.contains(part), "{line}");
        }
    }
    assert!(!out.exists());
}

#[test]
fn an_indentation_beyond_the_limit_names_the_limit_and_gives_no_rows() {
    let design = shipped("paper-prestretched");
    let line = refusal(&["solve", &design, "--indentation-mm", "1.0,4.3"]);
    assert!(
        line.contains("4.3 mm is beyond the limit of 4.166107 mm"),
        "{line}"
    );
}

#[test]
fn bad_input_is_one_line() {
    let design = shipped("skin-analogue");
    for (arguments, part) in [
        (
            &["rest", "no-such.toml"][..],
            "no-such.toml: the design file cannot be read",
        ),
        (&["solve", &design][..], "--indentation-mm"),
        (&["solve", &design, "--indentation-mm", "deep"][..], "'deep'"),
        (&["solve", &design, "--indentation-mm", "nan"][..], "'nan'"),
        (
            &["solve", &design, "--indentation-mm", "-1"][..],
            "must be a number of at least 0",
        ),
        (
            &[
                "solve",
                &design,
                "--indentation-mm",
                "1",
                "--tension-field",
                "soft",
            ][..],
            "'soft'",
        ),
        (&["estimate", &design, "--pressure-rise-pa", "inf"][..], "'inf'"),
        (
            &["profile", &design, "--indentation-mm", "99"][..],
            "99 mm is beyond the limit of",
        ),
        (
            &["profile", &design, "--indentation-mm", "1", "--points", "2"][..],
            "2 is not in 3..=10000",
        ),
        // E = 6 (13400 + 29500) Pa.
        (
            &["actuator", &design, "--pressure-kpa", "1,258"][..],
            "skin-analogue.toml: actuator pressure 258 kPa is not below 257.400000 kPa",
        ),
        (
            &["actuator", &design, "--pressure-kpa", "-3"][..],
            "actuator pressure -3 kPa is not possible",
        ),
        (&["rest", &design, "--format", "xml"][..], "'xml'"),
        (&["published", "--out", "/"][..], "does not name a file"),
        (&["press", &design][..], "'press'"),
        (&[][..], "a subcommand is needed: rest, solve, history, profile, "),
    ] {
        let line = refusal(arguments);
        assert!(line.starts_with("error: ") && line.contains(part), "{line}");
    }
}

#[test]
fn a_bad_design_names_file_line_and_key() {
    let folder = scratch("bad");
    let file = folder.join("thin.toml");
    let text = fs::read_to_string(shipped("skin-analogue"))
        .expect("the design")
        .replace("thickness_mm = 1.0", "thickness_mm = -1.0");
    fs::write(&file, text).expect("written");
    for command in [
        &["rest"][..],
        &["solve", "--indentation-mm", "1"][..],
        &["estimate", "--pressure-rise-pa", "1"][..],
    ] {
        let mut arguments = command.to_vec();
        arguments.insert(1, file.to_str().expect("utf-8"));
        let line = refusal(&arguments);
        assert!(
            line.contains("thin.toml:7: `membrane.thickness_mm` is -1.0: must be"),
            "{line}"
        );
    }
}

#[test]
fn json_and_tables_are_printed_on_request() {
    let design = shipped("paper-prestretched");
    let output = designer(&["rest", &design, "--format", "json"]);
    let value: serde_json::Value = serde_json::from_slice(&output.stdout).expect("valid JSON");
    assert!((value[0]["rest_pressure_kpa"].as_f64().expect("a number") - 179.062).abs() < 1e-3);
    let output = designer(&["rest", &design, "--format", "table"]);
    let text = String::from_utf8(output.stdout).expect("text");
    assert!(text.lines().count() == 2 && text.contains("179.061"), "{text}");
}

#[test]
fn chart_writes_what_was_measured() {
    let folder = scratch("chart");
    let out = folder.to_str().expect("text");
    let (_, rows) = header_and_rows(&["chart", "skin", "--out", out]);
    assert_eq!(rows.len(), 5);
    for name in ["speed-accuracy", "ladder"] {
        let svg = fs::read_to_string(folder.join(format!("{name}.svg"))).expect("the chart");
        assert!(
            svg.starts_with("<svg") && svg.ends_with("</svg>\n") && !svg.contains("NaN"),
            "{name}"
        );
    }
    let mut reader = csv::Reader::from_path(folder.join("speed-accuracy.csv")).expect("the data");
    let rows: Vec<csv::StringRecord> = reader.records().map(|row| row.expect("a row")).collect();
    for method in [
        "collocation",
        "shooting",
        "bisection",
        "few-states",
        "closed-form",
    ] {
        assert!(rows.iter().any(|row| &row[1] == method), "{method}");
    }
    for row in rows.iter().filter(|row| &row[1] == "collocation") {
        assert_eq!((&row[6], &row[10]), ("64", "ok"), "{row:?}");
    }
    let reason = refusal(&["chart", "thumb", "--out", out]);
    assert!(reason.contains("thumb"), "{reason}");
}

/// A long membrane of a softening law (Yeoh, `C2` < 0), which its bulge takes beyond the law's stability late in a press.
#[test]
fn an_unstable_law_is_warned_of_on_one_line() {
    let folder = scratch("unstable_law");
    let file = folder.join("design.toml");
    fs::write(
        &file,
        "name = \"bulging\"\n[membrane]\nradial_semi_axis_mm = 8.471570640121309\n\
         axial_semi_axis_mm = 16.148785\nthickness_mm = 0.14780644628159717\n[material]\nlaw = \"yeoh\"\n\
         c1_pa = 13521.914858548498\nc2_pa = -1310.032\nc3_pa = 24.7508\n[rest]\npole_stretch = 1.05716922\n",
    )
    .expect("the design");
    let path = file.to_str().expect("a path");
    let output = designer(&["solve", path, "--indentation-mm", "1,9"]);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{stderr}");
    let warnings: Vec<&str> = stderr
        .lines()
        .filter(|line| !line.starts_with("note: "))
        .collect();
    let [warning] = warnings[..] else {
        panic!("{stderr}");
    };
    assert!(
        warning.starts_with("warning: ") && warning.contains("9 mm the law is not stable"),
        "{stderr}"
    );
    // Nothing to warn of: no line but the notes on its material and on what a membrane leaves out.
    let noted = designer(&["rest", &shipped("paper-prestretched")]).stderr;
    let noted = String::from_utf8_lossy(&noted);
    assert!(
        noted.lines().all(|line| {
            line.starts_with("note: Agilus30")
                || line.starts_with("note: against the solid 2 x 24 of the same wall")
        }),
        "{noted}"
    );
    // No state at all: a refusal that names the stretch, sqrt(C1 / -C2) = 2.
    let text = fs::read_to_string(&file).expect("the design");
    let (before, _) = text.split_once("law = ").expect("a law");
    let law = "law = \"mooney-rivlin\"\nc1_pa = 100000.0\nc2_pa = -25000.0\n[rest]\npole_stretch = 2.3\n";
    let oblate = before.replace("16.148785", "4.0");
    fs::write(&file, format!("{oblate}{law}")).expect("the design");
    let reason = refusal(&["rest", path]);
    assert!(
        reason.contains("stretches of 2.0000 along and 2.0000 around"),
        "{reason}"
    );
}

#[test]
fn atlas_maps_every_method_and_ours_is_never_silently_wrong() {
    let folder = scratch("atlas");
    let out = folder.to_str().expect("text");
    let (header, rows) = header_and_rows(&["atlas", "--stride", "8", "--out", out]);
    assert_eq!(header, "map,method,verdict,cells");
    for map in ["aspect", "indentation", "mooney-rivlin", "yeoh"] {
        for method in ["collocation", "shooting", "bisection"] {
            let cells: usize = rows
                .iter()
                .filter(|row| row[0] == map && row[1] == method)
                .map(|row| row[3].parse::<usize>().expect("a count"))
                .sum();
            assert_eq!(cells, 6, "{map} {method}");
        }
        let svg = fs::read_to_string(folder.join(format!("{map}.svg"))).expect("the map");
        assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n") && !svg.contains("NaN"));
    }
    for row in rows.iter().filter(|row| row[1] == "collocation") {
        assert!(["exact", "no-state"].contains(&row[2].as_str()), "{row:?}");
    }
}

#[test]
fn the_help_of_every_subcommand_ends_with_an_example() {
    let list = String::from_utf8(designer(&["--help"]).stdout).expect("text");
    let names: Vec<&str> = list
        .lines()
        .skip_while(|line| *line != "Commands:")
        .skip(1)
        .take_while(|line| line.starts_with("  "))
        .filter_map(|line| line.split_whitespace().next())
        // The monitor's help is its own program's.
        .filter(|name| !["help", "monitor"].contains(name))
        .collect();
    assert!(names.len() >= 16, "{names:?}");
    for name in names {
        let help = String::from_utf8(designer(&[name, "--help"]).stdout).expect("text");
        assert!(
            help.contains(&format!("cargo designer {name}")),
            "{name}:\n{help}"
        );
    }
}

#[cfg(unix)]
#[test]
fn an_interrupt_leaves_nothing_behind() {
    let out = scratch("interrupted").join("out");
    let target = format!("{}/../targets/human-fingertip.toml", env!("CARGO_MANIFEST_DIR"));
    let mut child = Command::new(env!("CARGO_BIN_EXE_designer"))
        .args(["size", &target, "--out"])
        .arg(&out)
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::null())
        .spawn()
        .expect("the binary runs");
    std::thread::sleep(std::time::Duration::from_millis(300));
    let id = child.id().to_string();
    let sent = Command::new("kill")
        .args(["-INT", &id])
        .status()
        .expect("kill is there");
    assert!(sent.success());
    let status = child.wait().expect("it ends");
    // By its own hand, or by the signal's where that came before it was ready.
    let by_signal = std::os::unix::process::ExitStatusExt::signal(&status) == Some(2);
    assert!(status.code() == Some(130) || by_signal, "{status}");
    assert!(!out.exists());
}

#[test]
fn a_hand_is_refused_with_the_designs_of_its_tips() {
    let hand = format!("{}/../hands/hand.toml", env!("CARGO_MANIFEST_DIR"));
    for command in ["rest", "table"] {
        let out = scratch("hand").display().to_string();
        let arguments: &[&str] = match command {
            "table" => &[command, &hand, "--out", &out],
            _ => &[command, &hand],
        };
        let text = refusal(arguments);
        assert!(
            text.contains("this is a hand") && text.contains(": ../designs/index-fingertip-elastic.toml"),
            "{text}"
        );
    }
}
