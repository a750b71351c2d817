//! NOR flash whose power fails when it is told to: programming only clears bits, erasing sets them, and what is under
//! way when power goes is left half done.

use embassy_futures::block_on;
use embedded_storage_async::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};
use fingertip::calibration::Calibration;
use fingertip::store::{Identity, Store};

/// Steps that one erasure is divided into: power may fail between and within them.
pub const ERASE_STEPS: u64 = 16;

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
pub struct SimulatedFlash<const SLOT: usize> {
    bytes: Vec<u8>,
    /// Steps until power fails.
    budget: Option<u64>,
    powered: bool,
    steps: u64,
    operations: u64,
    defect: Defect,
    random: u64,
}

/// The memory has no power, or a defect.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct FlashFailure;

impl NorFlashError for FlashFailure {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl<const SLOT: usize> SimulatedFlash<SLOT> {
    /// Two erased slots; `seed` decides how half-done steps look.
    pub fn erased(seed: u64) -> Self {
        Self {
            bytes: vec![0xFF; 2 * SLOT],
            budget: None,
            powered: true,
            steps: 0,
            operations: 0,
            defect: Defect::None,
            random: seed.wrapping_mul(2).wrapping_add(1),
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

    /// Another look for half-done steps.
    #[must_use]
    pub fn seeded(mut self, seed: u64) -> Self {
        self.random = seed.wrapping_mul(2).wrapping_add(1);
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

    /// One byte of noise (xorshift64*).
    fn noise(&mut self) -> u8 {
        self.random ^= self.random >> 12;
        self.random ^= self.random << 25;
        self.random ^= self.random >> 27;
        (self.random.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 56) as u8
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

impl<const SLOT: usize> ErrorType for SimulatedFlash<SLOT> {
    type Error = FlashFailure;
}

impl<const SLOT: usize> ReadNorFlash for SimulatedFlash<SLOT> {
    const READ_SIZE: usize = 1;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashFailure> {
        self.operate()?;
        let from = offset as usize;
        bytes.copy_from_slice(&self.bytes[from..from + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        2 * SLOT
    }
}

impl<const SLOT: usize> NorFlash for SimulatedFlash<SLOT> {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = SLOT;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashFailure> {
        assert!((from as usize).is_multiple_of(SLOT) && (to as usize).is_multiple_of(SLOT));
        if !self.operate()? {
            return Ok(());
        }
        let length = (to - from) as usize / ERASE_STEPS as usize;
        for step in 0..ERASE_STEPS as usize {
            let whole = self.step();
            for i in 0..length {
                let at = from as usize + step * length + i;
                self.bytes[at] |= if whole { 0xFF } else { self.noise() };
            }
            if !whole {
                return Err(FlashFailure);
            }
        }
        Ok(())
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashFailure> {
        assert!((offset as usize).is_multiple_of(Self::WRITE_SIZE));
        if !self.operate()? {
            return Ok(());
        }
        for (i, unit) in bytes.chunks(Self::WRITE_SIZE).enumerate() {
            let whole = self.step();
            for (j, &byte) in unit.iter().enumerate() {
                let at = offset as usize + i * Self::WRITE_SIZE + j;
                self.bytes[at] &= if whole { byte } else { byte | self.noise() };
            }
            if !whole {
                return Err(FlashFailure);
            }
        }
        Ok(())
    }
}

/// The bytes of two slots that one calibration was saved in.
///
/// # Panics
/// Never: nothing fails that memory.
pub fn saved<const SLOT: usize>(identity: Identity, calibration: Calibration) -> Vec<u8> {
    let (mut store, _) = block_on(Store::open(
        SimulatedFlash::<SLOT>::erased(1),
        SLOT as u32,
        identity,
    ));
    block_on(store.save(Some(calibration))).expect("the memory is sound");
    store.into_flash().bytes
}
