//! Commands from the host to the board. `PROTOCOL.md` beside this file has the layout of every body.
//!
//! Each command is answered once: at once, or when its action has succeeded or failed. A frame that is not a command is counted and
//! not answered, because its sender is not known.

use crate::link::wire::{DecodeError, Encoded, PROTOCOL_VERSION, Reader, unstuff};
use crate::signal::calibration::LARGEST_GAIN;
use crate::signal::design::NoSuchObject;
use crate::signal::zero::surroundings::AirRefusal;
use crate::signal::zero::tare::TareRefusal;
use crate::status::{code_of, named_by};
use model_tables::table::law::Touched;

const HEADER: usize = 4;

/// A command from the host.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Command {
    /// Take a new zero. The host asserts that the fingertip is unloaded.
    Tare,
    /// Take back the last commanded zero.
    Undo,
    /// Store zero and gain for the next start.
    Save {
        /// A new gain trim, parts in a million added to the pressure rise. `None` keeps the current trim.
        gain: Option<i32>,
    },
    /// Send a hello.
    Info,
    /// Run the self-test.
    SelfTest {
        /// Present indentation of the fingertip, nanometres. 0 means unknown.
        indentation: i32,
    },
    /// Send only one report out of `every`.
    Rate {
        /// 1 to 1000.
        every: u16,
    },
    /// Clear the stored calibration. The next zero is a first zero.
    Forget,
    /// The air pressure around an absolute transducer, measured by the host.
    Air {
        /// Pascals absolute.
        pascals: i32,
    },
    /// Select the object that is touched from now on.
    Object(Touched),
    /// The hand gives a known indentation of the fingertip.
    Indentation {
        /// Nanometres, above 0.
        known: i32,
    },
}

/// The kind of a command, without its arguments.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum CommandKind {
    /// [`Command::Tare`].
    Tare,
    /// [`Command::Undo`].
    Undo,
    /// [`Command::Save`].
    Save,
    /// [`Command::Info`].
    Info,
    /// [`Command::SelfTest`].
    SelfTest,
    /// [`Command::Rate`].
    Rate,
    /// [`Command::Forget`].
    Forget,
    /// [`Command::Air`].
    Air,
    /// [`Command::Object`].
    Object,
    /// [`Command::Indentation`].
    Indentation,
}

impl CommandKind {
    /// Every kind with its code on the wire.
    pub const CODES: [(Self, u8); 10] = [
        (Self::Tare, 0x81),
        (Self::Undo, 0x82),
        (Self::Save, 0x83),
        (Self::Info, 0x84),
        (Self::SelfTest, 0x85),
        (Self::Rate, 0x86),
        (Self::Forget, 0x87),
        (Self::Object, 0x88),
        (Self::Indentation, 0x89),
        (Self::Air, 0x8A),
    ];

    /// Code of the kind on the wire.
    pub fn code(self) -> u8 {
        code_of(&Self::CODES, self)
    }

    /// The kind with this code. `None` for an unknown code.
    pub fn from_code(code: u8) -> Option<Self> {
        named_by(&Self::CODES, code)
    }
}

impl Command {
    /// Kind of the command.
    pub const fn kind(self) -> CommandKind {
        match self {
            Self::Tare => CommandKind::Tare,
            Self::Undo => CommandKind::Undo,
            Self::Save { .. } => CommandKind::Save,
            Self::Info => CommandKind::Info,
            Self::SelfTest { .. } => CommandKind::SelfTest,
            Self::Rate { .. } => CommandKind::Rate,
            Self::Forget => CommandKind::Forget,
            Self::Air { .. } => CommandKind::Air,
            Self::Object(_) => CommandKind::Object,
            Self::Indentation { .. } => CommandKind::Indentation,
        }
    }
}

