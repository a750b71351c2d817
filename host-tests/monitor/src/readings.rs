//! What came over the wire: the latest report, a history of the force, the greeting, the answers, and what was lost.

use crate::frames::clock::BoardClock;
use crate::frames::order::{FrameOrder, Order};
use crate::frames::pending::{self, Pending};
use crate::frames::tip::TipChoice;
use fingertip::link::band::BandMessage;
use fingertip::link::command::{Command, CommandKind, Outcome, Request};
use fingertip::link::telemetry::{Hello, Message};
use fingertip::link::tips::{AnyDecoder, AnyFrame};
use fingertip::link::wire::{DecodeError, HAND_VERSION, PROTOCOL_VERSION};
use std::collections::VecDeque;
use std::time::Duration;

mod live;

pub use live::{LiveBand, LiveReading, LiveValues};

/// A report older than this is no longer the fingertip's state. Of a board that sends few reports: one older than
/// `MISSED` of the periods in its hello, where that is longer.
pub const STALE: Duration = Duration::from_millis(500);
/// Reports missed in a row.
const MISSED: u32 = 3;
/// How far the history reaches back, seconds of the board's clock.
pub const HISTORY: f64 = 10.0;
/// Between points of the history, seconds.
const STEP: f64 = 0.02;
/// Most points of the history, also of a board whose clock stands still.
const POINTS: usize = 2 * (HISTORY / STEP) as usize;
/// The board greets once a second. After a silence of this a command may not arrive, or only when nobody expects it.
const SILENCE: Duration = Duration::from_millis(2500);
/// Lines of the journal that are kept.
const LINES: usize = 50;

/// Frames and bytes since the start.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Counts {
    /// Reports.
    pub reports: u64,
    /// Frames that their numbers say are missing.
    pub missing: u64,
    /// Frames that did not read as one.
    pub broken: u64,
    /// Frames that came twice, or after later ones: left out.
    pub out_of_order: u64,
}

/// A point of the history: a report that was ok, or that there is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HistoryPoint {
    /// The board's clock, seconds since its reset.
    pub time: f64,
    /// Its values; `None` of a fault.
    pub values: Option<[f64; 2]>,
}

/// Everything that is known of a board.
#[derive(Clone, Debug, Default)]
pub struct Monitor {
    decoder: AnyDecoder,
    tip: TipChoice,
    order: FrameOrder,
    clock: BoardClock,
    counts: Counts,
    latest: Option<LiveReading>,
    /// When the last frame of any kind came.
    heard: Option<Duration>,
    peak_force_n: Option<f64>,
    history: VecDeque<HistoryPoint>,
    hello: Option<Hello>,
    /// The band of that greeting; `None`: the board states none.
    band: Option<BandMessage>,
    other_version: Option<u8>,
    journal: VecDeque<String>,
    next_command: u16,
    pending: Pending,
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
    /// Of a board of several fingertips, that with this number or name; of a board of one this is left alone.
    #[must_use]
    pub fn of_tip(tip: &str) -> Self {
        Self {
            tip: TipChoice::of(tip),
            ..Self::default()
        }
    }

    /// The fingertip that is followed, of a board of several; `None` of a board of one, and before its greeting.
    pub fn tip(&self) -> Option<String> {
        self.tip.label()
    }

    /// The link is connected again: another board may be at its end.
    pub fn connected(&mut self) {
        self.connection = Connection::Connected;
        self.decoder = AnyDecoder::default();
        self.tip = self.tip.anew();
        self.order = FrameOrder::default();
        self.hello = None;
        self.band = None;
        self.restarted("connected");
    }

    /// The link is lost. What was read before is no longer the fingertip's state.
    pub fn lost(&mut self, reason: &str) {
        let lost = Connection::Lost(reason.to_owned());
        if self.connection != lost {
            self.note(format!("no connection: {reason}"));
        }
        self.connection = lost;
        self.latest = None;
        self.heard = None;
        self.gap();
        self.give_up("the connection was lost");
    }

