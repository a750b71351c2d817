//! One standard deviation of the pressure rise.

use crate::transducer::counts::BLOCK_LENGTH;
use crate::units::Pressure;
use model_tables::constants::{DesignConstants, TransducerKind};
use model_tables::units::PressureRise;

/// The constant part of the uncertainty of a pressure rise, counts.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Uncertainty {
    /// Noise after averaging and filtering, and resolution.
    noise: i32,
}

impl Uncertainty {
    /// For a design.
    pub const fn of(constants: &DesignConstants, fraction_bits: u32) -> Self {
        Self::averaging(constants, fraction_bits, averaged(&constants.transducer.kind))
    }

    /// For a design whose reading averages `averaged` samples, counted as in [`averaged`].
    pub const fn averaging(constants: &DesignConstants, fraction_bits: u32, averaged: u32) -> Self {
        let transducer = &constants.transducer;
        let averaged = averaged as i64;
        let (noise, resolution) = (transducer.noise as i64, transducer.resolution as i64);
        // The kernel 1-2-1 over 4 leaves 6/16 of the variance; steps of the resolution have 1/12. Below 2^63.
        let variance = noise * noise / averaged / 16 * 6 + resolution * resolution / 12;
        Self {
            noise: Pressure::from_millipascals(variance.isqrt(), fraction_bits).0,
        }
    }

    /// The uncertainty of a reading over an exactly known zero, counts.
    pub const fn noise(&self) -> i32 {
        self.noise
    }

    /// The uncertainty of a rise, counts >= 0. The zero lies anywhere within `bound`; `temperature` is the possible error by temperature.
    #[inline]
    pub fn rise(&self, bound: i32, temperature: i32) -> PressureRise {
        // 1 / sqrt 3 = 577 / 1000 = 591 / 1024.
        let uniform = ((i64::from(bound) * 591) >> 10) as i32;
        let mut sigma = hypotenuse(self.noise, uniform);
        if temperature != 0 {
            sigma = hypotenuse(sigma, temperature);
        }
        PressureRise(sigma)
    }
}

/// Effective number of samples that a reading averages: the factor by which averaging reduces the variance of the noise.
pub const fn averaged(kind: &TransducerKind) -> u32 {
    match kind {
        TransducerKind::Ratiometric {
            supply_measured: false,
            ..
        } => BLOCK_LENGTH as u32,
        // Half of the codes measure the pressure. The other half measures the supply and adds as much noise again.
        TransducerKind::Ratiometric {
            supply_measured: true,
            ..
        } => BLOCK_LENGTH as u32 / 4,
        _ => 1,
    }
}

/// `sqrt(a^2 + b^2)` to 3 %, for `a, b >= 0`: the larger one, or 7/8 of it plus half of the other, whichever is larger.
#[inline]
pub(super) fn hypotenuse(a: i32, b: i32) -> i32 {
    let (small, large) = if a < b { (a, b) } else { (b, a) };
    large.max((large - (large >> 3)).saturating_add(small >> 1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::test_design::Linear;
    use proptest::prelude::*;

    #[test]
    fn noise_is_what_filtering_leaves_and_resolution_what_steps_leave() {
        // 5 Pa over 100 and 6/16: 0.306 Pa; 10 Pa / sqrt 12: 2.887 Pa; together 2.903 Pa or 743 counts of 1/256.
        let uncertainty = Uncertainty::of(&Linear::CONSTANTS, 8);
        assert_eq!(uncertainty.rise(0, 0), PressureRise(743));
        // 2500 Pa / sqrt 3 = 1443 Pa.
        let unverified = uncertainty.rise(2_500 << 8, 0).0;
        assert!((unverified - (1443 << 8)).abs() < 600, "{unverified}");
    }

    proptest! {
        #[test]
        fn the_hypotenuse_is_right_to_three_percent(a in 100..1_000_000_000_i32, b in 100..1_000_000_000_i32) {
            let exact = f64::from(a).hypot(f64::from(b));
            let got = f64::from(hypotenuse(a, b));
            prop_assert!((got / exact - 1.0).abs() < 0.03, "{got} for {exact}");
        }

        #[test]
        fn nothing_overflows(one in 0..=i32::MAX, other in 0..=i32::MAX) {
            prop_assert!(hypotenuse(one, other) >= one.max(other));
        }
    }
}
