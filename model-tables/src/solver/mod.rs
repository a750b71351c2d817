//! Boundary-value problems with two unknown functions and a few parameters, free of physics: each element is condensed
//! ([`collocation`]), the elements are chained and bordered by the equations of the parameters ([`bordered_block`]).

pub mod bordered_block;
pub mod collocation;
