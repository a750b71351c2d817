//! A zero that is being measured, at a start or by a command: the condition it waits for, and the reasons for a refusal.

use crate::signal::zero::interval::Interval;
use crate::units::Microseconds;

/// Longest wait for a good window, microseconds.
pub const PATIENCE: u64 = 2_000_000;

/// Reasons why a zero was not taken, or not undone.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum TareRefusal {
    /// The fingertip is touched, or may be.
    Touched,
    /// No window was quiet.
    Restless,
    /// Further from the reference than any transducer drifts.
    OutOfBounds,
    /// There are no readings.
    NoReading,
    /// Another tare is under way.
    Busy,
    /// There is nothing to undo.
    NothingToUndo,
}

/// A zero that is being measured.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measuring {
    /// The host asserts that the fingertip is unloaded, and waits for an answer.
    pub(super) commanded: bool,
    /// Whether the zero was ok at the start of the measurement. An ok zero is not replaced by one that is not ok.
    pub(super) over_ok: bool,
    /// Whether the [`PATIENCE`] of a start ended without a zero. The measurement then continues, gives way to a command, and
    /// resumes if the command fails.
    pub(super) overdue: bool,
    pub(super) since: Option<Microseconds>,
    /// Why the last window gave no zero.
    pub(super) objection: TareRefusal,
}

/// The zero that a command replaced, and the new one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Replaced {
    pub(super) before: Interval,
    pub(super) zeroed: bool,
    pub(super) by: Interval,
    pub(super) at: Microseconds,
}

impl Measuring {
    /// At start-up.
    pub(super) const NEW: Self = Self {
        commanded: false,
        over_ok: false,
        overdue: false,
        since: None,
        objection: TareRefusal::NoReading,
    };
}
