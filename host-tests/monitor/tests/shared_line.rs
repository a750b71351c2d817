//! The monitor on a shared line (RS-485): a board that is silent until it has the turn.

use fingertip::link::command::{Command, CommandKind, Outcome, read_body};
use fingertip::link::sink::Turn;
use fingertip::link::telemetry::{Answer, Frame, Message, encode};
use fingertip::link::wire::Deframer;
use fingertip::signal::report::{Measurement, Report};
use fingertip::units::Microseconds;
use monitor::link::{Address, Link, LinkEvent};
use monitor::readings::Monitor;
use std::collections::VecDeque;
use std::io::{ErrorKind, Read as _, Write as _};
use std::net::TcpListener;
use std::process::{Command as Program, Output};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::thread;
use std::time::{Duration, Instant};

const LONG: Duration = Duration::from_secs(10);
const QUIET: Duration = Duration::from_micros(Turn::QUIET);

/// Frames that wait on a board of one tip.
const WAITING: usize = 8;

/// What the other end of the line does.
#[derive(Default)]
struct Board {
    /// It takes everything and says nothing.
    is_mute: AtomicBool,
    /// It does not wait for its turn.
    is_rude: AtomicBool,
    /// Turns that it used.
    turns: AtomicU32,
    /// Bytes of the host within [`Turn::QUIET`] of a frame: two at once on a pair of wires.
    collisions: AtomicU32,
}

impl Board {
    /// Serves one connection after the other. A report each millisecond, on a line of no duration, so that no turn lapses.
    fn serve(self: &Arc<Self>) -> String {
        let server = TcpListener::bind("127.0.0.1:0").expect("a port");
        let address = server.local_addr().expect("bound").to_string();
        let board = Arc::clone(self);
        thread::spawn(move || {
            for mut wire in server.incoming().flatten() {
                wire.set_read_timeout(Some(Duration::from_millis(1)))
                    .expect("not zero");
                wire.set_nodelay(true).expect("a socket");
                let (mut turn, mut deframer) = (Turn::HOSTS, Deframer::default());
                let (mut waiting, mut sequence, mut reports) = (VecDeque::new(), 0_u16, 0);
                let (began, mut sent) = (Instant::now(), None::<Instant>);
                loop {
                    let mut byte = [0];
                    let read = match wire.read(&mut byte) {
                        Ok(0) => break,
                        Ok(_) => true,
                        Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {
                            false
                        }
                        Err(_) => break,
                    };
                    let mut add = |message| {
                        waiting.push_back(
                            encode(&Frame {
                                sequence,
                                dropped: 0,
                                message,
                            })
                            .to_vec(),
                        );
                        sequence += 1;
                    };
                    while reports < began.elapsed().as_millis() as u64 {
                        reports += 1;
                        add(report(1000 * reports));
                    }
                    if read {
                        let early = sent.is_some_and(|sent| sent.elapsed() < QUIET);
                        board.collisions.fetch_add(early.into(), Ordering::Relaxed);
                        let request = deframer
                            .push(byte[0])
                            .and_then(|body| read_body(&body.ok()?).ok());
                        if let Some(request) = request {
                            assert_eq!(request.command, Command::Tare);
                            add(answer(1000 * reports, request.sequence));
                        }
                        turn.hear(byte[0], request.is_some(), Microseconds(1));
                    }
                    while waiting.len() > WAITING {
                        waiting.pop_front();
                    }
                    let is_rude = board.is_rude.load(Ordering::Relaxed);
                    if board.is_mute.load(Ordering::Relaxed) || !turn.is_boards(Microseconds(1)) && !is_rude {
                        continue;
                    }
                    board.turns.fetch_add(1, Ordering::Relaxed);
                    for frame in waiting.drain(..) {
                        if wire.write_all(&frame).is_err() {
                            break;
                        }
                        sent = Some(Instant::now());
                        turn.sent(Microseconds(1));
                    }
                    turn.end();
                }
            }
        });
        address
    }
}

/// A report of 1.2345 N at a time of the board's clock, microseconds.
fn report(time: u64) -> Message {
    let mut measurement = Measurement::default();
    measurement.force.0 = 1_234_500;
    Message::Report {
        report: Report {
            time: Microseconds(time),
            outcome: Ok(measurement),
        },
        pressure_fraction_bits: 4,
    }
}

fn answer(time: u64, sequence: u16) -> Message {
    Message::Answer(Answer {
        time: Microseconds(time),
        command: CommandKind::Tare,
        command_sequence: sequence,
        outcome: Outcome::Done,
        findings: 0,
        known: None,
    })
}

/// A link that polls after 3 ms of silence.
fn polled(address: &str) -> Link {
    Link::start(Address::Tcp(address.to_owned()), Some(Duration::from_millis(3)))
}

