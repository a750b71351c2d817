//! The `designer` binary on tip files.

mod program;

use model_tables::block::write::sign;
use program::{designer, header_and_rows, refusal};
use std::fs;
use std::path::{Path, PathBuf};

/// The smallest shipped design, in a second of one core.
const DESIGN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../designs/paper-prestretched.toml");

fn scratch(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("tip-{name}"))
}

fn write(name: &str, bytes: &[u8]) -> String {
    let path = scratch(name);
    fs::write(&path, bytes).expect("the test folder");
    path.display().to_string()
}

/// The tip of a design, written by the binary.
fn tip_of(name: &str, more: &[&str]) -> (String, Vec<String>) {
    let out = scratch(name).display().to_string();
    let arguments = [&["tip", DESIGN, "--out", &out], more].concat();
    let (header, mut rows) = header_and_rows(&arguments);
    assert_eq!(
        header,
        "file,design,design_hash,size_bytes,crc32,sections,certificate_hash"
    );
    assert_eq!(rows.len(), 1);
    (out, rows.remove(0))
}

#[test]
fn a_tip_file_answers_as_its_design_bit_for_bit() {
    let (out, row) = tip_of("same.bin", &[]);
    let bytes = fs::read(&out).expect("it was written");
    assert_eq!(row[1], "paper-prestretched");
    assert_eq!(row[3], bytes.len().to_string());
    assert_eq!(row[5], "constants tables name");
    // Offsets 12 and 16 of the layout's page.
    assert_eq!(
        row[4],
        format!(
            "{:08x}",
            u32::from_le_bytes(bytes[12..16].try_into().expect("four"))
        )
    );
    assert_eq!(
        row[2],
        format!(
            "{:016x}",
            u64::from_le_bytes(bytes[16..24].try_into().expect("eight"))
        )
    );
    // Below zero, the whole range and beyond it, in steps that meet no segment's begin twice.
    let rises: Vec<String> = (-20..1_000)
        .map(|i| format!("{:.3}", 61.803 * f64::from(i)))
        .collect();
    let rises = rises.join(",");
    let of = |file: &str| designer(&["estimate", file, "--pressure-rise-pa", &rises, "--format", "csv"]);
    let [design, tip] = [of(DESIGN), of(&out)];
    assert!(design.status.success() && tip.status.success());
    assert_eq!(design.stdout, tip.stdout);
    assert_eq!(
        String::from_utf8(tip.stdout).expect("text").lines().count(),
        1_021
    );
    // Read alone it says the same of itself.
    let (_, shown) = header_and_rows(&["tip", &out]);
    assert_eq!(shown, [row]);
}

#[test]
fn a_calibration_makes_the_calibrated_designs_tip() {
    let alone = write(
        "alone.toml",
        b"[calibration]\nmaterial_factor = 1.2\npressure_gain = 1.03\n",
    );
    let (out, row) = tip_of(
        "calibrated.bin",
        &["--calibration", &alone, "--gain-ppm", "-2500"],
    );
    assert_eq!(row[5], "constants tables calibration name");
    let text = fs::read_to_string(DESIGN).expect("a shipped design");
    let whole = text.clone() + "\n[calibration]\nmaterial_factor = 1.2\npressure_gain = 1.03\n";
    let whole = write("whole.toml", whole.as_bytes());
    // The factors are in the tables: those of the calibrated design, and of no other.
    let of = |file: &str| designer(&["estimate", file, "--pressure-rise-pa", "642,2571,9000"]).stdout;
    assert_eq!(of(&out), of(&whole));
    assert_ne!(of(&out), of(DESIGN));
    // The calibrated design in the place of the section alone.
    let (_, same) = tip_of(
        "calibrated-2.bin",
        &["--calibration", &whole, "--gain-ppm", "-2500"],
    );
    assert_eq!(same[2..], row[2..]);
    let other = write(
        "other.toml",
        text.replace("thickness_mm = 1.0", "thickness_mm = 1.1")
            .as_bytes(),
    );
    let other_whole = fs::read_to_string(&other).expect("there") + "\n[calibration]\nmaterial_factor = 1.3\n";
    let other_whole = write("other-whole.toml", other_whole.as_bytes());
    let missing = scratch("missing.bin").display().to_string();
    for (calibration, reason) in [
        (other.as_str(), "has no [calibration]"),
        (&other_whole, "is the calibration of another design"),
        (&missing, "the calibration cannot be read"),
    ] {
        let text = refusal(&["tip", DESIGN, "--calibration", calibration, "--out", &missing]);
        assert!(text.contains(reason), "{text}");
        assert!(!Path::new(&missing).exists());
    }
}

#[test]
fn what_is_no_tip_file_is_refused_by_reason() {
    let (out, _) = tip_of("sound.bin", &[]);
    let sound = fs::read(&out).expect("it was written");
    let changed = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = sound.clone();
        change(&mut bytes);
        bytes
    };
    let last = sound.len() - 1;
    // The words of the tables are the last section but the name; the highest segment comes first.
    let tables = 88 + 40 + 40;
    for (name, bytes, reason) in [
        ("cut", sound[..last].to_vec(), "cut off"),
        ("bit", changed(&|bytes| bytes[last / 2] ^= 1), "CRC-32 differs"),
        (
            "layout",
            changed(&|bytes| bytes[4] = 2),
            "layout 2, and layout 1 is read",
        ),
        (
            "longer",
            changed(&|bytes| bytes.push(0)),
            "more than its tip's data",
        ),
        (
            "falls",
            changed(&|bytes| {
                bytes[tables..tables + 4].copy_from_slice(&(-1_i32 << 16).to_le_bytes());
                sign(bytes);
            }),
            "fall",
        ),
    ] {
        let file = write(&format!("{name}.bin"), &bytes);
        for arguments in [
            &["tip", &file][..],
            &["estimate", &file, "--pressure-rise-pa", "642"],
        ] {
            let text = refusal(arguments);
            assert!(text.contains(reason) && text.contains(&file), "{name}: {text}");
            assert!(text.contains("designer tip"), "{name}: {text}");
        }
    }
    let text = refusal(&["tip", &out, "--out", &scratch("again.bin").display().to_string()]);
    assert!(text.contains("is a tip file"), "{text}");
    let text = refusal(&["tip", DESIGN]);
    assert!(text.contains("--out is missing"), "{text}");
    let text = refusal(&["tip", DESIGN, "--out", &out, "--gain-ppm", "100001"]);
    assert!(text.contains("from -100000 to 100000"), "{text}");
}
