//! The transducer of the design, on the board's port. Only its driver is in the image.

#[cfg(not(transducer = "ratiometric"))]
use embassy_time::Delay;
use embassy_time::{Duration, Instant, Timer};
use fingertip::board::Port;
use fingertip::image::ImageDesign;
use fingertip::transducer::driver::Driver;
use model_tables::constants;

const DESIGNED: constants::Transducer = ImageDesign::CONSTANTS.transducer;

/// The converter's ticks pace it.
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

/// Says when the next sample is due: a part on a bus measures when it is told, a converter by itself.
pub(crate) struct SampleTimer {
    /// Nothing, where a converter's ticks pace it.
    due: Option<Instant>,
}

impl SampleTimer {
    /// The pace of the transducer, or of none.
    pub(crate) fn new(measures: bool) -> Self {
        let ticks = measures && cfg!(transducer = "ratiometric");
        Self {
            due: (!ticks).then(Instant::now),
        }
    }

    /// Waits until the next sample is due; time that was lost is not caught up.
    pub(crate) async fn wait(&mut self) {
        let Some(due) = self.due else {
            return;
        };
        let period = Duration::from_micros(u64::from(ImageDesign::PARAMETERS.period));
        Timer::at(due).await;
        self.due = Some((due + period).max(Instant::now()));
    }
}
