//! Monitors the tasks, keeps a record across a reset, and limits resets.
//!
//! - The watchdog is fed only while every task has reported within its time ([`TaskMonitor`]).
//! - The cause of the end of a run, and the zero in use, are kept in memory that survives a reset ([`CrashRecord`]).
//! - After too many unrequested resets in a row, the board measures nothing and reports this ([`CrashRecord::start`]).
//!
//! The [`supervisor`](crate::transducer::supervisor) handles a transducer that does not answer.

use crate::signal::zero::Zero;
use crate::status::{LastFault, ResetCause, code_of, named_by};
use crate::units::{Microseconds, Pressure};
use crc::{CRC_32_ISO_HDLC, Crc, NoTable};

/// A run of at least this length is a good run, microseconds. After it, resets are counted from 1 again.
pub const GOOD_RUN: u64 = 10_000_000;

/// Resets in a row, each before [`GOOD_RUN`] was over, after which the board no longer measures. It uses neither the store nor the
/// transducer, because one of them may cause the hang.
pub const RESET_LIMIT: u8 = 5;

/// The tasks that must report, and how often.
#[derive(Clone, Copy, Debug)]
pub struct TaskMonitor<const TASKS: usize> {
    /// Longest time between two reports of each, microseconds.
    allowed: [u64; TASKS],
    last: [Microseconds; TASKS],
}

impl<const TASKS: usize> TaskMonitor<TASKS> {
    /// A monitor in which all tasks have reported at `now`.
    pub const fn new(allowed: [u64; TASKS], now: Microseconds) -> Self {
        Self {
            allowed,
            last: [now; TASKS],
        }
    }

    /// Takes the report of a task. An unknown task number is ignored.
    #[inline]
    pub fn report(&mut self, task: usize, now: Microseconds) {
        if let Some(last) = self.last.get_mut(task) {
            *last = now;
        }
    }

    /// The first task that is late. `None` if no task is late; only then the watchdog is fed.
    #[inline]
    pub fn late(&self, now: Microseconds) -> Option<usize> {
        (0..TASKS).find(|&task| now.0.saturating_sub(self.last[task].0) > self.allowed[task])
    }
}

/// Progress of a start; it shows where a hang without another trace occurred.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Stage {
    /// The start is complete: samples arrive.
    Running = 0,
    /// Clocks and peripherals are set up.
    Board = 1,
    /// The stored calibration is read.
    Store = 2,
    /// The first sample is awaited.
    Transducer = 3,
}

/// Record of a run for the next one. It is in memory that start-up does not clear, so it may have any bits at first.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct CrashRecord {
    /// The fault that ended the run.
    pub fault: LastFault,
    /// Task, line or address of the fault. Without a fault, the [`Stage`] of the start.
    pub detail: u32,
    /// Unrequested resets in a row.
    pub resets: u8,
    /// Whether this run has lasted for [`GOOD_RUN`].
    pub good: bool,
    /// Hash of the design to which the zero belongs.
    pub design_hash: u64,
    /// The zero in use; `None` before one was found.
    pub zero: Option<Zero>,
}

/// Words of a [`CrashRecord`] in memory.
pub const WORDS: usize = 8;

const MAGIC: u32 = 0x4642_5244;

const CHECK: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);

fn check(words: &[u32; WORDS]) -> u32 {
    let mut digest = CHECK.digest();
    for word in &words[..WORDS - 1] {
        digest.update(&word.to_le_bytes());
    }
    digest.finalize()
}

impl CrashRecord {
    /// The words to be kept.
    pub fn to_words(&self) -> [u32; WORDS] {
        let zero = self.zero.unwrap_or(Zero {
            pressure: Pressure(0),
            bound: 0,
            verified: false,
        });
        let flags = u32::from(self.good)
            | u32::from(self.zero.is_some()) << 1
            | u32::from(zero.verified) << 2
            | u32::from(self.resets) << 8
            | u32::from(code_of(&LastFault::CODES, self.fault)) << 16;
        let mut words = [
            MAGIC,
            flags,
            self.detail,
            self.design_hash as u32,
            (self.design_hash >> 32) as u32,
            zero.pressure.0 as u32,
            zero.bound as u32,
            0,
        ];
        words[WORDS - 1] = check(&words);
        words
    }

