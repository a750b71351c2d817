//! What images for the board and the host that judges them agree on. The images are in `bin/`; `cargo test-all` builds and
//! runs them on the emulated board.
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]

pub mod lookup_sweep;
pub mod lookup_ways;
pub mod solver_states;
