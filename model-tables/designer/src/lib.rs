//! The design tool: designs in, states, tables, calibrated and sized designs, reports out.
//!
//! [`commands`] (the command line, one module a subcommand) calls [`fit`] (bench data -> a calibrated design) and
//! [`size`] (a wanted force -> designs) and [`sweep`] (many designs to Parquet); all of them solve with `model_tables`. Charts of other methods come from
//! `compare`, rows and files go out through `output`.
#![forbid(unsafe_code)]

#[cfg(feature = "commands")]
pub mod commands;
pub mod fit;
pub mod size;
pub mod sweep;
mod table_text;
