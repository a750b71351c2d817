//! Data in the flash: the calibration, with its [`record`] and the [`store`] of one fingertip, over a [`log`] in two slots. A
//! hand has the same for all its tips. The feature `load-tip` adds two slots for a loaded tip.

#[cfg(tips)]
pub mod hand_record;
#[cfg(tips)]
pub mod hand_store;
pub mod log;
pub mod record;
pub mod save_budget;
pub mod store;
#[cfg(feature = "load-tip")]
pub mod tip_slots;
