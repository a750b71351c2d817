//! The hand of this image, as the build script solved and wrote it: a set of tables for each design, and the tips.

use crate::device::hand::{HandNames, HandTip};
use crate::device::logic::{Beginning, Device};
#[cfg(feature = "load-tip")]
use crate::signal::design::Design;
use crate::signal::design::Parameters;
#[cfg(feature = "load-tip")]
use crate::signal::loaded_design::LoadedDesign;
#[cfg(feature = "load-tip")]
use crate::signal::tip_design::TipDesign;
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
#[cfg(object)]
#[macro_use]
mod object;

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

/// Whether a design of a tip has an `[object]`.
pub const HAS_OBJECT: bool = cfg!(object);

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
            generated::$module::TABLES.layout.fraction_bits,
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
            generated::$module::TABLES.layout.fraction_bits,
            PressureRise(generated::$module::TABLES.layout.maximum),
            PERIOD,
        )
    };
}

/// A design against its plate, or with an `[object]` too.
macro_rules! touching {
    (plate $design:ident $plate:ident $module:ident $wall:ident) => {
        folded_design!($design, generated::$module, $wall, of_hand!($module), {});

        impl $design {
            /// The same, to begin with.
            fn start() -> Self {
                Self
            }
        }
    };
    (object $design:ident $plate:ident $module:ident $wall:ident) => {
        folded_design!($plate, generated::$module, $wall, of_hand!($module), {});
        object_design!($design, $plate, generated::$module);
    };
}

/// A tip's design: the one of the image.
#[cfg(not(feature = "load-tip"))]
type OfTip<D> = D;

/// A tip's design: the one of the image, or one that was loaded.
#[cfg(feature = "load-tip")]
type OfTip<D> = TipDesign<'static, D>;

/// What the tips begin with, in their order.
#[derive(Clone, Copy, Debug)]
pub struct HandStart<'a> {
    /// What the board knows of each.
    pub beginnings: &'a [Beginning; TIPS],
    /// The loaded designs in use; `None`: the image's own is.
    #[cfg(feature = "load-tip")]
    pub loaded: &'a [Option<&'static LoadedDesign<'static>>; TIPS],
}

/// A tip that has seen nothing yet, with the design that it begins with.
macro_rules! first_device {
    ($of:ident, $beginning:ident, $loaded:ident) => {{
        #[cfg(not(feature = "load-tip"))]
        {
            Device::new($of::start(), $beginning)
        }
        #[cfg(feature = "load-tip")]
        first_device($of::start, $loaded.next().copied().flatten(), $beginning)
    }};
}

// Its frame holds copies of the design: once, and not once a tip.
#[cfg(feature = "load-tip")]
#[inline(never)]
fn first_device<D: Design>(
    image: fn() -> D,
    loaded: Option<&LoadedDesign<'static>>,
    beginning: &Beginning,
) -> Device<TipDesign<'static, D>> {
    let design = match loaded {
        Some(loaded) => TipDesign::Loaded(*loaded),
        None => TipDesign::Image(image()),
    };
    Device::new(design, beginning)
}

/// The designs, and the tips with the design of each.
macro_rules! hand {
    (
        designs { $($design:ident $plate:ident $module:ident $wall:ident $touched:ident,)* }
        tips { $($tip:ident $of:ident,)* }
    ) => {
        $(touching!($touched $design $plate $module $wall);)*

        /// The transducers of the tips.
        pub const TRANSDUCERS: [Transducer; TIPS] = [$($of::PARAMETERS.constants.transducer,)*];

        const TABLE_VERSIONS: [u32; TIPS] = [$($of::PARAMETERS.constants.table_version,)*];

        /// Hashes of the designs of the tips, those of the image.
        #[cfg(feature = "load-tip")]
        pub const DESIGN_HASHES: [u64; TIPS] = [$($of::PARAMETERS.constants.hash,)*];

        /// The tips.
        #[derive(Debug)]
        pub struct Tips {
            $($tip: Device<OfTip<$of>>,)*
        }

        impl Tips {
            /// Tips that have seen nothing yet, from what the board knows of each when it starts.
            pub fn new(start: HandStart<'_>) -> Self {
                let [$($tip,)*] = start.beginnings;
                #[cfg(feature = "load-tip")]
                let mut loaded = start.loaded.iter();
                Self {
                    $($tip: first_device!($of, $tip, loaded),)*
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