    /// Takes a byte that came at `now`, since the start; gives the report that it completes, unless it is late or came before.
    pub fn hear(&mut self, byte: u8, now: Duration) -> Option<LiveReading> {
        let frame = match self.decoder.push(byte)? {
            Ok(frame) => frame,
            Err(error) => {
                self.counts.broken += 1;
                if let DecodeError::Version(version) = error {
                    self.met_version(version);
                }
                return None;
            }
        };
        let (sequence, time) = match &frame {
            AnyFrame::One(frame) => (frame.sequence, frame.message.time()),
            AnyFrame::Tips(frame) => (frame.sequence, frame.message.time()),
        };
        let missing = match self.order.place(sequence, time.0) {
            Order::Next { missing } => missing,
            Order::Repeated | Order::Late => {
                self.counts.out_of_order += 1;
                return None;
            }
            Order::Restarted => {
                self.hello = None;
                self.band = None;
                self.restarted("the board was reset");
                0
            }
        };
        self.counts.missing += missing;
        if missing > 0 {
            self.gap();
        }
        self.heard = Some(now);
        let late = self.clock.lateness(time.0, now);
        let message = match frame {
            AnyFrame::One(frame) => frame.message,
            AnyFrame::Tips(frame) => self.tip.message(frame.message)?,
        };
        match message {
            Message::Report {
                report,
                pressure_fraction_bits,
            } => Some(
                self.take(LiveReading {
                    measured: now.saturating_sub(late),
                    missing_before: missing,
                    design: self.hello.map(|hello| hello.design_hash),
                    band: self
                        .band
                        .as_ref()
                        .and_then(|band| LiveBand::of(&report, pressure_fraction_bits, band)),
                    ..LiveReading::of(&report, pressure_fraction_bits)
                }),
            ),
            Message::Hello(hello) => {
                self.hello = Some(hello);
                self.band = None;
                None
            }
            Message::Band(band) => {
                self.band = Some(band);
                None
            }
            Message::Answer(answer) => {
                if answer.command == CommandKind::Object && answer.outcome == Outcome::Done {
                    // The next greeting has the band, if there still is one.
                    self.band = None;
                }
                let own = self.pending.answered(&answer);
                let elsewhere = if own { "" } else { " (not asked for here)" };
                self.note(format!("{}{elsewhere}", pending::describe(&answer)));
                None
            }
            // Another program's: this one loads nothing.
            Message::Load(_) => None,
        }
    }

    /// Takes a report, of the wire or of a log.
    pub fn take(&mut self, reading: LiveReading) -> LiveReading {
        self.counts.reports += 1;
        self.remember(&reading);
        if let Some(values) = reading.ok() {
            let force = values.force_n[0];
            self.peak_force_n = Some(self.peak_force_n.map_or(force, |peak| peak.max(force)));
        }
        self.latest = Some(reading);
        reading
    }

    /// Another run of the board, or another board.
    fn restarted(&mut self, why: &str) {
        self.clock = BoardClock::default();
        self.latest = None;
        self.note(why.to_owned());
        self.give_up("the board was reset");
    }

    fn met_version(&mut self, version: u8) {
        if self.other_version.replace(version) != Some(version) {
            self.note(format!(
                "the board speaks version {version} of the protocol, this monitor versions {PROTOCOL_VERSION} and {HAND_VERSION}"
            ));
        }
    }

    fn give_up(&mut self, why: &str) {
        for (sequence, kind) in self.pending.lost() {
            self.note(format!("{} {sequence}: no answer, {why}", pending::name(kind)));
        }
    }

