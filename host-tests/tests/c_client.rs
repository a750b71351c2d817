//! The header in C (`host-tests/c`) reads what the page's examples are, writes the page's commands, and takes and refuses the same
//! bytes as the firmware's own reader. Compiled with every warning an error; without a C compiler nothing is tested.

use fingertip::link::telemetry::Message;
use fingertip::link::tips::{AnyDecoder, AnyFrame, TipsMessage};
use fingertip::link::wire::unstuff;
use fingertip::signal::report::Report;
use fingertip::status::{Fault, Touch};
use host_tests::workspace;
use model_tables::block::StoredCalibration;
use model_tables::block::write::{TipData, sign};
use model_tables::random::Random;
use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::OnceLock;

/// Frames drawn and changed a little.
const FRAMES: usize = 60_000;

#[allow(clippy::unreadable_literal, unreachable_pub, dead_code)] // generated source
mod golden {
    pub(crate) mod paper {
        include!("../../model-tables/golden/paper-prestretched/tables.rs");
    }
    pub(crate) mod index {
        include!("../../model-tables/golden/index-fingertip/tables.rs");
    }
}

/// The program, built once; nothing where there is no C compiler.
fn program() -> Option<&'static PathBuf> {
    static PROGRAM: OnceLock<Option<PathBuf>> = OnceLock::new();
    let built = PROGRAM.get_or_init(|| {
        let folder = workspace().join("host-tests/c");
        let to = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("read_frames");
        let compiled = Command::new("cc")
            .args([
                "-std=c99",
                "-pedantic",
                "-Wall",
                "-Wextra",
                "-Wconversion",
                "-Wshadow",
                "-Werror",
                "-O1",
            ])
            .arg("-o")
            .args([&to, &folder.join("read_frames.c"), &folder.join("fingertip.c")])
            .status();
        if let Ok(status) = compiled {
            assert!(status.success(), "it does not compile");
            return Some(to);
        }
        assert!(
            std::env::var_os("FINGERTIP_REQUIRE_PYTHON").is_none(),
            "there is no C compiler `cc`"
        );
        eprintln!("no C compiler `cc`: not tested");
        None
    });
    built.as_ref()
}

/// What it prints, and whether it succeeded.
fn run(arguments: &[&str], input: &[u8]) -> Option<(Vec<u8>, bool)> {
    let mut child = Command::new(program()?)
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("it was built");
    let mut stdin = child.stdin.take().expect("it is piped");
    let input = input.to_vec();
    // It writes while it reads.
    let feeder = std::thread::spawn(move || {
        let _ = stdin.write_all(&input);
    });
    let output = child.wait_with_output().expect("it ends");
    feeder.join().expect("it feeds");
    Some((output.stdout, output.status.success()))
}

fn lines(input: &[u8]) -> Option<Vec<String>> {
    let (told, _) = run(&[], input)?;
    let text = String::from_utf8(told).expect("it is text");
    Some(text.lines().map(str::to_owned).collect())
}

/// The examples of the protocol's page: what each is, and its bytes.
fn examples() -> Vec<(String, Vec<u8>)> {
    let page = fs::read_to_string(workspace().join("src/link/PROTOCOL.md")).expect("the page is there");
    let example = |line: &str| {
        let (what, bytes) = line.strip_prefix("| ")?.strip_suffix("` |")?.split_once(" | `")?;
        let bytes: Option<Vec<u8>> = bytes
            .split(' ')
            .map(|byte| u8::from_str_radix(byte, 16).ok().filter(|_| byte.len() == 2))
            .collect();
        Some((what.to_owned(), bytes?))
    };
    page.lines().filter_map(example).collect()
}

fn example(what: &str) -> Vec<u8> {
    let found = examples().into_iter().find(|(name, _)| name.starts_with(what));
    found
        .unwrap_or_else(|| panic!("PROTOCOL.md has no example \"{what}\""))
        .1
}

