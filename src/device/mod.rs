//! One board: the [`station`] between samples and line, and the [`supervisor`] of tasks and resets.

pub mod station;
pub mod supervisor;
