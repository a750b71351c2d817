//! Frames from the board: a report each period, a hello once a second, an answer to each command. `PROTOCOL.md` beside this file
//! has the layout of every body.
//!
//! A frame of another version, an unknown kind, code or length is discarded as a whole.

#[cfg(band)]
use crate::link::band::{self, BandMessage};
use crate::link::command::{CommandKind, Outcome};
#[cfg(feature = "load-tip")]
use crate::link::load::{self, LoadReply};
use crate::link::wire::{DecodeError, Deframer, Encoded, PROTOCOL_VERSION, Reader, unstuff};
use crate::signal::report::{Feedback, FeedbackForce, Measurement, Report, Sigma};
use crate::status::{Fault, LastFault, ResetCause, Stored, Touch, Warnings, code_of, named_by};
use crate::units::Microseconds;
use model_tables::table::known::KnownContact;
use model_tables::units::{Micronewtons, Nanometres, PressureRise};

pub(super) const HEADER: usize = 14;
const READING: usize = HEADER + 28;
/// Length for a design with a feedback actuator.
const FEEDBACK: usize = READING + 8;
const FAULT: usize = HEADER + 1;
const HELLO: usize = HEADER + 47;
const ANSWER: usize = HEADER + 6;
/// Length of an answer with the contact from a known indentation.
const KNOWN: usize = ANSWER + 16;

/// Identity and state of the board, once a second and on request.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Hello {
    /// Time when it was made.
    pub time: Microseconds,
    /// Version of the firmware: major, minor, patch.
    pub firmware: [u8; 3],
    /// Cause of the last reset.
    pub reset_cause: ResetCause,
    /// Hash of the design whose tables are in the image.
    pub design_hash: u64,
    /// Version of the layout of these tables.
    pub table_version: u32,
    /// Time from one sent report to the next, microseconds.
    pub report_period: u32,
    /// State of the stored calibration.
    pub stored: Stored,
    /// Cause of the end of the previous run.
    pub last_fault: LastFault,
    /// Unrequested resets in a row.
    pub resets_in_a_row: u8,
    /// Task, line or address of the fault; `last_fault` determines which.
    pub last_fault_detail: u32,
    /// Number of the stored calibration.
    pub stored_sequence: u32,
    /// Samples lost since reset.
    pub samples_lost: u32,
    /// Outliers replaced since reset.
    pub samples_rejected: u32,
    /// Frames dropped since reset because the line was not free.
    pub frames_dropped: u32,
    /// Count since reset of received data that were not a command: frames, and lost stretches of bytes.
    pub commands_refused: u32,
}

/// Answer to a command.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Answer {
    /// Time when it was made.
    pub time: Microseconds,
    /// Kind of the command.
    pub command: CommandKind,
    /// Sequence number of the command.
    pub command_sequence: u16,
    /// Its outcome.
    pub outcome: Outcome,
    /// For a self-test: its findings, one bit each. For an indentation: [`doubts`](model_tables::table::known::doubts).
    pub findings: u16,
    /// The force and curvature at an indentation that the host gave, whose doubts are the findings; `None` in every
    /// other answer.
    pub known: Option<KnownContact>,
}

/// Content of a frame.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Message {
    /// A report of the signal path.
    Report {
        /// The report.
        report: Report,
        /// `k`: a count of its pressure rise is `1 / 2^k` pascal. 0 to 31; a fault carries none and reads 0.
        pressure_fraction_bits: u8,
    },
    /// Identity and state of the board.
    Hello(Hello),
    /// Answer to a command.
    Answer(Answer),
    /// The band that belongs to the hello before it.
    #[cfg(band)]
    Band(BandMessage),
    /// Answer of the loader of a tip's data.
    #[cfg(feature = "load-tip")]
    Load(LoadReply),
}

