//! Every command that writes: on a disk that takes nothing, on one that fills up, with a standard output that takes nothing, and killed.
//!
//! The disk is a limit on the size of files (`ulimit -f`), whose signal is ignored: a write then fails as on a full disk.
#![cfg(unix)]

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

fn designer(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_designer"))
        .args(arguments)
        .output()
        .expect("the binary runs")
}

/// An empty folder with a design whose tables take a tenth of a second, data of it, a question and a space.
fn scratch(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("full-{name}"));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    let design = "name = \"thin\"\n[membrane]\nradial_semi_axis_mm = 9\naxial_semi_axis_mm = 7\nthickness_mm = 0.2\n\
         [material]\npreset = \"skin\"\n[rest]\npole_stretch = 1.3\n[press]\nmax_indentation_mm = 1.5\n\
         [transducer]\nkind = \"ratiometric\"\nrange_kpa = [0, 40]\nresolution_pa = 5\n\
         [accuracy]\nforce_percent_of_reading = 1\nindentation_percent_of_reading = 1\nfrom_percent_of_full_scale = 1\n";
    fs::write(folder.join("thin.toml"), design).expect("a design");
    let design = folder.join("thin.toml");
    let solved = designer(&[
        "solve",
        design.to_str().expect("text"),
        "--indentation-mm",
        "0.2:0.2:1.4",
        "--format",
        "csv",
    ]);
    assert!(
        solved.status.success(),
        "{}",
        String::from_utf8_lossy(&solved.stderr)
    );
    fs::write(
        folder.join("bench.csv"),
        bench(&String::from_utf8_lossy(&solved.stdout)),
    )
    .expect("data");
    fs::write(
        folder.join("question.toml"),
        "name = \"q\"\n[wanted]\nlightest_touch_n = 0.1\ngreatest_force_n = 5\n[materials]\npresets = [\"sortaclear-40\"]\n\
         [transducers]\nparts = [\"abp2-100kpa\"]\n",
    )
    .expect("a question");
    folder
}

/// Indentation, pressure rise and force of `solve` as data of a bench.
fn bench(rows: &str) -> String {
    let mut text = String::from("indentation_mm,pressure_kpa,force_n\n");
    for line in rows.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let _ = writeln!(text, "{},{},{}", cells[0], cells[2], cells[3]);
    }
    text
}

/// The commands that write, with the place of what they write as `OUT`.
const WRITE: [(&str, &str); 11] = [
    ("table", "table thin.toml --out OUT"),
    ("tip", "tip thin.toml --out OUT/tip.bin"),
    ("report", "report thin.toml --figures --out OUT"),
    ("fit", "fit thin.toml bench.csv --out OUT"),
    ("size", "size question.toml --best 1 --out OUT"),
    ("sweep", "sweep SPACE --out OUT"),
    ("chart", "chart paper --out OUT"),
    ("atlas", "atlas --stride 8 --out OUT"),
    ("ladder", "ladder --designs 1 --out OUT"),
    ("calibration", "calibration --out OUT/page.md"),
    ("published", "published --out OUT/page.md"),
];

/// Runs a command of [`WRITE`] in a folder by a shell that has done `before` first.
fn run(folder: &Path, before: &str, command: &str) -> Output {
    let space = format!("{}/../spaces/domes-with-tables.toml", env!("CARGO_MANIFEST_DIR"));
    let command = command
        .replace("OUT", "out")
        .replace("SPACE", &format!("'{space}'"));
    fs::create_dir_all(folder.join("out")).expect("a folder");
    Command::new("sh")
        .current_dir(folder)
        .args([
            "-c",
            &format!("{before}; exec '{}' {command}", env!("CARGO_BIN_EXE_designer")),
        ])
        .stdin(Stdio::null())
        .output()
        .expect("sh is there")
}

