//! Frames on the wire: one per report, and a hello once a second.
//!
//! A frame is a body, its CRC, both stuffed with COBS so that no byte of them is zero, and one zero byte at
//! the end. A reader that joins in the middle, or meets noise, is in step again after the next zero.
//!
//! All numbers are little-endian; signed ones are two's complement. Every body opens alike:
//!
//! | offset | bytes | field |
//! |---|---|---|
//! | 0 | 1 | protocol version, 1 |
//! | 1 | 1 | kind: 1 reading, 2 fault, 3 hello |
//! | 2 | 2 | sequence number; one counter over all kinds, wraps from 65535 to 0. A gap is a lost frame |
//! | 4 | 8 | time since reset, microseconds. Of a reading or fault: the middle of its samples |
//!
//! Kind 1, a reading (27 bytes; on the wire 31 with CRC, COBS and the zero):
//!
//! | offset | bytes | field |
//! |---|---|---|
//! | 12 | 2 | warnings, one bit each: 0 saturated (force and indentation are lower bounds), 1 zero unverified, 2 below zero; none set: the reading is ok |
//! | 14 | 1 | `k` of the pressure rise's unit, 0 to 31 |
//! | 15 | 4 | pressure rise, signed, counts of `1 / 2^k` pascal |
//! | 19 | 4 | force, signed, micronewtons |
//! | 23 | 4 | indentation, signed, nanometres |
//!
//! Kind 2, a fault (13 bytes; on the wire 17): no reading, because
//!
//! | offset | bytes | field |
//! |---|---|---|
//! | 12 | 1 | 1 sensor open, 2 sensor short, 3 zeroing, 4 settling, 5 samples lost, 6 converter stalled; of a transducer on a bus: 16 sensor absent, 17 bus fault, 18 wrong sensor, 19 sensor calibration, 20 sensor busy, 21 sensor memory, 22 sensor saturated, 23 sensor reset, 24 sensor implausible |
//!
//! Kind 3, hello (36 bytes; on the wire 40):
//!
//! | offset | bytes | field |
//! |---|---|---|
//! | 12 | 3 | version of the firmware: major, minor, patch |
//! | 15 | 1 | why the chip was reset last: 0 unknown, 1 power-on, 2 pin, 3 software, 4 watchdog, 5 brown-out, 6 low power |
//! | 16 | 8 | hash of the design whose tables are in the image |
//! | 24 | 4 | time from one report to the next, microseconds |
//! | 28 | 4 | blocks of samples lost since reset |
//! | 32 | 4 | frames dropped since reset because the line was not free |
//!
//! The two bytes after the body are its CRC-16/IBM-3740 (polynomial 0x1021, initial value 0xFFFF, not
//! reflected, no final exclusive-or; check value 0x29B1), low byte first. Python has it as
//! `binascii.crc_hqx(body, 0xFFFF)`.
//!
//! A frame of another version, an unknown kind, code or length is refused as a whole: none of it is a number.

use crate::report::{Fault, Measurement, Microseconds, Report, Warnings};
use core::fmt;
use crc::{CRC_16_IBM_3740, Crc};
use heapless::Vec;
use model_tables::units::{Micronewtons, Nanometres, PressureRise};

/// Version of the layout above.
pub const PROTOCOL_VERSION: u8 = 1;

const HEADER: usize = 12;
const READING: usize = HEADER + 15;
const FAULT: usize = HEADER + 1;
const HELLO: usize = HEADER + 24;
const CRC_BYTES: usize = 2;

/// Longest body with its CRC.
const MAXIMUM_PLAIN: usize = HELLO + CRC_BYTES;

/// Longest frame on the wire: COBS adds one byte to anything below 255, the zero is one more.
pub const MAXIMUM_FRAME: usize = MAXIMUM_PLAIN + 2;

const CHECK: Crc<u16> = Crc::<u16>::new(&CRC_16_IBM_3740);

/// Why the chip was reset last.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum ResetCause {
    /// The chip does not say.
    Unknown,
    /// Power was switched on.
    PowerOn,
    /// The reset pin was pulled.
    Pin,
    /// The firmware asked for it.
    Software,
    /// A watchdog was not fed.
    Watchdog,
    /// The supply sagged.
    BrownOut,
    /// A forbidden entry into a low-power mode.
    LowPower,
}

impl ResetCause {
    const CODES: [(Self, u8); 7] = [
        (Self::Unknown, 0),
        (Self::PowerOn, 1),
        (Self::Pin, 2),
        (Self::Software, 3),
        (Self::Watchdog, 4),
        (Self::BrownOut, 5),
        (Self::LowPower, 6),
    ];
}

