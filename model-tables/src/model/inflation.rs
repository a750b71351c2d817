//! The rest state of a solid that is given by its pole stretch: the one that the membrane in the middle of its wall reaches.

use super::ModelError;
use crate::design::{Design, RestBy};
use crate::membrane::TensionField;
use crate::membrane::press::{MembraneError, Press};
use crate::object::Object;
use crate::solid;
use crate::solid::inflation::{FreeRest, mid_surface};
use crate::solid::mesh::Elements;

/// What the membrane in the middle of a design's wall inflates to.
fn free_rest(design: &Design, stretch: f64) -> Result<FreeRest, MembraneError> {
    let membrane = Design {
        membrane: mid_surface(&design.membrane),
        rest: RestBy::PoleStretch(stretch),
        object: Object::PLATE,
        ..*design
    };
    let mut press = Press::new(&membrane, TensionField::Relaxed)?;
    let rest = *press.rest();
    let thinning = press
        .profile(0.0, 3)?
        .last()
        .map_or(1.0, |edge| 1.0 / (edge.meridional_stretch * edge.hoop_stretch));
    Ok(FreeRest {
        edge_radius: rest.edge_radius,
        height: rest.height,
        volume: rest.volume,
        thinning,
    })
}

impl solid::press::Press {
    /// Inflates a design to its rest state. The semi-axes of `design.membrane` are those of the outer surface here.
    ///
    /// # Errors
    /// [`ModelError`] of the solid, and of the membrane where the rest state is given by the pole stretch.
    pub fn new(design: &Design, elements: Elements) -> Result<Self, ModelError> {
        Self::inflate(design, elements, |stretch| Ok(free_rest(design, stretch)?))
    }
}
