//! `designer load` against a board on the host: the firmware's own frames, commands, loader and slots behind a socket.

mod program;

use fingertip::image::ImageDesign;
use host_tests::nor_flash::SimulatedFlash;
use host_tests::tip_device::{BadLine, ServedDevice, tip};
use program::{designer, header_and_rows, refusal};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread;
use std::time::Duration;

/// A slot of the default board.
const SLOT: usize = 16 * 1024;

fn scratch(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("load-{name}"))
}

fn file(name: &str, bytes: &[u8]) -> String {
    let path = scratch(name);
    fs::write(&path, bytes).expect("the test folder");
    path.display().to_string()
}

fn board(lines: [BadLine; 2]) -> (ServedDevice, String) {
    let board = ServedDevice::start(SimulatedFlash::<SLOT>::erased(1), SLOT as u32, lines);
    let port = format!("tcp:{}", board.address);
    // A board that has run for a while: a restart shows in its clock.
    thread::sleep(Duration::from_millis(200));
    (board, port)
}

fn sound() -> [BadLine; 2] {
    [BadLine::new(1, 0), BadLine::new(2, 0)]
}

#[test]
fn a_tip_is_loaded_read_back_and_rolled_back() {
    let (board, port) = board(sound());
    let block = tip(0x1111, 500);
    let path = file("tip.bin", &block);
    let name = fingertip::image::generated::NAME;
    let (header, rows) = header_and_rows(&["load", &port, &path, "--tip", name]);
    assert_eq!(header, "action,tip,design_hash,size_bytes,seconds");
    assert_eq!(
        rows[0][..4],
        ["loaded", name, "0000000000001111", &block.len().to_string()]
    );
    // What the board has is what was sent.
    let out = scratch("back.bin").display().to_string();
    let (_, rows) = header_and_rows(&["load", &port, "--read-back", &out]);
    assert_eq!(
        rows[0][..4],
        ["read back", name, "0000000000001111", &block.len().to_string()]
    );
    assert_eq!(fs::read(&out).expect("it was written"), block);
    let (_, rows) = header_and_rows(&["load", &port, "--roll-back"]);
    let image = format!("{:016x}", ImageDesign::CONSTANTS.hash);
    assert_eq!(rows[0][..3], ["rolled back", "0", &image]);
    // The image's own tables cannot be read back.
    let none = scratch("none.bin").display().to_string();
    let text = refusal(&["load", &port, "--read-back", &none]);
    assert!(text.contains("its image's own tables are"), "{text}");
    assert!(!Path::new(&none).exists());
    assert_eq!(board.end(), 2);
}

#[test]
fn what_the_board_or_the_tool_refuses_is_one_line() {
    let (board, port) = board(sound());
    let text = refusal(&["load", &port, "--roll-back"]);
    assert!(text.contains("nothing was loaded"), "{text}");
    let sound = file("sound.bin", &tip(0x1111, 0));
    let text = refusal(&["load", &port, &sound, "--tip", "3"]);
    assert!(text.contains("it has no such tip; take --tip 0"), "{text}");
    let text = refusal(&["load", &port, &sound, "--tip", "thumb"]);
    assert!(text.contains("--tip thumb is no number"), "{text}");
    // Of another transducer: the page of the layout has its range's upper end at 12 of the constants, which begin at 88.
    let mut other = tip(0x1111, 0);
    other[100..104].copy_from_slice(&99_000_i32.to_le_bytes());
    model_tables::block::write::sign(&mut other);
    let other = file("other.bin", &other);
    let text = refusal(&["load", &port, &other]);
    assert!(text.contains("for another transducer"), "{text}");
    let design = concat!(env!("CARGO_MANIFEST_DIR"), "/../designs/paper-prestretched.toml");
    let text = refusal(&["load", &port, design]);
    assert!(text.contains("no tip file"), "{text}");
    let text = refusal(&["load", &port, "no-such.bin"]);
    assert!(text.contains("no such file"), "{text}");
    assert_eq!(board.end(), 0);
    let text = refusal(&["load", &port, &sound]);
    assert!(text.contains("cannot be opened"), "{text}");
}

/// A fifth of the frames of both ways is lost, doubled or broken.
#[test]
fn a_bad_line_slows_a_load_and_spoils_nothing() {
    for seed in 0..3 {
        let (board, port) = board([BadLine::new(seed, 5), BadLine::new(100 + seed, 5)]);
        let block = tip(0x2222, 7);
        let path = file(&format!("bad-{seed}.bin"), &block);
        let (_, rows) = header_and_rows(&["load", &port, &path]);
        assert_eq!(rows[0][2], "0000000000002222");
        let out = scratch(&format!("bad-back-{seed}.bin")).display().to_string();
        header_and_rows(&["load", &port, "--read-back", &out]);
        assert_eq!(fs::read(&out).expect("it was written"), block);
        assert_eq!(board.end(), 1, "seed {seed}");
    }
}

/// The connection is broken, or the board reset, again and again while it is loaded over a line that makes the load long.
#[test]
fn a_load_goes_on_after_a_broken_line_and_after_a_reset() {
    for resets in [false, true] {
        let (board, port) = board([BadLine::new(7, 3), BadLine::new(8, 3)]);
        let block = tip(0x3333, 9);
        let path = file("long.bin", &block);
        let mut child = Command::new(env!("CARGO_BIN_EXE_designer"))
            .args(["load", &port, &path, "--format", "csv"])
            .stdout(Stdio::piped())
            .spawn()
            .expect("the binary runs");
        for _ in 0..3 {
            thread::sleep(Duration::from_millis(400));
            if resets {
                board.reset();
            } else {
                board.cut();
            }
        }
        let status = child.wait().expect("it ends");
        assert!(status.success());
        let out = scratch("long-back.bin").display().to_string();
        let answer = designer(&["load", &port, "--read-back", &out]);
        assert!(
            answer.status.success(),
            "{}",
            String::from_utf8_lossy(&answer.stderr)
        );
        assert_eq!(fs::read(&out).expect("it was written"), block);
        board.end();
    }
}
