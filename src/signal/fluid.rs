//! Is the fluid still what the model was solved for? Suspicions, latched until someone clears them.
//!
//! - A **leak** lowers the rest pressure. The zero that is followed, or a reading that stays below it, falls under the
//!   lowest zero to be expected by more than drift explains. To a gauge transducer that is the zero that was stored, or
//!   the design's. To an absolute one a leak, the weather and a climb look alike: only below the rest pressure in the
//!   thinnest air is it none of these. So it tells a leak where the fingertip rests far above the air, and is silent
//!   where it rests near it.
//! - A **bubble** makes the fingertip softer, most of all at a light touch, where the pressure barely rises at first.
//!   Pressure alone cannot tell that from a lighter touch, so it is judged only when someone says how deep the
//!   fingertip is pressed (a self-test against a stop).

use crate::status::{Touch, Warnings};
use crate::units::{Microseconds, Pressure};
use model_tables::constants::{DesignConstants, Quantity};
use model_tables::units::{Nanometres, PressureRise};

/// Fallen by this share of the rest pressure, as a divisor, it is a leak.
const SHARE: i32 = 8;

/// But by no less than this, in grains of the transducer.
const LEAST_GRAINS: i64 = 10;

/// Below zero for this long it is no flutter, microseconds.
const STANDS: u64 = 1_000_000;

/// A known indentation is read smaller than this share of it: in the fingertip there is something softer than
/// liquid. Permille.
const SOFT_PERMILLE: i64 = 850;

/// What a leak is compared with, counts.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Fall {
    /// Further below the lowest zero to be expected: a leak.
    pub leak: i32,
}

impl Fall {
    /// The fall that is a leak for a design; `far` is what the transducer's offset may be, counts. A stored zero has it
    /// in it, the thinnest air has not.
    pub const fn of(constants: &DesignConstants, fraction_bits: u32, far: i32) -> Self {
        let share = constants.rest_pressure / SHARE;
        let grains = constants.transducer.grain() * LEAST_GRAINS;
        let share = share as i64 * 1000;
        let least = if share > grains { share } else { grains };
        let leak = Pressure::from_millipascals(least, fraction_bits).0;
        Self {
            leak: match constants.transducer.quantity {
                Quantity::Gauge => leak,
                Quantity::Absolute => leak.saturating_add(far),
            },
        }
    }
}

/// What is suspected.
#[derive(Clone, Debug)]
pub struct Fluid {
    fall: Fall,
    below_since: Option<Microseconds>,
    suspicions: Warnings,
}

impl Fluid {
    /// Nothing is suspected.
    pub const fn new(fall: Fall) -> Self {
        Self {
            fall,
            below_since: None,
            suspicions: Warnings::NONE,
        }
    }

    /// What is suspected so far.
    pub const fn suspicions(&self) -> Warnings {
        self.suspicions
    }

    /// The fluid was seen to.
    pub fn clear(&mut self) {
        *self = Self::new(self.fall);
    }

    /// One reading later: the rise over the zero that serves, and how far that zero lies over the lowest to be expected.
    #[inline]
    pub fn step(&mut self, time: Microseconds, rise: PressureRise, zero_over_lowest: i32, touch: Touch) {
        let over = zero_over_lowest.saturating_add(rise.0.min(0));
        if touch != Touch::Untouched || over >= -self.fall.leak {
            self.below_since = None;
            return;
        }
        let since = *self.below_since.get_or_insert(time);
        if time.0.saturating_sub(since.0) >= STANDS {
            self.suspicions = self.suspicions.and(Warnings::LEAK_SUSPECTED);
        }
    }

    /// Someone presses to a known indentation: whether the reading agrees. Too little raises the suspicion, enough
    /// lays it.
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

    fn fluid() -> Fluid {
        Fluid::new(Fall::of(&Linear::CONSTANTS, 8, 2_500 << 8))
    }

    fn leaks(rise: i32, over: i32, touch: Touch) -> bool {
        let mut fluid = fluid();
        for ms in 0..1_500 {
            fluid.step(Microseconds(ms * 1000), PressureRise(rise), over, touch);
        }
        fluid.suspicions() == Warnings::LEAK_SUSPECTED
    }

    #[test]
    fn an_eighth_of_the_rest_pressure_is_a_leak() {
        // Rests at 20 kPa: 2.5 kPa.
        assert_eq!(fluid().fall.leak, 2_500 << 8);
        assert!(!leaks(0, -(2_490 << 8), Touch::Untouched));
        assert!(leaks(0, -(2_510 << 8), Touch::Untouched));
        assert!(leaks(-(2_400 << 8), -(110 << 8), Touch::Untouched));
    }

    #[test]
    fn a_press_or_a_flutter_is_none() {
        assert!(!leaks(0, -(9_000 << 8), Touch::Touched));
        let mut fluid = fluid();
        for ms in 0..10_000 {
            let rise = if ms % 900 == 0 { 0 } else { -(9_000 << 8) };
            fluid.step(Microseconds(ms * 1000), PressureRise(rise), 0, Touch::Untouched);
        }
        assert_eq!(fluid.suspicions(), Warnings::NONE);
    }

    #[test]
    fn a_suspicion_stays_until_it_is_cleared() {
        let mut fluid = fluid();
        for ms in 0..2_000 {
            fluid.step(
                Microseconds(ms * 1000),
                PressureRise(-(9_000 << 8)),
                0,
                Touch::Untouched,
            );
        }
        fluid.step(Microseconds(3_000_000), PressureRise(0), 0, Touch::Untouched);
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
