//! The haptic loop: fingertip and feedback actuator share one fluid, `V_tip(P, H) + V_actuator(P) + V_gas(P) + c P = const`.
//!
//! At one indentation, the actuator acts on the fingertip as a compliance: its volume over its pressure since rest. Trapped gas
//! does the same. The state of the loop is the state of a fingertip with the compliance for which both pressures are equal. The
//! solver searches for this compliance, and solves states of neighbouring compliances from one another.

mod curve;
mod edge;
mod limit;

pub use curve::LoopCurve;
pub use limit::LoopLimit;

use super::{Fingertip, Kind, ModelError};
use crate::curve::Contact;
use crate::design::Design;
use crate::design_file::{DesignFile, ModelSection};
use crate::limit::EndsBy;
use crate::membrane::TensionField;
use crate::membrane::adapt::Resolution;
use crate::membrane::press;
use crate::solid;
use crate::solid::disc::{Disc, DiscError, DiscState};
use crate::solid::gas::TrappedGas;
use crate::solid::inflation::mid_surface;
use crate::solid::mesh::Elements;
use crate::solid::section::WallPoint;
use edge::Edge;
use std::fmt;

/// Accuracy of the compliance, relative: a solid has its pressure to some 1e-8.
const TOLERANCE: f64 = 1e-7;
/// Accuracy that is enough where rounding leaves no better one: at the lightest touches.
const ROUNDED: f64 = 1e-5;
/// Part of the disc's volume by which a sum of its compliances may be off a finer one, and off the volume where that has the digits, to be
/// taken for it. The compliances themselves are right to 1e-5.
const SMOOTH: f64 = 1e-4;
/// Part of its wall's volume from which on the volume that a disc has taken has more digits than [`SMOOTH`] asks: both volumes are right to some 1e-9 of
/// that.
const COUNTED: f64 = 1e-4;
/// Part by which the sum of two compliances may be off the volume for a third one to be looked at, from this part of the pressure on.
const ABOUT: f64 = 1e-2;
const LIGHT: f64 = 0.05;
/// Iterations after which there is no balance: doublings, then halvings of a bracket.
const MAX_ITERATIONS: u32 = 80;
/// Steps on the way from rest to a state that was not found at once.
const WAY: u32 = 8;

/// Why the loop gives no answer.
#[derive(Clone, Debug, PartialEq)]
pub enum LoopError {
    /// Of the fingertip.
    Fingertip(ModelError),
    /// Of the actuator, at the pressure of the rest state.
    Actuator(DiscError),
    /// The design has no actuator, or only the paper's formula of one.
    NoActuator,
    /// At no pressure that the actuator stands do both have the fluid's volume.
    NoBalance {
        /// The indentation, metres.
        asked: f64,
        /// The least pressure at which the actuator failed, and why, if it did.
        failed: Option<DiscError>,
        /// What ends the press of a fingertip of some compliance in between, if it ends before.
        tip: Option<EndsBy>,
    },
    /// The indentation lies beyond the end of the loop.
    BeyondLimit {
        /// What was asked for, metres.
        asked: f64,
        /// The end, metres.
        limit: f64,
        /// What ends, in a word.
        ends_by: &'static str,
    },
    /// The actuator presses from some state of the press on, and tables are of forces from rest on.
    Apart {
        /// The last pressure rise without a force, pascals.
        rise: f64,
    },
}

impl fmt::Display for LoopError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Fingertip(error) => error.fmt(f),
            Self::Actuator(error) => write!(f, "at the rest pressure of the fingertip: {error}"),
            Self::NoActuator => f.write_str(
                "the loop needs the actuator as a disc: give [actuator] diameter_mm and thickness_mm",
            ),
            Self::NoBalance { asked, .. } => write!(
                f,
                "fingertip and actuator do not balance at indentation {} mm ({}); press less deep, or take a stiffer actuator",
                asked * 1e3,
                self.word()
            ),
            Self::BeyondLimit {
                asked,
                limit,
                ends_by,
            } => write!(
                f,
                "indentation {} mm is beyond the limit of {:.3} mm, below which fingertip and actuator do not balance ({ends_by}); \
                 ask for less, or take a stiffer actuator",
                asked * 1e3,
                limit * 1e3
            ),
            Self::Apart { rise } => write!(
                f,
                "the actuator does not reach what is over it up to a pressure rise of {rise:.1} Pa, and its force has tables only                  where it presses from the first touch on; set actuator.gap_mm to 0, or leave actuator.thickness_mm out"
            ),
        }
    }
}