impl fmt::Display for ResetCause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Unknown => "unknown",
            Self::PowerOn => "power-on",
            Self::Pin => "pin",
            Self::Software => "software",
            Self::Watchdog => "watchdog",
            Self::BrownOut => "brown-out",
            Self::LowPower => "low power",
        })
    }
}

/// Who is speaking, once a second.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Hello {
    /// When.
    pub time: Microseconds,
    /// Version of the firmware: major, minor, patch.
    pub firmware: [u8; 3],
    /// Why the chip was reset last.
    pub reset_cause: ResetCause,
    /// Hash of the design whose tables are in the image.
    pub design_hash: u64,
    /// From one report to the next, microseconds.
    pub report_period: u32,
    /// Blocks of samples lost since reset.
    pub blocks_lost: u32,
    /// Frames dropped since reset.
    pub frames_dropped: u32,
}

/// What one frame says.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Message {
    /// A report of the signal path.
    Report {
        /// The report.
        report: Report,
        /// `k`: a count of its pressure rise is `1 / 2^k` pascal. 0 to 31; a fault carries none and reads 0.
        pressure_fraction_bits: u8,
    },
    /// Who is speaking.
    Hello(Hello),
}

/// A message and its place in the stream.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Frame {
    /// Counts frames, wraps.
    pub sequence: u16,
    /// What it says.
    pub message: Message,
}

/// Why bytes are not a frame.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum DecodeError {
    /// The stuffing is broken, or there are more bytes than any frame has.
    Stuffing,
    /// Fewer bytes than the shortest frame has.
    Short,
    /// The check value does not fit the bytes.
    Crc,
    /// Another version of the layout.
    Version(u8),
    /// No such kind.
    Kind(u8),
    /// The bytes are not as many as the kind has.
    Length,
    /// A field holds what the layout does not allow; its offset.
    Field(u8),
}

impl fmt::Display for DecodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stuffing => f.write_str("the COBS stuffing is broken or the frame is too long"),
            Self::Short => f.write_str("the frame is too short"),
            Self::Crc => f.write_str("the CRC does not fit"),
            Self::Version(found) => {
                write!(
                    f,
                    "protocol version {found}, this reader knows {PROTOCOL_VERSION}"
                )
            }
            Self::Kind(found) => write!(f, "unknown kind of frame {found}"),
            Self::Length => f.write_str("the length does not fit the kind of frame"),
            Self::Field(offset) => write!(f, "the field at offset {offset} holds no allowed value"),
        }
    }
}

impl core::error::Error for DecodeError {}

/// Bytes of one frame, the closing zero included.
pub type Encoded = Vec<u8, MAXIMUM_FRAME>;

/// The bytes of a frame, ready for the wire.
pub fn encode(frame: &Frame) -> Encoded {
    let mut body = Writer(Vec::new());
    match &frame.message {
        Message::Report {
            report,
            pressure_fraction_bits,
        } => match report.outcome {
            Ok(measurement) => {
                body.header(1, frame.sequence, report.time);
                body.put(measurement.warnings.bits().to_le_bytes());
                body.put([*pressure_fraction_bits]);
                body.put(measurement.pressure_rise.0.to_le_bytes());
                body.put(measurement.force.0.to_le_bytes());
                body.put(measurement.indentation.0.to_le_bytes());
            }
            Err(fault) => {
                body.header(2, frame.sequence, report.time);
                body.put([code_of(&Fault::CODES, fault)]);
            }
        },
        Message::Hello(hello) => {
            body.header(3, frame.sequence, hello.time);
            body.put(hello.firmware);
            body.put([code_of(&ResetCause::CODES, hello.reset_cause)]);
            body.put(hello.design_hash.to_le_bytes());
            body.put(hello.report_period.to_le_bytes());
            body.put(hello.blocks_lost.to_le_bytes());
            body.put(hello.frames_dropped.to_le_bytes());
        }
    }
    body.put(CHECK.checksum(&body.0).to_le_bytes());

    let mut bytes = [0; MAXIMUM_FRAME];
    // The destination has room for the longest frame, so this cannot fail; a zero alone would be an empty frame.
    let stuffed = cobs::try_encode(&body.0, &mut bytes[..MAXIMUM_FRAME - 1]).unwrap_or(0);
    let mut encoded = Encoded::from_array(bytes);
    encoded.truncate(stuffed + 1);
    encoded
}

