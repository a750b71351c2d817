//! The value of a zero and the levels between which the true one lies.

use crate::signal::zero::Zero;
use crate::signal::zero::limits::{self, Limits};
use crate::units::{Pressure, saturate};

/// Fraction bits of levels: below 2^47, so that no sum of a few leaves its word.
const FRACTION: u32 = 16;

/// Longest time that counts at once for rates of seconds, and for drift (38 h), microseconds: no product leaves its word.
const LONGEST: u64 = 1 << 28;
const LONGEST_DRIFT: u64 = 1 << 37;

/// Levels are counts with [`FRACTION`] more bits.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) struct Interval {
    /// What reads as no rise.
    value: i64,
    /// The true zero is not below: the word of a host that the fingertip is unloaded, and drift since.
    low: i64,
    /// Nor above: the lowest quiet level since then, and drift since.
    high: i64,
    /// Where someone last saw it untouched.
    witnessed: i64,
    /// The last quiet level that did not look like a touch: it may be the zero.
    looked: i64,
    /// How far below the witnessed zero a quiet level lay that drift does not explain: there the word is void.
    fallen: i64,
    /// How far the zero of an absolute part may move before the next window ends: a lift goes on as it did.
    moving: i64,
    /// Someone saw it untouched.
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

/// At a rate for some time, rounded up.
const fn travelled(rate: i64, passed: u64, longest: u64) -> i64 {
    let passed = if passed < longest { passed } else { longest };
    ((rate * passed as i64) >> (limits::FRACTION - FRACTION)) + 1
}

impl Interval {
    /// A zero of this value; nobody saw it.
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

    /// What reads as no rise.
    #[inline]
    pub(super) const fn value(&self) -> Pressure {
        Pressure(counts(self.value))
    }

    /// How far the true zero may be from the value, and how far it may have moved since someone saw it: counts, >= 0.
    // Once in an image: inlined where it is asked for, each time a window ends, it takes 100 bytes more.
    #[inline(never)]
    pub(super) fn bound(&self, limits: &Limits) -> i32 {
        let up = self.high - self.value;
        let down = self.value - self.low;
        let risen = self.looked - self.witnessed;
        let moved = (risen + level(limits.margin - limits.wander)).max(self.fallen);
        let still = up.max(down).max(moved).max(level(limits.margin));
        counts_above(still + self.moving)
    }

    /// Whether somebody saw it, and it is near enough.
    pub(super) fn is_ok(&self, limits: &Limits) -> bool {
        self.verified && self.bound(limits) <= limits.bound
    }

    /// How far the true zero may be above the value, beyond the level of a quiet window: counts, >= 0.
    pub(super) fn above(&self, limits: &Limits) -> i32 {
        let open = self.value + level(limits.margin);
        counts(self.high - open).max(0).saturating_add(limits.wander)
    }

    /// Both ends move apart by so many counts.
    pub(super) fn widen(&mut self, by: i32) {
        self.low -= level(by);
        self.high += level(by);
    }

    /// All of it moves by so many counts: somebody else saw the air do so.
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

    /// Time passes: what is not seen drifts.
    pub(super) fn drift(&mut self, limits: &Limits, passed: u64) {
        let drift = travelled(limits.drift, passed, LONGEST_DRIFT);
        self.low -= drift;
        self.high += drift;
    }

    /// A quiet window at this pressure, so long after the one before.
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
            // From the middle of the last window to the end of the next one it is one and a half of them.
            let moved = (seen - self.looked).abs();
            self.moving = moved + moved / 2;
        }
        self.looked = seen;
        // Nothing presses with less than nothing: the true zero is not higher than what is seen. But the air may rise.
        let air = travelled(limits.air, passed, LONGEST);
        let evident = seen + margin;
        self.high = evident.min(self.high + air);
        let follows = travelled(limits.follows, passed, LONGEST);
        let rise = seen - self.value;
        // Not `clamp`, which panics where its limits are the wrong way round.
        let followed = self.value + rise.max(-follows).min(follows);
        self.value = followed.min(evident);
        if !limits.absolute {
            // A wall that creeps back lies below its rest for a while: neither goes there.
            self.high = self.high.max(self.low + margin);
            self.value = self.value.max(self.low);
            // Nor without bound where a slow press looks like drift.
            self.value = self.value.min(self.witnessed + touch);
        }
        // Nor so far up that the drift that may be in it is too much, as long as there is a value for which it is not.
        let apart = self.high - self.low;
        if apart <= 2 * touch {
            let highest = self.low + touch - margin;
            self.value = self.value.min(highest.max(self.low + apart / 2));
        }
    }

    /// The zero that this level makes when the host asserts that the fingertip is unloaded. What lies over all that is known stays in the
    /// bound.
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

    /// Someone vouches for the value.
    pub(super) fn vouched(&self, limits: &Limits) -> Self {
        let seen = self.value();
        Self {
            high: self.value + level(limits.margin),
            ..*self
        }
        .taken(limits, seen)
    }

    /// This zero with what happened since `then`, when another took its place: so long ago. `now` is that other one.
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
