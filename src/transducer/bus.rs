//! The interface of a driver to its bus, and the meaning of an error on it.

use crate::status::Fault;
use embedded_hal_async::i2c::{Error, ErrorKind, I2c};

/// Longest that one operation on the bus takes, microseconds: 20 bytes at 100 kHz take 1.9 ms. What takes longer is
/// held by something, and the board's bus breaks it off with an error.
pub const OPERATION_LIMIT: u32 = 5_000;

/// An I2C bus whose every operation ends within [`OPERATION_LIMIT`], and that can be freed.
#[allow(async_fn_in_trait)] // one task awaits it, on one thread: no bound is missing
pub trait Bus: I2c {
    /// Clocks a part that holds the data line until it lets go, sends a stop and resets the chip's end.
    async fn clear(&mut self);
}

/// Why there is no sample, from the failure of the bus.
#[allow(clippy::needless_pass_by_value)] // as `map_err` hands it over
pub(super) fn fault(error: impl Error) -> Fault {
    match error.kind() {
        ErrorKind::NoAcknowledge(_) => Fault::SensorAbsent,
        _ => Fault::BusFault,
    }
}
