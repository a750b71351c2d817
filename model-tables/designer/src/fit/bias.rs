//! Constant and creeping errors of a bench in what a fit leaves: offsets of force, pressure and indentation, and slow drift.
//!
//! A candidate's column is projected off the fitted parameters' (a score test), so that only what they cannot take up counts.

use super::data::Data;
use super::heading::Measured;
use super::model::{DataQuantity, Target};
use super::trial_zeros::zero_name;
use nalgebra::{DMatrix, DVector};
use std::fmt;

/// Standard errors that a bias is away from zero at least.
const SURE: f64 = 5.0;
/// Part of the largest reading that is worth a word.
const WORTH: f64 = 0.01;
/// Rows of a trial in which a drift can be seen.
const MIN_ROWS: usize = 10;
/// A bias of so many times as good evidence as the next is told alone: one causes others.
const ALONE: f64 = 0.5;

/// How an error of the bench goes over the rows.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Course {
    /// The same in every row.
    Offset,
    /// Growing evenly from the first row of a trial to the last.
    Drift,
    /// Of the force's depth against the pressure's: they do not vanish together.
    Lag,
}

/// An error of the bench.
#[derive(Clone, Debug, PartialEq)]
pub struct Bias {
    quantity: Measured,
    course: Course,
    /// The trial's name, if it is that of one trial.
    trial: Option<String>,
    /// Offset, or drift over the trial, or how much deeper the force vanishes than the pressure; SI.
    value: f64,
    /// In standard errors.
    evidence: f64,
}

impl Bias {
    /// Whether force and pressure do not vanish at the same depth.
    pub fn is_lag(&self) -> bool {
        self.course == Course::Lag
    }
}

impl fmt::Display for Bias {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let unit = match self.quantity {
            Measured::Indentation => "mm",
            Measured::Force => "N",
            Measured::PressureRise => "kPa",
        };
        let value = self.value * self.quantity.per_si();
        let value = match self.course {
            Course::Lag => output::rows::significant(value.abs(), 3),
            Course::Offset | Course::Drift => output::rows::significant(value, 3),
        };
        let of = self
            .trial
            .as_ref()
            .filter(|trial| !trial.is_empty())
            .map_or_else(String::new, |trial| format!(" of trial {trial}"));
        let evidence = self.evidence.abs();
        match self.course {
            Course::Offset => write!(
                f,
                "the {}{of} looks offset by {value} {unit} ({evidence:.0} standard errors): tare it, or fit it with {}{}",
                self.quantity,
                if self.trial.is_some() {
                    "--per-trial "
                } else {
                    "--fit material,pole-stretch,"
                },
                zero_name(self.quantity)
            ),
            Course::Lag => write!(
                f,
                "force and pressure do not vanish at the same depth: the force begins {value} mm {} the pressure ({evidence:.0} standard \
                 errors); look for a zero that was not tared or a delay of one channel",
                if self.value > 0.0 { "after" } else { "before" }
            ),
            Course::Drift => write!(
                f,
                "the {}{of} looks to drift by {value} {unit} from its first row to its last ({evidence:.0} standard errors): tare \
                 before each press, or leave the trial out",
                self.quantity
            ),
        }
    }
}

/// What a fit leaves, in standard deviations; rows of outliers are zero.
pub(super) struct Left<'a> {
    pub(super) data: &'a Data,
    pub(super) targets: &'a [Target],
    /// One over the standard deviation of each target.
    pub(super) factors: &'a [f64],
    /// Of the fitted parameters.
    pub(super) jacobian: &'a DMatrix<f64>,
    /// Measured less fitted, SI.
    pub(super) residuals: &'a [f64],
    /// Change of the predictions by an offset of the indentation, SI per metre; `None` where no row has one.
    pub(super) by_indentation: Option<Vec<f64>>,
}

/// The errors of the bench that stand out, the best founded first.
pub(super) fn find(left: &Left<'_>) -> Vec<Bias> {
    let space = Space::new(left);
    let mut found: Vec<Bias> = candidates(left)
        .into_iter()
        .filter_map(|(bias, column, full_scale)| {
            let (value, evidence) = space.test(&column)?;
            let enough = evidence.abs() > SURE && value.abs() > WORTH * full_scale;
            enough.then_some(Bias {
                value,
                evidence,
                ..bias
            })
        })
        .collect();
    found.sort_by(|a, b| b.evidence.abs().total_cmp(&a.evidence.abs()));
    let best = found.first().map_or(0.0, |bias| bias.evidence.abs());
    found.retain(|bias| bias.evidence.abs() > ALONE * best || bias.trial.is_some());
    // An offset of a trial looks like a drift of it, and the other way round.
    let mut told: Vec<(Measured, Option<String>)> = Vec::new();
    found.retain(|bias| {
        let of = (bias.quantity, bias.trial.clone());
        let first = bias.trial.is_none() || !told.contains(&of);
        told.push(of);
        first
    });
    // An offset of all is one of each trial too.
    if found.first().is_some_and(|bias| bias.trial.is_none()) {
        found.truncate(1);
    }
    found.truncate(4);
    found
}

