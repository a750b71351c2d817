//! A tip's data in flash (feature `load-tip`): two slots. Each has a block at its start and a log of activations at its end.
//!
//! | in a slot | bytes | what |
//! |---|---|---|
//! | 0 | up to the log | the block, written in chunks into the slot that is not in use |
//! | slot - [`LOG`] | [`LOG`] | activations, [`LENGTH`] bytes each, one after the other |
//!
//! | in an activation | bytes | field |
//! |---|---|---|
//! | 0 | 4 | `FTA` and the version of this layout, 1 |
//! | 4 | 4 | sequence number, from 1; the highest of both slots is valid |
//! | 8 | 4 | 1: this slot's block is in use; 0: the image's own tables are |
//! | 12 | 4 | bytes of the block |
//! | 16 | 4 | the CRC-32 in its head |
//! | 20 | 8 | its design's hash |
//! | 28 | 4 | CRC-32/ISO-HDLC of the bytes before |
//!
//! Numbers are little-endian. Power may fail at any write or erasure. A block is valid only with an activation, which is written
//! after the whole block was read back. The slot with the valid activation is never erased. A start therefore finds the previous
//! tip or the new one, complete. An activation that cannot be read is ignored.

use crate::link::wire::Reader;
use crate::storage::log::StoreError;
use crc::{CRC_32_ISO_HDLC, Crc, NoTable};
use embedded_storage_async::nor_flash::NorFlash;

/// Bytes of an activation: a multiple of every write unit.
pub const LENGTH: usize = 32;

/// Bytes of a slot's log. It limits the number of activations between two loads into the slot.
pub const LOG: u32 = 16 * LENGTH as u32;

const PLACES: u32 = LOG / LENGTH as u32;

/// Largest write unit of a memory.
const UNIT: usize = 8;

const MAGIC: [u8; 4] = *b"FTA\x01";

/// There are few activations, so the CRC needs no table for speed.
const CHECK: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);

/// Position of a slot in the memory, in whole erasure units.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Slot {
    /// Offset of its first byte from the start of the memory.
    pub begin: u32,
    /// Bytes.
    pub length: u32,
}

/// A block in a slot.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct SlotBlock {
    /// The slot, 0 or 1.
    pub slot: u32,
    /// Bytes.
    pub length: u32,
    /// The CRC-32 in its head.
    pub check: u32,
    /// Its design's hash.
    pub hash: u64,
}

/// An activation in a log.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
struct Activation {
    sequence: u32,
    /// The slot of its log.
    home: u32,
    /// The block that it puts in use; `None` for the image's own tables.
    block: Option<SlotBlock>,
}

/// The two slots. Each call gets the memory, because the memory also holds the calibration.
#[derive(Clone, Debug)]
pub struct TipSlots {
    slots: [Slot; 2],
    /// The activation in force.
    latest: Option<Activation>,
    /// The last activation before it that puts another block, or the image's tables, in use.
    before: Option<Activation>,
    /// The next place in each log.
    next: [u32; 2],
    /// The highest sequence number that any place may hold.
    highest: u32,
}

impl TipSlots {
    /// Two slots of `slot` bytes each, starting at `base`, to be read by [`TipSlots::scan`].
    pub const fn new(base: u32, slot: u32) -> Self {
        Self::of([
            Slot {
                begin: base,
                length: slot,
            },
            Slot {
                begin: base + slot,
                length: slot,
            },
        ])
    }

    /// A pair of given slots, to be read by [`TipSlots::scan`].
    pub const fn of(slots: [Slot; 2]) -> Self {
        Self {
            slots,
            latest: None,
            before: None,
            next: [0; 2],
            highest: 0,
        }
    }

    /// Largest length of a block, bytes.
    pub fn room(&self) -> u32 {
        let [first, second] = self.slots;
        first.length.min(second.length) - LOG
    }

    /// Reads both logs.
    pub async fn scan(&mut self, flash: &mut impl NorFlash) {
        *self = Self::of(self.slots);
        let mut unknown = 0;
        // Reads twice: the activation before the last one can be found only when the last one is known.
        for _ in 0..2 {
            unknown = 0;
            for home in 0..2 {
                for place in 0..PLACES {
                    let found = self.read_place(flash, home, place).await;
                    if found != Place::Blank {
                        self.set_next(home, place + 1);
                    }
                    match found {
                        Place::Blank => {}
                        Place::Activation(found) => self.take(found),
                        Place::Unknown => unknown += 1,
                    }
                }
            }
        }
        // A place that cannot be read now may be readable at another start, so its number is not used again.
        self.highest = self.highest.saturating_add(unknown);
    }

    /// The block in use. `None` if the image's own tables are in use.
    pub fn in_use(&self) -> Option<SlotBlock> {
        self.latest.and_then(|latest| latest.block)
    }

