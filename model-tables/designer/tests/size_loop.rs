//! `designer size` of a haptic loop, held to `designer loop` of the designs that it writes.

mod program;
use program::{header_and_rows, refusal};
use std::fs;
use std::path::{Path, PathBuf};

fn scratch(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    folder
}

const TARGET: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../targets/feedback.toml"));

/// The shipped target with all but the actuator's diameter held, and one material.
fn held() -> String {
    let mut text = TARGET.to_owned();
    for (from, to) in [
        ("[7.0, 10.0]", "9.0"),
        ("[5.0, 8.0]", "7.0"),
        ("[0.8, 1.5]", "1.0"),
        ("[0.5, 1.5]", "1.0"),
        ("[\"agilus30\", \"dragon-skin-30\"]", "[\"agilus30\"]"),
        ("air_mm3 = 5.0", "air_mm3 = 500.0"),
    ] {
        assert!(text.contains(from), "{from}");
        text = text.replacen(from, to, 1);
    }
    text
}

#[test]
fn a_sized_loop_has_the_wanted_ratio_when_it_is_solved_again() {
    let folder = scratch("size-loop");
    let target = folder.join("target.toml");
    fs::write(&target, held()).expect("written");
    let out = folder.join("out");
    let words = [target.to_str().expect("utf-8"), out.to_str().expect("utf-8")];
    let (header, rows) = header_and_rows(&["size", words[0], "--out", words[1], "--best", "1"]);
    let column = |name: &str| {
        let place = header.split(',').position(|found| found == name).expect(name);
        rows[0][place].parse::<f64>().expect("a number")
    };
    assert!(column("misfit_percent") < 0.2);
    assert!((column("transmission") / 0.2 - 1.0).abs() < 2e-3);
    let design = fs::read_to_string(out.join("feedback-1.toml")).expect("a design");
    // The sizing's mesh is coarse: 2 % of what the model of `auto` gives.
    let solved = |text: &str, name: &str| {
        let file = folder.join(name);
        fs::write(&file, text).expect("written");
        let (_, rows) = header_and_rows(&["loop", file.to_str().expect("utf-8"), "--indentation-mm", "2"]);
        rows[0][4].parse::<f64>().expect("a ratio")
    };
    let ratio = solved(&design, "same.toml");
    assert!((ratio / 0.2 - 1.0).abs() < 0.03, "{ratio}");
    let wider = format!("diameter_mm = {:?}", column("actuator_diameter_mm") + 0.1);
    let line = design
        .lines()
        .find(|line| line.starts_with("diameter_mm"))
        .expect("the key");
    let change = 100.0 * (solved(&design.replacen(line, &wider, 1), "wider.toml") / ratio - 1.0);
    let stated = column("percent_for_diameter_tolerance");
    assert!((change / stated - 1.0).abs() < 0.1, "{change} {stated}");
    let airy = design.replacen("trapped_air_mm3 = 0.0", "trapped_air_mm3 = 500.0", 1);
    let change = 100.0 * (solved(&airy, "airy.toml") / ratio - 1.0);
    let stated = column("percent_for_air");
    assert!(
        (change - stated).abs() < 0.1 + 0.1 * change.abs(),
        "{change} {stated}"
    );
}

#[test]
fn what_is_no_target_of_a_loop_is_refused_in_one_line() {
    let folder = scratch("size-loop-bad");
    for (from, to, told) in [
        (
            "feedback_over_touch = 0.2",
            "feedback_over_touch = 0",
            "transmission.feedback_over_touch",
        ),
        (
            "actuator_diameter_mm = [6.0, 15.0]",
            "",
            "bounds.actuator_diameter_mm",
        ),
        ("[\"agilus30\"]", "[\"rubber\"]", "materials.actuator_presets"),
        (
            "indentation_mm = 2.0",
            "indentation_mm = 2.0\ngap_mm = -1",
            "transmission.gap_mm",
        ),
        ("[0.0, 100.0]", "[0.0, 0.001]", "no loop within the bounds"),
    ] {
        let text = if told.starts_with("no loop") {
            held()
        } else {
            TARGET.to_owned()
        };
        assert!(text.contains(from), "{from}");
        let file = folder.join("target.toml");
        fs::write(&file, text.replacen(from, to, 1)).expect("written");
        let line = refusal(&["size", file.to_str().expect("utf-8")]);
        assert!(line.contains(told), "{line}");
    }
}