impl std::error::Error for LoopError {}

impl From<ModelError> for LoopError {
    fn from(error: ModelError) -> Self {
        Self::Fingertip(error)
    }
}

/// A state of the loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopState {
    /// Of the fingertip: indentation, pressure rise and force of the touch.
    pub touch: Contact,
    /// Of the actuator, at the same pressure.
    pub actuator: DiscState,
    /// Fluid that the actuator has taken since rest, cubic metres.
    pub volume_moved: f64,
    /// By how much trapped gas has become smaller since rest, cubic metres.
    pub gas_compressed: f64,
    /// The compliance of a fingertip alone that has the same state, cubic metres per pascal.
    pub compliance: f64,
}

impl LoopState {
    /// Force that the actuator presses with over that of the touch; `None` where nothing touches.
    pub fn transmission(&self) -> Option<f64> {
        (self.touch.force > 0.0).then(|| self.actuator.force / self.touch.force)
    }
}

/// Fingertip and actuator at rest.
#[derive(Clone, Debug)]
pub struct Loop {
    kind: Kind,
    design: Design,
    rest_pressure: f64,
    actuator: Disc,
    actuator_at_rest: DiscState,
    gas: TrappedGas,
    /// The compliance of the latest state.
    compliance: f64,
    /// A fingertip of about that compliance, pressed.
    near: Option<Box<Fingertip>>,
    /// Of the fingertip, where it is a membrane.
    resolution: Resolution,
}

impl Loop {
    /// A fingertip whose semi-axes are those that its model takes (of the middle of a membrane, of the outer surface of a solid), and an actuator.
    ///
    /// # Errors
    /// [`LoopError::Fingertip`], [`LoopError::Actuator`].
    pub fn new(kind: Kind, design: &Design, mut actuator: Disc) -> Result<Self, LoopError> {
        let rest_pressure = fingertip(kind, design, press::FULL)?.rest_pressure();
        let actuator_at_rest = actuator
            .at_pressure(rest_pressure.max(0.0))
            .map_err(LoopError::Actuator)?;
        Ok(Self {
            kind,
            design: *design,
            rest_pressure,
            actuator,
            compliance: design.compliance + actuator_at_rest.compliance,
            actuator_at_rest,
            gas: TrappedGas::NONE,
            near: None,
            resolution: press::FULL,
        })
    }

    /// The loop of a design with `[actuator] thickness_mm`, its fingertip of this model and its disc of these elements; `None` of one without.
    ///
    /// # Errors
    /// As [`Loop::new`].
    pub fn of_file(file: &DesignFile, kind: Kind, elements: Elements) -> Result<Option<Self>, LoopError> {
        let Some(disc) = file.disc() else {
            return Ok(None);
        };
        let mut design = file.design();
        if kind == Kind::Membrane && file.model != ModelSection::Membrane {
            design.membrane = mid_surface(&design.membrane);
        }
        let actuator = Disc::new(&disc, elements).map_err(LoopError::Actuator)?;
        Ok(Some(
            Self::new(kind, &design, actuator)?.with_gas(file.trapped_gas()),
        ))
    }

    /// The same with a fingertip on another mesh, where it is a membrane.
    #[must_use]
    pub fn with_resolution(mut self, resolution: Resolution) -> Self {
        self.resolution = resolution;
        self
    }

    /// The same with gas in the line.
    #[must_use]
    pub fn with_gas(mut self, gas: TrappedGas) -> Self {
        self.gas = gas;
        self.compliance = self.constant_compliance();
        self
    }

    /// Gauge pressure at rest, pascals.
    pub fn rest_pressure(&self) -> f64 {
        self.rest_pressure
    }