/// Every file in a folder and the folders in it, hidden ones too.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).into_iter().flatten() {
        let path = entry.expect("listed").path();
        if path.is_dir() {
            found.extend(files(&path));
        } else {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// One line on standard error, after the lines of progress and warnings; nothing on standard output; status 1.
fn is_refused(name: &str, output: &Output) -> String {
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{name}: {text}");
    assert!(
        output.stdout.is_empty(),
        "{name}: {}",
        String::from_utf8_lossy(&output.stdout)
    );
    assert_eq!(
        text.lines().filter(|line| line.starts_with("error: ")).count(),
        1,
        "{name}: {text}"
    );
    assert!(!text.contains("panicked"), "{name}: {text}");
    text
}

#[test]
fn a_disk_that_takes_nothing_is_found_before_the_work() {
    let folder = scratch("nothing");
    for (name, command) in WRITE {
        let begun = Instant::now();
        let output = run(&folder, "trap '' XFSZ; ulimit -f 0", command);
        let text = is_refused(name, &output);
        assert!(text.contains("cannot be written"), "{name}: {text}");
        assert!(
            begun.elapsed() < Duration::from_secs(5),
            "{name}: {:?}",
            begun.elapsed()
        );
        assert_eq!(files(&folder.join("out")), Vec::<PathBuf>::new(), "{name}");
    }
}

/// A block of 512 or 1024 bytes: the probe fits, some file of each of these sets does not.
#[test]
fn a_disk_that_fills_up_leaves_nothing_half_written() {
    let folder = scratch("fills");
    for (name, command) in WRITE
        .iter()
        .filter(|(name, _)| ["table", "report", "fit"].contains(name))
    {
        let output = run(&folder, "trap '' XFSZ; ulimit -f 1", command);
        let text = is_refused(name, &output);
        assert!(text.contains("cannot be written"), "{name}: {text}");
        assert_eq!(
            files(&folder.join("out")),
            Vec::<PathBuf>::new(),
            "{name}: {text}"
        );
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_standard_output_that_takes_nothing_is_an_error() {
    let folder = scratch("stdout");
    for command in [
        "rest thin.toml",
        "solve thin.toml --indentation-mm 0.5",
        "profile thin.toml --indentation-mm 0.5",
        "estimate thin.toml --pressure-rise-pa 300",
        "actuator thin.toml --pressure-kpa 5",
        "materials",
        "completions bash",
        "--help",
        "solve --help",
        "--version",
        "table thin.toml --out OUT",
    ] {
        let output = run(&folder, "exec >/dev/full", command);
        let text = is_refused(command, &output);
        assert!(text.contains("standard output"), "{command}: {text}");
    }
}

/// Old tables stand in the folder; `table` makes those of another design and is killed after a time that differs from run to run. What is
/// there is one set whole, or has no certificate.
#[test]
fn killed_at_any_instant_no_certificate_stands_beside_other_tables() {
    const NAMES: [&str; 4] = ["tables.rs", "tables.bin", "tables.csv", "certificate.toml"];
    let folder = scratch("killed");
    let out = folder.join("out");
    let text = fs::read_to_string(folder.join("thin.toml")).expect("a design");
    fs::write(
        folder.join("new.toml"),
        text.replace("thickness_mm = 0.2", "thickness_mm = 0.21"),
    )
    .expect("a design");
    let set = || NAMES.map(|name| fs::read(out.join(name)).unwrap_or_default());
    let table = |design: &str| {
        Command::new(env!("CARGO_BIN_EXE_designer"))
            .current_dir(&folder)
            .args(["table", design, "--out", "out"])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("it runs")
    };
    let begun = Instant::now();
    assert!(table("new.toml").wait().expect("it ends").success());
    let whole = begun.elapsed();
    let new = set();
    assert!(table("thin.toml").wait().expect("it ends").success());
    let old = set();
    assert!(old != new && old.iter().all(|content| !content.is_empty()));
    let mut random = 0x2026_u64;
    for _ in 0..20 {
        random = random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        // The files are written at the end of the run.
        let part = 0.7 + 0.5 * ((random >> 11) as f64 / (1_u64 << 53) as f64);
        let mut child = table("new.toml");
        std::thread::sleep(whole.mul_f64(part));
        let _ = child.kill();
        child.wait().expect("it ends");
        let found = set();
        assert!(
            found == old || found == new || found[3].is_empty(),
            "a certificate of other tables"
        );
        assert!(table("thin.toml").wait().expect("it ends").success());
        assert_eq!(set(), old);
    }
}
