//! Every command that a document shows, taken from the document: a block of `sh` is run as a reader would, in a folder
//! with the files that the document shows; a command in a sentence is held to its arguments. What cannot run here is
//! named with the reason.
//!
//! `cargo test --workspace --ignore-rust-version --test documents -- --ignored` builds the images that the documents
//! build and asks the programs of the other packages about their arguments.
#![cfg(unix)]

mod commands;

use commands::{
    Command, Document, Shown, assert_names_exist, assert_one_chip, documents, resolved, split, value,
    workspace,
};
use host_tests::hand_device::{HandDevice, TIPS};
use host_tests::nor_flash::SimulatedFlash;
use host_tests::tip_device::{BadLine, ServedDevice};
use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs;
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};
use std::process;
use std::time::{Duration, Instant, SystemTime};

/// Commands that begin so are not run, and why.
const NOT_RUN: [(&str, &str); 9] = [
    ("cargo install ", "network"),
    ("stty -F /dev/ttyACM0 ", "board"),
    ("probe-rs run ", "board"),
    (
        "python3 host-tests/scripts/peers.py ",
        "an hour, and packages from the network",
    ),
    (
        "python3 host-tests/scripts/a_thousand_designs.py ",
        "minutes, the package's wheel and scipy",
    ),
    ("python3 host-tests/scripts/read_frames.py /dev/ttyACM0", "board"),
    ("python3 host-tests/scripts/read_hand.py /dev/ttyACM0", "board"),
    (
        "python3 host-tests/scripts/read_frames.py tcp:",
        "the emulated board, which runs for ever; host-tests/tests/protocol.rs runs the script",
    ),
    (
        "python3 force.py ",
        "board, or the emulated one; host-tests/tests/protocol.rs runs it",
    ),
];

/// Commands of blocks that are held to their arguments alone, and why.
const NOT_TO_THE_END: [(&str, &str); 4] = [
    (
        "cargo designer chart --out charts",
        "minutes; tests/methods.rs has its methods",
    ),
    (
        "cargo designer ladder --out ladder",
        "hours; tests/ladder.rs draws its walls anew",
    ),
    (
        "cargo designer chart --tables --out charts",
        "minutes; host-tests/tests/golden.rs has its tables",
    ),
    (
        "cargo designer atlas --out atlas",
        "minutes; tests/methods.rs has its cases",
    ),
];

/// What stands for something of the reader's.
const PLACEHOLDERS: [(&str, &str); 3] = [
    ("DESIGN", "model-tables/designs/skin-analogue.toml"),
    ("DIR", "out"),
    ("NAME", "press-hold-release"),
];

/// The page of the tool has files that a guide shows: its reader's, and the guide's.
const DESIGN_TOOL: &str = "model-tables/README.md";
const DESIGN_TOOL_FILES: [(&str, &str); 2] = [("my.toml", "tip.toml"), ("bench.csv", "bench.csv")];
const CALIBRATE: &str = "host-tests/guides/calibrate.md";
const CALIBRATE_HAND: &str = "host-tests/guides/calibrate-a-hand.md";

fn document(path: &str) -> Document {
    let found = documents().into_iter().find(|document| document.path == path);
    found.unwrap_or_else(|| panic!("no {path}"))
}

