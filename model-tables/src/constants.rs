//! The constants of a design that the firmware needs besides the tables: integers in stated units.

use crate::units::PressureRise;

/// Constants of the design that tables were generated for; written by the generator next to them.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct DesignConstants {
    /// First eight bytes, big-endian, of the SHA-256 of the design's canonical text.
    pub hash: u64,
    /// Version of the tables' layout and of the generator.
    pub table_version: u32,
    /// First eight bytes, big-endian, of the SHA-256 of the tables' certificate.
    pub certificate: u64,
    /// Gauge pressure at rest, pascals.
    pub rest_pressure: i32,
    /// Gauge pressure at the end of the tables, pascals.
    pub maximum_pressure: i32,
    /// The pressure transducer.
    pub transducer: Transducer,
    /// What may move the zero beside a press.
    pub zero: ZeroAssumptions,
}

/// What a design states of its zero, `[zero]` and `[air]`: none is below 0, and 0 is what nothing was stated of.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct ZeroAssumptions {
    /// Drift of the transducer's offset at a steady temperature, millipascals an hour; 0: what the firmware takes for its kind.
    pub drift: i32,
    /// How far a kelvin moves the offset that is left after compensation, millipascals.
    pub per_kelvin: i32,
    /// From one attitude of the hand to another, the weight of the fluid column, millipascals.
    pub fluid_head: i32,
    /// What a press leaves for good, millipascals.
    pub hysteresis: i32,
    /// What a press leaves for a while, until the wall has crept back, millipascals.
    pub creep: i32,
    /// Largest bound of the zero of an ok reading, millipascals; 0: six noise floors.
    pub bound: i32,
    /// Who measures the air around an absolute transducer.
    pub air: AirReference,
}

impl ZeroAssumptions {
    /// Nothing is stated.
    pub const NONE: Self = Self {
        drift: 0,
        per_kelvin: 0,
        fluid_head: 0,
        hysteresis: 0,
        creep: 0,
        bound: 0,
        air: AirReference::None,
    };
}

/// Who measures the air around an absolute transducer.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum AirReference {
    /// Nobody: the weather is in the bound of the zero.
    None,
    /// The host, which tells the board with the command `air`.
    Host,
    /// A second transducer.
    Part,
}

/// The thinnest and the densest air around a hand, pascals absolute. 60 kPa is a little below the standard atmosphere at
/// 4000 m (61.6 kPa, ISO 2533); 108 kPa is a high at sea level of which there are few a century (the highest on record
/// below 750 m is 108.4 kPa, WMO World Weather and Climate Extremes Archive).
pub const AIR: [i32; 2] = [60_000, 108_000];

/// How far a part that does not tell its temperature may warm or cool while its zero is used, kelvins: between a room and a hand.
pub const UNSEEN_KELVINS: i32 = 10;

/// What a transducer measures against.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Quantity {
    /// Against the air around it.
    Gauge,
    /// Against a vacuum: the air is in it, within [`AIR`], and the zero has to take it out. 1 hPa of weather or 8 m of
    /// stairs read as 100 Pa.
    Absolute,
}

/// Standard deviations of one sample below zero that noise is believed to explain: filtered white noise gets there
/// less than once in 10^30 reports.
pub const BELOW_ZERO_DEVIATIONS: i64 = 8;

/// The pressure transducer of a design.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Transducer {
    /// Pressure at the lower and upper end of the part's own range, pascals, in its own quantity.
    pub range: [i32; 2],
    /// Smallest change it tells apart, millipascals.
    pub resolution: i32,
    /// One standard deviation of one sample at the converter, millipascals.
    pub noise: i32,
    /// What it measures against.
    pub quantity: Quantity,
    /// Its kind, with what only that kind has.
    pub kind: TransducerKind,
}

impl Transducer {
    /// What the transducer cannot tell apart, millipascals: its noise or its resolution, whichever is coarser.
    pub const fn noise_floor(&self) -> i64 {
        if self.noise > self.resolution {
            self.noise as i64
        } else {
            self.resolution as i64
        }
    }

