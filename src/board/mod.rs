//! One file per board: pins, clocks and interrupts, each with its reason. Every board gives the same things.

#[cfg(not(transducer = "ratiometric"))]
mod i2c;
mod memory;

#[cfg(feature = "board-nucleo-l432kc")]
pub(crate) mod ecc;
#[cfg(feature = "board-nucleo-f429zi")]
#[path = "no_ecc.rs"]
pub(crate) mod ecc;

/// Whether the transducer has a supply of its own, which is measured beside its output.
#[cfg(transducer = "ratiometric")]
const SUPPLY_MEASURED: bool = fingertip::transducer::ratiometric::supply_measured(
    &<fingertip::image::ImageDesign as fingertip::design::Design>::CONSTANTS.transducer,
);

#[cfg(feature = "board-nucleo-f429zi")]
mod nucleo_f429zi;
#[cfg(feature = "board-nucleo-f429zi")]
pub(crate) use nucleo_f429zi::{Board, Clock, Ears, Line, Memory, Port, SLOT, Watchdog, begin};

#[cfg(feature = "board-nucleo-l432kc")]
mod nucleo_l432kc;
#[cfg(feature = "board-nucleo-l432kc")]
pub(crate) use nucleo_l432kc::{Board, Clock, Ears, Line, Memory, Port, SLOT, Watchdog, begin};

#[cfg(not(any(feature = "board-nucleo-f429zi", feature = "board-nucleo-l432kc")))]
compile_error!("choose a board: --no-default-features --features board-nucleo-l432kc");
