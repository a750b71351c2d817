//! Other ways to solve a fingertip and to look its tables up, held against those of the product.
//!
//! `methods` (bisection, shooting, closed forms, curves through few states) and the [`lookups`] that a
//! chip could do instead -> `campaign` (random designs, judged) -> `chart` (speed against accuracy), `atlas` (where each
//! method answers) and `ladder` (which model a wall needs), which are commands of `designer`.
//!
//! # Features
//!
//! | feature | default | adds |
//! |---|---|---|
//! | none | | [`lookups`] alone: `no_std`, for the image that counts their instructions |
//! | `std` | yes | everything else |
#![cfg_attr(not(feature = "std"), no_std)]
#![forbid(unsafe_code)]

pub mod lookups;

#[cfg(feature = "std")]
pub mod campaign;
#[cfg(feature = "std")]
pub mod chart;
#[cfg(feature = "std")]
pub mod ladder;
#[cfg(feature = "std")]
pub mod methods;
#[cfg(feature = "std")]
pub mod robustness_map;
