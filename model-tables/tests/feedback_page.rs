//! The tables of `FEEDBACK_LOOP.md` are what the loop gives.

use model_tables::design_file::DesignFile;
use model_tables::model::Kind;
use model_tables::model::feedback::{Loop, LoopState};
use model_tables::solid::disc::DISC;
use model_tables::solid::mesh::Elements;

const PAGE: &str = include_str!("../FEEDBACK_LOOP.md");
const TIP: Kind = Kind::Solid(Elements {
    through: 1,
    along: 24,
});
/// Skin of the page's design, as its text has it.
const SKIN: &str = "foundation_kpa_per_mm = 20.0";

/// The page's own design, a part of it replaced.
fn design(from: &str, to: &str) -> DesignFile {
    let text = PAGE
        .split("```toml haptic.toml\n")
        .nth(1)
        .and_then(|rest| rest.split("```").next())
        .expect("the page has the design");
    assert!(text.contains(from), "{from}");
    DesignFile::parse(&text.replace(from, to), "haptic.toml").expect("a design")
}

/// Pressed by 2 mm, and by how many percent a constant compliance is off in the touch.
fn pressed(file: &DesignFile) -> (LoopState, f64) {
    let mut haptic = Loop::of_file(file, TIP, DISC)
        .expect("at rest")
        .expect("an actuator");
    let state = haptic.at_indentation(2e-3).expect("a state");
    let constant = haptic.with_constant_compliance(2e-3).expect("a state");
    (state, 100.0 * (constant.force / state.touch.force - 1.0))
}

/// The cells of the page's rows after a heading of these columns.
fn rows(head: &str) -> Vec<Vec<&'static str>> {
    let mut lines = PAGE.lines().skip_while(|line| !line.starts_with(head));
    assert!(lines.next().is_some(), "{head}");
    lines
        .skip(1)
        .take_while(|line| line.starts_with('|'))
        .map(|line| line.trim_matches('|').split('|').map(str::trim).collect())
        .collect()
}

/// A printed number is a found one but for the unit of its last digit.
fn says(printed: &str, found: f64) {
    let number = printed.trim_end_matches('%').trim_end();
    let value: f64 = number.parse().expect("a number");
    let decimals = number.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    let unit = 0.1_f64.powi(decimals as i32);
    assert!((value - found).abs() <= unit, "{printed} for {found}");
}

#[test]
fn over_diameters_under_skin() {
    let rows = rows("| diameter, mm | pressure rise");
    assert_eq!(rows.len(), 10);
    for row in rows {
        let diameter = row[0].parse().expect("a diameter");
        let (state, constant) = pressed(&design(SKIN, SKIN).with_actuator_diameter(diameter));
        let found = [
            state.touch.pressure_rise * 1e-3,
            state.touch.force,
            state.actuator.force,
            state.transmission().expect("a touch"),
            state.volume_moved * 1e9,
            constant,
        ];
        for (printed, found) in row[1..].iter().zip(found) {
            says(printed, found);
        }
    }
}

#[test]
fn over_diameters_under_a_plate_and_free() {
    let rows = rows("| over the disc | diameter, mm |");
    assert_eq!(rows.len(), 8);
    let mut over = "";
    for row in rows {
        if !row[0].is_empty() {
            over = row[0];
        }
        let to = if over == "nothing" { "" } else { "gap_mm = 0.0" };
        let diameter = row[1].parse().expect("a diameter");
        let (state, constant) = pressed(&design(SKIN, to).with_actuator_diameter(diameter));
        let found = [
            state.touch.force,
            state.actuator.force,
            state.transmission().expect("a touch"),
            constant,
        ];
        for (printed, found) in row[2..].iter().zip(found) {
            says(printed, found);
        }
    }
}

#[test]
fn with_air_in_the_line() {
    let rows = rows("| air, mm^3 |");
    assert_eq!(rows.len(), 5);
    for row in rows {
        let air = format!("trapped_air_mm3 = {}.0", row[0]);
        let (state, constant) = pressed(&design("trapped_air_mm3 = 0.0", &air));
        let found = [
            state.touch.pressure_rise * 1e-3,
            state.touch.force,
            state.actuator.force,
            state.transmission().expect("a touch"),
            constant,
        ];
        for (printed, found) in row[1..].iter().zip(found) {
            says(printed, found);
        }
    }
}
