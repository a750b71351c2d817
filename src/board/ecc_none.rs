//! The STM32F4's flash has no error correction (RM0090 3). An interrupted write reads as arbitrary bits, and the check of a record
//! detects it.

/// There is nothing to clear.
pub fn begin() {}

/// Always `false`: there is no error correction.
pub fn failed() -> bool {
    false
}

/// The flash raises no interrupt that cannot be masked.
///
/// # Errors
/// Always 0: the cause is never the flash.
pub fn take_failure() -> Result<(), u32> {
    Err(0)
}
