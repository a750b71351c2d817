//! Presses onto the objects of one design, by its own model.

use crate::curve::{Contact, Curve, CurveError};
use crate::design_file::{Axes, DesignFile, ObjectSection, ShapeSection};
use crate::model::{Fingertip, Kind, ModelError};
use crate::object::Friction;

/// Deepest state of a curve over its first one.
const RANGE: f64 = 300.0;
/// How much deeper an object is pressed at a time until it has the plate's last pressure.
const DEEPER: f64 = 1.06;
/// From where to its end a curve's powers are taken with which it is continued, over that end's pressure.
const BACK: f64 = 0.95;

/// A length in micrometres.
pub(super) fn micrometres(metres: f64) -> i32 {
    libm::round(metres * 1e6) as i32
}

/// The object that a design's tables are of before any blend: its plate, with its friction.
pub(in crate::generate) fn plate_of(design: &DesignFile) -> DesignFile {
    with_shape(design, ShapeSection::Plate)
}

fn with_shape(design: &DesignFile, shape: ShapeSection) -> DesignFile {
    DesignFile {
        object: Some(ObjectSection {
            shape,
            friction: design.object.map_or(Friction::NONE, |object| object.friction),
            unknown: false,
        }),
        ..design.clone()
    }
}

/// Where the states of a curve lie.
#[derive(Clone, Copy, Debug)]
pub(super) struct Depths {
    /// How many down to the plate's last indentation.
    pub(super) states: usize,
    /// The deepest, over the plate's last indentation.
    pub(super) most: f64,
}

/// Presses of one design.
pub(super) struct Presses<'a> {
    design: &'a DesignFile,
    kind: Kind,
    /// The plate's last pressure rise, pascals.
    last: f64,
    /// The plate's last indentation, metres.
    deepest: f64,
}

pub(super) enum Failed {
    Model(ModelError),
    Curve(CurveError),
}

impl<'a> Presses<'a> {
    /// Of a design whose plate has this model and ends there.
    pub(super) fn of(design: &'a DesignFile, tip: &Fingertip, last: f64, deepest: f64) -> Self {
        Self {
            design,
            kind: match tip {
                Fingertip::Membrane(_) => Kind::Membrane,
                Fingertip::Solid(press) => Kind::Solid(press.elements()),
            },
            last,
            deepest,
        }
    }

    /// A press onto a ball, or with a negative radius into a cup, until it has the plate's last pressure, is deep enough or ends.
    pub(super) fn curve(&self, radius: f64, depths: Depths) -> Result<Curve, Failed> {
        let radius_mm = radius * 1e3;
        let design = with_shape(self.design, ShapeSection::Ball { radius_mm });
        let gain = design.calibration.pressure_gain;
        let mut tip = Fingertip::of(self.kind, &design.design_to(Axes::Outer)).map_err(Failed::Model)?;
        let mut contact = |depth: f64| {
            tip.contact_at(depth).map(|contact| Contact {
                pressure_rise: gain * contact.pressure_rise,
                ..contact
            })
        };
        let first = self.deepest / RANGE;
        let most = depths.most * self.deepest;
        let ratio = libm::pow(RANGE, 1.0 / (depths.states as f64 - 1.0));
        let mut points: Vec<Contact> = Vec::new();
        let mut depth = first;
        while points.last().is_none_or(|point| point.pressure_rise < self.last) {
            match contact(depth) {
                Ok(point) => points.push(point),
                // The press ends.
                Err(_) if depth > 0.5 * self.deepest => break,
                Err(error) => return Err(Failed::Model(error)),
            }
            if depth >= most {
                break;
            }
            let deeper = if depth < 0.8 * self.deepest {
                ratio
            } else {
                DEEPER.min(ratio)
            };
            depth = (depth * deeper).min(most);
        }
        Curve::new(points).map_err(Failed::Curve)
    }
}

/// A curve that goes on to where another ends, its outputs over the other's continued as powers of the pressure. What lies there
/// is not read; it lets the tables of both be of one layout.
pub(super) fn beyond(curve: &Curve, other: &Curve) -> Result<Curve, CurveError> {
    let (end, last) = (curve.end(), other.end());
    let mut points = curve.points().to_vec();
    if end.pressure_rise < last.pressure_rise {
        let over = |rise: f64| {
            let (own, other) = (curve.at_pressure_rise(rise), other.at_pressure_rise(rise));
            [
                libm::log(own.force / other.force),
                libm::log(own.indentation / other.indentation),
            ]
        };
        let (from, to) = (over(BACK * end.pressure_rise), over(end.pressure_rise));
        let steps = 12;
        let whole = libm::log(last.pressure_rise / end.pressure_rise);
        for step in 1..=steps {
            let further = whole * f64::from(step) / f64::from(steps);
            let rise = end.pressure_rise * libm::exp(further);
            let at = other.at_pressure_rise(rise);
            let ratio = |output: usize| {
                let slope = (to[output] - from[output]) / -libm::log(BACK);
                libm::exp(to[output] + slope * further)
            };
            points.push(Contact {
                pressure_rise: rise,
                force: at.force * ratio(0),
                indentation: at.indentation * ratio(1),
            });
        }
    }
    Curve::new(points)
}
