//! NOR flash whose power fails when it is told to: programming only clears bits, erasing sets them, and what is under
//! way when power goes is left half done.
//!
//! Units of 4 bytes are the STM32F4's. Units of 8 bytes have error correction, as the STM32L4's (RM0351 3.3.2, 3.3.7):
//! each is programmed once between erasures, but for all zeros, and one that is left half done may refuse to be read.

use embassy_futures::block_on;
use embedded_storage_async::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};
use fingertip::signal::calibration::Calibration;
use fingertip::storage::hand_store::{HandStore, TipIdentity};
use fingertip::storage::store::{Identity, Store};
use fingertip::units::Microseconds;
use model_tables::random::Random;
use std::sync::atomic::{AtomicU64, Ordering};

/// Steps that one erasure is divided into: power may fail between and within them.
pub const ERASE_STEPS: u64 = 16;

/// How a step looks that power failed in: the unit that was written, or all that was not erased yet.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum HalfDone {
    /// Any mixture, bit by bit; with error correction also unit by unit, of all looks.
    #[default]
    Mixed,
    /// As if it had not begun.
    Untouched,
    /// As if it had ended.
    Complete,
    /// Refuses to be read.
    Unreadable,
    /// Reads as erased, and refuses to be programmed.
    LooksErased,
}

impl HalfDone {
    /// The looks of memory without error correction, ...
    pub const PLAIN: &[Self] = &[Self::Mixed, Self::Untouched, Self::Complete];
    /// ... and with it.
    pub const CORRECTED: &[Self] = &[
        Self::Mixed,
        Self::Untouched,
        Self::Complete,
        Self::Unreadable,
        Self::LooksErased,
    ];
}

/// One unit of memory with error correction, beside its bytes.
#[derive(Clone, Copy, Debug, Default)]
struct Unit {
    /// Programmed since it was erased.
    written: bool,
    /// Two errors: it cannot be read.
    spoilt: bool,
}

/// What the memory does wrong, beside losing power.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum Defect {
    /// Nothing.
    #[default]
    None,
    /// Operations (reads, writes, erasures, each counted) from this number on fail, so many of them.
    Fails {
        /// The first, from 0.
        from: u64,
        /// How many.
        times: u64,
    },
    /// Writes and erasures from this number on say that they succeeded and do nothing, so many of them.
    Pretends {
        /// The first, from 0.
        from: u64,
        /// How many.
        times: u64,
    },
}

/// The memory.
#[derive(Clone, Debug)]
pub struct SimulatedFlash<const SLOT: usize, const UNIT: usize = 4> {
    bytes: Vec<u8>,
    units: Vec<Unit>,
    half_done: HalfDone,
    /// Steps until power fails.
    budget: Option<u64>,
    powered: bool,
    steps: u64,
    operations: u64,
    defect: Defect,
    random: Random,
}

/// The memory has no power, or a defect.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct FlashFailure;

impl NorFlashError for FlashFailure {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl<const SLOT: usize, const UNIT: usize> SimulatedFlash<SLOT, UNIT> {
    /// Two erased slots; `seed` decides how half-done steps look.
    pub fn erased(seed: u64) -> Self {
        Self::of_slots(2, seed)
    }

    /// So many erased slots.
    pub fn of_slots(slots: usize, seed: u64) -> Self {
        Self {
            bytes: vec![0xFF; slots * SLOT],
            units: vec![Unit::default(); slots * SLOT / UNIT],
            half_done: HalfDone::default(),
            budget: None,
            powered: true,
            steps: 0,
            operations: 0,
            defect: Defect::None,
            random: Random(seed),
        }
    }

    /// The same memory, with power again and no further failure.
    #[must_use]
    pub fn powered_up(mut self) -> Self {
        self.budget = None;
        self.powered = true;
        self.defect = Defect::None;
        self
    }

    /// The same memory, whose power fails in the step after `steps` whole ones.
    #[must_use]
    pub fn failing_after(mut self, steps: u64) -> Self {
        self.budget = Some(steps);
        self
    }

