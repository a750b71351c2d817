//! The design at rest in either model, ready to be pressed.

use super::kind::Kind;
use model_tables::curve::Contact;
use model_tables::design::Design;
use model_tables::material::Law;
use model_tables::membrane::TensionField;
use model_tables::membrane::adapt::Resolution;
use model_tables::membrane::press::Press;
use model_tables::model::{self, ModelError};
use model_tables::solid;
use model_tables::solid::inflation::mid_surface;

/// Gauss points an element.
const STAGES: usize = 4;
/// A mesh for fits: far finer than any bench, and no finer than differences of it need.
const MESH: Resolution = Resolution {
    density: 1.0,
    contact_elements: 1,
    tolerance: 1e-10,
    last_term: f64::INFINITY,
};

/// Either model at rest.
pub(super) enum Ready {
    Membrane(Box<Press<Law, STAGES>>),
    Solid(Box<solid::press::Press>),
}

impl Ready {
    pub(super) fn new(kind: Kind, design: &Design) -> Result<Self, ModelError> {
        let membrane = |design: &Design| {
            let press = Press::with_resolution(design, TensionField::Relaxed, MESH)?;
            Ok(Self::Membrane(Box::new(press)))
        };
        match kind {
            Kind::Membrane => membrane(design),
            Kind::Wall(model::Kind::Membrane) => membrane(&Design {
                membrane: mid_surface(&design.membrane),
                ..*design
            }),
            Kind::Wall(model::Kind::Solid(elements)) => {
                solid::press::Press::new(design, elements).map(|press| Self::Solid(Box::new(press)))
            }
        }
    }

    pub(super) fn height(&self) -> f64 {
        match self {
            Self::Membrane(press) => press.rest().height,
            Self::Solid(press) => press.rest().height,
        }
    }

    pub(super) fn contact_at(&mut self, indentation: f64) -> Result<Contact, ModelError> {
        match self {
            Self::Membrane(press) => Ok(press.contact_at(indentation)?),
            Self::Solid(press) => Ok(press.contact_at(indentation)?),
        }
    }
}
