//! The error correction of the flash of the STM32L4 and the STM32G4, from the manuals alone: nothing here was tried on hardware.
//!
//! Each double word has a code beside it. One error is corrected. With two errors, as a double word has whose programming or erasure was
//! cut, the read gives arbitrary data, `FLASH_ECCR` keeps ECCD and the address, and the flash raises the non-maskable interrupt until ECCD
//! is cleared (RM0351 3.3.2, and RM0394 is taken to say the same for the STM32L432; RM0440 3.3.4). The interrupt comes some cycles after
//! the read, and the code continues behind the read. So the reader asks afterwards ([`failed`]), when the handler ([`take_failure`]) has
//! run or is pending.

use super::chip::{REGION, failed_bank};
use super::chosen::{CALIBRATION, SLOT};
use core::sync::atomic::{AtomicBool, Ordering};
use embassy_stm32::flash::FLASH_BASE;
use embassy_stm32::pac::FLASH;

/// The handler met a place of the calibration that cannot be read.
static MET: AtomicBool = AtomicBool::new(false);

/// To be called before a read of the calibration. Forgets errors that were corrected: while one is noted, the address
/// of the next is not.
pub fn begin() {
    FLASH.eccr().write(|w| w.set_eccc(true));
    MET.store(false, Ordering::Relaxed);
}

/// Whether what was read since [`begin`] is arbitrary.
pub fn failed() -> bool {
    // The reads have ended, and the interrupt is taken if it is pending.
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
    // In this order: the handler clears the one after it has set the other.
    FLASH.eccr().read().eccd() || MET.load(Ordering::Relaxed)
}

/// For the handler of the non-maskable interrupt: a place of the calibration could not be read, which the reader will
/// ask for.
///
/// # Errors
/// Another cause: the address in flash that was given up, a word of the image; or 0, none of the flash.
pub fn take_failure() -> Result<(), u32> {
    let register = FLASH.eccr().read();
    if !register.eccd() {
        return Err(0);
    }
    let place = failed_bank(register) + register.addr_ecc();
    let calibration = REGION + CALIBRATION;
    if register.sysf_ecc() || !(calibration..calibration + 2 * SLOT).contains(&place) {
        return Err(FLASH_BASE as u32 + place);
    }
    MET.store(true, Ordering::Relaxed);
    FLASH.eccr().write(|w| {
        w.set_eccc(true);
        w.set_eccd(true);
    });
    Ok(())
}
