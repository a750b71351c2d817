//! The STM32F4's flash has no error correction (RM0090 3). An interrupted write reads as arbitrary bits, and the check of a record
//! detects it.

/// Nothing to forget.
pub fn begin() {}

/// Never.
pub fn failed() -> bool {
    false
}

/// The flash raises no interrupt that cannot be masked.
///
/// # Errors
/// Always: its cause is none of the flash.
pub fn take_failure() -> Result<(), u32> {
    Err(0)
}
