//! Contact force and indentation of a fluid-filled fingertip, from the pressure in its fluid.
//!
//! One sample's way: [`counts`] -> [`transducer`] -> [`stuck`] -> [`pressure`] -> [`temperature`] -> [`tare`] ->
//! [`filter`] -> [`touch`] -> [`drift`] -> [`fluid`] -> [`contact`] -> [`uncertainty`] -> [`report`], called in that
//! order by [`pipeline`]; [`telemetry`] and [`command`] put into
//! words what goes over the [`wire`], where it waits in the [`outbox`]; [`calibration`] says what is known of this one
//! fingertip, [`design`] of all of its kind, and `image` (feature `design`) of the kind this build is for. Integers only,
//! but for the full model's [`solver_states`], which the firmware does not solve; nothing here knows a clock or a bus:
//! time and samples are arguments.
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]

pub mod calibration;
pub mod command;
pub mod contact;
pub mod counts;
pub mod design;
pub mod drift;
pub mod filter;
pub mod fluid;
#[cfg(feature = "design")]
pub mod image;
pub mod lookup_sweep;
pub mod lookup_ways;
pub mod outbox;
pub mod pipeline;
pub mod pressure;
pub mod record;
pub mod report;
pub mod solver_states;
pub mod station;
pub mod store;
pub mod stuck;
pub mod supervisor;
pub mod tare;
pub mod telemetry;
pub mod temperature;
pub mod touch;
pub mod transducer;
pub mod uncertainty;
pub mod wire;

#[cfg(test)]
mod test_design;