    /// The compliance at rest of actuator, gas and tubing, cubic metres per pascal.
    pub fn constant_compliance(&self) -> f64 {
        self.design.compliance
            + self.actuator_at_rest.compliance
            + self.gas.compliance(self.rest_pressure.max(0.0))
    }

    /// The actuator at rest.
    pub fn actuator_at_rest(&self) -> &DiscState {
        &self.actuator_at_rest
    }

    /// The touch of a fingertip with a constant compliance in the loop's place: [`Loop::constant_compliance`].
    ///
    /// # Errors
    /// [`ModelError`] of the fingertip.
    pub fn with_constant_compliance(&self, indentation: f64) -> Result<Contact, ModelError> {
        self.alone(self.constant_compliance())?.contact_at(indentation)
    }

    /// The fingertip alone with the same state: its compliance replaces actuator, gas and tubing.
    ///
    /// # Errors
    /// [`ModelError`] of the fingertip.
    pub fn fingertip_of(&self, state: &LoopState) -> Result<Fingertip, ModelError> {
        self.alone(state.compliance)
    }

    /// The meridian of the actuator in a state, as [`Disc::profile`].
    ///
    /// # Errors
    /// [`DiscError`].
    pub fn actuator_profile(
        &mut self,
        state: &LoopState,
        points: usize,
    ) -> Result<Vec<WallPoint>, DiscError> {
        self.actuator.profile(state.actuator.pressure, points)
    }

    fn alone(&self, compliance: f64) -> Result<Fingertip, ModelError> {
        let design = Design {
            compliance,
            ..self.design
        };
        fingertip(self.kind, &design, self.resolution)
    }

    /// The touch of a fingertip of this compliance: from a state of nearly the same, or else along the path from rest.
    fn touch(&mut self, indentation: f64, compliance: f64) -> Result<Contact, ModelError> {
        if let Some(near) = &mut self.near
            && let Ok(Some(contact)) = near.contact_with_compliance(indentation, compliance)
        {
            return Ok(contact);
        }
        let mut own = self.alone(compliance)?;
        let contact = own.contact_at(indentation)?;
        self.near = Some(Box::new(own));
        Ok(contact)
    }

    /// The loop with a fingertip of this compliance.
    fn state(&mut self, touch: Contact, compliance: f64) -> Result<LoopState, DiscError> {
        let pressure = (self.rest_pressure + touch.pressure_rise).max(0.0);
        let actuator = self.actuator.at_pressure(pressure)?;
        Ok(LoopState {
            touch,
            actuator,
            volume_moved: self.moved(&actuator)?,
            gas_compressed: self.gas.compressed(pressure) - self.gas.compressed(self.rest_pressure.max(0.0)),
            compliance,
        })
    }

    /// Fluid that the actuator has taken since rest. Where it has hardly bulged the difference of two volumes has few digits, and the compliance
    /// summed over the pressure, by Simpson's rule, has all.
    fn moved(&mut self, actuator: &DiscState) -> Result<f64, DiscError> {
        let at_rest = self.actuator_at_rest;
        let rise = actuator.pressure - at_rest.pressure;
        let difference = actuator.volume - at_rest.volume;
        let ends = at_rest.compliance + actuator.compliance;
        let trapezium = 0.5 * rise * ends;
        let is_light = rise < LIGHT * actuator.pressure;
        if !is_light && (trapezium - difference).abs() > ABOUT * difference.abs() {
            return Ok(difference);
        }
        let middle = self.actuator.at_pressure(at_rest.pressure + 0.5 * rise)?;
        let simpson = rise / 6.0 * (ends + 4.0 * middle.compliance);
        let is_off = |other: f64| (other - simpson).abs() > SMOOTH * simpson.abs();
        let is_counted = difference.abs() > COUNTED * self.actuator.wall_volume();
        // Two sums may agree by chance.
        let is_smooth = !(is_off(trapezium) || is_counted && is_off(difference));
        Ok(if is_smooth { simpson } else { difference })
    }

