//! Live readings of a board, from its serial port or from the emulated board's socket, in a terminal.
//!
//! [`link`] (bytes, and the connection again when it is lost) or [`source::replay`] (a log) -> [`readings`] (frames in order, counted; the
//! latest report, unless the line held it back; commands and their answers) -> [`view`] (the terminal), [`output`] (CSV, JSON,
//! MCAP), run by [`command`]; [`load`] brings a tip's data onto the board. A force is shown only while its report is `ok`; otherwise
//! the reason is.
#![forbid(unsafe_code)]

pub mod command;
mod frames;
mod keys;
pub mod link;
pub mod load;
pub mod output;
pub mod readings;
mod signals;
pub mod source;
pub mod view;
