//! Contact force and indentation of a fluid-filled fingertip, from the pressure in its fluid.
//!
//! One sample's way: [`counts`] -> [`transducer`] -> [`pressure`] -> [`tare`] -> [`filter`] -> [`contact`] -> [`report`], called
//! in that order by [`pipeline`]; [`telemetry`] puts reports on the wire and [`design`] says for which
//! fingertip, [`image`] for the one this
//! build is for. Integers only, but for the full model's [`solver_states`], which the firmware does not solve; nothing here knows a clock or a bus: time and samples are
//! arguments.
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]

pub mod contact;
pub mod counts;
pub mod design;
pub mod filter;
pub mod image;
pub mod lookup_sweep;
pub mod pipeline;
pub mod pressure;
pub mod report;
pub mod solver_states;
pub mod tare;
pub mod telemetry;
pub mod transducer;

#[cfg(test)]
mod test_design;
