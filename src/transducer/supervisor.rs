//! Restarts a transducer after faults.
//!
//! | faults in a row | before the next sample |
//! |---|---|
//! | 1 | nothing: only one transaction was disturbed |
//! | 2 | the part is restarted: reset, identity, calibration, settings |
//! | 3 and more | a pause, the bus is cleared, the part is restarted |
//!
//! Every fault is reported at once. A pause is at most [`LONGEST_PAUSE`]. A part that works again therefore gives a sample after at
//! most this pause, its start and one conversion.

use crate::status::Fault;
use crate::transducer::driver::{Driver, Sample};
use embedded_hal_async::delay::DelayNs;

/// First pause, microseconds. Each further pause is twice as long, up to [`LONGEST_PAUSE`].
const PAUSE: u32 = 1_000;
/// Longest pause, microseconds.
pub const LONGEST_PAUSE: u32 = 8_000;

/// A transducer that is started, freed and restarted as needed.
#[derive(Debug)]
pub struct TransducerSupervisor<T, D> {
    transducer: T,
    delay: D,
    started: bool,
    /// Faults in a row.
    faults: u32,
}

impl<T: Driver, D: DelayNs> TransducerSupervisor<T, D> {
    /// A supervisor of a part that is not started yet.
    pub const fn new(transducer: T, delay: D) -> Self {
        Self {
            transducer,
            delay,
            started: false,
            faults: 0,
        }
    }

    /// The transducer.
    #[cfg(test)]
    pub(super) const fn transducer(&self) -> &T {
        &self.transducer
    }

    /// The next sample, or the reason why there is none.
    ///
    /// # Errors
    /// The transducer's [`Fault`].
    pub async fn next(&mut self) -> Result<Sample, Fault> {
        let outcome = self.attempt().await;
        match outcome {
            // These faults need no restart. A line at its rail is a measured state and not a failed measurement, and lost samples are past.
            Ok(_)
            | Err(Fault::SensorOpen | Fault::SensorShort | Fault::SensorSupply | Fault::SamplesLost) => {
                self.faults = 0;
            }
            Err(_) => {
                self.faults = self.faults.saturating_add(1);
                self.started &= self.faults < 2;
            }
        }
        outcome
    }

    async fn attempt(&mut self) -> Result<Sample, Fault> {
        if !self.started {
            if self.faults > 2 {
                let pause = PAUSE << (self.faults - 3).min(3);
                self.delay.delay_us(pause.min(LONGEST_PAUSE)).await;
                self.transducer.free().await;
            }
            self.transducer.start().await?;
            self.started = true;
        }
        self.transducer.sample().await
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transducer::script::Stopwatch;
    use crate::units::Millipascals;
    use embassy_futures::block_on;
    use std::cell::RefCell;
    use std::rc::Rc;

    /// A part that takes 40 ms to start and 12 ms for a sample, and does not answer in between two times.
    struct Fickle {
        stopwatch: Stopwatch,
        absent: core::ops::Range<u64>,
        did: Deeds,
    }

    impl Fickle {
        fn answer(&self) -> Result<(), Fault> {
            let absent = self.absent.contains(&self.stopwatch.microseconds());
            if absent { Err(Fault::SensorAbsent) } else { Ok(()) }
        }
    }

    impl Driver for Fickle {
        async fn start(&mut self) -> Result<(), Fault> {
            self.did.borrow_mut().push("start");
            self.stopwatch.delay_us(100).await;
            self.answer()?;
            self.stopwatch.delay_us(40_000).await;
            self.answer()
        }

        async fn sample(&mut self) -> Result<Sample, Fault> {
            self.did.borrow_mut().push("sample");
            self.stopwatch.delay_us(12_000).await;
            self.answer()?;
            Ok(Sample {
                pressure: Millipascals(7),
                ..Sample::default()
            })
        }

        async fn free(&mut self) {
            self.did.borrow_mut().push("free");
        }
    }

    /// What was done to a part, in order.
    type Deeds = Rc<RefCell<Vec<&'static str>>>;

    fn kept(absent: core::ops::Range<u64>) -> (TransducerSupervisor<Fickle, Stopwatch>, Stopwatch, Deeds) {
        let (stopwatch, did) = (Stopwatch::default(), Rc::default());
        let part = Fickle {
            stopwatch: stopwatch.clone(),
            absent,
            did: Rc::clone(&did),
        };
        (TransducerSupervisor::new(part, stopwatch.clone()), stopwatch, did)
    }

    #[test]
    fn it_starts_once_and_then_samples() {
        let (mut supervisor, _, did) = kept(0..0);
        for _ in 0..3 {
            assert!(block_on(supervisor.next()).is_ok());
        }
        assert_eq!(*did.borrow(), ["start", "sample", "sample", "sample"]);
    }

    #[test]
    fn one_fault_is_asked_again_two_start_anew_three_free_the_bus() {
        let (mut supervisor, _, did) = kept(60_000..200_000);
        let _ = block_on(supervisor.next());
        did.borrow_mut().clear();
        for _ in 0..3 {
            assert_eq!(block_on(supervisor.next()), Err(Fault::SensorAbsent));
        }
        assert_eq!(*did.borrow(), ["sample", "sample", "start"]);
        did.borrow_mut().clear();
        assert_eq!(block_on(supervisor.next()), Err(Fault::SensorAbsent));
        assert_eq!(*did.borrow(), ["free", "start"]);
    }

    #[test]
    fn a_part_that_appears_late_or_again_is_read_within_a_tenth_of_a_second() {
        for back in [1_000, 50_000, 123_456, 1_000_000, 10_000_000] {
            for gone in [0, 100_000] {
                let (mut supervisor, stopwatch, _) = kept(gone..gone + back);
                let mut faults = 0;
                loop {
                    let before = stopwatch.microseconds();
                    let outcome = block_on(supervisor.next());
                    let now = stopwatch.microseconds();
                    // Nothing is kept back for longer than a start, a sample and a pause.
                    assert!(now - before <= 61_000);
                    if now < gone + back {
                        continue;
                    }
                    match outcome {
                        Ok(_) => break assert!(now - (gone + back) < 100_000, "{now}"),
                        Err(fault) => {
                            assert_eq!(fault, Fault::SensorAbsent);
                            faults += 1;
                        }
                    }
                }
                assert!(faults <= 1, "{faults} faults after it was back");
            }
        }
    }
}
