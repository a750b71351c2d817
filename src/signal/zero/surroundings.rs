//! Measured surroundings -> possible change of the zero: the part's temperature, and the air pressure that a host sends.
//!
//! Between two air pressures from the host, only the weather is included, and the next one removes it again. The weather between
//! the last air pressure and the zero stays included.

use crate::signal::zero::limits::{FRACTION, Rates};
use crate::units::{Centidegrees, Microseconds, Pressure, saturate};

/// Longest time without an air pressure that counts, microseconds: 38 h.
const LONGEST: u64 = 1 << 37;

/// The surroundings since the zero was measured.
#[derive(Clone, Copy, Debug)]
pub struct Surroundings {
    /// Lowest and highest temperature; `None` before the first one.
    span: Option<[Centidegrees; 2]>,
    /// The last air pressure from the host, counts, and its time; `None` before the first one.
    told: Option<(Pressure, Microseconds)>,
    /// Time when the zero was measured.
    seen: Microseconds,
}

/// Effects of a new air pressure from the host, counts.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct AirMoved {
    /// Change of the zero.
    pub shift: i32,
    /// Increase of the zero's bound, >= 0.
    pub widen: i32,
}

/// Reasons for refusing an air pressure.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum AirRefusal {
    /// The design does not take the air pressure from a host.
    NotInDesign,
    /// It is outside [`AIR`](model_tables::constants::AIR).
    OutOfBounds,
}

impl Surroundings {
    /// Unknown surroundings.
    pub const NEW: Self = Self {
        span: None,
        told: None,
        seen: Microseconds(0),
    };

    /// Takes a temperature of the part, if it measures one.
    pub fn warm(&mut self, temperature: Option<Centidegrees>) {
        let Some(now) = temperature else { return };
        let [coldest, warmest] = self.span.unwrap_or([now; 2]);
        self.span = Some([coldest.min(now), warmest.max(now)]);
    }

    /// Largest movement of the zero since it was measured: counts, >= 0.
    pub fn moved(&self, rates: &Rates, now: Microseconds) -> i32 {
        let warmed = self.span.map_or(0, |[coldest, warmest]| {
            // 2^17 * 2^42.
            let span = i64::from(warmest.0) - i64::from(coldest.0);
            (span * rates.per_centikelvin + 0xFFFF) >> 16
        });
        let since = self.told.map_or(self.seen, |(_, at)| at.max(self.seen));
        saturate(warmed.saturating_add(weather(rates, since, now)))
    }

    /// The zero was measured, or its possible movement so far was added to its bound.
    pub fn begin(&mut self, now: Microseconds) {
        self.span = None;
        self.seen = now;
    }

    /// Takes an air pressure from the host.
    pub fn tell(&mut self, rates: &Rates, air: Pressure, now: Microseconds) -> AirMoved {
        let before = self.told.replace((air, now));
        match before {
            None => AirMoved {
                shift: 0,
                widen: saturate(weather(rates, self.seen, now)),
            },
            Some((told, at)) => AirMoved {
                shift: air.0.saturating_sub(told.0),
                widen: saturate(weather(rates, at, self.seen)),
            },
        }
    }
}

/// Largest change by weather from one time to another, counts, rounded up; 0 if `to` is before `from`.
fn weather(rates: &Rates, from: Microseconds, to: Microseconds) -> i64 {
    // 100 Pa/h are below 2^23, for 2^37 us.
    let passed = to.0.saturating_sub(from.0).min(LONGEST) as i64;
    (rates.weather * passed + (1 << FRACTION) - 1) >> FRACTION
}

/// Storage for the surroundings: one place, or none in an image whose design does not use them.
pub trait Around: AsRef<[Surroundings]> + AsMut<[Surroundings]> + Clone + core::fmt::Debug {
    /// Unknown surroundings.
    const NEW: Self;
}

impl<const PLACES: usize> Around for [Surroundings; PLACES] {
    const NEW: Self = [Surroundings::NEW; PLACES];
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// 2 Pa/K, 100 Pa/h, 1/256 Pa.
    const RATES: Rates = Rates {
        per_centikelvin: (2_000 << 24) / 100_000,
        weather: ((100 << 8) << 32) / 3_600_000_000,
    };
    const HOUR: u64 = 3_600_000_000;

    fn pascals(counts: i32) -> f64 {
        f64::from(counts) / 256.0
    }

    #[test]
    fn the_span_of_temperatures_since_the_zero_counts_and_not_the_last_one() {
        let mut around = Surroundings::NEW;
        for celsius in [20, 27, 18, 20] {
            around.warm(Some(Centidegrees(celsius * 100)));
        }
        around.warm(None);
        assert!((pascals(around.moved(&RATES, Microseconds(0))) - 18.0).abs() < 0.1);
        around.begin(Microseconds(0));
        around.warm(Some(Centidegrees(2_000)));
        assert!(pascals(around.moved(&RATES, Microseconds(0))) < 0.1);
    }

    #[test]
    fn weather_is_open_until_the_air_is_told_again() {
        let mut around = Surroundings::NEW;
        around.tell(&RATES, Pressure(100_000 << 8), Microseconds(0));
        around.begin(Microseconds(0));
        assert!((pascals(around.moved(&RATES, Microseconds(HOUR))) - 100.0).abs() < 0.1);
        let moved = around.tell(&RATES, Pressure(100_030 << 8), Microseconds(HOUR));
        assert_eq!((moved.shift, moved.widen), (30 << 8, 0));
        assert_eq!(around.moved(&RATES, Microseconds(HOUR)), 0);
    }

    #[test]
    fn what_passed_between_the_last_telling_and_the_zero_stays_open() {
        let mut around = Surroundings::NEW;
        around.tell(&RATES, Pressure(100_000 << 8), Microseconds(0));
        around.begin(Microseconds(HOUR));
        assert_eq!(around.moved(&RATES, Microseconds(HOUR)), 0);
        let moved = around.tell(&RATES, Pressure(100_080 << 8), Microseconds(HOUR));
        assert_eq!(moved.shift, 80 << 8);
        assert!((pascals(moved.widen) - 100.0).abs() < 0.1);
        // The first telling of all tells no change, and what passed since the zero stays open.
        let mut around = Surroundings::NEW;
        let moved = around.tell(&RATES, Pressure(100_000 << 8), Microseconds(HOUR));
        assert_eq!(moved.shift, 0);
        assert!((pascals(moved.widen) - 100.0).abs() < 0.1);
    }

    proptest! {
        #[test]
        fn nothing_overflows(
            rates in (0..1_i64 << 42, 0..1_i64 << 23), cold in any::<i16>(), warm in any::<i16>(), air in any::<[i32; 2]>(),
            times in any::<[u64; 3]>(),
        ) {
            let rates = Rates { per_centikelvin: rates.0, weather: rates.1 };
            let mut around = Surroundings::NEW;
            around.warm(Some(Centidegrees(cold)));
            around.warm(Some(Centidegrees(warm)));
            around.begin(Microseconds(times[0]));
            around.warm(Some(Centidegrees(cold)));
            around.warm(Some(Centidegrees(warm)));
            for (air, time) in air.into_iter().zip(times) {
                prop_assert!(around.tell(&rates, Pressure(air), Microseconds(time)).widen >= 0);
                prop_assert!(around.moved(&rates, Microseconds(times[2])) >= 0);
            }
        }
    }
}
