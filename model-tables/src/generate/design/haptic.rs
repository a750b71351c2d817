//! The press of a fingertip that shares its fluid with a feedback actuator; its tables are made from this press.

use super::press::{BEYOND, ReadPress, read_by};
use super::{DesignState, GenerateError, in_range};
use crate::curve::{Contact, Curve, CurveFailure};
use crate::design_file::{DesignFile, ShapeSection, TransducerSection};
use crate::generate::feedback::FeedbackCurve;
use crate::membrane::press::{CURVE, FINER};
use crate::model::feedback::{Loop, LoopError};
use crate::model::own_error::Comparison;
use crate::model::{Fingertip, Kind};
use crate::solid::disc::{DISC, Disc, FarSide};

/// States at which the loop is solved on finer meshes.
const CHECKED: usize = 4;

/// Refuses an actuator in a design whose tables do not hold with one.
pub(super) fn is_tabled(design: &DesignFile) -> Result<(), GenerateError> {
    if design.disc().is_none() {
        return Ok(());
    }
    let blends = |shape: &ShapeSection| !matches!(shape, ShapeSection::Punch { .. });
    let reason = if design.relaxation.is_some() {
        "actuator.thickness_mm is given: with [material.relaxation] the tables are of a rigid circuit, leave it out"
    } else if design.actuator_relaxation().is_some() {
        "actuator.material.relaxation is given: the tables are of an actuator that does not relax, leave it out"
    } else if design.object.is_some_and(|object| blends(&object.shape)) {
        "[object] is given: tables of other objects than a plate are of a fingertip without an actuator, leave [object] or \
         actuator.thickness_mm out"
    } else {
        return Ok(());
    };
    Err(GenerateError::NotHaptic(reason))
}

/// Solves the loop down to `indentation`, millimetres; the fingertip alone gives the model.
pub(super) fn pressed(
    design: &DesignFile,
    transducer: &TransducerSection,
    indentation: f64,
    kind: Kind,
) -> Result<ReadPress, GenerateError> {
    let calibration = &design.calibration;
    let deepest = indentation * 1e-3;
    let mut haptic = Loop::of_file(design, kind, DISC)
        .and_then(|haptic| haptic.ok_or(LoopError::NoActuator))
        .map_err(GenerateError::Loop)?
        .with_resolution(CURVE);
    let rest_pressure = calibration.pressure_read(haptic.rest_pressure());
    in_range(transducer, DesignState::Rest, rest_pressure)?;
    let last = haptic.at_indentation(deepest).map_err(GenerateError::Loop)?;
    in_range(
        transducer,
        DesignState::Pressed { indentation },
        calibration.pressure_read(haptic.rest_pressure() + last.touch.pressure_rise),
    )?;
    let failed = |failure| match failure {
        CurveFailure::Model(error) => GenerateError::Loop(error),
        CurveFailure::Shape(error) => GenerateError::Curve(CurveFailure::Shape(error)),
    };
    let found = match haptic.curve(deepest * BEYOND) {
        Ok(found) => found,
        Err(_) => haptic.curve(deepest).map_err(failed)?,
    };
    let alone = haptic.fingertip_of(&last).map_err(GenerateError::Model)?;
    let end = found.touch.at_indentation(deepest);
    let gained = found
        .feedback
        .map(|gained| read_by(calibration, gained))
        .transpose()?;
    Ok(ReadPress {
        rest_pressure,
        curve: read_by(calibration, found.touch)?,
        end: Contact {
            pressure_rise: calibration.pressure_gain * end.pressure_rise,
            ..end
        },
        fingertip: Some(alone),
        feedback: gained.map(|gained| FeedbackCurve {
            gained,
            at_rest: found.force_at_rest,
        }),
        compliance: Some(last.compliance),
    })
}

/// The force of the actuator over a press that was measured with it: the disc at the pressures of the data.
pub(super) fn over_data(
    design: &DesignFile,
    rest_pressure: f64,
    curve: &Curve,
) -> Result<Option<FeedbackCurve>, GenerateError> {
    let Some(disc) = design.disc() else {
        return Ok(None);
    };
    if disc.far_side == FarSide::Free {
        return Ok(None);
    }
    let actuator = |error| GenerateError::Loop(LoopError::Actuator(error));
    let mut disc = Disc::new(&disc, DISC).map_err(actuator)?;
    let at_rest = disc.at_pressure(rest_pressure.max(0.0)).map_err(actuator)?.force;
    let mut points = Vec::with_capacity(curve.points().len());
    for point in curve.points() {
        let force = disc
            .at_pressure(rest_pressure + point.pressure_rise)
            .map_err(actuator)?
            .force
            - at_rest;
        if force <= 0.0 {
            let rise = point.pressure_rise;
            return Err(GenerateError::Loop(LoopError::Apart { rise }));
        }
        points.push(Contact { force, ..*point });
    }
    let gained = Curve::new(points).map_err(|error| GenerateError::Curve(CurveFailure::Shape(error)))?;
    Ok(Some(FeedbackCurve { gained, at_rest }))
}

/// The loop on finer meshes of both ends, against its curves: errors of the touch, and of the feedback force in percent of reading.
pub(super) fn convergence(
    design: &DesignFile,
    fingertip: &Fingertip,
    curve: &Curve,
    feedback: Option<&FeedbackCurve>,
    end: Contact,
    from: f64,
) -> Option<(Comparison, f64)> {
    let kind = fingertip.kind();
    let mut haptic = Loop::of_file(design, kind.finer(), DISC.finer())
        .ok()??
        .with_resolution(FINER);
    let better = match kind {
        Kind::Membrane => "a mesh twice as fine".to_owned(),
        Kind::Solid(_) => kind.finer().to_string(),
    };
    let mut found = Comparison {
        better: format!(
            "{better}, with a disc of {} x {}",
            DISC.finer().through,
            DISC.finer().along
        ),
        states: 0,
        lightest: f64::INFINITY,
        force_percent: 0.0,
        indentation_percent: 0.0,
    };
    let gain = design.calibration.pressure_gain;
    let mut of_feedback = 0.0_f64;
    for part in (1..=CHECKED).rev() {
        let state = haptic
            .at_indentation(end.indentation * part as f64 / CHECKED as f64)
            .ok()?;
        let rise = gain * state.touch.pressure_rise;
        let read = curve.at_pressure_rise(rise);
        let share = |got: f64, truth: f64, full: f64| 100.0 * (got - truth).abs() / truth.max(from * full);
        found.states += 1;
        found.lightest = found.lightest.min(state.touch.indentation);
        found.force_percent = found
            .force_percent
            .max(share(read.force, state.touch.force, end.force));
        found.indentation_percent =
            found
                .indentation_percent
                .max(share(read.indentation, state.touch.indentation, end.indentation));
        if let Some(feedback) = feedback {
            let read = feedback.at_rest + feedback.gained.at_pressure_rise(rise).force;
            of_feedback = of_feedback.max(share(read, state.actuator.force, 0.0));
        }
    }
    Some((found, of_feedback))
}