/// The frame in the bytes between two zeros (the zeros themselves left out).
///
/// # Errors
/// [`DecodeError`] for anything that [`encode`] would not have written.
pub fn decode(stuffed: &[u8]) -> Result<Frame, DecodeError> {
    let mut plain = [0; MAXIMUM_PLAIN];
    if stuffed.contains(&0) {
        return Err(DecodeError::Stuffing);
    }
    let length = cobs::decode(stuffed, &mut plain)
        .map_err(|_| DecodeError::Stuffing)?
        .frame_size();
    let plain = plain.get(..length).ok_or(DecodeError::Stuffing)?;
    let (body, check) = plain
        .split_last_chunk::<CRC_BYTES>()
        .filter(|(body, _)| body.len() >= HEADER)
        .ok_or(DecodeError::Short)?;
    if CHECK.checksum(body) != u16::from_le_bytes(*check) {
        return Err(DecodeError::Crc);
    }
    read_body(body)
}

fn read_body(body: &[u8]) -> Result<Frame, DecodeError> {
    let mut fields = Reader(body);
    let [version, kind] = fields.take()?;
    if version != PROTOCOL_VERSION {
        return Err(DecodeError::Version(version));
    }
    let sequence = u16::from_le_bytes(fields.take()?);
    let time = Microseconds(u64::from_le_bytes(fields.take()?));
    let expected = match kind {
        1 => READING,
        2 => FAULT,
        3 => HELLO,
        _ => return Err(DecodeError::Kind(kind)),
    };
    if body.len() != expected {
        return Err(DecodeError::Length);
    }
    let message = match kind {
        1 => {
            let bits = u16::from_le_bytes(fields.take()?);
            let warnings = Warnings::from_bits(bits).ok_or(DecodeError::Field(12))?;
            let [pressure_fraction_bits] = fields.take()?;
            if pressure_fraction_bits > 31 {
                return Err(DecodeError::Field(14));
            }
            let measurement = Measurement {
                pressure_rise: PressureRise(i32::from_le_bytes(fields.take()?)),
                force: Micronewtons(i32::from_le_bytes(fields.take()?)),
                indentation: Nanometres(i32::from_le_bytes(fields.take()?)),
                warnings,
            };
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
            let fault = named_by(&Fault::CODES, code).ok_or(DecodeError::Field(12))?;
            Message::Report {
                report: Report {
                    time,
                    outcome: Err(fault),
                },
                pressure_fraction_bits: 0,
            }
        }
        _ => {
            let firmware = fields.take()?;
            let [code] = fields.take()?;
            let reset_cause = named_by(&ResetCause::CODES, code).ok_or(DecodeError::Field(15))?;
            Message::Hello(Hello {
                time,
                firmware,
                reset_cause,
                design_hash: u64::from_le_bytes(fields.take()?),
                report_period: u32::from_le_bytes(fields.take()?),
                blocks_lost: u32::from_le_bytes(fields.take()?),
                frames_dropped: u32::from_le_bytes(fields.take()?),
            })
        }
    };
    Ok(Frame { sequence, message })
}

/// Frames out of a stream of bytes that come one at a time.
#[derive(Debug, Default)]
pub struct Decoder {
    bytes: Vec<u8, MAXIMUM_FRAME>,
    /// More bytes came without a zero than any frame has.
    overflowed: bool,
}

impl Decoder {
    /// Takes the next byte; at the zero that closes a frame, what the frame says. Zeros alone say nothing.
    pub fn push(&mut self, byte: u8) -> Option<Result<Frame, DecodeError>> {
        if byte != 0 {
            self.overflowed |= self.bytes.push(byte).is_err();
            return None;
        }
        let said = if core::mem::take(&mut self.overflowed) {
            Some(Err(DecodeError::Stuffing))
        } else if self.bytes.is_empty() {
            None
        } else {
            Some(decode(&self.bytes))
        };
        self.bytes.clear();
        said
    }
}

fn code_of<T: Copy + PartialEq>(codes: &[(T, u8)], wanted: T) -> u8 {
    codes
        .iter()
        .find(|(one, _)| *one == wanted)
        .map_or(0, |(_, code)| *code)
}

fn named_by<T: Copy>(codes: &[(T, u8)], wanted: u8) -> Option<T> {
    codes
        .iter()
        .find(|(_, code)| *code == wanted)
        .map(|(one, _)| *one)
}

/// Fields put one after the other.
struct Writer(Vec<u8, MAXIMUM_PLAIN>);

impl Writer {
    fn put<const N: usize>(&mut self, field: [u8; N]) {
        // MAXIMUM_PLAIN holds the longest body: nothing is ever left out.
        let _ = self.0.extend_from_slice(&field);
    }

    fn header(&mut self, kind: u8, sequence: u16, time: Microseconds) {
        self.put([PROTOCOL_VERSION, kind]);
        self.put(sequence.to_le_bytes());
        self.put(time.0.to_le_bytes());
    }
}

/// Fields taken one after the other.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], DecodeError> {
        let (field, rest) = self.0.split_first_chunk::<N>().ok_or(DecodeError::Length)?;
        self.0 = rest;
        Ok(*field)
    }
}

#[cfg(test)]
mod tests;
