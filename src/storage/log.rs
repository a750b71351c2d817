//! Records in flash: two slots of erasable memory, each a log of records; the highest sequence number is in use.
//!
//! A new record is written after the last one in its slot. If that slot is full, the *other* slot is erased and written. The
//! slot with the record in use is never erased. Power may therefore fail at any write or erasure, and the next start reads the
//! old record or the new one. Every record is read back before it counts. One erasure makes room for a slot full of saves. The
//! [budget](crate::storage::save_budget) limits saves in time, and its [`ENDURANCE`] stops them before the memory wears out.
//!
//! Memory with error correction refuses to read a unit whose programming or erasure was interrupted. A place with such a unit
//! has no record and is skipped. Saves continue after it, and the next erasure of its slot makes it usable again. A place that
//! may have held a whole record, newer than the one in use, makes the state [`Stored::Unreadable`] until the next save. A
//! record is written in order, so a place that ends blank never held one.
//!
//! A key-value crate is not used, because there is one value without a key, and no garbage to collect. The log is tested with a
//! power cut at every step (`host-tests/tests/calibration_store.rs`, `hand_store.rs`).

use crate::status::Stored;
use crate::storage::save_budget::{AT_ONCE, ENDURANCE, SaveBudget};
use crate::units::Microseconds;
use crc::{CRC_32_ISO_HDLC, Crc, NoTable};
use embedded_storage_async::nor_flash::NorFlash;

/// Number of places tried in one slot before the other slot is used.
const TRIES: u32 = 3;

/// Bytes at the end of a record, with erasures and check. They are never all blank, because no memory endures that many erasures.
pub const END: usize = 8;

/// There are few records, so the CRC needs no table for speed.
const CHECK: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);

/// Content of the place of a record.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Found<R> {
    /// Erased memory.
    Blank,
    /// A whole record.
    Record(R),
    /// Something else: torn, worn, or not ours.
    Torn,
}

/// A record of `LENGTH` bytes, a multiple of the memory's write unit. Its last [`END`] bytes are never all blank.
pub trait LoggedRecord<const LENGTH: usize>: Copy + PartialEq {
    /// Sequence number. The record with the highest number is in use.
    fn sequence(&self) -> u32;

    /// Lower 16 bits: erasures of both slots together when it was written. Upper 16 bits: debt of the [save
    /// budget](crate::storage::save_budget) at that time, in units of 2^21 us.
    fn wear(&self) -> u32;

    /// Sets the wear at which the record is written.
    fn set_wear(&mut self, wear: u32);

    /// Encodes the record.
    fn encode(&self) -> [u8; LENGTH];

    /// Decodes the bytes.
    fn decode(bytes: &[u8; LENGTH]) -> Found<Self>;
}

/// Writes the check of the other bytes to the end of a record.
pub(super) fn seal<const LENGTH: usize>(bytes: &mut [u8; LENGTH]) {
    let check = CHECK.checksum(&bytes[..LENGTH - 4]);
    bytes[LENGTH - 4..].copy_from_slice(&check.to_le_bytes());
}

/// Decodes sealed bytes that begin with `magic`. `read` gets all bytes except the check.
pub(super) fn unseal<R, const LENGTH: usize>(
    bytes: &[u8; LENGTH],
    magic: [u8; 4],
    read: impl FnOnce(&[u8]) -> Option<R>,
) -> Found<R> {
    if bytes.iter().all(|&byte| byte == 0xFF) {
        return Found::Blank;
    }
    let (body, check) = bytes.split_at(LENGTH - 4);
    let whole = body.starts_with(&magic) && CHECK.checksum(body).to_le_bytes() == *check;
    if !whole {
        return Found::Torn;
    }
    // A body with a valid check has all fields.
    read(body).map_or(Found::Torn, Found::Record)
}

/// Reasons why a record was not stored. The previous record is still stored.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum StoreError {
    /// The write failed, or the memory holds other bytes than were written.
    Failed,
    /// The memory has reached the number of erasures that it endures.
    WornOut,
    /// More saves than the [budget](crate::storage::save_budget) allows.
    TooSoon,
}

