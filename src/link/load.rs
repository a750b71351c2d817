//! Loading a tip's data over the line (feature `load-tip`): commands 0x90 to 0x96, their answers, and data read back.
//! `PROTOCOL.md` beside this file has the layout of every body.

use crate::link::wire::{DecodeError, Encoded, PROTOCOL_VERSION, Reader, unstuff};
use crate::status::{code_of, named_by};
use crate::units::Microseconds;

/// Bytes of a chunk: each chunk begins at a multiple of this length. Only the last chunk of a block may be shorter.
pub const CHUNK: usize = 64;

/// Largest number of bytes in one read-back.
pub const READ_BACK: usize = 56;

/// The argument of the command `arm`. No other command uses it.
pub const ARM_WORD: [u8; 4] = *b"LOAD";

/// Bytes before the arguments of a command: version, kind, sequence number.
const HEADER: usize = 4;

/// Between 1 and `N` bytes.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Piece<const N: usize> {
    bytes: [u8; N],
    length: usize,
}

impl<const N: usize> Piece<N> {
    /// A piece with these bytes. `None` for no bytes, and for more than `N`.
    pub fn of(from: &[u8]) -> Option<Self> {
        let mut bytes = [0; N];
        bytes.get_mut(..from.len())?.copy_from_slice(from);
        (!from.is_empty()).then_some(Self {
            bytes,
            length: from.len(),
        })
    }

    /// The bytes.
    pub fn as_slice(&self) -> &[u8] {
        self.bytes.get(..self.length).unwrap_or(&[])
    }
}

/// A command from the host.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum LoadCommand {
    /// Allow loading for a limited time.
    Arm,
    /// Erase the free slot for a block.
    Begin {
        /// Number of the tip on the board, from 0.
        tip: u8,
        /// Bytes of the whole block.
        length: u32,
        /// The CRC-32 in the head of the block.
        check: u32,
    },
    /// Write a part of the block.
    Chunk {
        /// Offset of the part in the block, bytes: a multiple of [`CHUNK`].
        offset: u32,
        /// The bytes.
        bytes: Piece<CHUNK>,
    },
    /// Read the whole block and check it.
    Verify,
    /// Use the block from the next restart on.
    Activate {
        /// Hash of the design, as a check.
        hash: u64,
    },
    /// Return to the block used before.
    RollBack,
    /// Send a part of the block in use.
    ReadBack {
        /// Offset in the block, bytes.
        offset: u32,
        /// Bytes, 1 to [`READ_BACK`].
        length: u8,
    },
}

/// The kind of a command, without its arguments.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum LoadKind {
    /// [`LoadCommand::Arm`].
    Arm,
    /// [`LoadCommand::Begin`].
    Begin,
    /// [`LoadCommand::Chunk`].
    Chunk,
    /// [`LoadCommand::Verify`].
    Verify,
    /// [`LoadCommand::Activate`].
    Activate,
    /// [`LoadCommand::RollBack`].
    RollBack,
    /// [`LoadCommand::ReadBack`].
    ReadBack,
}

impl LoadKind {
    /// Every kind with its code on the wire.
    pub const CODES: [(Self, u8); 7] = [
        (Self::Arm, 0x90),
        (Self::Begin, 0x91),
        (Self::Chunk, 0x92),
        (Self::Verify, 0x93),
        (Self::Activate, 0x94),
        (Self::RollBack, 0x95),
        (Self::ReadBack, 0x96),
    ];

    /// Its name.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Arm => "arm",
            Self::Begin => "load begin",
            Self::Chunk => "load chunk",
            Self::Verify => "load verify",
            Self::Activate => "activate",
            Self::RollBack => "roll back",
            Self::ReadBack => "read back",
        }
    }
}

impl LoadCommand {
    /// Kind of the command.
    pub const fn kind(self) -> LoadKind {
        match self {
            Self::Arm => LoadKind::Arm,
            Self::Begin { .. } => LoadKind::Begin,
            Self::Chunk { .. } => LoadKind::Chunk,
            Self::Verify => LoadKind::Verify,
            Self::Activate { .. } => LoadKind::Activate,
            Self::RollBack => LoadKind::RollBack,
            Self::ReadBack { .. } => LoadKind::ReadBack,
        }
    }
}

