//! The flash of the calibration. Every wait has a time limit: a memory that does not become ready in time has failed. A place that
//! cannot be read gives an error, never old data from the caches.

use super::ecc;
use embassy_stm32::pac::FLASH;
use embassy_time::{Duration, with_timeout};
use embedded_storage_async::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};

/// Longest erasure of a slot. 16 KB take 0.5 s, or 0.8 s with 8 bits at a time (DS9405 table 48). A tip of a hand may have 128 KB, which take 2 s.
const ERASE: Duration = Duration::from_secs(if cfg!(all(hand, feature = "load-tip")) {
    3
} else {
    2
});

/// Longest write. A record has 12 words of 0.1 ms each, a chunk of a tip 16 words, the record of a hand with twelve tips 104 words.
const WRITE: Duration = Duration::from_millis(if cfg!(hand) { 20 } else { 10 });

/// Clears the caches (RM0351 3.3.5, RM0090 3.5.1: a cache is reset while it is off). After programming, they may still hold the
/// blank flash.
fn flush_caches() {
    let before = FLASH.acr().read();
    if !before.icen() && !before.dcen() {
        return;
    }
    FLASH.acr().modify(|w| {
        w.set_icen(false);
        w.set_dcen(false);
    });
    FLASH.acr().modify(|w| {
        w.set_icrst(true);
        w.set_dcrst(true);
    });
    FLASH.acr().write_value(before);
}

/// A part of the flash, starting at an offset.
pub struct RetryingFlash<F> {
    flash: F,
    base: u32,
}

impl<F> RetryingFlash<F> {
    /// The part of the flash that starts at `base`.
    pub const fn new(flash: F, base: u32) -> Self {
        Self { flash, base }
    }

    /// The same flash with another start.
    #[cfg(feature = "load-tip")]
    pub const fn at(&mut self, base: u32) -> RetryingFlash<&mut F> {
        RetryingFlash {
            flash: &mut self.flash,
            base,
        }
    }
}

/// The memory refused, was not ready in time, or had an error that could not be corrected.
#[derive(Debug)]
pub struct MemoryFailure;

impl NorFlashError for MemoryFailure {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl<F: NorFlash> ErrorType for RetryingFlash<F> {
    type Error = MemoryFailure;
}

impl<F: NorFlash> ReadNorFlash for RetryingFlash<F> {
    const READ_SIZE: usize = F::READ_SIZE;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), MemoryFailure> {
        ecc::begin();
        let read = self.flash.read(self.base + offset, bytes).await;
        if ecc::failed() {
            flush_caches();
            return Err(MemoryFailure);
        }
        read.map_err(|_| MemoryFailure)
    }

    fn capacity(&self) -> usize {
        self.flash.capacity() - self.base as usize
    }
}

impl<F: NorFlash> NorFlash for RetryingFlash<F> {
    const WRITE_SIZE: usize = F::WRITE_SIZE;
    const ERASE_SIZE: usize = F::ERASE_SIZE;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), MemoryFailure> {
        #[cfg(all(hand, feature = "load-tip", feature = "board-nucleo-f429zi"))]
        super::chip::erase_by_words();
        let erased = with_timeout(ERASE, self.flash.erase(self.base + from, self.base + to)).await;
        flush_caches();
        erased.map_err(|_| MemoryFailure)?.map_err(|_| MemoryFailure)
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), MemoryFailure> {
        let written = with_timeout(WRITE, self.flash.write(self.base + offset, bytes)).await;
        flush_caches();
        written.map_err(|_| MemoryFailure)?.map_err(|_| MemoryFailure)
    }
}
