//! Version 3 of the protocol: frames and commands of a board with several fingertips (tips). `PROTOCOL.md` beside this file has the
//! layout of every body.
//!
//! The readings of one instant share one frame. Warnings, faults and answers are those of version 2.

mod deviation;
mod read;

#[cfg(band)]
use crate::link::band::{self, BandMessage};
use crate::link::command::{self, Outcome, Request};
#[cfg(feature = "load-tip")]
use crate::link::load::{self, LoadCommand, LoadReply, LoadRequest};
use crate::link::telemetry::{self, Answer, Frame, Hello};
use crate::link::wire::{DecodeError, Deframer, Encoded, HAND_VERSION, unstuff};
use crate::signal::report::Report;
use crate::status::{Fault, Stored, Touch, code_of};
use crate::units::Microseconds;
use heapless::{String, Vec};

#[cfg(feature = "load-tip")]
pub use read::read_load;
pub use read::{read_body, read_request};

/// Largest number of tips of a board.
pub const MAX_TIPS: usize = 12;
/// Largest length of a tip's name, bytes.
pub const NAME: usize = 32;
/// Tip number of a command to all tips.
pub const ALL_TIPS: u8 = 255;

const BOARD: u8 = 3;
const ANSWER: u8 = 4;
const READINGS: u8 = 5;
const TIP: u8 = 6;

/// Whether the image has the command `object` and the contact from a known indentation. It has both if the design of a tip has
/// `[object]`, or if such a design may be loaded.
const OBJECT: bool = cfg!(any(object, not(hand), feature = "load-tip"));

/// Bytes of a tip in a frame of readings.
const READING_BYTES: usize = 18;
const FAULTY: u8 = 1 << 7;

/// Content of a frame of version 3.
#[allow(
    clippy::large_enum_variant,
    reason = "there is no allocator to box a variant with"
)]
#[derive(Clone, Debug, PartialEq)]
pub enum TipsMessage {
    /// The reports of all tips at one instant, in the order of the tips.
    Readings {
        /// Time of the reports.
        time: Microseconds,
        /// `k`: a count of their pressure rises is `1 / 2^k` pascal.
        pressure_fraction_bits: u8,
        /// One for each tip.
        reports: Vec<Report, MAX_TIPS>,
    },
    /// The board: the fields of a hello of version 2. The hash is that of the hand, and the stored calibration is that of tip 0.
    Board {
        /// The hello.
        hello: Hello,
        /// Number of tips of the board.
        tips: u8,
    },
    /// The hello of a tip, once a second and on request.
    Tip(TipHello),
    /// Answer to a command to a tip.
    Answer {
        /// The tip.
        tip: u8,
        /// The answer.
        answer: Answer,
    },
    /// The band of a tip. It belongs to the hello before it.
    #[cfg(band)]
    Band {
        /// The tip.
        tip: u8,
        /// The band.
        band: BandMessage,
    },
    /// Answer to a command that loads a tip, or data of the tip in use.
    #[cfg(feature = "load-tip")]
    Load {
        /// The tip.
        tip: u8,
        /// The answer, or the data.
        reply: LoadReply,
    },
}

/// The hello of a tip.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct TipHello {
    /// Time when it was made.
    pub time: Microseconds,
    /// Its number, from 0.
    pub tip: u8,
    /// Hash of its design.
    pub design_hash: u64,
    /// Version of its tables' layout.
    pub table_version: u32,
    /// Time from one sent report of the tip to the next, microseconds.
    pub report_period: u32,
    /// State of its stored calibration.
    pub stored: Stored,
    /// Number of that calibration.
    pub stored_sequence: u32,
    /// Samples replaced since reset.
    pub samples_rejected: u32,
    /// Its name.
    pub name: String<NAME>,
}

