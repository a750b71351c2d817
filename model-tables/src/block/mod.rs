//! A tip's data as one block of bytes: the data of one fingertip in flash or in a file, separate from the code. `LAYOUT.md` beside
//! this file gives every byte.
//!
//! [`read`](read::TipBlock::read) accepts a block only as a whole. The block must have this layout, be complete and unchanged since
//! it was written, have every value in its range, and have tables that never fall. Otherwise the result is a [`BlockError`].

pub mod field;
pub mod read;
pub mod section;
#[cfg(feature = "std")]
pub mod write;

use crate::table::TablesError;
use core::fmt;
use crc::{CRC_32_ISO_HDLC, Crc, NoTable};
use section::SectionKind;

/// The first bytes of a block.
pub const MAGIC: [u8; 4] = *b"FTIP";

/// The layout that is written and read.
pub const LAYOUT_VERSION: u16 = 1;

/// Bytes of the head before its directory of sections.
pub const HEAD: usize = 40;

/// Bytes of an entry of the directory.
pub const ENTRY: usize = 12;

/// Where the check lies; it covers all other bytes of the block.
const CHECK_AT: usize = 12;

/// Longest name, bytes: as in a design file.
pub const LONGEST_NAME: usize = 64;

/// Blocks are read once: no table for speed.
const CHECK: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);

/// CRC-32/ISO-HDLC of a block without its own four bytes.
fn check(block: &[u8]) -> u32 {
    let mut digest = CHECK.digest();
    let (before, after) = block.split_at_checked(CHECK_AT).unwrap_or((block, &[]));
    digest.update(before);
    digest.update(after.get(4..).unwrap_or_default());
    digest.finalize()
}

/// The next multiple of four: where the next section begins.
const fn aligned(length: usize) -> usize {
    length.next_multiple_of(4)
}

/// What is known of one fingertip beside its design.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct StoredCalibration {
    /// The zero, seen untouched, millipascals in the transducer's own quantity; the lowest number: none.
    pub zero: i32,
    /// The transducer's temperature at that zero, hundredths of a degree Celsius; the lowest number: none.
    pub temperature: i32,
    /// What temperature adds to the zero, millipascals a kelvin.
    pub coefficient: i32,
    /// Added to the pressure rise, parts in a million of it.
    pub gain: i32,
}

/// Why a block is not used.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum BlockError {
    /// It does not begin as a block.
    NoBlock,
    /// It has another layout.
    LayoutVersion(u16),
    /// Fewer bytes than it needs.
    Short {
        /// Bytes needed.
        needed: usize,
        /// Bytes there.
        found: usize,
    },
    /// It was changed, or damaged, since it was written.
    Check,
    /// Its lengths or offsets do not fit each other, or a byte between its sections is not 0.
    Directory,
    /// A section of this number is for other firmware.
    UnknownSection(u16),
    /// A section has another version.
    SectionVersion(SectionKind, u16),
    /// A section that every block has is not there.
    Missing(SectionKind),
    /// A section is longer or shorter than its fields.
    SectionLength(SectionKind),
    /// A value is not in its range.
    Value(SectionKind, &'static str),
    /// The tables may answer wrongly.
    Tables(TablesError),
}

impl fmt::Display for BlockError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NoBlock => f.write_str("this is no tip's data: it does not begin with FTIP"),
            Self::LayoutVersion(found) => {
                write!(
                    f,
                    "the tip's data has layout {found}, and layout {LAYOUT_VERSION} is read"
                )
            }
            Self::Short { needed, found } => {
                write!(f, "the tip's data is cut off: {found} of {needed} bytes")
            }
            Self::Check => f.write_str("the tip's data was changed or damaged: its CRC-32 differs"),
            Self::Directory => f.write_str("the sections of the tip's data do not fit each other"),
            Self::UnknownSection(number) => {
                write!(f, "section {number} of the tip's data is for other firmware")
            }
            Self::SectionVersion(kind, found) => write!(
                f,
                "section {} of the tip's data has version {found}, and version {} is read",
                kind.word(),
                SectionKind::VERSION
            ),
            Self::Missing(kind) => write!(f, "the tip's data has no section {}", kind.word()),
            Self::SectionLength(kind) => {
                write!(f, "section {} of the tip's data has a wrong length", kind.word())
            }
            Self::Value(kind, field) => {
                write!(
                    f,
                    "{field} in section {} of the tip's data is out of its range",
                    kind.word()
                )
            }
            Self::Tables(error) => write!(f, "{error}"),
        }
    }
}

impl core::error::Error for BlockError {}

impl From<TablesError> for BlockError {
    fn from(error: TablesError) -> Self {
        Self::Tables(error)
    }
}

#[cfg(all(test, feature = "std"))]
mod tests;
