//! The firmware image, unmodified, on an emulated board with a fingertip pressed against it.
//!
//! The way of one press: [`fingertip_design`] and [`scenario`] (the plate's travel) -> [`plant`] (full model:
//! contact and pressure) ->
//! [`transducer`] and [`noise`] (a voltage, or a `sensor` on a bus) -> `board` (the emulated microcontroller) running [`image`] ->
//! [`bench`] (the bytes it sends) -> [`record`] (reports beside the truth) -> [`accuracy`], [`chart`] and
//! [`output`] files. [`hand`] is the same for several fingertips. [`inlined`] finds what a part of an image costs.
#![forbid(unsafe_code)]

mod abp2;
pub mod accuracy;
pub mod bench;
mod board;
pub mod chart;
pub mod fingertip_design;
pub mod hand;
pub mod image;
pub mod inlined;
mod ms5837;
pub mod multiplexer;
pub mod output;
pub mod plant;
pub mod record;
pub mod scenario;
mod sensor;
pub mod serve;
pub mod timed;
pub mod transducer;