impl TipsMessage {
    /// The board's time.
    pub fn time(&self) -> Microseconds {
        match self {
            Self::Readings { time, .. } => *time,
            Self::Board { hello, .. } => hello.time,
            Self::Tip(hello) => hello.time,
            Self::Answer { answer, .. } => answer.time,
            #[cfg(band)]
            Self::Band { band, .. } => band.time,
            #[cfg(feature = "load-tip")]
            Self::Load {
                reply: LoadReply::Answer { time, .. } | LoadReply::Data { time, .. },
                ..
            } => *time,
        }
    }
}

/// A message of version 3 and its place in the stream.
#[derive(Clone, Debug, PartialEq)]
pub struct TipsFrame {
    /// Number of the frame; wraps.
    pub sequence: u16,
    /// Frames dropped since reset, wraps.
    pub dropped: u16,
    /// Its content.
    pub message: TipsMessage,
}

/// Buffer for a frame, with its number and the number of frames dropped before it.
#[derive(Debug)]
pub struct FrameStart<'a> {
    /// The frame.
    pub body: &'a mut Encoded,
    /// Its number.
    pub sequence: u16,
    /// Frames dropped since reset.
    pub dropped: u16,
}

impl<'a> FrameStart<'a> {
    fn header(self, kind: u8, time: Microseconds) -> &'a mut Encoded {
        self.body.begin();
        self.body.put([HAND_VERSION, kind]);
        self.body.put(self.sequence.to_le_bytes());
        self.body.put(time.0.to_le_bytes());
        self.body.put(self.dropped.to_le_bytes());
        self.body
    }

    /// Writes a frame of readings. `reports` has, for each tip, its report and the number of fraction bits that its pressures
    /// have in addition to those of the frame.
    pub fn readings<'r>(
        self,
        time: Microseconds,
        pressure_fraction_bits: u8,
        reports: impl ExactSizeIterator<Item = (&'r Report, u32)>,
    ) {
        let body = self.header(READINGS, time);
        body.put([reports.len() as u8, pressure_fraction_bits]);
        for (tip, (report, shift)) in reports.enumerate() {
            write_reading(body, tip as u8, report, shift);
        }
        body.finish();
    }

    /// Writes the hello of the board.
    pub fn board(self, hello: &Hello, tips: u8) {
        let body = self.header(BOARD, hello.time);
        telemetry::write_hello(body, hello);
        body.put([tips]);
        body.finish();
    }

    /// Writes the hello of a tip, from the fields of a hello of version 2. A longer name is cut to its first [`NAME`] bytes.
    pub fn tip(self, tip: u8, name: &str, hello: &Hello) {
        let body = self.header(TIP, hello.time);
        body.put([tip]);
        body.put(hello.design_hash.to_le_bytes());
        for number in [hello.table_version, hello.report_period] {
            body.put(number.to_le_bytes());
        }
        body.put([code_of(&Stored::CODES, hello.stored)]);
        for number in [hello.stored_sequence, hello.samples_rejected] {
            body.put(number.to_le_bytes());
        }
        let name = name.as_bytes();
        let name = name.get(..NAME).unwrap_or(name);
        body.put([name.len() as u8]);
        for &byte in name {
            body.put([byte]);
        }
        body.finish();
    }

    /// Writes the answer to a command to a tip.
    pub fn answer(self, tip: u8, answer: &Answer) {
        let body = self.header(ANSWER, answer.time);
        body.put([tip, answer.command.code()]);
        body.put(answer.command_sequence.to_le_bytes());
        body.put([code_of(&Outcome::CODES, answer.outcome)]);
        body.put(answer.findings.to_le_bytes());
        if OBJECT && let Some(known) = &answer.known {
            telemetry::write_known(body, known);
        }
        body.finish();
    }

    /// The band of a tip.
    #[cfg(band)]
    pub fn band(self, tip: u8, message: &BandMessage) {
        let body = self.header(band::BAND, message.time);
        body.put([tip]);
        band::write(body, message);
        body.finish();
    }

    /// Writes the answer to a command that loads a tip, or data of the tip in use.
    #[cfg(feature = "load-tip")]
    pub fn load(self, tip: u8, reply: &LoadReply) {
        let (kind, time) = match reply {
            LoadReply::Answer { time, .. } => (ANSWER, *time),
            LoadReply::Data { time, .. } => (load::DATA, *time),
        };
        let body = self.header(kind, time);
        body.put([tip]);
        load::write_reply(body, reply);
        body.finish();
    }
}

