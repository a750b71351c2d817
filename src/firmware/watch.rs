//! Monitoring by the signal task, in addition to its samples: missing samples, late tasks, and the watchdog.

use crate::firmware::queues::TASK_MONITOR;
use crate::firmware::retained;
use fingertip::board::Watchdog;
use fingertip::status::LastFault;
use fingertip::units::Microseconds;

/// Time from one check of the tasks and feed of the watchdog to the next, microseconds.
pub(super) const WATCHDOG_PERIOD: u64 = 16_000;

/// Time from one update of the stored record to the next, microseconds.
pub(super) const NOTES: u64 = 1_000_000;

/// The firmware: major, minor, patch.
pub(super) fn version() -> [u8; 3] {
    let number = |text: &str| text.parse().unwrap_or(u8::MAX);
    [
        number(env!("CARGO_PKG_VERSION_MAJOR")),
        number(env!("CARGO_PKG_VERSION_MINOR")),
        number(env!("CARGO_PKG_VERSION_PATCH")),
    ]
}

/// Number of samples missing between the last one and the one measured at this time. Times and `period` are in microseconds.
pub(super) fn missing(last: Option<u64>, measured: u64, period: u32) -> u32 {
    last.map_or(0, |last| {
        let passed = u32::try_from(measured.saturating_sub(last)).unwrap_or(u32::MAX);
        // Rounded, because the time of a block is known only to one or two conversions.
        (passed.saturating_add(period / 2) / period).saturating_sub(1)
    })
}

/// Feeds the watchdog while no task is late. Otherwise records the late task for the next run.
pub(super) fn feed(watchdog: &mut Watchdog, now: Microseconds) {
    match TASK_MONITOR.lock(|task_monitor| task_monitor.borrow().late(now)) {
        None => watchdog.pet(),
        Some(task) => retained::record_fault(LastFault::Late, task as u32),
    }
}
