//! The frame of the band: how far the true values may be from the readings of a board to which the touched object is unknown.

use crate::link::wire::{DecodeError, Encoded, Reader};
use crate::units::Microseconds;
use model_tables::table::band::{ChipBand, ChipBandRow, MAX_BAND_ROWS};
use model_tables::units::PressureRise;

/// Kind code of the frame.
pub(super) const BAND: u8 = 8;
/// Bytes before the rows, and bytes of a row.
const BEFORE: usize = 6;
const ROW: usize = 12;

/// The band that belongs to the hello before it.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct BandMessage {
    /// Time when it was sent.
    pub time: Microseconds,
    /// `k`: a count of its pressure rises is `1 / 2^k` pascal, 0 to 31.
    pub pressure_fraction_bits: u8,
    /// The band.
    pub band: ChipBand,
}

/// Writes the fields after the header; in a hand, after the tip.
pub(super) fn write(body: &mut Encoded, message: &BandMessage) {
    let band = &message.band;
    body.put([message.pressure_fraction_bits, band.count]);
    body.put(band.from.0.to_le_bytes());
    for row in band.rows() {
        body.put(row.to.0.to_le_bytes());
        for percent in row.force.iter().chain(&row.indentation) {
            body.put(percent.to_le_bytes());
        }
    }
}

/// Reads the fields from the rest of a body. `at` is the offset of the first byte.
pub(super) fn read(mut fields: Reader<'_>, time: Microseconds, at: u8) -> Result<BandMessage, DecodeError> {
    let [pressure_fraction_bits, count] = fields.take()?;
    if pressure_fraction_bits > 31 {
        return Err(DecodeError::Field(at));
    }
    if !(1..=MAX_BAND_ROWS).contains(&usize::from(count)) {
        return Err(DecodeError::Field(at + 1));
    }
    let mut last = i32::from_le_bytes(fields.take()?);
    let mut band = ChipBand {
        from: PressureRise(last),
        count,
        rows: [ChipBandRow::NOTHING; MAX_BAND_ROWS],
    };
    if last < 0 {
        return Err(DecodeError::Field(at + 2));
    }
    let rows = band.rows.iter_mut().take(count.into());
    for (offset, row) in (usize::from(at) + BEFORE..).step_by(ROW).zip(rows) {
        let to = i32::from_le_bytes(fields.take()?);
        let mut percent = || fields.take().map(i16::from_le_bytes);
        *row = ChipBandRow {
            to: PressureRise(to),
            force: [percent()?, percent()?],
            indentation: [percent()?, percent()?],
        };
        let orders = |[least, most]: [i16; 2]| least <= most;
        if to <= last || !orders(row.force) || !orders(row.indentation) {
            return Err(DecodeError::Field(offset as u8));
        }
        last = to;
    }
    if !fields.0.is_empty() {
        return Err(DecodeError::Length);
    }
    Ok(BandMessage {
        time,
        pressure_fraction_bits,
        band,
    })
}
