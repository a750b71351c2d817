//! The design of this image, as the build script solved and wrote it.

use crate::signal::design::Parameters;
use model_tables::constants::DesignConstants;
use model_tables::units::PressureRise;

#[macro_use]
mod folded;

/// The build script's words.
#[allow(clippy::unreadable_literal)] // nobody reads them
pub mod generated {
    include!(concat!(env!("OUT_DIR"), "/design.rs"));
}
use generated::{DESIGN, TABLES};

/// Whether the design has an `[object]`.
pub const HAS_OBJECT: bool = cfg!(object);

#[cfg(object)]
#[macro_use]
mod object;

/// What the firmware runs on.
#[cfg(object)]
pub type FirmwareDesign = ObjectDesign;

/// What the firmware runs on.
#[cfg(not(object))]
pub type FirmwareDesign = ImageDesign;

const PARAMETERS: Parameters = Parameters::of(
    DESIGN,
    TABLES.layout.fraction_bits,
    PressureRise(TABLES.layout.maximum),
);

/// The design with what only some have beside its tables.
macro_rules! image_design {
    ($wall:ident) => {
        folded_design!(ImageDesign, generated, $wall, PARAMETERS, {
            #[cfg(feedback_tables)]
            #[inline]
            fn feedback(&self, rise: PressureRise) -> Option<model_tables::units::Micronewtons> {
                Some(generated::FEEDBACK.lookup(&TABLES.layout, rise))
            }
        });
    };
}

#[cfg(not(relaxation))]
image_design!(elastic);
#[cfg(relaxation)]
image_design!(relaxing);

#[cfg(object)]
object_design!(ObjectDesign, ImageDesign, generated);

impl ImageDesign {
    /// The same, to begin with.
    #[cfg(not(object))]
    pub const fn start() -> Self {
        Self
    }

    /// The design beside its tables.
    pub const CONSTANTS: DesignConstants = DESIGN;
}
