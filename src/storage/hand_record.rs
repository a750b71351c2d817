//! Layout in flash of the calibrations of a hand's tips. All are in one record of fixed size, with a version and a check.
//!
//! | offset | bytes | field |
//! |---|---|---|
//! | 0 | 4 | `FTH` and the version of this layout, 1 |
//! | 4 | 4 | sequence number, from 1; the highest is the one in use |
//! | 8 | 3 | version of the firmware that wrote it |
//! | 11 | 1 | number of tips |
//! | 12 | 12 | 0 |
//! | 24 | 32 a tip | the tips, below |
//! | length - 8 | 2 | erasures so far, of both slots together |
//! | length - 6 | 2 | debt of the [save budget](crate::storage::save_budget) at that time, in units of 2^21 us; 0 from versions before 0.1.0 |
//! | length - 4 | 4 | CRC-32/ISO-HDLC of the bytes before |
//!
//! | offset in a tip | bytes | field |
//! |---|---|---|
//! | 0 | 8 | hash of the tip: its name, its place on the board and its design |
//! | 8 | 4 | version of that design's tables |
//! | 12 | 4 | sequence number of the last record that changed this tip; 0: none |
//! | 16 | 4 | zero, millipascals; the lowest number: none |
//! | 20 | 2 | temperature of that zero, hundredths of a degree Celsius; the lowest number: none |
//! | 22 | 1 | 1: a calibration; 0: nothing is stored |
//! | 23 | 1 | 1: a later calibration may have been lost; 0: this is the last one |
//! | 24 | 4 | temperature coefficient of the zero, millipascals a kelvin |
//! | 28 | 4 | gain trim, parts in a million |
//!
//! Numbers are little-endian. One record holds every tip, so that a save of one tip is as atomic as on a board with one fingertip.

use crate::link::wire::Reader;
use crate::signal::calibration::Calibration;
use crate::storage::log::{END, Found, LoggedRecord, seal, unseal};
use crate::units::{Centidegrees, Millipascals};

const HEAD: usize = 24;
const TIP: usize = 32;

const MAGIC: [u8; 4] = *b"FTH\x01";

/// Bytes of the record for `tips` tips: a multiple of every write unit (1 to 16 bytes).
pub const fn length(tips: usize) -> usize {
    HEAD + TIP * tips + END
}

/// The stored data of one tip.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct TipEntry {
    /// Hash of the tip: its name, its place and its design.
    pub hash: u64,
    /// The version of that design's tables.
    pub table_version: u32,
    /// Sequence number of the last record that changed this tip; 0: none.
    pub number: u32,
    /// The calibration; `None` if nothing is stored.
    pub calibration: Option<Calibration>,
    /// Whether a later calibration may have been lost in an unreadable place.
    pub doubtful: bool,
}

impl TipEntry {
    /// Nothing was ever stored.
    pub const NOTHING: Self = Self {
        hash: 0,
        table_version: 0,
        number: 0,
        calibration: None,
        doubtful: false,
    };

    fn encode(&self) -> [u8; TIP] {
        let calibration = self.calibration.unwrap_or_default();
        let zero = calibration.zero.map_or(i32::MIN, |zero| zero.0);
        let temperature = calibration.temperature.map_or(i16::MIN, |found| found.0);
        let fields: [&[u8]; 8] = [
            &self.hash.to_le_bytes(),
            &self.table_version.to_le_bytes(),
            &self.number.to_le_bytes(),
            &zero.to_le_bytes(),
            &temperature.to_le_bytes(),
            &[u8::from(self.calibration.is_some()), u8::from(self.doubtful)],
            &calibration.coefficient.to_le_bytes(),
            &calibration.gain.to_le_bytes(),
        ];
        let mut bytes = [0; TIP];
        for (place, &byte) in bytes.iter_mut().zip(fields.iter().copied().flatten()) {
            *place = byte;
        }
        bytes
    }

