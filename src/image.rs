//! The design this image is built for: what the build script solved and wrote.

use crate::signal::design::{Design, Parameters};
#[cfg(not(relaxation))]
use crate::signal::wall::Elastic;
#[cfg(relaxation)]
use crate::signal::wall::Memory;
use crate::signal::zero::limits::Limits;
use crate::signal::zero::surroundings::Surroundings;
use model_tables::constants::DesignConstants;
use model_tables::table::Reading;
#[cfg(feedback_tables)]
use model_tables::units::Micronewtons;
use model_tables::units::PressureRise;

/// The build script's words.
#[allow(clippy::unreadable_literal)] // nobody reads them
pub mod generated {
    include!(concat!(env!("OUT_DIR"), "/design.rs"));
}
#[cfg(relaxation)]
use generated::RELAXATION;
use generated::{DESIGN, TABLES};
#[cfg(relaxation)]
use model_tables::material::series::WallSeries;

/// Whether the design has an `[object]`.
pub const HAS_OBJECT: bool = cfg!(object);

#[cfg(object)]
mod object;
#[cfg(object)]
pub use object::ObjectDesign as FirmwareDesign;

/// What the firmware runs on.
#[cfg(not(object))]
pub type FirmwareDesign = ImageDesign;

/// The design of the image, against its plate: no bytes, as all of it folds into the code.
#[derive(Clone, Copy, Debug)]
pub struct ImageDesign;

impl ImageDesign {
    /// The same, to begin with.
    #[cfg(not(object))]
    pub const fn start() -> Self {
        Self
    }

    /// The design beside its tables.
    pub const CONSTANTS: DesignConstants = DESIGN;

    /// What the signal path needs of it.
    pub const PARAMETERS: Parameters = Parameters::of(
        DESIGN,
        TABLES.layout.pressure_fraction_bits,
        PressureRise(TABLES.layout.maximum),
    );
}

impl Design for ImageDesign {
    #[cfg(not(relaxation))]
    type Wall = Elastic;
    #[cfg(relaxation)]
    type Wall = Memory<{ RELAXATION.step.count }>;
    type Around = [Surroundings; Self::PARAMETERS.rates.places()];

    #[cfg(relaxation)]
    #[inline]
    fn series(&self) -> Option<&WallSeries> {
        const { Some(&RELAXATION) }
    }

    #[inline]
    fn parameters(&self) -> &Parameters {
        const { &Self::PARAMETERS }
    }

    #[inline]
    fn limits(&self) -> Limits {
        const { Self::PARAMETERS.limits }
    }

    #[inline]
    fn lookup(&self, rise: PressureRise) -> Reading {
        TABLES.lookup(rise)
    }

    #[cfg(feedback_tables)]
    #[inline]
    fn feedback(&self, rise: PressureRise) -> Option<Micronewtons> {
        Some(generated::FEEDBACK.lookup(&TABLES.layout, rise))
    }
}
