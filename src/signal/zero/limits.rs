//! The limits of a zero: its expected value, its largest deviation, and its largest rate of change.

use crate::signal::touch::Thresholds;
use crate::signal::uncertainty::Uncertainty;
use crate::units::Pressure;
use model_tables::constants::{
    AIR, AirReference, DesignConstants, Quantity, Transducer, TransducerKind, UNSEEN_KELVINS,
};

/// Largest distance of a zero at start-up from the design's rest pressure, ten-thousandths of the transducer's range. It is the
/// day-to-day change of the offset of a compensated gauge bridge.
pub(crate) const NEAR_PERMYRIAD: i64 = 25;

/// Largest distance of any zero from its expected value, thousandths of the transducer's range: the offset that NXP allows an
/// MPX5100 (2.5 % of full scale, 0 to 85 degC).
const FAR_PERMILLE: i64 = 25;

/// Largest difference between the lowest and the highest sample of a quiet window, in noise floors. White noise of one noise
/// floor spreads over 5.6 of them in 256 draws, over more than 9 once in 10^16 windows.
const QUIET_FLOORS: i64 = 10;

/// A swing is wider than half a noise floor by this, in standard deviations of a reading. White noise spreads over this width
/// in one part of four samples in 200, and over the same levels in three successive parts once a day. A smaller swing stays
/// undetected: three standard deviations to either side, which the 1-sigma of a reading allows for.
const SWING_DEVIATIONS: i32 = 6;

/// Remaining drift of a compensated gauge bridge at a steady temperature, millipascals an hour.
pub const GAUGE_DRIFT: i64 = 2_000;

/// Drift of the zero of an absolute transducer by weather, millipascals an hour: 1 hPa an hour as a front passes.
pub const ABSOLUTE_DRIFT: i64 = 100_000;

/// The fastest change of the air around an absolute transducer, millipascals a second: a lift at 5 m/s, 12 Pa a metre.
const AIR_RATE: i64 = 60_000;

/// Rate at which the value follows the untouched pressure up, millipascals a second. It is ten times slower than the lightest
/// press that is detected at once. The movement is included in the bound.
const GAUGE_FOLLOWS: i64 = 500;

/// The same for an absolute transducer: 8 m of stairs in 25 s.
const ABSOLUTE_FOLLOWS: i64 = 4_000;

/// Fraction bits of rates.
pub(crate) const FRACTION: u32 = 32;

/// The limits of a zero, counts.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Limits {
    /// The lowest and the highest expected zero. For a gauge transducer both are the reference: the stored zero, or the
    /// design's rest pressure. For an absolute transducer they are the rest pressures in the thinnest and in the densest air.
    pub expected: [Pressure; 2],
    /// Whether the reference is a stored zero, measured on the untouched fingertip.
    pub stored: bool,
    /// Largest distance of an unverified zero from the design's rest pressure, >= 0.
    pub near: i32,
    /// Largest distance of any zero outside `expected`, >= 0.
    pub far: i32,
    /// Largest range of a quiet window, >= 0.
    pub quiet: i32,
    /// Largest common range of three successive parts of a window that noise explains, >= 0.
    pub swing: i32,
    /// Error of a zero from a quiet window: half a noise floor, and `wander`.
    pub margin: i32,
    /// Movement of the zero back and forth without a press: the fluid's weight, hysteresis, creep, and temperature if the part does
    /// not measure it; >= 0.
    pub wander: i32,
    /// The largest bound of a zero whose readings are ok. A quiet window above this rise is a touch. The design states it;
    /// otherwise it is six noise floors.
    pub bound: i32,
    /// Whether the transducer is absolute, so that its pressure includes the air pressure.
    pub absolute: bool,
    /// Largest unobserved drift, `2^-32` counts a microsecond. It includes the weather if the air pressure is not measured.
    pub drift: i64,
    /// The fastest expected rise of an untouched zero, in the same unit; 0 for a gauge transducer.
    pub air: i64,
    /// Largest rate at which the value follows, in the same unit.
    pub follows: i64,
}