/// Outcome of a command.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Outcome {
    /// It is done.
    Done,
    /// The fingertip is touched, or may be.
    Touched,
    /// The fingertip did not keep still.
    Restless,
    /// The zero is further from its expected value than any transducer drifts.
    OutOfBounds,
    /// There are no readings.
    NoReading,
    /// The same or a similar action is under way.
    Busy,
    /// There is nothing to undo.
    NothingToUndo,
    /// There is no verified zero to be stored: tare first.
    ZeroUnverified,
    /// The memory write failed. The previous calibration stays in use.
    MemoryFailed,
    /// The design in the image does not use this command.
    NotInImage,
    /// There are no tables for this object.
    NoSuchObject,
    /// More saves than the memory endures for ten years. The next save is possible after 6.5 minutes, or the time that PROTOCOL.md states.
    SavedTooOften,
}

impl Outcome {
    /// Every outcome with its code on the wire.
    pub const CODES: [(Self, u8); 12] = [
        (Self::Done, 0),
        (Self::Touched, 1),
        (Self::Restless, 2),
        (Self::OutOfBounds, 3),
        (Self::NoReading, 4),
        (Self::Busy, 5),
        (Self::NothingToUndo, 6),
        (Self::ZeroUnverified, 7),
        (Self::MemoryFailed, 8),
        (Self::NoSuchObject, 9),
        (Self::NotInImage, 14),
        (Self::SavedTooOften, 16),
    ];
}

impl From<AirRefusal> for Outcome {
    fn from(refusal: AirRefusal) -> Self {
        match refusal {
            AirRefusal::NotInDesign => Self::NotInImage,
            AirRefusal::OutOfBounds => Self::OutOfBounds,
        }
    }
}

impl From<NoSuchObject> for Outcome {
    fn from(NoSuchObject: NoSuchObject) -> Self {
        Self::NoSuchObject
    }
}

impl From<TareRefusal> for Outcome {
    fn from(refusal: TareRefusal) -> Self {
        match refusal {
            TareRefusal::Touched => Self::Touched,
            TareRefusal::Restless => Self::Restless,
            TareRefusal::OutOfBounds => Self::OutOfBounds,
            TareRefusal::NoReading => Self::NoReading,
            TareRefusal::Busy => Self::Busy,
            TareRefusal::NothingToUndo => Self::NothingToUndo,
        }
    }
}

/// A command with the number its sender gave it.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Request {
    /// Sequence number; the answer repeats it.
    pub sequence: u16,
    /// The command.
    pub command: Command,
}

/// The bytes of a request, ready for the wire.
pub fn encode(request: &Request) -> Encoded {
    let mut body = Encoded::NOTHING;
    body.begin();
    body.put([PROTOCOL_VERSION, request.command.kind().code()]);
    body.put(request.sequence.to_le_bytes());
    match request.command {
        Command::Tare | Command::Undo | Command::Info | Command::Forget => {}
        Command::Save { gain } => body.put(gain.unwrap_or(i32::MIN).to_le_bytes()),
        Command::SelfTest { indentation } => body.put(indentation.to_le_bytes()),
        Command::Indentation { known } => body.put(known.to_le_bytes()),
        Command::Rate { every } => body.put(every.to_le_bytes()),
        Command::Air { pascals } => body.put(pascals.to_le_bytes()),
        Command::Object(touched) => {
            let (code, radius) = touched.code();
            body.put([code]);
            body.put(radius.to_le_bytes());
        }
    }
    body.finish();
    body
}

/// The request in the bytes between two zeros (the zeros themselves left out).
///
/// # Errors
/// [`DecodeError`] for any bytes that [`encode`] does not write for a valid request.
pub fn decode(stuffed: &[u8]) -> Result<Request, DecodeError> {
    read_body(&unstuff(stuffed)?)
}

/// The request of a body.
///
/// # Errors
/// As [`decode`].
pub fn read_body(body: &[u8]) -> Result<Request, DecodeError> {
    read_known_body::<true>(body)
}

