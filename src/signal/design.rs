//! The fingertip a signal path is built for, as a type: its constants and tables fold into the code.

use model_tables::constants::DesignConstants;
use model_tables::table::Reading;
use model_tables::units::PressureRise;

/// A design with its tables; the build script writes the one of the image.
pub trait Design {
    /// What is known of the design beside its tables.
    const CONSTANTS: DesignConstants;

    /// `k`: pressures are counted in `1 / 2^k` pascal, 0 to 16.
    const PRESSURE_FRACTION_BITS: u32;

    /// The last rise that the tables cover; beyond it they are saturated.
    const LAST_RISE: PressureRise;

    /// Force and indentation at a pressure rise. Total: every `i32` has an answer.
    fn lookup(rise: PressureRise) -> Reading;
}