#[test]
fn the_pages_examples_are_what_the_header_in_c_reads() {
    let wanted = [
        (
            "fault, ",
            "version 2 kind 2 sequence 65535 time 0 us dropped 0 | tip 0 fault 1",
        ),
        (
            "answer, sequence 8",
            "version 2 kind 4 sequence 8 time 2000000 us dropped 0 tip 0 command 85 sequence 772 outcome 0 findings 0012",
        ),
        (
            "answer, sequence 9",
            "version 2 kind 4 sequence 9 time 2000000 us dropped 0 tip 0 command 89 sequence 5 outcome 0 findings 0001 1500000 \
             uN sigma 90000 curvature 125000 sigma 4000",
        ),
        (
            "reading, ",
            "version 2 kind 1 sequence 258 time 3000500 us dropped 3 | tip 0 warnings 0001 touch 2 rise 642.000 Pa 1500000 uN \
             2500000 nm sigma 742 6000 9000",
        ),
        (
            "feedback, ",
            "version 2 kind 1 sequence 258 time 3000500 us dropped 3 | tip 0 warnings 0001 touch 2 rise 642.000 Pa 1500000 uN \
             2500000 nm sigma 742 6000 9000 feedback 445000 uN sigma 1800",
        ),
        (
            "hello, ",
            "version 2 kind 3 sequence 7 time 1000000 us dropped 259 firmware 0.1.0 reset 4 design 0123456789abcdef tables 1 \
             period 1000 stored 1 (17) before 1 3 resets 2 lost 2 outliers 6 dropped 259 refused 4 tips 0",
        ),
        (
            "answer to a load",
            "version 2 kind 4 sequence 8 time 2000000 us dropped 0 tip 0 command 93 sequence 5 outcome 12 findings 0008",
        ),
        (
            "band, ",
            "version 2 kind 8 sequence 8 time 1000000 us dropped 0 tip 0 object unknown from 500.000 Pa to 2000.000 Pa force 935000 \
             to 1225000 uN indentation 988000 to 1300000 nm to 82944.000 Pa force 664000 to 1221000 uN indentation 977000 to \
             1586000 nm",
        ),
        (
            "data, ",
            "version 2 kind 7 sequence 8 time 2000000 us dropped 0 sequence 5 offset 0 bytes 46544950",
        ),
        // A deviation is 2^(c / 8): 742 counts are sent as 76, 6 mN as 100, 9 um as 105.
        (
            "hand: readings",
            "version 3 kind 5 sequence 258 time 3000500 us dropped 3 | tip 0 warnings 0001 touch 2 rise 642.000 Pa 1500000 uN \
             2500000 nm sigma 724 5793 8933 | tip 1 fault 1",
        ),
        (
            "hand: hello of the board",
            "version 3 kind 3 sequence 7 time 1000000 us dropped 259 firmware 0.1.0 reset 4 design 0123456789abcdef tables 1 \
             period 2010 stored 1 (17) before 1 3 resets 2 lost 2 outliers 6 dropped 259 refused 4 tips 5",
        ),
        (
            "hand: hello of tip 4",
            "version 3 kind 6 sequence 8 time 1000000 us dropped 0 tip 4 index design 0123456789abcdef tables 5 period 2010 \
             stored 0 (0) outliers 6",
        ),
        (
            "hand: band of tip 4",
            "version 3 kind 8 sequence 8 time 1000000 us dropped 0 tip 4 object unknown from 500.000 Pa to 2000.000 Pa force 935000 \
             to 1225000 uN indentation 988000 to 1300000 nm to 82944.000 Pa force 664000 to 1221000 uN indentation 977000 to \
             1586000 nm",
        ),
        (
            "hand: answer of tip 4",
            "version 3 kind 4 sequence 9 time 2000000 us dropped 0 tip 4 command 81 sequence 772 outcome 1 findings 0000",
        ),
    ];
    let mut stream = vec![0x55; 300];
    stream.push(0);
    stream.extend(wanted.iter().flat_map(|(what, _)| example(what)));
    let Some(told) = lines(&stream) else {
        return;
    };
    assert_eq!(told[0], "no frame: stuffing");
    let told: Vec<&str> = told[1..].iter().map(String::as_str).collect();
    assert_eq!(told, wanted.map(|(_, line)| line));
}

#[test]
fn the_commands_of_the_header_in_c_are_the_pages() {
    let commands = [
        ("tare, ", &["-", "81", "258"][..]),
        ("rate, ", &["-", "86", "1", "0a00"]),
        ("save, ", &["-", "83", "2", "3cf6ffff"]),
        ("self-test, ", &["-", "85", "3", "90d00300"]),
        ("object, ", &["-", "88", "6", "01401f0000"]),
        ("indentation, ", &["-", "89", "5", "d0121300"]),
        ("air, ", &["-", "8a", "4", "cd8b0100"]),
        ("arm, ", &["-", "90", "5", "4c4f4144"]),
        ("load begin, ", &["-", "91", "5", "000402000067452301"]),
        ("activate, ", &["-", "94", "5", "efcdab8967452301"]),
        ("read back, ", &["-", "96", "5", "c001000038"]),
        ("hand: tare", &["4", "81", "258"]),
        ("hand: rate", &["255", "86", "1", "0400"]),
    ];
    for (what, arguments) in commands {
        let arguments: Vec<&str> = std::iter::once("encode")
            .chain(arguments.iter().copied())
            .collect();
        let Some((bytes, _)) = run(&arguments, &[]) else {
            return;
        };
        assert_eq!(bytes, example(what), "{what}");
    }
}

