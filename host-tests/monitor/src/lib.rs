//! Live readings of a board, from its serial port or from the emulated board's socket, in a terminal.
//!
//! [`link`] (bytes, and the connection again when it is lost) -> [`readings`] (frames, counted; the latest report) ->
//! [`view`] (the terminal) and [`rows`] (CSV and JSON), run by [`command`]; [`load`] brings a tip's data onto the board. A force is shown only while its report is `ok`; otherwise the reason is.
#![forbid(unsafe_code)]

pub mod command;
pub mod link;
pub mod load;
pub mod readings;
pub mod rows;
pub mod view;
