//! What came over the wire: the latest report, a history of the force, the greeting, the answers, and what was lost.

use fingertip::link::command::{self, Command, CommandKind, Outcome, Request};
use fingertip::link::telemetry::{Answer, Decoder, Hello, Message};
use fingertip::signal::report::Report;
use fingertip::status::{Status, Touch};
use fingertip::units::Microseconds;
use std::collections::VecDeque;
use std::time::Duration;

/// A report older than this is no longer the fingertip's state. Of a board that sends few reports: one older than
/// `MISSED` of the periods in its hello, where that is longer.
pub const STALE: Duration = Duration::from_millis(500);
/// Reports missed in a row.
const MISSED: u32 = 3;
/// How far the history reaches back, seconds of the board's clock.
pub const HISTORY: f64 = 10.0;
/// Between points of the history, seconds.
const STEP: f64 = 0.02;
/// Lines of the journal that are kept.
const LINES: usize = 50;

/// A report as people read it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LiveReading {
    /// The board's clock, since its reset.
    pub time: Microseconds,
    /// How far to believe it.
    pub status: Status,
    /// Its values; a fault has none.
    pub values: Option<LiveValues>,
    /// Whether something presses.
    pub touch: Touch,
}

/// The values of a report.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LiveValues {
    /// Pressure over the zero, pascals, and its standard deviation.
    pub pressure_rise_pa: [f64; 2],
    /// Force, newtons, and its standard deviation.
    pub force_n: [f64; 2],
    /// Indentation, millimetres, and its standard deviation.
    pub indentation_mm: [f64; 2],
}

impl LiveReading {
    fn of(report: &Report, pressure_fraction_bits: u8) -> Self {
        let bits = u32::from(pressure_fraction_bits);
        let values = report.outcome.ok().map(|measurement| {
            let sigma = measurement.sigma;
            LiveValues {
                pressure_rise_pa: [
                    measurement.pressure_rise.pascals(bits),
                    sigma.pressure_rise.pascals(bits),
                ],
                force_n: [measurement.force.newtons(), sigma.force.newtons()],
                indentation_mm: [measurement.indentation, sigma.indentation]
                    .map(|length| 1e3 * length.metres()),
            }
        });
        Self {
            time: report.time,
            status: report.status(),
            values,
            touch: report
                .outcome
                .map_or(Touch::Unknown, |measurement| measurement.touch),
        }
    }

    /// Its values if they hold as they stand, else nothing: what is qualified or missing is not for showing.
    pub fn ok(&self) -> Option<LiveValues> {
        self.values.filter(|_| self.status == Status::Ok)
    }
}

/// Frames and bytes since the start.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Counts {
    /// Reports.
    pub reports: u64,
    /// Frames that their numbers say are missing.
    pub missing: u64,
    /// Frames that did not read as one.
    pub broken: u64,
}

/// Everything that is known of a board.
#[derive(Debug, Default)]
pub struct Monitor {
    decoder: Decoder,
    sequence: Option<u16>,
    counts: Counts,
    latest: Option<(LiveReading, Duration)>,
    history: VecDeque<(f64, Option<f64>)>,
    hello: Option<Hello>,
    journal: VecDeque<String>,
    next_command: u16,
    connection: Connection,
}

/// The state of the link.
#[derive(Clone, Debug, Default, Eq, PartialEq)]
pub enum Connection {
    /// Not yet tried.
    #[default]
    Connecting,
    /// There is one.
    Connected,
    /// There is none, and why.
    Lost(String),
}

impl Monitor {
    /// The link is connected again: a board may have been reset since.
    pub fn connected(&mut self) {
        self.connection = Connection::Connected;
        self.decoder = Decoder::default();
        self.sequence = None;
        self.note("connected".to_owned());
    }

    /// The link is lost. What was read before is no longer the fingertip's state.
    pub fn lost(&mut self, reason: &str) {
        let lost = Connection::Lost(reason.to_owned());
        if self.connection != lost {
            self.note(format!("no connection: {reason}"));
        }
        self.connection = lost;
        self.latest = None;
    }