fn code_of<T: PartialEq + Copy>(codes: &[(T, u8)], wanted: T) -> u8 {
    let found = codes.iter().find(|(one, _)| *one == wanted);
    found.expect("every one has a code").1
}

/// The values of a tip as the program prints them.
fn values(line: &mut String, tip: usize, report: &Report, bits: u8) {
    let _ = write!(line, " | tip {tip} ");
    let _ = match &report.outcome {
        Err(fault) => write!(line, "fault {}", code_of(&Fault::CODES, *fault)),
        Ok(found) => write!(
            line,
            "warnings {:04x} touch {} rise {:.3} Pa {} uN {} nm sigma {} {} {}",
            found.warnings.bits(),
            code_of(&Touch::CODES, found.touch),
            f64::from(found.pressure_rise.0) / f64::from(bits).exp2(),
            found.force.0,
            found.indentation.0,
            found.sigma.pressure_rise.0,
            found.sigma.force.0,
            found.sigma.indentation.0
        ),
    };
    if let Ok(found) = &report.outcome
        && let Some(feedback) = found.feedback.force()
    {
        let _ = write!(
            line,
            " feedback {} uN sigma {}",
            feedback.force.0, feedback.sigma.0
        );
    }
}

/// What the firmware's own reader has of it: a line for readings, a word for other frames, nothing for what is none.
fn of_the_firmware(frame: &[u8]) -> Option<String> {
    let mut decoder = AnyDecoder::default();
    let mut found = None;
    for &byte in frame {
        found = decoder.push(byte);
    }
    let found = found?.ok()?;
    let mut line = String::new();
    match found {
        AnyFrame::One(frame) => match frame.message {
            Message::Report {
                report,
                pressure_fraction_bits,
            } => values(&mut line, 0, &report, pressure_fraction_bits),
            _ => line.push_str("other"),
        },
        AnyFrame::Tips(frame) => match frame.message {
            TipsMessage::Readings {
                pressure_fraction_bits,
                reports,
                ..
            } => {
                for (tip, report) in reports.iter().enumerate() {
                    values(&mut line, tip, report, pressure_fraction_bits);
                }
            }
            _ => line.push_str("other"),
        },
    }
    Some(line)
}

/// A body with its CRC, stuffed, and its zero, as the page has it.
fn framed(body: &[u8]) -> Vec<u8> {
    let mut crc = 0xFFFF_u16;
    for &byte in body {
        crc ^= u16::from(byte) << 8;
        for _ in 0..8 {
            crc = crc << 1 ^ if crc & 0x8000 == 0 { 0 } else { 0x1021 };
        }
    }
    let plain = [body, &crc.to_le_bytes()].concat();
    let mut frame = vec![];
    for piece in plain.split(|&byte| byte == 0) {
        // Longer pieces would take a code of 255.
        assert!(piece.len() < 254);
        frame.push(piece.len() as u8 + 1);
        frame.extend(piece);
    }
    frame.push(0);
    frame
}

#[test]
fn the_header_in_c_takes_and_refuses_the_same_bytes_as_the_firmwares_reader() {
    let bodies: Vec<Vec<u8>> = examples()
        .iter()
        .filter_map(|(_, bytes)| unstuff(&bytes[..bytes.len() - 1]).ok())
        .map(|body| body.to_vec())
        // Commands are of the other direction.
        .filter(|body| body[1] < 0x80)
        .collect();
    assert_eq!(bodies.len(), 17);
    let mut random = Random(11);
    let mut below = |end: usize| (random.bits() >> 33) as usize % end;
    let mut frames = Vec::new();
    for _ in 0..FRAMES {
        let mut body = bodies[below(bodies.len())].clone();
        for _ in 0..below(4) {
            let at = below(body.len());
            body[at] = match below(3) {
                0 => body[at] ^ 1 << below(8),
                1 => below(256) as u8,
                _ => below(26) as u8,
            };
        }
        match below(12) {
            0 => body.truncate(below(body.len() + 1)),
            1 => body.extend((0..below(20)).map(|byte| byte as u8)),
            _ => {}
        }
        let mut frame = framed(&body);
        // Now and then the check is wrong, or the stuffing.
        if below(12) == 0 {
            let at = below(frame.len() - 1);
            frame[at] = 1 + below(255) as u8;
        }
        frames.push(frame);
    }
    let Some(told) = lines(&frames.concat()) else {
        return;
    };
    assert_eq!(told.len(), frames.len());
    let (mut taken, mut refused) = (0, 0);
    for (frame, line) in frames.iter().zip(&told) {
        match of_the_firmware(frame) {
            None => {
                refused += 1;
                assert!(line.starts_with("no frame: "), "{frame:02x?}: {line}");
            }
            Some(wanted) => {
                taken += 1;
                assert!(!line.starts_with("no frame: "), "{frame:02x?}: {line}");
                if wanted != "other" {
                    let (_, values) = line.split_once(" | ").expect("values");
                    assert_eq!(format!(" | {values}"), wanted, "{frame:02x?}");
                }
            }
        }
    }
    println!("{taken} frames taken, {refused} refused");
    assert!(taken > FRAMES / 4 && refused > FRAMES / 4, "{taken}, {refused}");
}

