//! The firmware image on an emulated board.
