//! What the flash keeps: the calibration, one [`record`] of it and the [`store`] of one fingertip, both over a [`log`] in two slots; of a hand
//! the same of all its tips; and with the feature `load-tip` the two slots of a loaded tip.

#[cfg(tips)]
pub mod hand_record;
#[cfg(tips)]
pub mod hand_store;
pub mod log;
pub mod record;
pub mod store;
#[cfg(feature = "load-tip")]
pub mod tip_slots;
