//! One standard deviation of the pressure rise, and through the tables of force and indentation.

use crate::signal::contact::Contact;
use crate::signal::design::Design;
use crate::signal::report::Sigma;
use crate::transducer::counts::BLOCK_LENGTH;
use crate::units::Pressure;
use model_tables::constants::{DesignConstants, TransducerKind};
use model_tables::units::{Micronewtons, Nanometres, PressureRise};

/// What is uncertain in a pressure rise, whatever happens: counts.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Uncertainty {
    /// Noise after averaging and filtering, and resolution.
    noise: i32,
    /// An unverified zero, uniform within the bounds of any zero: of an absolute transducer nearly all that the air may be.
    unverified: i32,
}

impl Uncertainty {
    /// For a design; any zero lies within `reach` counts of the middle of its bounds.
    pub const fn of(constants: &DesignConstants, fraction_bits: u32, reach: i32) -> Self {
        let transducer = &constants.transducer;
        let averaged = averaged(&transducer.kind) as i64;
        let (noise, resolution) = (transducer.noise as i64, transducer.resolution as i64);
        // The kernel 1-2-1 over 4 leaves 6/16 of the variance; steps of the resolution have 1/12. Below 2^63.
        let variance = noise * noise / averaged / 16 * 6 + resolution * resolution / 12;
        Self {
            noise: Pressure::from_millipascals(variance.isqrt(), fraction_bits).0,
            // 1 / sqrt 3.
            unverified: (reach as i64 * 577 / 1000) as i32,
        }
    }

    /// Of a rise, with what drift and temperature may have added, counts >= 0.
    #[inline]
    pub fn rise(&self, verified: bool, drift: i32, temperature: i32) -> PressureRise {
        let mut sigma = hypotenuse(self.noise, drift);
        if temperature != 0 {
            sigma = hypotenuse(sigma, temperature);
        }
        if !verified {
            sigma = hypotenuse(sigma, self.unverified);
        }
        PressureRise(sigma)
    }
}

/// Samples of a transducer that a reading is made of, in what averaging them gains: the noise's variance falls by so much.
pub const fn averaged(kind: &TransducerKind) -> u32 {
    match kind {
        TransducerKind::Ratiometric {
            supply_measured: false,
            ..
        } => BLOCK_LENGTH as u32,
        // Half the codes, and as much noise again from the supply's half.
        TransducerKind::Ratiometric {
            supply_measured: true,
            ..
        } => BLOCK_LENGTH as u32 / 4,
        _ => 1,
    }
}

/// `sqrt(a^2 + b^2)` to 3 %, for `a, b >= 0`: the larger one, or 7/8 of it and half the other.
#[inline]
fn hypotenuse(a: i32, b: i32) -> i32 {
    let (small, large) = if a < b { (a, b) } else { (b, a) };
    large.max((large - (large >> 3)).saturating_add(small >> 1))
}

/// The same through the tables: what they give one deviation further on, or back at their end; from that end where the rise
/// is beyond it, and from zero where it is below. At least one unit: what is uncertain in the pressure is so in all three.
// On its own: woven into the reading's own lookup it takes the registers that this one needs.
#[inline(never)]
pub fn through_tables<D: Design>(rise: PressureRise, at: &Contact, sigma: PressureRise) -> Sigma {
    let last = D::LAST_RISE.0;
    let rise = rise.0.clamp(0, last);
    let above = rise.saturating_add(sigma.0);
    let other = if above > last {
        rise.saturating_sub(sigma.0)
    } else {
        above
    };
    let other = D::lookup(PressureRise(other));
    // Outputs of the tables are not negative, so no difference exceeds the word.
    let apart = |one: i32, another: i32| (one - another).abs().max(1);
    Sigma {
        pressure_rise: sigma,
        force: Micronewtons(apart(other.force.0, at.force.0)),
        indentation: Nanometres(apart(other.indentation.0, at.indentation.0)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::contact::contact;
    use crate::signal::test_design::{Linear, RISE_END, With};
    use crate::status::Warnings;
    use model_tables::table::Reading;
    use proptest::prelude::*;

    fn beside<D: Design>(rise: PressureRise, sigma: PressureRise) -> Sigma {
        through_tables::<D>(rise, &contact::<D>(rise, Warnings::NONE), sigma)
    }

    /// Many counts to a micronewton and to a nanometre.
    struct Shallow;

    impl Design for Shallow {
        const CONSTANTS: DesignConstants = Linear::CONSTANTS;
        const PRESSURE_FRACTION_BITS: u32 = Linear::PRESSURE_FRACTION_BITS;
        const LAST_RISE: PressureRise = Linear::LAST_RISE;

        fn lookup(rise: PressureRise) -> Reading {
            let reading = Linear::lookup(rise);
            Reading {
                force: Micronewtons(reading.force.0 >> 12),
                indentation: Nanometres(reading.indentation.0 >> 12),
                ..reading
            }
        }
    }

    #[test]
    fn noise_is_what_filtering_leaves_and_resolution_what_steps_leave() {
        // 5 Pa over 100 and 6/16: 0.306 Pa; 10 Pa / sqrt 12: 2.887 Pa; together 2.903 Pa or 743 counts of 1/256.
        let uncertainty = Uncertainty::of(&Linear::CONSTANTS, 8, 2_500 << 8);
        assert_eq!(uncertainty.rise(true, 0, 0), PressureRise(743));
        // 2500 Pa / sqrt 3 = 1443 Pa.
        let unverified = uncertainty.rise(false, 0, 0).0;
        assert!((unverified - (1443 << 8)).abs() < 600, "{unverified}");
    }

    #[test]
    fn at_the_end_of_the_tables_it_is_taken_from_below() {
        let rise = PressureRise(RISE_END - 5);
        let sigma = beside::<Linear>(rise, PressureRise(700));
        assert_eq!((sigma.force.0, sigma.indentation.0), (700, 700));
        let below = beside::<Linear>(PressureRise(-9_000), PressureRise(700));
        assert_eq!(below.force.0, 700);
    }

    #[test]
    fn beyond_the_end_it_is_what_it_is_at_the_end() {
        for beyond in [1, 700, 10_000, i32::MAX - RISE_END] {
            let sigma = beside::<Linear>(PressureRise(RISE_END + beyond), PressureRise(700));
            assert_eq!((sigma.force.0, sigma.indentation.0), (700, 700), "{beyond}");
        }
    }

    proptest! {
        #[test]
        fn the_hypotenuse_is_right_to_three_percent(a in 100..1_000_000_000_i32, b in 100..1_000_000_000_i32) {
            let exact = f64::from(a).hypot(f64::from(b));
            let got = f64::from(hypotenuse(a, b));
            prop_assert!((got / exact - 1.0).abs() < 0.03, "{got} for {exact}");
        }

        #[test]
        fn nothing_overflows(rise in any::<i32>(), sigma in 0..=i32::MAX, drift in 0..=i32::MAX) {
            for sigma in [
                beside::<Linear>(PressureRise(rise), PressureRise(sigma)),
                beside::<With<4>>(PressureRise(rise), PressureRise(sigma)),
                beside::<Shallow>(PressureRise(rise), PressureRise(sigma)),
            ] {
                prop_assert!(sigma.force.0 > 0 && sigma.indentation.0 > 0);
            }
            prop_assert!(hypotenuse(drift, rise.saturating_abs()) >= drift);
        }
    }
}