    /// The slot that a block may be written to. It is never the slot with the activation in force.
    pub fn free(&self) -> u32 {
        self.latest.map_or(0, |latest| 1 - latest.home)
    }

    /// Erases the free slot.
    ///
    /// # Errors
    /// [`StoreError`]
    pub async fn erase_free(&mut self, flash: &mut impl NorFlash) -> Result<(), StoreError> {
        let free = self.free();
        if self.before.is_some_and(|before| before.home == free) {
            self.before = None;
        }
        let Slot { begin, length } = self.slot(free);
        flash
            .erase(begin, begin + length)
            .await
            .map_err(|_| StoreError::Failed)?;
        self.set_next(free, 0);
        Ok(())
    }

    /// Writes a part of a block into the free slot and reads it back. Equal data that are already there are not written again;
    /// different data give an error.
    ///
    /// # Errors
    /// [`StoreError`]
    pub async fn write_free<const N: usize>(
        &mut self,
        flash: &mut impl NorFlash,
        offset: u32,
        bytes: &[u8],
    ) -> Result<(), StoreError> {
        const { assert!(N.is_multiple_of(UNIT)) };
        let mut wanted = [0xFF; N];
        let padded = bytes.len().next_multiple_of(UNIT);
        let (Some(place), true) = (
            wanted.get_mut(..bytes.len()),
            offset.saturating_add(padded as u32) <= self.room(),
        ) else {
            return Err(StoreError::Failed);
        };
        place.copy_from_slice(bytes);
        let wanted = wanted.get(..padded).unwrap_or(&[]);
        let mut found = [0; N];
        let found = found.get_mut(..padded).unwrap_or(&mut []);
        let at = self.slot(self.free()).begin + offset;
        let known = flash.read(at, found).await.is_ok();
        if known && found == wanted {
            return Ok(());
        }
        if !known || found.iter().any(|&byte| byte != 0xFF) {
            return Err(StoreError::Failed);
        }
        // The result of the write is ignored: only the data read back count.
        let _ = flash.write(at, wanted).await;
        match flash.read(at, found).await {
            Ok(()) if found == wanted => Ok(()),
            _ => Err(StoreError::Failed),
        }
    }

    /// Reads from a slot.
    ///
    /// # Errors
    /// [`StoreError`]
    pub async fn read(
        &self,
        flash: &mut impl NorFlash,
        slot: u32,
        offset: u32,
        bytes: &mut [u8],
    ) -> Result<(), StoreError> {
        let end = offset as usize + bytes.len();
        if slot > 1 || end > self.room() as usize {
            return Err(StoreError::Failed);
        }
        let at = self.slot(slot).begin + offset;
        flash.read(at, bytes).await.map_err(|_| StoreError::Failed)
    }

    /// Puts the block of the free slot in use, after the whole block was read back.
    ///
    /// # Errors
    /// [`StoreError`]; the previous block or the image's tables stay in use.
    pub async fn activate(&mut self, flash: &mut impl NorFlash, block: SlotBlock) -> Result<(), StoreError> {
        self.append(flash, block.slot, Some(block)).await
    }

    /// What [`TipSlots::roll_back`] would put in use: the previous block, or the image's own tables. `None` if there is nothing
    /// to roll back. The caller must read and check the block first.
    #[allow(clippy::option_option)] // nothing to take back, or the image's own tables
    pub fn rolls_back_to(&self) -> Option<Option<SlotBlock>> {
        match (self.before, self.latest) {
            (Some(before), _) => Some(before.block),
            // A load into the other slot erased the previous block. The image's own tables are always available.
            (None, Some(latest)) => latest.block.is_some().then_some(None),
            (None, None) => None,
        }
    }

    /// Puts `to` in use, which is the result of [`TipSlots::rolls_back_to`].
    ///
    /// # Errors
    /// [`StoreError`]; the previous block or the image's tables stay in use.
    pub async fn roll_back(
        &mut self,
        flash: &mut impl NorFlash,
        to: Option<SlotBlock>,
    ) -> Result<(), StoreError> {
        let home = self.latest.map_or(0, |latest| latest.home);
        self.append(flash, to.map_or(home, |block| block.slot), to).await
    }

    /// Writes an activation into the next place of a log at which the write succeeds.
    async fn append(
        &mut self,
        flash: &mut impl NorFlash,
        home: u32,
        block: Option<SlotBlock>,
    ) -> Result<(), StoreError> {
        let Some(next) = self.next.get(home as usize).copied() else {
            return Err(StoreError::Failed);
        };
        for place in next..PLACES {
            self.set_next(home, place + 1);
            let written = Activation {
                sequence: self.highest.saturating_add(1),
                home,
                block,
            };
            let at = self.place(home, place);
            let _ = flash.write(at, &written.encode()).await;
            match self.read_place(flash, home, place).await {
                Place::Activation(found) if found == written => {
                    self.take(found);
                    return Ok(());
                }
                Place::Blank => {}
                // The place may be readable at another start, so its number is not used again.
                _ => self.highest = self.highest.saturating_add(1),
            }
        }
        Err(StoreError::Failed)
    }

