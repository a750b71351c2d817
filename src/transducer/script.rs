//! For the tests: a bus that plays a list of transactions, fails where it is told to, and a clock that only waiting
//! moves.

use crate::status::Fault;
use crate::transducer::bus::Bus;
use crate::transducer::driver::{Driver, Sample};
use core::convert::Infallible;
use core::future::Future;
use core::pin::pin;
use core::task::{Context, Poll, Waker};
use embassy_futures::block_on;
use embedded_hal_async::delay::DelayNs;
use embedded_hal_async::i2c::{Error, ErrorKind, ErrorType, I2c, NoAcknowledgeSource, Operation};
use std::cell::{Cell, RefCell};
use std::rc::Rc;

/// A clock that only waiting moves.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stopwatch(Rc<Cell<u64>>);

impl Stopwatch {
    /// Waited so far, rounded up.
    pub(crate) fn microseconds(&self) -> u64 {
        self.0.get().div_ceil(1000)
    }
}

impl DelayNs for Stopwatch {
    async fn delay_ns(&mut self, ns: u32) {
        self.0.set(self.0.get() + u64::from(ns));
    }
}

/// One transaction: bytes written, then, after a repeated start, bytes read.
pub(crate) type Step = (&'static [u8], Vec<u8>);

/// Bytes that are written, and nothing read.
pub(crate) fn write(bytes: &'static [u8]) -> Step {
    (bytes, vec![])
}

/// Bytes that are read, after others were written or none.
pub(crate) fn read(written: &'static [u8], bytes: impl Into<Vec<u8>>) -> Step {
    (written, bytes.into())
}

/// What happens in place of a transaction.
#[derive(Clone, Copy, Debug)]
pub(crate) enum BusFailure {
    /// The bus says so.
    Error(ErrorKind),
    /// It never ends: whoever waits gives up.
    Hangs,
}

/// What a bus can say, and the fault it is.
pub(crate) const FAILURES: [(BusFailure, Option<Fault>); 6] = [
    (
        BusFailure::Error(ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address)),
        Some(Fault::SensorAbsent),
    ),
    (
        BusFailure::Error(ErrorKind::NoAcknowledge(NoAcknowledgeSource::Unknown)),
        Some(Fault::SensorAbsent),
    ),
    (BusFailure::Error(ErrorKind::Bus), Some(Fault::BusFault)),
    (
        BusFailure::Error(ErrorKind::ArbitrationLoss),
        Some(Fault::BusFault),
    ),
    (BusFailure::Error(ErrorKind::Other), Some(Fault::BusFault)),
    (BusFailure::Hangs, None),
];

/// A bus with one part on it that says what the script says.
#[derive(Clone, Debug)]
pub(crate) struct Script(Rc<RefCell<Play>>);

#[derive(Debug)]
struct Play {
    address: u8,
    steps: Vec<Step>,
    at: usize,
    failure: Option<(usize, BusFailure)>,
}

/// The error of a [`Script`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct ScriptedError(ErrorKind);

impl Error for ScriptedError {
    fn kind(&self) -> ErrorKind {
        self.0
    }
}

impl Script {
    /// The part at `address`, going through `steps`.
    pub(crate) fn new(address: u8, steps: &[Step]) -> Self {
        Self(Rc::new(RefCell::new(Play {
            address,
            steps: steps.to_vec(),
            at: 0,
            failure: None,
        })))
    }

    /// The step of this number fails, and the script goes on from the front.
    fn failing(self, number: usize, failure: BusFailure) -> Self {
        self.0.borrow_mut().failure = Some((number, failure));
        self
    }

    /// Whether every step was played.
    pub(crate) fn is_over(&self) -> bool {
        let play = self.0.borrow();
        play.at == play.steps.len()
    }
}

impl ErrorType for Script {
    type Error = ScriptedError;
}

impl I2c for Script {
    async fn transaction(
        &mut self,
        address: u8,
        operations: &mut [Operation<'_>],
    ) -> Result<(), ScriptedError> {
        let failure = {
            let mut play = self.0.borrow_mut();
            let at = play.at;
            play.failure.take_if(|(number, _)| *number == at)
        };
        match failure {
            Some((_, BusFailure::Error(kind))) => {
                self.0.borrow_mut().at = 0;
                return Err(ScriptedError(kind));
            }
            Some((_, BusFailure::Hangs)) => {
                self.0.borrow_mut().at = 0;
                core::future::pending::<Infallible>().await;
            }
            None => {}
        }
        let mut play = self.0.borrow_mut();
        assert_eq!(address, play.address);
        let (written, answer) = play.steps.get(play.at).expect("the script goes on").clone();
        play.at += 1;
        let (written_bytes, heard) = match operations {
            [Operation::Write(written_bytes)] => (*written_bytes, None),
            [Operation::Read(heard)] => (&[][..], Some(heard)),
            [Operation::Write(written_bytes), Operation::Read(heard)] => (*written_bytes, Some(heard)),
            _ => panic!("no transaction of these parts"),
        };
        assert_eq!(written_bytes, written, "transaction {}", play.at);
        assert_eq!(heard.as_ref().map_or(0, |heard| heard.len()), answer.len());
        if let Some(heard) = heard {
            heard.copy_from_slice(&answer);
        }
        Ok(())
    }
}

impl Bus for Script {
    async fn clear(&mut self) {}
}

/// Starts a part and takes one sample, all of the script.
pub(crate) fn play<T: Driver>(
    address: u8,
    steps: &[Step],
    make: impl FnOnce(Script, Stopwatch) -> T,
) -> (Result<Sample, Fault>, u64) {
    let (script, stopwatch) = (Script::new(address, steps), Stopwatch::default());
    let mut part = make(script.clone(), stopwatch.clone());
    let outcome = block_on(started_and_sampled(&mut part));
    if outcome.is_ok() {
        assert!(script.is_over(), "there is more in the script");
    }
    (outcome, stopwatch.microseconds())
}

async fn started_and_sampled(part: &mut impl Driver) -> Result<Sample, Fault> {
    part.start().await?;
    part.sample().await
}

/// Lets every transaction fail in every way, once: the fault is reported, nothing else, and the next start and sample are
/// as if nothing had been. Returns how many failures there were.
pub(crate) fn fail_everywhere<T: Driver>(
    address: u8,
    steps: &[Step],
    make: impl Fn(Script, Stopwatch) -> T,
) -> usize {
    let sound = play(address, steps, &make).0.expect("the script has no fault");
    for number in 0..steps.len() {
        for (failure, expected) in FAILURES {
            let script = Script::new(address, steps).failing(number, failure);
            let mut part = make(script, Stopwatch::default());
            let mut context = Context::from_waker(Waker::noop());
            let outcome = pin!(started_and_sampled(&mut part)).poll(&mut context);
            match (outcome, expected) {
                (Poll::Ready(Err(fault)), Some(expected)) => assert_eq!(fault, expected, "step {number}"),
                // The caller has given up on it, and dropped it half way.
                (Poll::Pending, None) => {}
                (outcome, _) => panic!("step {number}: {outcome:?} for {failure:?}"),
            }
            assert_eq!(
                block_on(started_and_sampled(&mut part)),
                Ok(sound),
                "step {number}"
            );
        }
    }
    steps.len() * FAILURES.len()
}
