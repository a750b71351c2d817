//! A tip's data onto a board, back to what was before, or read back: one command at a time, each repeated until it is answered.
//!
//! No line and no clock here: bytes to send come from [`Loading::next`], frames go to [`Loading::hear`]. A line may lose, double or
//! break frames, and the board may be reset at any time: every command may be repeated, and a load whose begin is gone starts anew.

mod asked;
mod failure;
mod target;

use asked::Asked;
pub use failure::LoadFailure;
use fingertip::link::command::{Command, Request};
use fingertip::link::load::{
    CHUNK, LoadCommand, LoadKind, LoadOutcome, LoadReply, LoadRequest, Piece, READ_BACK,
};
use fingertip::link::telemetry::Message;
use fingertip::link::tips::{AnyDecoder, AnyFrame, TipsMessage};
use model_tables::block::HEAD;
use model_tables::block::read::stated;
use std::time::Duration;
use target::Target;

/// How often a command is sent before it is given up.
const TRIES: u32 = 20;
/// How often a load is begun.
const BEGINNINGS: u32 = 5;
/// How long a line may be gone.
const GONE: Duration = Duration::from_secs(30);
/// How long a board may take to restart.
const RESTART: Duration = Duration::from_secs(10);
/// A board whose clock stands this much lower than before was reset, microseconds: the times of reports lag by less.
const RESET: u64 = 50_000;

/// What is to be done.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum LoadJob {
    /// Load and activate a block.
    Load {
        /// Its bytes.
        block: Vec<u8>,
        /// Its design's hash.
        hash: u64,
        /// Its design's name: a board of one tip may be asked for it by that.
        name: String,
    },
    /// Use what was used before.
    RollBack,
    /// Read the block in use.
    ReadBack,
}

/// What came of it.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Loaded {
    /// The hash of the design in use.
    pub hash: u64,
    /// The tip's name; `None`: the board is no hand.
    pub tip: Option<String>,
    /// Bytes that were read back.
    pub block: Vec<u8>,
    /// Commands that were sent more than once.
    pub repeated: u32,
}

/// A job under way.
#[derive(Debug)]
pub struct Loading {
    job: LoadJob,
    target: Target,
    decoder: AnyDecoder,
    asked: Asked,
    sequence: u16,
    /// When the command was sent last; nothing: it is to be sent.
    sent: Option<Duration>,
    tries: u32,
    beginnings: u32,
    repeated: u32,
    /// Bytes written, or read back.
    done: usize,
    read: Vec<u8>,
    /// After the restart that ends it.
    restart: Option<Duration>,
    /// The board's clock, as far as it was heard.
    board: u64,
    /// Since the command was asked first.
    was_reset: bool,
    /// The restart is taken from a refusal after a reset, which may be one of before the command.
    assumed: bool,
    hash: Option<u64>,
    /// Since when there is no connection.
    gone: Option<(Duration, String)>,
    outcome: Option<Result<Loaded, LoadFailure>>,
}

impl Loading {
    /// Begins a job by asking who is there. `tip` is the tip's number, or its name on a hand; a board of one needs none.
    pub fn new(job: LoadJob, tip: Option<&str>) -> Self {
        let own = match &job {
            LoadJob::Load { name, .. } => Some(name.as_str()),
            LoadJob::RollBack | LoadJob::ReadBack => None,
        };
        Self {
            target: Target::new(tip, own),
            job,
            decoder: AnyDecoder::default(),
            asked: Asked::Info,
            sequence: 0,
            sent: None,
            tries: 0,
            beginnings: 0,
            repeated: 0,
            done: 0,
            read: Vec::new(),
            restart: None,
            board: 0,
            was_reset: false,
            assumed: false,
            hash: None,
            gone: None,
            outcome: None,
        }
    }

    /// What came of it, when it has ended.
    pub fn outcome(&self) -> Option<&Result<Loaded, LoadFailure>> {
        self.outcome.as_ref()
    }

    /// Bytes that are over there.
    pub fn done(&self) -> usize {
        self.done
    }