impl Limits {
    /// The limits of a design without a stored calibration.
    pub const fn of(constants: &DesignConstants, fraction_bits: u32) -> Self {
        let transducer = &constants.transducer;
        let range = transducer.range[1] as i64 - transducer.range[0] as i64;
        let floor = transducer.noise_floor();
        let absolute = matches!(transducer.quantity, Quantity::Absolute);
        let [thinnest, densest] = if absolute { AIR } else { [0; 2] };
        let (air, follows) = if absolute {
            (AIR_RATE, ABSOLUTE_FOLLOWS)
        } else {
            (0, GAUGE_FOLLOWS)
        };
        let zero = &constants.zero;
        let (stated, unmeasured) = (
            zero.drift as i64,
            absolute && !matches!(zero.air, AirReference::Host),
        );
        let drift = match (stated, unmeasured) {
            // The drift of the part itself is small compared with the weather.
            (0, true) => ABSOLUTE_DRIFT,
            (0, false) => GAUGE_DRIFT,
            (_, true) => stated + ABSOLUTE_DRIFT,
            (_, false) => stated,
        };
        let wander = wander(constants);
        let bound = match zero.bound {
            0 => Thresholds::of(constants, fraction_bits).touch.0,
            stated => Pressure::from_millipascals(stated as i64, fraction_bits).0,
        };
        let rest = constants.rest_pressure;
        let near = range * NEAR_PERMYRIAD / 10;
        Self {
            expected: [
                Pressure::from_pascals(rest.saturating_add(thinnest), fraction_bits),
                Pressure::from_pascals(rest.saturating_add(densest), fraction_bits),
            ],
            stored: false,
            near: Pressure::from_millipascals(near, fraction_bits).0,
            far: Pressure::from_millipascals(range * FAR_PERMILLE, fraction_bits).0,
            quiet: Pressure::from_millipascals(floor * QUIET_FLOORS, fraction_bits).0,
            swing: Pressure::from_millipascals(floor / 2, fraction_bits)
                .0
                .saturating_add(Uncertainty::of(constants, fraction_bits).noise() * SWING_DEVIATIONS),
            margin: Pressure::from_millipascals(floor / 2 + wander, fraction_bits).0,
            wander: Pressure::from_millipascals(wander, fraction_bits).0,
            bound,
            absolute,
            drift: per_microsecond(drift, fraction_bits, 3_600_000_000),
            air: per_microsecond(air, fraction_bits, 1_000_000),
            follows: per_microsecond(follows, fraction_bits, 1_000_000),
        }
    }

    /// The same with a stored zero as the reference. An absolute transducer ignores it, because it depends on the air pressure of that day.
    #[must_use]
    pub const fn with_stored(mut self, zero: Pressure) -> Self {
        if !self.absolute {
            self.expected = [zero; 2];
            self.stored = true;
        }
        self
    }

    /// Largest distance of any zero from the middle of the expected range, counts.
    pub const fn reach(&self) -> i32 {
        let [lowest, highest] = self.expected;
        self.far.saturating_add(highest.0.saturating_sub(lowest.0) / 2)
    }

    /// Whether a zero is possible.
    pub(super) const fn allows(&self, zero: Pressure) -> bool {
        let [lowest, highest] = self.expected;
        zero.0 >= lowest.0.saturating_sub(self.far) && zero.0 <= highest.0.saturating_add(self.far)
    }

    /// The highest zero that is accepted at a start without a command: within the bound of a stored zero, or near the design's rest pressure.
    pub(super) const fn highest_at_start(&self) -> i32 {
        let over = if self.stored {
            self.bound - self.margin
        } else {
            self.near
        };
        self.expected[1].0.saturating_add(over)
    }
}

/// Movement of a zero back and forth without a press, millipascals. It is below 2^31 for every possible design. The air
/// pressure from a host is accurate to half a noise floor.
const fn wander(constants: &DesignConstants) -> i64 {
    let zero = &constants.zero;
    let kelvins = if tells_temperature(&constants.transducer) {
        0
    } else {
        UNSEEN_KELVINS as i64
    };
    let air = match zero.air {
        AirReference::Host => constants.transducer.noise_floor() / 2,
        AirReference::None | AirReference::Part => 0,
    };
    zero.fluid_head as i64
        + zero.hysteresis as i64
        + zero.creep as i64
        + kelvins * zero.per_kelvin as i64
        + air
}