impl Message {
    /// The board's time. For a report it is the middle of its samples, for other messages the time when they were made.
    pub const fn time(&self) -> Microseconds {
        match self {
            Self::Report { report, .. } => report.time,
            Self::Hello(hello) => hello.time,
            Self::Answer(answer) => answer.time,
            #[cfg(band)]
            Self::Band(band) => band.time,
            #[cfg(feature = "load-tip")]
            Self::Load(LoadReply::Answer { time, .. } | LoadReply::Data { time, .. }) => *time,
        }
    }
}

/// A message and its place in the stream.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Frame {
    /// Number of the frame; wraps.
    pub sequence: u16,
    /// Frames dropped since reset, wraps.
    pub dropped: u16,
    /// Content of the frame.
    pub message: Message,
}

/// The bytes of a frame, ready for the wire.
pub fn encode(frame: &Frame) -> Encoded {
    let mut encoded = Encoded::NOTHING;
    write::<true>(&mut encoded, frame.sequence, frame.dropped, &frame.message);
    encoded
}

/// Writes a frame into the buffer from which it is sent. `OBJECT`: the design of the board has `[object]`; without it, no
/// answer contains a known contact.
pub fn write<const OBJECT: bool>(body: &mut Encoded, sequence: u16, dropped: u16, message: &Message) {
    body.begin();
    let mut header = |kind: u8, time: Microseconds| {
        body.put([PROTOCOL_VERSION, kind]);
        body.put(sequence.to_le_bytes());
        body.put(time.0.to_le_bytes());
        body.put(dropped.to_le_bytes());
    };
    match message {
        Message::Report {
            report,
            pressure_fraction_bits,
        } => match report.outcome {
            Ok(measurement) => {
                header(1, report.time);
                body.put(measurement.warnings.bits().to_le_bytes());
                body.put([*pressure_fraction_bits, code_of(&Touch::CODES, measurement.touch)]);
                body.put(measurement.pressure_rise.0.to_le_bytes());
                body.put(measurement.force.0.to_le_bytes());
                body.put(measurement.indentation.0.to_le_bytes());
                body.put(measurement.sigma.pressure_rise.0.to_le_bytes());
                body.put(measurement.sigma.force.0.to_le_bytes());
                body.put(measurement.sigma.indentation.0.to_le_bytes());
                if let Some(FeedbackForce { force, sigma }) = measurement.feedback.force() {
                    body.put(force.0.to_le_bytes());
                    body.put(sigma.0.to_le_bytes());
                }
            }
            Err(fault) => {
                header(2, report.time);
                body.put([code_of(&Fault::CODES, fault)]);
            }
        },
        Message::Hello(hello) => {
            header(3, hello.time);
            write_hello(body, hello);
        }
        Message::Answer(answer) => {
            header(4, answer.time);
            body.put([answer.command.code()]);
            body.put(answer.command_sequence.to_le_bytes());
            body.put([code_of(&Outcome::CODES, answer.outcome)]);
            body.put(answer.findings.to_le_bytes());
            if OBJECT && let Some(known) = &answer.known {
                write_known(body, known);
            }
        }
        #[cfg(band)]
        Message::Band(message) => {
            header(band::BAND, message.time);
            band::write(body, message);
        }
        #[cfg(feature = "load-tip")]
        Message::Load(reply) => {
            match reply {
                LoadReply::Answer { time, .. } => header(4, *time),
                LoadReply::Data { time, .. } => header(load::DATA, *time),
            }
            load::write_reply(body, reply);
        }
    }
    body.finish();
}

/// Writes the contact from a known indentation.
#[inline]
pub(super) fn write_known(body: &mut Encoded, known: &KnownContact) {
    for number in [
        known.force.0,
        known.force_sigma.0,
        known.curvature,
        known.curvature_sigma,
    ] {
        body.put(number.to_le_bytes());
    }
}

/// Reads the contact from a known indentation. `doubts` are its warnings.
pub(super) fn read_known(fields: &mut Reader<'_>, doubts: u16) -> Result<KnownContact, DecodeError> {
    let mut number = || fields.take().map(i32::from_le_bytes);
    Ok(KnownContact {
        force: Micronewtons(number()?),
        force_sigma: Micronewtons(number()?),
        curvature: number()?,
        curvature_sigma: number()?,
        doubts,
    })
}