    /// The bytes of a command, where one is to be sent now.
    pub fn next(&mut self, now: Duration) -> Option<Vec<u8>> {
        if self.outcome.is_some() {
            return None;
        }
        if let Some((since, reason)) = &self.gone {
            if now.saturating_sub(*since) > GONE {
                self.outcome = Some(Err(LoadFailure::NoConnection(reason.clone())));
            }
            return None;
        }
        if self
            .restart
            .is_some_and(|since| now.saturating_sub(since) > RESTART)
        {
            let found = self.hash;
            self.outcome = Some(Err(LoadFailure::NotInUse { found }));
            return None;
        }
        let waits = self
            .sent
            .is_some_and(|sent| now.saturating_sub(sent) < self.asked.patience(self.target.is_hand()));
        if waits {
            return None;
        }
        // Who restarts is asked until the time for it is over.
        if self.tries >= TRIES && self.restart.is_none() {
            self.outcome = Some(Err(LoadFailure::NoAnswer(self.asked.word())));
            return None;
        }
        self.repeated += u32::from(self.tries > 0);
        self.tries += 1;
        self.sent = Some(now);
        let sequence = self.sequence;
        Some(match self.asked {
            Asked::Info => self.target.encode_info(&Request {
                sequence,
                command: Command::Info,
            }),
            Asked::Load(command) => self.target.encode(&LoadRequest { sequence, command }),
        })
    }

    /// The connection is there, again.
    pub fn connected(&mut self) {
        self.gone = None;
        self.sent = None;
        self.tries = 0;
        self.decoder = AnyDecoder::default();
    }

    /// The connection is lost.
    pub fn lost(&mut self, now: Duration, reason: &str) {
        if self.gone.is_none() {
            self.gone = Some((now, reason.to_owned()));
        }
    }

    /// Bytes that came.
    pub fn hear(&mut self, now: Duration, bytes: &[u8]) {
        for &byte in bytes {
            // What is broken is as good as lost.
            if let Some(Ok(frame)) = self.decoder.push(byte)
                && self.outcome.is_none()
            {
                match frame {
                    AnyFrame::One(frame) => self.take(now, &frame.message),
                    AnyFrame::Tips(frame) => self.take_of_a_hand(now, &frame.message),
                }
            }
        }
    }

    fn take(&mut self, now: Duration, message: &Message) {
        self.tick(match message {
            Message::Report { report, .. } => report.time.0,
            Message::Hello(hello) => hello.time.0,
            Message::Answer(answer) => answer.time.0,
            Message::Band(band) => band.time.0,
            Message::Load(LoadReply::Answer { time, .. } | LoadReply::Data { time, .. }) => time.0,
        });
        match message {
            Message::Hello(hello) => {
                self.target.is_one();
                // A tip that it has not is the board's to refuse.
                match self.target.resolve() {
                    Ok(_) => self.greeted(hello.design_hash),
                    Err(failure) => self.outcome = Some(Err(failure)),
                }
            }
            Message::Load(reply) => self.replied(now, reply),
            _ => {}
        }
    }

    fn take_of_a_hand(&mut self, now: Duration, message: &TipsMessage) {
        self.tick(message.time().0);
        if self.target.is_a_hand() && self.asked == Asked::Info {
            // It did not understand who was asked.
            self.sent = None;
            self.tries = 0;
        }
        match message {
            TipsMessage::Board { tips, .. } => self.target.has(*tips),
            TipsMessage::Tip(tip) => {
                self.target.greeted(tip.tip, &tip.name);
                match self.target.resolve() {
                    Ok(Some(number)) if number == tip.tip => self.greeted(tip.design_hash),
                    Ok(_) => {}
                    Err(failure) => self.outcome = Some(Err(failure)),
                }
            }
            TipsMessage::Load { tip, reply } if self.target.number() == Some(*tip) => {
                self.replied(now, reply);
            }
            _ => {}
        }
    }

    /// The board's clock.
    fn tick(&mut self, time: u64) {
        self.was_reset |= time.saturating_add(RESET) < self.board;
        self.board = time;
    }

    fn replied(&mut self, now: Duration, reply: &LoadReply) {
        match *reply {
            LoadReply::Answer {
                kind,
                sequence,
                outcome,
                findings,
                ..
            } if self.is_asked(kind, sequence) => self.answered(now, kind, outcome, findings),
            LoadReply::Data {
                sequence,
                offset,
                bytes,
                ..
            } if self.is_asked(LoadKind::ReadBack, sequence) && offset as usize == self.read.len() => {
                self.read.extend(bytes.as_slice());
                self.done = self.read.len();
                self.read_on();
            }
            _ => {}
        }
    }

    fn is_asked(&self, kind: LoadKind, sequence: u16) -> bool {
        matches!(self.asked, Asked::Load(command) if command.kind() == kind) && sequence == self.sequence
    }

