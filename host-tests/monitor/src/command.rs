//! `designer monitor`: live readings of a board in a terminal, or as rows in a pipe.
use crate::link::{Address, BAUD, Link, LinkEvent};
use crate::readings::{LiveReading, Monitor};
use crate::rows::{Form, Writer};
use crate::view::{self, ViewContext};
use clap::{Parser, ValueEnum};
use fingertip::link::command::Command;
use ratatui::crossterm::event::{self, Event as Input, KeyCode, KeyEvent, KeyEventKind, KeyModifiers};
use std::ffi::OsString;
use std::fs::File;
use std::io::{self, ErrorKind, IsTerminal as _, Write as _};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// From one picture to the next.
const PICTURE: Duration = Duration::from_millis(50);

/// Shows what a board says, from its serial port or the emulated board's socket.
///
/// A force is shown only while its report is `ok`; otherwise the reason is. On a terminal it is a view with keys: t tare, u undo,
/// s save, i info, x self-test, q quit. In a pipe, or with --format csv or json, it is a row a report.
#[derive(Debug, Parser)]
#[command(
    name = "designer monitor",
    bin_name = "designer monitor",
    version,
    after_help = "Examples:\n  cargo designer monitor /dev/ttyACM0\n  cargo designer monitor /dev/ttyACM0 --csv grasp.csv\n  \
                  cargo designer monitor /dev/ttyACM0 --for-s 5 --format csv > five-seconds.csv\n\n\
                  With no board:\n  cargo demo --serve 127.0.0.1:4000\n  cargo designer monitor tcp:127.0.0.1:4000"
)]
struct Arguments {
    /// A serial port (/dev/ttyACM0, COM3) or tcp:HOST:PORT
    address: Address,
    /// Speed of the serial port, bits a second
    #[arg(long, value_name = "BAUD", default_value_t = BAUD)]
    baud: u32,
    /// Also write every report to this CSV file, which must not be there yet
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// End after so many seconds
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    for_s: Option<Duration>,
    /// table: the view; csv, json: a row a report [default: table on a terminal, csv otherwise]
    #[arg(long)]
    format: Option<Format>,
}

#[derive(Clone, Copy, Debug, Eq, PartialEq, ValueEnum)]
enum Format {
    Table,
    Csv,
    Json,
}

fn seconds(text: &str) -> Result<Duration, String> {
    text.parse()
        .ok()
        .and_then(|seconds| Duration::try_from_secs_f64(seconds).ok())
        .ok_or_else(|| "not a number of seconds".to_owned())
}

