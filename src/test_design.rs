//! A fingertip with straight lines for tables, so that tests can expect by hand.

use crate::design::Design;
use model_tables::constants::{DesignConstants, Transducer, TransducerKind};
use model_tables::table::Reading;
use model_tables::units::{Micronewtons, Nanometres, PressureRise};

/// Rests at 20 kPa; 1 uN and 1 nm for a count of 1/256 Pa, up to 40 kPa over rest.
pub(crate) struct Linear;

/// 40 kPa.
pub(crate) const RISE_END: i32 = 40_000 << 8;
/// Force at the end, micronewtons.
pub(crate) const FORCE_END: i32 = RISE_END;
/// Indentation at the end, nanometres.
pub(crate) const INDENTATION_END: i32 = RISE_END;

impl Design for Linear {
    const CONSTANTS: DesignConstants = DesignConstants {
        name: "linear",
        hash: 1,
        table_version: 1,
        certificate: 2,
        rest_pressure: 20_000,
        maximum_pressure: 60_000,
        transducer: Transducer {
            range: [0, 100_000],
            resolution: 10_000,
            noise: 5_000,
            kind: TransducerKind::Ratiometric {
                output: [2621, 61604],
                supply_measured: false,
            },
        },
    };

    const PRESSURE_FRACTION_BITS: u32 = 8;

    const LAST_RISE: PressureRise = PressureRise(RISE_END);

    fn lookup(rise: PressureRise) -> Reading {
        let held = rise.0.clamp(0, RISE_END);
        Reading {
            force: Micronewtons(held),
            indentation: Nanometres(held),
            saturated: rise.0 > RISE_END,
            negative: rise.0 < 0,
        }
    }
}
