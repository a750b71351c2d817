use super::*;
use crate::transducer::abp2::Abp2;
use crate::transducer::bus::Bus;
use crate::transducer::multiplexer::BusBranch;
use crate::transducer::shared_bus::{BusPort, SharedBus};
use core::future::Future;
use core::pin::Pin;
use core::task::{Context, Poll, Waker};
use embedded_hal_async::delay::DelayNs;
use embedded_hal_async::i2c::{Error, ErrorKind, ErrorType, I2c, NoAcknowledgeSource, Operation};
use model_tables::constants::hand_bus::{FAILURE, OPERATION_LIMIT};
use model_tables::constants::{Quantity, Transducer, TransducerKind};
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::future::poll_fn;

/// Time that passes when everybody waits.
#[derive(Default)]
struct World {
    now: Cell<u64>,
    alarms: RefCell<BTreeSet<u64>>,
    parts: RefCell<Vec<Part>>,
    /// The register of each multiplexer from 0x70 on.
    registers: RefCell<[u8; 8]>,
    /// Multiplexers that are not there, by number.
    missing: Cell<Option<u8>>,
    /// Multiplexers that open another branch than they were told.
    confused: Cell<Option<u8>>,
    /// The data line is held, whatever is done.
    shorted: Cell<bool>,
    /// When a transaction of a part began, and its address and branch.
    transactions: RefCell<Vec<(u64, u8, Option<BusBranch>)>>,
    clears: Cell<u32>,
    random: Cell<u64>,
}

/// What a part does.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Does {
    Measure,
    /// It does not answer.
    Nothing,
    /// It answers with bytes of chance.
    Chatter,
    /// It holds the clock: a transaction with it never ends.
    HoldClock,
    /// It holds the data line of its branch for ever.
    HoldData,
}

#[derive(Clone, Copy, Debug)]
struct Part {
    address: u8,
    branch: Option<BusBranch>,
    does: Does,
    converted: u64,
}

