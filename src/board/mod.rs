//! One file per board: pins, clocks and interrupts, each with its reason. Every board gives the same things.

#[cfg(feature = "board-nucleo-f429zi")]
mod nucleo_f429zi;
#[cfg(feature = "board-nucleo-f429zi")]
pub(crate) use nucleo_f429zi::{Board, Clock, Converter, Line, Watchdog};

#[cfg(not(feature = "board-nucleo-f429zi"))]
compile_error!("choose a board: --features board-nucleo-f429zi");
