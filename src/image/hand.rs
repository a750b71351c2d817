//! The hand of this image, as the build script solved and wrote it: a set of tables for each design, and the tips.

use crate::device::hand::{HandNames, HandTip};
use crate::device::logic::{Beginning, Device};
use crate::signal::design::Parameters;
use crate::storage::hand_record::length;
use crate::storage::hand_store::TipIdentity;
#[cfg(transducer = "bus")]
use crate::transducer::multiplexer::BusBranch;
#[cfg(transducer = "bus")]
use crate::transducer::rounds::RoundTimes;
#[cfg(transducer = "ratiometric")]
use crate::transducer::scan::row;
use model_tables::constants::Transducer;
use model_tables::units::PressureRise;

#[macro_use]
mod folded;

/// The build script's words.
#[allow(clippy::unreadable_literal)] // nobody reads them
pub mod generated {
    include!(concat!(env!("OUT_DIR"), "/design.rs"));
}
#[cfg(transducer = "ratiometric")]
pub use generated::{CHANNELS, SCANS};
pub use generated::{NAME, PERIOD, TIPS};

/// Words of a row of the converter's ring: each scan has a code of each tip and one of the internal reference.
#[cfg(transducer = "ratiometric")]
pub const ROW: usize = row(TIPS);

/// Rows of a block.
#[cfg(transducer = "ratiometric")]
pub const ROWS: usize = SCANS * (TIPS + 1) / (2 * ROW);

/// The rows are whole scans.
#[cfg(transducer = "ratiometric")]
const _: () = assert!(2 * ROW * ROWS == SCANS * (TIPS + 1));

/// The rounds of the parts on the bus.
#[cfg(transducer = "bus")]
pub const ROUNDS: RoundTimes<TIPS> = RoundTimes {
    period: PERIOD,
    instant: generated::INSTANT[0],
    skew: generated::INSTANT[1],
    begins: generated::BEGINS,
    halves: generated::HALVES,
};

/// The branch of a multiplexer that the part of a tip is on; `None`: the bus itself.
///
/// # Panics
/// For a tip that there is not.
#[cfg(transducer = "bus")]
pub const fn branch(tip: usize) -> Option<BusBranch> {
    match generated::BRANCHES[tip] {
        Some([multiplexer, number]) => Some(BusBranch { multiplexer, number }),
        None => None,
    }
}

/// The part of a tip, at its address.
///
/// # Panics
/// For a tip that there is not.
#[cfg(transducer = "bus")]
pub const fn part(tip: usize) -> Transducer {
    TRANSDUCERS[tip].at(generated::ADDRESSES[tip])
}

/// One of so many reports goes on the line at the start: five tips that are scanned take 55 of its 100 kB/s.
pub const EVERY: u16 = if cfg!(transducer = "bus") { 1 } else { 2 };

/// Bytes of the record of their calibrations.
pub const RECORD: usize = length(TIPS);

/// No design of a hand has an `[object]`.
pub const HAS_OBJECT: bool = false;

/// What the hand and its tips are called.
pub const NAMES: HandNames<TIPS> = HandNames {
    hash: generated::HASH,
    tips: generated::TIP_NAMES,
};

/// A design of this many codes a report.
#[cfg(transducer = "ratiometric")]
macro_rules! of_hand {
    ($module:ident) => {
        Parameters::of_scan(
            generated::$module::DESIGN,
            generated::$module::TABLES.layout.pressure_fraction_bits,
            PressureRise(generated::$module::TABLES.layout.maximum),
            [PERIOD, SCANS as u32],
        )
    };
}

/// A design of a sample a round.
#[cfg(transducer = "bus")]
macro_rules! of_hand {
    ($module:ident) => {
        Parameters::of_rounds(
            generated::$module::DESIGN,
            generated::$module::TABLES.layout.pressure_fraction_bits,
            PressureRise(generated::$module::TABLES.layout.maximum),
            PERIOD,
        )
    };
}

/// The designs, and the tips with the design of each.
macro_rules! hand {
    (
        designs { $($design:ident $module:ident $wall:ident,)* }
        tips { $($tip:ident $of:ident,)* }
    ) => {
        $(folded_design!($design, generated::$module, $wall, of_hand!($module), {});)*

        /// The transducers of the tips.
        pub const TRANSDUCERS: [Transducer; TIPS] = [$($of::PARAMETERS.constants.transducer,)*];

        const TABLE_VERSIONS: [u32; TIPS] = [$($of::PARAMETERS.constants.table_version,)*];

        /// The tips.
        #[derive(Debug)]
        pub struct Tips {
            $($tip: Device<$of>,)*
        }

        impl Tips {
            /// Tips that have seen nothing yet, from what the board knows of each when it starts.
            pub fn new([$($tip,)*]: &[Beginning; TIPS]) -> Self {
                Self {
                    $($tip: Device::new($of, $tip),)*
                }
            }

            /// Each, whatever its design.
            pub fn each(&mut self) -> [&mut dyn HandTip; TIPS] {
                [$(&mut self.$tip,)*]
            }
        }
    };
}

include!(concat!(env!("OUT_DIR"), "/hand.rs"));

/// What the stored calibration of each tip is for.
pub const IDENTITIES: [TipIdentity; TIPS] = {
    let none = TipIdentity {
        hash: 0,
        table_version: 0,
        range: [0; 2],
    };
    let mut identities = [none; TIPS];
    let mut tip = 0;
    while tip < TIPS {
        identities[tip] = TipIdentity {
            hash: generated::TIP_HASHES[tip],
            table_version: TABLE_VERSIONS[tip],
            range: TRANSDUCERS[tip].range,
        };
        tip += 1;
    }
    identities
};
