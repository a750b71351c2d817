//! Fingertips with straight lines for tables, so that tests can expect by hand.

use crate::signal::design::Design;
use model_tables::constants::{DesignConstants, Quantity, Transducer, TransducerKind};
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
            quantity: Quantity::Gauge,
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

/// The transducers of [`With`]: every kind there is, and an analogue one of either quantity.
pub(crate) const TRANSDUCERS: [Transducer; 5] = [
    Linear::CONSTANTS.transducer,
    // NXP MPX4250A: Vs (0.004 P - 0.04) from 20 to 250 kPa absolute, so 4 to 96 % of the supply.
    Transducer {
        range: [20_000, 250_000],
        quantity: Quantity::Absolute,
        kind: TransducerKind::Ratiometric {
            output: [2621, 62915],
            supply_measured: false,
        },
        ..Linear::CONSTANTS.transducer
    },
    Transducer {
        kind: TransducerKind::Abp2 {
            address: 0x28,
            counts: [1_677_722, 15_099_494],
        },
        ..Linear::CONSTANTS.transducer
    },
    Transducer {
        range: [1_000, 200_000],
        quantity: Quantity::Absolute,
        kind: TransducerKind::Ms5837 { address: 0x76 },
        ..Linear::CONSTANTS.transducer
    },
    Transducer {
        range: [30_000, 120_000],
        quantity: Quantity::Absolute,
        kind: TransducerKind::Dps310 { address: 0x77 },
        ..Linear::CONSTANTS.transducer
    },
];

/// The same fingertip, at rest at 1 kPa and pressed up to 10 kPa over that, with one of the [`TRANSDUCERS`].
pub(crate) struct With<const TRANSDUCER: usize>;

impl<const TRANSDUCER: usize> Design for With<TRANSDUCER> {
    const CONSTANTS: DesignConstants = DesignConstants {
        rest_pressure: 1_000,
        maximum_pressure: 11_000,
        transducer: TRANSDUCERS[TRANSDUCER],
        ..Linear::CONSTANTS
    };

    const PRESSURE_FRACTION_BITS: u32 = Linear::PRESSURE_FRACTION_BITS;

    const LAST_RISE: PressureRise = PressureRise(10_000 << 8);

    fn lookup(rise: PressureRise) -> Reading {
        Reading {
            saturated: rise > Self::LAST_RISE,
            ..Linear::lookup(rise.min(Self::LAST_RISE))
        }
    }
}
