//! The telemetry client in Python against a board on the host: the firmware's own frames, commands, loader and slots behind a socket, and a
//! line that loses, doubles and breaks frames.

use fingertip::image::ImageDesign;
use host_tests::nor_flash::SimulatedFlash;
use host_tests::tip_device::{BadLine, ServedDevice, tip};
use host_tests::{python3, workspace};
use std::fs;
use std::path::Path;
use std::process::{Child, Stdio};
use std::thread;
use std::time::Duration;

/// A slot of the default board.
const SLOT: usize = 16 * 1024;

fn board(lines: [BadLine; 2]) -> ServedDevice {
    let board = ServedDevice::start(SimulatedFlash::<SLOT>::erased(1), SLOT as u32, lines);
    // A board that has run for a while: a restart shows in its clock.
    thread::sleep(Duration::from_millis(200));
    board
}

/// Runs a program with the client of the sources, where there is a Python for it.
fn python(program: &str, arguments: &[&str]) -> Option<Child> {
    let child = python3()?
        .args(["-c", program])
        .args(arguments)
        .env("PYTHONPATH", workspace().join("model-tables/python/package"))
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn();
    Some(child.expect("Python runs"))
}

fn output_of(child: Child) -> String {
    let output = child.wait_with_output().expect("it ends");
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{error}");
    String::from_utf8(output.stdout).expect("it is text")
}

fn file(name: &str, bytes: &[u8]) -> String {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("python-{name}"));
    fs::write(&path, bytes).expect("the test folder");
    path.display().to_string()
}

const LOAD: &str = r#"
import sys
from fingertip.telemetry import Client, TelemetryError, load, read_back, roll_back
with Client("tcp:" + sys.argv[1]) as board:
    loaded = load(board, sys.argv[2])
    print(f"{loaded.design_hash:x}")
    print(read_back(board).content == open(sys.argv[2], "rb").read())
    print(f"{roll_back(board).design_hash:016x}")
    try:
        read_back(board)
    except TelemetryError as error:
        print(error)
"#;

#[test]
fn a_tip_is_loaded_read_back_and_rolled_back() {
    let board = board([BadLine::new(1, 0), BadLine::new(2, 0)]);
    let path = file("tip.bin", &tip(0x1111, 500));
    let Some(child) = python(LOAD, &[&board.address, &path]) else {
        return;
    };
    let image = format!("{:016x}", ImageDesign::CONSTANTS.hash);
    let refused = format!(
        "tcp:{}: the board refused `read-back`: no loaded tip is in use, its image's own tables are; load one first",
        board.address
    );
    let text = output_of(child);
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines, ["1111", "True", &image, &refused]);
    assert_eq!(board.end(), 2);
}

#[test]
fn a_load_goes_on_over_a_bad_line_a_lost_connection_and_a_reset() {
    let program = r#"
import sys
from fingertip.telemetry import Client, load
with Client("tcp:" + sys.argv[1]) as board:
    loaded = load(board, sys.argv[2])
    print(f"{loaded.design_hash:x}", loaded.repeated > 0, board.counts.damaged > 0, board.counts.missing > 0)
"#;
    let board = board([BadLine::new(3, 12), BadLine::new(4, 12)]);
    let path = file("bad-line.bin", &tip(0x2222, 0));
    let Some(child) = python(program, &[&board.address, &path]) else {
        return;
    };
    thread::sleep(Duration::from_millis(600));
    board.cut();
    thread::sleep(Duration::from_millis(900));
    board.reset();
    assert_eq!(output_of(child).trim(), "2222 True True True");
    // One for the tip to be in use, and the one above, if it came before the end.
    assert!((1..=2).contains(&board.end()));
}

#[test]
fn commands_are_answered_by_the_firmware_and_frames_are_its_own() {
    let program = r#"
import sys
from fingertip.telemetry import Client, Reading, TelemetryError, Touch
with Client("tcp:" + sys.argv[1]) as board:
    hello = board.hello()
    print(f"{hello.design_hash:016x}", hello.firmware, hello.period_us)
    print(board.tare().outcome.word, board.rate(10).outcome.word)
    board.take()
    times = []
    while len(times) < 5:
        frame = board.read(5)
        if isinstance(frame, Reading):
            times.append(frame.time_us)
            last = frame
    print({b - a for a, b in zip(times, times[1:])}, last.touch == Touch.UNTOUCHED, abs(last.force_n) < 0.01, last.tip)
    try:
        board.save()
        board.undo()
        board.undo()
    except TelemetryError as error:
        print(error.args[0].split(": ", 1)[1])
"#;
    let board = board([BadLine::new(5, 0), BadLine::new(6, 0)]);
    let Some(child) = python(program, &[&board.address]) else {
        return;
    };
    let text = output_of(child);
    let lines: Vec<&str> = text.lines().collect();
    let image = format!("{:016x} (0, 1, 0) 1000", ImageDesign::CONSTANTS.hash);
    assert_eq!(
        lines[..3],
        [image.as_str(), "done done", "{10000} True True 0"],
        "{text}"
    );
    assert!(lines[3].starts_with("the board"), "{text}");
    board.end();
}
