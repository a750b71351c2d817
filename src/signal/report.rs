//! Results of the signal path: values with a status, or the reason why there are none.

use crate::status::{Fault, Status, Touch, Warnings};
use crate::units::Microseconds;
use model_tables::table::known::ReadPair;
use model_tables::units::{Micronewtons, Nanometres, PressureRise};

/// Force and indentation at a pressure rise, with their warnings.
///
/// | status | what the fields mean |
/// |---|---|
/// | ok | all hold, within their 1-sigma |
/// | warning: saturated | forces and indentation are lower bounds, and so is the rise beyond the transducer's range |
/// | warning: below zero | force and indentation are 0; a touch may be hidden |
/// | warning: recovering | force is 0 within its 1-sigma, indentation an upper bound; touch is unknown |
/// | warning: past unknown | all hold within their 1-sigma, which narrows |
/// | warning: zero unverified | all may be offset by an unknown rise, which the 1-sigma allows for; never "untouched" |
/// | warning: leak suspected, bubble suspected | rise and touch hold; force and indentation are for more liquid than there is |
/// | warning: calibration refused, zero aged, noisy, temperature | all hold within their 1-sigma, which is wider than it need be |
/// | warning: clock | all hold; times are a percent off |
/// | fault | there is no measurement: no field, touch included, says anything |
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Measurement {
    /// Pressure over the zero, filtered.
    pub pressure_rise: PressureRise,
    /// Force on the fingertip.
    pub force: Micronewtons,
    /// Indentation of its pole.
    pub indentation: Nanometres,
    /// One standard deviation of the three. It includes the transducer's noise and resolution, the possible drift since the zero
    /// was last known, and 2 K between a relaxing wall and its series. The error of the model is not in it.
    pub sigma: Sigma,
    /// Touch state.
    pub touch: Touch,
    /// Warnings about the other fields.
    pub warnings: Warnings,
    /// Force of the feedback actuator.
    pub feedback: Feedback,
}

impl Measurement {
    /// The reading as used with a known indentation; `None` if force and indentation are bounds, 0, or of another volume of liquid.
    #[inline]
    pub fn pair(&self) -> Option<ReadPair> {
        let refused = [
            Warnings::SATURATED,
            Warnings::BELOW_ZERO,
            Warnings::RECOVERING,
            Warnings::LEAK_SUSPECTED,
            Warnings::BUBBLE_SUSPECTED,
        ];
        let holds = !refused.iter().any(|warning| self.warnings.contains(*warning));
        (holds && self.touch != Touch::Untouched && self.indentation.0 > 0).then_some(ReadPair {
            force: self.force,
            force_sigma: self.sigma.force,
            indentation: self.indentation,
            indentation_sigma: self.sigma.indentation,
        })
    }
}

/// Force of the feedback actuator on the wearer. It takes memory, and can hold a force, only if the design has an actuator, or if
/// one may be loaded.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Feedback {
    #[cfg(feedback)]
    force: Option<FeedbackForce>,
}

/// A force of the feedback actuator.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct FeedbackForce {
    /// The force on the wearer's skin, >= 0; a lower bound where the reading is saturated.
    pub force: Micronewtons,
    /// Its one standard deviation, > 0. It includes the uncertainty of the pressure, but not the error of the model.
    pub sigma: Micronewtons,
}

impl Feedback {
    /// No actuator.
    pub const NONE: Self = Self {
        #[cfg(feedback)]
        force: None,
    };

    /// The force of a design's actuator; [`Feedback::NONE`] in an image without storage for it.
    #[cfg_attr(not(feedback), expect(unused_variables, reason = "there is no room for it"))]
    pub const fn of(force: FeedbackForce) -> Self {
        Self {
            #[cfg(feedback)]
            force: Some(force),
        }
    }

    /// The force; `None` for a design without an actuator.
    pub const fn force(self) -> Option<FeedbackForce> {
        #[cfg(feedback)]
        {
            self.force
        }
        #[cfg(not(feedback))]
        {
            None
        }
    }
}

/// One standard deviation of each value, >= 0, and above 0 for force and indentation. The largest value of the word means this
/// value or more.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Sigma {
    /// Of the pressure rise.
    pub pressure_rise: PressureRise,
    /// Of the force.
    pub force: Micronewtons,
    /// Of the indentation.
    pub indentation: Nanometres,
}

/// Force and indentation at a pressure rise.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Contact {
    /// Force on the fingertip.
    pub force: Micronewtons,
    /// Indentation of its pole.
    pub indentation: Nanometres,
    /// Warnings about both.
    pub warnings: Warnings,
}

/// One report of the signal path.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Report {
    /// The instant the values belong to: the middle of the samples they are made of.
    pub time: Microseconds,
    /// The values, or the reason why there are none.
    pub outcome: Result<Measurement, Fault>,
}

impl Report {
    /// Status of the report.
    pub fn status(&self) -> Status {
        match self.outcome {
            Ok(Measurement { warnings, .. }) => Status::qualified(warnings),
            Err(fault) => Status::Fault(fault),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(outcome: Result<Measurement, Fault>) -> Report {
        Report {
            time: Microseconds(0),
            outcome,
        }
    }

    fn qualified(warnings: Warnings) -> Report {
        report(Ok(Measurement {
            warnings,
            ..Measurement::default()
        }))
    }

    #[test]
    fn a_status_reads_as_scripts_expect_it() {
        assert_eq!(qualified(Warnings::NONE).status().to_string(), "ok");
        assert_eq!(
            qualified(Warnings::SATURATED).status().to_string(),
            "warning: saturated"
        );
        assert_eq!(
            qualified(Warnings::ZERO_UNVERIFIED.and(Warnings::SATURATED))
                .status()
                .to_string(),
            "warning: saturated; zero unverified"
        );
        assert_eq!(
            report(Err(Fault::SensorOpen)).status().to_string(),
            "fault: sensor open"
        );
    }
}
