//! The calibration in flash: two slots of erasable memory, each a log of records; the highest sequence number is in use.
//!
//! A new record goes behind the last one in its slot. When that is full the *other* slot is erased and written, never
//! the one that holds the record in use: power may fail at any write or erasure, and what is read afterwards is
//! the old calibration or the new one. Every record is read back before it counts. One erasure frees a slot for a slot full of
//! saves, what is stored already is not stored again, and [`ENDURANCE`] ends it before the memory does.
//!
//! Memory with error correction refuses to read a unit whose programming or erasure was cut. A place with such a unit
//! holds no record and is passed over: saves go on behind it, and the next erasure of its slot heals it. A place that
//! may have held a whole record, newer than the one in use, makes the state [`Stored::Unreadable`] until the next
//! save. A record is written in order, so a place that ends blank never held one.
//!
//! Own code and no key-value crate: one value and no keys, so that there is nothing to collect; what is proven is the
//! whole of it, by a sweep over every cut (`host-tests/tests/calibration_store.rs`).

use crate::signal::calibration::Calibration;
use crate::status::Stored;
use crate::storage::record::{self, Found, LENGTH, Record};
use embedded_storage_async::nor_flash::NorFlash;

/// Erasures of a slot: what flash is specified for at the least (DS9405 table 49: 10 000 cycles).
pub const ENDURANCE: u32 = 10_000;

/// Places tried in one slot before it is given up for the other.
const TRIES: u32 = 3;

/// What records are for.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Identity {
    /// The design whose tables are in the image.
    pub design_hash: u64,
    /// Their version.
    pub table_version: u32,
    /// The firmware: major, minor, patch.
    pub firmware: [u8; 3],
    /// The transducer's range, pascals: bounds what can be a zero.
    pub range: [i32; 2],
}

/// Why a calibration was not stored. What was stored before is stored still.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum StoreError {
    /// The memory does not take it, or not what was given.
    Failed,
    /// The memory was erased as often as it stands.
    WornOut,
}

/// The two slots.
#[derive(Clone, Debug)]
pub struct Store<F> {
    flash: F,
    identity: Identity,
    /// Bytes of a slot.
    slot: u32,
    latest: Option<Record>,
    /// The slot that holds it.
    home: u32,
    /// The slot that is written to.
    current: u32,
    /// The next place in it.
    next: u32,
    erasures: u32,
    /// Spoilt places that may have held newer records than the one in use.
    hidden: u32,
    /// The memory refused to read some place.
    refused: bool,
}

/// What a place holds.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Place {
    Blank,
    Record(Record),
    /// A record that was never written to its end.
    Cut,
    /// Perhaps a record once: it cannot be read, or its check does not fit.
    Spoilt,
}

/// What one slot holds.
#[derive(Clone, Copy, Debug, Default)]
struct Log {
    /// Places up to the last one that is not blank.
    used: u32,
    /// Whether there is a record.
    holds: bool,
    /// Spoilt places behind the last one.
    hidden: u32,
    /// The largest count of erasures in a record.
    erasures: u32,
}

impl<F: NorFlash> Store<F> {
    const PLACE: u32 = LENGTH as u32;

    /// The first two slots of `slot` bytes in `flash`, to be read by [`Store::load`].
    ///
    /// # Panics
    /// At compile time, for a memory whose write unit a record is not a multiple of.
    pub const fn new(flash: F, slot: u32, identity: Identity) -> Self {
        const { assert!(LENGTH.is_multiple_of(F::WRITE_SIZE)) };
        Self {
            flash,
            identity,
            slot,
            latest: None,
            home: 0,
            current: 0,
            next: 0,
            erasures: 0,
            hidden: 0,
            refused: false,
        }
    }

    /// [`Store::new`] and [`Store::load`].
    pub async fn open(flash: F, slot: u32, identity: Identity) -> (Self, Stored) {
        let mut store = Self::new(flash, slot, identity);
        let state = store.load().await;
        (store, state)
    }

    /// Reads both slots.
    // In place, and the latest record into its own: moved from one future to another they take a `memmove`, 1.6 kB of flash.
    pub async fn load(&mut self) -> Stored {
        let logs = [self.scan(0).await, self.scan(1).await];
        let [first, second] = &logs;
        let (in_use, other) = if self.home == 0 {
            (first, second)
        } else {
            (second, first)
        };
        // Saves leave a slot when it is full, so behind a slot that is not full there is no newer one; and the records
        // of a slot are older than the first of the next.
        let turned_over = !in_use.holds || in_use.used == self.places();
        self.hidden = in_use.hidden;
        if turned_over && !other.holds {
            self.hidden += other.hidden;
        }
        self.current = self.home;
        self.next = in_use.used;
        self.erasures = in_use.erasures.max(other.erasures);
        match &self.latest {
            Some(_) if self.hidden > 0 => Stored::Unreadable,
            Some(latest) => self.state_of(latest),
            None if self.refused => Stored::Unreadable,
            None if in_use.used + other.used > 0 => Stored::Damaged,
            None => Stored::None,
        }
    }

