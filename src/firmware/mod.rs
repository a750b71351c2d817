//! Additions of the image to the library: the tasks, the transducer of the design on the board's port, and memory that survives
//! a reset.

#[cfg(hand)]
mod hand;
#[cfg(all(hand, feature = "load-tip"))]
mod hand_tips;
mod line;
mod queues;
mod retained;
#[cfg(hand)]
mod samples;
#[cfg(not(hand))]
mod tasks;
#[cfg(all(not(hand), feature = "load-tip"))]
mod tip;
#[cfg(not(hand))]
mod transducer;
mod watch;
