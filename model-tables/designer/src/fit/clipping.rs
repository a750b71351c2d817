//! Channels that stood at their end: a load cell or a transducer that reads one value while the press goes on.

use super::heading::Measured;
use super::record::{Data, DataRow};

/// Values this near to the extreme one, over the range of the channel, are the same.
const SAME: f64 = 1e-6;
/// Rows that stand at the end at least, and over the usual number of rows of one value: a coarse channel has ties everywhere.
const MIN_TIES: usize = 3;
const OVER_USUAL: f64 = 3.0;
/// Part of the range of every other channel that is passed through meanwhile.
const GOES_ON: f64 = 0.05;
/// The same part at a lower end, where the other channel grows from row to row.
const GOES_ON_LIGHTLY: f64 = 0.01;
/// Part of the rows that stand at a value at most; more is another kind of data.
const MAX_SHARE: f64 = 0.9;

/// Takes the values of force and pressure out that stood at an end of their channel; gives one line for each end.
pub(super) fn take_out(data: &mut Data) -> Vec<String> {
    let mut notes = Vec::new();
    for quantity in [Measured::Force, Measured::PressureRise] {
        for upper in [true, false] {
            let Some(members) = standing(&data.rows, quantity, upper) else {
                continue;
            };
            let value = data.rows[members[0]].get(quantity).unwrap_or_default();
            let lines = members.iter().map(|&i| data.rows[i].line);
            let (first, last) = (lines.clone().min().unwrap_or(0), lines.max().unwrap_or(0));
            notes.push(format!(
                "the {quantity} stands at {} in {} rows, lines {first} to {last}, while the press goes on: its channel was at its \
                 end there, and these values were left out",
                output::rows::significant(value * quantity.per_si(), 6),
                members.len()
            ));
            for i in members {
                data.rows[i].set(quantity, None);
            }
        }
    }
    let before = data.rows.len();
    data.rows.retain(|row| row.quantities() >= 2);
    data.incomplete += before - data.rows.len();
    notes
}

/// The rows in which a quantity stands at an end of its channel.
fn standing(rows: &[DataRow], quantity: Measured, upper: bool) -> Option<Vec<usize>> {
    let range = Range::of(rows.iter().filter_map(|row| row.get(quantity)))?;
    let end = if upper { range.high } else { range.low };
    let members: Vec<usize> = (0..rows.len())
        .filter(|&i| {
            rows[i]
                .get(quantity)
                .is_some_and(|value| (value - end).abs() <= SAME * range.width())
        })
        .collect();
    let count = members.len();
    if count < MIN_TIES
        || count as f64 > MAX_SHARE * rows.len() as f64
        || (count as f64) < OVER_USUAL * usual_ties(rows, quantity, end)
    {
        return None;
    }
    let (mut others, mut moves) = (0, false);
    for other in Measured::ALL.into_iter().filter(|other| *other != quantity) {
        let Some(whole) = Range::of(rows.iter().filter_map(|row| row.get(other))) else {
            continue;
        };
        others += 1;
        let during: Vec<f64> = members.iter().filter_map(|&i| rows[i].get(other)).collect();
        let stands = upper && other != Measured::Indentation;
        let Some(meanwhile) = Range::of(during.iter().copied()) else {
            // Taken out already.
            if stands {
                continue;
            }
            return None;
        };
        let goes_on = meanwhile.width() >= GOES_ON * whole.width();
        // Force and pressure both at their upper ends stand while the stage alone goes on.
        let both = stands && meanwhile.width() <= SAME * whole.width();
        // A press is light at a lower end: it goes on by little, but from row to row.
        let lightly = !upper && meanwhile.width() >= GOES_ON_LIGHTLY * whole.width() && grows(&during);
        if !(goes_on || both || lightly) {
            return None;
        }
        moves |= goes_on || lightly;
    }
    if !moves {
        return None;
    }
    // At the lower end one other channel alone does not tell a channel at its end from a tip that is not touched yet.
    (others == 2 || (others == 1 && upper)).then_some(members)
}

/// Whether each value is above the one before it; too few tell nothing.
fn grows(values: &[f64]) -> bool {
    values.len() > MIN_TIES && values.windows(2).all(|pair| pair[1] > pair[0])
}

