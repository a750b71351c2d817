//! Which model a fit solves.

use model_tables::design_file::{DesignFile, ModelSection};
use model_tables::model::{self, ModelError, choice};
use model_tables::solid::mesh::Elements;

/// The model of a design, settled once for a whole fit.
#[derive(Clone, Copy, Debug)]
pub(super) enum Kind {
    /// A membrane of the design's dimensions: what it does goes with its wall.
    Membrane,
    /// A model of an outer surface and a wall: the wall is part of the shape.
    Wall(model::Kind),
}

impl Kind {
    /// What the design names, or what `auto` chooses for it.
    ///
    /// # Errors
    /// [`ModelError`] where no model answers.
    pub(super) fn of(file: &DesignFile) -> Result<Self, ModelError> {
        Ok(match file.model {
            ModelSection::Membrane => Self::Membrane,
            ModelSection::Solid { through, along } => Self::Wall(model::Kind::Solid(Elements {
                through: through as usize,
                along: along as usize,
            })),
            ModelSection::Auto => Self::Wall(choice::choose(&file.design(), &choice::Wanted::of(file))?.kind),
        })
    }

    /// Whether a press is cheap enough to start a fit from many places.
    pub(super) fn is_cheap(self) -> bool {
        matches!(self, Self::Membrane | Self::Wall(model::Kind::Membrane))
    }
}
