//! The interface of a driver to its bus, and the meaning of an error on it.

use crate::status::Fault;
#[cfg(tips)]
use crate::transducer::multiplexer::{BusBranch, PortError};
#[cfg(tips)]
use embedded_hal_async::i2c::Operation;
use embedded_hal_async::i2c::{Error, ErrorKind, I2c};

/// Longest that one operation on the bus takes, microseconds: 20 bytes at 100 kHz take 1.9 ms. What takes longer is
/// held by something, and the board's bus breaks it off with an error.
pub const OPERATION_LIMIT: u32 = 5_000;

/// An I2C bus whose every operation ends within [`OPERATION_LIMIT`], and that can be freed.
#[allow(async_fn_in_trait)] // one task awaits it, on one thread: no bound is missing
pub trait Bus: I2c {
    /// Clocks a part that holds the data line until it lets go, sends a stop and resets the chip's end.
    async fn clear(&mut self);

    /// A transaction with a part on a branch of a multiplexer, which is open for it alone. A bus that is set up for each transaction may
    /// be so once for all of these.
    ///
    /// # Errors
    /// [`PortError`] of the multiplexer or the part.
    #[cfg(tips)]
    async fn through(
        &mut self,
        branch: BusBranch,
        address: u8,
        operations: &mut [Operation<'_>],
    ) -> Result<(), PortError>
    where
        Self: Sized,
    {
        branch.transaction(self, address, operations).await
    }
}

/// Why there is no sample, from the failure of the bus.
#[allow(clippy::needless_pass_by_value)] // as `map_err` hands it over
pub(super) fn fault(error: impl Error) -> Fault {
    match error.kind() {
        ErrorKind::NoAcknowledge(_) => Fault::SensorAbsent,
        _ => Fault::BusFault,
    }
}
