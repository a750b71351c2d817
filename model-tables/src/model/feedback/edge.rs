//! Compliances with which the fingertip has no state, on the way to the one of a loop.

use crate::limit::EndsBy;
use crate::model::ModelError;

/// Part of a compliance to which the edge is found beyond which the fingertip has no state.
const EDGE: f64 = 1e-3;
/// Factor between both ends of a bracket from which on it is divided by factors.
const WIDE: f64 = 4.0;

/// What is known of compliances without a state.
#[derive(Default)]
pub(super) struct Edge {
    /// What ends the press with the latest of them.
    pub(super) tip: Option<EndsBy>,
    /// Whether the actuator takes more than the lower end of the bracket stands for, so that the compliance looked for is above it.
    has_low: bool,
    /// Which ends of the bracket are compliances without a state.
    fails: [bool; 2],
    /// Whether the fluid without actuator has been tried, and a larger compliance that the fluid's is below, then.
    stiffest: bool,
    above: Option<f64>,
}

impl Edge {
    /// A compliance with a state is one end of the bracket: the lower one, or else the upper one.
    pub(super) fn found(&mut self, is_low: bool) {
        self.has_low |= is_low;
        self.fails[usize::from(!is_low)] = false;
    }

    /// The next compliance to try after one without a state: that without actuator first, then one between what is left of the bracket.
    ///
    /// # Errors
    /// The reason, where it is no end of the press or the fluid without actuator has no state either.
    pub(super) fn without(
        &mut self,
        error: ModelError,
        compliance: f64,
        stiffest: f64,
        [low, high]: [&mut f64; 2],
    ) -> Result<f64, ModelError> {
        self.tip = Some(error.beyond().ok_or(error)?.ends_by);
        if !self.stiffest && compliance > stiffest {
            self.stiffest = true;
            self.above = Some(*high).filter(|high| high.is_finite());
            *high = compliance;
            self.fails[1] = true;
            return Ok(if self.has_low {
                between(*low, *high)
            } else {
                stiffest
            });
        }
        if compliance <= stiffest {
            // Only a more compliant fluid can have one.
            let above = self.above.ok_or(error)?;
            (*low, *high) = (*high, above);
            self.fails = [true, false];
        } else if self.has_low {
            *high = compliance;
            self.fails[1] = true;
        } else {
            *low = compliance;
            self.fails[0] = true;
        }
        Ok(between(*low, *high))
    }

    /// Whether a bracket has closed on compliances without a state.
    pub(super) fn is_at(&self, [low, high]: [f64; 2]) -> bool {
        self.fails != [false; 2] && high.is_finite() && high - low <= EDGE * high
    }
}

fn between(low: f64, high: f64) -> f64 {
    if low > 0.0 && high > WIDE * low {
        libm::sqrt(low * high)
    } else {
        0.5 * (low + high)
    }
}
