//! The lookup on the chip: pressure rise -> force and indentation, integers only.
//!
//! `certified_lookup` describes how it works and what is proven. Here the input is the pressure rise. The two outputs are the
//! force in micronewtons and the indentation in nanometres. Tables of other objects and of a feedback force use it too.
//!
//! The tables of a design are a constant, so the compiler folds everything except the coefficients.

pub mod band;
pub mod blend;
pub mod feedback;
pub mod known;
pub mod law;
pub mod objects;

use crate::units::{Micronewtons, Nanometres, PressureRise};

pub use certified_lookup::{Constant, Layout, LoadedTables, Outputs, Powers, Tables, TablesError};

/// Table values at a pressure rise.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Reading {
    /// Force on the plate.
    pub force: Micronewtons,
    /// Indentation of the pole.
    pub indentation: Nanometres,
    /// The input was above the tables. Force and indentation are lower bounds.
    pub saturated: bool,
    /// The input was negative and read as zero.
    pub negative: bool,
}

impl From<Outputs> for Reading {
    #[inline(always)]
    #[allow(clippy::inline_always)] // part of the lookup
    fn from(outputs: Outputs) -> Self {
        let [force, indentation] = outputs.values;
        Self {
            force: Micronewtons(force),
            indentation: Nanometres(indentation),
            saturated: outputs.saturated,
            negative: outputs.negative,
        }
    }
}

/// Tables whose input is a pressure rise, and whose outputs are force and indentation.
pub trait ContactLookup {
    /// Force and indentation at a pressure rise. Total: every rise has an answer.
    fn contact_at(&self, rise: PressureRise) -> Reading;
}

impl<const SEGMENTS: usize, const WORDS: usize> ContactLookup for Tables<SEGMENTS, WORDS> {
    #[inline(always)]
    #[allow(clippy::inline_always)] // so that the layout folds into the code of the one call site
    fn contact_at(&self, rise: PressureRise) -> Reading {
        self.lookup(rise.0).into()
    }
}

impl ContactLookup for LoadedTables<'_> {
    fn contact_at(&self, rise: PressureRise) -> Reading {
        self.lookup(rise.0).into()
    }
}

#[cfg(feature = "std")]
impl ContactLookup for certified_lookup::generate::OwnedTables {
    #[inline]
    fn contact_at(&self, rise: PressureRise) -> Reading {
        self.lookup(rise.0).into()
    }
}