pub(super) fn write_hello(body: &mut Encoded, hello: &Hello) {
    body.put(hello.firmware);
    body.put([code_of(&ResetCause::CODES, hello.reset_cause)]);
    body.put(hello.design_hash.to_le_bytes());
    body.put(hello.table_version.to_le_bytes());
    body.put(hello.report_period.to_le_bytes());
    body.put([
        code_of(&Stored::CODES, hello.stored),
        code_of(&LastFault::CODES, hello.last_fault),
        hello.resets_in_a_row,
    ]);
    for number in [
        hello.last_fault_detail,
        hello.stored_sequence,
        hello.samples_lost,
        hello.samples_rejected,
        hello.frames_dropped,
        hello.commands_refused,
    ] {
        body.put(number.to_le_bytes());
    }
}

/// The frame in the bytes between two zeros (the zeros themselves left out).
///
/// # Errors
/// [`DecodeError`] for any bytes that [`encode`] does not write.
pub fn decode(stuffed: &[u8]) -> Result<Frame, DecodeError> {
    read_body(&unstuff(stuffed)?)
}

pub(super) fn read_body(body: &[u8]) -> Result<Frame, DecodeError> {
    if body.len() < HEADER {
        return Err(DecodeError::Short);
    }
    let mut fields = Reader(body);
    let [version, kind] = fields.take()?;
    if version != PROTOCOL_VERSION {
        return Err(DecodeError::Version(version));
    }
    let sequence = u16::from_le_bytes(fields.take()?);
    let time = Microseconds(u64::from_le_bytes(fields.take()?));
    let dropped = u16::from_le_bytes(fields.take()?);
    let frame = |message| Frame {
        sequence,
        dropped,
        message,
    };
    #[cfg(feature = "load-tip")]
    {
        let reply = match kind {
            4 if body.len() == ANSWER => load::read_answer(Reader(fields.0), time),
            load::DATA => Some(load::read_data(Reader(fields.0), time)),
            _ => None,
        };
        if let Some(reply) = reply {
            return Ok(frame(Message::Load(reply?)));
        }
    }
    #[cfg(band)]
    if kind == band::BAND {
        return Ok(frame(Message::Band(band::read(fields, time, HEADER as u8)?)));
    }
    let expected = match kind {
        1 => READING,
        2 => FAULT,
        3 => HELLO,
        4 => ANSWER,
        _ => return Err(DecodeError::Kind(kind)),
    };
    let tells =
        kind == 4 && body.len() == KNOWN && body.get(HEADER) == Some(&CommandKind::Indentation.code());
    let feels = cfg!(feedback) && kind == 1 && body.len() == FEEDBACK;
    if body.len() != expected && !tells && !feels {
        return Err(DecodeError::Length);
    }
    let message = match kind {
        1 => {
            let (mut measurement, pressure_fraction_bits) = read_measurement(&mut fields)?;
            if feels {
                measurement.feedback = read_feedback(&mut fields)?;
            }
            Message::Report {
                report: Report {
                    time,
                    outcome: Ok(measurement),
                },
                pressure_fraction_bits,
            }
        }
        2 => {
            let [code] = fields.take()?;
            let fault = named_by(&Fault::CODES, code).ok_or(DecodeError::Field(14))?;
            Message::Report {
                report: Report {
                    time,
                    outcome: Err(fault),
                },
                pressure_fraction_bits: 0,
            }
        }
        3 => Message::Hello(read_hello(&mut fields, time)?),
        _ => {
            let [command] = fields.take()?;
            let command_sequence = u16::from_le_bytes(fields.take()?);
            let [outcome] = fields.take()?;
            let findings = u16::from_le_bytes(fields.take()?);
            let known = if tells {
                Some(read_known(&mut fields, findings)?)
            } else {
                None
            };
            Message::Answer(Answer {
                time,
                command: CommandKind::from_code(command).ok_or(DecodeError::Field(14))?,
                command_sequence,
                outcome: named_by(&Outcome::CODES, outcome).ok_or(DecodeError::Field(17))?,
                findings,
                known,
            })
        }
    };
    Ok(frame(message))
}

