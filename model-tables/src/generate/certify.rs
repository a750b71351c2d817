//! The certificate: every representable input, compared with the curve.

use super::owned::OwnedTables;
use super::truth::Truth;
use crate::curve::Curve;
use crate::design_file::Accuracy;
use crate::table::Reading;
use crate::units::PressureRise;

/// What holds of tables, found by evaluating every input.
#[derive(Clone, Debug, PartialEq)]
pub struct Certificate {
    /// Inputs evaluated: all from zero to the maximum.
    pub inputs: u64,
    /// Errors of the force; absolute ones in micronewtons.
    pub force: Errors,
    /// Errors of the indentation; absolute ones in nanometres.
    pub indentation: Errors,
    /// Error of the comparison itself, relative: the local polynomials that stand for the curve.
    pub comparison_error: f64,
}

/// Errors of one output over every input.
#[derive(Clone, Debug, PartialEq)]
pub struct Errors {
    /// The output at the end of the press.
    pub full_scale: f64,
    /// Where errors of reading begin, in units of the output.
    pub from: f64,
    /// Largest, root-mean-square and mean error from there up, percent of reading (mean signed).
    pub of_reading: Spread,
    /// The same over all inputs, percent of full scale.
    pub of_full_scale: Spread,
    /// Largest error below `from`, percent of `from`.
    pub below_percent_of_from: f64,
    /// Largest error that `[accuracy]` allows, percent.
    pub allowed_percent: f64,
    /// Steps up by one count where the output does not change.
    pub equal_steps: u64,
    /// Steps up by one count where the output falls.
    pub falling_steps: u64,
    /// Largest step up by one count: what a count of input is worth where the output is steepest.
    pub largest_step: i32,
    /// Smallest and largest output.
    pub range: [i32; 2],
}

/// Largest, root-mean-square and mean.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// Largest magnitude.
    pub max: f64,
    /// Root mean square.
    pub rms: f64,
    /// Mean, signed.
    pub mean: f64,
}

impl Errors {
    /// Largest error as a fraction of what is allowed.
    pub fn share_of_allowed(&self) -> f64 {
        self.of_reading.max.max(self.below_percent_of_from) / self.allowed_percent
    }

    fn holds(&self) -> bool {
        self.share_of_allowed() <= 1.0 && self.falling_steps == 0 && self.range[0] == 0
    }
}

impl Certificate {
    /// Whether the tables may be used: accurate, never falling, zero at zero, flagged at both ends; and the
    /// comparison itself a hundred times finer than what it is to show.
    pub fn holds(&self) -> bool {
        let allowed = self.force.allowed_percent.min(self.indentation.allowed_percent);
        self.force.holds() && self.indentation.holds() && 100.0 * self.comparison_error <= 0.01 * allowed
    }
}

/// Evaluates every input. `None` when an end is not held and flagged as it must be.
pub(super) fn certify(
    tables: &OwnedTables,
    curve: &Curve,
    truth: &Truth,
    accuracy: &Accuracy,
) -> Option<Certificate> {
    if !ends_are_held(tables) {
        return None;
    }
    let full_scale = truth.full_scale;
    let from = full_scale.map(|full| full * accuracy.from_percent_of_full_scale / 100.0);
    let mut force = Tally::new(full_scale[0], from[0]);
    let mut indentation = Tally::new(full_scale[1], from[1]);
    let mut flagged = false;
    truth.for_each(|count, [true_force, true_indentation]| {
        let reading = tables.lookup(PressureRise(count));
        flagged |= reading.saturated | reading.negative;
        force.add(reading.force.0, true_force);
        indentation.add(reading.indentation.0, true_indentation);
    });
    (!flagged).then(|| Certificate {
        inputs: truth.maximum as u64 + 1,
        force: force.finish(accuracy.force_percent_of_reading),
        indentation: indentation.finish(accuracy.indentation_percent_of_reading),
        comparison_error: truth.deviation(curve),
    })
}

/// Inputs beyond the ends read as the ends do, with their flag.
fn ends_are_held(tables: &OwnedTables) -> bool {
    let maximum = tables.layout.maximum;
    let (zero, last) = (
        tables.lookup(PressureRise(0)),
        tables.lookup(PressureRise(maximum)),
    );
    let above = [maximum + 1, maximum.saturating_mul(2), i32::MAX - 1, i32::MAX];
    let below = [-1, -maximum, i32::MIN / 2, -i32::MAX];
    above.iter().all(|&count| {
        tables.lookup(PressureRise(count))
            == Reading {
                saturated: true,
                ..last
            }
    }) && below.iter().all(|&count| {
        tables.lookup(PressureRise(count))
            == Reading {
                negative: true,
                ..zero
            }
    })
}

/// Sums over the inputs of one output.
struct Tally {
    full_scale: f64,
    from: f64,
    all: Sums,
    reading: Sums,
    below: f64,
    previous: i32,
    equal: u64,
    falling: u64,
    largest_step: i32,
    range: [i32; 2],
}

#[derive(Default)]
struct Sums {
    count: u64,
    max: f64,
    squares: f64,
    sum: f64,
}

impl Sums {
    #[inline]
    fn add(&mut self, error: f64) {
        self.count += 1;
        self.max = self.max.max(error.abs());
        self.squares += error * error;
        self.sum += error;
    }

    /// In percent of `unit`.
    fn spread(&self, unit: f64) -> Spread {
        let count = self.count.max(1) as f64;
        let scale = 100.0 / unit;
        Spread {
            max: scale * self.max,
            rms: scale * libm::sqrt(self.squares / count),
            mean: scale * self.sum / count,
        }
    }
}

impl Tally {
    fn new(full_scale: f64, from: f64) -> Self {
        Self {
            full_scale,
            from,
            all: Sums::default(),
            reading: Sums::default(),
            below: 0.0,
            // Zero input reads zero, or the certificate does not hold.
            previous: 0,
            equal: 0,
            falling: 0,
            largest_step: 0,
            range: [i32::MAX, i32::MIN],
        }
    }

    #[inline]
    fn add(&mut self, got: i32, truth: f64) {
        let error = f64::from(got) - truth;
        self.all.add(error);
        if truth >= self.from {
            self.reading.add(error / truth);
        } else {
            self.below = self.below.max(error.abs());
        }
        let step = got.saturating_sub(self.previous);
        self.equal += u64::from(step == 0 && self.all.count > 1);
        self.falling += u64::from(step < 0);
        self.largest_step = self.largest_step.max(step);
        self.previous = got;
        self.range = [self.range[0].min(got), self.range[1].max(got)];
    }

    fn finish(self, allowed_percent: f64) -> Errors {
        Errors {
            full_scale: self.full_scale,
            from: self.from,
            of_reading: self.reading.spread(1.0),
            of_full_scale: self.all.spread(self.full_scale),
            below_percent_of_from: 100.0 * self.below / self.from,
            allowed_percent,
            equal_steps: self.equal,
            falling_steps: self.falling,
            largest_step: self.largest_step,
            range: self.range,
        }
    }
}
