//! What a board does beside measuring.

pub mod station;
pub mod supervisor;
