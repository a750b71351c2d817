//! The press of a design as its transducer reads it, solved or measured.

use super::{DesignState, GenerateError, in_range};
use crate::curve::{Contact, Curve, CurveFailure};
use crate::design_file::{Calibration, DataCurve, DesignFile, TransducerSection};
use crate::generate::feedback::FeedbackCurve;
use crate::model::Fingertip;

/// How much deeper than the press the curve goes where it can, so that the last input can be a number that the chip handles in
/// fewer instructions: the pressure, which grows faster than the indentation, then goes on by as much at least.
pub(super) const BEYOND: f64 = 1.0 + 1.0 / 64.0;

/// A press as the transducer reads it, with the same words as [`Solved`](super::Solved).
pub(super) struct ReadPress {
    pub(super) rest_pressure: f64,
    pub(super) curve: Curve,
    pub(super) end: Contact,
    pub(super) fingertip: Option<Fingertip>,
    pub(super) feedback: Option<FeedbackCurve>,
    pub(super) compliance: Option<f64>,
}

/// What the transducer reads at rest, and the curve of the model as it reads it with the end of the press: its own zero takes
/// the offset away.
pub(super) fn pressed(
    mut press: Fingertip,
    design: &DesignFile,
    transducer: &TransducerSection,
    indentation: f64,
) -> Result<ReadPress, GenerateError> {
    let calibration = &design.calibration;
    let deepest = indentation * 1e-3;
    let rest_pressure = calibration.pressure_read(press.rest_pressure());
    // What cannot be read is refused before the curve is solved.
    in_range(transducer, DesignState::Rest, rest_pressure)?;
    let end = press.contact_at(deepest).map_err(GenerateError::Model)?;
    in_range(
        transducer,
        DesignState::Pressed { indentation },
        calibration.pressure_read(press.rest_pressure() + end.pressure_rise),
    )?;
    let curve = match press.curve(deepest * BEYOND) {
        Ok(curve) => curve,
        Err(_) => press.curve(deepest).map_err(GenerateError::Curve)?,
    };
    let end = curve.at_indentation(deepest);
    Ok(ReadPress {
        rest_pressure,
        curve: read_by(calibration, curve)?,
        end: Contact {
            pressure_rise: calibration.pressure_gain * end.pressure_rise,
            ..end
        },
        fingertip: Some(press),
        feedback: None,
        compliance: None,
    })
}

/// A curve as the transducer reads it.
pub(super) fn read_by(calibration: &Calibration, curve: Curve) -> Result<Curve, GenerateError> {
    if calibration.pressure_gain.to_bits() == 1.0_f64.to_bits() {
        return Ok(curve);
    }
    let read = |point: &Contact| Contact {
        pressure_rise: calibration.pressure_gain * point.pressure_rise,
        ..*point
    };
    Curve::new(curve.points().iter().map(read).collect())
        .map_err(|error| GenerateError::Curve(CurveFailure::Shape(error)))
}

/// The curve of the data down to an indentation within them.
pub(super) fn measured(data: &DataCurve, deepest: f64) -> Result<Curve, GenerateError> {
    let end = data.end();
    if deepest > end.indentation * (1.0 + 1e-9) {
        return Err(GenerateError::BeyondData {
            asked: deepest * 1e3,
            deepest: end.indentation * 1e3,
        });
    }
    Curve::new(data.points(deepest)).map_err(|error| GenerateError::Curve(CurveFailure::Shape(error)))
}
