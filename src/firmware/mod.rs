//! The image: tasks on the board's peripherals.

pub(crate) mod retained;
mod tasks;
pub(crate) mod transducer;
