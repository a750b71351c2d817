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
