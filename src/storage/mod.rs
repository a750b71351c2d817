//! The calibration in flash: one [`record`] of it, and the [`store`] of records.

pub mod record;
pub mod store;