    /// The state at an indentation of the fingertip in metres, 0 ..= limit: from the latest state, or else over states from rest on.
    ///
    /// # Errors
    /// [`LoopError`].
    pub fn at_indentation(&mut self, indentation: f64) -> Result<LoopState, LoopError> {
        let direct = self.search(indentation);
        if !matches!(&direct, Err(error) if error.is_end()) {
            return direct;
        }
        let mut from_rest = self.at_rest();
        for step in 1..WAY {
            if from_rest
                .search(indentation * f64::from(step) / f64::from(WAY))
                .is_err()
            {
                return direct;
            }
        }
        let found = from_rest.search(indentation);
        if found.is_err() {
            return direct;
        }
        *self = from_rest;
        found
    }

    /// The same before anything was solved.
    fn at_rest(&self) -> Self {
        Self {
            compliance: self.constant_compliance(),
            near: None,
            ..self.clone()
        }
    }

    /// The state at an indentation, from the compliance of the latest.
    fn search(&mut self, indentation: f64) -> Result<LoopState, LoopError> {
        // Where the actuator takes more than the compliance stands for (or does not stand the pressure), more is needed; else less.
        let (mut low, mut high) = (self.design.compliance, f64::INFINITY);
        let mut compliance = self.compliance;
        let mut before: Option<[f64; 2]> = None;
        let mut failed = None;
        let mut nearest: Option<(f64, LoopState)> = None;
        let mut edge = Edge::default();
        for _ in 0..MAX_ITERATIONS {
            let touch = match self.touch(indentation, compliance) {
                Ok(touch) => touch,
                Err(error) => {
                    let stiffest = self.design.compliance;
                    compliance = edge.without(error, compliance, stiffest, [&mut low, &mut high])?;
                    if edge.is_at([low, high]) {
                        break;
                    }
                    before = None;
                    continue;
                }
            };
            if touch.pressure_rise <= 0.0 {
                return self.state(touch, compliance).map_err(LoopError::Actuator);
            }
            let mut next = None;
            match self.state(touch, compliance) {
                Ok(state) => {
                    let taken = state.volume_moved + state.gas_compressed;
                    let needed = self.design.compliance + taken / touch.pressure_rise;
                    let excess = needed - compliance;
                    if excess.abs() <= TOLERANCE * needed {
                        self.compliance = compliance;
                        return Ok(state);
                    }
                    let off = excess.abs() / needed;
                    if nearest.is_none_or(|(least, _)| off < least) {
                        nearest = Some((off, state));
                    }
                    if excess > 0.0 {
                        low = compliance;
                    } else {
                        high = compliance;
                    }
                    edge.found(excess > 0.0);
                    // The secant through the last two, or what is needed at the pressure of now.
                    next = Some(match before {
                        Some([c, e]) if (e - excess).abs() > 0.0 => {
                            compliance - excess * (compliance - c) / (excess - e)
                        }
                        _ => needed,
                    });
                    before = Some([compliance, excess]);
                }
                Err(error) => {
                    low = compliance;
                    edge.found(true);
                    failed = Some(error);
                }
            }
            if edge.is_at([low, high]) || high.is_finite() && high - low <= TOLERANCE * high {
                break;
            }
            let middle = if high.is_finite() {
                0.5 * (low + high)
            } else {
                2.0 * compliance
            };
            compliance = next.filter(|next| *next > low && *next < high).unwrap_or(middle);
        }
        match nearest {
            Some((off, state)) if off <= ROUNDED => Ok(state),
            _ => Err(LoopError::NoBalance {
                asked: indentation,
                failed,
                tip: edge.tip,
            }),
        }
    }
}

fn fingertip(kind: Kind, design: &Design, resolution: Resolution) -> Result<Fingertip, ModelError> {
    Ok(match kind {
        Kind::Membrane => {
            let press = press::Press::with_resolution(design, TensionField::Relaxed, resolution)?;
            Fingertip::Membrane(Box::new(press))
        }
        Kind::Solid(elements) => Fingertip::Solid(Box::new(solid::press::Press::new(design, elements)?)),
    })
}
