//! What the flash keeps: the calibration, one [`record`] of it and the [`store`] of records; and with the feature `load-tip` the
//! two slots of a loaded tip.

pub mod record;
pub mod store;
#[cfg(feature = "load-tip")]
pub mod tip_slots;