    /// Takes a byte that came at `now`, since the start; gives the report that it completes.
    pub fn hear(&mut self, byte: u8, now: Duration) -> Option<LiveReading> {
        let Ok(frame) = self.decoder.push(byte)? else {
            self.counts.broken += 1;
            return None;
        };
        if let Some(before) = self.sequence.replace(frame.sequence) {
            self.counts.missing += u64::from(frame.sequence.wrapping_sub(before).wrapping_sub(1));
        }
        match frame.message {
            Message::Report {
                report,
                pressure_fraction_bits,
            } => {
                let reading = LiveReading::of(&report, pressure_fraction_bits);
                self.counts.reports += 1;
                self.remember(&reading);
                self.latest = Some((reading, now));
                Some(reading)
            }
            Message::Hello(hello) => {
                self.hello = Some(hello);
                None
            }
            Message::Answer(answer) => {
                self.note(words(&answer));
                None
            }
            // Another program's: this one loads nothing.
            Message::Load(_) => None,
        }
    }

    fn remember(&mut self, reading: &LiveReading) {
        let time = reading.time.0 as f64 * 1e-6;
        let force = reading.ok().map(|values| values.force_n[0]);
        match self.history.back() {
            // Another life of the board.
            Some((last, _)) if time < *last => self.history.clear(),
            Some((last, before)) if time - last < STEP && before.is_some() == force.is_some() => return,
            _ => {}
        }
        self.history.push_back((time, force));
        while self
            .history
            .front()
            .is_some_and(|(first, _)| time - first > HISTORY)
        {
            self.history.pop_front();
        }
    }

    fn note(&mut self, line: String) {
        self.journal.push_back(line);
        if self.journal.len() > LINES {
            self.journal.pop_front();
        }
    }

    /// The bytes of a command, to be sent.
    pub fn command(&mut self, command: Command) -> Vec<u8> {
        self.next_command = self.next_command.wrapping_add(1);
        let sequence = self.next_command;
        self.note(format!("{} {sequence} sent", name(command.kind())));
        command::encode(&Request { sequence, command }).to_vec()
    }

    /// The latest report, unless it is stale.
    pub fn latest(&self, now: Duration) -> Option<LiveReading> {
        let period = self.hello.map_or(0, |hello| hello.report_period);
        let stale = STALE.max(MISSED * Duration::from_micros(period.into()));
        self.latest
            .filter(|(_, came)| now.saturating_sub(*came) < stale)
            .map(|(reading, _)| reading)
    }

    /// Board seconds and force of the last [`HISTORY`]; no force where a report was not ok.
    pub fn history(&self) -> &VecDeque<(f64, Option<f64>)> {
        &self.history
    }

    /// The last greeting.
    pub fn hello(&self) -> Option<&Hello> {
        self.hello.as_ref()
    }

    /// What was counted.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// What happened, the latest last.
    pub fn journal(&self) -> impl DoubleEndedIterator<Item = &str> {
        self.journal.iter().map(String::as_str)
    }

    /// The state of the link.
    pub fn connection(&self) -> &Connection {
        &self.connection
    }
}

fn name(kind: CommandKind) -> &'static str {
    match kind {
        CommandKind::Tare => "tare",
        CommandKind::Undo => "undo",
        CommandKind::Save => "save",
        CommandKind::Info => "info",
        CommandKind::SelfTest => "self-test",
        CommandKind::Rate => "rate",
        CommandKind::Forget => "forget",
        CommandKind::Air => "air",
        CommandKind::Object => "object",
    }
}

fn words(answer: &Answer) -> String {
    let outcome = match answer.outcome {
        Outcome::Done => "done",
        Outcome::Touched => "refused: the fingertip is touched, or may be",
        Outcome::Restless => "refused: the fingertip did not keep still",
        Outcome::OutOfBounds => "refused: the zero is further off than any transducer drifts",
        Outcome::NoReading => "refused: there are no readings",
        Outcome::Busy => "refused: the same is under way",
        Outcome::NothingToUndo => "refused: there is nothing to undo",
        Outcome::ZeroUnverified => "refused: no verified zero; tare first",
        Outcome::MemoryFailed => "failed: the memory did not take it",
        Outcome::NotInImage => "refused: the design in the image has no use for it",
        Outcome::NoSuchObject => "refused: the design has no tables of such an object",
    };
    let findings = match (answer.command, answer.findings) {
        (CommandKind::SelfTest, 0) => ", nothing found".to_owned(),
        (CommandKind::SelfTest, bits) => format!(", findings {bits:#06x}"),
        _ => String::new(),
    };
    format!(
        "{} {}: {outcome}{findings}",
        name(answer.command),
        answer.command_sequence
    )
}
