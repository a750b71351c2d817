//! Tables that are known only at run time: their layout is data, and their words are bytes of a file or of flash.
//!
//! They are checked once, when they are loaded: the lookup supports the layout, there is a segment for every input, zero gives
//! zero, and neither output ever falls (`rising`).

use crate::error::TablesError;
use crate::layout::{Layout, MAX_FRACTION_BITS, Outputs};
use crate::rising::rises;
use crate::segments::Segments;

/// Last input and bias are below this, so that their sum fits a word.
const INPUTS_END: i32 = 1 << 30;
/// An octave is cut in halves at most so often.
const MAX_HALVINGS: u32 = 3;
/// Most bits of a shift of a word.
const MAX_SHIFT: u32 = 31;

/// Tables whose words lie in memory as little-endian bytes, at any address; reads exactly as [`crate::Tables`] does.
#[derive(Clone, Copy, Debug)]
pub struct LoadedTables<'a>(Segments<'a>);

impl<'a> LoadedTables<'a> {
    /// Tables of a layout, with [`Layout::words`] words a segment, the segment of the largest inputs first.
    ///
    /// # Errors
    /// [`TablesError`]: such tables may answer wrongly.
    pub fn new(layout: Layout, words: &'a [[u8; 4]]) -> Result<Self, TablesError> {
        check_layout(&layout)?;
        let number = |count: i32| layout.place(count).number;
        if number(layout.maximum) != layout.first_index {
            return Err(TablesError::Layout("first_index"));
        }
        // Numbers grow downwards, to 255 at most.
        let segments = (number(0) - layout.first_index + 1) as usize;
        let (needed, found) = (segments * layout.words(), words.len());
        if needed != found {
            return Err(TablesError::Words { needed, found });
        }
        let tables = Segments { layout, words };
        if tables.lookup(0).values != [0, 0] {
            return Err(TablesError::Zero);
        }
        rises(&tables, &[0, 1])?;
        Ok(Self(tables))
    }

    /// Where the segments lie and how their words are read.
    pub const fn layout(&self) -> &Layout {
        &self.0.layout
    }

    /// Their words.
    pub const fn words(&self) -> &'a [[u8; 4]] {
        self.0.words
    }

    /// Both outputs at an input. Total: every `i32` has an answer.
    pub fn lookup(&self, input: i32) -> Outputs {
        self.0.lookup(input)
    }
}

/// Whether every field is one that the lookup computes with.
fn check_layout(layout: &Layout) -> Result<(), TablesError> {
    let halvings = if layout.octaves == 1 { MAX_HALVINGS } else { 0 };
    let fields = [
        ("fraction_bits", layout.fraction_bits <= MAX_FRACTION_BITS),
        ("maximum", (1..INPUTS_END).contains(&layout.maximum)),
        ("bias", (1..INPUTS_END).contains(&layout.bias)),
        ("octaves", (1..=2).contains(&layout.octaves)),
        ("halvings", layout.halvings <= halvings),
        ("first shift", layout.shifts[0] <= MAX_SHIFT),
        ("second shift", layout.shifts[1] <= MAX_SHIFT),
    ];
    match fields.into_iter().find(|(_, holds)| !holds) {
        Some((field, _)) => Err(TablesError::Layout(field)),
        None => Ok(()),
    }
}
