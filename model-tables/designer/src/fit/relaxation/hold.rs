//! A trial of a record: from the last untouched row to the end of its hold, thinned.

use super::error::HoldError;
use crate::fit::heading::Measured;

/// Rows from this part of the depth on tell the level of the hold.
const HELD: f64 = 0.98;
/// The plate is on its way back this part of the depth above the hold: contact may be lost within a hundredth of it.
const RELEASED: f64 = 5e-4;
/// Noise of a stage that is more than rounding, over the depth.
const STILL: f64 = 1e-6;
/// A hold is so many times as long as its press, at least.
const MIN_HOLD: f64 = 2.0;
/// Rows of a press, and of a hold, that are told apart.
const MAX_PRESSED: usize = 200;
const FEW_HELD: usize = 300;
/// Rows of a hold closer than this part of the time since it began are read as one.
const BIN: f64 = 0.01;
/// Rows of a hold at least.
const MIN_ROWS: usize = 10;
/// Pressure or force of an untouched tip, over the largest, that is a zero not taken.
const UNTOUCHED: f64 = 0.01;

/// A row, SI; `None` where the cell is empty or the column missing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HoldRow {
    /// Line of the file, counted from 1: of the first of the rows that it stands for.
    pub line: u64,
    /// Time since the trial began, seconds.
    pub time: f64,
    /// Indentation from first touch, as the stage reads it, metres.
    pub indentation: f64,
    /// Pressure over rest, as the transducer reads it, pascals; `None` where it was not measured.
    pub rise: Option<f64>,
    /// Force, newtons; `None` where it was not measured.
    pub force: Option<f64>,
    /// Number of rows of the file it is the mean of, dimensionless.
    pub count: f64,
}

/// A press and its hold.
#[derive(Clone, Debug, PartialEq)]
pub struct HoldTrial {
    /// As the file has it; empty where there is no such column.
    pub name: String,
    /// Mean over the rows, degrees Celsius; `None` where the file has no such column.
    pub temperature: Option<f64>,
    /// The first is the untouched tip.
    pub rows: Vec<HoldRow>,
    /// The row at which the press has come to its depth.
    pub held_from: usize,
    /// Depth of the hold, metres.
    pub depth: f64,
}

impl HoldTrial {
    /// Seconds from the end of the press to the end of the record.
    pub fn hold(&self) -> f64 {
        self.rows[self.rows.len() - 1].time - self.rows[self.held_from].time
    }

    /// Its name for a message.
    pub(super) fn title(&self) -> String {
        if self.name.is_empty() {
            "the record".to_owned()
        } else {
            format!("trial `{}`", self.name)
        }
    }
}

/// A trial as the file has it.
pub(super) struct RawTrial {
    pub(super) name: String,
    pub(super) rows: Vec<HoldRow>,
    pub(super) temperatures: Vec<f64>,
}

/// The level of the hold, and how still the stage stands there (standard deviation): over time, as rows of a press or a release may
/// lie close. Nothing where no two rows are deep.
fn level(rows: &[HoldRow], deepest: f64) -> Option<[f64; 2]> {
    let deep: Vec<[f64; 2]> = rows
        .windows(2)
        .filter(|pair| pair.iter().all(|row| row.indentation >= HELD * deepest))
        .map(|pair| [pair[0].indentation, pair[1].time - pair[0].time])
        .collect();
    if deep.is_empty() {
        return None;
    }
    let depth = median_in_time(&deep);
    let off: Vec<[f64; 2]> = deep
        .iter()
        .map(|[level, seconds]| [(level - depth).abs(), *seconds])
        .collect();
    Some([depth, 1.483 * median_in_time(&off)])
}

