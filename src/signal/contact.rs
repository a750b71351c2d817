//! Pressure rise -> force and indentation with their 1-sigma, through the tables of the design.

use crate::signal::design::Design;
use crate::signal::report::{Contact, Feedback, FeedbackForce, Sigma};
use crate::status::Warnings;
use model_tables::units::{Micronewtons, Nanometres, PressureRise};

/// Force and indentation at a rise, with the warnings that the tables add. Below zero both are 0. Below
/// [`lowest_rest`](model_tables::constants::Transducer::lowest_rest) a warning is set.
#[inline]
pub fn contact(design: &impl Design, rise: PressureRise, warnings: Warnings) -> Contact {
    let reading = design.lookup(rise);
    Contact {
        force: reading.force,
        indentation: reading.indentation,
        warnings: warnings
            .and(Warnings::SATURATED.when(reading.saturated))
            .and(Warnings::BELOW_ZERO.when(rise < design.parameters().lowest_rest)),
    }
}

/// Converts one standard deviation of the rise into deviations of force and indentation. It compares the table values at the
/// rise and one deviation above it. Near the end of the tables it takes one deviation below instead. A rise beyond the end
/// counts as the end, and a rise below zero counts as zero. Each deviation is at least one unit, because an uncertain pressure
/// makes all three values uncertain.
// Not inlined: merged with the lookup of the reading, it would take registers that the lookup needs.
#[inline(never)]
pub fn through_tables(design: &impl Design, rise: PressureRise, at: &Contact, sigma: PressureRise) -> Sigma {
    let other = design.lookup(beside(design, rise, sigma));
    // Outputs of the tables are not negative, so a difference cannot overflow.
    let apart = |one: i32, another: i32| (one - another).abs().max(1);
    Sigma {
        pressure_rise: sigma,
        force: Micronewtons(apart(other.force.0, at.force.0)),
        indentation: Nanometres(apart(other.indentation.0, at.indentation.0)),
    }
}

/// The rise one deviation above, or one deviation below near the end of the tables.
#[inline]
fn beside(design: &impl Design, rise: PressureRise, sigma: PressureRise) -> PressureRise {
    let last = design.last_rise().0;
    let rise = rise.0.clamp(0, last);
    let above = rise.saturating_add(sigma.0);
    PressureRise(if above > last {
        rise.saturating_sub(sigma.0)
    } else {
        above
    })
}

