//! Errors and steps of one output, tallied over all inputs.

use super::bounds::{Range, Sum, bounds};
use super::truth::Piece;

/// Inputs of a part that its sums of errors are taken from, evenly spaced.
const SAMPLED: i32 = 256;
/// Inputs of a part that are evaluated beforehand, and steps at either end.
const SOUNDED: i32 = 16;

/// Errors of one output over every input.
#[derive(Clone, Debug, PartialEq)]
pub struct Errors {
    /// The output at the end, in its unit.
    pub full_scale: f64,
    /// Where errors of reading begin, in its unit.
    pub from: f64,
    /// Largest, root-mean-square and mean error from there up, percent of reading (mean signed).
    pub of_reading: Spread,
    /// The same over all inputs, percent of full scale.
    pub of_full_scale: Spread,
    /// Largest error below `from`, percent of `from`.
    pub below_percent_of_from: f64,
    /// Largest error that is allowed, percent.
    pub allowed_percent: f64,
    /// Steps up by one count where the output does not change.
    pub equal_steps: u64,
    /// Steps up by one count where the output falls.
    pub falling_steps: u64,
    /// Largest increase for one count of input, where the output is steepest.
    pub largest_step: i32,
    /// Smallest and largest output.
    pub range: [i32; 2],
}

/// Largest, root-mean-square and mean.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// Largest magnitude, percent.
    pub max: f64,
    /// Root mean square, percent.
    pub rms: f64,
    /// Mean, signed, percent.
    pub mean: f64,
}

impl Errors {
    /// Largest error as a fraction of the allowed one.
    pub fn share_of_allowed(&self) -> f64 {
        self.of_reading.max.max(self.below_percent_of_from) / self.allowed_percent
    }

    /// Whether the error is allowed, the output never falls, and it is zero at zero.
    pub fn holds(&self) -> bool {
        self.share_of_allowed() <= 1.0 && self.falling_steps == 0 && self.range[0] == 0
    }
}

/// Consecutive inputs with one sum and one piece of the curve.
pub(super) struct OutputPart<'a> {
    pub(super) range: Range,
    pub(super) sum: Sum<'a>,
    pub(super) piece: Piece<'a>,
    /// 0 or 1.
    pub(super) output: usize,
}

impl OutputPart<'_> {
    /// Output and truth at a count.
    fn at(&self, count: i32) -> (i32, f64) {
        (self.sum.at(count), self.truth(count))
    }

    fn truth(&self, count: i32) -> f64 {
        self.piece.at(count)[self.output]
    }

    /// Largest error over a range, at most, in units of the output; infinite where only evaluation tells.
    fn largest_error(&self, range: Range) -> f64 {
        let Piece::Polynomial(block) = self.piece else {
            return f64::INFINITY;
        };
        let unit = self.sum.unit();
        let mut error = self.sum.over(range);
        for (error, truth) in error.iter_mut().zip(block.over(self.output, range)) {
            *error = *error / unit - truth;
        }
        let [least, largest] = bounds(&error);
        let rounding = self.sum.rounding() / unit;
        // The shift rounds down, by less than a unit.
        (largest + rounding).max(1.0 + rounding - least)
    }
}

/// Sums over the inputs of one output.
pub(super) struct Tally {
    full_scale: f64,
    from: f64,
    all: Sums,
    reading: Sums,
    below: f64,
    previous: Option<i32>,
    equal: u64,
    falling: u64,
    largest_step: i32,
    range: [i32; 2],
}

#[derive(Default)]
struct Sums {
    count: f64,
    max: f64,
    squares: f64,
    sum: f64,
}

impl Sums {
    /// An error that stands for so many inputs.
    #[inline]
    fn add(&mut self, error: f64, inputs: f64) {
        self.count += inputs;
        self.squares += inputs * (error * error);
        self.sum += inputs * error;
    }

    /// In percent of `unit`.
    fn spread(&self, unit: f64) -> Spread {
        let count = self.count.max(1.0);
        let scale = 100.0 / unit;
        Spread {
            max: scale * self.max,
            rms: scale * libm::sqrt(self.squares / count),
            mean: scale * self.sum / count,
        }
    }
}

impl Tally {
    pub(super) fn new(full_scale: f64, from: f64) -> Self {
        Self {
            full_scale,
            from,
            all: Sums::default(),
            reading: Sums::default(),
            below: 0.0,
            previous: None,
            equal: 0,
            falling: 0,
            largest_step: 0,
            range: [i32::MAX, i32::MIN],
        }
    }

    /// The next input.
    #[inline]
    pub(super) fn add(&mut self, got: i32, truth: f64) {
        self.largest(got, truth);
        self.sum(got, truth, 1.0);
        self.step(got);
    }

    /// Largest errors.
    #[inline]
    fn largest(&mut self, got: i32, truth: f64) {
        let error = (f64::from(got) - truth).abs();
        self.all.max = self.all.max.max(error);
        if truth >= self.from {
            self.reading.max = self.reading.max.max(error / truth);
        } else {
            self.below = self.below.max(error);
        }
    }