/// Outcome of a command.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum LoadOutcome {
    /// It is done.
    Done,
    /// The block is longer than the memory, or the requested part is outside the block.
    OutOfBounds,
    /// The board is about to restart.
    Busy,
    /// There is nothing to roll back.
    NothingToRollBack,
    /// The memory write failed. The block in use stays in use.
    MemoryFailed,
    /// The board has no such tip.
    WrongTip,
    /// Another command must come first.
    OutOfOrder,
    /// This image cannot use the block. The findings give the reason.
    BlockRefused,
    /// The block belongs to another design than the command names.
    OtherHash,
    /// Loading is not allowed. Send `arm` first.
    NotArmed,
}

impl LoadOutcome {
    /// Every outcome with its code on the wire.
    pub const CODES: [(Self, u8); 10] = [
        (Self::Done, 0),
        (Self::OutOfBounds, 3),
        (Self::Busy, 5),
        (Self::NothingToRollBack, 6),
        (Self::MemoryFailed, 8),
        (Self::WrongTip, 10),
        (Self::OutOfOrder, 11),
        (Self::BlockRefused, 12),
        (Self::OtherHash, 13),
        (Self::NotArmed, 15),
    ];
}

/// Reasons for refusing a block, one bit each.
pub mod refused {
    /// It is shorter or longer than `load begin` announced, or is not a block.
    pub const LENGTH: u16 = 1;
    /// Its CRC-32 differs.
    pub const CHECK: u16 = 2;
    /// It has another layout.
    pub const LAYOUT: u16 = 4;
    /// Its tables may give wrong values.
    pub const TABLES: u16 = 8;
    /// A value is out of its range.
    pub const VALUE: u16 = 16;
    /// It is for another transducer than the image's.
    pub const TRANSDUCER: u16 = 32;
}

/// A command with the number its sender gave it.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct LoadRequest {
    /// Sequence number; the answer repeats it.
    pub sequence: u16,
    /// The command.
    pub command: LoadCommand,
}

/// Reply of the board.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum LoadReply {
    /// Answer to a command.
    Answer {
        /// Time of the reply.
        time: Microseconds,
        /// Kind of the command.
        kind: LoadKind,
        /// Sequence number of the command.
        sequence: u16,
        /// Outcome of the command.
        outcome: LoadOutcome,
        /// Reasons for refusing a block, bits of [`refused`]; 0 otherwise.
        findings: u16,
    },
    /// A part of the block in use.
    Data {
        /// Time of the reply.
        time: Microseconds,
        /// Sequence number of the command that requested it.
        sequence: u16,
        /// Offset in the block, bytes.
        offset: u32,
        /// The bytes.
        bytes: Piece<READ_BACK>,
    },
}

/// The bytes of a request, ready for the wire.
pub fn encode(request: &LoadRequest) -> Encoded {
    let mut body = Encoded::NOTHING;
    body.begin();
    body.put([
        PROTOCOL_VERSION,
        code_of(&LoadKind::CODES, request.command.kind()),
    ]);
    body.put(request.sequence.to_le_bytes());
    match request.command {
        LoadCommand::Arm => body.put(ARM_WORD),
        LoadCommand::Begin { tip, length, check } => {
            body.put([tip]);
            body.put(length.to_le_bytes());
            body.put(check.to_le_bytes());
        }
        LoadCommand::Chunk { offset, bytes } => {
            body.put(offset.to_le_bytes());
            body.put_all(bytes.as_slice());
        }
        LoadCommand::Verify | LoadCommand::RollBack => {}
        LoadCommand::Activate { hash } => body.put(hash.to_le_bytes()),
        LoadCommand::ReadBack { offset, length } => {
            body.put(offset.to_le_bytes());
            body.put([length]);
        }
    }
    body.finish();
    body
}

/// The request in the bytes between two zeros (the zeros themselves left out).
///
/// # Errors
/// [`DecodeError`] for any bytes that [`encode`] does not write for a valid request.
pub fn decode(stuffed: &[u8]) -> Result<LoadRequest, DecodeError> {
    read_body(&unstuff(stuffed)?)
}

/// Whether a body is one of these commands. All other commands are in [`command`](super::command).
pub fn is_load(body: &[u8]) -> bool {
    body.get(1)
        .is_some_and(|&code| named_by(&LoadKind::CODES, code).is_some())
}

