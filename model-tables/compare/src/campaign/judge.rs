//! The judges of a state.
//!
//! Virtual work uses nothing of the solver's way to a force: with the strain energy `E` and the volume `V`,
//! `F = dE/dH - P dV/dH`, both rates by central differences in `ln H` of sixth order. The second method is the same
//! collocation with other Gauss points, of order sixteen, on a finer mesh.

use super::draw::{Case, INDENTATIONS};
use model_tables::limit::EndsBy;
use model_tables::material::Law;
use model_tables::membrane::TensionField;
use model_tables::membrane::adapt::{Resolution, Unsolved};
use model_tables::membrane::closure::NewtonOutcome;
use model_tables::membrane::press::{FULL, MembraneError, Press};
use model_tables::membrane::state::PressedState;

/// What became of a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Solved, and both judges agree.
    Converged,
    /// Solved beyond the stability of the law, which the command line warns of: at best one of several states. With
    /// the judge that contradicts it, if one does.
    Warned(Option<&'static str>),
    /// Refused, and why.
    Refused(&'static str),
    /// Given, and contradicted by this judge.
    Wrong(&'static str),
}

/// A judged state.
#[derive(Clone, Debug, PartialEq)]
pub struct Judged {
    /// Indentation over the limit.
    pub part: f64,
    /// The state; `None` where it was refused.
    pub state: Option<PressedState>,
    /// What became of it.
    pub verdict: Verdict,
    /// Force less that of virtual work, over the force.
    pub work_error: f64,
    /// Part of that error that rounding explains, relative.
    pub work_rounding: f64,
    /// Largest relative difference of pressure, force and contact radius from the second method.
    pub second_error: f64,
    /// Margin of the law's stability over the state, 1 in the undeformed state.
    pub margin: f64,
    /// The refusal in words.
    pub message: String,
}

/// Gauss points of the second method: order sixteen.
const SECOND_STAGES: usize = 8;
/// Its mesh.
const SECOND: Resolution = Resolution {
    density: 1.3 * FULL.density,
    contact_elements: 2 * FULL.contact_elements,
    tolerance: FULL.tolerance,
    last_term: FULL.last_term,
};

/// Indentation over the height of rest at which a press usually ends.
const USUAL_LIMIT: f64 = 0.55;
/// Margin of stability at which a law is as good as unstable.
const NO_MARGIN: f64 = 0.02;
/// Steps of the differences in `ln H`, tried in turn: wrinkles that appear between the states leave kinks.
const STEPS: [f64; 5] = [0.06, 0.02, 5e-3, 1e-3, 1e-4];
/// Weights of the central difference of sixth order.
const WEIGHTS: [f64; 3] = [45.0 / 60.0, -9.0 / 60.0, 1.0 / 60.0];
/// Relative error a state may show by virtual work, beyond rounding.
const WORK_TOLERANCE: f64 = 1e-6;
/// Rounding of an energy, relative.
const ENERGY_ROUNDING: f64 = 1e-14;
/// Relative difference the second method may show.
const SECOND_TOLERANCE: f64 = 1e-5;

/// Force by virtual work over the force of the state, less 1, and what of it rounding explains.
fn work_error(press: &mut Press, state: &PressedState, step: f64) -> Result<(f64, f64), MembraneError> {
    let (mut energy, mut volume) = (0.0, 0.0);
    for (k, weight) in (1..).zip(WEIGHTS) {
        let shift = libm::exp(step * f64::from(k));
        let over = press.at_indentation(state.indentation * shift)?.shape;
        let under = press.at_indentation(state.indentation / shift)?.shape;
        energy += weight * (over.energy - under.energy);
        volume += weight * (over.volume - under.volume);
    }
    let length = step * state.indentation;
    let work = (energy - state.shape.pressure * volume) / length;
    let magnitude = state.shape.energy + state.shape.pressure * state.shape.volume;
    Ok((
        work / state.force - 1.0,
        ENERGY_ROUNDING * magnitude / (length * state.force),
    ))
}

/// Why a refusal was made, in a word that can be counted.
fn reason(error: &MembraneError, press: Option<&Press>) -> &'static str {
    let failure = match error {
        MembraneError::NoRestState { .. } => return "pole-stretch-turns",
        MembraneError::BeyondLimit { limit, .. } if limit.ends_by == EndsBy::MaterialSoftens => {
            return "press-law-unstable";
        }
        MembraneError::BeyondLimit { .. } => return "beyond-limit",
        MembraneError::NotAnIndentation { .. } => return "not-an-indentation",
        MembraneError::LawUnstable { .. } => return "law-unstable",
        MembraneError::Unstretched => return "no-rest-state",
        MembraneError::NotAxisymmetric
        | MembraneError::ObjectNotForMembrane
        | MembraneError::CupTooTight { .. } => {
            return "object-not-for-membrane";
        }
        MembraneError::Unheld { .. } => return "inflates-by-itself",
        MembraneError::RestUnsolved { failure } | MembraneError::PressUnsolved { failure, .. } => failure,
    };
    match (error, failure) {
        (MembraneError::PressUnsolved { .. }, _)
            if press.is_some_and(|press| press.stability().value < NO_MARGIN) =>
        {
            "press-law-unstable"
        }
        (MembraneError::RestUnsolved { .. }, Unsolved::Newton(NewtonOutcome::Inadmissible { .. })) => {
            "rest-inadmissible"
        }
        (MembraneError::RestUnsolved { .. }, _) => "rest-unsolved",
        (_, Unsolved::Newton(NewtonOutcome::Inadmissible { .. })) => "press-inadmissible",
        (_, Unsolved::Newton(NewtonOutcome::Singular { .. })) => "press-singular",
        (_, Unsolved::Newton(_)) => "press-stalled",
        (_, Unsolved::EdgePushes { .. }) => "plain-edge-pushes",
        (_, Unsolved::SlackOnObject) => "press-slack-on-object",
        (_, Unsolved::SnapsThrough) => "press-snaps-through",
        (_, Unsolved::Unsettled) => "press-unsettled",
    }
}

fn refused(part: f64, error: &MembraneError, why: &'static str) -> Judged {
    Judged {
        part,
        state: None,
        verdict: Verdict::Refused(why),
        work_error: f64::NAN,
        work_rounding: f64::NAN,
        second_error: f64::NAN,
        margin: f64::NAN,
        message: error.to_string(),
    }
}

/// Judges every state of a case.
pub fn judge(case: &Case) -> Vec<Judged> {
    let mut press = match Press::new(&case.design, case.tension_field) {
        Ok(press) => press,
        Err(error) => {
            let why = reason(&error, None);
            return case
                .parts
                .iter()
                .map(|&part| refused(part, &error, why))
                .collect();
        }
    };
    let mut by_hand = press.clone();
    // Where the end is not reached, what comes before it is judged all the same.
    let (limit, refusal) = match press.limit() {
        Ok(limit) => (limit.indentation, None),
        Err(error) => {
            let why = reason(&error, Some(&press));
            (USUAL_LIMIT * press.rest().height, Some((error, why)))
        }
    };
    let mut second =
        Press::<Law, SECOND_STAGES>::with_resolution(&case.design, case.tension_field, SECOND).ok();
    let mut judged = Vec::with_capacity(INDENTATIONS);
    let mut before: Option<PressedState> = None;
    for part in case.parts {
        let state = match (by_hand.at_indentation(part * limit), refusal) {
            (Ok(state), _) => state,
            (Err(_), Some((error, why))) => {
                judged.push(refused(part, &error, why));
                continue;
            }
            (Err(error), None) => {
                let why = reason(&error, Some(&by_hand));
                judged.push(refused(part, &error, why));
                continue;
            }
        };
        judged.push(judge_state(
            case,
            part,
            state,
            before.as_ref(),
            &mut by_hand,
            second.as_mut(),
        ));
        before = Some(state);
    }
    judged
}

fn judge_state(
    case: &Case,
    part: f64,
    state: PressedState,
    before: Option<&PressedState>,
    press: &mut Press,
    second: Option<&mut Press<Law, SECOND_STAGES>>,
) -> Judged {
    let mut judged = Judged {
        part,
        state: Some(state),
        verdict: Verdict::Converged,
        work_error: f64::INFINITY,
        work_rounding: 0.0,
        second_error: f64::INFINITY,
        margin: press.stability().value,
        message: String::new(),
    };
    let room = 0.2 * libm::log(1.0 / part);
    for step in STEPS {
        match work_error(press, &state, step.min(room)) {
            Ok((error, rounding)) => {
                if error.abs() - rounding < judged.work_error - judged.work_rounding {
                    (judged.work_error, judged.work_rounding) = (error.abs(), rounding);
                }
                if error.abs() < WORK_TOLERANCE + rounding {
                    break;
                }
            }
            Err(error) => judged.message = format!("beside it: {error}"),
        }
    }
    match second.map(|second| second.at_indentation(state.indentation)) {
        Some(Ok(other)) => {
            let off = |a: f64, b: f64| (a / b - 1.0).abs();
            judged.second_error = off(other.force, state.force)
                .max(off(other.shape.pressure, state.shape.pressure))
                .max(off(other.contact_radius, state.contact_radius));
        }
        Some(Err(error)) => judged.message = format!("second method: {error}"),
        None => judged.message = "second method: no rest state".into(),
    }
    let least = state.shape.least_tension();
    let pushes = least < -1e-9 * state.force / state.contact_radius;
    let contradicted = if case.tension_field == TensionField::Relaxed && pushes {
        Some("compressed")
    } else if case.compliance == 0.0
        && before.is_some_and(|b| state.indentation > b.indentation && state.force <= b.force)
    {
        Some("force-falls")
    } else if judged.work_error >= WORK_TOLERANCE + judged.work_rounding {
        Some("virtual-work")
    } else if judged.second_error >= SECOND_TOLERANCE {
        Some("second-method")
    } else {
        None
    };
    judged.verdict = match contradicted {
        _ if judged.margin <= 0.0 => Verdict::Warned(contradicted),
        None => Verdict::Converged,
        Some(judge) => Verdict::Wrong(judge),
    };
    judged
}
