//! What the flash keeps.

pub mod record;
pub mod store;
