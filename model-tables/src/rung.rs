//! Either model behind one interface: what tables are made from.

use crate::curve::{Contact, Curve};
use crate::design_file::DesignFile;
use crate::membrane::TensionField;
use crate::press::{self, CurveFailure, Limit, ModelError};
use crate::solid;

/// A fingertip at rest, ready to be pressed, of the model that its design names.
#[derive(Clone, Debug)]
pub enum Rung {
    /// The membrane, relaxed.
    Membrane(Box<press::Press>),
    /// The solid.
    Solid(Box<solid::press::Press>),
}

impl Rung {
    /// Inflates a design to its rest state.
    ///
    /// # Errors
    /// [`ModelError`] where there is none.
    pub fn new(file: &DesignFile) -> Result<Self, ModelError> {
        let design = file.design();
        Ok(match file.elements() {
            None => Self::Membrane(Box::new(press::Press::new(&design, TensionField::Relaxed)?)),
            Some(elements) => Self::Solid(Box::new(solid::press::Press::new(&design, elements)?)),
        })
    }

    /// Gauge pressure at rest, pascals.
    pub fn rest_pressure(&self) -> f64 {
        match self {
            Self::Membrane(press) => press.rest().pressure,
            Self::Solid(press) => press.rest().pressure,
        }
    }

    /// Pressure rise and force at an indentation in metres, 0 ..= limit.
    ///
    /// # Errors
    /// [`ModelError`], as the model's own.
    pub fn contact_at(&mut self, indentation: f64) -> Result<Contact, ModelError> {
        match self {
            Self::Membrane(press) => press.contact_at(indentation),
            Self::Solid(press) => press.contact_at(indentation),
        }
    }

    /// The end of the press.
    ///
    /// # Errors
    /// [`ModelError::PressUnsolved`] if the way there fails.
    pub fn limit(&mut self) -> Result<Limit, ModelError> {
        match self {
            Self::Membrane(press) => press.limit(),
            Self::Solid(press) => press.limit(),
        }
    }

    /// The curve of a press down to `deepest`, metres.
    ///
    /// # Errors
    /// [`CurveFailure`] if a state is missing, or pressure or force do not grow throughout.
    pub fn curve(&mut self, deepest: f64) -> Result<Curve, CurveFailure> {
        match self {
            Self::Membrane(press) => press.curve(deepest),
            Self::Solid(press) => press.curve(deepest),
        }
    }
}
