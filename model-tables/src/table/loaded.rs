//! Tables that are known at run time only: their layout is data, and their words are bytes of a file or of a flash.

use crate::table::{Layout, Reading};
use crate::units::PressureRise;

/// Tables whose words lie in memory as little-endian bytes, at any address; reads exactly as [`crate::table::Tables`] does.
#[derive(Clone, Copy, Debug)]
pub struct LoadedTables<'a> {
    layout: Layout,
    words: &'a [[u8; 4]],
}

impl<'a> LoadedTables<'a> {
    /// Tables of a layout that the generator wrote, with its words, [`Layout::words`] a segment, the segment of the
    /// largest inputs first.
    pub const fn new(layout: Layout, words: &'a [[u8; 4]]) -> Self {
        Self { layout, words }
    }

    /// Where the segments lie and how their words are read.
    pub const fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Number of segments.
    pub fn segments(&self) -> usize {
        self.words.len() / self.layout.words()
    }

    /// Force and indentation at a pressure rise. Total: every `i32` has an answer.
    pub fn lookup(&self, rise: PressureRise) -> Reading {
        let place = self.layout.place(rise);
        let index = place.number.wrapping_sub(self.layout.first_index) as usize;
        let index = index.min(self.segments().saturating_sub(1));
        let width = self.layout.words();
        let mut words = [0; Layout::MOST_WORDS];
        let segment = self.words.iter().skip(index * width).take(width);
        for (word, bytes) in words.iter_mut().zip(segment) {
            *word = i32::from_le_bytes(*bytes);
        }
        self.layout.reading(rise, place, &words)
    }
}