    /// The record in the words; `None` if [`CrashRecord::to_words`] did not write them.
    pub fn from_words(words: &[u32; WORDS]) -> Option<Self> {
        let [magic, flags, detail, low, high, zero, bound, sum] = *words;
        if magic != MAGIC || sum != check(words) {
            return None;
        }
        let flag = |bit: u32| flags >> bit & 1 == 1;
        Some(Self {
            fault: named_by(&LastFault::CODES, (flags >> 16) as u8)?,
            detail,
            resets: (flags >> 8) as u8,
            good: flag(0),
            design_hash: u64::from(high) << 32 | u64::from(low),
            zero: flag(1).then_some(Zero {
                pressure: Pressure(zero as i32),
                bound: bound as i32,
                verified: flag(2),
            }),
        })
    }

    /// The record of the previous run, and the start of this run. `found` is the record in the memory.
    pub fn start(found: Option<Self>, cause: ResetCause, design_hash: u64) -> Start {
        // A record with a valid check was never without power. A power-on with such a record was a sag of the supply. It
        // therefore counts as an unrequested reset.
        let asked = cause == ResetCause::Pin || cause == ResetCause::PowerOn && found.is_none();
        let before = found.unwrap_or_default();
        let (fault, detail) = match (before.fault, cause) {
            (LastFault::None, ResetCause::Watchdog) => (LastFault::Hang, before.detail),
            (LastFault::None, _) => (LastFault::None, 0),
            (fault, _) => (fault, before.detail),
        };
        let resets = match (asked, before.good) {
            (true, _) => 0,
            (false, true) => 1,
            (false, false) => before.resets.saturating_add(1),
        };
        Start {
            fault,
            detail,
            kept: before.zero.filter(|_| before.design_hash == design_hash),
            give_up: resets > RESET_LIMIT,
            crash_record: Self {
                fault: LastFault::None,
                detail: Stage::Board as u32,
                resets,
                good: false,
                design_hash,
                zero: None,
            },
        }
    }
}

