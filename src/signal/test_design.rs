//! Fingertips with straight lines for tables, so that tests can expect by hand.

use crate::signal::design::{Design, Parameters};
use crate::signal::wall::Elastic;
use crate::signal::zero::surroundings::Surroundings;
use model_tables::constants::{DesignConstants, Quantity, Transducer, TransducerKind, ZeroAssumptions};
use model_tables::table::Reading;
use model_tables::units::{Micronewtons, Nanometres, PressureRise};

/// 1 uN and 1 nm for a count of 1/256 Pa, up to the end of its tables.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Linear(Parameters);

/// 40 kPa.
pub(crate) const RISE_END: i32 = 40_000 << 8;
/// Force at the end, micronewtons.
pub(crate) const FORCE_END: i32 = RISE_END;
/// Indentation at the end, nanometres.
pub(crate) const INDENTATION_END: i32 = RISE_END;

impl Linear {
    /// Of [`Self::NEW`].
    pub(crate) const CONSTANTS: DesignConstants = DesignConstants {
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
        zero: ZeroAssumptions::NONE,
    };

    /// A count is 1/256 Pa.
    pub(crate) const PRESSURE_FRACTION_BITS: u32 = 8;

    /// Rests at 20 kPa and is pressed up to 40 kPa over rest.
    pub(crate) const NEW: Self = Self(Parameters::of(
        Self::CONSTANTS,
        Self::PRESSURE_FRACTION_BITS,
        PressureRise(RISE_END),
    ));

    /// Rests at 1 kPa and is pressed up to 10 kPa over that, with this transducer.
    pub(crate) const fn with(transducer: Transducer) -> Self {
        Self::stating(transducer, ZeroAssumptions::NONE)
    }

    /// The same, with what the design states of its zero.
    pub(crate) const fn stating(transducer: Transducer, zero: ZeroAssumptions) -> Self {
        let constants = DesignConstants {
            zero,
            rest_pressure: 1_000,
            maximum_pressure: 11_000,
            transducer,
            ..Self::CONSTANTS
        };
        let end = PressureRise(10_000 << 8);
        Self(Parameters::of(constants, Self::PRESSURE_FRACTION_BITS, end))
    }
}

impl Design for Linear {
    type Wall = Elastic;
    type Around = [Surroundings; 1];

    fn parameters(&self) -> &Parameters {
        &self.0
    }

    fn lookup(&self, rise: PressureRise) -> Reading {
        let end = self.0.last_rise.0;
        let held = rise.0.clamp(0, end);
        Reading {
            force: Micronewtons(held),
            indentation: Nanometres(held),
            saturated: rise.0 > end,
            negative: rise.0 < 0,
        }
    }
}

/// Every kind of transducer there is, and an analogue one of either quantity.
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