    /// Reads one slot, each place once, and keeps its last record where that is newer than the other slot's. All of it: a place that cannot be read now may read as blank at another start,
    /// so blanks may lie before a record.
    async fn scan(&mut self, which: u32) -> Log {
        let mut log = Log::default();
        for place in 0..self.places() {
            match self.read(which, place).await {
                Place::Blank => continue,
                // A slot is written from its first place on: the last record is the newest.
                Place::Record(record) => {
                    log.erasures = log.erasures.max(record.erasures);
                    log.holds = true;
                    if self.home == which || record.sequence > self.sequence() {
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

    fn state_of(&self, record: &Record) -> Stored {
        let identity = &self.identity;
        match record.calibration {
            None => Stored::None,
            Some(_)
                if record.design_hash != identity.design_hash
                    || record.table_version != identity.table_version =>
            {
                Stored::OtherDesign
            }
            Some(calibration) if !calibration.is_plausible(identity.range) => Stored::Damaged,
            Some(_) => Stored::InUse,
        }
    }

    /// The calibration in use, if the record is this design's and its values can be.
    pub fn calibration(&self) -> Option<Calibration> {
        let record = self
            .latest
            .filter(|record| self.state_of(record) == Stored::InUse)?;
        record.calibration
    }

    /// The number of the last record; 0 before the first.
    pub fn sequence(&self) -> u32 {
        self.latest.map_or(0, |record| record.sequence)
    }

    /// The memory.
    pub fn into_flash(self) -> F {
        self.flash
    }

    /// The memory, for what lies outside of the two slots.
    #[cfg(feature = "load-tip")]
    pub fn flash_mut(&mut self) -> &mut F {
        &mut self.flash
    }

    /// Stores a calibration, or that there is none.
    ///
    /// # Errors
    /// [`StoreError`]; the record from before stays in use.
    pub async fn save(&mut self, calibration: Option<Calibration>) -> Result<(), StoreError> {
        let Identity {
            design_hash,
            table_version,
            firmware,
            ..
        } = self.identity;
        // Each spoilt place may hold one.
        let passed = self.sequence().checked_add(self.hidden);
        let sequence = passed.and_then(|passed| passed.checked_add(1));
        let mut record = Record {
            sequence: sequence.ok_or(StoreError::WornOut)?,
            design_hash,
            table_version,
            firmware,
            calibration,
            erasures: 0,
        };
        let same = |latest: &Record| {
            Record {
                sequence: record.sequence,
                erasures: 0,
                ..*latest
            } == record
        };
        if self.hidden == 0 && self.latest.as_ref().is_some_and(same) {
            return Ok(());
        }
        record.erasures = self.erasures;
        if self.append(&record).await {
            return Ok(());
        }
        self.turn_over().await?;
        record.erasures = self.erasures;
        if self.append(&record).await {
            return Ok(());
        }
        Err(StoreError::Failed)
    }

    /// Writes into the next places of the current slot; whether one took it.
    async fn append(&mut self, record: &Record) -> bool {
        // The first place that is blank after all is the next one still.
        let mut blank = None;
        for place in self.next..self.places().min(self.next + TRIES) {
            // A place that is not blank, or cannot be read, is passed over.
            if self.read(self.current, place).await != Place::Blank {
                continue;
            }
            let bytes = record::encode(record);
            // What is read back is what the next start will read, whatever the memory says of the write.
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

    /// Erases the slot that does not hold the record in use, and goes on there.
    async fn turn_over(&mut self) -> Result<(), StoreError> {
        if self.erasures >= 2 * ENDURANCE {
            return Err(StoreError::WornOut);
        }
        let other = 1 - self.home;
        let from = other * self.slot;
        // The slots take turns, so each has half of these.
        self.erasures += 1;
        self.flash
            .erase(from, from + self.slot)
            .await
            .map_err(|_| StoreError::Failed)?;
        self.current = other;
        self.next = 0;
        Ok(())
    }

    async fn read(&mut self, which: u32, place: u32) -> Place {
        let mut bytes = [0; LENGTH];
        let offset = self.offset(which, place);
        if self.flash.read(offset, &mut bytes).await.is_ok() {
            return match record::decode(&bytes) {
                Found::Blank => Place::Blank,
                Found::Record(record) => Place::Record(record),
                Found::Torn if record::ends_blank(&bytes) => Place::Cut,
                Found::Torn => Place::Spoilt,
            };
        }
        self.refused = true;
        let end = LENGTH - record::END;
        let last = self.flash.read(offset + end as u32, &mut bytes[end..]).await;
        if last.is_ok() && record::ends_blank(&bytes) {
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