    fn read(fields: &mut Reader<'_>) -> Option<Self> {
        let hash = u64::from_le_bytes(fields.take().ok()?);
        let table_version = u32::from_le_bytes(fields.take().ok()?);
        let number = u32::from_le_bytes(fields.take().ok()?);
        let zero = i32::from_le_bytes(fields.take().ok()?);
        let temperature = i16::from_le_bytes(fields.take().ok()?);
        let [kind, doubt] = fields.take().ok()?;
        let coefficient = i32::from_le_bytes(fields.take().ok()?);
        let gain = i32::from_le_bytes(fields.take().ok()?);
        let calibration = Calibration {
            zero: (zero != i32::MIN).then_some(Millipascals(zero)),
            temperature: (temperature != i16::MIN).then_some(Centidegrees(temperature)),
            coefficient,
            gain,
        };
        (kind <= 1 && doubt <= 1).then_some(Self {
            hash,
            table_version,
            number,
            calibration: (kind == 1).then_some(calibration),
            doubtful: doubt == 1,
        })
    }
}

/// The stored data of all tips.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct HandRecord<const TIPS: usize> {
    /// Sequence number. The record with the highest number is in use.
    pub sequence: u32,
    /// The firmware that wrote it: major, minor, patch.
    pub firmware: [u8; 3],
    /// The tips, in their order.
    pub tips: [TipEntry; TIPS],
    /// [`LoggedRecord::wear`].
    pub wear: u32,
}

impl<const TIPS: usize, const LENGTH: usize> LoggedRecord<LENGTH> for HandRecord<TIPS> {
    fn sequence(&self) -> u32 {
        self.sequence
    }

    fn wear(&self) -> u32 {
        self.wear
    }

    fn set_wear(&mut self, wear: u32) {
        self.wear = wear;
    }

    fn encode(&self) -> [u8; LENGTH] {
        const { assert!(LENGTH == length(TIPS)) };
        let mut bytes = [0; LENGTH];
        let (head, rest) = bytes.split_at_mut(HEAD);
        let (tips, end) = rest.split_at_mut(TIP * TIPS);
        head[..4].copy_from_slice(&MAGIC);
        head[4..8].copy_from_slice(&self.sequence.to_le_bytes());
        head[8..11].copy_from_slice(&self.firmware);
        head[11] = TIPS as u8;
        for (place, tip) in tips.chunks_exact_mut(TIP).zip(&self.tips) {
            place.copy_from_slice(&tip.encode());
        }
        end[..4].copy_from_slice(&self.wear.to_le_bytes());
        seal(&mut bytes);
        bytes
    }

    fn decode(bytes: &[u8; LENGTH]) -> Found<Self> {
        unseal(bytes, MAGIC, read)
    }
}

