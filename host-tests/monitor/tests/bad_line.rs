//! The monitor on lines as they are: silence, loss, resets, other boards, full disks, readers that stop reading.

use fingertip::link::command::Command;
use fingertip::link::telemetry::{Frame, Hello, Message, encode};
use fingertip::signal::report::{Measurement, Report};
use fingertip::status::{Fault, Touch};
use fingertip::units::Microseconds;
use monitor::readings::{HISTORY, Monitor, STALE};
use std::fs;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::path::PathBuf;
use std::process::{Child, Command as Program, Stdio};
use std::thread;
use std::time::{Duration, Instant};

/// A report of 1.2345 N at a time of the board's clock.
fn report(milliseconds: u64) -> Message {
    let mut measurement = Measurement {
        touch: Touch::Touched,
        ..Measurement::default()
    };
    measurement.force.0 = 1_234_500;
    measurement.indentation.0 = 750_000;
    measurement.pressure_rise.0 = 16_008;
    measurement.sigma.force.0 = 1_000;
    Message::Report {
        report: Report {
            time: Microseconds(1000 * milliseconds),
            outcome: Ok(measurement),
        },
        pressure_fraction_bits: 4,
    }
}

fn bytes(sequence: u16, message: Message) -> Vec<u8> {
    encode(&Frame {
        sequence,
        dropped: 0,
        message,
    })
    .to_vec()
}

fn hear(monitor: &mut Monitor, sequence: u16, message: Message, now: Duration) -> bool {
    let heard: Vec<_> = bytes(sequence, message)
        .into_iter()
        .filter_map(|byte| monitor.hear(byte, now))
        .collect();
    !heard.is_empty()
}

fn connected() -> Monitor {
    let mut monitor = Monitor::default();
    monitor.connected();
    monitor
}

const fn ms(milliseconds: u64) -> Duration {
    Duration::from_millis(milliseconds)
}

/// Whether the history has nothing between its first and its last point.
fn broken(monitor: &Monitor) -> bool {
    let points = monitor.history();
    let inner = points.iter().skip(1).take(points.len().saturating_sub(2));
    points.len() > 2 && inner.clone().any(|point| point.values.is_none())
}

#[test]
fn the_chart_is_broken_by_silence_by_lost_frames_and_by_a_lost_connection() {
    let mut monitor = connected();
    hear(&mut monitor, 0, report(0), ms(0));
    hear(&mut monitor, 1, report(4000), ms(4000));
    assert!(broken(&monitor), "silence: {:?}", monitor.history());

    let mut monitor = connected();
    hear(&mut monitor, 0, report(0), ms(0));
    hear(&mut monitor, 90, report(90), ms(90));
    assert!(broken(&monitor), "lost frames: {:?}", monitor.history());

    let mut monitor = connected();
    hear(&mut monitor, 0, report(0), ms(0));
    monitor.lost("unplugged");
    monitor.connected();
    hear(&mut monitor, 1, report(100), ms(100));
    assert!(broken(&monitor), "lost connection: {:?}", monitor.history());
}

#[test]
fn a_reset_a_repeated_and_a_reordered_frame_are_not_missing() {
    let mut monitor = connected();
    assert!(hear(&mut monitor, 40_000, report(3_600_000), ms(0)));
    assert!(!hear(&mut monitor, 40_000, report(3_600_000), ms(0)));
    assert!(hear(&mut monitor, 40_002, report(3_600_002), ms(2)));
    assert!(!hear(&mut monitor, 40_001, report(3_600_001), ms(3)));
    assert_eq!(monitor.counts().missing, 1);
    assert!(hear(&mut monitor, 0, report(5), ms(100)));
    assert!(hear(&mut monitor, 1, report(6), ms(101)));
    let counts = monitor.counts();
    assert_eq!((counts.reports, counts.missing, counts.out_of_order), (4, 1, 2));
    assert!(monitor.journal().any(|line| line == "the board was reset"));
}

