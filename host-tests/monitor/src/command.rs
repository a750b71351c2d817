//! `designer monitor`: live readings of a board in a terminal, or as rows in a pipe.
use crate::keys::{KeyAction, Keyboard};
use crate::link::{Address, BAUD, Link, LinkEvent, SILENCE, silence};
use crate::output::capture::Capture;
use crate::output::rows::{Form, Writer};
use crate::output::whole::{RowFile, RowOutput};
use crate::readings::{LiveReading, Monitor};
use crate::signals::Ending;
use crate::source::replay::Replay;
use crate::source::{Source, SourceEvent, take};
use crate::view::{self, ViewContext};
use clap::{Parser, ValueEnum};
use fingertip::link::wire::{HAND_VERSION, PROTOCOL_VERSION};
use ratatui::DefaultTerminal;
use ratatui::crossterm::event::{self, Event as Input, KeyEventKind};
use std::ffi::OsString;
use std::io::{self, ErrorKind, IsTerminal as _};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant, SystemTime};

/// From one picture to the next.
const PICTURE: Duration = Duration::from_millis(50);

/// Shows the readings of a board, from its serial port or the emulated board's socket.
///
/// A force is shown only while its report is `ok`; otherwise the reason is shown. A terminal shows a view with keys; press ? to list
/// them. In a pipe, or with --format csv or json, each report is one row.
#[derive(Debug, Parser)]
#[command(
    name = "designer monitor",
    bin_name = "designer monitor",
    version,
    after_help = "Examples:\n  cargo designer monitor /dev/ttyACM0\n  cargo designer monitor /dev/ttyACM0 --csv grasp.csv\n  \
                  cargo designer monitor /dev/ttyACM0 --for-s 5 --format csv > five-seconds.csv\n  \
                  cargo designer monitor --replay grasp.csv --speed 0.5\n\n\
                  With no board:\n  cargo demo --serve 127.0.0.1:4000\n  cargo designer monitor tcp:127.0.0.1:4000"
)]
struct Arguments {
    /// A serial port (/dev/ttyACM0, COM3) or tcp:HOST:PORT
    #[arg(required_unless_present = "replay")]
    address: Option<Address>,
    /// Speed of the serial port, bits a second
    #[arg(long, value_name = "BAUD", default_value_t = BAUD)]
    baud: u32,
    /// Of a shared line (RS-485, firmware with the feature rs485): give the board the turn after so many milliseconds of silence
    #[arg(long, value_name = "MS", num_args = 0..=1, require_equals = true, default_missing_value = SILENCE, value_parser = silence, conflicts_with = "replay")]
    poll: Option<Duration>,
    /// For a hand: number or name of the tip to show and log
    #[arg(long, value_name = "TIP", default_value = "0")]
    tip: String,
    /// Also write every report to this CSV file; it must not exist yet
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    // The help says "PlotJuggler" as its makers do, without the marks of code.
    #[arg(
        long,
        value_name = "FILE",
        help = "Also write every report to this MCAP file, for Foxglove and PlotJuggler; it must not be there yet"
    )]
    mcap: Option<PathBuf>,
    /// Replay a file written with --csv, without a board
    #[arg(long, value_name = "FILE", conflicts_with = "address")]
    replay: Option<PathBuf>,
    /// Speed of the replay: 1 is the speed of the recording
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, requires = "replay", value_parser = factor)]
    speed: f64,
    /// End after this many seconds
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    for_s: Option<Duration>,
    /// table: the view; csv, json: one row per report [default: table on a terminal, csv otherwise]
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

fn factor(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|factor| (0.01..=1000.0).contains(factor))
        .ok_or_else(|| "not a number from 0.01 to 1000".to_owned())
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
    if let Some(Address::Serial { baud, .. }) = &mut arguments.address {
        *baud = arguments.baud;
    }
    match run(&arguments) {
        Ok(code) => code,
        Err(reason) => {
            eprintln!("error: {reason}");
            ExitCode::FAILURE
        }
    }
}

/// Files that take every report beside what is shown.
#[derive(Default)]
struct Logs {
    csv: Option<Writer<RowFile>>,
    mcap: Option<Capture>,
}

