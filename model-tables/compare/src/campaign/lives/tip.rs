//! The fingertips that live: one of each kind of transducer, with straight lines for tables.

use fingertip::signal::design::{Design, Parameters};
use fingertip::signal::wall::Elastic;
use fingertip::signal::zero::surroundings::Surroundings;
use model_tables::constants::{DesignConstants, Quantity, Transducer, TransducerKind, ZeroAssumptions};
use model_tables::table::Reading;
use model_tables::units::{Micronewtons, Nanometres, PressureRise};

/// `k` of the unit of pressures, `1 / 2^k` pascal.
pub const FRACTION_BITS: u32 = 8;
/// Gauge pressure at rest, pascals.
pub const REST: i32 = 1_000;
/// The largest press over it, pascals.
pub const LARGEST_PRESS: i32 = 10_000;

/// What a transducer is called, and what it is.
pub const TRANSDUCERS: [(&str, Transducer); 5] = [
    ("ratiometric gauge", ANALOGUE),
    (
        // NXP MPX4250A: 4 to 96 % of the supply.
        "ratiometric absolute",
        Transducer {
            range: [20_000, 250_000],
            quantity: Quantity::Absolute,
            kind: TransducerKind::Ratiometric {
                output: [2_621, 62_915],
                supply_measured: false,
            },
            ..ANALOGUE
        },
    ),
    (
        "abp2",
        Transducer {
            kind: TransducerKind::Abp2 {
                address: 0x28,
                counts: [1_677_722, 15_099_494],
            },
            ..ANALOGUE
        },
    ),
    (
        "ms5837-02ba",
        Transducer {
            range: [1_000, 200_000],
            quantity: Quantity::Absolute,
            kind: TransducerKind::Ms5837 { address: 0x76 },
            ..ANALOGUE
        },
    ),
    (
        "dps310",
        Transducer {
            range: [30_000, 120_000],
            quantity: Quantity::Absolute,
            kind: TransducerKind::Dps310 { address: 0x77 },
            ..ANALOGUE
        },
    ),
];

/// NXP MPX5100.
const ANALOGUE: Transducer = Transducer {
    range: [0, 100_000],
    resolution: 10_000,
    noise: 5_000,
    quantity: Quantity::Gauge,
    kind: TransducerKind::Ratiometric {
        output: [2_621, 61_604],
        supply_measured: false,
    },
};

/// A micronewton and a nanometre for each count.
#[derive(Clone, Copy, Debug)]
pub struct Tip(Parameters);

impl Tip {
    /// With this transducer, and what its design states of its zero.
    pub const fn new(transducer: Transducer, zero: ZeroAssumptions) -> Self {
        let constants = DesignConstants {
            hash: 1,
            table_version: 1,
            certificate: 1,
            rest_pressure: REST,
            maximum_pressure: REST + LARGEST_PRESS,
            transducer,
            zero,
        };
        Self(Parameters::of(
            constants,
            FRACTION_BITS,
            PressureRise(LARGEST_PRESS << FRACTION_BITS),
        ))
    }
}

impl Design for Tip {
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
