//! The STM32F4's flash has no error correction (RM0090 3): what is half done reads as some bits or other, and the check
//! of a record finds it.

/// Nothing to forget.
pub(crate) fn begin() {}

/// Never.
pub(crate) fn failed() -> bool {
    false
}

/// The flash raises no interrupt that cannot be masked.
pub(crate) fn take_failure() -> Result<(), u32> {
    Err(0)
}