#[derive(Clone, Copy)]
struct Alarm(&'static World);

impl RoundTimer for Alarm {
    fn now(&self) -> u64 {
        self.0.now.get()
    }

    async fn until(&self, time: u64) {
        poll_fn(|_| {
            if self.0.now.get() >= time {
                Poll::Ready(())
            } else {
                self.0.alarms.borrow_mut().insert(time);
                Poll::Pending
            }
        })
        .await;
    }
}

impl DelayNs for Alarm {
    async fn delay_ns(&mut self, ns: u32) {
        self.until(self.now() + u64::from(ns.div_ceil(1000))).await;
    }
}

/// Drives all of them until this time.
fn run(world: &'static World, tasks: &mut [Pin<Box<dyn Future<Output = ()>>>], until: u64) {
    let mut context = Context::from_waker(Waker::noop());
    while world.now.get() < until {
        // Turns on the bus are handed on in one instant: as often as there are tasks.
        for _ in 0..tasks.len() {
            for task in tasks.iter_mut() {
                assert!(task.as_mut().poll(&mut context).is_pending());
            }
        }
        let next = world.alarms.borrow_mut().pop_first().expect("somebody waits");
        world.now.set(next.max(world.now.get()));
    }
}

/// The pressure at a time, pascals: one more every 20 us.
fn pressure(time: u64) -> f64 {
    (time / 20 % 80_000) as f64
}

const RANGE: [i32; 2] = [0, 100_000];
const COUNTS: [u32; 2] = [1_677_722, 15_099_494];

fn answer(converted: u64) -> [u8; 7] {
    let share = pressure(converted) / f64::from(RANGE[1]);
    let counts = f64::from(COUNTS[0]) + share * f64::from(COUNTS[1] - COUNTS[0]);
    let [_, a, b, c] = (counts as u32).to_be_bytes();
    [0x40, a, b, c, 0x60, 0, 0]
}

#[derive(Clone, Copy)]
struct Wire(&'static World);

#[derive(Debug)]
struct WireError(ErrorKind);

impl Error for WireError {
    fn kind(&self) -> ErrorKind {
        self.0
    }
}

impl ErrorType for Wire {
    type Error = WireError;
}

const NOBODY: WireError = WireError(ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address));

impl Wire {
    fn is_reached(self, part: &Part) -> bool {
        let registers = self.0.registers.borrow();
        part.branch
            .is_none_or(|branch| registers[usize::from(branch.multiplexer - 0x70)] & 1 << branch.number != 0)
    }

    fn is_held(self) -> bool {
        let parts = self.0.parts.borrow();
        let holds = |part: &Part| part.does == Does::HoldData && self.is_reached(part);
        self.0.shorted.get() || parts.iter().any(holds)
    }

    async fn takes(self, microseconds: u64) {
        let alarm = Alarm(self.0);
        alarm.until(alarm.now() + microseconds).await;
    }

    fn multiplexer(self, address: u8, operation: &mut Operation<'_>) -> Result<(), WireError> {
        if self.0.missing.get() == Some(address) {
            return Err(NOBODY);
        }
        let register = &mut self.0.registers.borrow_mut()[usize::from(address - 0x70)];
        match operation {
            Operation::Write(bytes) => {
                let confused = self.0.confused.get() == Some(address) && bytes[0] != 0;
                *register = if confused { bytes[0] << 1 } else { bytes[0] };
            }
            Operation::Read(bytes) => bytes[0] = *register,
        }
        Ok(())
    }
}

impl I2c for Wire {
    async fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), WireError> {
        let began = self.0.now.get();
        if self.is_held() {
            return Err(WireError(ErrorKind::Bus));
        }
        let bytes: usize = operations
            .iter()
            .map(|operation| match operation {
                Operation::Write(bytes) => 1 + bytes.len(),
                Operation::Read(bytes) => 1 + bytes.len(),
            })
            .sum();
        let time = 20 + (9 * bytes as u64 + 2) * 5 / 2;
        if (0x70..0x78).contains(&address) {
            self.takes(time).await;
            return self.multiplexer(address, &mut operations[0]);
        }
        let reached: Vec<usize> = {
            let parts = self.0.parts.borrow();
            let reached = parts.iter().enumerate();
            reached
                .filter(|(_, part)| {
                    part.address == address && part.does != Does::Nothing && self.is_reached(part)
                })
                .map(|(number, _)| number)
                .collect()
        };
        let [number] = reached[..] else {
            assert!(reached.is_empty(), "two parts answer at {address:#04x}");
            self.takes(45).await;
            return Err(NOBODY);
        };
        let part = self.0.parts.borrow()[number];
        self.0
            .transactions
            .borrow_mut()
            .push((began, address, part.branch));
        if part.does == Does::HoldClock {
            self.takes(u64::from(OPERATION_LIMIT)).await;
            return Err(WireError(ErrorKind::Other));
        }
        self.takes(time).await;
        for operation in operations {
            match operation {
                Operation::Write(_) => {
                    self.0.parts.borrow_mut()[number].converted = self.0.now.get() + 2_500;
                }
                Operation::Read(bytes) if part.does == Does::Chatter => {
                    for byte in bytes.iter_mut() {
                        let next = self
                            .0
                            .random
                            .get()
                            .wrapping_mul(6_364_136_223_846_793_005)
                            .wrapping_add(1);
                        self.0.random.set(next);
                        *byte = (next >> 56) as u8;
                    }
                }
                Operation::Read(bytes) => bytes.copy_from_slice(&answer(part.converted)),
            }
        }
        Ok(())
    }
}

impl Bus for Wire {
    async fn clear(&mut self) {
        self.0.clears.set(self.0.clears.get() + 1);
        self.takes(200).await;
        *self.0.registers.borrow_mut() = [0; 8];
    }
}

const TIMES: RoundTimes<3> = RoundTimes {
    period: 9_000,
    instant: 2_950,
    skew: 600 + FAILURE,
    begins: [0; 3],
    halves: [2_500; 3],
};

const fn branch(multiplexer: u8, number: u8) -> BusBranch {
    BusBranch { multiplexer, number }
}

/// Two parts of one address on two branches, and one of another on the bus itself.
const PLACES: [(u8, Option<BusBranch>); 3] = [
    (0x28, Some(branch(0x70, 0))),
    (0x28, Some(branch(0x71, 7))),
    (0x18, None),
];

/// The samples of a round, and when they were read.
type Round = (u64, [Result<Sample, Fault>; 3]);

/// What three parts and their reader do, and what the test does to them.
struct Hand {
    world: &'static World,
    tasks: Vec<Pin<Box<dyn Future<Output = ()>>>>,
    read: &'static RefCell<Vec<Round>>,
}

