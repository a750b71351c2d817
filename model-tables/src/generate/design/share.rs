//! How the fluid and the wall share the contact's force: one parameter a design.

use super::GenerateError;
use crate::curve::Contact;
use crate::design_file::{Axes, DesignFile, ShapeSection};
use crate::model::{Fingertip, Kind};

/// States at which the share of the fluid in the contact's force is looked at.
const SHARED_STATES: u32 = 12;
/// The shares that its parameter is fitted to.
const MIDDLE: std::ops::RangeInclusive<f64> = 0.2..=0.8;

/// The pressure rise, pascals, at which the fluid bears half of the contact's force: the parameter of its share `P / (P_1 + P)` that fits
/// the share `P A / F` of solved states, `A` the area of contact: onto the ball that a design states, and else onto a plate.
pub(super) fn half_borne_by_the_fluid(
    design: &DesignFile,
    plate: &DesignFile,
    solved: Option<&Fingertip>,
    end: Contact,
) -> Result<f64, GenerateError> {
    let on_ball = design
        .object
        .is_some_and(|object| matches!(object.shape, ShapeSection::Ball { radius_mm } if radius_mm > 0.0));
    let mut tip = match solved {
        Some(solved) if on_ball => {
            let kind = match solved {
                Fingertip::Membrane(_) => Kind::Membrane,
                Fingertip::Solid(press) => Kind::Solid(press.elements()),
            };
            Fingertip::of(kind, &design.design_to(Axes::Outer)).map_err(GenerateError::Model)?
        }
        Some(solved) => solved.clone(),
        None => Fingertip::for_curve(plate).map_err(GenerateError::Model)?,
    };
    // Halves of the log-odds: in the middle, where the share matters, or where there is no middle at the state next to it.
    let (mut sum, mut count) = (0.0, 0.0);
    let mut nearest = (f64::INFINITY, end.pressure_rise);
    for k in 1..=SHARED_STATES {
        let indentation = end.indentation * f64::from(k) / f64::from(SHARED_STATES);
        let state = tip.at_indentation(indentation).map_err(GenerateError::Model)?;
        let area = std::f64::consts::PI * state.contact_radius * state.contact_radius;
        let share = state.pressure_rise * area / state.force;
        if !(share > 0.0 && share < 1.0) {
            continue;
        }
        let half = state.pressure_rise * (1.0 / share - 1.0);
        if MIDDLE.contains(&share) {
            sum += libm::log(half);
            count += 1.0;
        }
        let off = (share - 0.5).abs();
        if off < nearest.0 {
            nearest = (off, half);
        }
    }
    Ok(if count > 0.0 {
        libm::exp(sum / count)
    } else {
        nearest.1
    })
}
