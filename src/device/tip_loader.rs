//! The policy for the commands that load a tip's data (feature `load-tip`), over the two [slots](TipSlots) of each tip, without a clock
//! or a line.
//!
//! The steps are arm, begin, chunks, verify and activate. Each step is refused if the previous one is missing. An activated or
//! rolled back tip is in use after a restart, because a signal path has one design for its whole life. The caller restarts once
//! the answer is on the line. Only one tip is loaded at a time. A begin for another tip ends the previous load.

use crate::link::load::{CHUNK, LoadCommand, LoadOutcome, LoadReply, LoadRequest, Piece, READ_BACK, refused};
use crate::signal::calibration::Calibration;
use crate::signal::design::Design as _;
use crate::signal::loaded_design::LoadedDesign;
use crate::storage::log::StoreError;
use crate::storage::tip_slots::{SlotBlock, TipSlots};
use crate::units::Microseconds;
use embedded_storage_async::nor_flash::NorFlash;
use model_tables::block::BlockError;
use model_tables::block::read::stated;
use model_tables::constants::Transducer;

/// Largest length of a block, bytes. The shipped designs need a few hundred.
pub const LARGEST_BLOCK: usize = 4096;

/// Loading is allowed for this time after `arm`, and after each command that changes something, microseconds.
const ARMED: u64 = 60_000_000;

/// What a start found in the slots.
#[derive(Clone, Copy, Debug)]
#[allow(clippy::large_enum_variant)] // made once, and there is no heap
pub enum FoundTip<'a> {
    /// No tip is loaded, or it was rolled back. The image's own tables are in use.
    Image,
    /// A loaded tip, with the calibration of the fingertip if the block has one.
    Loaded(LoadedDesign<'a>, Option<Calibration>),
    /// A loaded tip that cannot be used. The image's own tables are in use, and the board reports this.
    Refused,
}

/// Progress of a load.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Progress {
    Nothing,
    /// The slot was erased for this block.
    Begun {
        length: u32,
        check: u32,
        /// Nothing was written yet.
        blank: bool,
    },
    Verified(SlotBlock),
}

/// State of the load commands.
#[derive(Clone, Debug)]
pub struct TipLoader<const TIPS: usize> {
    slots: [TipSlots; TIPS],
    transducers: [Transducer; TIPS],
    /// Tip of the present command.
    tip: usize,
    /// Tip of the present load.
    loading: usize,
    progress: Progress,
    /// Time when the permission to load ends, microseconds.
    armed_until: u64,
    restarting: bool,
}

impl<const TIPS: usize> TipLoader<TIPS> {
    /// A loader for a board whose tips have these transducers.
    ///
    /// # Panics
    /// At compile time, if there is no tip.
    pub const fn new(slots: [TipSlots; TIPS], transducers: [Transducer; TIPS]) -> Self {
        const { assert!(TIPS > 0) };
        Self {
            slots,
            transducers,
            tip: 0,
            loading: 0,
            progress: Progress::Nothing,
            armed_until: 0,
            restarting: false,
        }
    }