/// Force of the feedback actuator at a rise, with its 1-sigma computed as in [`through_tables`]. It depends on the pressure
/// only, not on the touched object or on the memory of the wall.
#[inline]
pub fn feedback(design: &impl Design, rise: PressureRise, sigma: PressureRise) -> Feedback {
    let Some(force) = design.feedback(rise) else {
        return Feedback::NONE;
    };
    let other = design.feedback(beside(design, rise, sigma)).unwrap_or(force);
    Feedback::of(FeedbackForce {
        force,
        sigma: Micronewtons(other.0.saturating_sub(force.0).saturating_abs().max(1)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::design::Parameters;
    use crate::signal::test_design::{FORCE_END, INDENTATION_END, Linear, RISE_END, TRANSDUCERS};
    use crate::signal::wall::Elastic;
    use crate::signal::zero::surroundings::Surroundings;
    use model_tables::table::Reading;
    use proptest::prelude::*;

    fn deviation(design: &impl Design, rise: i32, sigma: i32) -> Sigma {
        let rise = PressureRise(rise);
        through_tables(
            design,
            rise,
            &contact(design, rise, Warnings::NONE),
            PressureRise(sigma),
        )
    }

    /// Many counts to a micronewton and to a nanometre.
    struct Shallow(Linear);

    impl Design for Shallow {
        type Wall = Elastic;
        type Around = [Surroundings; 1];

        fn parameters(&self) -> &Parameters {
            self.0.parameters()
        }

        fn lookup(&self, rise: PressureRise) -> Reading {
            let reading = self.0.lookup(rise);
            Reading {
                force: Micronewtons(reading.force.0 >> 12),
                indentation: Nanometres(reading.indentation.0 >> 12),
                ..reading
            }
        }
    }

    fn at(rise: i32) -> Contact {
        contact(&Linear::NEW, PressureRise(rise), Warnings::NONE)
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

    #[test]
    fn at_the_end_of_the_tables_it_is_taken_from_below() {
        let sigma = deviation(&Linear::NEW, RISE_END - 5, 700);
        assert_eq!((sigma.force.0, sigma.indentation.0), (700, 700));
        let below = deviation(&Linear::NEW, -9_000, 700);
        assert_eq!(below.force.0, 700);
    }

    /// An actuator that presses with 200 uN at rest and with 1 uN more for each count.
    #[cfg(feedback)]
    struct Actuated(Linear);

    #[cfg(feedback)]
    impl Design for Actuated {
        type Wall = Elastic;
        type Around = [Surroundings; 1];

        fn parameters(&self) -> &Parameters {
            self.0.parameters()
        }

        fn lookup(&self, rise: PressureRise) -> Reading {
            self.0.lookup(rise)
        }

        fn feedback(&self, rise: PressureRise) -> Option<Micronewtons> {
            Some(Micronewtons(self.lookup(rise).force.0 + 200))
        }
    }

    #[cfg(feedback)]
    #[test]
    fn an_actuator_has_its_force_and_the_deviation_of_the_pressure() {
        let at = |rise: i32| {
            let found = feedback(&Actuated(Linear::NEW), PressureRise(rise), PressureRise(700));
            let FeedbackForce { force, sigma } = found.force().expect("an actuator");
            (force.0, sigma.0)
        };
        assert_eq!(at(0), (200, 700));
        assert_eq!(at(-20_000), (200, 700));
        assert_eq!(at(5_000), (5_200, 700));
        assert_eq!(at(RISE_END - 5), (RISE_END + 195, 700));
        // Beyond the end the force is that of the end, a lower bound.
        assert_eq!(at(i32::MAX), (RISE_END + 200, 700));
        let still = feedback(&Actuated(Linear::NEW), PressureRise(50), PressureRise(0));
        assert_eq!(still.force().map(|force| force.sigma), Some(Micronewtons(1)));
    }

    #[test]
    fn a_design_without_an_actuator_has_no_feedback() {
        let found = feedback(&Linear::NEW, PressureRise(5_000), PressureRise(700));
        assert_eq!(found, Feedback::NONE);
        assert_eq!(found.force(), None);
    }

    #[test]
    fn beyond_the_end_it_is_what_it_is_at_the_end() {
        for beyond in [1, 700, 10_000, i32::MAX - RISE_END] {
            let sigma = deviation(&Linear::NEW, RISE_END + beyond, 700);
            assert_eq!((sigma.force.0, sigma.indentation.0), (700, 700), "{beyond}");
        }
    }

    proptest! {
        #[test]
        fn no_deviation_overflows(rise in any::<i32>(), sigma in 0..=i32::MAX) {
            for sigma in [
                deviation(&Linear::NEW, rise, sigma),
                deviation(&Linear::with(TRANSDUCERS[4]), rise, sigma),
                deviation(&Shallow(Linear::NEW), rise, sigma),
            ] {
                prop_assert!(sigma.force.0 > 0 && sigma.indentation.0 > 0);
            }
        }

        #[test]
        fn every_rise_has_an_answer_that_never_falls(rise in any::<i32>(), step in any::<u16>()) {
            let (low, high) = (at(rise), at(rise.saturating_add(i32::from(step))));
            prop_assert!(low.force <= high.force && low.indentation <= high.indentation);
            prop_assert!((0..=FORCE_END).contains(&low.force.0));
            prop_assert!((0..=INDENTATION_END).contains(&low.indentation.0));
        }
    }
}
