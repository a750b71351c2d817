//! The calibration of one fingertip in flash: a [log](crate::storage::log) of [records](Record), and a check whether the last
//! record belongs to this design. A calibration that is already stored is not written again.

use crate::signal::calibration::Calibration;
use crate::status::Stored;
use crate::storage::log::{RecordLog, StoreError};
use crate::storage::record::{LENGTH, Record};
use crate::units::Microseconds;
use embedded_storage_async::nor_flash::NorFlash;

/// Identity of the fingertip of the records.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Identity {
    /// The design whose tables are in the image.
    pub design_hash: u64,
    /// Version of these tables.
    pub table_version: u32,
    /// The firmware: major, minor, patch.
    pub firmware: [u8; 3],
    /// The transducer's range, pascals: limits the possible zeros.
    pub range: [i32; 2],
}

/// The two slots.
#[derive(Clone, Debug)]
pub struct Store<F> {
    log: RecordLog<F, Record, LENGTH>,
    identity: Identity,
}

impl<F: NorFlash> Store<F> {
    /// The first two slots of `slot` bytes in `flash`, to be read by [`Store::load`].
    ///
    /// # Panics
    /// At compile time, if the length of a record is not a multiple of the memory's write unit.
    pub const fn new(flash: F, slot: u32, identity: Identity) -> Self {
        Self {
            log: RecordLog::new(flash, slot),
            identity,
        }
    }

    /// [`Store::new`] and [`Store::load`].
    pub async fn open(flash: F, slot: u32, identity: Identity) -> (Self, Stored) {
        let mut store = Self::new(flash, slot, identity);
        let state = store.load().await;
        (store, state)
    }

    /// Reads both slots.
    pub async fn load(&mut self) -> Stored {
        match (self.log.load().await, self.log.latest()) {
            (Stored::InUse, Some(latest)) => self.state_of(latest),
            (state, _) => state,
        }
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

    /// The calibration in use. `None` if the record belongs to another design or has impossible values.
    pub fn calibration(&self) -> Option<Calibration> {
        let record = self
            .log
            .latest()
            .filter(|record| self.state_of(record) == Stored::InUse)?;
        record.calibration
    }

    /// The number of the last record; 0 before the first.
    pub fn sequence(&self) -> u32 {
        self.log.sequence()
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

    /// Stores a calibration, or clears it with `None`. `now` is the time since the start.
    ///
    /// # Errors
    /// [`StoreError`]; the previous record stays in use.
    pub async fn save(
        &mut self,
        now: Microseconds,
        calibration: Option<Calibration>,
    ) -> Result<(), StoreError> {
        let Identity {
            design_hash,
            table_version,
            firmware,
            ..
        } = self.identity;
        let mut record = Record {
            sequence: self.log.next_sequence()?,
            design_hash,
            table_version,
            firmware,
            calibration,
            wear: 0,
        };
        let same = |latest: &Record| {
            Record {
                sequence: record.sequence,
                wear: 0,
                ..*latest
            } == record
        };
        if !self.log.is_hidden() && self.log.latest().is_some_and(same) {
            return Ok(());
        }
        self.log.save(now, &mut record).await
    }
}
