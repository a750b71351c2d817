//! The design this image is built for: what the build script solved and wrote.

use crate::signal::design::{Design, Parameters};
use crate::signal::zero::limits::Limits;
use crate::signal::zero::surroundings::Surroundings;
use model_tables::constants::DesignConstants;
use model_tables::table::Reading;
use model_tables::units::PressureRise;

/// The build script's words.
#[allow(clippy::unreadable_literal)] // nobody reads them
pub mod generated {
    include!(concat!(env!("OUT_DIR"), "/design.rs"));
}
use generated::{DESIGN, TABLES};

/// The design of the image: no bytes, as all of it folds into the code.
#[derive(Clone, Copy, Debug)]
pub struct ImageDesign;

impl ImageDesign {
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
    type Around = [Surroundings; Self::PARAMETERS.rates.places()];

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
}