/// The first event that is wanted.
fn wait(link: &Link, wanted: impl Fn(&LinkEvent) -> bool) -> LinkEvent {
    let began = Instant::now();
    while began.elapsed() < LONG {
        if let Some(event) = link.next(Duration::from_millis(50)).filter(|event| wanted(event)) {
            return event;
        }
    }
    panic!("it does not come");
}

fn run(arguments: &[&str]) -> Output {
    Program::new(env!("CARGO_BIN_EXE_monitor"))
        .args(arguments)
        .output()
        .expect("it runs")
}

#[test]
fn a_board_that_waits_for_its_turn_is_read_and_takes_commands_and_the_two_never_send_at_once() {
    let board = Arc::new(Board::default());
    let link = polled(&board.serve());
    let mut monitor = Monitor::default();
    let began = Instant::now();
    let mut asked = false;
    let answered = |monitor: &Monitor| monitor.journal().any(|line| line.contains("done"));
    while began.elapsed() < LONG && !(answered(&monitor) && monitor.counts().reports > 200) {
        match link.next(Duration::from_millis(20)) {
            Some(LinkEvent::Connected) => monitor.connected(),
            Some(LinkEvent::Bytes(bytes)) => {
                for byte in bytes {
                    let _ = monitor.hear(byte, began.elapsed());
                }
            }
            other => assert_eq!(other, None),
        }
        if monitor.counts().reports > 50 && !asked {
            let bytes = monitor.command(Command::Tare, began.elapsed());
            link.send(&bytes.expect("the board is there"));
            asked = true;
        }
    }
    assert!(
        answered(&monitor) && monitor.counts().reports > 200,
        "{:?}",
        monitor.counts()
    );
    assert_eq!(monitor.counts().broken, 0);
    assert!(board.turns.load(Ordering::Relaxed) > 20);
    assert_eq!(board.collisions.load(Ordering::Relaxed), 0);
}

#[test]
fn a_board_that_stops_answering_is_lost_for_a_reason_and_found_again() {
    let board = Arc::new(Board::default());
    let link = polled(&board.serve());
    wait(&link, |event| matches!(event, LinkEvent::Bytes(_)));
    board.is_mute.store(true, Ordering::Relaxed);
    let lost = wait(&link, |event| !matches!(event, LinkEvent::Bytes(_)));
    assert!(
        matches!(&lost, LinkEvent::Lost(reason) if reason.contains("no answer to polls for 2.5 s") && reason.contains("rs485")),
        "{lost:?}"
    );
    board.is_mute.store(false, Ordering::Relaxed);
    assert_eq!(wait(&link, |_| true), LinkEvent::Connected);
    assert!(matches!(wait(&link, |_| true), LinkEvent::Bytes(_)));
}

#[test]
fn a_board_that_sends_unasked_is_no_board_of_a_shared_line() {
    let board = Arc::new(Board::default());
    board.is_rude.store(true, Ordering::Relaxed);
    // A silence that the board's thread does not make when the computer is busy.
    let link = Link::start(Address::Tcp(board.serve()), Some(Duration::from_millis(500)));
    let lost = wait(&link, |event| matches!(event, LinkEvent::Lost(_)));
    assert!(
        matches!(&lost, LinkEvent::Lost(reason) if reason.contains("leave --poll out")),
        "{lost:?}"
    );
}

#[test]
fn the_monitor_reads_a_shared_line_with_poll_alone() {
    let board = Arc::new(Board::default());
    let address = format!("tcp:{}", board.serve());
    let silent = run(&[&address, "--for-s", "0.5", "--format", "csv"]);
    assert!(!silent.status.success());
    for poll in ["--poll", "--poll=5"] {
        let read = run(&[&address, poll, "--for-s", "1", "--format", "csv"]);
        let text = String::from_utf8_lossy(&read.stdout);
        assert!(
            read.status.success() && text.lines().count() > 50,
            "{poll}: {text}"
        );
        assert!(text.contains(",1.2345"), "{text}");
    }
    board.is_mute.store(true, Ordering::Relaxed);
    let mute = run(&[&address, "--poll", "--for-s", "4", "--format", "csv"]);
    let told = String::from_utf8_lossy(&mute.stderr).into_owned();
    assert!(!mute.status.success() && mute.stdout.is_empty());
    assert!(told.contains("no answer to polls for 2.5 s"), "{told}");
    for wrong in ["--poll=0.5", "--poll=2000", "--poll=soon"] {
        let refused = run(&[&address, wrong]);
        let told = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert!(
            told.contains("not a number of milliseconds from 1 to 1000"),
            "{told}"
        );
    }
}
