//! The firmware image, unmodified, on an emulated board with a fingertip pressed against it.
//!
//! The way of one press: [`fingertip_design`] and [`scenario`] (the plate's travel) -> [`plant`] (full model:
//! contact and pressure) ->
//! [`transducer`] and [`noise`] (voltage) -> `board` (the emulated microcontroller) running [`image`] ->
//! [`bench`] (the bytes it sends).
#![forbid(unsafe_code)]

pub mod bench;
mod board;
pub mod fingertip_design;
pub mod image;
pub mod noise;
pub mod plant;
pub mod scenario;
pub mod transducer;
