//! Pressure samples -> the level of a stretch of them, whether it was quiet, and how far the pressure swings in it.
//!
//! A window has parts of [`PART`]. The common part of the ranges of three successive parts was passed three times within 48 ms. A
//! hand cannot press and release so fast, but mains hum and a motor can. A ramp has no common part.

use crate::units::{Microseconds, Pressure, saturate};

/// Length of a window, microseconds: many periods of any hum, and shorter than `PATIENCE`.
pub(super) const LENGTH: u64 = 256_000;

/// Length of a part of a window, microseconds; at least two samples. It contains nine tenths of the range of a 50 Hz hum, and
/// nearly all at 60 Hz. Three parts are shorter than two periods of the fastest tremor of a hand, 12 Hz.
pub(super) const PART: u64 = 16_000;

/// The samples so far: at most 2^32 samples of at most 2^31 counts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    /// Start of the present part.
    since: Option<Microseconds>,
    samples: u32,
    sum: i64,
    /// Lowest and highest sample of the present part.
    lowest: Pressure,
    highest: Pressure,
    /// Start of the window.
    begun: Microseconds,
    /// The range over all its completed parts.
    range: Range,
    /// Of the last two completed parts, across windows: `common` is their common range, `last` the range of the last one.
    common: Range,
    last: Range,
}

/// From the lowest to the highest of some samples, counts. Without samples, `low` is above `high`.
#[derive(Clone, Copy, Debug)]
struct Range {
    low: i32,
    high: i32,
}

impl Range {
    const EMPTY: Self = Self {
        low: i32::MAX,
        high: i32::MIN,
    };

    const fn common(self, other: Self) -> Self {
        Self {
            low: if self.low > other.low { self.low } else { other.low },
            high: if self.high < other.high {
                self.high
            } else {
                other.high
            },
        }
    }

    fn shift(&mut self, by: i32) {
        self.low = self.low.saturating_add(by);
        self.high = self.high.saturating_add(by);
    }
}

/// Result of a complete window.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) struct Seen {
    /// The mean of its samples.
    pub level: Pressure,
    /// Difference between the highest and the lowest sample, counts.
    pub spread: i32,
}

/// Result of a part, and of the window if it ended with the part.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) struct Part {
    /// Width of the common range of this part and the two before it, counts; 0 or less if there is none.
    pub swing: i32,
    /// The result of the window; `None` until the window is long enough.
    pub window: Option<Seen>,
}

impl Window {
    pub(super) const EMPTY: Self = Self {
        since: None,
        samples: 0,
        sum: 0,
        lowest: Pressure(i32::MAX),
        highest: Pressure(i32::MIN),
        begun: Microseconds(0),
        range: Range::EMPTY,
        common: Range::EMPTY,
        last: Range::EMPTY,
    };

    /// Takes a sample. Returns the result of a part that ends with it.
    #[inline]
    pub(super) fn add(&mut self, time: Microseconds, pressure: Pressure) -> Option<Part> {
        let since = *self.since.get_or_insert(time);
        self.samples = self.samples.saturating_add(1);
        self.sum = self.sum.saturating_add(i64::from(pressure.0));
        self.lowest = self.lowest.min(pressure);
        self.highest = self.highest.max(pressure);
        if time.0.saturating_sub(since.0) >= PART {
            return Some(self.end_part(since, time));
        }
        None
    }

    /// The air pressure changed: adds `by` counts to all samples so far.
    pub(super) fn shift(&mut self, by: i32) {
        self.sum = self.sum.saturating_add(i64::from(by) * i64::from(self.samples));
        self.lowest = Pressure(self.lowest.0.saturating_add(by));
        self.highest = Pressure(self.highest.0.saturating_add(by));
        for range in [&mut self.range, &mut self.common, &mut self.last] {
            range.shift(by);
        }
    }

    /// Marks the window as not quiet, because its pressure is no evidence for the zero.
    #[inline]
    pub(super) fn disturb(&mut self) {
        self.lowest = Pressure(i32::MIN);
        self.highest = Pressure(i32::MAX);
    }

