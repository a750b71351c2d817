//! The end of a loop: the greatest indentation at which fingertip and actuator balance.

use super::{Loop, LoopError, fingertip};
use crate::limit::EndsBy;

/// Steps of the height at rest in which the end is told.
const STEPS: u32 = 1024;

/// The end of a loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopLimit {
    /// The greatest indentation with a state, metres, to a thousandth of the height at rest.
    pub indentation: f64,
    /// What ends there, in a word: the press of the fingertip or the actuator's states.
    pub ends_by: &'static str,
}

impl Loop {
    /// The end of the loop. It depends on the design alone, and on nothing that was solved before.
    ///
    /// # Errors
    /// [`LoopError`] of the rest state.
    pub fn limit(&self) -> Result<LoopLimit, LoopError> {
        let height = fingertip(self.kind, &self.design, self.resolution)?.rest().height;
        let mut fresh = self.at_rest();
        let depth = |step: u32| height * f64::from(step) / f64::from(STEPS);
        let (mut last, mut beyond) = (0, STEPS);
        let mut ends_by = EndsBy::NoFurtherState.word();
        while beyond - last > 1 {
            let middle = u32::midpoint(last, beyond);
            match fresh.search(depth(middle)) {
                Ok(_) => last = middle,
                Err(error) => {
                    beyond = middle;
                    ends_by = error.word();
                }
            }
        }
        Ok(LoopLimit {
            indentation: depth(last),
            ends_by,
        })
    }

    /// An error of an indentation, metres, by the end of the loop where it lies beyond that: other errors name what was tried on the way.
    #[must_use]
    pub fn explained(&self, error: LoopError, indentation: f64) -> LoopError {
        if !error.is_end() {
            return error;
        }
        match self.limit() {
            Ok(limit) if indentation > limit.indentation => LoopError::BeyondLimit {
                asked: indentation,
                limit: limit.indentation,
                ends_by: limit.ends_by,
            },
            _ => error,
        }
    }
}

impl LoopError {
    /// Whether no state is there, as far as was looked.
    pub(super) fn is_end(&self) -> bool {
        match self {
            Self::NoBalance { .. } => true,
            Self::Fingertip(error) => error.beyond().is_some(),
            _ => false,
        }
    }

    /// What ends, in a word.
    pub(super) fn word(&self) -> &'static str {
        match self {
            Self::NoBalance {
                failed: Some(error), ..
            }
            | Self::Actuator(error) => error.word(),
            Self::NoBalance {
                tip: Some(ends_by), ..
            } => ends_by.word(),
            Self::Fingertip(error) => error
                .beyond()
                .map_or(EndsBy::NoFurtherState.word(), |limit| limit.ends_by.word()),
            _ => EndsBy::NoFurtherState.word(),
        }
    }
}