    /// The same memory with a defect, its operations counted from here.
    #[must_use]
    pub fn with(mut self, defect: Defect) -> Self {
        self.operations = 0;
        self.defect = defect;
        self
    }

    /// Another look for half-done steps; `seed` decides the mixture.
    #[must_use]
    pub fn leaving(mut self, half_done: HalfDone, seed: u64) -> Self {
        self.half_done = half_done;
        self.random = Random(seed);
        self
    }

    /// The looks that its half-done steps have.
    pub const fn looks() -> &'static [HalfDone] {
        if Self::CORRECTED {
            HalfDone::CORRECTED
        } else {
            HalfDone::PLAIN
        }
    }

    /// The same memory, which refuses to read the unit at `offset`.
    #[must_use]
    pub fn spoilt_at(mut self, offset: usize) -> Self {
        self.units[offset / UNIT] = Unit {
            written: true,
            spoilt: true,
        };
        self
    }

    /// Steps so far: written units, and sixteenths of erasures.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Operations so far.
    pub fn operations(&self) -> u64 {
        self.operations
    }

    /// What lies there.
    pub fn bytes_mut(&mut self) -> &mut [u8] {
        &mut self.bytes
    }

    /// Whether a unit has error correction.
    const CORRECTED: bool = UNIT == 8;

    /// Programs one unit; false: it refuses.
    fn program(&mut self, unit: usize, data: &[u8]) -> bool {
        let zeros = data.iter().all(|&byte| byte == 0);
        if Self::CORRECTED && self.units[unit].written && !zeros {
            return false;
        }
        for (at, &byte) in (unit * UNIT..).zip(data) {
            self.bytes[at] &= byte;
        }
        self.units[unit] = Unit {
            written: true,
            spoilt: false,
        };
        true
    }

    fn erase_unit(&mut self, unit: usize) {
        self.bytes[unit * UNIT..][..UNIT].fill(0xFF);
        self.units[unit] = Unit::default();
    }

    /// How one unit is left: a mixture is of any look there is, or of bits.
    fn look(&mut self) -> HalfDone {
        match self.half_done {
            HalfDone::Mixed if Self::CORRECTED => HalfDone::CORRECTED[usize::from(self.noise()) % 5],
            look => look,
        }
    }

    /// Programs one unit by half.
    fn half_program(&mut self, unit: usize, data: &[u8]) {
        match self.look() {
            HalfDone::Untouched => {}
            HalfDone::Complete => {
                self.program(unit, data);
            }
            HalfDone::LooksErased => self.units[unit].written = true,
            look => {
                for (at, &byte) in (unit * UNIT..).zip(data) {
                    self.bytes[at] &= byte | self.noise();
                }
                self.units[unit] = Unit {
                    written: true,
                    spoilt: look == HalfDone::Unreadable,
                };
            }
        }
    }

    /// Erases one unit by half.
    fn half_erase(&mut self, unit: usize) {
        match self.look() {
            HalfDone::Untouched => {}
            HalfDone::Complete => self.erase_unit(unit),
            HalfDone::LooksErased => {
                self.erase_unit(unit);
                self.units[unit].written = true;
            }
            look => {
                for at in unit * UNIT..(unit + 1) * UNIT {
                    self.bytes[at] |= self.noise();
                }
                self.units[unit] = Unit {
                    written: true,
                    spoilt: look == HalfDone::Unreadable,
                };
            }
        }
    }

    /// One byte of noise.
    fn noise(&mut self) -> u8 {
        (self.random.bits() >> 56) as u8
    }

    /// Whether power lasts for the whole of the next step.
    fn step(&mut self) -> bool {
        self.steps += 1;
        match &mut self.budget {
            Some(0) => {
                self.powered = false;
                false
            }
            Some(left) => {
                *left -= 1;
                true
            }
            None => true,
        }
    }

