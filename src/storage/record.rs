//! Layout of one calibration in flash: a record of fixed size, with a version and a check.
//!
//! | offset | bytes | field |
//! |---|---|---|
//! | 0 | 4 | `FTC` and the version of this layout, 1 |
//! | 4 | 4 | sequence number, from 1; the highest is the one in use |
//! | 8 | 8 | hash of its design |
//! | 16 | 4 | version of that design's tables |
//! | 20 | 3 | version of the firmware that wrote it |
//! | 23 | 1 | 1: a calibration; 0: what was stored before is void |
//! | 24 | 4 | zero, millipascals; the lowest number: none |
//! | 28 | 2 | temperature of that zero, hundredths of a degree Celsius; the lowest number: none |
//! | 30 | 2 | 0 |
//! | 32 | 4 | temperature coefficient of the zero, millipascals a kelvin |
//! | 36 | 4 | gain trim, parts in a million |
//! | 40 | 2 | erasures so far, of both slots together |
//! | 42 | 2 | debt of the [save budget](crate::storage::save_budget) at that time, in units of 2^21 us; 0 from versions before 0.1.0 |
//! | 44 | 4 | CRC-32/ISO-HDLC of the bytes before |
//!
//! Numbers are little-endian. The check comes last, so an interrupted write leaves no valid check.

use crate::link::wire::Reader;
use crate::signal::calibration::Calibration;
use crate::storage::log::{Found, LoggedRecord, seal, unseal};
use crate::units::{Centidegrees, Millipascals};

/// Bytes of a record: a multiple of every write unit (1 to 16 bytes).
pub const LENGTH: usize = 48;

const MAGIC: [u8; 4] = *b"FTC\x01";

/// A calibration and the identity of its design.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Record {
    /// Sequence number. The record with the highest number is in use.
    pub sequence: u32,
    /// Hash of its design.
    pub design_hash: u64,
    /// The version of that design's tables.
    pub table_version: u32,
    /// The firmware that wrote it: major, minor, patch.
    pub firmware: [u8; 3],
    /// The calibration; `None` voids the previous one.
    pub calibration: Option<Calibration>,
    /// [`LoggedRecord::wear`].
    pub wear: u32,
}

impl LoggedRecord<LENGTH> for Record {
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
        encode(self)
    }

    fn decode(bytes: &[u8; LENGTH]) -> Found<Self> {
        decode(bytes)
    }
}

/// The bytes of a record.
pub fn encode(record: &Record) -> [u8; LENGTH] {
    let calibration = record.calibration.unwrap_or_default();
    let fields: [&[u8]; 11] = [
        &MAGIC,
        &record.sequence.to_le_bytes(),
        &record.design_hash.to_le_bytes(),
        &record.table_version.to_le_bytes(),
        &record.firmware,
        &[u8::from(record.calibration.is_some())],
        &calibration.zero.map_or(i32::MIN, |zero| zero.0).to_le_bytes(),
        &calibration
            .temperature
            .map_or(i32::from(i16::MIN) & 0xFFFF, |temperature| {
                i32::from(temperature.0) & 0xFFFF
            })
            .to_le_bytes(),
        &calibration.coefficient.to_le_bytes(),
        &calibration.gain.to_le_bytes(),
        &record.wear.to_le_bytes(),
    ];
    let mut bytes = [0; LENGTH];
    let mut at = 0;
    for field in fields {
        for &byte in field {
            bytes[at] = byte;
            at += 1;
        }
    }
    seal(&mut bytes);
    bytes
}

/// Decodes the bytes.
pub fn decode(bytes: &[u8; LENGTH]) -> Found<Record> {
    unseal(bytes, MAGIC, read)
}

