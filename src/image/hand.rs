//! The hand this image is built for: what the build script solved and wrote, a set of tables for each design, and its tips.

use crate::device::hand::{HandNames, HandTip};
use crate::device::logic::{Beginning, Device};
use crate::signal::design::{Design, Parameters};
#[allow(unused_imports)] // a hand may have walls of one kind alone
use crate::signal::wall::{Elastic, Memory};
use crate::signal::zero::limits::Limits;
use crate::signal::zero::surroundings::Surroundings;
use model_tables::constants::Transducer;
use model_tables::material::series::WallSeries;
use model_tables::table::Reading;
use model_tables::units::PressureRise;

/// The build script's words.
#[allow(clippy::unreadable_literal)] // nobody reads them
pub mod generated {
    include!(concat!(env!("OUT_DIR"), "/design.rs"));
}
pub use generated::{CHANNELS, NAME, PERIOD, SCANS, TIPS};

/// Ranks of a scan: the tips', and the internal reference's.
pub const RANKS: usize = TIPS + 1;

/// No design of a hand has an `[object]`.
pub const HAS_OBJECT: bool = false;

/// What the hand and its tips are called.
pub const NAMES: HandNames<TIPS> = HandNames {
    hash: generated::HASH,
    tips: generated::TIP_NAMES,
};

/// A design that folds into the code, as that of an image of one fingertip does.
macro_rules! design {
    ($name:ident, $module:ident, elastic) => {
        design!($name, $module, Elastic, None);
    };
    ($name:ident, $module:ident, relaxing) => {
        design!(
            $name,
            $module,
            Memory<{ generated::$module::RELAXATION.step.count }>,
            Some(&generated::$module::RELAXATION)
        );
    };
    ($name:ident, $module:ident, $wall:ty, $series:expr) => {
        /// A design of the hand: no bytes, as all of it folds into the code.
        #[derive(Clone, Copy, Debug)]
        pub struct $name;

        impl $name {
            const PARAMETERS: Parameters = Parameters::of_scan(
                generated::$module::DESIGN,
                generated::$module::TABLES.layout.pressure_fraction_bits,
                PressureRise(generated::$module::TABLES.layout.maximum),
                [PERIOD, SCANS as u32],
            );
        }

        impl Design for $name {
            type Wall = $wall;
            type Around = [Surroundings; Self::PARAMETERS.rates.places()];

            #[inline]
            fn series(&self) -> Option<&WallSeries> {
                const { $series }
            }

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
                generated::$module::TABLES.lookup(rise)
            }
        }
    };
}

/// The designs, and the tips with the design of each.
macro_rules! hand {
    (
        designs { $($design:ident $module:ident $wall:ident,)* }
        tips { $($tip:ident $of:ident,)* }
    ) => {
        $(design!($design, $module, $wall);)*

        /// The transducers of the tips.
        pub const TRANSDUCERS: [Transducer; TIPS] = [$($of::PARAMETERS.constants.transducer,)*];

        /// The tips.
        #[derive(Debug)]
        pub struct Tips {
            $($tip: Device<$of>,)*
        }

        impl Tips {
            /// Tips that have seen nothing yet, from what the board knows when it starts.
            pub fn new(beginning: &Beginning) -> Self {
                Self {
                    $($tip: Device::new($of, beginning),)*
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
