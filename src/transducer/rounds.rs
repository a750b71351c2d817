//! The parts of a hand on one bus, in rounds: a sample of each part, all at one instant, or the reason why there is none.
//!
//! Each part has its own task, [`keep`]. It waits for its time in the round and then calls the driver. The parts convert at the
//! same time and take turns on the bus. A part that fails is tried less often, while the bus is idle during the conversions of
//! the others. Only one such part is tried in a round:
//!
//! | faults in a row | the next try |
//! |---|---|
//! | 1 | the next round: one disturbed transaction is over |
//! | 2 | the next round: the part is started anew: reset, identity, calibration, settings |
//! | 3 and more | after 2, 4, 8 and then always [`LONGEST_PAUSE`] rounds it is started anew |

use crate::status::Fault;
use crate::transducer::driver::{Driver, Sample};
use core::cell::Cell;

/// Largest number of rounds between two tries of a part that does not answer.
pub const LONGEST_PAUSE: u32 = 16;

/// The time of the rounds, microseconds.
#[allow(async_fn_in_trait)] // one task awaits it, on one thread: no bound is missing
pub trait RoundTimer: Copy {
    /// The present time.
    fn now(&self) -> u64;

    /// Waits until this time. Returns at once if it is past.
    async fn until(&self, time: u64);
}

/// The times of a round, computed for the parts of the hand, microseconds.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct RoundTimes<const N: usize> {
    /// Time from one round to the next.
    pub period: u32,
    /// Time from the start of a round to the instant of its samples.
    pub instant: u32,
    /// Largest distance of the middle of a conversion from that instant.
    pub skew: u32,
    /// Time from the start of a round to the start of each part.
    pub begins: [u32; N],
    /// Half of each part's conversion of the pressure.
    pub halves: [u32; N],
}

/// The last outcome of a part.
#[derive(Clone, Copy, Debug)]
struct Outcome {
    round: u32,
    sample: Result<Sample, Fault>,
    /// The middle of the conversion, microseconds.
    measured: u64,
}

/// Outcome of a part before its first sample.
const NOT_YET: Outcome = Outcome {
    round: 0,
    sample: Err(Fault::SensorBusy),
    measured: 0,
};

/// The rounds of `N` parts: the state shared by their tasks and the reader of their samples.
#[derive(Debug)]
pub struct Rounds<const N: usize> {
    times: RoundTimes<N>,
    first: u64,
    outcomes: [Cell<Outcome>; N],
    commanded: [Cell<u64>; N],
    /// The first round in which a part may be started.
    starts_from: Cell<u32>,
}

impl<const N: usize> Rounds<N> {
    /// Rounds that begin at the time `first`, microseconds.
    pub const fn new(times: RoundTimes<N>, first: u64) -> Self {
        Self {
            times,
            first,
            outcomes: [const { Cell::new(NOT_YET) }; N],
            commanded: [const { Cell::new(0) }; N],
            starts_from: Cell::new(0),
        }
    }

    /// Cell in which the part of a tip stores the time of its last command.
    ///
    /// # Panics
    /// If the tip does not exist.
    pub const fn commanded(&self, tip: usize) -> &Cell<u64> {
        &self.commanded[tip]
    }

    fn begin(&self, round: u32) -> u64 {
        self.first + u64::from(round) * u64::from(self.times.period)
    }

    /// The round at a time.
    fn at(&self, time: u64) -> u32 {
        (time.saturating_sub(self.first) / u64::from(self.times.period)) as u32
    }

    fn instant(&self, round: u32) -> u64 {
        self.begin(round) + u64::from(self.times.instant)
    }

    /// Whether a part may be started in this round. Each round starts at most one part.
    fn may_start(&self, round: u32) -> bool {
        let may = round >= self.starts_from.get();
        if may {
            self.starts_from.set(round + 1);
        }
        may
    }

    fn put(&self, tip: usize, round: u32, sample: Result<Sample, Fault>) {
        let half = u64::from(self.times.halves[tip]);
        self.outcomes[tip].set(Outcome {
            round,
            sample,
            measured: self.commanded[tip].get() + half,
        });
    }

    /// The sample of a tip in a completed round, with its age at `now`.
    fn sample(&self, tip: usize, round: u32, now: u64) -> Result<Sample, Fault> {
        let outcome = self.outcomes[tip].get();
        let sample = outcome.sample?;
        let instant = self.instant(round);
        if outcome.round != round || outcome.measured.abs_diff(instant) > u64::from(self.times.skew) {
            return Err(Fault::SamplesLost);
        }
        Ok(Sample {
            age: now.saturating_sub(instant) as u32,
            ..sample
        })
    }
}

/// Schedule for new tries of a part that failed.
#[derive(Clone, Copy, Debug, Default)]
struct Attempts {
    /// In a row.
    faults: u32,
    /// The round of the next try. It may be past.
    resumes: u32,
}

impl Attempts {
    const fn failed(&mut self, round: u32) {
        self.faults = self.faults.saturating_add(1);
        let doublings = self.faults.saturating_sub(2);
        let pause = if doublings < LONGEST_PAUSE.ilog2() {
            1 << doublings
        } else {
            LONGEST_PAUSE
        };
        self.resumes = round.saturating_add(pause);
    }
}

/// Runs the part of a tip for ever.
pub async fn keep<const N: usize>(
    rounds: &Rounds<N>,
    tip: usize,
    mut part: impl Driver,
    timer: impl RoundTimer,
) -> ! {
    let mut attempts = Attempts::default();
    let mut started = false;
    loop {
        let round = (rounds.at(timer.now()) + 1).max(attempts.resumes);
        timer
            .until(rounds.begin(round) + u64::from(rounds.times.begins[tip]))
            .await;
        if !started {
            // A start during the conversions of the others cannot delay their commands.
            timer.until(rounds.instant(round)).await;
            if !rounds.may_start(round) {
                continue;
            }
        }
        let outcome = if started {
            part.sample().await.map(Some)
        } else {
            part.start().await.map(|()| None)
        };
        let last = rounds.at(timer.now());
        match outcome {
            Ok(None) => started = true,
            Ok(Some(sample)) => {
                attempts = Attempts::default();
                rounds.put(tip, round, Ok(sample));
            }
            Err(fault) => {
                attempts.failed(last);
                started &= attempts.faults < 2;
                rounds.put(tip, round, Err(fault));
            }
        }
    }
}

/// Reads the samples of each round when it is over.
#[derive(Debug)]
pub struct RoundReader<'a, T, const N: usize> {
    rounds: &'a Rounds<N>,
    timer: T,
    samples: [Result<Sample, Fault>; N],
}

impl<'a, T: RoundTimer, const N: usize> RoundReader<'a, T, N> {
    /// A reader without any sample yet.
    pub const fn new(rounds: &'a Rounds<N>, timer: T) -> Self {
        Self {
            rounds,
            timer,
            samples: [NOT_YET.sample; N],
        }
    }

    /// The samples of the next round, in the order of the tips, or the reason why there is none. Missed rounds are skipped.
    pub async fn next(&mut self) -> &[Result<Sample, Fault>; N] {
        let round = self.rounds.at(self.timer.now());
        self.timer.until(self.rounds.begin(round + 1)).await;
        let now = self.timer.now();
        for (tip, sample) in self.samples.iter_mut().enumerate() {
            *sample = self.rounds.sample(tip, round, now);
        }
        &self.samples
    }
}

#[cfg(test)]
mod tests;
