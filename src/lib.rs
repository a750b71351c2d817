//! Contact force and indentation of a fluid-filled fingertip, from the pressure in its fluid.
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]

pub mod report;
pub mod telemetry;
