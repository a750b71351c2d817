//! Certified integer lookups: two outputs that grow with one input, in a few dozen words, proven over every input.
//!
//! A sensor's response is often known as a curve, from a model or a calibration, and needed on a chip as integers. This crate finds
//! the smallest table that keeps to a stated accuracy, writes down the largest error over *every* input, and reads the table with
//! about 25 instructions on a Cortex-M4: one count of leading zeros, one load of a segment, a sum of three products for each output.
//! No search, no division, no loop and no branch on data; no input can panic.
//!
//! ```
//! # #[cfg(feature = "generate")] {
//! use certified_lookup::generate::{AccuracyGoal, CurvePair, CurvePoint, tables};
//!
//! /// A conical vessel with a flat foot: depth in micrometres -> volume in mm^3, and surface in mm^2.
//! struct Cone;
//!
//! impl CurvePair for Cone {
//!     fn at(&self, depth: f64) -> [f64; 2] {
//!         [depth * depth * depth / 3e9 + depth / 1e3, depth * depth / 1e6 + depth / 1e3]
//!     }
//!
//!     fn points(&self) -> Vec<CurvePoint> {
//!         let depths = (1..=64).map(|i| 1.5e5 * f64::from(i) / 64.0);
//!         depths.map(|input| CurvePoint { input, outputs: self.at(input) }).collect()
//!     }
//! }
//!
//! let end = CurvePoint { input: 1.5e5, outputs: Cone.at(1.5e5) };
//! let goal = AccuracyGoal {
//!     percent_of_reading: [0.5, 0.5],
//!     from_percent_of_full_scale: 1.0,
//! };
//! let made = tables(&Cone, end, &goal, 10.0)?;
//! assert!(made.proof.holds() && made.proof.outputs[0].of_reading.max <= 0.5);
//! let half = made.tables.lookup(75_000 << made.tables.layout.fraction_bits);
//! assert!((f64::from(half.values[0]) / Cone.at(75e3)[0] - 1.0).abs() <= 5e-3);
//! # }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # What is proven, and how
//!
//! Let `f` be a curve and `T` the integer table. For every integer input from 0 to the table's maximum: `|T - f|` is at most the
//! stated share of `f` (below a stated part of full scale, of that part), `T` never falls, `T(0) = 0`, and inputs beyond either end
//! read as the end does, with a flag. Up to 2<sup>22</sup> inputs are evaluated one by one. Beyond, a range of inputs is settled by bounds:
//!
//! 1. The table's sum of real factors, and the local polynomial that stands for `f`, are polynomials in the place within the range.
//!    *Theorem:* a polynomial of degree `n` lies between the least and the largest of its coefficients in Bernstein's basis of degree `n`
//!    over the range (the convex hull property: G. Farin, *Curves and Surfaces for CAGD*, 5th edition, chapter 5).
//! 2. What the integers add is bounded: a product rounded down loses less than 1, a factor less than 1.6 of 2<sup>-32</sup>.
//! 3. A range that these two do not settle is halved, and evaluated where it is short.
//!
//! Largest errors, equal and falling steps are therefore those of full evaluation, to the digit. How far the local polynomials are
//! from `f` is measured, and must be a hundred times below the error that is stated.
//!
//! A table that arrives at run time ([`LoadedTables`]) is checked in integers alone, without the curve: its layout is one that the
//! lookup computes, zero reads zero, and neither output falls anywhere.
//!
//! # How a table is found
//!
//! Coefficients are of least largest error (E. Remez, 1934; powers with gaps are a Chebyshev system by Descartes' rule of signs, see E. W.
//! Cheney, *Introduction to Approximation Theory*, chapter 3), rounded to 16 bits highest power first, the others fitted again after each
//! (N. Brisebarre and S. Chevillard, *Efficient polynomial L-infinity approximations*, ARITH 18, 2007, has the general problem). Segments
//! are octaves of `input + bias` or two of them, so that the place costs a count of leading zeros. The search goes from the smallest
//! table to larger ones.
//!
//! # Features
//!
//! | feature | default | adds |
//! |---|---|---|
//! | none | | the lookup and the check of loaded tables: `no_std`, no allocation, integers only |
//! | `generate` | yes | the generator and the proof (`std`) |
#![cfg_attr(not(feature = "generate"), no_std)]
#![forbid(unsafe_code)]

mod error;
#[cfg(feature = "generate")]
pub mod generate;
mod layout;
mod loaded;
mod rising;
mod segments;

pub use error::TablesError;
pub use layout::{Constant, Layout, Outputs, Place, Powers, Tables, product};
pub use loaded::LoadedTables;
pub use rising::rises;
pub use segments::Segments;
