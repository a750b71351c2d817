//! Pressure rise -> force and indentation, through the tables of the design.

use crate::signal::design::Design;
use crate::status::Warnings;
use model_tables::units::{Micronewtons, Nanometres, PressureRise};

/// What the tables say of a rise.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Contact {
    /// Force on the fingertip.
    pub force: Micronewtons,
    /// Indentation of its pole.
    pub indentation: Nanometres,
    /// What qualifies both.
    pub warnings: Warnings,
}

/// Force and indentation at a rise, with what the tables add to the warnings. Below zero both are 0; below
/// [`lowest_rest`](model_tables::constants::Transducer::lowest_rest) that is flagged.
#[inline]
pub fn contact<D: Design>(rise: PressureRise, warnings: Warnings) -> Contact {
    let lowest_rest = const { D::CONSTANTS.transducer.lowest_rest(D::PRESSURE_FRACTION_BITS) };
    let reading = D::lookup(rise);
    Contact {
        force: reading.force,
        indentation: reading.indentation,
        warnings: warnings
            .and(Warnings::SATURATED.when(reading.saturated))
            .and(Warnings::BELOW_ZERO.when(rise < lowest_rest)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::test_design::{FORCE_END, INDENTATION_END, Linear, RISE_END};
    use proptest::prelude::*;

    fn at(rise: i32) -> Contact {
        contact::<Linear>(PressureRise(rise), Warnings::NONE)
    }

    #[test]
    fn noise_around_zero_is_no_contact_and_ok() {
        // 8 deviations of 10 Pa at 1/256 Pa: -20 480 counts.
        for rise in [0, -1, -20_480] {
            let measurement = at(rise);
            assert_eq!(measurement.warnings, Warnings::NONE);
            assert_eq!((measurement.force.0, measurement.indentation.0), (0, 0));
        }
    }

    #[test]
    fn far_below_zero_is_flagged() {
        let measurement = at(-20_481);
        assert_eq!(measurement.warnings, Warnings::BELOW_ZERO);
        assert_eq!((measurement.force.0, measurement.indentation.0), (0, 0));
    }

    #[test]
    fn beyond_the_tables_is_a_flagged_lower_bound() {
        let end = at(RISE_END);
        assert_eq!(end.warnings, Warnings::NONE);
        assert_eq!((end.force.0, end.indentation.0), (FORCE_END, INDENTATION_END));
        let beyond = at(i32::MAX);
        assert_eq!(beyond.warnings, Warnings::SATURATED);
        assert_eq!((beyond.force, beyond.indentation), (end.force, end.indentation));
    }

    proptest! {
        #[test]
        fn every_rise_has_an_answer_that_never_falls(rise in any::<i32>(), step in any::<u16>()) {
            let (low, high) = (at(rise), at(rise.saturating_add(i32::from(step))));
            prop_assert!(low.force <= high.force && low.indentation <= high.indentation);
            prop_assert!((0..=FORCE_END).contains(&low.force.0));
            prop_assert!((0..=INDENTATION_END).contains(&low.indentation.0));
        }
    }
}
