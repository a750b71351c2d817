//! The band of an unknown object, as a chip has it: how far the truth may lie from what is read.

use crate::units::PressureRise;

/// Most rows of a band on the chip.
pub const MAX_BAND_ROWS: usize = 5;

/// The truth less the reading over a part of the pressure rises, tenths of a percent of the reading: least and most.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct ChipBandRow {
    /// The last rise of the row, counts.
    pub to: PressureRise,
    /// Of the force, tenths of a percent of reading.
    pub force: [i16; 2],
    /// Of the indentation, tenths of a percent of reading.
    pub indentation: [i16; 2],
}

impl ChipBandRow {
    /// No row.
    pub const NOTHING: Self = Self {
        to: PressureRise(0),
        force: [0; 2],
        indentation: [0; 2],
    };
}

/// A band of 1 to [`MAX_BAND_ROWS`] rows, one beside the other, by pressure rise.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct ChipBand {
    /// The first rise of the first row, counts: below it nothing is stated.
    pub from: PressureRise,
    /// How many rows there are, 1 to [`MAX_BAND_ROWS`].
    pub count: u8,
    /// The rows; those behind `count` are [`ChipBandRow::NOTHING`].
    pub rows: [ChipBandRow; MAX_BAND_ROWS],
}

impl ChipBand {
    /// The rows that there are.
    pub fn rows(&self) -> &[ChipBandRow] {
        self.rows.get(..usize::from(self.count)).unwrap_or(&self.rows)
    }

    /// The row of a pressure rise; nothing outside of the band.
    pub fn at(&self, rise: PressureRise) -> Option<&ChipBandRow> {
        if rise < self.from {
            return None;
        }
        self.rows().iter().find(|row| rise <= row.to)
    }
}