    /// The same part at another address of its bus; an analogue one has none.
    #[must_use]
    pub const fn at(self, address: u8) -> Self {
        let kind = match self.kind {
            TransducerKind::Abp2 { counts, .. } => TransducerKind::Abp2 { address, counts },
            TransducerKind::Ms5837 { .. } => TransducerKind::Ms5837 { address },
            TransducerKind::Dps310 { .. } => TransducerKind::Dps310 { address },
            analogue @ TransducerKind::Ratiometric { .. } => analogue,
        };
        Self { kind, ..self }
    }

    /// The lowest rise that still reads as untouched, in counts of `1 / 2^fraction_bits` pascal: below it the
    /// firmware warns.
    pub const fn lowest_rest(&self, fraction_bits: u32) -> PressureRise {
        // Below 2^31 * 8 * 2^16 = 2^50.
        let counts = (self.noise_floor() * BELOW_ZERO_DEVIATIONS * (1 << fraction_bits) + 500) / 1000;
        PressureRise(
            -(if counts > i32::MAX as i64 {
                i32::MAX
            } else {
                counts as i32
            }),
        )
    }
}

/// Kinds of transducer.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum TransducerKind {
    /// Voltage proportional to the supply, read by the chip's converter.
    Ratiometric {
        /// Output at the two ends of the range, in `1 / 65536` of the supply, increasing.
        output: [u32; 2],
        /// Whether that supply is another than the converter's reference, and measured beside the output.
        supply_measured: bool,
    },
    /// Honeywell ABP2 on I2C.
    Abp2 {
        /// Seven-bit bus address.
        address: u8,
        /// Counts of 24 bits at the two ends of the range (transfer function A: 10 % and 90 % of 2^24;
        /// B: 30 % and 70 %).
        counts: [u32; 2],
    },
    /// TE MS5837-02BA on I2C: absolute pressure, range from its own calibration words.
    Ms5837 {
        /// Seven-bit bus address.
        address: u8,
    },
    /// Infineon DPS310 on I2C: absolute pressure, range from its own coefficients.
    Dps310 {
        /// Seven-bit bus address.
        address: u8,
    },
}

/// From one sample of a kind to the next, microseconds.
pub mod period {
    /// A block of the converter.
    pub const CONVERTER: u32 = 1_000;
    /// The part measures about 200 times a second.
    pub const ABP2: u32 = 8_000;
    /// Two conversions of it.
    pub const MS5837: u32 = 7_000;
    /// Two measurements of it.
    pub const DPS310: u32 = 14_000;
}

/// How long a part on a bus converts, microseconds.
pub mod conversion {
    /// Pressure and temperature at once (datasheet 32350268, section 5).
    pub const ABP2: u32 = 5_000;
    /// Temperature with 256 samples, and pressure with 2048 (TE, datasheet of 09/2017, "ADC": at most 0.60 and 4.54 ms).
    pub const MS5837: [u32; 2] = [600, 4_600];
    /// Temperature once, and four pressures averaged (datasheet V1.2, section 8.3, table 16).
    pub const DPS310: [u32; 2] = [3_600, 8_400];
}

/// What limits the parts of a hand on one I2C bus, microseconds.
pub mod hand_bus {
    /// Longest that one transaction takes: 21 bytes, the most that a driver reads, are 0.5 ms at 400 kHz.
    pub const OPERATION_LIMIT: u32 = 1_000;
    /// Most that freeing the bus takes after it: the multiplexers' reset, nine pulses of 10 us and a stop, and their timers.
    pub const RECOVERY: u32 = 500;
    /// Most that a part that fails takes of the bus at a time.
    pub const FAILURE: u32 = OPERATION_LIMIT + RECOVERY;
}

impl TransducerKind {
    /// From one sample, and report, to the next, microseconds.
    pub const fn period(&self) -> u32 {
        match self {
            Self::Ratiometric { .. } => period::CONVERTER,
            Self::Abp2 { .. } => period::ABP2,
            Self::Ms5837 { .. } => period::MS5837,
            Self::Dps310 { .. } => period::DPS310,
        }
    }
}
