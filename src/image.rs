//! The design this image is built for: what the build script solved and wrote.

use crate::signal::design::Design;
use model_tables::constants::DesignConstants;
use model_tables::table::Reading;
use model_tables::units::PressureRise;

/// The build script's words.
#[allow(clippy::unreadable_literal)] // nobody reads them
pub mod generated {
    include!(concat!(env!("OUT_DIR"), "/design.rs"));
}
use generated::{DESIGN, TABLES};

/// The design of the image.
#[derive(Clone, Copy, Debug)]
pub struct ImageDesign;

impl Design for ImageDesign {
    const CONSTANTS: DesignConstants = DESIGN;

    const PRESSURE_FRACTION_BITS: u32 = TABLES.layout.pressure_fraction_bits;

    const LAST_RISE: PressureRise = PressureRise(TABLES.layout.maximum);

    #[inline]
    fn lookup(rise: PressureRise) -> Reading {
        TABLES.lookup(rise)
    }
}