fn read(body: &[u8]) -> Option<Record> {
    let mut fields = Reader(body);
    let [_, _, _, _] = fields.take().ok()?;
    let sequence = u32::from_le_bytes(fields.take().ok()?);
    let design_hash = u64::from_le_bytes(fields.take().ok()?);
    let table_version = u32::from_le_bytes(fields.take().ok()?);
    let firmware = fields.take().ok()?;
    let [kind] = fields.take().ok()?;
    let zero = i32::from_le_bytes(fields.take().ok()?);
    let temperature = i16::from_le_bytes(fields.take().ok()?);
    let [padding, more] = fields.take().ok()?;
    let coefficient = i32::from_le_bytes(fields.take().ok()?);
    let gain = i32::from_le_bytes(fields.take().ok()?);
    let wear = u32::from_le_bytes(fields.take().ok()?);
    let calibration = Calibration {
        zero: (zero != i32::MIN).then_some(Millipascals(zero)),
        temperature: (temperature != i16::MIN).then_some(Centidegrees(temperature)),
        coefficient,
        gain,
    };
    (kind <= 1 && padding == 0 && more == 0).then_some(Record {
        sequence,
        design_hash,
        table_version,
        firmware,
        calibration: (kind == 1).then_some(calibration),
        wear,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const RECORD: Record = Record {
        sequence: 7,
        design_hash: 0x0123_4567_89AB_CDEF,
        table_version: 3,
        firmware: [0, 1, 0],
        calibration: Some(Calibration {
            zero: Some(Millipascals(20_100_000)),
            temperature: Some(Centidegrees(-250)),
            coefficient: -2_000,
            gain: 25_000,
        }),
        wear: 2,
    };

    /// By the table above, with Python's `struct` and `binascii.crc32`.
    const BYTES: [u8; LENGTH] = [
        0x46, 0x54, 0x43, 0x01, 0x07, 0x00, 0x00, 0x00, 0xEF, 0xCD, 0xAB, 0x89, 0x67, 0x45, 0x23, 0x01, 0x03,
        0x00, 0x00, 0x00, 0x00, 0x01, 0x00, 0x01, 0xA0, 0xB3, 0x32, 0x01, 0x06, 0xFF, 0x00, 0x00, 0x30, 0xF8,
        0xFF, 0xFF, 0xA8, 0x61, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0xAF, 0x61, 0x3F, 0x93,
    ];

    #[test]
    fn a_record_is_the_documented_bytes() {
        assert_eq!(encode(&RECORD), BYTES);
        assert_eq!(decode(&BYTES), Found::Record(RECORD));
    }

    #[test]
    fn erased_memory_is_blank_and_anything_else_torn() {
        assert_eq!(decode(&[0xFF; LENGTH]), Found::Blank);
        assert_eq!(decode(&[0; LENGTH]), Found::Torn);
        let mut other = BYTES;
        other[3] = 2;
        assert_eq!(decode(&other), Found::Torn);
    }

    #[test]
    fn no_prefix_of_a_record_on_erased_memory_is_one() {
        for length in 1..LENGTH {
            let mut bytes = [0xFF; LENGTH];
            bytes[..length].copy_from_slice(&BYTES[..length]);
            assert_eq!(decode(&bytes), Found::Torn, "{length}");
        }
    }

    fn any_record() -> impl Strategy<Value = Record> {
        let calibration = (
            any::<Option<i32>>(),
            any::<Option<i16>>(),
            any::<i32>(),
            any::<i32>(),
        )
            .prop_map(|(zero, temperature, coefficient, gain)| Calibration {
                zero: zero.filter(|&zero| zero != i32::MIN).map(Millipascals),
                temperature: temperature
                    .filter(|&temperature| temperature != i16::MIN)
                    .map(Centidegrees),
                coefficient,
                gain,
            });
        (
            any::<[u32; 3]>(),
            any::<u64>(),
            any::<[u8; 3]>(),
            prop::option::of(calibration),
        )
            .prop_map(|(words, design_hash, firmware, calibration)| Record {
                sequence: words[0],
                design_hash,
                table_version: words[1],
                firmware,
                calibration,
                wear: words[2],
            })
    }

    proptest! {
        #[test]
        fn a_record_is_read_as_it_was_written(record in any_record()) {
            let voided = record.calibration.is_none();
            prop_assert_eq!(decode(&encode(&record)), Found::Record(record));
            prop_assert_eq!(voided, encode(&record)[23] == 0);
        }

        #[test]
        fn up_to_three_flipped_bits_are_never_a_record(record in any_record(), bits in prop::collection::hash_set(0..LENGTH * 8, 1..4)) {
            let mut bytes = encode(&record);
            for bit in bits {
                bytes[bit / 8] ^= 1 << (bit % 8);
            }
            prop_assert_eq!(decode(&bytes), Found::Torn);
        }

        #[test]
        fn no_bytes_make_the_reader_panic(bytes in prop::array::uniform32(any::<u8>()), sealed in any::<bool>()) {
            let mut all = [0_u8; LENGTH];
            all[4..36].copy_from_slice(&bytes);
            if sealed {
                all[..4].copy_from_slice(&MAGIC);
                seal(&mut all);
            }
            let _ = decode(&all);
        }
    }
}