/// Reads the arguments, the name of the command first, and shows what the board says until it is to end.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let mut arguments = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(error) if error.use_stderr() => {
            let text = error.to_string();
            let first = text.split("\n\n").next().unwrap_or_default();
            let words: Vec<&str> = first.split_whitespace().collect();
            eprintln!("{} (see `designer monitor --help`)", words.join(" "));
            return ExitCode::FAILURE;
        }
        Err(error) => {
            // A closed pipe is no reason to complain.
            let _ = error.print();
            return ExitCode::SUCCESS;
        }
    };
    if let Address::Serial { baud, .. } = &mut arguments.address {
        *baud = arguments.baud;
    }
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => {
            eprintln!("error: {reason}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), String> {
    let terminal = io::stdout().is_terminal();
    let form = match arguments.format {
        Some(Format::Table) if !terminal => {
            return Err("--format table is a view and needs a terminal; take csv or json".to_owned());
        }
        Some(Format::Table) => None,
        Some(Format::Json) => Some(Form::Json),
        None if terminal => None,
        Some(Format::Csv) | None => Some(Form::Csv),
    };
    let mut log = arguments
        .csv
        .as_ref()
        .map(|path| {
            File::create_new(path)
                .and_then(|file| Writer::new(Form::Csv, file))
                .map_err(|error| format!("{}: {error}; choose another --csv", path.display()))
        })
        .transpose()?;
    let keep = |reading: &LiveReading| match &mut log {
        Some(log) => log.write(reading).map_err(|error| format!("--csv: {error}")),
        None => Ok(()),
    };
    match form {
        None => watch(arguments, keep),
        Some(form) => pipe(arguments, form, keep),
    }
}

/// The view.
fn watch(
    arguments: &Arguments,
    mut keep: impl FnMut(&LiveReading) -> Result<(), String>,
) -> Result<(), String> {
    let surroundings = ViewContext {
        address: arguments.address.to_string(),
        log: arguments.csv.as_ref().map(|path| path.display().to_string()),
    };
    let link = Link::start(arguments.address.clone());
    let start = Instant::now();
    let mut terminal = ratatui::try_init().map_err(|error| format!("the terminal: {error}"))?;
    let mut monitor = Monitor::default();
    let mut show = || -> Result<(), String> {
        loop {
            let next = start.elapsed() + PICTURE;
            while let Some(left) = next.checked_sub(start.elapsed()) {
                let Some(event) = link.next(left) else { break };
                take(event, &mut monitor, start.elapsed(), &mut keep)?;
            }
            terminal
                .draw(|frame| view::draw(frame, &monitor, &surroundings, start.elapsed()))
                .map_err(|error| format!("the terminal: {error}"))?;
            while event::poll(Duration::ZERO).is_ok_and(|ready| ready) {
                match event::read() {
                    Ok(Input::Key(key)) if key.kind == KeyEventKind::Press => match asked(key) {
                        Some(Asked::Quit) => return Ok(()),
                        Some(Asked::Command(command)) => link.send(&monitor.command(command)),
                        None => {}
                    },
                    Ok(_) => {}
                    Err(error) => return Err(format!("the terminal: {error}")),
                }
            }
            if arguments.for_s.is_some_and(|end| start.elapsed() >= end) {
                return Ok(());
            }
        }
    };
    let outcome = show();
    ratatui::restore();
    outcome
}

/// Rows, until the time is over or nobody reads them.
fn pipe(
    arguments: &Arguments,
    form: Form,
    mut keep: impl FnMut(&LiveReading) -> Result<(), String>,
) -> Result<(), String> {
    let ended = Arc::new(AtomicBool::new(false));
    let ends = Arc::clone(&ended);
    // Whole rows and no more: the loop below ends between two.
    ctrlc::set_handler(move || ends.store(true, Ordering::Relaxed)).map_err(|error| error.to_string())?;
    let link = Link::start(arguments.address.clone());
    let start = Instant::now();
    let mut monitor = Monitor::default();
    let mut writer = None;
    let mut connected = false;
    while !ended.load(Ordering::Relaxed) && arguments.for_s.is_none_or(|end| start.elapsed() < end) {
        let Some(event) = link.next(PICTURE) else { continue };
        if let LinkEvent::Lost(reason) = &event {
            if !connected {
                return Err(format!(
                    "{} cannot be opened: {reason}; see that the board is plugged in, or serve one with `cargo demo --serve`",
                    arguments.address
                ));
            }
            eprintln!("warning: no connection, trying again: {reason}");
        }
        connected |= event == LinkEvent::Connected;
        let mut write = |reading: &LiveReading| -> Result<bool, String> {
            keep(reading)?;
            let written = match &mut writer {
                Some(writer) => Writer::write(writer, reading),
                None => {
                    Writer::new(form, io::stdout().lock()).and_then(|new| writer.insert(new).write(reading))
                }
            };
            match written {
                Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(false),
                Err(error) => Err(format!("standard output: {error}")),
                Ok(()) => Ok(true),
            }
        };
        let mut read = true;
        take(event, &mut monitor, start.elapsed(), &mut |reading| {
            read = read && write(reading)?;
            Ok(())
        })?;
        if !read {
            return Ok(());
        }
    }
    if writer.is_none() {
        return Err(format!(
            "{} sent no report; is it a fingertip's port, at this speed?",
            arguments.address
        ));
    }
    io::stdout()
        .flush()
        .map_err(|error| format!("standard output: {error}"))
}

/// Takes an event of the link; every report of it goes to `each`.
fn take(
    event: LinkEvent,
    monitor: &mut Monitor,
    now: Duration,
    each: &mut impl FnMut(&LiveReading) -> Result<(), String>,
) -> Result<(), String> {
    match event {
        LinkEvent::Connected => monitor.connected(),
        LinkEvent::Lost(reason) => monitor.lost(&reason),
        LinkEvent::Bytes(bytes) => {
            for byte in bytes {
                if let Some(reading) = monitor.hear(byte, now) {
                    each(&reading)?;
                }
            }
        }
    }
    Ok(())
}

/// What a key asks for.
enum Asked {
    Quit,
    Command(Command),
}

fn asked(key: KeyEvent) -> Option<Asked> {
    match key.code {
        KeyCode::Char('c') if key.modifiers.contains(KeyModifiers::CONTROL) => Some(Asked::Quit),
        KeyCode::Char('q') | KeyCode::Esc => Some(Asked::Quit),
        KeyCode::Char('t') => Some(Asked::Command(Command::Tare)),
        KeyCode::Char('u') => Some(Asked::Command(Command::Undo)),
        KeyCode::Char('s') => Some(Asked::Command(Command::Save { gain: None })),
        KeyCode::Char('i') => Some(Asked::Command(Command::Info)),
        KeyCode::Char('x') => Some(Asked::Command(Command::SelfTest { indentation: 0 })),
        _ => None,
    }
}
