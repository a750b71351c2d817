//! The error correction of the flash of the STM32L4 and the STM32G4, written from the manuals only; nothing here was tried on hardware.
//!
//! Each double word has an error-correcting code. One wrong bit is corrected. An interrupted programming or erasure can leave
//! two wrong bits. The read then gives arbitrary data, `FLASH_ECCR` keeps ECCD and the address, and the flash raises the
//! non-maskable interrupt until ECCD is cleared (RM0351 3.3.2, and RM0394 is taken to say the same for the STM32L432; RM0440
//! 3.3.4). The interrupt comes some cycles after the read, and the code continues behind the read. The reader therefore checks
//! afterwards ([`failed`]), when the handler ([`take_failure`]) has run or is pending.

use super::chip::{REGION, failed_bank};
use super::chosen::{CALIBRATION, SLOT};
use core::sync::atomic::{AtomicBool, Ordering};
use embassy_stm32::flash::FLASH_BASE;
use embassy_stm32::pac::FLASH;

/// Whether the handler found an unreadable place of the calibration.
static MET: AtomicBool = AtomicBool::new(false);

/// To be called before a read of the calibration. Clears the flag of a corrected error, because while it is set the address of
/// the next error is not stored.
pub fn begin() {
    FLASH.eccr().write(|w| w.set_eccc(true));
    MET.store(false, Ordering::Relaxed);
}

/// Whether the data read since [`begin`] are arbitrary.
pub fn failed() -> bool {
    // After these barriers the reads have ended, and a pending interrupt has been taken.
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
    // The order matters: the handler sets `MET` before it clears ECCD.
    FLASH.eccr().read().eccd() || MET.load(Ordering::Relaxed)
}

/// For the handler of the non-maskable interrupt: a place of the calibration could not be read. The reader will check for this.
///
/// # Errors
/// Another cause: the address of an unreadable word of the image, or 0 if the cause is not the flash.
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
