//! A press of the loop as curves: touch and feedback over the pressure.

use super::{Loop, LoopError, LoopState};
use crate::curve::{Contact, Curve, CurveFailure};
use crate::membrane::press::curve_depths as depths_of_membrane;
use crate::model::Kind;
use crate::solid::press::curve_depths as depths_of_solid;

/// Pressure rise over the pressure at rest below which the difference of two forces of the actuator has too few digits for a curve.
const MIN_RISE: f64 = 1e-3;

/// A press of the loop.
#[derive(Clone, Debug)]
pub struct LoopCurve {
    /// Pressure rise, force of the touch, indentation.
    pub touch: Curve,
    /// The same with the force that the actuator has gained since rest in the place of the touch's; `None` where it presses nothing.
    pub feedback: Option<Curve>,
    /// Force of the actuator at rest, newtons.
    pub force_at_rest: f64,
    /// The compliance of a fingertip alone that has the deepest state, cubic metres per pascal.
    pub compliance: f64,
}

impl Loop {
    /// The curves of a press down to `deepest`, metres.
    ///
    /// # Errors
    /// [`CurveFailure::Model`] where a state is missing or the actuator begins to press only on the way, [`CurveFailure::Shape`] if pressure or
    /// forces do not grow throughout.
    pub fn curve(&mut self, deepest: f64) -> Result<LoopCurve, CurveFailure<LoopError>> {
        // The deepest first: its fingertip is near those of all others.
        let last = self.at_indentation(deepest).map_err(CurveFailure::Model)?;
        let depths: Vec<f64> = match self.kind {
            Kind::Membrane => depths_of_membrane(deepest).collect(),
            Kind::Solid(_) => depths_of_solid(deepest).collect(),
        };
        let states: Result<Vec<LoopState>, LoopError> = depths
            .into_iter()
            .map(|depth| self.at_indentation(depth))
            .collect();
        let states = states.map_err(CurveFailure::Model)?;
        let touch = Curve::new(states.iter().map(|state| state.touch).collect());
        let force_at_rest = self.actuator_at_rest.force;
        let feedback = (last.actuator.force > 0.0)
            .then(|| gained(&states, force_at_rest, self.rest_pressure))
            .transpose()?;
        Ok(LoopCurve {
            touch: touch.map_err(CurveFailure::Shape)?,
            feedback,
            force_at_rest,
            compliance: last.compliance,
        })
    }
}

/// What the actuator's force has gained since rest.
fn gained(
    states: &[LoopState],
    force_at_rest: f64,
    rest_pressure: f64,
) -> Result<Curve, CurveFailure<LoopError>> {
    let points: Vec<Contact> = states
        .iter()
        .filter(|state| state.touch.pressure_rise >= MIN_RISE * rest_pressure)
        .map(|state| Contact {
            force: state.actuator.force - force_at_rest,
            ..state.touch
        })
        .collect();
    // Over a gap the force begins on the way, as no polynomial does.
    if let Some(point) = points.iter().rfind(|point| point.force <= 0.0) {
        return Err(CurveFailure::Model(LoopError::Apart {
            rise: point.pressure_rise,
        }));
    }
    Curve::new(points).map_err(CurveFailure::Shape)
}