/// Every bias that is looked for, with its column, SI, and the largest reading.
fn candidates(left: &Left<'_>) -> Vec<(Bias, Vec<f64>, f64)> {
    let Left { data, targets, .. } = *left;
    let mut candidates = Vec::new();
    let bias = |quantity, course, trial: Option<usize>| Bias {
        quantity,
        course,
        trial: trial.map(|trial| data.trials[trial].clone()),
        value: 0.0,
        evidence: 0.0,
    };
    for (of, quantity) in [
        (DataQuantity::Force, Measured::Force),
        (DataQuantity::Rise, Measured::PressureRise),
    ] {
        let full_scale = targets
            .iter()
            .filter(|target| target.quantity == of)
            .map(|target| target.measured.abs())
            .fold(0.0, f64::max);
        let column = |value: &dyn Fn(usize) -> f64| -> Vec<f64> {
            let of_target = |target: &Target| {
                if target.quantity == of {
                    value(target.row)
                } else {
                    0.0
                }
            };
            targets.iter().map(of_target).collect()
        };
        candidates.push((bias(quantity, Course::Offset, None), column(&|_| 1.0), full_scale));
        for trial in 0..data.trials.len() {
            let rows: Vec<usize> = (0..data.rows.len())
                .filter(|&row| data.rows[row].trial == trial)
                .collect();
            let (Some(&first), Some(&last)) = (rows.first(), rows.last()) else {
                continue;
            };
            if data.trials.len() > 1 {
                let alone = column(&|row| if data.rows[row].trial == trial { 1.0 } else { 0.0 });
                candidates.push((bias(quantity, Course::Offset, Some(trial)), alone, full_scale));
            }
            if rows.len() >= MIN_ROWS {
                let part = |row: usize| (row - first) as f64 / (last - first) as f64;
                let drift = column(&|row| {
                    if data.rows[row].trial == trial {
                        part(row)
                    } else {
                        0.0
                    }
                });
                candidates.push((bias(quantity, Course::Drift, Some(trial)), drift, full_scale));
            }
        }
    }
    if let Some(column) = &left.by_indentation {
        let deepest = data
            .rows
            .iter()
            .filter_map(|row| row.indentation)
            .fold(0.0, f64::max);
        candidates.push((
            bias(Measured::Indentation, Course::Offset, None),
            column.clone(),
            deepest,
        ));
        // A depth of the force alone, where the pressure tells its own.
        if targets.iter().any(|target| target.quantity == DataQuantity::Rise) {
            let force = targets
                .iter()
                .zip(column)
                .map(|(target, change)| match target.quantity {
                    DataQuantity::Force => *change,
                    DataQuantity::Rise => 0.0,
                })
                .collect();
            candidates.push((bias(Measured::Indentation, Course::Lag, None), force, deepest));
        }
    }
    candidates
}

/// What the fitted parameters leave.
struct Space<'a> {
    factors: &'a [f64],
    /// An orthonormal basis of what the parameters reach.
    reached: DMatrix<f64>,
    residuals: DVector<f64>,
    freedom: f64,
}

impl<'a> Space<'a> {
    fn new(left: &Left<'a>) -> Self {
        let counted = left.factors.iter().filter(|factor| **factor > 0.0).count();
        let reached = left.jacobian.clone().qr().q();
        let weighted = DVector::from_fn(left.residuals.len(), |i, _| left.factors[i] * left.residuals[i]);
        let mut space = Self {
            factors: left.factors,
            freedom: counted as f64 - left.jacobian.ncols() as f64 - 1.0,
            reached,
            residuals: DVector::zeros(0),
        };
        space.residuals = space.off(weighted);
        space
    }

    /// A vector less what the parameters reach of it.
    fn off(&self, vector: DVector<f64>) -> DVector<f64> {
        let within = &self.reached * (self.reached.transpose() * &vector);
        vector - within
    }

    /// Value and evidence of a column; `None` where the parameters take it up or too little is left.
    fn test(&self, column: &[f64]) -> Option<(f64, f64)> {
        let weighted = DVector::from_fn(column.len(), |i, _| self.factors[i] * column[i]);
        let whole = weighted.norm_squared();
        let alone = self.off(weighted);
        let square = alone.norm_squared();
        if square < 1e-6 * whole || whole <= 0.0 || self.freedom < 3.0 {
            return None;
        }
        let value = alone.dot(&self.residuals) / square;
        let rest = self.residuals.norm_squared() - value * value * square;
        let deviation = libm::sqrt((rest / self.freedom).max(f64::MIN_POSITIVE));
        Some((value, value * libm::sqrt(square) / deviation))
    }
}