fn begins(list: &[(&'static str, &str)], command: &Command) -> Option<&'static str> {
    let found = list
        .iter()
        .find(|(beginning, _)| command.line.starts_with(beginning));
    found.map(|(beginning, _)| *beginning)
}

fn with_placeholders(words: &[String]) -> Vec<String> {
    let replaced = |word: &String| PLACEHOLDERS.iter().find(|(name, _)| name == word);
    words
        .iter()
        .map(|word| {
            replaced(word)
                .map_or(word.as_str(), |(_, value)| value)
                .to_owned()
        })
        .collect()
}

/// Runs a program, which must succeed; gives what it printed.
fn succeed(line: &str, program: &mut process::Command) -> String {
    let output = program.output().unwrap_or_else(|error| panic!("{line}: {error}"));
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{line}: {}\n{stderr}", output.status);
    format!("{}{stderr}", String::from_utf8_lossy(&output.stdout))
}

/// Runs a command in a folder, or holds it to its arguments; gives what it printed.
fn run(command: &Command, folder: &Path, to_the_end: bool) -> String {
    let line = &command.line;
    if begins(&NOT_RUN, command).is_some() {
        return String::new();
    }
    let (program, arguments) = command.words.split_first().expect("a program");
    if program == "designer" {
        // Installed; what wants a board is followed in a test of its own.
        let mut words = arguments.to_vec();
        if !to_the_end || ["monitor", "load"].contains(&words[0].as_str()) {
            words.push("--help".to_owned());
        }
        let mut designer = process::Command::new(env!("CARGO_BIN_EXE_designer"));
        return succeed(line, designer.args(words).current_dir(folder));
    }
    if program != "cargo" {
        return succeed(
            line,
            process::Command::new(program).args(arguments).current_dir(folder),
        );
    }
    let arguments = resolved(arguments);
    assert_names_exist(line, &arguments);
    if value(&arguments, "--target").is_some() {
        assert_one_chip(line, &arguments);
    }
    let (cargos, mut programs) = (split(&arguments).0, with_placeholders(split(&arguments).1));
    if value(cargos, "--bin") != Some("designer") || programs.is_empty() {
        return String::new();
    }
    // They want a board.
    if !to_the_end || ["monitor", "load"].contains(&programs[0].as_str()) {
        // Refuses what it does not know before it comes to this.
        programs.push("--help".to_owned());
    }
    let mut designer = process::Command::new(env!("CARGO_BIN_EXE_designer"));
    succeed(
        line,
        designer
            .args(programs)
            .envs(command.variables.iter().cloned())
            .current_dir(folder),
    )
}

/// Follows a document in a folder of its own, beside the crates; gives the folder and what the commands printed.
fn follow(document: &Document) -> (PathBuf, String) {
    let name = document.path.replace('/', "-");
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("document-{name}"));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("the test folder");
    std::os::unix::fs::symlink(workspace().join("model-tables"), folder.join("model-tables"))
        .expect("a link");
    if document.path == DESIGN_TOOL {
        for (name, of_guide) in DESIGN_TOOL_FILES {
            fs::write(folder.join(name), file_of(CALIBRATE, of_guide)).expect("the test folder");
        }
    }
    let mut printed = String::new();
    for shown in document.shown() {
        match shown {
            Shown::File(name, text) => fs::write(folder.join(name), text).expect("the test folder"),
            Shown::Command(command) => {
                let to_the_end = begins(&NOT_TO_THE_END, &command).is_none();
                printed += &run(&command, &folder, to_the_end);
            }
            Shown::Mention(command) => printed += &run(&command, &folder, false),
        }
    }
    (folder, printed)
}

/// A file that a document shows.
fn file_of(path: &str, name: &str) -> String {
    let file = document(path).shown().into_iter().find_map(|shown| match shown {
        Shown::File(file, text) if file == name => Some(text),
        _ => None,
    });
    file.unwrap_or_else(|| panic!("{path} shows no {name}"))
}

/// Every command of every document.
fn commands() -> Vec<Command> {
    let shown = documents().into_iter().flat_map(|document| document.shown());
    shown
        .filter_map(|shown| match shown {
            Shown::File(..) => None,
            Shown::Command(command) | Shown::Mention(command) => Some(command),
        })
        .collect()
}

#[test]
fn a_new_membrane_gets_tables_and_a_page() {
    let (folder, printed) = follow(&document("host-tests/guides/new-membrane.md"));
    assert!(
        printed.contains("rest_pressure_kpa") && printed.contains("inputs_checked"),
        "{printed}"
    );
    assert!(folder.join("tables/tables.rs").is_file() && folder.join("report/my-tip.html").is_file());
}

#[test]
fn a_transducer_that_fits_gets_tables() {
    let (folder, _) = follow(&document("host-tests/guides/wire-a-transducer.md"));
    assert!(folder.join("tables/tables.rs").is_file());
}

/// The guide says what its data were made of.
#[test]
fn a_calibration_finds_the_device_of_its_data() {
    let guide = document(CALIBRATE);
    let (folder, printed) = follow(&guide);
    assert!(guide.text.contains("1.3 times as stiff and stretched by 5 %"));
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

/// From the bench's file to the tip on a board, with the guide's own commands: a board on the host stands at the port, and no command of
/// these is a compiler.
#[test]
fn a_hand_is_calibrated_without_a_compiler() {
    const SLOT: usize = 16 * 1024;
    let board = ServedDevice::serve(
        || HandDevice::start(SimulatedFlash::<SLOT>::of_slots(2 * TIPS, 1), SLOT as u32),
        [BadLine::new(1, 0), BadLine::new(2, 0)],
    );
    let port = format!("tcp:{}", board.address);
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("calibrate-a-hand");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("the test folder");
    let mut printed = String::new();
    for shown in document(CALIBRATE_HAND).shown() {
        let command = match shown {
            Shown::File(name, text) => {
                fs::write(folder.join(name), text).expect("the test folder");
                continue;
            }
            Shown::Command(command) if command.words[0] == "designer" => command,
            _ => continue,
        };
        let at_port = |word: &String| word.replace("/dev/ttyACM0", &port);
        let mut words: Vec<String> = command.words[1..].iter().map(at_port).collect();
        if words[0] == "monitor" {
            words.extend(["--for-s", "5", "--format", "csv"].map(str::to_owned));
        }
        let begun = Instant::now();
        let mut designer = process::Command::new(env!("CARGO_BIN_EXE_designer"));
        printed += &succeed(&command.line, designer.args(words).current_dir(&folder));
        println!("{:.1} s: {}", begun.elapsed().as_secs_f64(), command.line);
    }
    let [sent, back] =
        ["left-index.bin", "in-use.bin"].map(|name| fs::read(folder.join(name)).expect("written"));
    assert_eq!(sent, back);
    // Loaded, read, rolled back: two restarts; and the monitor followed the tip by its name.
    assert_eq!(board.end(), 2);
    for word in [
        "material_factor",
        "left-index",
        "loaded",
        "read back",
        // After a restart that is no power-on, a tip without a kept zero waits for a tare.
        "warning: zero unverified",
        "rolled back",
    ] {
        assert!(printed.contains(word), "{word}: {printed}");
    }
}

#[test]
fn every_command_of_the_design_tool_works() {
    let (folder, _) = follow(&document(DESIGN_TOOL));
    assert!(folder.join("tables/tables.rs").is_file() && folder.join("report/tip.html").is_file());
}

#[test]
fn every_command_of_every_other_document_works() {
    let told_apart = [
        DESIGN_TOOL,
        CALIBRATE,
        CALIBRATE_HAND,
        "host-tests/guides/new-membrane.md",
        "host-tests/guides/wire-a-transducer.md",
    ];
    let others: Vec<_> = documents()
        .into_iter()
        .filter(|document| !told_apart.contains(&document.path.as_str()))
        .collect();
    assert!(
        others
            .iter()
            .any(|document| document.path == "host-tests/FAULTS.md")
    );
    for document in others {
        follow(&document);
    }
}

#[test]
fn what_is_not_run_is_in_a_document() {
    let commands = commands();
    for (beginning, _) in NOT_RUN.into_iter().chain(NOT_TO_THE_END) {
        let shown = commands.iter().any(|command| command.line.starts_with(beginning));
        assert!(shown, "no document shows `{beginning}`");
    }
}

#[test]
#[ignore = "needs the chip's target, and the programs of the whole workspace: .ci/run"]
fn every_image_builds_and_every_program_takes_its_arguments() {
    let (mut built, mut own) = (BTreeSet::new(), vec![]);
    for command in commands() {
        let line = &command.line;
        if command.words[0] != "cargo" || begins(&NOT_RUN, &command).is_some() {
            continue;
        }
        let arguments = resolved(&command.words[1..]);
        let (cargos, programs) = (split(&arguments).0, with_placeholders(split(&arguments).1));
        if value(cargos, "--bin") == Some("demo") {
            // Built beside this one by the same `cargo test --workspace`.
            let program = Path::new(env!("CARGO_BIN_EXE_designer")).with_file_name("demo");
            succeed(line, process::Command::new(program).args(programs).arg("--help"));
        }
        if value(cargos, "--target").is_none() {
            continue;
        }
        let of_reader = |(_, design): &(String, String)| !workspace().join(design).is_file();
        if command.variables.iter().any(of_reader) {
            // The reader's own design, which their guide makes tables of.
            own.push(cargos.to_vec());
        } else if built.insert((cargos.to_vec(), command.variables.clone())) {
            // As far as the probe, which `cargo run` would start.
            let mut cargo = process::Command::new(env!("CARGO"));
            cargo
                .arg("build")
                .args(&cargos[1..])
                .envs(command.variables.iter().cloned())
                .current_dir(workspace());
            succeed(line, &mut cargo);
        }
    }
    for arguments in own {
        assert!(built.contains(&(arguments.clone(), vec![])), "{arguments:?}");
    }
    assert!(!built.is_empty());
}

/// Checks the firmware's library for the chip with this value of `FINGERTIP_DESIGN`, or without it: the tables' source,
/// or what cargo stderr.
fn tables_of(design: Option<&OsStr>, features: &[&str]) -> Result<String, String> {
    let output = process::Command::new(env!("CARGO"))
        .args([
            "check",
            "--keep-going",
            "--profile",
            "firmware",
            "--target",
            "thumbv7em-none-eabihf",
        ])
        .args([
            "--package",
            "fingertip",
            "--lib",
            "--message-format",
            "json-render-diagnostics",
        ])
        .args(features)
        .env_remove("FINGERTIP_DESIGN")
        .envs(design.map(|design| ("FINGERTIP_DESIGN", design)))
        .current_dir(workspace())
        .output()
        .expect("cargo");
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned());
    }
    let folder = String::from_utf8_lossy(&output.stdout)
        .lines()
        .filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok())
        .filter(|message| message["reason"] == "build-script-executed")
        .filter(|message| {
            let package = message["package_id"].as_str();
            package.is_some_and(|package| package.contains("#fingertip@"))
        })
        .find_map(|message| message["out_dir"].as_str().map(PathBuf::from))
        .expect("its folder");
    Ok(fs::read_to_string(folder.join("design.rs")).expect("the tables"))
}

