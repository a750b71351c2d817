//! One board: the [`station`] between samples and line, and the [`supervisor`] of tasks and resets; with the feature `load-tip` the
//! loader of a tip's data.

pub mod station;
pub mod supervisor;
#[cfg(feature = "load-tip")]
pub mod tip_loader;