#[test]
fn a_report_that_the_line_held_back_is_not_now() {
    let mut monitor = connected();
    hear(&mut monitor, 0, report(1000), ms(50));
    hear(&mut monitor, 1, report(1010), ms(60));
    assert!(monitor.latest(ms(60)).is_some());
    // Measured at 70 ms, here 5 s later.
    hear(&mut monitor, 2, report(1020), ms(5070));
    assert!(monitor.latest(ms(5070)).is_none());
    hear(&mut monitor, 3, report(6020), ms(5070));
    assert!(monitor.latest(ms(5070)).is_some());
    assert!(monitor.latest(ms(5070) + STALE).is_none());
}

#[test]
fn a_history_of_a_clock_that_stands_still_has_an_end() {
    let mut monitor = connected();
    for sequence in 0..20_000_u16 {
        let message = if sequence % 2 == 0 {
            report(7)
        } else {
            Message::Report {
                report: Report {
                    time: Microseconds(7000),
                    outcome: Err(Fault::Jump),
                },
                pressure_fraction_bits: 0,
            }
        };
        hear(&mut monitor, sequence, message, ms(u64::from(sequence)));
    }
    let most = (200.0 * HISTORY) as usize;
    assert!(monitor.history().len() < most, "{}", monitor.history().len());
}

#[test]
fn a_number_at_the_end_of_its_range_is_no_number_and_a_negative_deviation_no_frame() {
    let mut monitor = connected();
    let with = |change: &dyn Fn(&mut Measurement)| {
        let Message::Report {
            report,
            pressure_fraction_bits,
        } = report(0)
        else {
            unreachable!("a report")
        };
        let mut measurement = report.outcome.expect("it has values");
        change(&mut measurement);
        Message::Report {
            report: Report {
                outcome: Ok(measurement),
                ..report
            },
            pressure_fraction_bits,
        }
    };
    let endless = with(&|measurement| measurement.sigma.force.0 = i32::MAX);
    assert!(hear(&mut monitor, 0, endless, ms(0)));
    let reading = monitor.latest(ms(0)).expect("it came");
    assert!(reading.ok().is_none());
    assert_eq!(
        reading.values.map(|values| values.force_n),
        Some([1.2345, f64::INFINITY])
    );
    let negative = with(&|measurement| measurement.sigma.force.0 = -1);
    assert!(!hear(&mut monitor, 1, negative, ms(1)));
    assert_eq!(monitor.counts().broken, 1);
}

#[test]
fn a_command_is_sent_once_and_only_where_it_can_arrive() {
    let mut monitor = Monitor::default();
    let told = |monitor: &Monitor| monitor.journal().last().map(str::to_owned);
    assert_eq!(monitor.command(Command::Tare, ms(0)), None);
    assert_eq!(
        told(&monitor).as_deref(),
        Some("tare not sent: there is no connection")
    );
    monitor.connected();
    assert_eq!(monitor.command(Command::Tare, ms(0)), None);
    assert_eq!(
        told(&monitor).as_deref(),
        Some("tare not sent: the board is silent")
    );
    hear(&mut monitor, 0, report(0), ms(0));
    // A key that is held down.
    let sent = (0..2000)
        .filter(|_| monitor.command(Command::Tare, ms(1)).is_some())
        .count();
    assert_eq!(sent, 1);
    assert!(monitor.command(Command::Info, ms(1)).is_some());
    assert!(monitor.journal().count() < 10);
    hear(&mut monitor, 1, report(6000), ms(6000));
    monitor.tick(ms(6001));
    assert!(monitor.journal().any(|line| line == "tare 1: no answer"));
    assert!(monitor.command(Command::Tare, ms(6001)).is_some());
    assert_eq!(
        monitor.command(Command::Undo, ms(9000)),
        None,
        "the board is silent"
    );
}

/// Serves each connection in turn to `serve`, on an address of its own.
fn board(serve: impl Fn(TcpStream) + Send + 'static) -> String {
    let server = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = format!("tcp:{}", server.local_addr().expect("bound"));
    thread::spawn(move || {
        for stream in server.incoming().flatten() {
            serve(stream);
        }
    });
    address
}

