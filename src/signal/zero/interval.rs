//! The value of a zero and the levels between which the true one lies.

use crate::signal::zero::Zero;
use crate::signal::zero::limits::{self, Limits};
use crate::units::{Pressure, saturate};

/// Fraction bits of levels. A level is below 2^47, so a sum of a few levels cannot overflow.
const FRACTION: u32 = 16;

/// Longest time that counts in one step, microseconds: for rates of seconds, and for drift (38 h). With these limits no product overflows.
const LONGEST: u64 = 1 << 28;
const LONGEST_DRIFT: u64 = 1 << 37;

/// Bounds of the true zero. Levels are counts with [`FRACTION`] fraction bits.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) struct Interval {
    /// The level that is reported as a rise of 0.
    value: i64,
    /// Lower bound of the true zero: from the host's assertion that the fingertip was unloaded, and drift since then.
    low: i64,
    /// Upper bound of the true zero: the lowest quiet level since then, and drift since.
    high: i64,
    /// The zero when someone last asserted that the fingertip was untouched.
    witnessed: i64,
    /// The last quiet level that did not look like a touch: it may be the zero.
    looked: i64,
    /// Largest distance of a quiet level below the witnessed zero that drift does not explain. Such a level contradicts the assertion.
    fallen: i64,
    /// Possible movement of the zero of an absolute part before the next window ends, if a lift continues at its present speed.
    moving: i64,
    /// Whether someone asserted that the fingertip was untouched.
    pub(super) verified: bool,
}

const fn level(pressure: i32) -> i64 {
    (pressure as i64) << FRACTION
}

const fn counts(level: i64) -> i32 {
    saturate(level >> FRACTION)
}

/// The same, rounded up.
const fn counts_above(level: i64) -> i32 {
    counts(level + (1 << FRACTION) - 1)
}

/// Distance at a rate during a time, rounded up.
const fn travelled(rate: i64, passed: u64, longest: u64) -> i64 {
    let passed = if passed < longest { passed } else { longest };
    ((rate * passed as i64) >> (limits::FRACTION - FRACTION)) + 1
}

impl Interval {
    /// A zero of this value that nobody verified.
    pub(super) const fn unverified(value: Pressure, high: i32, limits: &Limits) -> Self {
        let value = level(value.0);
        Self {
            value,
            low: value - level(limits.margin),
            high: level(high),
            witnessed: value,
            looked: value,
            fallen: 0,
            moving: 0,
            verified: false,
        }
    }

    /// The verified zero from before a reset.
    pub(super) const fn kept(zero: Zero) -> Self {
        let (value, bound) = (level(zero.pressure.0), level(zero.bound));
        Self {
            value,
            low: value - bound,
            high: value + bound,
            witnessed: value,
            looked: value,
            fallen: 0,
            moving: 0,
            verified: true,
        }
    }

    /// The level that is reported as a rise of 0.
    #[inline]
    pub(super) const fn value(&self) -> Pressure {
        Pressure(counts(self.value))
    }

    /// Largest distance of the true zero from the value, and largest movement since it was witnessed, whichever is larger: counts, >= 0.
    // Not inlined: inlining at each call adds 100 bytes to the image.
    #[inline(never)]
    pub(super) fn bound(&self, limits: &Limits) -> i32 {
        let up = self.high - self.value;
        let down = self.value - self.low;
        let risen = self.looked - self.witnessed;
        let moved = (risen + level(limits.margin - limits.wander)).max(self.fallen);
        let still = up.max(down).max(moved).max(level(limits.margin));
        counts_above(still + self.moving)
    }

    /// Whether the zero is verified and its bound is within the limit.
    pub(super) fn is_ok(&self, limits: &Limits) -> bool {
        self.verified && self.bound(limits) <= limits.bound
    }

    /// Largest distance of the true zero above the value, beyond the margin of a quiet window: counts, >= 0.
    pub(super) fn above(&self, limits: &Limits) -> i32 {
        let open = self.value + level(limits.margin);
        counts(self.high - open).max(0).saturating_add(limits.wander)
    }