#[test]
#[ignore = "needs the chip's target: .ci/run"]
fn a_design_is_known_by_its_content_and_not_by_its_date() {
    let design = Path::new(env!("CARGO_TARGET_TMPDIR")).join("replaced.toml");
    // The later in the list, the older.
    for (name, age) in [
        ("skin-analogue", 0),
        ("paper-prestretched", 1),
        ("skin-light-touch", 2),
    ] {
        let shipped = workspace().join(format!("model-tables/designs/{name}.toml"));
        fs::write(&design, fs::read(shipped).expect("it is shipped")).expect("the test folder");
        let day = Duration::from_hours(24);
        let date = SystemTime::now() - age * day;
        let file = fs::File::options()
            .write(true)
            .open(&design)
            .expect("it was written");
        file.set_modified(date).expect("its date can be set");
        let tables = tables_of(Some(design.as_os_str()), &[]).expect("it builds");
        assert!(tables.contains(&format!("\"{name}\"")), "{name}: {tables}");
    }
}

#[test]
#[ignore = "needs the chip's target: .ci/run"]
fn what_names_no_design_is_refused_in_a_line() {
    // To cargo, a variable that is not UTF-8 is as good as none: nothing would have changed.
    let default = tables_of(None, &[]).expect("it builds");
    assert!(default.contains("\"index-fingertip-elastic\""), "{default}");
    for (asked, refusal) in [
        (
            &b"designs/\xff.toml"[..],
            "is not UTF-8: rename the file or its folder",
        ),
        (b"", "FINGERTIP_DESIGN is empty: give a design file, or unset it"),
        (
            b"model-tables/designs",
            "FINGERTIP_DESIGN=model-tables/designs is no file",
        ),
        (
            b"none.toml",
            "FINGERTIP_DESIGN=none.toml is no file: give a design file, absolute or relative",
        ),
    ] {
        let stderr = tables_of(Some(OsStr::from_bytes(asked)), &[]).expect_err("nothing to build");
        let lines: Vec<&str> = stderr
            .lines()
            .filter(|line| line.contains("FINGERTIP_DESIGN"))
            .collect();
        assert!(lines.len() == 1 && lines[0].contains(refusal), "{stderr}");
    }
}

#[test]
#[ignore = "needs the chip's target: .ci/run"]
fn an_image_for_two_boards_or_none_is_refused_with_the_remedy() {
    let design = OsStr::new("model-tables/designs/skin-analogue.toml");
    for (features, boards) in [
        (&["--features", "board-nucleo-l432kc"][..], "2"),
        (&["--no-default-features"], "0"),
    ] {
        let stderr = tables_of(Some(design), features).expect_err("there is no such image");
        let refusal = format!(
            "{boards} boards are chosen: choose one, with --package fingertip --no-default-features --features board-"
        );
        assert!(stderr.contains(&refusal), "{stderr}");
    }
}
