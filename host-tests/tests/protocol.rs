//! The protocol's page, the reader in Python and the firmware agree, byte for byte.

use fingertip::link::command::{self, Command, Request};
use fingertip::link::load::{self, LoadCommand, LoadKind, LoadRequest};
use fingertip::link::telemetry::{self, Frame, Hello, Message};
use fingertip::link::tips;
use fingertip::link::wire::unstuff;
use fingertip::signal::report::{Measurement, Report};
use fingertip::status::{Fault, LastFault, ResetCause, Stored, Touch, Warnings};
use fingertip::units::Microseconds;
use host_tests::{python3, workspace};
use model_tables::table::law::Touched;
use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::Stdio;

/// The bytes of the page's example.
fn example(what: &str) -> Vec<u8> {
    let page = fs::read_to_string(workspace().join("src/link/PROTOCOL.md")).expect("the page is there");
    let row = page
        .lines()
        .find(|line| line.starts_with(&format!("| {what}")))
        .unwrap_or_else(|| panic!("PROTOCOL.md has no example \"{what}\""));
    let bytes = row.split('`').nth(1).expect("the bytes stand in backquotes");
    bytes
        .split_whitespace()
        .map(|byte| u8::from_str_radix(byte, 16).expect("two digits"))
        .collect()
}

const REQUESTS: [(&str, Request); 6] = [
    (
        "object, sequence 6",
        Request {
            sequence: 6,
            command: Command::Object(Touched::Ball(8_000)),
        },
    ),
    (
        "indentation, sequence 5",
        Request {
            sequence: 5,
            command: Command::Indentation { known: 1_250_000 },
        },
    ),
    (
        "tare, sequence 0x0102",
        Request {
            sequence: 0x0102,
            command: Command::Tare,
        },
    ),
    (
        "rate, sequence 1",
        Request {
            sequence: 1,
            command: Command::Rate { every: 10 },
        },
    ),
    (
        "save, sequence 2",
        Request {
            sequence: 2,
            command: Command::Save { gain: Some(-2500) },
        },
    ),
    (
        "self-test, sequence 3",
        Request {
            sequence: 3,
            command: Command::SelfTest { indentation: 250_000 },
        },
    ),
];

/// Of firmware that takes a tip.
const LOADS: [(&str, LoadCommand); 4] = [
    ("arm, sequence 5", LoadCommand::Arm),
    (
        "load begin, sequence 5",
        LoadCommand::Begin {
            tip: 0,
            length: 516,
            check: 0x0123_4567,
        },
    ),
    (
        "activate, sequence 5",
        LoadCommand::Activate {
            hash: 0x0123_4567_89AB_CDEF,
        },
    ),
    (
        "read back, sequence 5",
        LoadCommand::ReadBack {
            offset: 448,
            length: 56,
        },
    ),
];

const LOAD_REPLIES: [&str; 2] = ["answer to a load, sequence 8", "data, sequence 8"];

const FRAMES: [&str; 7] = [
    "fault, sequence 65535",
    "answer, sequence 8",
    "answer, sequence 9",
    "reading, sequence 0x0102",
    "hello, sequence 7",
    "feedback, sequence 0x0102",
    "band, sequence 8",
];

#[test]
fn the_pages_examples_are_what_the_firmware_sends_and_takes() {
    for (what, request) in REQUESTS {
        assert_eq!(command::encode(&request).as_slice(), example(what), "{what}");
    }
    for (what, command) in LOADS {
        let request = LoadRequest { sequence: 5, command };
        assert_eq!(load::encode(&request).as_slice(), example(what), "{what}");
    }
    for what in FRAMES.into_iter().chain(LOAD_REPLIES) {
        let bytes = example(what);
        let frame = telemetry::decode(&bytes[..bytes.len() - 1]).expect("it is a frame");
        assert_eq!(telemetry::encode(&frame).as_slice(), bytes, "{what}");
    }
}