    fn remember(&mut self, reading: &LiveReading) {
        let time = reading.time.0 as f64 * 1e-6;
        let values = reading
            .ok()
            .map(|values| [values.force_n[0], values.pressure_rise_pa[0]]);
        if let Some(last) = self.history.back().copied() {
            if time < last.time {
                // Another run of the board.
                self.history.clear();
            } else if time - last.time > self.stale().as_secs_f64() {
                // Nothing is known of a silence.
                self.gap();
            } else if time - last.time < STEP && last.values.is_some() == values.is_some() {
                return;
            }
        }
        self.push(HistoryPoint { time, values });
    }

    /// Nothing is known between the last point and the next.
    fn gap(&mut self) {
        if let Some(HistoryPoint {
            time,
            values: Some(_),
        }) = self.history.back().copied()
        {
            self.push(HistoryPoint { time, values: None });
        }
    }

    fn push(&mut self, point: HistoryPoint) {
        self.history.push_back(point);
        while self.history.len() > POINTS
            || self
                .history
                .front()
                .is_some_and(|first| point.time - first.time > HISTORY)
        {
            self.history.pop_front();
        }
    }

    fn note(&mut self, line: String) {
        if self.journal.back() == Some(&line) {
            return;
        }
        self.journal.push_back(line);
        if self.journal.len() > LINES {
            self.journal.pop_front();
        }
    }

    /// The bytes of a command, to be sent; nothing where it cannot arrive now, or one of its kind waits for an answer: the journal
    /// tells why. What a dead line holds back must not reach the board later.
    pub fn command(&mut self, command: Command, now: Duration) -> Option<Vec<u8>> {
        self.tick(now);
        let name = pending::name(command.kind());
        let refused = if self.connection != Connection::Connected {
            Some("there is no connection".to_owned())
        } else if self.heard.is_none_or(|heard| now.saturating_sub(heard) > SILENCE) {
            Some("the board is silent".to_owned())
        } else {
            self.pending
                .waiting(command.kind())
                .map(|sequence| format!("{name} {sequence} waits for its answer"))
        };
        if let Some(reason) = refused {
            self.note(format!("{name} not sent: {reason}"));
            return None;
        }
        self.next_command = self.next_command.wrapping_add(1);
        let sequence = self.next_command;
        self.pending.sent(sequence, command, now);
        self.note(format!("{name} {sequence} sent"));
        Some(self.tip.encode(&Request { sequence, command }))
    }

    /// Gives up answers that are overdue.
    pub fn tick(&mut self, now: Duration) {
        for (sequence, kind) in self.pending.overdue(now) {
            self.note(format!("{} {sequence}: no answer", pending::name(kind)));
        }
    }

    /// A line for the journal.
    pub fn tell(&mut self, line: &str) {
        self.note(line.to_owned());
    }

    /// From here on the peak counts anew.
    pub fn forget_peak(&mut self) {
        self.peak_force_n = None;
    }

    /// How long after a report the next one is missing.
    fn stale(&self) -> Duration {
        let period = self.hello.map_or(0, |hello| hello.report_period);
        STALE.max(MISSED * Duration::from_micros(period.into()))
    }

    /// The latest report, unless it is stale.
    pub fn latest(&self, now: Duration) -> Option<LiveReading> {
        let stale = self.stale();
        self.latest
            .filter(|reading| now.saturating_sub(reading.measured) < stale)
    }

    /// The largest force, newtons, that was ok since the start or [`forget_peak`](Self::forget_peak); none where none was.
    pub fn peak_force_n(&self) -> Option<f64> {
        self.peak_force_n
    }

    /// The last [`HISTORY`] seconds.
    pub fn history(&self) -> &VecDeque<HistoryPoint> {
        &self.history
    }

    /// The last greeting of this run of the board.
    pub fn hello(&self) -> Option<&Hello> {
        self.hello.as_ref()
    }

    /// The band of an unknown object, as the last greeting has it; none where the board states none.
    pub fn band(&self) -> Option<&BandMessage> {
        self.band.as_ref()
    }

    /// The version of the protocol that the board speaks, where it is another one; none where no such frame came.
    pub fn other_version(&self) -> Option<u8> {
        self.other_version
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
