//! Pressure samples -> the level of a stretch of them, and whether it was quiet.

use crate::units::{Microseconds, Pressure, saturate};

/// How long a window is, microseconds: longer than any hum, shorter than patience.
pub(super) const LENGTH: u64 = 256_000;

/// Samples so far: at most 2^32 of at most 2^31.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    since: Option<Microseconds>,
    samples: u32,
    sum: i64,
    lowest: Pressure,
    highest: Pressure,
}

/// What a full window saw.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) struct Seen {
    /// The mean of its samples.
    pub level: Pressure,
    /// From the lowest to the highest of them, counts.
    pub spread: i32,
}

impl Window {
    pub(super) const EMPTY: Self = Self {
        since: None,
        samples: 0,
        sum: 0,
        lowest: Pressure(i32::MAX),
        highest: Pressure(i32::MIN),
    };

    /// Takes a sample; a full window says what it saw and starts again.
    #[inline]
    pub(super) fn add(&mut self, time: Microseconds, pressure: Pressure) -> Option<Seen> {
        let since = *self.since.get_or_insert(time);
        self.samples = self.samples.saturating_add(1);
        self.sum = self.sum.saturating_add(i64::from(pressure.0));
        self.lowest = self.lowest.min(pressure);
        self.highest = self.highest.max(pressure);
        let full = time.0.saturating_sub(since.0) >= LENGTH;
        full.then(|| self.end())
    }

    /// The air, which is in all of its samples, moved by so many counts.
    pub(super) fn shift(&mut self, by: i32) {
        self.sum = self.sum.saturating_add(i64::from(by) * i64::from(self.samples));
        if self.samples > 0 {
            self.lowest = Pressure(self.lowest.0.saturating_add(by));
            self.highest = Pressure(self.highest.0.saturating_add(by));
        }
    }

    #[cold]
    fn end(&mut self) -> Seen {
        let samples = i64::from(self.samples.max(1));
        let seen = Seen {
            level: Pressure(saturate((self.sum + samples / 2).div_euclid(samples))),
            spread: self.highest.0.saturating_sub(self.lowest.0),
        };
        *self = Self::EMPTY;
        seen
    }
}