#[test]
fn the_pages_examples_of_a_hand_are_what_the_reader_in_python_reads() {
    let whats = [
        "readings, sequence 0x0102",
        "hello of the board",
        "hello of tip 4",
        "answer of tip 4",
        "band of tip 4",
    ];
    let mut stream = Vec::new();
    for what in whats {
        let bytes = example(&format!("hand: {what}"));
        let body = unstuff(&bytes[..bytes.len() - 1]).expect("it is a frame");
        assert!(tips::read_body(&body).is_ok(), "{what}");
        stream.extend(bytes);
    }
    for (tip, sequence, command, arguments, what) in [
        (
            4,
            0x0102,
            Command::Tare,
            &["--encode", "4", "tare", "258"][..],
            "tare of tip 4",
        ),
        (
            255,
            1,
            Command::Rate { every: 4 },
            &["--encode", "255", "rate", "1", "0400"],
            "rate of all",
        ),
    ] {
        let bytes = example(&format!("hand: {what}"));
        let request = Request { sequence, command };
        assert_eq!(tips::encode_request(tip, &request).as_slice(), bytes, "{what}");
        assert_eq!(
            reader_of(HAND_READER, arguments, &[]).unwrap_or(bytes.clone()),
            bytes,
            "{what}"
        );
    }
    let load = |command| LoadRequest { sequence: 5, command };
    for (command, what) in [
        (LoadCommand::Arm, "arm"),
        (
            LoadCommand::Begin {
                tip: 3,
                length: 516,
                check: 0x0123_4567,
            },
            "load begin",
        ),
        (
            LoadCommand::Activate {
                hash: 0x0123_4567_89AB_CDEF,
            },
            "activate",
        ),
        (
            LoadCommand::ReadBack {
                offset: 448,
                length: 56,
            },
            "read back",
        ),
    ] {
        let bytes = example(&format!("hand: {what} of tip 3"));
        assert_eq!(tips::encode_load(3, &load(command)).as_slice(), bytes, "{what}");
    }
    let object = Request {
        sequence: 6,
        command: Command::Object(Touched::Ball(8_000)),
    };
    assert_eq!(
        tips::encode_request(1, &object).as_slice(),
        example("hand: object of tip 1")
    );
    for what in ["answer to a load of tip 3", "data of tip 3", "answer of tip 1"] {
        expect_frame_of_a_hand(what);
    }
    let Some(told) = reader_of(HAND_READER, &[], &stream) else {
        return;
    };
    let told = String::from_utf8(told).expect("it is text");
    let lines: Vec<&str> = told.lines().collect();
    assert_eq!(
        lines,
        [
            "258 3000500 us, 3 dropped: tip 0 warning: saturated, touched, 642.000 Pa, 1500000 uN, 2500000 nm, 1-sigma 2.828 \
             Pa, 5793 uN, 8933 nm | tip 1 fault: sensor open",
            "7 1000000 us, 259 dropped: hello, firmware 0.1.0, reset by watchdog, design 0123456789abcdef, tables 1, a \
             report each 2010 us, stored: in use (17), before: late task 0x3, 2 resets in a row; 2 samples lost, 6 outliers, \
             259 frames dropped, 4 refused; 5 tips",
            "8 1000000 us, 0 dropped: tip 4 index, design 0123456789abcdef, tables 5, a report each 2010 us, stored: none \
             (0), 6 outliers",
            "9 2000000 us, 0 dropped: tip 4: tare 772: touched, findings 0x0",
            "8 1000000 us, 0 dropped: tip 4: object unknown, from 500.0 Pa: to 2000.0 Pa force -6.5 to +22.5 %, indentation -1.2 to \
             +30.0 %; to 82944.0 Pa force -33.6 to +22.1 %, indentation -2.3 to +58.6 %",
        ]
    );
}

/// The page's example of a hand is a frame of version 3.
fn expect_frame_of_a_hand(what: &str) {
    let bytes = example(&format!("hand: {what}"));
    let body = unstuff(&bytes[..bytes.len() - 1]).expect("it is a frame");
    assert!(tips::read_body(&body).is_ok(), "{what}");
}

/// The tests of the client of a hand need the standard library alone.
#[test]
fn the_client_of_a_hand_in_python_is_the_pages() {
    let folder = workspace().join("model-tables/python");
    let Some(mut python) = python3() else {
        return;
    };
    let output = python
        .arg(folder.join("tests/test_hand.py"))
        .env("PYTHONPATH", folder.join("package"))
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .output()
        .expect("Python runs");
    let (told, error) = (
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr),
    );
    assert!(
        output.status.success() && told.matches("... ok").count() == 9,
        "{told}{error}"
    );
}

#[test]
fn the_page_names_every_code() {
    let page = fs::read_to_string(workspace().join("src/link/PROTOCOL.md")).expect("the page is there");
    for (fault, code) in Fault::CODES {
        assert!(page.contains(&format!("| {code} | {fault}")), "{code} {fault}");
    }
    for (kind, code) in command::CommandKind::CODES {
        let words = format!("{kind:?}")
            .replace("SelfTest", "self-test")
            .to_lowercase();
        assert!(page.contains(&format!("| {code:#04x} | {words} |")), "{words}");
    }
    for (kind, code) in LoadKind::CODES {
        assert!(
            page.contains(&format!("| {code:#04x} | {} |", kind.word())),
            "{kind:?}"
        );
    }
    for bit in 0..9_u16 {
        let warning = Warnings::from_bits(1 << bit).expect("it is known");
        assert!(page.contains(&format!("| {bit} | {warning} |")), "{warning}");
    }
}

