//! `designer actuator` of a disc, and `designer loop`.

mod program;
use program::{header_and_rows, refusal};
use std::fs;
use std::path::Path;

const TIP: &str = "name = \"loop\"\n[membrane]\nradial_semi_axis_mm = 9.0\naxial_semi_axis_mm = 7.0\nthickness_mm = 1.0\n\
    [material]\npreset = \"agilus30\"\n[model]\nkind = \"solid\"\nthrough = 1\nalong = 16\n";

/// The tip with these keys of an actuator, in a file of its own.
fn design(name: &str, actuator: &str) -> String {
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.toml"));
    fs::write(&file, format!("{TIP}[actuator]\n{actuator}")).expect("written");
    file.to_str().expect("utf-8").to_owned()
}

#[test]
fn a_loop_has_the_columns_of_the_contract() {
    let file = design(
        "loop-blocked",
        "diameter_mm = 9.0\nthickness_mm = 1.0\ngap_mm = 0.0\n",
    );
    let (header, rows) = header_and_rows(&["loop", &file, "--indentation-mm", "1.0,0"]);
    assert_eq!(
        header,
        "indentation_mm,pressure_rise_kpa,touch_force_n,feedback_force_n,transmission,actuator_travel_mm,volume_moved_mm3"
    );
    let number = |text: &String| text.parse::<f64>().expect("a number");
    // Held on every side the disc passes the pressure on: kPa times mm^2 is mN.
    let passed_on = number(&rows[0][1]) * core::f64::consts::PI * 4.5 * 4.5 * 1e-3;
    assert!((number(&rows[0][3]) / passed_on - 1.0).abs() < 0.01);
    assert!((number(&rows[0][4]) * number(&rows[0][2]) / number(&rows[0][3]) - 1.0).abs() < 1e-9);
    // Nothing touches yet: there is no ratio.
    assert_eq!(rows[1][4], "");
}

#[test]
fn what_is_no_loop_is_refused_in_one_line() {
    for (name, actuator, told) in [
        ("loop-formula", "diameter_mm = 9\n", "thickness_mm"),
        (
            "loop-gap",
            "diameter_mm = 9\nthickness_mm = 1\ngap_mm = -0.1\n",
            "actuator.gap_mm",
        ),
        (
            "loop-thick",
            "diameter_mm = 9\nthickness_mm = 9.5\n",
            "actuator.thickness_mm",
        ),
        (
            "loop-soft",
            "diameter_mm = 9\nthickness_mm = 0.1\n[actuator.material]\nlaw = \"neo-hookean\"\nc1_pa = 1000\n",
            "do not balance",
        ),
    ] {
        let line = refusal(&["loop", &design(name, actuator), "--indentation-mm", "3"]);
        assert!(line.contains(told), "{line}");
    }
}

/// An elastic loop has no memory: each row in time is the state without time. One that relaxes has more force at once than later.
#[test]
fn a_loop_in_time_has_the_time_before_the_columns_of_the_contract() {
    let keys =
        "diameter_mm = 9.0\nthickness_mm = 1.0\nfoundation_kpa_per_mm = 20.0\ntrapped_air_mm3 = 20.0\n";
    let elastic = design("loop-elastic", keys);
    let relaxing = design(
        "loop-relaxing",
        &format!(
            "{keys}[actuator.material]\npreset = \"agilus30\"\n[actuator.material.relaxation]\ntau_s = [1.0]\ng = [2.0]\n"
        ),
    );
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join("loop-rows.csv");
    fs::write(&file, "time_s,indentation_mm\n0,0\n0.2,1\n20,1\n").expect("written");
    let file = file.to_str().expect("utf-8");
    let (header, rows) = header_and_rows(&["loop", &elastic, "--history", file]);
    assert_eq!(
        header,
        "time_s,indentation_mm,pressure_rise_kpa,touch_force_n,feedback_force_n,transmission,actuator_travel_mm,volume_moved_mm3"
    );
    let (_, settled) = header_and_rows(&["loop", &elastic, "--indentation-mm", "0,1,1"]);
    for (row, settled) in rows.iter().zip(&settled) {
        assert_eq!(&row[2..], &settled[1..]);
    }
    let (_, rows) = header_and_rows(&["loop", &relaxing, "--history", file]);
    let number = |row: &[String], i: usize| row[i].parse::<f64>().expect("a number");
    // The stiffer disc gives way less; in the end it is the settled one.
    assert!(number(&rows[1], 7) < 0.9 * number(&rows[2], 7));
    for i in 2..8 {
        let settled = number(&settled[1], i - 1);
        assert!((number(&rows[2], i) / settled - 1.0).abs() < 2e-3, "{i}");
    }
    assert_eq!(rows[0][5], "");
}

#[test]
fn what_is_no_loop_in_time_is_refused_in_one_line() {
    let good = design("loop-good", "diameter_mm = 9.0\nthickness_mm = 1.0\n");
    let rows = |name: &str, text: &str| {
        let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        fs::write(&file, text).expect("written");
        file.to_str().expect("utf-8").to_owned()
    };
    for (text, told) in [
        ("time_s,indentation_mm\n0,0.5\n1,1\n", "the first row is 0.5"),
        ("time_s,force_n\n0,0\n1,-1\n", "a plate does not pull"),
        (
            "time_s,pressure_rise_kpa\n0,0\n",
            "needs one of the columns indentation_mm, force_n",
        ),
        ("time_s,indentation_mm\n0,0\n0,1\n", "rows follow in time"),
        ("time_s,indentation_mm\n0,0\n1,6.9\n", "time_s = 1"),
    ] {
        let line = refusal(&["loop", &good, "--history", &rows("loop-bad.csv", text)]);
        assert!(line.contains(told), "{line}");
    }
    let file = rows("loop-ok.csv", "time_s,indentation_mm\n0,0\n");
    let line = refusal(&["loop", &good, "--history", &file, "--indentation-mm", "1"]);
    assert!(line.contains("cannot be used with"), "{line}");
}

/// The tables of a loop: what the chip would say is what the loop gives, and a design without has the columns of the contract alone.
#[test]
fn the_chip_tells_the_feedback_force_of_a_loop() {
    let shipped = concat!(env!("CARGO_MANIFEST_DIR"), "/../designs/haptic-loop.toml");
    let (_, states) = header_and_rows(&["loop", shipped, "--indentation-mm", "0.5,2"]);
    let number = |text: &String| text.parse::<f64>().expect("a number");
    let rises: Vec<String> = states
        .iter()
        .map(|state| format!("{}", 1e3 * number(&state[1])))
        .collect();
    let (header, rows) = header_and_rows(&["estimate", shipped, "--pressure-rise-pa", &rises.join(",")]);
    assert_eq!(
        header,
        "pressure_rise_pa,force_n,indentation_mm,status,feedback_force_n"
    );
    for (row, state) in rows.iter().zip(&states) {
        // Touch force, indentation and feedback force.
        for (got, truth) in [(1, 2), (2, 0), (4, 3)] {
            let share = number(&row[got]) / number(&state[truth]) - 1.0;
            assert!(share.abs() < 3e-3, "{row:?} for {state:?}");
        }
    }
    let elastic = concat!(env!("CARGO_MANIFEST_DIR"), "/../designs/paper-prestretched.toml");
    let (header, _) = header_and_rows(&["estimate", elastic, "--pressure-rise-pa", "600"]);
    assert_eq!(header, "pressure_rise_pa,force_n,indentation_mm,status");
}