/// A trial from its last untouched row to the end of its hold.
pub(super) fn trial(raw: RawTrial, notes: &mut Vec<String>) -> Result<HoldTrial, HoldError> {
    let RawTrial {
        name,
        mut rows,
        temperatures,
    } = raw;
    let mean = temperatures.iter().sum::<f64>() / temperatures.len() as f64;
    let mut trial = HoldTrial {
        temperature: (!temperatures.is_empty()).then_some(mean),
        rows: Vec::new(),
        held_from: 0,
        depth: 0.0,
        name,
    };
    let title = trial.title();
    let spread = temperatures
        .iter()
        .fold(0.0_f64, |most, t| most.max((t - mean).abs()));
    if spread > 0.5 {
        notes.push(format!(
            "{title}: the temperature is up to {spread:.1} K from its mean of {mean:.1} degrees Celsius, which is taken throughout"
        ));
    }
    let deepest = rows.iter().fold(0.0_f64, |most, row| most.max(row.indentation));
    let begin = rows
        .iter()
        .position(|row| row.indentation > 1e-3 * deepest)
        .unwrap_or(0);
    if deepest <= 0.0 || begin == 0 {
        return Err(HoldError::NotUntouched {
            title,
            line: rows[0].line,
            indentation: rows[0].indentation,
        });
    }
    zero(&title, &rows[..begin], &rows)?;
    rows.drain(..begin - 1);
    rows[0] = HoldRow {
        indentation: 0.0,
        ..rows[0]
    };
    let Some([depth, noise]) = level(&rows, deepest) else {
        return Err(HoldError::NoHold {
            title,
            depth: deepest,
            pressed: rows[rows.len() - 1].time - rows[0].time,
            held: 0.0,
            rows: 1,
        });
    };
    let held_from = rows
        .iter()
        .position(|row| row.indentation >= depth - 3.0 * noise - 1e-9 * depth);
    let held_from = held_from.unwrap_or(rows.len() - 1);
    let back = RELEASED.max(5.0 * noise / depth);
    let end = rows[held_from..]
        .iter()
        .position(|row| row.indentation < (1.0 - back) * depth)
        .map_or(rows.len(), |at| held_from + at);
    if end < rows.len() {
        notes.push(format!(
            "{title}: {} rows from the first release on were left out",
            rows.len() - end
        ));
        rows.truncate(end);
    }
    let last = rows[rows.len() - 1].time;
    let (pressed, held) = (rows[held_from].time - rows[0].time, last - rows[held_from].time);
    if held < MIN_HOLD * pressed || rows.len() - held_from < MIN_ROWS {
        return Err(HoldError::NoHold {
            title,
            depth,
            pressed,
            held,
            rows: rows.len() - held_from,
        });
    }
    if noise > STILL * depth {
        notes.push(format!(
            "{title}: the indentation of the hold is taken as {:.4} mm, from which it is {:.4} mm off (standard deviation)",
            1e3 * depth,
            1e3 * noise
        ));
    }
    let wander = rows[held_from..]
        .iter()
        .fold(0.0_f64, |most, row| most.max((row.indentation - depth).abs()));
    if wander <= 5.0 * noise + 1e-9 * depth {
        for row in &mut rows[held_from..] {
            row.indentation = depth;
        }
    }
    (trial.rows, trial.held_from) = thinned(&rows, held_from);
    trial.depth = depth;
    Ok(trial)
}

/// Median of values that each hold for some time; of none 0.
fn median_in_time(values: &[[f64; 2]]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let half = 0.5 * sorted.iter().map(|[_, seconds]| seconds).sum::<f64>();
    let mut passed = 0.0;
    let middle = sorted.iter().find(|[_, seconds]| {
        passed += seconds;
        passed >= half
    });
    middle.map_or(0.0, |[value, _]| *value)
}

/// Refuses readings of the untouched tip that are none.
fn zero(title: &str, untouched: &[HoldRow], rows: &[HoldRow]) -> Result<(), HoldError> {
    for (quantity, get) in [
        (
            Measured::PressureRise,
            (|row| row.rise) as fn(&HoldRow) -> Option<f64>,
        ),
        (Measured::Force, |row| row.force),
    ] {
        let values: Vec<f64> = untouched.iter().filter_map(get).collect();
        let largest = rows
            .iter()
            .filter_map(get)
            .fold(0.0, |most: f64, value| most.max(value.abs()));
        let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
        if mean.abs() > UNTOUCHED * largest {
            return Err(HoldError::NotZero {
                title: title.to_owned(),
                column: quantity.column(),
                mean: mean * quantity.per_si(),
            });
        }
    }
    Ok(())
}

/// Every so many rows of a long press, and means over rows of a long hold that are close on the scale of the time since it began; where the
/// hold begins in them.
fn thinned(rows: &[HoldRow], held_from: usize) -> (Vec<HoldRow>, usize) {
    let stride = held_from.div_ceil(MAX_PRESSED).max(1);
    let mut kept: Vec<HoldRow> = rows[..held_from].iter().step_by(stride).copied().collect();
    let start = kept.len();
    let held = &rows[held_from..];
    if held.len() <= FEW_HELD {
        kept.extend(held);
        return (kept, start);
    }
    let mut bin: Vec<HoldRow> = Vec::new();
    for row in held {
        let since = |row: &HoldRow| row.time - held[0].time;
        if let Some(first) = bin.first()
            && (since(row) > (1.0 + BIN) * since(first)
                || row.rise.is_some() != first.rise.is_some()
                || row.force.is_some() != first.force.is_some())
        {
            kept.push(mean(&bin));
            bin.clear();
        }
        bin.push(*row);
    }
    kept.push(mean(&bin));
    (kept, start)
}

fn mean(rows: &[HoldRow]) -> HoldRow {
    let count = rows.len() as f64;
    let of = |get: fn(&HoldRow) -> Option<f64>| {
        let sum: Option<f64> = rows.iter().map(get).sum();
        sum.map(|sum| sum / count)
    };
    HoldRow {
        line: rows[0].line,
        time: rows.iter().map(|row| row.time).sum::<f64>() / count,
        indentation: rows.iter().map(|row| row.indentation).sum::<f64>() / count,
        rise: of(|row| row.rise),
        force: of(|row| row.force),
        count,
    }
}
