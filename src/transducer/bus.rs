//! The interface of a driver to its bus, and the meaning of an error on it.

use crate::status::Fault;
#[cfg(tips)]
use crate::transducer::multiplexer::{BusBranch, PortError};
#[cfg(tips)]
use embedded_hal_async::i2c::Operation;
use embedded_hal_async::i2c::{Error, ErrorKind, I2c};

/// Longest time of one operation on the bus, microseconds. 20 bytes at 100 kHz take 1.9 ms. A longer operation means that
/// something holds the bus, and the board's bus aborts it with an error.
pub const OPERATION_LIMIT: u32 = 5_000;

/// An I2C bus that can be freed. Every operation on it ends within [`OPERATION_LIMIT`].
#[allow(async_fn_in_trait)] // one task awaits it, on one thread: no bound is missing
pub trait Bus: I2c {
    /// Frees the bus: clocks a part that holds the data line until the part releases it, sends a stop, and resets the chip's peripheral.
    async fn clear(&mut self);

    /// A transaction with a part on a branch of a multiplexer. The branch is open only during the transaction. A bus that is
    /// set up for each transaction may be set up once for all steps of this one.
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

/// The fault of a sample after a failure of the bus.
#[allow(clippy::needless_pass_by_value)] // as `map_err` hands it over
pub(super) fn fault(error: impl Error) -> Fault {
    match error.kind() {
        ErrorKind::NoAcknowledge(_) => Fault::SensorAbsent,
        _ => Fault::BusFault,
    }
}
