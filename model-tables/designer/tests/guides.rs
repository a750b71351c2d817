//! The guides, followed as a reader would: files written as they are shown, commands run as they stand. Blocks marked `board` need
//! one; those marked `emulated` are the emulated board's, which has tests of its own.
#![cfg(unix)]

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

fn guide(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../host-tests/guides/{name}.md"));
    fs::read_to_string(path).expect("the guide")
}

/// A fenced block: what stands behind its fence, and its lines.
struct Block {
    info: String,
    text: String,
}

fn blocks(guide: &str) -> Vec<Block> {
    let mut all = Vec::new();
    let mut lines = guide.lines();
    while let Some(line) = lines.next() {
        let Some(info) = line.trim_start().strip_prefix("```") else {
            continue;
        };
        let indent = line.len() - line.trim_start().len();
        let mut text = String::new();
        for line in lines.by_ref().take_while(|line| line.trim() != "```") {
            let _ = writeln!(text, "{}", line.get(indent..).unwrap_or_default());
        }
        all.push(Block {
            info: info.to_owned(),
            text,
        });
    }
    all
}

/// Follows a guide in a folder of its own, beside the crate; gives the folder and what the commands printed.
fn follow(name: &str) -> (PathBuf, String) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("guide-{name}"));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("the test folder");
    std::os::unix::fs::symlink(
        concat!(env!("CARGO_MANIFEST_DIR"), "/.."),
        folder.join("model-tables"),
    )
    .expect("a link");
    let (mut printed, mut ran) = (String::new(), 0);
    for Block { info, text } in blocks(&guide(name)) {
        match info.split_once(' ') {
            Some(("sh", "board" | "emulated")) => {}
            Some((_, file)) => fs::write(folder.join(file), text).expect("the test folder"),
            None => {
                assert_eq!(info, "sh", "what is a block of `{info}`?");
                // `cargo designer` is what it stands for.
                let script = format!("set -e\ncargo() {{ shift; \"$DESIGNER\" \"$@\"; }}\n{text}");
                let output = Command::new("bash")
                    .args(["-c", &script])
                    .current_dir(&folder)
                    .env("DESIGNER", env!("CARGO_BIN_EXE_designer"))
                    .output()
                    .expect("bash");
                let said = String::from_utf8_lossy(&output.stderr);
                assert!(output.status.success(), "{name}: {text}\n{said}");
                printed += &String::from_utf8_lossy(&output.stdout);
                printed += &said;
                ran += 1;
            }
        }
    }
    assert!(ran > 0, "{name} runs nothing");
    (folder, printed)
}

#[test]
fn a_new_membrane_gets_tables_and_a_page() {
    let (folder, printed) = follow("new-membrane");
    assert!(
        printed.contains("rest_pressure_kpa") && printed.contains("inputs_checked"),
        "{printed}"
    );
    assert!(folder.join("tables/tables.rs").is_file() && folder.join("report/my-tip.html").is_file());
}

#[test]
fn a_transducer_that_fits_gets_tables() {
    let (folder, _) = follow("wire-a-transducer");
    assert!(folder.join("tables/tables.rs").is_file());
}

/// The guide says what its data were made of.
#[test]
fn a_calibration_finds_the_device_of_its_data() {
    let (folder, printed) = follow("calibrate");
    let text = guide("calibrate");
    assert!(text.contains("1.3 times as stiff and stretched by 5 %"));
    let calibrated = fs::read_to_string(folder.join("calibrated/tip-calibrated.toml")).expect("written");
    let value = |key: &str| -> f64 {
        let line = calibrated
            .lines()
            .rfind(|line| line.starts_with(key))
            .expect("fitted");
        line.rsplit(' ')
            .next()
            .and_then(|number| number.parse().ok())
            .expect("a number")
    };
    assert!(
        (value("material_factor") / 1.3 - 1.0).abs() < 0.02,
        "{calibrated}"
    );
    assert!((value("pole_stretch") - 1.05).abs() < 0.003, "{calibrated}");
    assert!(
        folder.join("report/tip.html").is_file() && printed.contains("held_out_rms"),
        "{printed}"
    );
}

#[test]
fn every_block_of_every_guide_is_run_written_or_marked() {
    for name in ["flash-a-board", "telemetry-from-python"] {
        for Block { info, .. } in blocks(&guide(name)) {
            assert!(
                ["sh board", "sh emulated", "python force.py"].contains(&info.as_str()),
                "{name}: {info}"
            );
        }
    }
}
