//! What a zero is compared with: where it is expected, and how far off it may be.

use crate::signal::touch::Thresholds;
use crate::signal::zero::Zero;
use crate::units::Pressure;
use model_tables::constants::{AIR, DesignConstants, Quantity};
use model_tables::units::PressureRise;

/// How far a zero at start-up may lie from the reference, ten-thousandths of the transducer's range: what the offset of a
/// compensated gauge bridge wanders between one day and another.
const NEAR_PERMYRIAD: i64 = 25;

/// How far any zero may lie from where it is expected, thousandths of the transducer's range: the offset that NXP allows
/// an MPX5100 (2.5 % of full scale, 0 to 85 degC).
const FAR_PERMILLE: i64 = 25;

/// How far apart the lowest and the highest sample of a window may lie, in standard deviations of one sample.
/// White noise of that size spreads over 5.6 of them in 256 draws, over more than 9 once in 10^16 windows.
const QUIET_DEVIATIONS: i64 = 10;

/// What a window is compared with.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Gates {
    /// The lowest and the highest zero to be expected. Of a gauge transducer they are one, the reference: stored, or the
    /// design's rest pressure; of an absolute one the rest pressure in the thinnest and in the densest air.
    pub expected: [Pressure; 2],
    /// Whether the reference was stored by someone who saw the fingertip untouched.
    pub stored: bool,
    /// How far from it a zero may lie that nobody vouches for, counts, >= 0.
    pub near: i32,
    /// How far outside `expected` any zero may lie, counts, >= 0.
    pub far: i32,
    /// How far a quiet window may spread, counts, >= 0.
    pub quiet: i32,
    /// The rise from which on the fingertip is touched.
    pub touch: PressureRise,
    /// The air is in the pressure.
    pub absolute: bool,
}

impl Gates {
    /// The gates of a design without a stored calibration.
    pub const fn of(constants: &DesignConstants, fraction_bits: u32) -> Self {
        let transducer = &constants.transducer;
        let range = transducer.range[1] as i64 - transducer.range[0] as i64;
        let grain = transducer.grain();
        let absolute = matches!(transducer.quantity, Quantity::Absolute);
        let [thinnest, densest] = if absolute { AIR } else { [0; 2] };
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
            quiet: Pressure::from_millipascals(grain * QUIET_DEVIATIONS, fraction_bits).0,
            touch: Thresholds::of(constants, fraction_bits).touch,
            absolute,
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

    /// How far a zero may go from one end of its bounds to where it is last expected, counts.
    pub const fn travel(&self) -> i32 {
        let [lowest, highest] = self.expected;
        self.far.saturating_add(highest.0.saturating_sub(lowest.0))
    }

    /// How far any zero may lie from the middle of its bounds, counts.
    pub const fn reach(&self) -> i32 {
        let [lowest, highest] = self.expected;
        self.far.saturating_add(highest.0.saturating_sub(lowest.0) / 2)
    }

    pub(super) const fn within(&self, zero: Pressure, reach: i32) -> bool {
        let [lowest, highest] = self.expected;
        zero.0 >= lowest.0.saturating_sub(reach) && zero.0 <= highest.0.saturating_add(reach)
    }

    /// The zero that serves where none could be measured, if there is a reference.
    pub(super) const fn fallback(&self) -> Option<Zero> {
        if self.absolute {
            return None;
        }
        Some(Zero {
            pressure: self.expected[0],
            verified: false,
        })
    }
}
