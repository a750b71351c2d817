//! From a sample to a report: the stages, in the order of the data.

pub mod calibration;
pub mod contact;
pub mod design;
pub mod drift;
pub mod filter;
pub mod fluid;
pub mod pipeline;
pub mod scale;
pub mod stuck;
pub mod tare;
pub mod temperature;
#[cfg(test)]
pub(crate) mod test_design;
pub mod touch;
pub mod uncertainty;