/// The start of a run.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Start {
    /// Cause of the end of the previous run.
    pub fault: LastFault,
    /// Task, line, address or stage of the fault.
    pub detail: u32,
    /// The zero in use at that time. `None` if there was none, or if it belongs to another design.
    pub kept: Option<Zero>,
    /// Whether there were too many resets in a row. The board then measures nothing and reports this.
    pub give_up: bool,
    /// The record to be kept from now on.
    pub crash_record: CrashRecord,
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_watchdog_is_fed_only_while_every_task_reports() {
        let mut task_monitor = TaskMonitor::new([2_000, 50_000], Microseconds(0));
        for ms in 0..40 {
            task_monitor.report(0, Microseconds(ms * 1000));
            assert_eq!(task_monitor.late(Microseconds(ms * 1000)), None);
        }
        // The second one reports in time, then the first hangs, then the second.
        task_monitor.report(1, Microseconds(40_000));
        assert_eq!(task_monitor.late(Microseconds(41_000)), None);
        assert_eq!(task_monitor.late(Microseconds(41_001)), Some(0));
        task_monitor.report(0, Microseconds(90_000));
        assert_eq!(task_monitor.late(Microseconds(90_000)), None);
        task_monitor.report(0, Microseconds(90_001));
        assert_eq!(task_monitor.late(Microseconds(90_001)), Some(1));
        task_monitor.report(9, Microseconds(90_001));
        assert_eq!(task_monitor.late(Microseconds(90_001)), Some(1));
    }

    const CRASH_RECORD: CrashRecord = CrashRecord {
        fault: LastFault::Late,
        detail: 2,
        resets: 3,
        good: false,
        design_hash: 0x0123_4567_89AB_CDEF,
        zero: Some(Zero {
            pressure: Pressure(-42),
            bound: 7,
            verified: true,
        }),
    };

    #[test]
    fn a_watchdog_reset_keeps_the_zero_and_says_what_hung() {
        let start = CrashRecord::start(Some(CRASH_RECORD), ResetCause::Watchdog, CRASH_RECORD.design_hash);
        assert_eq!((start.fault, start.detail), (LastFault::Late, 2));
        assert_eq!(start.kept, CRASH_RECORD.zero);
        assert_eq!((start.crash_record.resets, start.give_up), (4, false));
        let other = CrashRecord::start(Some(CRASH_RECORD), ResetCause::Watchdog, 1);
        assert_eq!(other.kept, None);
    }

    #[test]
    fn a_hang_without_a_trace_is_one_all_the_same() {
        let start = CrashRecord::start(None, ResetCause::Watchdog, 1);
        assert_eq!((start.fault, start.kept), (LastFault::Hang, None));
    }

    #[test]
    fn a_hang_while_it_starts_says_where() {
        let first = CrashRecord::start(None, ResetCause::PowerOn, 1);
        let again = CrashRecord::start(Some(first.crash_record), ResetCause::Watchdog, 1);
        assert_eq!(
            (again.fault, again.detail),
            (LastFault::Hang, Stage::Board as u32)
        );
        let left = CrashRecord {
            detail: Stage::Store as u32,
            ..again.crash_record
        };
        let third = CrashRecord::start(Some(left), ResetCause::Watchdog, 1);
        assert_eq!(
            (third.fault, third.detail),
            (LastFault::Hang, Stage::Store as u32)
        );
        assert_eq!(third.crash_record.resets, 2);
        // A button is no hang, wherever it was pressed.
        let pressed = CrashRecord::start(Some(left), ResetCause::Pin, 1);
        assert_eq!((pressed.fault, pressed.detail), (LastFault::None, 0));
    }

    #[test]
    fn power_and_the_button_start_afresh() {
        let start = CrashRecord::start(None, ResetCause::PowerOn, CRASH_RECORD.design_hash);
        assert_eq!(
            (start.fault, start.kept, start.crash_record.resets),
            (LastFault::None, None, 0)
        );
        let start = CrashRecord::start(Some(CRASH_RECORD), ResetCause::Pin, CRASH_RECORD.design_hash);
        assert_eq!((start.fault, start.crash_record.resets), (LastFault::Late, 0));
    }

    #[test]
    fn a_supply_that_sags_keeps_the_zero_and_is_counted() {
        for cause in [ResetCause::PowerOn, ResetCause::BrownOut] {
            let mut found = Some(CrashRecord {
                resets: 0,
                ..CRASH_RECORD
            });
            for reset in 1..=RESET_LIMIT {
                let start = CrashRecord::start(found, cause, CRASH_RECORD.design_hash);
                assert_eq!((start.crash_record.resets, start.give_up), (reset, false));
                assert!(reset > 1 || start.kept == CRASH_RECORD.zero);
                found = Some(start.crash_record);
            }
            assert!(CrashRecord::start(found, cause, CRASH_RECORD.design_hash).give_up);
        }
    }

    #[test]
    fn a_loop_of_resets_ends_and_a_good_run_between_them_counts() {
        let mut found = None;
        for reset in 1..=RESET_LIMIT {
            let start = CrashRecord::start(found, ResetCause::Watchdog, 1);
            assert_eq!((start.crash_record.resets, start.give_up), (reset, false));
            found = Some(start.crash_record);
        }
        assert!(CrashRecord::start(found, ResetCause::Watchdog, 1).give_up);
        let good = found.map(|crash_record| CrashRecord {
            good: true,
            ..crash_record
        });
        assert_eq!(
            CrashRecord::start(good, ResetCause::Watchdog, 1)
                .crash_record
                .resets,
            1
        );
    }

    proptest! {
        #[test]
        fn what_is_kept_is_found(fault in 0..LastFault::CODES.len(), detail in any::<u32>(), resets in any::<u8>(), flags in any::<[bool; 3]>(), hash in any::<u64>(), zero in any::<[i32; 2]>()) {
            let crash_record = CrashRecord {
                fault: LastFault::CODES[fault].0,
                detail,
                resets,
                good: flags[0],
                design_hash: hash,
                zero: flags[1].then_some(Zero { pressure: Pressure(zero[0]), bound: zero[1], verified: flags[2] }),
            };
            prop_assert_eq!(CrashRecord::from_words(&crash_record.to_words()), Some(crash_record));
        }

        #[test]
        fn random_memory_is_no_crash_record(words in any::<[u32; WORDS]>(), magic in any::<bool>()) {
            let mut words = words;
            if magic {
                words[0] = MAGIC;
            }
            prop_assert_eq!(CrashRecord::from_words(&words), None);
        }

        #[test]
        fn one_flipped_bit_is_no_crash_record(word in 0..WORDS, bit in 0..32) {
            let mut words = CRASH_RECORD.to_words();
            words[word] ^= 1_u32 << bit;
            prop_assert_eq!(CrashRecord::from_words(&words), None);
        }
    }
}