    /// Sums of errors.
    #[inline]
    fn sum(&mut self, got: i32, truth: f64, inputs: f64) {
        let error = f64::from(got) - truth;
        self.all.add(error, inputs);
        if truth >= self.from {
            self.reading.add(error / truth, inputs);
        }
    }

    /// A step up from the input before.
    #[inline]
    fn step(&mut self, got: i32) {
        if let Some(previous) = self.previous {
            let step = got.saturating_sub(previous);
            self.equal += u64::from(step == 0);
            self.falling += u64::from(step < 0);
            self.largest_step = self.largest_step.max(step);
        }
        self.previous = Some(got);
        self.range = [self.range[0].min(got), self.range[1].max(got)];
    }

    /// A first look at a part: some errors and steps, so that the bounds of few ranges exceed the largest ones.
    pub(super) fn sound(&mut self, part: &OutputPart) {
        let Range { first, last } = part.range;
        for place in 0..=SOUNDED {
            let count = first + ((i64::from(last - first) * i64::from(place)) / i64::from(SOUNDED)) as i32;
            let (got, truth) = part.at(count);
            self.largest(got, truth);
        }
        for count in (first..last.min(first + SOUNDED)).chain(first.max(last - SOUNDED)..last) {
            let step = part.sum.at(count + 1) - part.sum.at(count);
            self.largest_step = self.largest_step.max(step);
        }
    }

    /// Whether an error so far exceeds what is allowed, percent.
    pub(super) fn misses(&self, allowed_percent: f64) -> bool {
        100.0 * self.reading.max.max(self.below / self.from) > allowed_percent
    }

    /// The inputs of a part, without evaluating all of them.
    pub(super) fn bound(&mut self, part: &OutputPart) {
        let Range { first, last } = part.range;
        self.step(part.sum.at(first));
        self.steps(&part.sum, part.range);
        self.step_over(part.sum.at(last));
        self.errors(part, part.range);
        // Where readings begin, a range of its own does.
        let readings = partition(part.range, |count| part.truth(count) < self.from);
        for range in [
            Range {
                last: readings - 1,
                first,
            },
            Range {
                first: readings,
                last,
            },
        ] {
            self.sums(part, range);
        }
    }

    /// Goes on from an input whose steps are tallied already.
    fn step_over(&mut self, got: i32) {
        self.previous = Some(got);
        self.range = [self.range[0].min(got), self.range[1].max(got)];
    }

    /// The steps within a range.
    fn steps(&mut self, sum: &Sum, range: Range) {
        if range.first == range.last {
            return;
        }
        let [least, most] = sum.growth(range);
        let unit = sum.unit();
        // The sum is an integer: it does not fall if it grows by more than -1, the output grows if it grows by a unit, and by one at
        // most if it grows by no more than a unit.
        let (rises, always, single) = (least > -1.0, least > unit - 1.0, most < unit + 1.0);
        let largest = libm::ceil(libm::floor(most) / unit);
        if rises && (always || single) && largest <= f64::from(self.largest_step) {
            if !always {
                let steps = i64::from(range.last) - i64::from(range.first);
                let up = i64::from(sum.at(range.last)) - i64::from(sum.at(range.first));
                self.equal += (steps - up) as u64;
            }
        } else if range.is_short() {
            self.previous = Some(sum.at(range.first));
            for count in range.first + 1..=range.last {
                self.step(sum.at(count));
            }
        } else {
            for half in range.halves() {
                self.steps(sum, half);
            }
        }
    }

    /// The largest errors within a range.
    fn errors(&mut self, part: &OutputPart, range: Range) {
        let worst = part.largest_error(range);
        let [low, high] = [range.first, range.last].map(|count| part.truth(count));
        let of_reading = high < self.from || worst <= self.reading.max * low.max(self.from);
        let below = low >= self.from || worst <= self.below;
        if worst <= self.all.max && of_reading && below {
            return;
        }
        if range.is_short() {
            for count in range.first..=range.last {
                let (got, truth) = part.at(count);
                self.largest(got, truth);
            }
        } else {
            for half in range.halves() {
                self.errors(part, half);
            }
        }
    }

    /// The sums of errors over a range, each sample in the middle of the inputs that it stands for.
    fn sums(&mut self, part: &OutputPart, range: Range) {
        if range.first > range.last {
            return;
        }
        let counts = i64::from(range.counts());
        let samples = i64::from(SAMPLED).min(counts);
        let inputs = counts as f64 / samples as f64;
        for sample in 0..samples {
            let count = range.first + ((2 * sample + 1) * counts / (2 * samples)) as i32;
            let (got, truth) = part.at(count);
            self.sum(got, truth, inputs);
        }
    }

    pub(super) fn finish(self, allowed_percent: f64) -> Errors {
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

/// The first count of a range for which a condition that holds up to some count no longer does; one past the last if it always
/// does.
fn partition(range: Range, holds: impl Fn(i32) -> bool) -> i32 {
    let (mut low, mut high) = (range.first, range.last + 1);
    while low < high {
        let middle = low + (high - low) / 2;
        if holds(middle) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    low
}
