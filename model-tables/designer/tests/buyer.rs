//! `designer size` asked in a buyer's words, and `solve` at forces, ranges and lists with blanks.

#[path = "program/mod.rs"]
mod program;

use program::{designer, header_and_rows, refusal};
use std::fs;
use std::path::{Path, PathBuf};

fn scratch(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("buyer-{name}"));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// A file in a folder: its path.
fn written(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    fs::write(&path, text).expect("written");
    path.to_str().expect("text").to_owned()
}

fn targets(name: &str) -> String {
    format!("{}/../targets/{name}", env!("CARGO_MANIFEST_DIR"))
}

/// Rows by the names of their columns.
struct Answer(Vec<String>, Vec<Vec<String>>);

impl Answer {
    fn of(arguments: &[&str]) -> Self {
        let (header, rows) = header_and_rows(arguments);
        Self(header.split(',').map(str::to_owned).collect(), rows)
    }

    fn text(&self, row: usize, column: &str) -> &str {
        let k = self.0.iter().position(|name| name == column).expect(column);
        &self.1[row][k]
    }

    fn number(&self, row: usize, column: &str) -> f64 {
        self.text(row, column).parse().expect(column)
    }
}

/// What must hold of every design of an answer, by commands that know nothing of the question: its tables are made, its model reads the
/// greatest force within the range, and at the lightest touch the pressure is six noise floors and the weather.
fn holds(answer: &Answer, out: &Path, name: &str, lightest: f64, greatest: f64, floor: impl Fn(&str) -> f64) {
    assert!(!answer.1.is_empty());
    for row in 0..answer.1.len() {
        let design = out.join(format!("{name}-{}.toml", row + 1));
        let design = design.to_str().expect("text");
        let tables = out.join(format!("tables-{row}"));
        let made = designer(&["table", design, "--out", tables.to_str().expect("text")]);
        assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
        let touch = answer.number(row, "lightest_touch_n");
        assert!(touch <= lightest, "{touch}");
        assert!(answer.number(row, "greatest_force_n") >= greatest);
        let solved = Answer::of(&["solve", design, "--force-n", &format!("{touch},{greatest}")]);
        assert!(solved.number(1, "pressure_kpa") <= answer.number(row, "range_kpa"));
        let peak = answer.number(row, "peak_pressure_kpa") / solved.number(1, "pressure_kpa");
        assert!((peak - 1.0).abs() < 0.03, "{peak}");
        // The tables' accuracy and the model's; a relaxing wall is touched later than a settled one.
        let pascals = 1e3 * solved.number(0, "pressure_rise_kpa") / floor(answer.text(row, "transducer"));
        let relaxes = answer.text(row, "material") == "agilus30";
        // Below a hundredth of the tables' end, their accuracy is a part of the value there.
        let small = 1e-4 * answer.number(row, "accuracy_percent") * answer.number(row, "greatest_force_n");
        let allowed = 0.05_f64.max(small / touch);
        assert!(
            pascals > 1.0 - allowed && (relaxes || pascals < 1.0 + allowed),
            "{pascals}, {allowed}"
        );
    }
}

#[test]
fn a_question_gets_a_design_that_its_own_commands_confirm() {
    let folder = scratch("narrow");
    let file = written(
        &folder,
        "narrow.toml",
        "name = \"narrow\"\n[wanted]\nlightest_touch_n = 0.05\ngreatest_force_n = 15\nreadings_per_second = 200\n\
         [materials]\npresets = [\"sortaclear-40\"]\n[transducers]\nparts = [\"hsc-100kpa\"]\n",
    );
    let out = folder.join("sized");
    let answer = Answer::of(&["size", &file, "--best", "1", "--out", out.to_str().expect("text")]);
    assert_eq!(answer.text(0, "transducer"), "hsc-100kpa");
    assert!(answer.number(0, "readings_per_second") >= 200.0);
    assert!(
        answer.number(0, "radial_semi_axis_mm") <= 9.0001 && answer.number(0, "axial_semi_axis_mm") <= 9.0001
    );
    // Six floors of 30 Pa; a gauge part has no weather.
    holds(&answer, &out, "narrow", 0.05, 15.0, |_| 180.0);
    assert!(answer.number(0, "weather_n").abs() < 1e-12);
}

/// CPU seconds of the children that have ended, by /proc: fields 16 and 17 of `stat`, in hundredths of a second.
#[cfg(target_os = "linux")]
fn seconds_of_children() -> f64 {
    let stat = fs::read_to_string("/proc/self/stat").expect("Linux");
    let after = stat.rsplit(") ").next().expect("fields after the name");
    let field = |k: usize| {
        after
            .split_whitespace()
            .nth(k - 3)
            .and_then(|text| text.parse::<f64>().ok())
    };
    0.01 * (field(16).expect("a number") + field(17).expect("a number"))
}