    #[cold]
    fn end_part(&mut self, since: Microseconds, time: Microseconds) -> Part {
        let part = Range {
            low: self.lowest.0,
            high: self.highest.0,
        };
        (self.lowest, self.highest) = (Self::EMPTY.lowest, Self::EMPTY.highest);
        // A disturbed part has no swing either.
        let told = if part.low == i32::MIN { Range::EMPTY } else { part };
        let three = told.common(self.common);
        self.common = told.common(self.last);
        self.last = told;
        if self.range.high < self.range.low {
            self.begun = since;
        }
        self.range.low = self.range.low.min(part.low);
        self.range.high = self.range.high.max(part.high);
        self.since = Some(time);
        let mut window = None;
        if time.0.saturating_sub(self.begun.0) >= LENGTH {
            let samples = i64::from(self.samples).max(1);
            window = Some(Seen {
                level: Pressure(saturate((self.sum + samples / 2) / samples)),
                spread: self.range.high.saturating_sub(self.range.low),
            });
            self.since = None;
            (self.samples, self.sum) = (0, 0);
            self.range = Range::EMPTY;
        }
        Part {
            swing: three.high.saturating_sub(three.low),
            window,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::TAU;

    /// The largest swing of two seconds of a pressure over time, seconds to counts, sampled every so many microseconds.
    fn swing(every: u64, pressure: impl Fn(f64) -> f64) -> i32 {
        let mut window = Window::EMPTY;
        let mut largest = 0;
        for sample in 0..2_000_000 / every {
            let time = Microseconds(sample * every);
            let counts = pressure(time.0 as f64 / 1e6).round() as i32;
            if let Some(part) = window.add(time, Pressure(counts)) {
                largest = largest.max(part.swing);
            }
        }
        largest
    }

    #[test]
    fn hum_swings_by_most_of_its_range() {
        for hertz in [50.0, 60.0] {
            let found = swing(1_000, |t| 1_000.0 * (TAU * hertz * t).sin());
            assert!((1_600..=2_000).contains(&found), "{hertz} Hz: {found}");
        }
    }

    #[test]
    fn disturbed_parts_have_no_swing() {
        let mut window = Window::EMPTY;
        for sample in 0..1_000 {
            window.disturb();
            if let Some(part) = window.add(Microseconds(sample * 1_000), Pressure(0)) {
                assert!(part.swing <= 0, "{}", part.swing);
            }
        }
    }

    #[test]
    fn what_a_hand_does_is_no_swing() {
        let press = |seconds: f64| swing(1_000, move |t| 1e6 * (t / seconds).min(1.0));
        // The fastest press there is, a slow one, a tap of 0.15 s, tremor at 12 Hz.
        assert_eq!([press(0.004), press(1.0)], [0, 0]);
        assert_eq!(
            swing(1_000, |t| 1e6 * (1.0 - (t / 0.075 - 1.0).abs()).max(0.0)),
            0
        );
        let tremor = swing(1_000, |t| 1e6 * (TAU * 12.0 * t).sin());
        assert!(tremor < 200_000, "{tremor}");
    }

    #[test]
    fn a_window_is_as_long_as_it_says_and_has_the_mean_and_the_spread_of_all_its_parts() {
        for every in [1_000, 8_000, 14_000] {
            let mut window = Window::EMPTY;
            let (mut sample, mut seen) = (0, None);
            while seen.is_none() {
                let time = Microseconds(7 + sample * every);
                seen = window
                    .add(time, Pressure(100 + sample as i32))
                    .and_then(|part| part.window);
                sample += 1;
            }
            let last = sample - 1;
            assert!(
                (LENGTH..LENGTH + 3 * every).contains(&(last * every)),
                "{every}: {last}"
            );
            let seen = seen.expect("it ended");
            assert_eq!(seen.spread, last as i32);
            assert!((seen.level.0 - 100 - (last / 2) as i32).abs() <= 1);
        }
    }
}
