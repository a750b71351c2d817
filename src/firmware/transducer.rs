//! The transducer of the design, on the board's port. The image contains only its driver.

#[cfg(not(transducer = "ratiometric"))]
use embassy_time::Delay;
use embassy_time::{Duration, Instant, Timer};
use fingertip::board::Port;
use fingertip::image::ImageDesign;
use fingertip::transducer::driver::Driver;
use model_tables::constants;

const DESIGNED: constants::Transducer = ImageDesign::CONSTANTS.transducer;

/// The ticks of the converter set its rate.
#[cfg(transducer = "ratiometric")]
pub(crate) fn transducer(port: Port) -> impl Driver {
    fingertip::transducer::ratiometric::Ratiometric::new(&DESIGNED, port)
}

#[cfg(transducer = "abp2")]
pub(crate) fn transducer(port: Port) -> impl Driver {
    fingertip::transducer::abp2::Abp2::new(&DESIGNED, port, Delay)
}

#[cfg(transducer = "ms5837")]
pub(crate) fn transducer(port: Port) -> impl Driver {
    let constants::TransducerKind::Ms5837 { address } = DESIGNED.kind else {
        unreachable!("the build script says so")
    };
    fingertip::transducer::ms5837::Ms5837::new(address, port, Delay)
}

#[cfg(transducer = "dps310")]
pub(crate) fn transducer(port: Port) -> impl Driver {
    let constants::TransducerKind::Dps310 { address } = DESIGNED.kind else {
        unreachable!("the build script says so")
    };
    fingertip::transducer::dps310::Dps310::new(address, port, Delay)
}

/// Waits until the next sample is due. A part on a bus measures on command; a converter runs by itself.
pub(crate) struct SampleTimer {
    /// Time of the next sample; `None` if the ticks of a converter set the rate.
    due: Option<Instant>,
}

impl SampleTimer {
    /// A timer for the transducer, or for a board that does not measure.
    pub(crate) fn new(measures: bool) -> Self {
        let ticks = measures && cfg!(transducer = "ratiometric");
        Self {
            due: (!ticks).then(Instant::now),
        }
    }

    /// Waits until the next sample is due; lost time is not made up.
    pub(crate) async fn wait(&mut self) {
        let Some(due) = self.due else {
            return;
        };
        let period = Duration::from_micros(u64::from(ImageDesign::PARAMETERS.period));
        Timer::at(due).await;
        self.due = Some((due + period).max(Instant::now()));
    }
}
