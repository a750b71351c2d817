//! The limits of a zero: its expected value, its largest deviation, and its largest rate of change.

use crate::signal::touch::Thresholds;
use crate::signal::uncertainty::Uncertainty;
use crate::units::Pressure;
use model_tables::constants::{
    AIR, AirReference, DesignConstants, Quantity, Transducer, TransducerKind, UNSEEN_KELVINS,
};

/// How far a zero at start-up may lie from the design's rest pressure, ten-thousandths of the transducer's range: what the
/// offset of a compensated gauge bridge wanders between one day and another.
pub(crate) const NEAR_PERMYRIAD: i64 = 25;

/// How far any zero may lie from where it is expected, thousandths of the transducer's range: the offset that NXP allows
/// an MPX5100 (2.5 % of full scale, 0 to 85 degC).
const FAR_PERMILLE: i64 = 25;

/// How far apart the lowest and the highest sample of a window may lie, in noise floors. White noise of that size spreads
/// over 5.6 of them in 256 draws, over more than 9 once in 10^16 windows.
const QUIET_FLOORS: i64 = 10;

/// How much wider than half a noise floor a swing is, in standard deviations of a reading: white noise spreads over that in a part of
/// four samples once in 200 times, over the same levels in three of them once in a day. What is left unseen is three of them to
/// either side, which a reading's own 1-sigma allows for.
const SWING_DEVIATIONS: i32 = 6;

/// What is left of a gauge bridge's drift after compensation, at a steady temperature, millipascals an hour.
pub const GAUGE_DRIFT: i64 = 2_000;

/// The weather, in the zero of an absolute transducer: 1 hPa an hour as a front passes.
pub const ABSOLUTE_DRIFT: i64 = 100_000;

/// The fastest change of the air around an absolute transducer, millipascals a second: a lift at 5 m/s, 12 Pa a metre.
const AIR_RATE: i64 = 60_000;

/// How fast the value follows the untouched pressure up, millipascals a second. Ten times slower than the lightest press
/// that is felt at once; what it takes away is in the bound.
const GAUGE_FOLLOWS: i64 = 500;

/// The same of an absolute transducer: 8 m of stairs in 25 s.
const ABSOLUTE_FOLLOWS: i64 = 4_000;

/// Fraction bits of rates.
pub(crate) const FRACTION: u32 = 32;

/// The limits of a zero, counts.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Limits {
    /// The lowest and the highest zero to be expected. Of a gauge transducer they are one, the reference: stored, or the
    /// design's rest pressure; of an absolute one the rest pressure in the thinnest and in the densest air.
    pub expected: [Pressure; 2],
    /// Whether the reference was stored by someone who saw the fingertip untouched.
    pub stored: bool,
    /// Largest distance of an unverified zero from the design's rest pressure, >= 0.
    pub near: i32,
    /// Largest distance of any zero outside `expected`, >= 0.
    pub far: i32,
    /// Largest range of a quiet window, >= 0.
    pub quiet: i32,
    /// What noise may have in common from one part of a window to the next two, >= 0.
    pub swing: i32,
    /// Error of a zero from a quiet window: half a noise floor, and `wander`.
    pub margin: i32,
    /// Movement of the zero back and forth without a press: the fluid's weight, hysteresis, creep, and temperature if the part does
    /// not measure it; >= 0.
    pub wander: i32,
    /// The largest bound of a zero whose readings are ok, and the rise from which on a quiet window is a touch: what the design
    /// states, or six noise floors.
    pub bound: i32,
    /// The air is in the pressure.
    pub absolute: bool,
    /// Unseen drift, `2^-32` counts a microsecond; the weather is in it where nobody measures the air.
    pub drift: i64,
    /// The fastest rise of an untouched zero that is no surprise, in the same unit; 0 for a gauge transducer.
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
            // The weather, beside which the part's own drift is small.
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

    /// The same with a stored zero for the reference. Of an absolute transducer it is of the air of that day, and none.
    #[must_use]
    pub const fn with_stored(mut self, zero: Pressure) -> Self {
        if !self.absolute {
            self.expected = [zero; 2];
            self.stored = true;
        }
        self
    }

    /// How far any zero may lie from the middle of its bounds, counts.
    pub const fn reach(&self) -> i32 {
        let [lowest, highest] = self.expected;
        self.far.saturating_add(highest.0.saturating_sub(lowest.0) / 2)
    }

    /// Whether a zero is one that can be.
    pub(super) const fn allows(&self, zero: Pressure) -> bool {
        let [lowest, highest] = self.expected;
        zero.0 >= lowest.0.saturating_sub(self.far) && zero.0 <= highest.0.saturating_add(self.far)
    }

    /// The highest zero that is believed at a start without asking: within the bound of a stored one, near the design's.
    pub(super) const fn highest_at_start(&self) -> i32 {
        let over = if self.stored {
            self.bound - self.margin
        } else {
            self.near
        };
        self.expected[1].0.saturating_add(over)
    }
}

/// What moves a zero back and forth while nothing presses, millipascals: below 2^31 for all that a design can state. The air that a
/// host measures is right to half a noise floor.
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

/// Whether samples of a part come with its temperature: of all on a bus.
const fn tells_temperature(transducer: &Transducer) -> bool {
    !matches!(transducer.kind, TransducerKind::Ratiometric { .. })
}

/// How fast what is measured around a fingertip moves its zero; 0 where the design does not ask for it.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Rates {
    /// Of a part that tells its temperature, `2^-16` counts for a hundredth of a kelvin.
    pub per_centikelvin: i64,
    /// The weather since a host told the air, `2^-32` counts a microsecond.
    pub weather: i64,
}

impl Rates {
    /// How many [`Surroundings`](crate::signal::zero::surroundings::Surroundings) they need: none, or one.
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

/// Millipascals in `microseconds` to `2^-32` counts in one, rounded up. At most 10^5 * 2^16 * 2^32 on the way: 128 bits, by the
/// compiler or once at the start.
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