impl Hand {
    fn new() -> Self {
        let world: &'static World = Box::leak(Box::default());
        let rounds: &'static Rounds<3> = Box::leak(Box::new(Rounds::new(TIMES, 0)));
        let shared: &'static SharedBus<Wire, 3> = Box::leak(Box::new(SharedBus::new(Wire(world))));
        let read: &'static RefCell<Vec<Round>> = Box::leak(Box::default());
        let alarm = Alarm(world);
        let mut tasks: Vec<Pin<Box<dyn Future<Output = ()>>>> = vec![];
        for (tip, (address, branch)) in PLACES.into_iter().enumerate() {
            world.parts.borrow_mut().push(Part {
                address,
                branch,
                does: Does::Measure,
                converted: 0,
            });
            let port = BusPort::new(shared, branch, alarm, rounds.commanded(tip));
            let part = Abp2::new(&transducer(address), port, alarm);
            tasks.push(Box::pin(async move {
                keep(rounds, tip, part, alarm).await;
            }));
        }
        tasks.push(Box::pin(async move {
            let mut reader = RoundReader::new(rounds, alarm);
            loop {
                let samples = *reader.next().await;
                read.borrow_mut().push((world.now.get(), samples));
            }
        }));
        Self { world, tasks, read }
    }

    fn does(&self, tip: usize, does: Does) {
        self.world.parts.borrow_mut()[tip].does = does;
    }

    /// So many rounds more: what was read in them.
    fn rounds(&mut self, rounds: u64) -> Vec<Round> {
        let until = self.world.now.get() + rounds * u64::from(TIMES.period);
        self.read.borrow_mut().clear();
        run(self.world, &mut self.tasks, until);
        self.read.borrow().clone()
    }

    /// A hand whose parts are all started.
    fn going() -> Self {
        let mut hand = Self::new();
        // One start in a round, and one round more.
        hand.rounds(6);
        hand
    }
}

fn transducer(address: u8) -> Transducer {
    Transducer {
        range: RANGE,
        resolution: 1_000,
        noise: 1_000,
        quantity: Quantity::Gauge,
        kind: TransducerKind::Abp2 {
            address: 0x28,
            counts: COUNTS,
        },
    }
    .at(address)
}

/// How far a sample is from the truth at the instant it says, microseconds.
fn off((now, sample): (u64, Sample)) -> f64 {
    let truth = pressure(now - u64::from(sample.age));
    (f64::from(sample.pressure.0) / 1e3 - truth).abs() * 20.0
}

/// Each tip but `but` has a sample in every round, all of one age; the most that one is off, microseconds.
fn sound(rounds: &[Round], but: &[usize]) -> f64 {
    let mut most = 0.0_f64;
    assert!(!rounds.is_empty());
    for (before, after) in rounds.iter().zip(&rounds[1..]) {
        assert_eq!(after.0 - before.0, u64::from(TIMES.period));
    }
    for (now, samples) in rounds {
        for tip in (0..3).filter(|tip| !but.contains(tip)) {
            let sample = samples[tip].unwrap_or_else(|fault| panic!("tip {tip} at {now}: {fault}"));
            assert_eq!(sample.age, TIMES.period - TIMES.instant);
            most = most.max(off((*now, sample)));
        }
    }
    most
}

/// Half of what three commands take one after the other, and the rounding of pascals: far less than a part that fails.
const TOGETHER: f64 = 650.0;

#[test]
fn parts_of_one_address_are_read_apart_and_of_one_instant() {
    let mut hand = Hand::going();
    let most = sound(&hand.rounds(200), &[]);
    println!("a conversion's middle is at most {most:.0} us from the instant");
    assert!(most < TOGETHER, "{most}");
    assert_eq!(hand.world.clears.get(), 0);
}

#[test]
fn all_parts_are_there_after_a_round_for_the_start_of_each() {
    let mut hand = Hand::new();
    let read = hand.rounds(8);
    let whole = read
        .iter()
        .position(|(_, samples)| samples.iter().all(Result::is_ok));
    assert_eq!(whole, Some(4), "{read:?}");
}

/// Whatever a part does, the others are read in every round, no later than by one failure at first and not at all after that; and it is
/// tried once in sixteen rounds.
#[test]
fn a_part_that_fails_costs_the_others_one_failure_and_a_share_after_that() {
    for (does, reasons) in [
        (Does::Nothing, vec![Fault::SensorAbsent]),
        (Does::HoldClock, vec![Fault::BusFault]),
        (Does::HoldData, vec![Fault::BusFault]),
    ] {
        for tip in 0..3 {
            if (tip, does) == (2, Does::HoldData) {
                // On the bus itself that is everybody's fault.
                continue;
            }
            let mut hand = Hand::going();
            hand.does(tip, does);
            let first = sound(&hand.rounds(40), &[tip]);
            assert!(
                first < TOGETHER + f64::from(FAILURE),
                "{does:?}, tip {tip}: {first} us"
            );
            let clears = hand.world.clears.get();
            let read = hand.rounds(320);
            let later = sound(&read, &[tip]);
            println!(
                "{does:?} at tip {tip}: the others are at most {first:.0} us off, and {later:.0} us after 40 rounds"
            );
            assert!(later < TOGETHER, "{does:?}, tip {tip}: {later} us");
            for (_, samples) in &read {
                assert!(
                    reasons.contains(&samples[tip].expect_err("it has no reading")),
                    "{does:?}"
                );
            }
            // 20 tries in 320 rounds, and each frees the bus once if at all.
            assert!(hand.world.clears.get() - clears <= 20, "{does:?}");
        }
    }
}