/// The same for a board with `[object]` in its design, or without: without `[object]`, [`Command::Object`] and
/// [`Command::Indentation`] are unknown commands.
///
/// # Errors
/// As [`decode`].
#[inline]
pub fn read_known_body<const OBJECT: bool>(body: &[u8]) -> Result<Request, DecodeError> {
    if body.len() < HEADER {
        return Err(DecodeError::Short);
    }
    let mut fields = Reader(body);
    let [version, code] = fields.take()?;
    if version != PROTOCOL_VERSION {
        return Err(DecodeError::Version(version));
    }
    let kind = CommandKind::from_code(code).ok_or(DecodeError::Kind(code))?;
    let sequence = u16::from_le_bytes(fields.take()?);
    let command = match kind {
        CommandKind::Tare => Command::Tare,
        CommandKind::Undo => Command::Undo,
        CommandKind::Info => Command::Info,
        CommandKind::Forget => Command::Forget,
        CommandKind::Save => {
            let gain = i32::from_le_bytes(fields.take()?);
            let largest = LARGEST_GAIN.unsigned_abs();
            match gain {
                i32::MIN => Command::Save { gain: None },
                gain if gain.unsigned_abs() <= largest => Command::Save { gain: Some(gain) },
                _ => return Err(DecodeError::Field(4)),
            }
        }
        CommandKind::SelfTest => {
            let indentation = i32::from_le_bytes(fields.take()?);
            if indentation < 0 {
                return Err(DecodeError::Field(4));
            }
            Command::SelfTest { indentation }
        }
        CommandKind::Air => Command::Air {
            pascals: i32::from_le_bytes(fields.take()?),
        },
        CommandKind::Rate => {
            let every = u16::from_le_bytes(fields.take()?);
            if !(1..=1000).contains(&every) {
                return Err(DecodeError::Field(4));
            }
            Command::Rate { every }
        }
        CommandKind::Object if OBJECT => {
            let [shape] = fields.take()?;
            let radius = i32::from_le_bytes(fields.take()?);
            Command::Object(Touched::of(shape, radius).ok_or(DecodeError::Field(4))?)
        }
        CommandKind::Indentation if OBJECT => {
            let known = i32::from_le_bytes(fields.take()?);
            if known <= 0 {
                return Err(DecodeError::Field(4));
            }
            Command::Indentation { known }
        }
        CommandKind::Object | CommandKind::Indentation => return Err(DecodeError::Kind(code)),
    };
    if fields.0.is_empty() {
        Ok(Request { sequence, command })
    } else {
        Err(DecodeError::Length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Bodies by the page, CRC by Python's `binascii.crc_hqx(body, 0xFFFF)`, stuffed by hand.
    const GOLDEN: [(Request, &[u8]); 5] = [
        (
            Request {
                sequence: 0x0102,
                command: Command::Tare,
            },
            GOLDEN_TARE,
        ),
        (
            Request {
                sequence: 1,
                command: Command::Rate { every: 10 },
            },
            GOLDEN_RATE,
        ),
        (
            Request {
                sequence: 2,
                command: Command::Save { gain: Some(-2_500) },
            },
            GOLDEN_SAVE,
        ),
        (
            Request {
                sequence: 3,
                command: Command::SelfTest { indentation: 250_000 },
            },
            GOLDEN_SELF_TEST,
        ),
        (
            Request {
                sequence: 4,
                command: Command::Air { pascals: 101_325 },
            },
            GOLDEN_AIR,
        ),
    ];

    const GOLDEN_TARE: &[u8] = &[0x07, 0x02, 0x81, 0x02, 0x01, 0x81, 0x13, 0x00];
    const GOLDEN_RATE: &[u8] = &[0x04, 0x02, 0x86, 0x01, 0x02, 0x0A, 0x03, 0x7A, 0xF3, 0x00];
    const GOLDEN_SAVE: &[u8] = &[
        0x04, 0x02, 0x83, 0x02, 0x07, 0x3C, 0xF6, 0xFF, 0xFF, 0x85, 0x69, 0x00,
    ];
    const GOLDEN_SELF_TEST: &[u8] = &[
        0x04, 0x02, 0x85, 0x03, 0x04, 0x90, 0xD0, 0x03, 0x03, 0x7E, 0x54, 0x00,
    ];

    const GOLDEN_AIR: &[u8] = &[
        0x04, 0x02, 0x8A, 0x04, 0x04, 0xCD, 0x8B, 0x01, 0x03, 0x36, 0x92, 0x00,
    ];

    #[test]
    fn requests_are_the_documented_bytes() {
        for (request, bytes) in GOLDEN {
            assert_eq!(encode(&request).as_slice(), bytes, "{request:?}");
            assert_eq!(decode(&bytes[..bytes.len() - 1]), Ok(request));
        }
    }

    #[test]
    fn what_the_layout_does_not_allow_is_refused() {
        for (body, error) in [
            (&[2_u8, 0x81, 0][..], DecodeError::Short),
            (&[1, 0x81, 0, 0], DecodeError::Version(1)),
            (&[2, 0x80, 0, 0], DecodeError::Kind(0x80)),
            (&[2, 0x81, 0, 0, 0], DecodeError::Length),
            (&[2, 0x86, 0, 0, 1], DecodeError::Length),
            (&[2, 0x86, 0, 0, 0, 0], DecodeError::Field(4)),
            (&[2, 0x86, 0, 0, 0xE9, 3], DecodeError::Field(4)),
            (&[2, 0x85, 0, 0, 0, 0, 0, 0x80], DecodeError::Field(4)),
            // A plate has no radius, a ball has one.
            (&[2, 0x88, 0, 0, 0, 1, 0, 0, 0], DecodeError::Field(4)),
            (&[2, 0x88, 0, 0, 1, 0, 0, 0, 0], DecodeError::Field(4)),
            (&[2, 0x88, 0, 0, 4, 1, 0, 0, 0], DecodeError::Field(4)),
            (&[2, 0x89, 0, 0, 0, 0, 0, 0], DecodeError::Field(4)),
            (&[2, 0x89, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF], DecodeError::Field(4)),
            // 100 001 parts in a million.
            (&[2, 0x83, 0, 0, 0xA1, 0x86, 1, 0], DecodeError::Field(4)),
        ] {
            assert_eq!(read_body(body), Err(error), "{body:?}");
        }
        assert!(read_body(&[2, 0x86, 0, 0, 0xE8, 3]).is_ok());
        // Of 8 mm; no command where the design has no [object].
        let ball = [2, 0x88, 0, 0, 1, 0x40, 0x1F, 0, 0];
        let command = read_body(&ball).map(|request| request.command);
        assert_eq!(command, Ok(Command::Object(Touched::Ball(8_000))));
        assert_eq!(read_known_body::<false>(&ball), Err(DecodeError::Kind(0x88)));
        // 1 mm; the same.
        let depth = [2, 0x89, 0, 0, 0x40, 0x42, 0x0F, 0];
        let command = read_body(&depth).map(|request| request.command);
        assert_eq!(command, Ok(Command::Indentation { known: 1_000_000 }));
        assert_eq!(read_known_body::<false>(&depth), Err(DecodeError::Kind(0x89)));
    }

    proptest! {
        #[test]
        fn a_request_survives_the_wire(sequence in any::<u16>(), which in 0..10, argument in any::<i32>()) {
            let command = match which {
                0 => Command::Tare,
                1 => Command::Undo,
                2 => Command::Save { gain: (argument % 2 == 0).then_some(argument % 100_001) },
                3 => Command::Info,
                4 => Command::SelfTest { indentation: argument & i32::MAX },
                5 => Command::Rate { every: (argument.unsigned_abs() % 1000 + 1) as u16 },
                6 => Command::Air { pascals: argument },
                8 => Command::Indentation { known: (argument & i32::MAX).max(1) },
                7 => Command::Object(Touched::Ball((argument & i32::MAX).max(1))),
                _ => Command::Forget,
            };
            let request = Request { sequence, command };
            let encoded = encode(&request);
            let (_, stuffed) = encoded.split_last().expect("never empty");
            prop_assert_eq!(decode(stuffed), Ok(request));
        }

        #[test]
        fn no_body_makes_the_reader_panic(mut body in prop::collection::vec(any::<u8>(), 0..20), kind in 0x80_u8..0x8C) {
            if let Some([a, b]) = body.first_chunk_mut() {
                *a = PROTOCOL_VERSION;
                *b = kind;
            }
            if let Ok(request) = read_body(&body) {
                let encoded = encode(&request);
                let (_, stuffed) = encoded.split_last().expect("never empty");
                prop_assert_eq!(decode(stuffed), Ok(request));
            }
        }
    }
}