    /// Moves the lower bound down and the upper bound up by `by` counts.
    pub(super) fn widen(&mut self, by: i32) {
        self.low -= level(by);
        self.high += level(by);
    }

    /// Moves all levels by `by` counts: the host measured this change of the air pressure.
    pub(super) fn shift(&mut self, by: i32) {
        for moved in [
            &mut self.value,
            &mut self.low,
            &mut self.high,
            &mut self.witnessed,
            &mut self.looked,
        ] {
            *moved += level(by);
        }
    }

    /// Adds the drift of the time passed to both bounds.
    pub(super) fn drift(&mut self, limits: &Limits, passed: u64) {
        let drift = travelled(limits.drift, passed, LONGEST_DRIFT);
        self.low -= drift;
        self.high += drift;
    }

    /// Takes a quiet window at this pressure, `passed` microseconds after the one before.
    pub(super) fn look(&mut self, limits: &Limits, pressure: Pressure, passed: u64) {
        let (seen, margin, touch) = (level(pressure.0), level(limits.margin), level(limits.bound));
        let over = seen - self.high;
        if seen < self.low - margin {
            self.fallen = self.fallen.max(self.witnessed - seen);
        }
        self.moving = 0;
        if over > touch {
            return;
        }
        if limits.absolute {
            // From the middle of the last window to the end of the next one is one and a half window lengths.
            let moved = (seen - self.looked).abs();
            self.moving = moved + moved / 2;
        }
        self.looked = seen;
        // A press never lowers the pressure, so the true zero is not above the measured level. But the air pressure may rise.
        let air = travelled(limits.air, passed, LONGEST);
        let evident = seen + margin;
        self.high = evident.min(self.high + air);
        let follows = travelled(limits.follows, passed, LONGEST);
        let rise = seen - self.value;
        // `clamp` would panic if its lower limit were above its upper limit.
        let followed = self.value + rise.max(-follows).min(follows);
        self.value = followed.min(evident);
        if !limits.absolute {
            // A wall that creeps back is below its rest for a while. Neither the upper bound nor the value follows it there.
            self.high = self.high.max(self.low + margin);
            self.value = self.value.max(self.low);
            // A slow press looks like drift, so the value follows it only up to the touch limit.
            self.value = self.value.min(self.witnessed + touch);
        }
        // The value also stays so low that its distance from the lower bound is within the limit, as long as such a value exists.
        let apart = self.high - self.low;
        if apart <= 2 * touch {
            let highest = self.low + touch - margin;
            self.value = self.value.min(highest.max(self.low + apart / 2));
        }
    }

    /// The zero from this level when the host asserts that the fingertip is unloaded. The part of the level above the known
    /// upper bound stays in the bound.
    pub(super) fn taken(&self, limits: &Limits, pressure: Pressure) -> Self {
        let (seen, margin) = (level(pressure.0), level(limits.margin));
        let known = seen.min(self.high - margin);
        let mut taken = Self {
            value: seen,
            low: known - margin,
            high: self.high.min(seen + margin),
            witnessed: known,
            looked: seen,
            fallen: 0,
            moving: 0,
            verified: true,
        };
        taken.verified = taken.bound(limits) <= limits.bound;
        taken
    }

    /// The user confirmed the value.
    pub(super) fn vouched(&self, limits: &Limits) -> Self {
        let seen = self.value();
        Self {
            high: self.value + level(limits.margin),
            ..*self
        }
        .taken(limits, seen)
    }

    /// This zero, updated after another zero was in use. `then` is the other zero when it was taken, `passed` microseconds ago;
    /// `now` is the other zero at present.
    pub(super) fn since(&self, limits: &Limits, then: &Self, now: &Self, passed: u64) -> Self {
        let followed = now.value - then.value;
        let mut aged = Self {
            value: self.value + followed,
            looked: self.looked + followed,
            ..*self
        };
        aged.drift(limits, passed);
        Self {
            high: now.high,
            ..aged
        }
    }
}
