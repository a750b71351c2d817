//! Segments whose words lie in memory as little-endian bytes, at any address.

use crate::layout::{Layout, Outputs};

/// A layout and its words, unchecked, [`Layout::words`] a segment, the segment of the largest inputs first.
#[derive(Clone, Copy, Debug)]
pub struct Segments<'a> {
    /// Where the segments lie.
    pub layout: Layout,
    /// Their words, little-endian.
    pub words: &'a [[u8; 4]],
}

impl Segments<'_> {
    /// Number of segments.
    fn count(&self) -> usize {
        self.words.len() / self.layout.words()
    }

    /// The words of the segment of this index, the last one's for any higher; those that a segment has not are 0.
    pub fn segment(&self, index: usize) -> [i32; Layout::MAX_WORDS] {
        let width = self.layout.words();
        let index = index.min(self.count().saturating_sub(1));
        let mut words = [0; Layout::MAX_WORDS];
        let segment = self.words.iter().skip(index * width).take(width);
        for (word, bytes) in words.iter_mut().zip(segment) {
            *word = i32::from_le_bytes(*bytes);
        }
        words
    }

    /// Both outputs at an input. For a layout that the lookup computes, every `i32` has an answer.
    pub fn lookup(&self, input: i32) -> Outputs {
        let place = self.layout.place(input);
        let index = place.number.wrapping_sub(self.layout.first_index) as usize;
        self.layout.outputs(input, place, &self.segment(index))
    }
}
