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
    /// From this pressure up to the end of the transducer's range; below zero: beyond it, a lower bound.
    pub headroom: Millipascals,
    /// The part's own temperature; `None` where it measures none.
    pub temperature: Option<Centidegrees>,
    /// The word the part gave, if it is so fine that noise moves it: unchanged for long it is stuck; `None` of a
    /// 12-bit converter that averages.
    pub raw: Option<u32>,
    /// From the middle of the time it was measured over to when the driver gave it, microseconds.
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
    /// Resets and identifies the part, reads its calibration and sets it up: to be done before the first sample and
    /// after a fault that does not go away. It may be dropped half way and called again.
    ///
    /// # Errors
    /// The [`Fault`] that keeps it from measuring.
    async fn start(&mut self) -> Result<(), Fault>;

    /// Waits for the next sample. It may be dropped half way and called again.
    ///
    /// # Errors
    /// The [`Fault`] that there is in place of a sample. The next call tries again.
    async fn sample(&mut self) -> Result<Sample, Fault>;

    /// Frees what lies between the part and the chip: a bus that is held, a converter that has stopped.
    async fn free(&mut self);
}

/// How far below the thinnest air a sound absolute part may read, pascals: its own error, and a little more height.
const BELOW_THINNEST_AIR: i32 = 3_000;

/// What an absolute part gives, once it is `recognised` by the first pressure after a start. The air is always in that, and
/// whatever presses adds to it: only a part that is read by another one's formula is below. There is no upper bound, for
/// it may be pressed.
///
/// # Errors
/// [`Fault::WrongSensor`] until a sample holds the air.
pub(super) fn recognise(recognised: &mut bool, sample: Sample) -> Result<Sample, Fault> {
    *recognised |= sample.pressure.0 >= (AIR[0] - BELOW_THINNEST_AIR) * 1000;
    if *recognised {
        Ok(sample)
    } else {
        Err(Fault::WrongSensor)
    }
}