impl Logs {
    fn open(arguments: &Arguments, began: SystemTime) -> Result<Self, String> {
        let csv = arguments.csv.as_ref().map(|path| {
            RowFile::create(path)
                .and_then(|file| Writer::new(Form::Csv, file, began))
                .map_err(|error| format!("{}: {error}; choose another --csv", path.display()))
        });
        let mcap = arguments.mcap.as_ref().map(|path| {
            Capture::create(path, began)
                .map_err(|error| format!("{}: {}; choose another --mcap", path.display(), cause(&error)))
        });
        Ok(Self {
            csv: csv.transpose()?,
            mcap: mcap.transpose()?,
        })
    }

    fn write(&mut self, reading: &LiveReading) -> Result<(), String> {
        if let Some(csv) = &mut self.csv {
            csv.write(reading).map_err(|error| format!("--csv: {error}"))?;
        }
        if let Some(mcap) = &mut self.mcap {
            mcap.write(reading)
                .map_err(|error| format!("--mcap: {}", cause(&error)))?;
        }
        Ok(())
    }

    fn finish(self) -> Result<(), String> {
        match self.mcap {
            Some(mcap) => mcap
                .finish()
                .map_err(|error| format!("--mcap: {}", cause(&error))),
            None => Ok(()),
        }
    }
}

fn run(arguments: &Arguments) -> Result<ExitCode, String> {
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
    let began = SystemTime::now();
    let replay = arguments
        .replay
        .as_ref()
        .map(|path| Replay::open(path, arguments.speed))
        .transpose()?;
    let mut logs = Logs::open(arguments, began)?;
    let ending = Ending::listen().map_err(|error| format!("signals: {error}"))?;
    let (source, name) = match (replay, &arguments.address) {
        (Some(replay), _) => {
            let path = arguments
                .replay
                .as_ref()
                .map_or_else(String::new, |path| path.display().to_string());
            let name = format!("{path} at {} times its pace", replay.speed());
            (Source::Replay(replay), name)
        }
        (None, Some(address)) => (
            Source::Link(Link::start(address.clone(), arguments.poll)),
            address.to_string(),
        ),
        (None, None) => return Err("there is no board to listen to".to_owned()),
    };
    let watch = Watch {
        source,
        name,
        start: Instant::now(),
        began,
        ending: ending.clone(),
        for_s: arguments.for_s,
        tip: arguments.tip.clone(),
        log: arguments.csv.as_ref().map(|path| path.display().to_string()),
    };
    let outcome = match form {
        None => watch.show(&mut logs),
        Some(form) => watch.pipe(form, &mut logs),
    };
    // What was measured stays, also behind an error.
    let finished = logs.finish();
    outcome.and(finished)?;
    Ok(ending.exit_code())
}

/// What the system says, where an error wraps that.
fn cause(error: &dyn std::error::Error) -> String {
    error
        .source()
        .map_or_else(|| error.to_string(), ToString::to_string)
}

/// A source that is watched until the time is over, a signal comes, or nobody wants it.
struct Watch {
    source: Source,
    /// What is watched.
    name: String,
    start: Instant,
    began: SystemTime,
    ending: Ending,
    for_s: Option<Duration>,
    /// Of a hand: the tip that is followed.
    tip: String,
    /// Where rows go.
    log: Option<String>,
}

impl Watch {
    fn over(&self) -> bool {
        self.ending.asked() || self.for_s.is_some_and(|end| self.start.elapsed() >= end)
    }

    /// The view.
    fn show(mut self, logs: &mut Logs) -> Result<(), String> {
        let mut terminal = ratatui::try_init().map_err(|error| format!("the terminal: {error}"))?;
        let outcome = self.show_on(&mut terminal, logs);
        ratatui::restore();
        outcome
    }