#[test]
fn a_part_that_chatters_harms_nobody_else() {
    let mut hand = Hand::going();
    hand.does(1, Does::Chatter);
    let read = hand.rounds(400);
    assert!(sound(&read, &[1]) < TOGETHER);
    // A status of chance is one of this part's once in sixteen.
    let believed = read.iter().filter(|(_, samples)| samples[1].is_ok()).count();
    assert!(believed < 60, "{believed}");
}

#[test]
fn a_part_that_comes_back_is_read_after_sixteen_rounds_at_the_most() {
    for does in [Does::Nothing, Does::HoldClock, Does::HoldData] {
        for gone in [3, 50, 51, 60, 66] {
            let mut hand = Hand::going();
            hand.does(0, does);
            hand.rounds(gone);
            hand.does(0, Does::Measure);
            let back = hand
                .rounds(40)
                .iter()
                .position(|(_, samples)| samples[0].is_ok())
                .expect("it comes back");
            // Its pause, its start, and a round.
            assert!(
                back <= LONGEST_PAUSE as usize + 2,
                "{does:?} for {gone} rounds: {back}"
            );
        }
    }
}

#[test]
fn a_disturbed_transaction_costs_one_sample() {
    let mut hand = Hand::going();
    hand.does(2, Does::Nothing);
    hand.rounds(1);
    hand.does(2, Does::Measure);
    let read = hand.rounds(20);
    let faults = read.iter().filter(|(_, samples)| samples[2].is_err()).count();
    assert!(faults <= 1, "{faults}");
    assert!(sound(&read, &[2]) < TOGETHER);
}

#[test]
fn parts_that_all_fail_are_started_one_a_round() {
    let mut hand = Hand::going();
    for tip in 0..3 {
        hand.does(tip, Does::HoldClock);
    }
    hand.rounds(40);
    hand.world.transactions.borrow_mut().clear();
    hand.rounds(160);
    let transactions = hand.world.transactions.borrow();
    // Three parts, each tried once in sixteen rounds.
    assert!((27..=33).contains(&transactions.len()), "{}", transactions.len());
    for pair in transactions.windows(2) {
        assert!(pair[1].0 - pair[0].0 >= u64::from(TIMES.period) / 2, "{pair:?}");
    }
}

#[test]
fn a_multiplexer_that_is_gone_or_confused_is_a_fault_of_the_bus_of_its_tips_alone() {
    for confused in [false, true] {
        let mut hand = Hand::going();
        let broken = if confused {
            &hand.world.confused
        } else {
            &hand.world.missing
        };
        broken.set(Some(0x71));
        let read = hand.rounds(100);
        assert!(sound(&read, &[1]) < TOGETHER + f64::from(FAILURE));
        let late = &read[3..];
        assert!(late.iter().all(|(_, samples)| samples[1] == Err(Fault::BusFault)));
        hand.world.missing.set(None);
        hand.world.confused.set(None);
        hand.rounds(u64::from(LONGEST_PAUSE) + 3);
        assert!(sound(&hand.rounds(10), &[]) < TOGETHER);
    }
}

/// A line of the bus itself that is held is everybody's fault, and over soon after it.
#[test]
fn a_bus_that_is_held_is_a_fault_of_all_and_all_come_back() {
    let mut hand = Hand::going();
    hand.world.shorted.set(true);
    let read = hand.rounds(100);
    for (_, samples) in &read[2..] {
        assert_eq!(*samples, [Err(Fault::BusFault); 3]);
    }
    let clears = hand.world.clears.get();
    hand.rounds(160);
    // Each of three parts once in sixteen rounds.
    assert!(hand.world.clears.get() - clears <= 33);
    hand.world.shorted.set(false);
    hand.rounds(u64::from(LONGEST_PAUSE) + 4);
    assert!(sound(&hand.rounds(10), &[]) < TOGETHER);
}
