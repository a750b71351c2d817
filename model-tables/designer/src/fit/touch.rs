//! First touch of a trial, by its own rows: where force or pressure leaves its level of before.
//!
//! `y = y_0 + s max(H - H_0, 0)^p` by least squares over the shallow rows: a line where the tip rests under pressure, up to a parabola. It counts
//! where it beats every such curve that begins before the first row.

use super::data::{Data, DataRow, Direction};
use super::heading::Measured;

/// Rows before first touch that tell the level, at least.
const BEFORE: usize = 4;
/// Rows after it, at least.
const AFTER: usize = 4;
/// The part of a channel's range that is shallow.
const SHALLOW: f64 = 0.3;
/// Powers of the indentation.
const POWERS: [f64; 7] = [1.0, 1.25, 1.5, 1.75, 2.0, 2.25, 2.5];
/// Places of first touch that are tried between two rows.
const BETWEEN: usize = 8;
/// Places that are tried before the first row, and how far out, over the span of the shallow rows.
const EARLIER: usize = 20;
/// Statistic of an F test from which on the level is one: no chance.
const SURE: f64 = 25.0;

/// First touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Touch {
    /// What the stage reads there, metres.
    pub(super) indentation: f64,
    /// Rows before it.
    pub(super) before: usize,
}

/// First touch of a trial, by the force where it was measured, else by the pressure rise; `None` where the rows begin after it.
pub(super) fn find(data: &Data, trial: usize) -> Option<Touch> {
    [Measured::Force, Measured::PressureRise]
        .into_iter()
        .find_map(|quantity| of_quantity(data, trial, quantity))
}

/// The mean of a quantity over the rows of a trial before an indentation.
pub(super) fn level(data: &Data, trial: usize, quantity: Measured, touch: &Touch) -> f64 {
    let before: Vec<f64> = rows(data, trial)
        .filter(|row| row.indentation.is_some_and(|depth| depth < touch.indentation))
        .filter_map(|row| row.get(quantity))
        .collect();
    before.iter().sum::<f64>() / before.len().max(1) as f64
}

/// Rows of a trial that are no way back.
fn rows(data: &Data, trial: usize) -> impl Iterator<Item = &DataRow> {
    data.rows
        .iter()
        .filter(move |row| row.trial == trial && row.direction != Direction::Unloading)
}

fn of_quantity(data: &Data, trial: usize, quantity: Measured) -> Option<Touch> {
    let mut points: Vec<[f64; 2]> = rows(data, trial)
        .filter_map(|row| Some([row.indentation?, row.get(quantity)?]))
        .collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let (low, high) = points
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), point| {
            (low.min(point[1]), high.max(point[1]))
        });
    let shallow = points
        .iter()
        .position(|point| point[1] > low + SHALLOW * (high - low))
        .unwrap_or(points.len());
    let points = &points[..shallow.max(BEFORE + AFTER).min(points.len())];
    if points.len() < BEFORE + AFTER {
        return None;
    }
    let least = |places: &[f64]| -> Option<(f64, f64)> {
        places
            .iter()
            .flat_map(|&place| POWERS.map(|power| (place, power)))
            .filter_map(|(place, power)| Some((left_of(points, place, power)?, place)))
            .min_by(|a, b| a.0.total_cmp(&b.0))
    };
    let span = points[points.len() - 1][0] - points[0][0];
    let earlier: Vec<f64> = (0..=EARLIER)
        .map(|k| points[0][0] - span * k as f64 / EARLIER as f64)
        .collect();
    let within: Vec<f64> = points[BEFORE - 1..=points.len() - AFTER]
        .windows(2)
        .flat_map(|pair| {
            (0..BETWEEN).map(|k| pair[0][0] + (pair[1][0] - pair[0][0]) * (k as f64 + 0.5) / BETWEEN as f64)
        })
        .collect();
    let (without, _) = least(&earlier)?;
    let (with, place) = least(&within)?;
    let freedom = points.len() as f64 - 4.0;
    // Rounding of a bench without noise.
    let rounding = 1e-18 * (high - low) * (high - low) * points.len() as f64;
    let sure = (without - with) * freedom > SURE * (with + rounding);
    sure.then(|| Touch {
        indentation: place,
        before: points.iter().filter(|point| point[0] < place).count(),
    })
}

/// Sum of squares that the best level and slope leave; `None` where the channel falls.
fn left_of(points: &[[f64; 2]], place: f64, power: f64) -> Option<f64> {
    let count = points.len() as f64;
    let base = |depth: f64| libm::pow((depth - place).max(0.0), power);
    let mean_base = points.iter().map(|point| base(point[0])).sum::<f64>() / count;
    let mean = points.iter().map(|point| point[1]).sum::<f64>() / count;
    let (mut square, mut product) = (0.0, 0.0);
    for point in points {
        let off = base(point[0]) - mean_base;
        square += off * off;
        product += off * (point[1] - mean);
    }
    let slope = product / square;
    (slope > 0.0).then(|| {
        points
            .iter()
            .map(|point| point[1] - mean - slope * (base(point[0]) - mean_base))
            .map(|left| left * left)
            .sum()
    })
}

#[cfg(test)]
mod tests {
    use super::super::data::DataChoice;
    use super::*;
    use model_tables::random::Random;
    use std::fmt::Write as _;

    /// A trial that begins `before` mm before first touch, `F = 2 H^power`, with noise in newtons.
    fn trial(before: f64, power: f64, noise: f64, seed: u64) -> Data {
        let mut random = Random(seed);
        let mut text = String::from("indentation_mm,force_n,pressure_rise_kpa\n");
        for k in 0..60 {
            let depth = 0.05 * f64::from(k) - before;
            let force = 2.0 * depth.max(0.0).powf(power) + noise * random.normal();
            let _ = writeln!(
                text,
                "{},{force},{}",
                12.0 + before + depth,
                5.0 * depth.max(0.0).powf(1.9)
            );
        }
        Data::parse(&text, "trial.csv", &DataChoice::default()).expect("data")
    }

    #[test]
    fn first_touch_is_found_where_it_is() {
        for power in [1.0, 1.4, 2.1] {
            for seed in 1..20 {
                let found = find(&trial(0.52, power, 0.01, seed), 0).expect("rows before first touch");
                let off = 1e3 * found.indentation - 12.52;
                // A row is 0.05 mm; a parabola leaves zero slowly: 0.01 N are 0.07 mm of it.
                assert!(
                    off.abs() < if power < 2.0 { 0.06 } else { 0.16 },
                    "{power} {seed} {off}"
                );
                assert!((7..=14).contains(&found.before), "{found:?}");
            }
        }
    }

    #[test]
    fn rows_that_begin_at_first_touch_or_after_it_have_none_before() {
        for power in [1.0, 1.4, 2.1, 2.5] {
            for (seed, before) in [(1, 0.0), (2, -0.1), (3, -0.5)] {
                assert_eq!(
                    find(&trial(before, power, 0.01, seed), 0),
                    None,
                    "{power} {before}"
                );
                assert_eq!(
                    find(&trial(before, power, 0.0, seed), 0),
                    None,
                    "{power} {before}"
                );
            }
        }
    }
}
