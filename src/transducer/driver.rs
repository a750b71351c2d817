//! The result of every pressure transducer: a [`Sample`], or the reason why there is none.
//!
//! A driver knows its part and its bus, but no clock and no policy. The bus limits the time of an operation, and the caller does
//! retries and back-off. A sample states its age in place of its time.

use crate::status::{Fault, Warnings};
use crate::units::{Centidegrees, Millipascals};
use model_tables::constants::AIR;

/// One reading of a transducer.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Sample {
    /// The pressure, compensated for temperature as far as the part can.
    pub pressure: Millipascals,
    /// Distance from this pressure to the end of the transducer's range. Below zero, the pressure is beyond the range and is a lower bound.
    pub headroom: Millipascals,
    /// The part's own temperature; `None` where it measures none.
    pub temperature: Option<Centidegrees>,
    /// The word from the part, if it is so fine that noise changes it. A word that stays unchanged for long is stuck. `None`
    /// for an averaging 12-bit converter.
    pub raw: Option<u32>,
    /// Time from the middle of the measurement to the return of the driver, microseconds.
    pub age: u32,
}

impl Sample {
    /// Warnings of every reading from this sample.
    pub const fn warnings(&self) -> Warnings {
        Warnings::SATURATED.when(self.headroom.0 < 0)
    }
}

/// The driver of a pressure transducer.
#[allow(async_fn_in_trait)] // one task awaits it, on one thread: no bound is missing
pub trait Driver {
    /// Resets and identifies the part, reads its calibration and sets it up: Called before the first sample, and after a fault
    /// that persists. The future may be dropped before it ends, and the function called again.
    ///
    /// # Errors
    /// The [`Fault`] that keeps it from measuring.
    async fn start(&mut self) -> Result<(), Fault>;

    /// Waits for the next sample. The future may be dropped before it ends, and the function called again.
    ///
    /// # Errors
    /// The [`Fault`] in place of a sample. The next call tries again.
    async fn sample(&mut self) -> Result<Sample, Fault>;

    /// Frees the connection between part and chip: a bus that is held, or a converter that has stopped.
    async fn free(&mut self);
}

/// A working absolute part may read this far below the thinnest air, pascals: its own error, and a little more height.
const BELOW_THINNEST_AIR: i32 = 3_000;

/// Passes on the sample of an absolute part, once the part is `recognised` by its first pressure after a start. That pressure
/// includes the air pressure, and a press only adds to it. Only a part that is read with the formula of another part gives
/// less. There is no upper bound, because the fingertip may be pressed.
///
/// # Errors
/// [`Fault::WrongSensor`] until a sample includes the air pressure.
pub(super) fn recognise(recognised: &mut bool, sample: Sample) -> Result<Sample, Fault> {
    *recognised |= sample.pressure.0 >= (AIR[0] - BELOW_THINNEST_AIR) * 1000;
    if *recognised {
        Ok(sample)
    } else {
        Err(Fault::WrongSensor)
    }
}
