//! One board: the [`logic`] between samples and line, and the [`task_monitor`] of tasks and resets; with the feature `load-tip` the
//! loader of a tip's data.

#[cfg(tips)]
pub mod hand;
#[cfg(tips)]
pub mod kept_zeros;
pub mod logic;
pub mod task_monitor;
#[cfg(feature = "load-tip")]
pub mod tip_loader;