macro_rules! block {
    ($design:ident, $calibration:expr, $relaxation:expr) => {
        TipData {
            constants: golden::$design::DESIGN,
            layout: golden::$design::TABLES.layout,
            words: golden::$design::TABLES.segments.as_flattened(),
            name: golden::$design::NAME,
            calibration: $calibration,
            relaxation: $relaxation,
            object: None,
            feedback: None,
        }
        .write()
    };
}

#[test]
fn the_header_in_c_reads_a_tip_file() {
    let calibration = Some(StoredCalibration {
        zero: 20_100_000,
        temperature: -250,
        coefficient: -2_000,
        gain: i32::MIN,
    });
    let constants = golden::paper::DESIGN;
    let block = block!(paper, calibration, None);
    let Some((told, ok)) = run(&["tip"], &block) else {
        return;
    };
    let told = String::from_utf8(told).expect("it is text");
    let lines: Vec<&str> = told.lines().collect();
    assert!(ok, "{told}");
    let begin = format!(
        "{} design {:016x} certificate ",
        golden::paper::NAME,
        constants.hash
    );
    assert!(lines[0].starts_with(&begin), "{told}");
    assert!(lines[0].ends_with(&format!("bytes {}", block.len())), "{told}");
    let [low, high] = constants.transducer.range;
    assert!(
        lines[1].starts_with(&format!("rest {} Pa to ", constants.rest_pressure))
            && lines[1].contains(&format!("range {low} to {high} Pa gauge")),
        "{told}"
    );
    let layout = golden::paper::TABLES.layout;
    assert_eq!(
        lines[2],
        format!(
            "tables to {} counts of 1/2^{} Pa, {} words; relaxation 0 object 0 zero {}",
            layout.maximum,
            layout.fraction_bits,
            golden::paper::TABLES.segments.as_flattened().len(),
            u8::from(lines[2].ends_with('1'))
        )
    );
    assert_eq!(
        lines[3],
        "calibration zero 20100000 mPa at -250, -2000 mPa/K, gain -2147483648"
    );
    // The wall in time is seen.
    let (told, _) =
        run(&["tip"], &block!(index, None, Some(golden::index::RELAXATION))).expect("it is built");
    let told = String::from_utf8(told).expect("it is text");
    assert!(
        told.contains("relaxation 1 object 0") && !told.contains("calibration"),
        "{told}"
    );
}

#[test]
fn the_header_in_c_refuses_a_tip_file_that_was_changed() {
    let block = block!(paper, None, None);
    let refused = |bytes: &[u8]| -> Option<String> {
        let (told, ok) = run(&["tip"], bytes)?;
        assert!(!ok, "{told:?}");
        Some(String::from_utf8(told).expect("it is text").trim().to_owned())
    };
    let changed = |at: usize, byte: u8, signed: bool| {
        let mut bytes = block.clone();
        bytes[at] = byte;
        if signed {
            sign(&mut bytes);
        }
        bytes
    };
    for (bytes, why) in [
        (changed(0, b'X', false), "magic"),
        (changed(4, 2, true), "layout"),
        (block[..block.len() - 1].to_vec(), "short"),
        (block[..20].to_vec(), "short"),
        (changed(100, block[100] ^ 1, false), "check"),
        // One more section than the directory has room for; a kind that is unknown; a section that begins elsewhere.
        (changed(36, block[36] + 1, true), "section"),
        (changed(40, 9, true), "section"),
        (changed(44, block[44] + 4, true), "section"),
        // The noise is negative; a letter of the name is a blank.
        (changed(block[44] as usize + 23, 0x80, true), "field"),
        (changed(block.len() - 1, b' ', true), "field"),
    ] {
        let Some(told) = refused(&bytes) else {
            return;
        };
        assert_eq!(told, format!("no tip: {why}"));
    }
}