/// The two slots.
#[derive(Clone, Debug)]
pub struct RecordLog<F, R, const LENGTH: usize> {
    flash: F,
    /// Bytes of a slot.
    slot: u32,
    latest: Option<R>,
    /// The slot of the latest record.
    home: u32,
    /// The slot of the next write.
    current: u32,
    /// The next place in that slot.
    next: u32,
    erasures: u32,
    /// Number of spoilt places that may have held newer records than the one in use.
    hidden: u32,
    /// Whether the memory refused to read a place.
    refused: bool,
    budget: SaveBudget,
}

/// Content of a place.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Place<R> {
    Blank,
    Record(R),
    /// A record that was not written to its end.
    Cut,
    /// Possibly a former record: it cannot be read, or its check is wrong.
    Spoilt,
}

/// Content of one slot.
#[derive(Clone, Copy, Debug, Default)]
struct SlotScan {
    /// Number of places up to the last one that is not blank.
    used: u32,
    /// Number of places up to the last record; 0 without a record.
    last: u32,
    /// Number of spoilt places after the last record.
    hidden: u32,
    /// The largest count of erasures in a record.
    erasures: u32,
}

impl<F: NorFlash, R: LoggedRecord<LENGTH>, const LENGTH: usize> RecordLog<F, R, LENGTH> {
    const PLACE: u32 = LENGTH as u32;

    /// The first two slots of `slot` bytes in `flash`, to be read by [`RecordLog::load`].
    ///
    /// # Panics
    /// At compile time, if the length of a record is not a multiple of the memory's write unit.
    pub const fn new(flash: F, slot: u32) -> Self {
        const { assert!(LENGTH.is_multiple_of(F::WRITE_SIZE)) };
        Self {
            flash,
            slot,
            latest: None,
            home: 0,
            current: 0,
            next: 0,
            erasures: 0,
            hidden: 0,
            refused: false,
            budget: SaveBudget::new(slot / Self::PLACE),
        }
    }

    /// Reads both slots. Returns [`Stored::InUse`] if the latest record is the last one that was written, otherwise the reason why not.
    // Works in place, and stores the latest record directly in its field. Moving them between futures needs `memmove`, which takes 1.6 kB of flash.
    pub async fn load(&mut self) -> Stored {
        let logs = [self.scan(0).await, self.scan(1).await];
        let [first, second] = &logs;
        let (in_use, other) = if self.home == 0 {
            (first, second)
        } else {
            (second, first)
        };
        // Saves leave a slot only when it is full. If the slot in use is not full, the other slot has no newer record. All
        // records of a slot are older than the first record of the next.
        let is_full = in_use.used == self.places();
        let turned_over = in_use.last == 0 || is_full;
        self.hidden = in_use.hidden;
        if turned_over && other.last == 0 {
            self.hidden += other.hidden;
        }
        self.current = self.home;
        self.next = in_use.used;
        self.erasures = in_use.erasures.max(other.erasures);
        // If the slot is full, an erasure of the other slot may have been interrupted any number of times.
        let cut = if is_full {
            AT_ONCE
        } else {
            in_use.used - in_use.last
        };
        self.budget
            .start(self.latest.as_ref().map_or(0, |latest| latest.wear() >> 16), cut);
        match &self.latest {
            Some(_) if self.hidden > 0 => Stored::Unreadable,
            Some(_) => Stored::InUse,
            None if self.refused => Stored::Unreadable,
            None if in_use.used + other.used > 0 => Stored::Damaged,
            None => Stored::None,
        }
    }

    /// Reads every place of one slot once, and keeps the last record if it is newer than that of the other slot. It does not
    /// stop at a blank place: a place that could not be read once may later read as blank, so blank places may precede a
    /// record.
    async fn scan(&mut self, which: u32) -> SlotScan {
        let mut log = SlotScan::default();
        for place in 0..self.places() {
            match self.read(which, place).await {
                Place::Blank => continue,
                // A slot is written from its first place on, so the last record is the newest.
                Place::Record(record) => {
                    log.erasures = log.erasures.max(record.wear() & 0xFFFF);
                    log.last = place + 1;
                    if self.home == which || record.sequence() > self.sequence() {
                        self.latest = Some(record);
                        self.home = which;
                    }
                    log.hidden = 0;
                }
                Place::Cut => {}
                Place::Spoilt => log.hidden += 1,
            }
            log.used = place + 1;
        }
        log
    }

    /// The latest record.
    pub const fn latest(&self) -> Option<&R> {
        self.latest.as_ref()
    }

    /// Whether a place that cannot be read may have a later record.
    pub const fn is_hidden(&self) -> bool {
        self.hidden > 0
    }