/// Rows of one value away from an end: on average, or of the value next to the end if those are more.
fn usual_ties(rows: &[DataRow], quantity: Measured, end: f64) -> f64 {
    let mut values: Vec<f64> = rows
        .iter()
        .filter_map(|row| row.get(quantity))
        .filter(|value| value.to_bits() != end.to_bits())
        .collect();
    let count = values.len() as f64;
    values.sort_by(|a, b| (a - end).abs().total_cmp(&(b - end).abs()));
    let next = values
        .iter()
        .take_while(|value| value.to_bits() == values[0].to_bits())
        .count();
    values.dedup();
    (count / values.len().max(1) as f64).max(next as f64).max(1.0)
}

struct Range {
    low: f64,
    high: f64,
}

impl Range {
    fn of(values: impl Iterator<Item = f64>) -> Option<Self> {
        values.fold(None, |range: Option<Self>, value| {
            let (low, high) = range.map_or((value, value), |range| {
                (range.low.min(value), range.high.max(value))
            });
            Some(Self { low, high })
        })
    }

    fn width(&self) -> f64 {
        self.high - self.low
    }
}

#[cfg(test)]
mod tests {
    use super::super::data::{Data, DataChoice};
    use std::fmt::Write as _;

    fn bench(force: impl Fn(f64) -> f64, rise: impl Fn(f64) -> f64) -> Data {
        let mut text = String::from("indentation_mm,force_n,pressure_rise_kpa\n");
        for k in 1..=40 {
            let depth = 0.05 * f64::from(k);
            let _ = writeln!(text, "{depth:.3},{:.5},{:.5}", force(depth), rise(depth));
        }
        Data::parse(&text, "bench.csv", &DataChoice::default()).expect("good data")
    }

    #[test]
    fn a_channel_at_either_end_is_left_out() {
        let (force, rise) = (|h: f64| 2.0 * h * h, |h: f64| 10.0 * h * h);
        for (data, word, left) in [
            (bench(|h| force(h).min(3.0), rise), "the force stands at 3", 16),
            (
                bench(force, |h| rise(h).min(20.0)),
                "the pressure rise stands at 20",
                12,
            ),
            (
                bench(force, |h| rise(h).max(2.5)),
                "the pressure rise stands at 2.5",
                10,
            ),
            (
                bench(|h| force(h).min(4.5), |h| rise(h).min(22.5)),
                "the force stands at 4.5",
                11,
            ),
            (
                bench(|h| force(h).min(4.5), |h| rise(h).min(22.5)),
                "the pressure rise stands at 22.5",
                11,
            ),
            (
                bench(force, |h| rise(h).max(0.95)),
                "the pressure rise stands at 0.95",
                6,
            ),
        ] {
            let found = data.notes.iter().find(|note| note.contains(word));
            let found = found.unwrap_or_else(|| panic!("{word}: {:?}", data.notes));
            assert!(found.contains(&format!("in {left} rows")), "{found}");
        }
    }

    /// A press to 1.5 mm that is held there.
    fn held() -> Data {
        let mut text = String::from("indentation_mm,force_n,pressure_rise_kpa\n");
        for k in 1..=40 {
            let depth = 0.05 * f64::from(k.min(30));
            let _ = writeln!(text, "{depth:.3},{:.5},{:.5}", 2.0 * depth, 10.0 * depth);
        }
        Data::parse(&text, "held.csv", &DataChoice::default()).expect("good data")
    }

    #[test]
    fn a_coarse_channel_a_hold_and_a_tip_not_yet_touched_are_none() {
        let coarse = |value: f64, step: f64| (value / step).round() * step;
        for data in [
            bench(|h| 2.0 * h * h, |h| coarse(3.0 * (1.0 - (-2.0 * h).exp()), 0.1)),
            bench(|h| (h - 0.4).max(0.0), |h| 5.0 * (h - 0.4).max(0.0)),
            held(),
        ] {
            assert!(
                data.notes.iter().all(|note| !note.contains("stands at")),
                "{:?}",
                data.notes
            );
        }
    }
}
