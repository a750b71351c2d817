//! The quantities of a state, the same for both models.

use super::{Fingertip, ModelError};
use crate::membrane::Zone;
use crate::membrane::state::Wrinkling;

/// A state of rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestState {
    /// Gauge pressure of the fluid, pascals.
    pub pressure: f64,
    /// Stretch of the pole, of the middle of the wall, dimensionless.
    pub pole_stretch: f64,
    /// Radius of the equator, metres: of a solid the outer one.
    pub edge_radius: f64,
    /// Height over the base, metres: of a solid that of its outer surface.
    pub height: f64,
    /// Volume of the fluid, cubic metres.
    pub volume: f64,
}

/// A pressed state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pressed {
    /// How far the plate went down from first touch, metres.
    pub indentation: f64,
    /// Pressure over that of the rest state, pascals.
    pub pressure_rise: f64,
    /// Force on the plate, newtons.
    pub force: f64,
    /// Deformed radius of the contact, metres.
    pub contact_radius: f64,
    /// Stretch of the pole, of the middle of the wall, dimensionless.
    pub pole_stretch: f64,
    /// Smallest tension, newtons per metre; `None` of a solid, whose wall may push.
    pub least_tension: Option<f64>,
    /// The worst zone; `None` of a solid.
    pub wrinkling: Option<Wrinkling>,
}

/// A point of the meridian, in the middle of the wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeridianStation {
    /// Meridian's parameter, radians: 0 at the pole, pi/2 at the equator.
    pub parameter: f64,
    /// Deformed radius, metres.
    pub radius: f64,
    /// Height over the base, metres.
    pub height: f64,
    /// Angle of the tangent, radians: 0 is horizontal, pi/2 vertical.
    pub angle: f64,
    /// Wall thickness over the undeformed one.
    pub thickness_stretch: f64,
    /// Stretches along the meridian and around, dimensionless.
    pub stretches: [f64; 2],
    /// Tensions along and around, newtons per metre of deformed length.
    pub tensions: [f64; 2],
    /// Whether the plate lies on it.
    pub in_contact: bool,
}

impl Fingertip {
    /// The rest state.
    pub fn rest(&self) -> RestState {
        match self {
            Self::Membrane(press) => {
                let rest = press.rest();
                RestState {
                    pressure: rest.pressure,
                    pole_stretch: rest.pole_stretch,
                    edge_radius: rest.edge_radius,
                    height: rest.height,
                    volume: rest.volume,
                }
            }
            Self::Solid(press) => {
                let rest = press.rest();
                RestState {
                    pressure: rest.pressure,
                    pole_stretch: rest.pole_stretch,
                    edge_radius: rest.edge_radius,
                    height: rest.height,
                    volume: rest.volume,
                }
            }
        }
    }

    /// The pressed state at an indentation in metres, 0 ..= limit.
    ///
    /// # Errors
    /// [`ModelError`], as the model's own.
    pub fn at_indentation(&mut self, indentation: f64) -> Result<Pressed, ModelError> {
        Ok(match self {
            Self::Membrane(press) => {
                let state = press.at_indentation(indentation)?;
                Pressed {
                    indentation,
                    pressure_rise: state.pressure_rise,
                    force: state.force,
                    contact_radius: state.contact_radius,
                    pole_stretch: state.shape.pole_stretch,
                    least_tension: Some(state.shape.least_tension()),
                    wrinkling: Some(state.shape.wrinkling),
                }
            }
            Self::Solid(press) => {
                let state = press.at_indentation(indentation)?;
                Pressed {
                    indentation,
                    pressure_rise: state.pressure_rise,
                    force: state.force,
                    contact_radius: state.contact_radius,
                    pole_stretch: state.pole_stretch,
                    least_tension: None,
                    wrinkling: None,
                }
            }
        })
    }

    /// The meridian of the state at an indentation in metres (0 is the rest state), from the pole to the equator: `points` of it,
    /// at least 3.
    ///
    /// # Errors
    /// As [`Fingertip::at_indentation`].
    pub fn profile(&mut self, indentation: f64, points: usize) -> Result<Vec<MeridianStation>, ModelError> {
        Ok(match self {
            Self::Membrane(press) => press
                .profile(indentation, points)?
                .map(|point| MeridianStation {
                    parameter: point.parameter,
                    radius: point.radius,
                    height: point.height,
                    angle: point.angle,
                    // Incompressible.
                    thickness_stretch: 1.0 / (point.meridional_stretch * point.hoop_stretch),
                    stretches: [point.meridional_stretch, point.hoop_stretch],
                    tensions: [point.meridional_tension, point.hoop_tension],
                    in_contact: point.zone == Zone::Contact,
                })
                .collect(),
            Self::Solid(press) => press
                .profile(indentation, points)?
                .into_iter()
                .map(|point| MeridianStation {
                    parameter: point.parameter,
                    radius: point.radius,
                    height: point.height,
                    angle: point.angle,
                    thickness_stretch: point.thickness_stretch,
                    stretches: [point.meridional_stretch, point.hoop_stretch],
                    tensions: [point.meridional_tension, point.hoop_tension],
                    in_contact: point.in_contact,
                })
                .collect(),
        })
    }
}
