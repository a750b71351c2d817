//! What the image adds to the library: the tasks, the transducer of the design on the board's port, and memory that a reset
//! keeps.

mod queues;
mod retained;
mod tasks;
#[cfg(feature = "load-tip")]
mod tip;
mod transducer;