/// Runs the reader, or nothing where there is no Python.
fn reader(arguments: &[&str], input: &[u8]) -> Option<Vec<u8>> {
    reader_of("host-tests/scripts/read_frames.py", arguments, input)
}

/// The reader of a hand's frames.
const HAND_READER: &str = "host-tests/scripts/read_hand.py";

/// The same of another script.
fn reader_of(script: &str, arguments: &[&str], input: &[u8]) -> Option<Vec<u8>> {
    let script = workspace().join(script);
    let mut child = python3()?
        .arg(script)
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("Python runs");
    let mut stdin = child.stdin.take().expect("it is piped");
    stdin.write_all(input).expect("the reader reads");
    drop(stdin);
    let output = child.wait_with_output().expect("the reader ends");
    assert!(output.status.success());
    Some(output.stdout)
}

#[test]
fn the_reader_in_python_reads_what_the_firmware_sends() {
    let mut stream = vec![0x55; 100];
    stream.push(0);
    for what in FRAMES.into_iter().chain(LOAD_REPLIES) {
        stream.extend(example(what));
    }
    let Some(output) = reader(&[], &stream) else {
        return;
    };
    let text = String::from_utf8(output).expect("it is text");
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(
        lines,
        [
            "no frame: stuffing",
            "65535 0 us, 0 dropped: fault: sensor open",
            "8 2000000 us, 0 dropped: self-test 772: done, findings 0x12",
            "9 2000000 us, 0 dropped: indentation 5: done, findings 0x1, 1500000 uN, 1-sigma 90000 uN, curvature 125000 / km, \
             1-sigma 4000 / km",
            "258 3000500 us, 3 dropped: warning: saturated, touched, 642.000 Pa, 1500000 uN, 2500000 nm, 1-sigma 2.898 \
             Pa, 6000 uN, 9000 nm",
            "7 1000000 us, 259 dropped: hello, firmware 0.1.0, reset by watchdog, design 0123456789abcdef, tables 1, a \
             report each 1000 us, stored: in use (17), before: late task 0x3, 2 resets in a row; 2 samples lost, 6 outliers, \
             259 frames dropped, 4 refused",
            "258 3000500 us, 3 dropped: warning: saturated, touched, 642.000 Pa, 1500000 uN, 2500000 nm, 1-sigma 2.898 \
             Pa, 6000 uN, 9000 nm, feedback 445000 uN, 1-sigma 1800 uN",
            "8 1000000 us, 0 dropped: object unknown, from 500.0 Pa: to 2000.0 Pa force -6.5 to +22.5 %, indentation -1.2 to \
             +30.0 %; to 82944.0 Pa force -33.6 to +22.1 %, indentation -2.3 to +58.6 %",
            "8 2000000 us, 0 dropped: verify 5: block refused, findings 0x8",
            "8 2000000 us, 0 dropped: read-back 5: from 0 on, 46544950",
        ]
    );
}

#[test]
fn the_commands_of_the_reader_in_python_are_the_firmwares() {
    let encoded = [
        (&["--encode", "tare", "258"][..], "tare, sequence 0x0102"),
        (&["--encode", "rate", "1", "0a00"], "rate, sequence 1"),
        (&["--encode", "save", "2", "3cf6ffff"], "save, sequence 2"),
        (
            &["--encode", "self-test", "3", "90d00300"],
            "self-test, sequence 3",
        ),
        (&["--encode", "object", "6", "01401f0000"], "object, sequence 6"),
        (
            &["--encode", "indentation", "5", "d0121300"],
            "indentation, sequence 5",
        ),
    ];
    for (arguments, what) in encoded {
        if let Some(bytes) = reader(arguments, &[]) {
            assert_eq!(bytes, example(what), "{what}");
        }
    }
}

#[test]
fn the_reader_in_python_refuses_on_one_line_what_the_board_would_refuse() {
    let script = workspace().join("host-tests/scripts/read_frames.py");
    for (arguments, reason) in [
        (&["--encode", "save", "8"][..], "with save go 4 bytes, not 0"),
        (
            &["--encode", "save", "8", "ffffff7f"],
            "a gain is -100000 to 100000",
        ),
        (&["--encode", "rate", "8", "0000"], "a rate is 1 to 1000"),
        (
            &["--encode", "self-test", "8", "ffffffff"],
            "an indentation is 0 nm or more",
        ),
        (&["--encode", "tare", "65536"], "no sequence number"),
        (&["--encode", "tear", "1"], "no command `tear`"),
        (&["--encode", "rate", "8", "ten"], "is not hexadecimal"),
        (&["--encode"], "needs KIND SEQUENCE"),
        (&["no/such/port"], "No such file"),
    ] {
        let Some(mut python) = python3() else {
            return;
        };
        let output = python.arg(&script).args(arguments).output().expect("Python runs");
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {error}");
        assert!(
            output.stdout.is_empty() && error.lines().count() == 1,
            "{arguments:?}: {error}"
        );
        assert!(error.contains(reason), "{arguments:?}: {error}");
    }
}