    /// Takes an activation found in a log.
    fn take(&mut self, found: Activation) {
        self.highest = self.highest.max(found.sequence);
        let newer = |than: &Option<Activation>| than.is_none_or(|than| found.sequence > than.sequence);
        match self.latest {
            Some(latest) if latest == found => {}
            _ if newer(&self.latest) => {
                let replaced = self.latest.replace(found);
                if let Some(replaced) = replaced
                    && replaced.block != found.block
                {
                    self.before = Some(replaced);
                }
            }
            Some(latest) if latest.block != found.block && newer(&self.before) => self.before = Some(found),
            _ => {}
        }
    }

    fn set_next(&mut self, home: u32, place: u32) {
        if let Some(next) = self.next.get_mut(home as usize) {
            *next = place;
        }
    }

    async fn read_place(&self, flash: &mut impl NorFlash, home: u32, place: u32) -> Place {
        let mut bytes = [0; LENGTH];
        match flash.read(self.place(home, place), &mut bytes).await {
            Err(_) => Place::Unknown,
            Ok(()) if bytes.iter().all(|&byte| byte == 0xFF) => Place::Blank,
            Ok(()) => Activation::decode(&bytes, home).map_or(Place::Unknown, Place::Activation),
        }
    }

    fn place(&self, home: u32, place: u32) -> u32 {
        let Slot { begin, length } = self.slot(home);
        begin + length - LOG + place * LENGTH as u32
    }

    fn slot(&self, which: u32) -> Slot {
        let [first, second] = self.slots;
        if which == 0 { first } else { second }
    }
}

/// Content of the place of an activation.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Place {
    Blank,
    Activation(Activation),
    /// Interrupted, or unreadable.
    Unknown,
}

impl Activation {
    fn encode(&self) -> [u8; LENGTH] {
        let (length, check, hash) = self
            .block
            .map_or((0, 0, 0), |block| (block.length, block.check, block.hash));
        let fields: [&[u8]; 6] = [
            &MAGIC,
            &self.sequence.to_le_bytes(),
            &u32::from(self.block.is_some()).to_le_bytes(),
            &length.to_le_bytes(),
            &check.to_le_bytes(),
            &hash.to_le_bytes(),
        ];
        let mut bytes = [0; LENGTH];
        for (place, &byte) in bytes.iter_mut().zip(fields.iter().copied().flatten()) {
            *place = byte;
        }
        let (body, end) = bytes.split_at_mut(LENGTH - 4);
        end.copy_from_slice(&CHECK.checksum(body).to_le_bytes());
        bytes
    }

    fn decode(bytes: &[u8; LENGTH], home: u32) -> Option<Self> {
        let (body, check) = bytes.split_at(LENGTH - 4);
        if CHECK.checksum(body).to_le_bytes() != *check {
            return None;
        }
        let mut fields = Reader(body);
        let magic: [u8; 4] = fields.take().ok()?;
        let mut number = || fields.take().ok().map(u32::from_le_bytes);
        let (sequence, kind, length, check) = (number()?, number()?, number()?, number()?);
        let block = SlotBlock {
            slot: home,
            length,
            check,
            hash: u64::from_le_bytes(fields.take().ok()?),
        };
        (magic == MAGIC && kind <= 1).then_some(Self {
            sequence,
            home,
            block: (kind == 1).then_some(block),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By the table above, with Python's `struct` and `binascii.crc32`.
    const BYTES: [u8; LENGTH] = [
        0x46, 0x54, 0x41, 0x01, 0x07, 0x00, 0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x04, 0x02, 0x00, 0x00, 0x67,
        0x45, 0x23, 0x01, 0xEF, 0xCD, 0xAB, 0x89, 0x67, 0x45, 0x23, 0x01, 0xEB, 0x54, 0x7C, 0xB2,
    ];

    #[test]
    fn an_activation_is_the_documented_bytes() {
        let activation = Activation {
            sequence: 7,
            home: 1,
            block: Some(SlotBlock {
                slot: 1,
                length: 516,
                check: 0x0123_4567,
                hash: 0x0123_4567_89AB_CDEF,
            }),
        };
        assert_eq!(activation.encode(), BYTES);
        assert_eq!(Activation::decode(&BYTES, 1), Some(activation));
        for bit in 0..8 * LENGTH {
            let mut bytes = BYTES;
            bytes[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(Activation::decode(&bytes, 1), None, "{bit}");
        }
        for length in 0..LENGTH {
            let mut bytes = [0xFF; LENGTH];
            bytes[..length].copy_from_slice(&BYTES[..length]);
            assert_eq!(Activation::decode(&bytes, 1), None, "{length}");
        }
    }
}