    /// What the next operation does: true: it works; false: it pretends to.
    fn operate(&mut self) -> Result<bool, FlashFailure> {
        let number = self.operations;
        self.operations += 1;
        let within = |from: u64, times: u64| number >= from && number - from < times;
        match self.defect {
            _ if !self.powered => Err(FlashFailure),
            Defect::Fails { from, times } if within(from, times) => Err(FlashFailure),
            Defect::Pretends { from, times } => Ok(!within(from, times)),
            _ => Ok(true),
        }
    }
}

impl<const SLOT: usize, const UNIT: usize> ErrorType for SimulatedFlash<SLOT, UNIT> {
    type Error = FlashFailure;
}

impl<const SLOT: usize, const UNIT: usize> ReadNorFlash for SimulatedFlash<SLOT, UNIT> {
    const READ_SIZE: usize = 1;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashFailure> {
        self.operate()?;
        let from = offset as usize;
        let units = from / UNIT..(from + bytes.len()).div_ceil(UNIT);
        if self.units[units].iter().any(|unit| unit.spoilt) {
            return Err(FlashFailure);
        }
        bytes.copy_from_slice(&self.bytes[from..from + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl<const SLOT: usize, const UNIT: usize> NorFlash for SimulatedFlash<SLOT, UNIT> {
    const WRITE_SIZE: usize = UNIT;
    const ERASE_SIZE: usize = SLOT;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashFailure> {
        assert!((from as usize).is_multiple_of(SLOT) && (to as usize).is_multiple_of(SLOT));
        if !self.operate()? {
            return Ok(());
        }
        let units = from as usize / UNIT..to as usize / UNIT;
        let length = units.len() / ERASE_STEPS as usize;
        for step in 0..ERASE_STEPS as usize {
            let begin = units.start + step * length;
            if !self.step() {
                (begin..units.end).for_each(|unit| self.half_erase(unit));
                return Err(FlashFailure);
            }
            (begin..begin + length).for_each(|unit| self.erase_unit(unit));
        }
        Ok(())
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashFailure> {
        assert!((offset as usize).is_multiple_of(Self::WRITE_SIZE));
        if !self.operate()? {
            return Ok(());
        }
        for (unit, data) in (offset as usize / UNIT..).zip(bytes.chunks(UNIT)) {
            if !self.step() {
                self.half_program(unit, data);
                return Err(FlashFailure);
            }
            if !self.program(unit, data) {
                return Err(FlashFailure);
            }
        }
        Ok(())
    }
}

/// A time so long after all times before that a store allows the next save, also one that was opened since.
pub fn later() -> Microseconds {
    static LAST: AtomicU64 = AtomicU64::new(0);
    // Longer than the pause of a slot of four records, 1882 units of 2^21 us, and short enough for all saves until it is worn out.
    const STEP: u64 = 10_000 << 21;
    Microseconds(LAST.fetch_add(STEP, Ordering::Relaxed) + STEP)
}

/// The bytes of two slots that a hand of these tips saved calibrations in, one after the other: each with the number of its tip.
///
/// # Panics
/// For a tip that is not there.
pub fn saved_hand<const SLOT: usize, const TIPS: usize, const LENGTH: usize>(
    identities: [TipIdentity; TIPS],
    calibrations: &[(usize, Calibration)],
) -> Vec<u8> {
    let flash = <SimulatedFlash<SLOT>>::erased(1);
    let mut store = HandStore::<_, TIPS, LENGTH>::new(flash, SLOT as u32, identities, [0, 1, 0]);
    block_on(store.load());
    for (tip, calibration) in calibrations {
        block_on(store.save(later(), *tip, Some(*calibration))).expect("the memory is sound");
    }
    store.into_flash().bytes
}

/// The bytes of two slots that one calibration was saved in.
///
/// # Panics
/// Never: nothing fails that memory.
pub fn saved<const SLOT: usize>(identity: Identity, calibration: Calibration) -> Vec<u8> {
    let (mut store, _) = block_on(Store::open(
        <SimulatedFlash<SLOT>>::erased(1),
        SLOT as u32,
        identity,
    ));
    block_on(store.save(later(), Some(calibration))).expect("the memory is sound");
    store.into_flash().bytes
}