/// Whether samples of a part include its temperature. All parts on a bus do.
const fn tells_temperature(transducer: &Transducer) -> bool {
    !matches!(transducer.kind, TransducerKind::Ratiometric { .. })
}

/// Rates at which the measured surroundings move the zero; 0 if the design does not use them.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Rates {
    /// For a part that measures its temperature, in `2^-16` counts for a hundredth of a kelvin.
    pub per_centikelvin: i64,
    /// Weather since the last air pressure from the host, `2^-32` counts a microsecond.
    pub weather: i64,
}

impl Rates {
    /// Number of [`Surroundings`](crate::signal::zero::surroundings::Surroundings) that these rates need: 0 or 1.
    pub const fn places(&self) -> usize {
        (self.per_centikelvin != 0 || self.weather != 0) as usize
    }

    /// The rates of a design.
    pub const fn of(constants: &DesignConstants, fraction_bits: u32) -> Self {
        let transducer = &constants.transducer;
        let told = tells_temperature(transducer);
        let host = matches!(constants.zero.air, AirReference::Host);
        Self {
            // Below 2^27 * 2^32 / 10^5, rounded up.
            per_centikelvin: if told && constants.zero.per_kelvin > 0 {
                (((constants.zero.per_kelvin as i64) << (fraction_bits + 16)) / 100_000) + 1
            } else {
                0
            },
            weather: if host && matches!(transducer.quantity, Quantity::Absolute) {
                per_microsecond(ABSOLUTE_DRIFT, fraction_bits, 3_600_000_000)
            } else {
                0
            },
        }
    }
}

/// Converts millipascals in `microseconds` to `2^-32` counts a microsecond, rounded up. Intermediate values reach 10^5 * 2^16 *
/// 2^32 and need 128 bits. The compiler computes it, or the board once at the start.
const fn per_microsecond(millipascals: i64, fraction_bits: u32, microseconds: i128) -> i64 {
    let divisor = 1000 * microseconds;
    ((((millipascals as i128) << (fraction_bits + FRACTION)) + divisor - 1) / divisor) as i64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::test_design::{Linear, TRANSDUCERS};

    fn of(transducer: usize) -> Limits {
        Limits::of(
            &DesignConstants {
                rest_pressure: 1_000,
                transducer: TRANSDUCERS[transducer],
                ..Linear::CONSTANTS
            },
            8,
        )
    }

    #[test]
    fn the_limits_of_an_absolute_part_hold_the_air() {
        // 2.5 % of 90 kPa; 1/256 Pa a count.
        let limits = of(4);
        assert_eq!(limits.expected, [Pressure(61_000 << 8), Pressure(109_000 << 8)]);
        assert_eq!((limits.far, limits.reach()), (2_250 << 8, 26_250 << 8));
        let gauge = of(0);
        assert_eq!(gauge.expected, [Pressure(1_000 << 8); 2]);
        assert_eq!((gauge.near, gauge.reach()), (250 << 8, 2_500 << 8));
        assert_eq!((gauge.margin, gauge.bound), (5 << 8, 60 << 8));
    }

    #[test]
    fn a_stored_zero_of_an_absolute_part_is_of_other_air() {
        assert_eq!(of(4).with_stored(Pressure(80_000)), of(4));
        assert_eq!(of(0).with_stored(Pressure(7)).expected, [Pressure(7); 2]);
    }

    #[test]
    fn rates_are_of_an_hour_and_a_second() {
        let counts = |rate: i64, microseconds: i64| (rate * microseconds) >> FRACTION;
        // 2 Pa and 100 Pa in an hour, 60 Pa in a second.
        assert!((counts(of(0).drift, 3_600_000_000) - (2 << 8)).abs() <= 1);
        assert!((counts(of(4).drift, 3_600_000_000) - (100 << 8)).abs() <= 1);
        assert_eq!(counts(of(4).air, 1_000_000), 60 << 8);
        assert_eq!(of(0).air, 0);
    }
}
