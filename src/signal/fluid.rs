//! Checks whether the fluid is still that of the model. Suspicions are latched until a command or a reset clears them.
//!
//! - A **leak** lowers the rest pressure. It is suspected if successive quiet windows are below the lowest expected zero by more
//!   than drift explains, for longer than a wall takes to creep back. For a gauge transducer, the expected zero is the stored one,
//!   or the design's. An absolute transducer cannot distinguish a leak from weather or altitude, except below the rest pressure in
//!   the thinnest air. It therefore detects a leak if the rest pressure is far above the air pressure, and cannot detect it if the
//!   two are close.
//! - A **bubble** makes the fingertip softer, most of all at a light touch, where the pressure barely rises at first. Pressure
//!   alone cannot distinguish this from a lighter touch, so it is checked only at a known indentation (a self-test against a stop).

use crate::signal::zero::limits::Limits;
use crate::status::Warnings;
use crate::units::{Microseconds, Pressure};
use model_tables::constants::{DesignConstants, Quantity};
use model_tables::units::Nanometres;

/// A fall by this share of the rest pressure is a leak, as a divisor.
const SHARE: i32 = 8;

/// Smallest fall that is a leak, in noise floors of the transducer.
const MIN_FLOORS: i64 = 10;

/// A wall that creeps back stays below zero for less than this, microseconds.
const STANDS: u64 = 60_000_000;

/// Smallest share of a known indentation that a liquid-filled fingertip reads, permille. A smaller reading means that something
/// softer than liquid is inside.
const SOFT_PERMILLE: i64 = 850;

/// Limits for a leak, counts.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Fall {
    /// Distance below the lowest expected zero from which on it is a leak.
    pub leak: i32,
}

impl Fall {
    /// The fall that is a leak for a design. The limit of the thinnest air does not include the transducer's offset. A gauge
    /// zero includes it, except for the change from day to day.
    pub const fn of(constants: &DesignConstants, fraction_bits: u32, limits: &Limits) -> Self {
        let share = constants.rest_pressure / SHARE;
        let floors = constants.transducer.noise_floor() * MIN_FLOORS;
        let share = share as i64 * 1000;
        let least = if share > floors { share } else { floors };
        let leak = Pressure::from_millipascals(least, fraction_bits).0;
        let wander = limits.wander;
        Self {
            leak: match constants.transducer.quantity {
                Quantity::Gauge if leak > limits.near => leak.saturating_add(wander),
                Quantity::Gauge => limits.near.saturating_add(wander),
                Quantity::Absolute => leak.saturating_add(limits.far).saturating_add(wander),
            },
        }
    }
}

/// Suspicions about the fluid.
#[derive(Clone, Debug)]
pub struct FluidHealth {
    fall: Fall,
    below_since: Option<Microseconds>,
    suspicions: Warnings,
}

impl FluidHealth {
    /// Nothing is suspected.
    pub const fn new(fall: Fall) -> Self {
        Self {
            fall,
            below_since: None,
            suspicions: Warnings::NONE,
        }
    }

    /// Suspicions so far.
    pub const fn suspicions(&self) -> Warnings {
        self.suspicions
    }

    /// The fluid was checked: clears all suspicions.
    pub fn clear(&mut self) {
        *self = Self::new(self.fall);
    }

    /// Takes a quiet window that lies `over` counts above the lowest expected zero.
    pub fn look(&mut self, time: Microseconds, over: i32) {
        if over >= -self.fall.leak {
            self.below_since = None;
            return;
        }
        let since = *self.below_since.get_or_insert(time);
        if time.0.saturating_sub(since.0) >= STANDS {
            self.suspicions = self.suspicions.and(Warnings::LEAK_SUSPECTED);
        }
    }

    /// A gap in the samples; its time does not count as time below the limit.
    pub fn interrupt(&mut self) {
        self.below_since = None;
    }

    /// Compares a reading with a known indentation, and returns whether they agree. A reading that is too small raises the
    /// suspicion of a bubble; otherwise the suspicion is cleared.
    pub fn compare(&mut self, read: Nanometres, known: Nanometres) -> bool {
        let firm = i64::from(read.0) * 1000 >= i64::from(known.0) * SOFT_PERMILLE;
        let others = self.suspicions.without(Warnings::BUBBLE_SUSPECTED);
        self.suspicions = others.and(Warnings::BUBBLE_SUSPECTED.when(!firm));
        firm
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::test_design::Linear;

    fn fluid() -> FluidHealth {
        let limits = Limits::of(&Linear::CONSTANTS, 8);
        FluidHealth::new(Fall::of(&Linear::CONSTANTS, 8, &limits))
    }

    /// Looks four times a second, for so many seconds.
    fn leaks(fluid: &mut FluidHealth, seconds: u64, over: i32) -> bool {
        for quarter in 0..=4 * seconds {
            fluid.look(Microseconds(quarter * 250_000), over);
        }
        fluid.suspicions() == Warnings::LEAK_SUSPECTED
    }

    #[test]
    fn an_eighth_of_the_rest_pressure_for_a_minute_is_a_leak() {
        // Rests at 20 kPa: 2.5 kPa.
        assert_eq!(fluid().fall.leak, 2_500 << 8);
        assert!(!leaks(&mut fluid(), 600, -(2_490 << 8)));
        assert!(!leaks(&mut fluid(), 59, -(2_510 << 8)));
        assert!(leaks(&mut fluid(), 60, -(2_510 << 8)));
    }

    #[test]
    fn a_flutter_or_a_gap_is_none() {
        let mut fluid = fluid();
        for quarter in 0..10_000 {
            let over = if quarter % 200 == 0 { 0 } else { -(9_000 << 8) };
            fluid.look(Microseconds(quarter * 250_000), over);
        }
        for gap in 0..100 {
            fluid.look(Microseconds((10_000 + gap * 30) * 250_000), -(9_000 << 8));
            fluid.interrupt();
        }
        assert_eq!(fluid.suspicions(), Warnings::NONE);
    }

    #[test]
    fn a_suspicion_stays_until_it_is_cleared() {
        let mut fluid = fluid();
        assert!(leaks(&mut fluid, 61, -(9_000 << 8)));
        fluid.look(Microseconds(62_000_000), 0);
        assert_eq!(fluid.suspicions(), Warnings::LEAK_SUSPECTED);
        fluid.clear();
        assert_eq!(fluid.suspicions(), Warnings::NONE);
    }

    #[test]
    fn softer_than_its_model_at_a_known_indentation_is_a_bubble() {
        let mut fluid = fluid();
        assert!(fluid.compare(Nanometres(850_000), Nanometres(1_000_000)));
        assert_eq!(fluid.suspicions(), Warnings::NONE);
        assert!(!fluid.compare(Nanometres(849_999), Nanometres(1_000_000)));
        assert_eq!(fluid.suspicions(), Warnings::BUBBLE_SUSPECTED);
        assert!(fluid.compare(Nanometres(1_000_000), Nanometres(1_000_000)));
        assert_eq!(fluid.suspicions(), Warnings::NONE);
    }
}