fn read<const TIPS: usize>(body: &[u8]) -> Option<HandRecord<TIPS>> {
    let mut fields = Reader(body);
    let [_, _, _, _] = fields.take().ok()?;
    let sequence = u32::from_le_bytes(fields.take().ok()?);
    let firmware = fields.take().ok()?;
    let [count] = fields.take().ok()?;
    let padding: [u8; 12] = fields.take().ok()?;
    let mut tips = [TipEntry::NOTHING; TIPS];
    for tip in &mut tips {
        *tip = TipEntry::read(&mut fields)?;
    }
    let wear = u32::from_le_bytes(fields.take().ok()?);
    (usize::from(count) == TIPS && padding == [0; 12]).then_some(HandRecord {
        sequence,
        firmware,
        tips,
        wear,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const LENGTH: usize = length(2);

    const RECORD: HandRecord<2> = HandRecord {
        sequence: 7,
        firmware: [0, 1, 0],
        tips: [
            TipEntry {
                hash: 0x0123_4567_89AB_CDEF,
                table_version: 3,
                number: 6,
                calibration: Some(Calibration {
                    zero: Some(Millipascals(20_100_000)),
                    temperature: Some(Centidegrees(-250)),
                    coefficient: -2_000,
                    gain: 25_000,
                }),
                doubtful: false,
            },
            TipEntry {
                hash: 0x1122_3344_5566_7788,
                table_version: 5,
                number: 7,
                calibration: None,
                doubtful: true,
            },
        ],
        wear: 2,
    };

    /// By the tables above, with Python's `struct` and `binascii.crc32`:
    /// `4s I 3B B 12x | Q I I i h B B i i | Q I I i h B B i i | I I`.
    const BYTES: [u8; LENGTH] = [
        0x46, 0x54, 0x48, 0x01, 0x07, 0x00, 0x00, 0x00, 0x00, 0x01, 0x00, 0x02, 0x00, 0x00, 0x00, 0x00, 0x00,
        0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xEF, 0xCD, 0xAB, 0x89, 0x67, 0x45, 0x23, 0x01, 0x03, 0x00,
        0x00, 0x00, 0x06, 0x00, 0x00, 0x00, 0xA0, 0xB3, 0x32, 0x01, 0x06, 0xFF, 0x01, 0x00, 0x30, 0xF8, 0xFF,
        0xFF, 0xA8, 0x61, 0x00, 0x00, 0x88, 0x77, 0x66, 0x55, 0x44, 0x33, 0x22, 0x11, 0x05, 0x00, 0x00, 0x00,
        0x07, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x80, 0x00, 0x80, 0x00, 0x01, 0x00, 0x00, 0x00, 0x00, 0x00,
        0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x42, 0x1C, 0x26, 0x6F,
    ];

    #[test]
    fn a_record_is_the_documented_bytes() {
        assert_eq!(RECORD.encode(), BYTES);
        assert_eq!(HandRecord::decode(&BYTES), Found::Record(RECORD));
        assert_eq!((length(5), length(12)), (192, 416));
    }

    #[test]
    fn no_prefix_of_a_record_on_erased_memory_is_one() {
        for length in 1..LENGTH {
            let mut bytes = [0xFF; LENGTH];
            bytes[..length].copy_from_slice(&BYTES[..length]);
            assert_eq!(HandRecord::<2>::decode(&bytes), Found::Torn, "{length}");
        }
        assert_eq!(HandRecord::<2>::decode(&[0xFF; LENGTH]), Found::Blank);
    }

    #[test]
    fn every_flipped_bit_and_a_record_of_other_tips_are_torn() {
        for bit in 0..8 * LENGTH {
            let mut bytes = BYTES;
            bytes[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(HandRecord::<2>::decode(&bytes), Found::Torn, "{bit}");
        }
        // The same bytes, of three tips or of a number that is no kind, their check made to fit.
        for (at, byte) in [(11, 3), (12, 1), (HEAD + 22, 2), (HEAD + TIP + 23, 2)] {
            let mut bytes = BYTES;
            bytes[at] = byte;
            seal(&mut bytes);
            assert_eq!(HandRecord::<2>::decode(&bytes), Found::Torn, "{at}");
        }
    }

    proptest! {
        #[test]
        fn a_record_is_read_as_it_was_written(
            sequence in any::<u32>(), hash in any::<u64>(), zero in any::<i32>(), temperature in any::<i16>(), gain in any::<i32>(),
        ) {
            let mut record = RECORD;
            record.sequence = sequence;
            record.tips[1] = TipEntry {
                hash,
                calibration: Some(Calibration {
                    zero: (zero != i32::MIN).then_some(Millipascals(zero)),
                    temperature: (temperature != i16::MIN).then_some(Centidegrees(temperature)),
                    coefficient: gain,
                    gain,
                }),
                ..record.tips[1]
            };
            let bytes: [u8; LENGTH] = record.encode();
            prop_assert_eq!(HandRecord::decode(&bytes), Found::Record(record));
        }
    }
}