    /// A hello: the begin, or the end after a restart.
    fn greeted(&mut self, hash: u64) {
        self.hash = Some(hash);
        if self.asked != Asked::Info {
            return;
        }
        if self.restart.is_none() {
            return match self.job {
                LoadJob::ReadBack => self.read_on(),
                LoadJob::Load { .. } | LoadJob::RollBack => self.ask(LoadCommand::Arm),
            };
        }
        if !self.was_reset {
            return;
        }
        let expected = match self.job {
            LoadJob::Load { hash, .. } => hash,
            LoadJob::RollBack | LoadJob::ReadBack => hash,
        };
        if hash != expected && std::mem::take(&mut self.assumed) {
            // The reset was one of before the activation, noticed late: the load is forgotten, and goes on from arming.
            self.restart = None;
            return self.ask(LoadCommand::Arm);
        }
        self.outcome = Some(if hash == expected {
            Ok(self.result(hash))
        } else {
            Err(LoadFailure::NotInUse { found: Some(hash) })
        });
    }

    fn result(&mut self, hash: u64) -> Loaded {
        Loaded {
            hash,
            tip: self.target.name(),
            block: std::mem::take(&mut self.read),
            repeated: self.repeated,
        }
    }

    fn answered(&mut self, now: Duration, kind: LoadKind, outcome: LoadOutcome, findings: u16) {
        let ends = matches!(kind, LoadKind::Activate | LoadKind::RollBack);
        match outcome {
            LoadOutcome::Done if ends => self.restarts(now),
            // It had been done, and the answer was lost: the board is restarting, or has.
            LoadOutcome::Busy => self.restarts(now),
            LoadOutcome::NotArmed | LoadOutcome::OutOfOrder if ends && self.was_reset => {
                self.assumed = true;
                self.restarts(now);
            }
            LoadOutcome::Done => self.go_on(kind),
            LoadOutcome::NotArmed if kind != LoadKind::Arm => self.ask(LoadCommand::Arm),
            // The board was reset, or what lies in the slot is not what was sent: from the begin.
            LoadOutcome::OutOfOrder | LoadOutcome::MemoryFailed
                if kind != LoadKind::ReadBack && self.beginnings < BEGINNINGS && self.begin() => {}
            _ => self.outcome = Some(Err(LoadFailure::Refused(kind, outcome, findings))),
        }
    }

    /// The next command after one that is done.
    fn go_on(&mut self, kind: LoadKind) {
        let LoadJob::Load { block, hash, .. } = &self.job else {
            return self.ask(LoadCommand::RollBack);
        };
        let (hash, length) = (*hash, block.len());
        match kind {
            LoadKind::Arm if self.beginnings == 0 => {
                self.begin();
            }
            LoadKind::Verify => self.ask(LoadCommand::Activate { hash }),
            kind => {
                if kind == LoadKind::Chunk {
                    self.done = (self.done + CHUNK).min(length);
                }
                self.write_on();
            }
        }
    }

    /// Begins a load; whether there is one to begin.
    fn begin(&mut self) -> bool {
        let LoadJob::Load { block, .. } = &self.job else {
            return false;
        };
        let (Some((length, check)), Some(tip)) = (stated(block), self.target.number()) else {
            return false;
        };
        self.beginnings += 1;
        self.done = 0;
        self.ask(LoadCommand::Begin { tip, length, check });
        true
    }

    /// The next chunk, or the end of them.
    fn write_on(&mut self) {
        let LoadJob::Load { block, .. } = &self.job else {
            return;
        };
        let rest = block.get(self.done..).unwrap_or(&[]);
        let command = match Piece::of(&rest[..rest.len().min(CHUNK)]) {
            None => LoadCommand::Verify,
            Some(bytes) => LoadCommand::Chunk {
                offset: self.done as u32,
                bytes,
            },
        };
        self.ask(command);
    }

    /// The next part to read, or the end.
    fn read_on(&mut self) {
        let known = self.read.len();
        // The head says how much there is.
        let whole = match stated(&self.read) {
            Some((length, _)) => length as usize,
            None if known < HEAD => HEAD,
            None => known,
        };
        if known < whole {
            self.ask(LoadCommand::ReadBack {
                offset: known as u32,
                length: (whole - known).min(READ_BACK) as u8,
            });
        } else {
            let hash = self.hash.unwrap_or_default();
            self.outcome = Some(Ok(self.result(hash)));
        }
    }

    fn ask(&mut self, command: LoadCommand) {
        self.asked = Asked::Load(command);
        self.fresh();
    }

    /// Waits for the board to come back.
    fn restarts(&mut self, now: Duration) {
        // It may be back already.
        let was_reset = self.was_reset;
        self.asked = Asked::Info;
        self.restart = Some(now);
        self.fresh();
        self.was_reset = was_reset;
    }

    /// Another command than before.
    fn fresh(&mut self) {
        self.sequence = self.sequence.wrapping_add(1);
        self.sent = None;
        self.tries = 0;
        self.was_reset = false;
    }
}