fn program(arguments: &[&str]) -> Program {
    let mut program = Program::new(env!("CARGO_BIN_EXE_monitor"));
    program
        .args(arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    program
}

fn place(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let path = folder.join(format!("{name}-{}", std::process::id()));
    let _ = fs::remove_file(&path);
    path
}

/// Reports for ever, 500 a second.
fn endless(mut stream: TcpStream) {
    for sequence in 0_u64.. {
        if stream
            .write_all(&bytes(sequence as u16, report(2 * sequence)))
            .is_err()
        {
            return;
        }
        thread::sleep(ms(2));
    }
}

fn ends(child: &mut Child, within: Duration) -> bool {
    let start = Instant::now();
    while start.elapsed() < within {
        if child.try_wait().expect("a child").is_some() {
            return true;
        }
        thread::sleep(ms(20));
    }
    let _ = child.kill();
    false
}

#[test]
fn a_refused_connection_leaves_no_file() {
    let free = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = format!("tcp:{}", free.local_addr().expect("bound"));
    drop(free);
    let log = place("refused.csv");
    let output = program(&[&address, "--csv", &log.display().to_string(), "--for-s", "5"])
        .output()
        .expect("it runs");
    assert!(!output.status.success() && !log.exists());
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(
        error.contains("cannot be opened") && error.lines().count() == 1,
        "{error}"
    );
}

#[test]
fn a_board_of_another_protocol_is_named() {
    let address = board(|mut stream| {
        let mut plain = vec![4, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0];
        let check = crc_16(&plain);
        plain.extend(check.to_le_bytes());
        let mut frame = Vec::new();
        for part in plain.split(|byte| *byte == 0) {
            frame.push(part.len() as u8 + 1);
            frame.extend_from_slice(part);
        }
        frame.push(0);
        for _ in 0..20 {
            if stream.write_all(&frame).is_err() {
                return;
            }
            thread::sleep(ms(20));
        }
        thread::sleep(ms(3000));
    });
    let output = program(&[&address, "--for-s", "1"]).output().expect("it runs");
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success());
    assert!(
        error.contains("speaks version 4 of the protocol, this monitor versions 2 and 3"),
        "{error}"
    );
}

/// CRC-16/IBM-3740, bit by bit.
fn crc_16(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0xFFFF, |check, byte| {
        (0..8).fold(check ^ u16::from(*byte) << 8, |check, _| {
            if check & 0x8000 == 0 {
                check << 1
            } else {
                check << 1 ^ 0x1021
            }
        })
    })
}

#[test]
fn what_had_arrived_when_the_time_is_over_is_written() {
    let address = board(|mut stream| {
        let all: Vec<u8> = (0..20_000_u64)
            .flat_map(|i| bytes(i as u16, report(2 * i)))
            .collect();
        let _ = stream.write_all(&all);
        let _ = stream.read(&mut [0; 1]);
    });
    let output = program(&[&address, "--for-s", "1"]).output().expect("it runs");
    let rows = String::from_utf8_lossy(&output.stdout).lines().count();
    assert_eq!(rows, 20_001, "{}", String::from_utf8_lossy(&output.stderr));
}

#[cfg(unix)]
#[test]
fn it_ends_by_each_signal_also_while_nobody_reads_its_output() {
    use std::os::unix::process::ExitStatusExt as _;
    thread::scope(|scope| {
        for (signal, code) in [("INT", 0), ("TERM", 143), ("HUP", 129), ("QUIT", 131)] {
            for read in [true, false] {
                scope.spawn(move || {
                    let address = board(endless);
                    let mut child = program(&[&address, "--format", "json"]).spawn().expect("it runs");
                    let output = child.stdout.take().expect("a pipe");
                    let mut rows = BufReader::new(output);
                    let mut first = String::new();
                    rows.read_line(&mut first).expect("a row");
                    // Not read: the pipe of 64 KiB is full after half a second.
                    let (reader, _unread) = if read {
                        let reader = thread::spawn(move || {
                            let mut rest = String::new();
                            let _ = rows.read_to_string(&mut rest);
                            rest
                        });
                        (Some(reader), None)
                    } else {
                        (None, Some(rows))
                    };
                    thread::sleep(ms(if read { 100 } else { 1000 }));
                    let killed = Program::new("kill")
                        .args([&format!("-{signal}"), &child.id().to_string()])
                        .status();
                    assert!(killed.is_ok_and(|status| status.success()));
                    assert!(ends(&mut child, Duration::from_secs(5)), "{signal}, read: {read}");
                    let status = child.wait().expect("it ended");
                    assert_eq!((status.code(), status.signal()), (Some(code), None), "{signal}");
                    if let Some(reader) = reader {
                        let rest = reader.join().expect("it reads");
                        assert!(rest.is_empty() || rest.ends_with("}\n"), "a half row: {rest}");
                    }
                });
            }
        }
    });
}

