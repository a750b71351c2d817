//! One interface for both models, and the choice of the model that a design needs.
//!
//! [`choice`] implements `kind = "auto"`; [`state`] has the quantities of a state of either model.

use crate::curve::{Contact, Curve, CurveFailure};
use crate::design::{Design, RestBy};
use crate::design_file::{Axes, DesignFile, ModelSection};
use crate::limit::Limit;
use crate::membrane::TensionField;
use crate::membrane::adapt::Resolution;
use crate::membrane::press;
use crate::solid;
use crate::solid::inflation::mid_surface;
use crate::solid::mesh::Elements;
use std::fmt;

pub mod choice;
mod error;
pub mod feedback;
mod inflation;
pub mod mesh_error;
pub mod own_error;
pub mod state;

pub use error::ModelError;

/// A model of a fingertip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The membrane, relaxed.
    Membrane,
    /// The solid, of so many elements.
    Solid(Elements),
}

impl Kind {
    /// Whether it can answer for a design. A membrane has no unstretched state, and it slides on the base as it is inflated.
    pub fn applies(self, design: &Design) -> bool {
        self != Self::Membrane || matches!(design.rest, RestBy::PoleStretch(_))
    }

    /// A solid of an element more through the wall and 8 for 5 along it, as [`choice::REFINED`] to [`choice::FINE`]; a membrane is the same, on a finer
    /// mesh.
    #[must_use]
    pub fn finer(self) -> Self {
        match self {
            Self::Membrane => Self::Membrane,
            Self::Solid(elements) => Self::Solid(elements.finer()),
        }
    }

    /// Whether it is a solid of fewer elements along the meridian than [`choice::FINE`].
    pub fn is_coarse(self) -> bool {
        matches!(self, Self::Solid(Elements { along, .. }) if along < choice::FINE.along)
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Membrane => write!(f, "membrane"),
            Self::Solid(Elements { through, along }) => write!(f, "solid {through} x {along}"),
        }
    }
}

/// A fingertip at rest, ready to be pressed.
#[derive(Clone, Debug)]
pub enum Fingertip {
    /// The membrane, relaxed.
    Membrane(Box<press::Press>),
    /// The solid.
    Solid(Box<solid::press::Press>),
}

impl Fingertip {
    /// Inflates a design to its rest state, of the model that it names.
    ///
    /// # Errors
    /// [`ModelError`] where there is none.
    pub fn new(file: &DesignFile) -> Result<Self, ModelError> {
        Self::with_resolution(file, press::FULL)
    }

    /// The same, on the mesh [`press::CURVE`] if it is a membrane's: twice as fast, for curves.
    ///
    /// # Errors
    /// [`ModelError`] where there is none.
    pub fn for_curve(file: &DesignFile) -> Result<Self, ModelError> {
        Self::with_resolution(file, press::CURVE)
    }

    fn with_resolution(file: &DesignFile, resolution: Resolution) -> Result<Self, ModelError> {
        let design = file.design();
        match file.model {
            ModelSection::Membrane => Ok(Self::Membrane(Box::new(press::Press::with_resolution(
                &design,
                TensionField::Relaxed,
                resolution,
            )?))),
            ModelSection::Solid { through, along } => {
                let elements = Elements {
                    through: through as usize,
                    along: along as usize,
                };
                Self::of(Kind::Solid(elements), &design)
            }
            ModelSection::Auto => Ok(choice::choose(&design, &choice::Wanted::of(file))?.fingertip),
        }
    }

    /// Inflates a design whose semi-axes are the outer surface's.
    ///
    /// # Errors
    /// [`ModelError`] where there is no rest state.
    pub fn of(kind: Kind, design: &Design) -> Result<Self, ModelError> {
        Ok(match kind {
            Kind::Membrane => {
                let membrane = mid_surface(&design.membrane);
                let design = Design { membrane, ..*design };
                Self::Membrane(Box::new(press::Press::new(&design, TensionField::Relaxed)?))
            }
            Kind::Solid(elements) => Self::Solid(Box::new(solid::press::Press::new(design, elements)?)),
        })
    }

    /// The same design and model on a finer mesh, and that mesh in words: a membrane's is twice as fine, a solid's has an element
    /// more through the wall and 8 for 5 along it.
    ///
    /// # Errors
    /// [`ModelError`] where it has no rest state.
    pub fn finer(&self, file: &DesignFile) -> Result<(Self, String), ModelError> {
        match self {
            Self::Membrane(_) => {
                let design = file.design_to(Axes::Mid);
                let press = press::Press::with_resolution(&design, TensionField::Relaxed, press::FINER)?;
                Ok((Self::Membrane(Box::new(press)), "a mesh twice as fine".to_owned()))
            }
            Self::Solid(_) => {
                let kind = self.kind().finer();
                Ok((Self::of(kind, &file.design_to(Axes::Outer))?, kind.to_string()))
            }
        }
    }

    /// Which model it is.
    pub fn kind(&self) -> Kind {
        match self {
            Self::Membrane(_) => Kind::Membrane,
            Self::Solid(press) => Kind::Solid(press.elements()),
        }
    }

    /// Gauge pressure at rest, pascals.
    pub fn rest_pressure(&self) -> f64 {
        self.rest().pressure
    }

    /// Pressure rise and force at an indentation in metres, 0 ..= limit.
    ///
    /// # Errors
    /// [`ModelError`], as the model's own.
    pub fn contact_at(&mut self, indentation: f64) -> Result<Contact, ModelError> {
        match self {
            Self::Membrane(press) => Ok(press.contact_at(indentation)?),
            Self::Solid(press) => Ok(press.contact_at(indentation)?),
        }
    }

    /// The same of a design with another compliance, cubic metres per pascal, from the state of its own; `None` where that one is too far off.
    ///
    /// # Errors
    /// [`ModelError`], as the model's own.
    pub fn contact_with_compliance(
        &mut self,
        indentation: f64,
        compliance: f64,
    ) -> Result<Option<Contact>, ModelError> {
        match self {
            Self::Membrane(press) => Ok(press.contact_with_compliance(indentation, compliance)?),
            Self::Solid(press) => Ok(press.contact_with_compliance(indentation, compliance)?),
        }
    }

    /// The end of the press.
    ///
    /// # Errors
    /// [`ModelError`] if the way there fails.
    pub fn limit(&mut self) -> Result<Limit, ModelError> {
        match self {
            Self::Membrane(press) => Ok(press.limit()?),
            Self::Solid(press) => Ok(press.limit()?),
        }
    }

    /// The curve of a press down to `deepest`, metres.
    ///
    /// # Errors
    /// [`CurveFailure`] if a state is missing, or pressure or force do not grow throughout.
    pub fn curve(&mut self, deepest: f64) -> Result<Curve, CurveFailure<ModelError>> {
        match self {
            Self::Membrane(press) => press.curve(deepest).map_err(CurveFailure::of),
            Self::Solid(press) => press.curve(deepest).map_err(CurveFailure::of),
        }
    }
}