    /// The number of the last record; 0 before the first.
    pub fn sequence(&self) -> u32 {
        self.latest.as_ref().map_or(0, R::sequence)
    }

    /// The number of the next record.
    ///
    /// # Errors
    /// [`StoreError::WornOut`] after the last one.
    pub fn next_sequence(&self) -> Result<u32, StoreError> {
        // Each spoilt place may hold a record with a number.
        let passed = self.sequence().checked_add(self.hidden);
        let sequence = passed.and_then(|passed| passed.checked_add(1));
        sequence.ok_or(StoreError::WornOut)
    }

    /// The memory.
    pub fn into_flash(self) -> F {
        self.flash
    }

    /// The memory, for access outside the two slots.
    #[cfg(feature = "load-tip")]
    pub fn flash_mut(&mut self) -> &mut F {
        &mut self.flash
    }

    /// Stores a record. `now` is the time since the start. The log sets the wear of the record.
    ///
    /// # Errors
    /// [`StoreError`]; the previous record stays in use.
    // The record is passed by reference, so that the futures hold only one copy.
    pub async fn save(&mut self, now: Microseconds, record: &mut R) -> Result<(), StoreError> {
        if !self.budget.take(now) {
            return Err(StoreError::TooSoon);
        }
        record.set_wear(self.wear());
        if self.append(record).await {
            return Ok(());
        }
        self.turn_over().await?;
        record.set_wear(self.wear());
        if self.append(record).await {
            return Ok(());
        }
        Err(StoreError::Failed)
    }

    const fn wear(&self) -> u32 {
        self.erasures | self.budget.owed() << 16
    }

    /// Writes into one of the next places of the current slot. Returns whether a write succeeded.
    async fn append(&mut self, record: &R) -> bool {
        // The first place that is still blank after the attempts stays the next place.
        let mut blank = None;
        for place in self.next..self.places().min(self.next + TRIES) {
            // Skips a place that is not blank or cannot be read.
            if self.read(self.current, place).await != Place::Blank {
                continue;
            }
            let bytes = record.encode();
            // The result of the write is ignored: only the data read back count, because the next start reads the same.
            let _ = self.flash.write(self.offset(self.current, place), &bytes).await;
            match self.read(self.current, place).await {
                Place::Record(found) if found == *record => {
                    self.latest = Some(found);
                    self.hidden = 0;
                    self.home = self.current;
                    self.next = place + 1;
                    return true;
                }
                Place::Blank => blank = blank.or(Some(place)),
                _ => {}
            }
        }
        self.next = blank.unwrap_or(self.next + TRIES).min(self.places());
        false
    }

    /// Erases the slot that does not hold the record in use, and continues there.
    async fn turn_over(&mut self) -> Result<(), StoreError> {
        if self.erasures >= 2 * ENDURANCE {
            return Err(StoreError::WornOut);
        }
        let other = 1 - self.home;
        let from = other * self.slot;
        // The slots alternate, so each has half of the erasures.
        self.erasures += 1;
        self.flash
            .erase(from, from + self.slot)
            .await
            .map_err(|_| StoreError::Failed)?;
        self.current = other;
        self.next = 0;
        Ok(())
    }

    async fn read(&mut self, which: u32, place: u32) -> Place<R> {
        let mut bytes = [0; LENGTH];
        let offset = self.offset(which, place);
        if self.flash.read(offset, &mut bytes).await.is_ok() {
            return match R::decode(&bytes) {
                Found::Blank => Place::Blank,
                Found::Record(record) => Place::Record(record),
                Found::Torn if ends_blank(&bytes) => Place::Cut,
                Found::Torn => Place::Spoilt,
            };
        }
        self.refused = true;
        let end = LENGTH - END;
        let last = self.flash.read(offset + end as u32, &mut bytes[end..]).await;
        if last.is_ok() && ends_blank(&bytes) {
            Place::Cut
        } else {
            Place::Spoilt
        }
    }

    const fn places(&self) -> u32 {
        self.slot / Self::PLACE
    }

    const fn offset(&self, which: u32, place: u32) -> u32 {
        which * self.slot + place * Self::PLACE
    }
}

/// Whether the end of a record was never written.
fn ends_blank<const LENGTH: usize>(bytes: &[u8; LENGTH]) -> bool {
    bytes[LENGTH - END..].iter().all(|&byte| byte == 0xFF)
}