/// The request of a body.
///
/// # Errors
/// As [`decode`].
pub fn read_body(body: &[u8]) -> Result<LoadRequest, DecodeError> {
    if body.len() < HEADER {
        return Err(DecodeError::Short);
    }
    let mut fields = Reader(body);
    let [version, code] = fields.take()?;
    if version != PROTOCOL_VERSION {
        return Err(DecodeError::Version(version));
    }
    let kind = named_by(&LoadKind::CODES, code).ok_or(DecodeError::Kind(code))?;
    let sequence = u16::from_le_bytes(fields.take()?);
    let command = match kind {
        LoadKind::Arm => {
            if fields.take()? != ARM_WORD {
                return Err(DecodeError::Field(4));
            }
            LoadCommand::Arm
        }
        LoadKind::Begin => {
            let [tip] = fields.take()?;
            LoadCommand::Begin {
                tip,
                length: u32::from_le_bytes(fields.take()?),
                check: u32::from_le_bytes(fields.take()?),
            }
        }
        LoadKind::Chunk => {
            let offset = u32::from_le_bytes(fields.take()?);
            if !(offset as usize).is_multiple_of(CHUNK) {
                return Err(DecodeError::Field(4));
            }
            let bytes = Piece::of(core::mem::take(&mut fields.0)).ok_or(DecodeError::Length)?;
            LoadCommand::Chunk { offset, bytes }
        }
        LoadKind::Verify => LoadCommand::Verify,
        LoadKind::Activate => LoadCommand::Activate {
            hash: u64::from_le_bytes(fields.take()?),
        },
        LoadKind::RollBack => LoadCommand::RollBack,
        LoadKind::ReadBack => {
            let offset = u32::from_le_bytes(fields.take()?);
            let [length] = fields.take()?;
            if !(1..=READ_BACK).contains(&usize::from(length)) {
                return Err(DecodeError::Field(8));
            }
            LoadCommand::ReadBack { offset, length }
        }
    };
    if fields.0.is_empty() {
        Ok(LoadRequest { sequence, command })
    } else {
        Err(DecodeError::Length)
    }
}

/// The kind of a frame with data read back.
pub(crate) const DATA: u8 = 7;

/// Writes the fields after the header of a reply.
pub(crate) fn write_reply(body: &mut Encoded, reply: &LoadReply) {
    match reply {
        LoadReply::Answer {
            kind,
            sequence,
            outcome,
            findings,
            ..
        } => {
            body.put([code_of(&LoadKind::CODES, *kind)]);
            body.put(sequence.to_le_bytes());
            body.put([code_of(&LoadOutcome::CODES, *outcome)]);
            body.put(findings.to_le_bytes());
        }
        LoadReply::Data {
            sequence,
            offset,
            bytes,
            ..
        } => {
            body.put(sequence.to_le_bytes());
            body.put(offset.to_le_bytes());
            body.put_all(bytes.as_slice());
        }
    }
}

/// Reads the reply from the fields after the header of an answer. `None` for an answer to another command.
pub(crate) fn read_answer(
    mut fields: Reader<'_>,
    time: Microseconds,
) -> Option<Result<LoadReply, DecodeError>> {
    let [code] = fields.take().ok()?;
    let kind = named_by(&LoadKind::CODES, code)?;
    let mut read = || {
        let sequence = u16::from_le_bytes(fields.take()?);
        let [outcome] = fields.take()?;
        Ok(LoadReply::Answer {
            time,
            kind,
            sequence,
            outcome: named_by(&LoadOutcome::CODES, outcome).ok_or(DecodeError::Field(17))?,
            findings: u16::from_le_bytes(fields.take()?),
        })
    };
    Some(read())
}

/// Reads the reply from the fields after the header of data read back.
pub(crate) fn read_data(mut fields: Reader<'_>, time: Microseconds) -> Result<LoadReply, DecodeError> {
    Ok(LoadReply::Data {
        time,
        sequence: u16::from_le_bytes(fields.take()?),
        offset: u32::from_le_bytes(fields.take()?),
        bytes: Piece::of(fields.0).ok_or(DecodeError::Length)?,
    })
}

#[cfg(test)]
mod tests;