#[test]
fn the_reader_in_python_is_done_soon_with_a_stretch_that_has_no_zero() {
    let mut stream = vec![0x55; 4_000_000];
    stream.push(0);
    stream.extend(example("tare, sequence 0x0102"));
    let began = std::time::Instant::now();
    if let Some(told) = reader(&[], &stream) {
        assert!(told.starts_with(b"no frame"));
        // Quadratic in the length it took 16 s and more.
        assert!(began.elapsed().as_secs() < 8, "{:?}", began.elapsed());
    }
}

/// A frame of this message, numbered 0.
fn framed(message: Message) -> Vec<u8> {
    let frame = Frame {
        sequence: 0,
        dropped: 0,
        message,
    };
    telemetry::encode(&frame).as_slice().to_vec()
}

fn report(outcome: Result<Measurement, Fault>) -> Vec<u8> {
    framed(Message::Report {
        report: Report {
            time: Microseconds(0),
            outcome,
        },
        pressure_fraction_bits: 0,
    })
}

#[test]
fn the_reader_in_python_has_a_word_for_every_code() {
    let mut lines_wanted: Vec<(Vec<u8>, String)> = vec![];
    for (fault, _) in Fault::CODES {
        lines_wanted.push((report(Err(fault)), format!("fault: {fault}")));
    }
    let reading = Measurement::default();
    for bit in 0..16 {
        if let Some(warnings) = Warnings::from_bits(1 << bit) {
            let warned = Measurement { warnings, ..reading };
            lines_wanted.push((report(Ok(warned)), format!("warning: {warnings}, unknown")));
        }
    }
    for (touch, _) in Touch::CODES {
        let word = format!("ok, {touch:?},").to_lowercase();
        lines_wanted.push((report(Ok(Measurement { touch, ..reading })), word));
    }
    for (reset_cause, _) in ResetCause::CODES {
        let hello = Hello {
            reset_cause,
            ..Hello::default()
        };
        lines_wanted.push((framed(Message::Hello(hello)), format!("reset by {reset_cause},")));
    }
    for ((stored, _), word) in
        Stored::CODES
            .into_iter()
            .zip(["none", "in use", "other", "damaged", "unreadable"])
    {
        let hello = Hello {
            stored,
            ..Hello::default()
        };
        lines_wanted.push((
            framed(Message::Hello(hello)),
            format!("stored: {word}").replace("other", "another"),
        ));
    }
    let words = [
        "nothing",
        "late",
        "panic",
        "hard fault",
        "hang",
        "non-maskable",
        "stack overflow",
    ];
    for ((last_fault, _), word) in LastFault::CODES.into_iter().zip(words) {
        let hello = Hello {
            last_fault,
            ..Hello::default()
        };
        lines_wanted.push((framed(Message::Hello(hello)), format!("before: {word}")));
    }
    let stream: Vec<u8> = lines_wanted.iter().flat_map(|(bytes, _)| bytes.clone()).collect();
    let Some(lines) = reader(&[], &stream) else {
        return;
    };
    let lines = String::from_utf8(lines).expect("it is text");
    assert_eq!(lines.lines().count(), lines_wanted.len(), "{lines}");
    for (line, (_, words)) in lines.lines().zip(&lines_wanted) {
        assert!(line.contains(words), "\"{line}\" does not say \"{words}\"");
    }
}

/// The program in the guide, on frames from a file.
#[test]
fn the_program_of_the_guide_prints_forces_and_reasons() {
    let guide = fs::read_to_string(workspace().join("host-tests/guides/telemetry-from-python.md"));
    let guide = guide.expect("the guide is there");
    let (_, rest) = guide.split_once("```python force.py\n").expect("a program");
    let (program, _) = rest.split_once("```").expect("its end");
    let frames = Path::new(env!("CARGO_TARGET_TMPDIR")).join("frames.bin");
    let mut stream = vec![0x55, 0];
    for what in FRAMES.into_iter().filter(|what| !what.starts_with("feedback")) {
        stream.extend(example(what));
    }
    fs::write(&frames, stream).expect("the test folder");
    let Some(mut python) = python3() else {
        return;
    };
    let output = python
        .args(["-c", program])
        .arg(&frames)
        .current_dir(workspace())
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .output()
        .expect("Python runs");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let text = String::from_utf8(output.stdout).expect("it is text");
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines, ["0 us fault: sensor open", "3000500 us warning 0x1"]);
}
