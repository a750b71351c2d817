//! Tables whose size is known only when they are made. The generator makes them.

use crate::layout::{Layout, Outputs};

/// Tables of any number of segments. They give exactly the values of [`crate::Tables`].
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct OwnedTables {
    /// Position of the segments, and the layout of their words.
    pub layout: Layout,
    /// The words, [`Layout::words`] a segment, the segment of the largest inputs first.
    pub words: Vec<i32>,
}

impl OwnedTables {
    /// Number of segments.
    pub fn segments(&self) -> usize {
        self.words.len() / self.layout.words()
    }

    /// Bytes of the words.
    pub fn bytes(&self) -> usize {
        size_of_val(self.words.as_slice())
    }

    /// Instructions from an input to both outputs and the saturation flag, inlined on the chip.
    pub fn instructions(&self) -> u32 {
        super::shape::instructions(&self.layout)
    }

    /// Both outputs at an input, bit for bit as on the chip.
    #[inline]
    pub fn lookup(&self, input: i32) -> Outputs {
        let place = self.layout.place(input);
        let index = place.number.wrapping_sub(self.layout.first_index) as usize;
        let words = self.segment(index.min(self.segments() - 1));
        self.layout.outputs(input, place, words)
    }

    /// The words of one segment.
    pub fn segment(&self, index: usize) -> &[i32] {
        let width = self.layout.words();
        &self.words[index * width..(index + 1) * width]
    }
}