fn read_measurement(fields: &mut Reader<'_>) -> Result<(Measurement, u8), DecodeError> {
    let bits = u16::from_le_bytes(fields.take()?);
    let warnings = Warnings::from_bits(bits).ok_or(DecodeError::Field(14))?;
    let [pressure_fraction_bits, touch] = fields.take()?;
    if pressure_fraction_bits > 31 {
        return Err(DecodeError::Field(16));
    }
    let touch = named_by(&Touch::CODES, touch).ok_or(DecodeError::Field(17))?;
    let mut number = || fields.take().map(i32::from_le_bytes);
    let measurement = Measurement {
        pressure_rise: PressureRise(number()?),
        force: Micronewtons(number()?),
        indentation: Nanometres(number()?),
        sigma: Sigma {
            pressure_rise: PressureRise(number()?),
            force: Micronewtons(number()?),
            indentation: Nanometres(number()?),
        },
        touch,
        warnings,
        feedback: Feedback::NONE,
    };
    let sigma = &measurement.sigma;
    for (deviation, offset) in [
        (sigma.pressure_rise.0, 30),
        (sigma.force.0, 34),
        (sigma.indentation.0, 38),
    ] {
        if deviation < 0 {
            return Err(DecodeError::Field(offset));
        }
    }
    Ok((measurement, pressure_fraction_bits))
}

fn read_feedback(fields: &mut Reader<'_>) -> Result<Feedback, DecodeError> {
    let [force, sigma] = [fields.take()?, fields.take()?].map(i32::from_le_bytes);
    for (number, offset) in [(force, 42), (sigma, 46)] {
        if number < 0 {
            return Err(DecodeError::Field(offset));
        }
    }
    Ok(Feedback::of(FeedbackForce {
        force: Micronewtons(force),
        sigma: Micronewtons(sigma),
    }))
}

pub(super) fn read_hello(fields: &mut Reader<'_>, time: Microseconds) -> Result<Hello, DecodeError> {
    let firmware = fields.take()?;
    let [reset_cause] = fields.take()?;
    let design_hash = u64::from_le_bytes(fields.take()?);
    let table_version = u32::from_le_bytes(fields.take()?);
    let report_period = u32::from_le_bytes(fields.take()?);
    let [stored, last_fault, resets_in_a_row] = fields.take()?;
    let mut number = || fields.take().map(u32::from_le_bytes);
    Ok(Hello {
        time,
        firmware,
        reset_cause: named_by(&ResetCause::CODES, reset_cause).ok_or(DecodeError::Field(17))?,
        design_hash,
        table_version,
        report_period,
        stored: named_by(&Stored::CODES, stored).ok_or(DecodeError::Field(34))?,
        last_fault: named_by(&LastFault::CODES, last_fault).ok_or(DecodeError::Field(35))?,
        resets_in_a_row,
        last_fault_detail: number()?,
        stored_sequence: number()?,
        samples_lost: number()?,
        samples_rejected: number()?,
        frames_dropped: number()?,
        commands_refused: number()?,
    })
}

/// Decodes frames from a stream, one byte at a time.
#[derive(Clone, Debug, Default)]
pub struct Decoder(Deframer);

impl Decoder {
    /// Takes the next byte. At the zero that closes a frame, returns the frame. Zeros alone give nothing.
    pub fn push(&mut self, byte: u8) -> Option<Result<Frame, DecodeError>> {
        let body = self.0.push(byte)?;
        Some(body.and_then(|body| read_body(&body)))
    }
}

#[cfg(test)]
mod tests;
