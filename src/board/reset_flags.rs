//! The flags of the last reset of the STM32L4 and the STM32G4, which are the same.

use crate::status::ResetCause;
use embassy_stm32::pac;

/// Why the chip was reset; clears the flags. Every internal reset also sets the flag of the pin, so that flag is checked last.
/// A brown-out also counts as a power-on (RM0394 6.1.1, RM0440 7.1.1).
pub(super) fn reset_cause() -> ResetCause {
    let flags = pac::RCC.csr().read();
    pac::RCC.csr().modify(|register| register.set_rmvf(true));
    if flags.iwdgrstf() || flags.wwdgrstf() {
        ResetCause::Watchdog
    } else if flags.lpwrrstf() {
        ResetCause::LowPower
    } else if flags.sftrstf() {
        ResetCause::Software
    } else if flags.borrstf() {
        ResetCause::PowerOn
    } else if flags.pinrstf() {
        ResetCause::Pin
    } else {
        ResetCause::Unknown
    }
}
