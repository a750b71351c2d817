//! The serial line, both ways.

pub mod command;
pub mod outbox;
pub mod telemetry;
pub mod wire;
