//! Tables whose size is known only when they are made: what the generator makes and the command line reads.

use crate::table::{Layout, Reading};
use crate::units::PressureRise;

/// Tables of any number of segments and coefficients; reads exactly as [`crate::table::Tables`] does.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct OwnedTables {
    /// Where the segments lie.
    pub layout: Layout,
    /// Coefficients of the force in each segment.
    pub force_order: usize,
    /// Coefficients of the indentation in each segment.
    pub indentation_order: usize,
    /// The coefficients, in the order of [`crate::table::Segment`]: force, then indentation, segment by segment.
    pub words: Vec<i32>,
}

impl OwnedTables {
    /// Number of segments.
    pub fn segments(&self) -> usize {
        self.words.len() / self.width()
    }

    /// Bytes of the coefficients.
    pub fn bytes(&self) -> usize {
        size_of_val(self.words.as_slice())
    }

    /// Force and indentation at a pressure rise, bit for bit as on the chip.
    #[inline]
    pub fn lookup(&self, rise: PressureRise) -> Reading {
        let place = self.layout.place(rise);
        let index = place.index.min(self.segments() - 1);
        let (force, indentation) = self.segment(index);
        self.layout.reading(place, force, indentation)
    }

    /// The coefficients of one segment: force, indentation.
    pub fn segment(&self, index: usize) -> (&[i32], &[i32]) {
        let start = index * self.width();
        self.words[start..start + self.width()].split_at(self.force_order)
    }

    fn width(&self) -> usize {
        self.force_order + self.indentation_order
    }
}