fn write_reading(body: &mut Encoded, tip: u8, report: &Report, shift: u32) {
    match &report.outcome {
        Ok(measurement) => {
            let touch = code_of(&Touch::CODES, measurement.touch);
            body.put([tip | touch << 4]);
            body.put(measurement.warnings.bits().to_le_bytes());
            body.put((measurement.pressure_rise.0 >> shift).to_le_bytes());
            body.put(measurement.force.0.to_le_bytes());
            body.put(measurement.indentation.0.to_le_bytes());
            let sigma = &measurement.sigma;
            body.put([
                deviation::eighths(sigma.pressure_rise.0 >> shift),
                deviation::eighths(sigma.force.0),
                deviation::eighths(sigma.indentation.0),
            ]);
        }
        Err(fault) => {
            body.put([tip | FAULTY, code_of(&Fault::CODES, *fault), 0]);
            body.put([0; 15]);
        }
    }
}

/// The bytes of a command to a tip, or to [`ALL_TIPS`].
pub fn encode_request(tip: u8, request: &Request) -> Encoded {
    with_tip(tip, &command::encode(request))
}

/// The bytes of a command that loads a tip. `load begin` already contains its tip in the same place, so the tip is not added again.
#[cfg(feature = "load-tip")]
pub fn encode_load(tip: u8, request: &LoadRequest) -> Encoded {
    let inner = load::encode(request);
    match request.command {
        LoadCommand::Begin { .. } => of_version_3(&inner, &[]),
        _ => with_tip(tip, &inner),
    }
}

/// A command of version 2 with its tip.
fn with_tip(tip: u8, inner: &Encoded) -> Encoded {
    of_version_3(inner, &[tip])
}

/// A command of version 2 with these bytes before its arguments.
fn of_version_3(inner: &Encoded, tip: &[u8]) -> Encoded {
    let mut body = Encoded::NOTHING;
    body.begin();
    // `inner` was just encoded, so it is a valid frame.
    let plain = inner
        .as_slice()
        .split_last()
        .and_then(|(_, stuffed)| unstuff(stuffed).ok());
    if let Some(plain) = plain {
        let (head, payload) = plain.split_at(plain.len().min(4));
        for &byte in [HAND_VERSION].iter().chain(&head[1..]).chain(tip).chain(payload) {
            body.put([byte]);
        }
    }
    body.finish();
    body
}

/// A frame of either version.
#[allow(
    clippy::large_enum_variant,
    reason = "there is no allocator to box a variant with"
)]
#[derive(Clone, Debug, PartialEq)]
pub enum AnyFrame {
    /// From a board with one fingertip.
    One(Frame),
    /// From a board with several fingertips.
    Tips(TipsFrame),
}

/// Decodes frames of either version from a stream, one byte at a time.
#[derive(Clone, Debug, Default)]
pub struct AnyDecoder(Deframer);

impl AnyDecoder {
    /// Takes the next byte. At the zero that closes a frame, returns the frame. Zeros alone give nothing.
    pub fn push(&mut self, byte: u8) -> Option<Result<AnyFrame, DecodeError>> {
        let body = self.0.push(byte)?;
        Some(body.and_then(|body| match body.first() {
            Some(&HAND_VERSION) => read_body(&body).map(AnyFrame::Tips),
            _ => telemetry::read_body(&body).map(AnyFrame::One),
        }))
    }
}

#[cfg(test)]
mod tests;