    fn show_on(&mut self, terminal: &mut DefaultTerminal, logs: &mut Logs) -> Result<(), String> {
        let mut monitor = Monitor::of_tip(&self.tip);
        let mut keyboard = Keyboard::default();
        let mut context = ViewContext {
            address: self.name.clone(),
            log: self.log.take(),
            replayed: matches!(self.source, Source::Replay(_)),
            ..ViewContext::default()
        };
        // What is shown while the screen stands still, and since when.
        let mut held: Option<(Monitor, Duration)> = None;
        let mut ended = false;
        while !self.over() {
            let next = self.start.elapsed() + PICTURE;
            while let Some(left) = next.checked_sub(self.start.elapsed()) {
                if ended {
                    std::thread::sleep(left);
                    break;
                }
                let Some(event) = self.source.next(self.start.elapsed(), left) else {
                    break;
                };
                let now = self.start.elapsed();
                if take(event, &mut monitor, now, &mut |reading| logs.write(reading))? {
                    monitor.tell("the end of the log");
                    ended = true;
                }
            }
            let now = self.start.elapsed();
            monitor.tick(now);
            context.question = keyboard.line();
            context.help = keyboard.help;
            context.paused = held.is_some();
            let (shown, at) = held.as_ref().map_or((&monitor, now), |(held, at)| (held, *at));
            terminal
                .draw(|frame| view::draw(frame, shown, &context, at))
                .map_err(|error| format!("the terminal: {error}"))?;
            while event::poll(Duration::ZERO).is_ok_and(|ready| ready) {
                let key = match event::read() {
                    Ok(Input::Key(key)) if key.kind == KeyEventKind::Press => key,
                    Ok(_) => continue,
                    Err(error) => return Err(format!("the terminal: {error}")),
                };
                match keyboard.press(key) {
                    Some(KeyAction::Quit) => return Ok(()),
                    Some(KeyAction::Send(command)) => {
                        let bytes = monitor.command(command, now);
                        if let (Some(bytes), Source::Link(link)) = (bytes, &self.source) {
                            link.send(&bytes);
                        }
                    }
                    Some(KeyAction::Pause) => {
                        held = match held {
                            None => Some((monitor.clone(), now)),
                            Some(_) => None,
                        }
                    }
                    Some(KeyAction::Chart) => context.plot = context.plot.next(),
                    Some(KeyAction::ForgetPeak) => monitor.forget_peak(),
                    Some(KeyAction::Tell(line)) => monitor.tell(&line),
                    None => {}
                }
            }
        }
        Ok(())
    }

    /// Rows, until nobody reads them.
    fn pipe(mut self, form: Form, logs: &mut Logs) -> Result<(), String> {
        let mut monitor = Monitor::of_tip(&self.tip);
        let mut output: Option<Writer<RowOutput>> = None;
        let mut connected = false;
        let mut is_told = false;
        let mut read = true;
        loop {
            // What had arrived when the time was over still counts.
            let within = if self.over() { Duration::ZERO } else { PICTURE };
            let Some(event) = self.source.next(self.start.elapsed(), within) else {
                if within.is_zero() {
                    break;
                }
                continue;
            };
            if let SourceEvent::Link(LinkEvent::Lost(reason)) = &event {
                if !connected {
                    return Err(format!(
                        "{} cannot be opened: {reason}; see that the board is plugged in, or serve one with `cargo demo --serve`",
                        self.name
                    ));
                }
                eprintln!("warning: no connection, trying again: {reason}");
            }
            connected |= matches!(event, SourceEvent::Link(LinkEvent::Connected));
            let began = self.began;
            let mut each = |reading: &LiveReading| -> Result<(), String> {
                if !read {
                    return Ok(());
                }
                logs.write(reading)?;
                let written = match &mut output {
                    Some(writer) => writer.write(reading),
                    None => Writer::new(form, RowOutput::new(), began)
                        .and_then(|new| output.insert(new).write(reading)),
                };
                match written {
                    Err(error) if error.kind() == ErrorKind::BrokenPipe => {
                        read = false;
                        Ok(())
                    }
                    written => written.map_err(|error| format!("standard output: {error}")),
                }
            };
            let ended = take(event, &mut monitor, self.start.elapsed(), &mut each)?;
            if ended || !read || self.ending.asked() {
                break;
            }
            if let Some(version) = monitor.other_version().filter(|_| !is_told) {
                is_told = true;
                eprintln!(
                    "warning: the board speaks version {version} of the protocol, this monitor versions {PROTOCOL_VERSION} and {HAND_VERSION}"
                );
            }
        }
        if output.is_none() && read {
            return Err(match monitor.other_version() {
                Some(version) => format!(
                    "{} speaks version {version} of the protocol, this monitor versions {PROTOCOL_VERSION} and {HAND_VERSION}; take the monitor of the \
                     board's firmware",
                    self.name
                ),
                None if monitor.tip().is_some() => {
                    format!(
                        "{}: no report of {}",
                        self.name,
                        monitor.tip().unwrap_or_default()
                    )
                }
                None => format!(
                    "{} sent no report; is it a fingertip's port, at this speed?",
                    self.name
                ),
            });
        }
        Ok(())
    }
}
