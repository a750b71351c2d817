//! The calibrations of a hand in flash: a [log](crate::storage::log) of [records](HandRecord), each of all tips. A save changes one
//! tip and keeps the stored data of the others, even if they belong to a previous tip. Data that are already stored are not written
//! again.
//!
//! If a later record may have been lost, every tip reports [`Stored::Unreadable`]. A save of a tip clears this for that tip
//! only.

use crate::signal::calibration::Calibration;
use crate::status::Stored;
use crate::storage::hand_record::{HandRecord, TipEntry};
use crate::storage::log::{RecordLog, StoreError};
use crate::units::Microseconds;
use embedded_storage_async::nor_flash::NorFlash;
#[cfg(feature = "load-tip")]
use model_tables::constants::DesignConstants;

/// Identity of the tip of an entry.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct TipIdentity {
    /// Hash of the tip: its name, its place on the board and its design.
    pub hash: u64,
    /// Version of its tables.
    pub table_version: u32,
    /// Its transducer's range, pascals: limits the possible zeros.
    pub range: [i32; 2],
}

#[cfg(feature = "load-tip")]
impl TipIdentity {
    /// The identity of a tip with a loaded design. `image` is the hash of its design in the image. The identity differs unless the two
    /// designs are the same.
    #[must_use]
    pub const fn with_design(self, image: u64, loaded: &DesignConstants) -> Self {
        Self {
            hash: self.hash ^ image ^ loaded.hash,
            table_version: loaded.table_version,
            range: loaded.transducer.range,
        }
    }
}

/// Stored data of a tip.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct StoredTip {
    /// State of the stored calibration.
    pub state: Stored,
    /// Sequence number of the last record that changed this tip; 0: none.
    pub number: u32,
    /// The calibration in use. `None` if the design's own values are in use.
    pub calibration: Option<Calibration>,
}

/// The two slots, with records of `LENGTH` bytes, which is [`length`](crate::storage::hand_record::length) of `TIPS`.
#[derive(Clone, Debug)]
pub struct HandStore<F, const TIPS: usize, const LENGTH: usize> {
    log: RecordLog<F, HandRecord<TIPS>, LENGTH>,
    identities: [TipIdentity; TIPS],
    /// Major, minor, patch.
    firmware: [u8; 3],
    /// State of the log.
    state: Stored,
}

impl<F: NorFlash, const TIPS: usize, const LENGTH: usize> HandStore<F, TIPS, LENGTH> {
    /// The first two slots of `slot` bytes in `flash`, to be read by [`HandStore::load`].
    ///
    /// # Panics
    /// At compile time, if the length of a record is not a multiple of the memory's write unit.
    pub const fn new(flash: F, slot: u32, identities: [TipIdentity; TIPS], firmware: [u8; 3]) -> Self {
        Self {
            log: RecordLog::new(flash, slot),
            identities,
            firmware,
            state: Stored::None,
        }
    }

    /// Reads both slots.
    pub async fn load(&mut self) {
        self.state = self.log.load().await;
    }

    /// The stored data of a tip. A tip that does not exist has none.
    pub fn stored(&self, tip: usize) -> StoredTip {
        let entry = self.entry(tip);
        let own = self
            .identities
            .get(tip)
            .map_or(Stored::None, |identity| state_of(identity, &entry));
        let state = match self.state {
            Stored::InUse if entry.doubtful => Stored::Unreadable,
            Stored::InUse => own,
            lost => lost,
        };
        StoredTip {
            state,
            number: entry.number,
            calibration: entry.calibration.filter(|_| own == Stored::InUse),
        }
    }

    fn entry(&self, tip: usize) -> TipEntry {
        let entry = self.log.latest().and_then(|latest| latest.tips.get(tip));
        entry.copied().unwrap_or(TipEntry::NOTHING)
    }

    /// The memory.
    pub fn into_flash(self) -> F {
        self.log.into_flash()
    }

    /// The memory, for access outside the two slots.
    #[cfg(feature = "load-tip")]
    pub fn flash_mut(&mut self) -> &mut F {
        self.log.flash_mut()
    }

    /// Stores a tip's calibration, or clears it with `None`. `now` is the time since the start.
    ///
    /// # Errors
    /// [`StoreError`]; the previous calibration stays in use.
    pub async fn save(
        &mut self,
        now: Microseconds,
        tip: usize,
        calibration: Option<Calibration>,
    ) -> Result<(), StoreError> {
        let identity = self.identities.get(tip).ok_or(StoreError::Failed)?;
        let before = self.log.latest().map(|latest| latest.tips);
        let mut tips = before.unwrap_or([TipEntry::NOTHING; TIPS]);
        let sequence = self.log.next_sequence()?;
        if matches!(self.state, Stored::Unreadable | Stored::Damaged) {
            for entry in &mut tips {
                entry.doubtful = true;
            }
        }
        if let Some(entry) = tips.get_mut(tip) {
            *entry = TipEntry {
                hash: identity.hash,
                table_version: identity.table_version,
                number: entry.number,
                calibration,
                doubtful: false,
            };
            if self.state == Stored::InUse && before == Some(tips) {
                return Ok(());
            }
            if let Some(entry) = tips.get_mut(tip) {
                entry.number = sequence;
            }
        }
        let mut record = HandRecord {
            sequence,
            firmware: self.firmware,
            tips,
            wear: 0,
        };
        self.log.save(now, &mut record).await?;
        self.state = Stored::InUse;
        Ok(())
    }
}

/// State of an entry for the present tip.
fn state_of(identity: &TipIdentity, entry: &TipEntry) -> Stored {
    match entry.calibration {
        None => Stored::None,
        Some(_) if (entry.hash, entry.table_version) != (identity.hash, identity.table_version) => {
            Stored::OtherDesign
        }
        Some(calibration) if !calibration.is_plausible(identity.range) => Stored::Damaged,
        Some(_) => Stored::InUse,
    }
}
