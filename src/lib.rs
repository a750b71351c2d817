//! Contact force and indentation of a fluid-filled fingertip, from the pressure in its fluid.
//!
//! One sample's way: [`counts`] -> [`transducer`] -> [`stuck`] -> [`pressure`] -> [`temperature`] -> [`tare`] ->
//! [`filter`] -> [`touch`] -> [`drift`] -> [`fluid`] -> [`contact`] -> [`uncertainty`] -> [`report`], called in that
//! order by [`pipeline`]; [`telemetry`] and [`command`] put into
//! words what goes over the [`wire`], where it waits in the [`outbox`]; [`calibration`] says what is known of this one
//! fingertip, [`design`] of all of its kind, and [`image`] of the kind this build is for. Integers only,
//! but for the full model's [`solver_states`], which the firmware does not solve; nothing here knows a clock or a bus:
//! time and samples are arguments.
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]

pub mod device;
pub mod image;
pub mod link;
pub mod lookup_sweep;
pub mod lookup_ways;
pub mod signal;
pub mod solver_states;
pub mod status;
pub mod storage;
pub mod transducer;

pub use device::{station, supervisor};
pub use link::{command, outbox, telemetry, wire};
#[cfg(test)]
pub(crate) use signal::test_design;
pub use signal::{
    calibration, contact, design, drift, filter, fluid, pipeline, scale as pressure, stuck, tare,
    temperature, touch, uncertainty,
};
pub use status as report;
pub use storage::{record, store};
#[path = "transducer/counts.rs"]
pub mod counts;
