//! A band in the few rows that a chip has.

use super::{Band, BandRow};
use crate::table::band::{ChipBand, ChipBandRow, MAX_BAND_ROWS};
use crate::units::PressureRise;

impl Band {
    /// The band in integers, of pressure rises in counts of `1 / 2^fraction_bits` pascal. Neighbouring rows are joined that widen it
    /// least, until [`MAX_BAND_ROWS`] are left. `None` if the band has no row.
    pub fn of_chip(&self, fraction_bits: u32) -> Option<ChipBand> {
        let mut rows = self.rows.clone();
        while rows.len() > MAX_BAND_ROWS {
            let cheapest = (1..rows.len())
                .min_by(|one, other| {
                    let cost = |at: usize| widened(&rows[at - 1], &rows[at]);
                    cost(*one).total_cmp(&cost(*other))
                })
                .unwrap_or(1);
            let joined = join(&rows[cheapest - 1], &rows[cheapest]);
            rows[cheapest - 1] = joined;
            rows.remove(cheapest);
        }
        let counts = |pascals: f64| PressureRise::from_pascals(pascals, fraction_bits);
        let mut found = ChipBand {
            from: counts(rows.first()?.from),
            count: rows.len() as u8,
            rows: [ChipBandRow::NOTHING; MAX_BAND_ROWS],
        };
        for (to, row) in found.rows.iter_mut().zip(&rows) {
            *to = ChipBandRow {
                to: counts(row.to),
                force: tenths(row.force_percent),
                indentation: tenths(row.indentation_percent),
            };
        }
        Some(found)
    }
}

/// Percents, which have one decimal, as tenths.
fn tenths(percents: [f64; 2]) -> [i16; 2] {
    percents.map(|percent| libm::round(10.0 * percent).clamp(f64::from(i16::MIN), f64::from(i16::MAX)) as i16)
}

fn join(one: &BandRow, other: &BandRow) -> BandRow {
    let widest = |one: [f64; 2], other: [f64; 2]| [one[0].min(other[0]), one[1].max(other[1])];
    BandRow {
        from: one.from,
        to: other.to,
        force_percent: widest(one.force_percent, other.force_percent),
        indentation_percent: widest(one.indentation_percent, other.indentation_percent),
    }
}

/// By how much the two rows are wider when they are joined, percent times decades of pressure.
fn widened(one: &BandRow, other: &BandRow) -> f64 {
    let joined = join(one, other);
    let width = |row: &BandRow| {
        let width = |[least, most]: [f64; 2]| most - least;
        width(row.force_percent) + width(row.indentation_percent)
    };
    let over = |row: &BandRow| (width(&joined) - width(row)) * libm::log10(row.to / row.from);
    over(one) + over(other)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::law::Touched;

    /// Rows whose ends are 1, 2, 4, ... kilopascals.
    fn band(rows: &[[f64; 4]]) -> Band {
        let row = |(at, [a, b, c, d]): (usize, &[f64; 4])| BandRow {
            from: 1e3 * f64::from(1_u32 << at),
            to: 1e3 * f64::from(2_u32 << at),
            force_percent: [*a, *b],
            indentation_percent: [*c, *d],
        };
        Band {
            tables_of: Touched::Plate,
            smallest_ball_mm: 5.0,
            cup_mm: None,
            rows: rows.iter().enumerate().map(row).collect(),
        }
    }

    #[test]
    fn rows_that_are_alike_are_joined_and_nothing_is_left_out() {
        let narrow = [-3.0, 3.0, -1.0, 1.0];
        let wide = [-30.0, 20.0, -4.0, 58.6];
        let band = band(&[
            narrow,
            [-6.0, 5.0, -1.5, 7.5],
            [-9.0, 5.0, -1.5, 17.5],
            [-15.0, 5.0, -1.5, 27.5],
            wide,
            [-30.1, 20.0, -4.0, 58.6],
            wide,
        ]);
        let found = band.of_chip(8).expect("it has rows");
        assert_eq!((found.from, found.count), (PressureRise(256_000), 5));
        let ends: Vec<i32> = found.rows().iter().map(|row| row.to.0 / 256_000).collect();
        assert_eq!(ends, [2, 4, 8, 16, 128]);
        assert_eq!(
            (found.rows[0].force, found.rows[4].indentation),
            ([-30, 30], [-40, 586])
        );
        assert_eq!(found.rows[4].force, [-301, 200]);
        // The rows that the chip has hold those of the certificate.
        for row in &band.rows {
            let middle = PressureRise::from_pascals(0.5 * (row.from + row.to), 8);
            let on_chip = found.at(middle).expect("it is inside");
            for (chip, own) in [
                (on_chip.force, row.force_percent),
                (on_chip.indentation, row.indentation_percent),
            ] {
                assert!(f64::from(chip[0]) <= 10.0 * own[0] && f64::from(chip[1]) >= 10.0 * own[1]);
            }
        }
        assert!(found.at(PressureRise(255_999)).is_none());
        assert!(found.at(PressureRise(128 * 256_000 + 1)).is_none());
    }

    #[test]
    fn a_band_without_a_row_is_none() {
        assert_eq!(band(&[]).of_chip(8), None);
    }
}
