//! From a sample to a report, in the order of the data: [`stuck`] -> [`scale`] -> [`temperature`] -> [`zero`] -> [`fluid`] ->
//! [`filter`] -> [`touch`] -> [`uncertainty`] -> [`wall`] ([`contact`], or [`relaxation`] where the wall has a memory) -> [`report`].
//! The [`pipeline`] calls them. Integers only; time and samples are arguments.

pub mod calibration;
pub mod contact;
pub mod design;
pub mod filter;
pub mod fluid;
pub mod loaded_design;
pub mod pipeline;
pub mod relaxation;
pub mod report;
pub mod scale;
pub mod stuck;
pub mod temperature;
#[cfg(test)]
pub(crate) mod test_design;
#[cfg(feature = "load-tip")]
pub mod tip_design;
pub mod touch;
pub mod uncertainty;
pub mod wall;
pub mod zero;