#[test]
fn a_log_says_when_which_board_and_what_is_missing_and_is_played_again() {
    let address = board(|mut stream| {
        let hello = Message::Hello(Hello {
            design_hash: 0xab,
            report_period: 2000,
            ..Hello::default()
        });
        let _ = stream.write_all(&bytes(0, hello));
        for i in [1_u16, 2, 5, 6] {
            let _ = stream.write_all(&bytes(i, report(2 * u64::from(i))));
        }
        let _ = stream.read(&mut [0; 1]);
    });
    let log = place("played.csv");
    let mcap = place("played.mcap");
    let output = program(&[
        &address,
        "--for-s",
        "1",
        "--csv",
        &log.display().to_string(),
        "--mcap",
        &mcap.display().to_string(),
    ])
    .output()
    .expect("it runs");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let text = fs::read_to_string(&log).expect("it was written");
    assert_eq!(text.as_bytes(), output.stdout);
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let header = reader.headers().expect("a header").clone();
    let place = |name: &str| header.iter().position(|one| one == name).expect(name);
    let rows: Vec<csv::StringRecord> = reader.records().map(|row| row.expect("a row")).collect();
    let missing: Vec<&str> = rows.iter().map(|row| &row[place("missing_before")]).collect();
    assert_eq!(missing, ["0", "0", "2", "0"]);
    let today = std::time::SystemTime::now()
        .duration_since(std::time::UNIX_EPOCH)
        .expect("after 1970")
        .as_secs_f64();
    for row in &rows {
        assert_eq!(&row[place("design")], "00000000000000ab");
        let host: f64 = row[place("host_time_s")].parse().expect("seconds");
        assert!((today - host).abs() < 60.0, "{host}");
    }
    let bytes = fs::read(&mcap).expect("it was written");
    let messages: Vec<serde_json::Value> = mcap::MessageStream::new(&bytes)
        .expect("an MCAP file")
        .map(|message| serde_json::from_slice(&message.expect("whole").data).expect("JSON"))
        .collect();
    let forces: Vec<_> = messages
        .iter()
        .map(|message| message["force_n"].as_f64())
        .collect();
    assert_eq!(forces, [Some(1.2345); 4]);

    let again = program(&["--replay", &log.display().to_string(), "--speed", "100"])
        .output()
        .expect("it runs");
    let again = String::from_utf8_lossy(&again.stdout).into_owned();
    let without_host = |text: &str| -> Vec<String> {
        text.lines()
            .map(|line| line.split(',').take(9).collect::<Vec<_>>().join(","))
            .collect()
    };
    assert_eq!(without_host(&again), without_host(&text));
    for path in [log, mcap] {
        fs::remove_file(path).expect("it is there");
    }
}

#[test]
fn a_log_that_is_none_is_refused_on_one_line() {
    let log = place("none.csv");
    for (text, reason) in [
        ("a,b\n1,2\n", "no column `time_ms`"),
        (
            "time_ms,status,touch,pressure_rise_pa,force_n,indentation_mm,sigma_pressure_rise_pa,sigma_force_n,\
             sigma_indentation_mm\n1,fine,touched,1,1,1,1,1,1\n",
            "line 2: `fine` is no status",
        ),
    ] {
        fs::write(&log, text).expect("room");
        let output = program(&["--replay", &log.display().to_string()])
            .output()
            .expect("it runs");
        let error = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success() && output.stdout.is_empty());
        assert!(error.contains(reason) && error.lines().count() == 1, "{error}");
    }
    fs::remove_file(log).expect("it is there");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_told() {
    let address = board(endless);
    let full = fs::OpenOptions::new()
        .write(true)
        .open("/dev/full")
        .expect("Linux has it");
    let output = program(&[&address, "--for-s", "2"])
        .stdout(full)
        .output()
        .expect("it runs");
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success());
    assert!(error.contains("No space left"), "{error}");
}