    /// Reads the slots of a tip at a start, and its block in use into `buffer`. A tip number that does not exist gives [`FoundTip::Image`].
    pub async fn start<'a>(
        &mut self,
        tip: usize,
        flash: &mut impl NorFlash,
        buffer: &'a mut [u8],
    ) -> FoundTip<'a> {
        if tip >= TIPS {
            return FoundTip::Image;
        }
        self.tip = tip;
        self.slots().scan(flash).await;
        let Some(block) = self.slots().in_use() else {
            return FoundTip::Image;
        };
        match self.judge(flash, block, buffer).await {
            Ok((design, calibration)) => FoundTip::Loaded(design, calibration),
            Err(_) => FoundTip::Refused,
        }
    }

    /// Whether an answer reported that the board restarts.
    pub const fn is_restarting(&self) -> bool {
        self.restarting
    }

    /// The tip whose design changes at that restart.
    pub const fn changed(&self) -> usize {
        self.loading
    }

    fn slots(&mut self) -> &mut TipSlots {
        // The number was checked against the number of tips.
        &mut self.slots[self.tip]
    }

    /// Executes a command for a tip. `buffer` is used to check a block.
    pub async fn request(
        &mut self,
        now: Microseconds,
        flash: &mut impl NorFlash,
        (tip, request): (u8, LoadRequest),
        buffer: &mut [u8],
    ) -> LoadReply {
        let LoadRequest { sequence, command } = request;
        let known = usize::from(tip) < TIPS;
        if known {
            self.tip = usize::from(tip);
        }
        let outcome = if self.restarting {
            Err((LoadOutcome::Busy, 0))
        } else if !known {
            Err((LoadOutcome::WrongTip, 0))
        } else if let LoadCommand::ReadBack { offset, length } = command {
            match self.read_back(flash, offset, length).await {
                Ok(bytes) => {
                    return LoadReply::Data {
                        time: now,
                        sequence,
                        offset,
                        bytes,
                    };
                }
                Err(outcome) => Err((outcome, 0)),
            }
        } else if command == LoadCommand::Arm || now.0 < self.armed_until {
            self.armed_until = now.0.saturating_add(ARMED);
            self.step(flash, command, buffer).await
        } else {
            Err((LoadOutcome::NotArmed, 0))
        };
        let (outcome, findings) = outcome.err().unwrap_or((LoadOutcome::Done, 0));
        LoadReply::Answer {
            time: now,
            kind: command.kind(),
            sequence,
            outcome,
            findings,
        }
    }

    async fn step(
        &mut self,
        flash: &mut impl NorFlash,
        command: LoadCommand,
        buffer: &mut [u8],
    ) -> Result<(), (LoadOutcome, u16)> {
        match command {
            LoadCommand::Arm | LoadCommand::ReadBack { .. } => Ok(()),
            LoadCommand::Begin { tip, length, check } => {
                self.begin(flash, tip, length, check).await.map_err(plain)
            }
            LoadCommand::Chunk { offset, bytes } => {
                self.chunk(flash, offset, bytes.as_slice()).await.map_err(plain)
            }
            LoadCommand::Verify => self.verify(flash, buffer).await,
            LoadCommand::Activate { hash } => self.activate(flash, hash).await.map_err(plain),
            LoadCommand::RollBack => self.roll_back(flash, buffer).await,
        }
    }

    async fn begin(
        &mut self,
        flash: &mut impl NorFlash,
        tip: u8,
        length: u32,
        check: u32,
    ) -> Result<(), LoadOutcome> {
        if usize::from(tip) != self.tip {
            return Err(LoadOutcome::WrongTip);
        }
        if length as usize > LARGEST_BLOCK || length > self.slots().room() {
            return Err(LoadOutcome::OutOfBounds);
        }
        let begun = Progress::Begun {
            length,
            check,
            blank: true,
        };
        // The command was repeated because its answer was lost. The slot is already erased, so it is not erased again.
        if self.progress() == begun {
            return Ok(());
        }
        self.loading = self.tip;
        self.progress = Progress::Nothing;
        self.slots()
            .erase_free(flash)
            .await
            .map_err(|_| LoadOutcome::MemoryFailed)?;
        self.progress = begun;
        Ok(())
    }

    async fn chunk(
        &mut self,
        flash: &mut impl NorFlash,
        offset: u32,
        bytes: &[u8],
    ) -> Result<(), LoadOutcome> {
        let (length, check) = match self.progress() {
            Progress::Nothing => return Err(LoadOutcome::OutOfOrder),
            Progress::Begun { length, check, .. } => (length, check),
            Progress::Verified(block) => (block.length, block.check),
        };
        let expected = length.saturating_sub(offset).min(CHUNK as u32);
        if expected as usize != bytes.len() {
            return Err(LoadOutcome::OutOfBounds);
        }
        self.progress = Progress::Begun {
            length,
            check,
            blank: false,
        };
        self.slots()
            .write_free::<CHUNK>(flash, offset, bytes)
            .await
            .map_err(|_| LoadOutcome::MemoryFailed)
    }

    async fn verify(
        &mut self,
        flash: &mut impl NorFlash,
        buffer: &mut [u8],
    ) -> Result<(), (LoadOutcome, u16)> {
        let (length, check) = match self.progress() {
            Progress::Nothing => return Err(plain(LoadOutcome::OutOfOrder)),
            Progress::Begun { length, check, .. } => (length, check),
            Progress::Verified(block) => (block.length, block.check),
        };
        let mut block = SlotBlock {
            slot: self.slots().free(),
            length,
            check,
            hash: 0,
        };
        block.hash = self
            .judge(flash, block, buffer)
            .await
            .map(|(design, _)| hash(&design))?;
        self.progress = Progress::Verified(block);
        Ok(())
    }

    async fn activate(&mut self, flash: &mut impl NorFlash, hash: u64) -> Result<(), LoadOutcome> {
        let Progress::Verified(block) = self.progress() else {
            return Err(LoadOutcome::OutOfOrder);
        };
        if block.hash != hash {
            return Err(LoadOutcome::OtherHash);
        }
        let activated = self.slots().activate(flash, block).await;
        // After a failure the slot may hold part of an activation. Only a new load gives a known state.
        self.progress = Progress::Nothing;
        activated.map_err(failed)?;
        self.restarting = true;
        Ok(())
    }

    async fn roll_back(
        &mut self,
        flash: &mut impl NorFlash,
        buffer: &mut [u8],
    ) -> Result<(), (LoadOutcome, u16)> {
        let to = self
            .slots()
            .rolls_back_to()
            .ok_or(plain(LoadOutcome::NothingToRollBack))?;
        if let Some(block) = to {
            self.judge(flash, block, buffer).await?;
        }
        self.loading = self.tip;
        self.progress = Progress::Nothing;
        self.slots()
            .roll_back(flash, to)
            .await
            .map_err(|error| plain(failed(error)))?;
        self.restarting = true;
        Ok(())
    }

    /// Progress of the load of the present command's tip.
    fn progress(&self) -> Progress {
        if self.tip == self.loading {
            self.progress
        } else {
            Progress::Nothing
        }
    }

    async fn read_back(
        &mut self,
        flash: &mut impl NorFlash,
        offset: u32,
        length: u8,
    ) -> Result<Piece<READ_BACK>, LoadOutcome> {
        let block = self.slots().in_use().ok_or(LoadOutcome::OutOfOrder)?;
        let mut bytes = [0; READ_BACK];
        let within = block.length.saturating_sub(offset).min(u32::from(length));
        let part = bytes
            .get_mut(..within as usize)
            .filter(|part| !part.is_empty())
            .ok_or(LoadOutcome::OutOfBounds)?;
        self.slots()
            .read(flash, block.slot, offset, part)
            .await
            .map_err(failed)?;
        Piece::of(part).ok_or(LoadOutcome::OutOfBounds)
    }

    /// Reads and checks a whole block, and returns its design if this image can use it.
    async fn judge<'a>(
        &mut self,
        flash: &mut impl NorFlash,
        block: SlotBlock,
        buffer: &'a mut [u8],
    ) -> Result<(LoadedDesign<'a>, Option<Calibration>), (LoadOutcome, u16)> {
        let refuse = |why: u16| (LoadOutcome::BlockRefused, why);
        let bytes = buffer
            .get_mut(..block.length as usize)
            .ok_or(refuse(refused::LENGTH))?;
        self.slots()
            .read(flash, block.slot, 0, bytes)
            .await
            .map_err(|error| plain(failed(error)))?;
        let bytes: &'a [u8] = bytes;
        let (design, calibration) = LoadedDesign::read(bytes).map_err(|error| refuse(finding(error)))?;
        let (length, check) = stated(bytes).ok_or(refuse(refused::LAYOUT))?;
        let Transducer {
            range,
            quantity,
            kind,
            ..
        } = design.parameters().constants.transducer;
        let own = &self.transducers[self.tip];
        let other = (range, quantity, kind) != (own.range, own.quantity, own.kind);
        let known = block.hash == 0 || block.hash == hash(&design);
        let why = match () {
            () if length != block.length => refused::LENGTH,
            () if check != block.check || !known => refused::CHECK,
            () if other => refused::TRANSDUCER,
            () => return Ok((design, calibration)),
        };
        Err(refuse(why))
    }
}

fn plain(outcome: LoadOutcome) -> (LoadOutcome, u16) {
    (outcome, 0)
}

fn failed(_: StoreError) -> LoadOutcome {
    LoadOutcome::MemoryFailed
}

fn hash(design: &LoadedDesign<'_>) -> u64 {
    design.parameters().constants.hash
}

/// The finding bit of an error.
const fn finding(error: BlockError) -> u16 {
    match error {
        BlockError::NoBlock | BlockError::Short { .. } => refused::LENGTH,
        BlockError::Check => refused::CHECK,
        BlockError::LayoutVersion(_)
        | BlockError::Directory
        | BlockError::UnknownSection(_)
        | BlockError::SectionVersion(..)
        | BlockError::Missing(_)
        | BlockError::SectionLength(_) => refused::LAYOUT,
        BlockError::Value(..) => refused::VALUE,
        BlockError::Tables(_) => refused::TABLES,
    }
}
