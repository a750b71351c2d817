//! What a bench measured: rows of indentation, force and pressure rise.

use super::heading::Measured;

/// Which way the plate moved.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Direction {
    /// Deeper.
    Loading,
    /// Back.
    Unloading,
    /// Not given, and not to be seen in the data.
    Unknown,
}

/// One row; SI units, `None` where the cell is empty or the column missing.
#[derive(Clone, Debug, PartialEq)]
pub struct DataRow {
    /// Line of the file, counted from 1.
    pub line: u64,
    /// Index of its trial, in the order of first appearance.
    pub trial: usize,
    /// Which way the plate moved.
    pub direction: Direction,
    /// Indentation as the stage reads it, metres; `None` where the cell is empty.
    pub indentation: Option<f64>,
    /// Force, newtons; `None` where the cell is empty.
    pub force: Option<f64>,
    /// Pressure rise over rest as the transducer reads it, pascals; `None` where the cell is empty.
    pub rise: Option<f64>,
}

impl DataRow {
    /// How deep it is pressed, for an order: its indentation or, without, its pressure rise.
    pub fn depth(&self) -> f64 {
        self.indentation.or(self.rise).unwrap_or(0.0)
    }

    /// One of the three quantities, SI.
    pub fn get(&self, quantity: Measured) -> Option<f64> {
        match quantity {
            Measured::Indentation => self.indentation,
            Measured::Force => self.force,
            Measured::PressureRise => self.rise,
        }
    }

    pub(super) fn set(&mut self, quantity: Measured, value: Option<f64>) {
        match quantity {
            Measured::Indentation => self.indentation = value,
            Measured::Force => self.force = value,
            Measured::PressureRise => self.rise = value,
        }
    }

    pub(super) fn quantities(&self) -> usize {
        Measured::ALL
            .iter()
            .filter(|quantity| self.get(**quantity).is_some())
            .count()
    }
}

/// What was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Data {
    /// Where it comes from, for reports.
    pub name: String,
    /// Rows with at least two of the three quantities, in the order of the file.
    pub rows: Vec<DataRow>,
    /// Names of the trials; one, empty, where there is no such column.
    pub trials: Vec<String>,
    /// Rows left out because fewer than two quantities were there.
    pub incomplete: usize,
    /// How the file was read, and what was changed or left out, one line each.
    pub notes: Vec<String>,
}