/// Three sentences of buyers; a minute or so: `cargo test -p designer --test buyer -- --ignored --nocapture`.
#[test]
#[ignore = "takes a minute: the three whole questions"]
#[cfg(target_os = "linux")]
fn three_buyers_are_answered_within_twenty_seconds_of_cpu() {
    let out = scratch("three");
    let folder = out.to_str().expect("text");
    let (egg, boxes) = (targets("egg.toml"), targets("crate.toml"));
    let floors = |part: &str| match part {
        "ms5837-02ba" => 6.0 * 2.8,
        "abp2-34kpa" => 6.0 * 3.5,
        "mpx5100" => 6.0 * 27.0,
        "hsc-100kpa" => 6.0 * 30.0,
        "hsc-250kpa" => 6.0 * 76.0,
        "hsc-400kpa" => 6.0 * 122.0,
        "abp2-100kpa" => 6.0 * 10.0,
        "abp2-400kpa" => 6.0 * 40.0,
        "mpx5500" => 6.0 * 136.0,
        other => panic!("{other}"),
    };
    let readme: &[&str] = &[
        "--lightest-touch-n",
        "0.05",
        "--greatest-force-n",
        "20",
        "--readings-per-second",
        "200",
    ];
    for (name, asked, lightest, greatest) in [
        ("question", readme, 0.05, 20.0),
        ("egg", &[egg.as_str()][..], 0.02, 2.0),
        ("crate", &[boxes.as_str()][..], 0.5, 60.0),
    ] {
        let before = seconds_of_children();
        let mut arguments = vec!["size"];
        arguments.extend(asked);
        arguments.extend(["--out", folder]);
        let answer = Answer::of(&arguments);
        let seconds = seconds_of_children() - before;
        println!("{name}: {seconds:.1} s of CPU, {} designs", answer.1.len());
        assert!(seconds <= 20.0, "{name}: {seconds} s");
        holds(&answer, &out, name, lightest, greatest, floors);
    }
}

#[test]
fn a_question_without_an_answer_is_refused_by_the_nearest_one() {
    let water = refusal(&[
        "size",
        "--lightest-touch-n",
        "0.05",
        "--greatest-force-n",
        "20",
        "--readings-per-second",
        "200",
        "--filling",
        "water",
    ]);
    assert!(
        water.contains("no transducer gives 200 readings a second in water"),
        "{water}"
    );
    assert!(water.contains("ms5837-02ba: 143 readings a second"), "{water}");
    let narrow = |lightest: f64, greatest: f64| {
        let folder = scratch(&format!("refused-{lightest}-{greatest}"));
        let file = folder.join("q.toml");
        let text = format!(
            "name = \"q\"\n[wanted]\nlightest_touch_n = {lightest}\ngreatest_force_n = {greatest}\n\
             [materials]\npresets = [\"sortaclear-40\"]\n[transducers]\nparts = [\"hsc-100kpa\"]\n"
        );
        fs::write(&file, text).expect("written");
        refusal(&["size", file.to_str().expect("text")])
    };
    let light = narrow(0.001, 15.0);
    assert!(
        light.contains("the lightest touch of those that read it is 0.0"),
        "{light}"
    );
    let great = narrow(0.05, 200.0);
    assert!(great.contains("the greatest force is"), "{great}");
    let swapped = refusal(&["size", "--lightest-touch-n", "5", "--greatest-force-n", "2"]);
    assert!(
        swapped.contains("--greatest-force-n 2 is not possible"),
        "{swapped}"
    );
    let comma = refusal(&["size", "--lightest-touch-n", "0,05", "--greatest-force-n", "2"]);
    assert!(comma.contains("0.05"), "{comma}");
}

#[test]
fn lists_are_ranges_or_have_blanks_and_a_decimal_comma_is_doubted() {
    let folder = scratch("lists");
    let design = written(
        &folder,
        "thin.toml",
        "name = \"thin\"\n[membrane]\nradial_semi_axis_mm = 9\naxial_semi_axis_mm = 7\nthickness_mm = 0.3\n\
         [material]\npreset = \"skin\"\n[rest]\npole_stretch = 1.3\n",
    );
    let design = design.as_str();
    let plain = Answer::of(&["solve", design, "--indentation-mm", "0,0.5,1,1.5,2"]);
    for list in ["0:0.5:2", "0, 0.5, 1, 1.5, 2", "0 0.5 1:0.5:2"] {
        let other = Answer::of(&["solve", design, "--indentation-mm", list]);
        assert_eq!(plain.1, other.1, "{list}");
    }
    let doubted = designer(&["solve", design, "--indentation-mm", "0,2"]);
    let note = String::from_utf8_lossy(&doubted.stderr).into_owned();
    assert!(doubted.status.success());
    assert!(
        note.contains("--indentation-mm 0,2 is read as the numbers 0 and 2") && note.contains("0.2"),
        "{note}"
    );
    let single = refusal(&["profile", design, "--indentation-mm", "0,2"]);
    assert!(single.contains("decimal comma"), "{single}");
    let blank = refusal(&["solve", design, "--indentation-mm", "0.2,"]);
    assert!(blank.contains("in quotes"), "{blank}");
}

#[test]
fn a_state_at_a_force_is_the_one_whose_force_it_is() {
    let folder = scratch("forces");
    let design = written(
        &folder,
        "solid.toml",
        "name = \"solid\"\n[membrane]\nradial_semi_axis_mm = 9\naxial_semi_axis_mm = 7\nthickness_mm = 1\n\
         [material]\npreset = \"skin\"\n[model]\nkind = \"solid\"\nthrough = 1\nalong = 24\n",
    );
    let design = design.as_str();
    let at_force = Answer::of(&["solve", design, "--force-n", "0.02,1,0.3"]);
    for (row, force) in [0.02, 1.0, 0.3].into_iter().enumerate() {
        assert!((at_force.number(row, "force_n") / force - 1.0).abs() < 1e-9);
        // The same depth asked as a depth.
        let depth = at_force.text(row, "indentation_mm");
        let at_depth = Answer::of(&["solve", design, "--indentation-mm", depth]);
        assert!(
            (at_depth.number(0, "force_n") / force - 1.0).abs() < 1e-7,
            "{depth}"
        );
    }
    let beyond = refusal(&["solve", design, "--force-n", "1000"]);
    assert!(
        beyond.contains("a force of 1000 N is not possible: the press has 0 to"),
        "{beyond}"
    );
    let both = refusal(&["solve", design, "--force-n", "1", "--indentation-mm", "1"]);
    assert!(both.contains("cannot be used with"), "{both}");
}
