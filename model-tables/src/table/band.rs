//! The band of an unknown object on the chip: how far the true values may be from the readings.

use crate::units::PressureRise;

/// Largest number of rows of a band on the chip.
pub const MAX_BAND_ROWS: usize = 5;

/// Smallest and largest error, true value minus reading, for a range of pressure rises, in tenths of a percent of the reading.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct ChipBandRow {
    /// The last rise of the row, counts.
    pub to: PressureRise,
    /// Errors of the force, tenths of a percent of the reading.
    pub force: [i16; 2],
    /// Errors of the indentation, tenths of a percent of the reading.
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

/// A band of 1 to [`MAX_BAND_ROWS`] adjacent rows, in the order of the pressure rise.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct ChipBand {
    /// The first rise of the first row, counts. The band states nothing below it.
    pub from: PressureRise,
    /// Number of rows, 1 to [`MAX_BAND_ROWS`].
    pub count: u8,
    /// The rows; those after `count` are [`ChipBandRow::NOTHING`].
    pub rows: [ChipBandRow; MAX_BAND_ROWS],
}

impl ChipBand {
    /// The rows in use.
    pub fn rows(&self) -> &[ChipBandRow] {
        self.rows.get(..usize::from(self.count)).unwrap_or(&self.rows)
    }

    /// The row of a pressure rise. `None` outside the band.
    pub fn at(&self, rise: PressureRise) -> Option<&ChipBandRow> {
        if rise < self.from {
            return None;
        }
        self.rows().iter().find(|row| rise <= row.to)
    }
}
