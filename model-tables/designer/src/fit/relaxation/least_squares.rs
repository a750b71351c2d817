//! Times and weights of a given number of terms, by least squares: the readings are linear in the weights (and in the relaxed modulus),
//! which
//! are solved for at each set of times, and the times vary alone (Golub and Pereyra 1973, with Kaufman's slopes, 1975).

use super::forward::{Forward, GROUPS};
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::storage::Owned;
use nalgebra::{DMatrix, DVector, Dyn};

/// Step of a logarithm for a slope.
const STEP: f64 = 1e-4;
/// Relative tolerances of the sum of squares and of the parameters.
const TOLERANCE: f64 = 1e-12;
/// Evaluations over the number of parameters.
const PATIENCE: usize = 30;
/// Rounds in which noise is taken from what is left.
const ROUNDS: usize = 3;
/// Logarithm of a weight that least squares want at zero or below.
const NONE: f64 = -60.0;
/// Noise is never below this part of the largest reading: rounding.
const ROUNDING: f64 = 1e-9;

/// A series, and what else a fit varies.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Series {
    /// Logarithms of the times in seconds, and whether each is held.
    pub(super) times: Vec<(f64, bool)>,
    /// Logarithms of the weights.
    pub(super) weights: Vec<f64>,
    /// Logarithm of the relaxed modulus over the design's, and whether it is free.
    pub(super) modulus: (f64, bool),
    /// Shift per kelvin, and whether it is free.
    pub(super) shift: (f64, bool),
}

/// What a parameter of the fit is.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum Varied {
    Time(usize),
    Weight(usize),
    Modulus,
    Shift,
}

impl Series {
    /// What is varied, in the order of the parameters.
    pub(super) fn varied(&self) -> Vec<Varied> {
        let times = self.times.iter().enumerate().filter(|(_, (_, held))| !held);
        let mut varied: Vec<Varied> = times.map(|(i, _)| Varied::Time(i)).collect();
        varied.extend((0..self.weights.len()).map(Varied::Weight));
        varied.extend(self.modulus.1.then_some(Varied::Modulus));
        varied.extend(self.shift.1.then_some(Varied::Shift));
        varied
    }

    fn get(&self, which: Varied) -> f64 {
        match which {
            Varied::Time(i) => self.times[i].0,
            Varied::Weight(i) => self.weights[i],
            Varied::Modulus => self.modulus.0,
            Varied::Shift => self.shift.0,
        }
    }

    fn set(&mut self, which: Varied, value: f64) {
        match which {
            Varied::Time(i) => self.times[i].0 = value,
            Varied::Weight(i) => self.weights[i] = value,
            Varied::Modulus => self.modulus.0 = value,
            Varied::Shift => self.shift.0 = value,
        }
    }

    /// `tau` and `g`.
    pub(super) fn terms(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        let weights = self.weights.iter().map(|weight| libm::exp(*weight));
        self.times
            .iter()
            .zip(weights)
            .map(|((time, _), weight)| [libm::exp(*time), weight])
    }

    /// Terms of increasing time.
    fn sorted(mut self) -> Self {
        let mut order: Vec<usize> = (0..self.times.len()).collect();
        order.sort_by(|&a, &b| self.times[a].0.total_cmp(&self.times[b].0));
        self.weights = order.iter().map(|&i| self.weights[i]).collect();
        self.times = order.iter().map(|&i| self.times[i]).collect();
        self
    }

    /// `1 + sum g_i exp(-t / tau_i)`.
    pub(super) fn stiffness(&self, seconds: f64) -> f64 {
        self.terms().fold(1.0, |sum, [time, weight]| {
            sum + weight * libm::exp(-seconds / time)
        })
    }
}

/// Noise of each group of readings.
pub(super) type Noise = [f64; GROUPS];

/// A series with the noise of what it leaves.
#[derive(Clone, Debug)]
pub(super) struct Settled {
    pub(super) series: Series,
    pub(super) noise: Noise,
    /// Bayesian information criterion.
    pub(super) criterion: f64,
}

/// Readings of a series.
pub(super) fn readings(forward: &Forward, series: &Series) -> DVector<f64> {
    let mut sum = forward.settled.clone();
    for [time, weight] in series.terms() {
        sum.axpy(weight, &forward.term(time, series.shift.0), 1.0);
    }
    sum.component_mul_assign(&forward.factors);
    sum * libm::exp(series.modulus.0)
}

/// One over the noise of each target.
pub(super) fn precision(forward: &Forward, noise: &Noise) -> DVector<f64> {
    DVector::from_iterator(
        forward.targets.len(),
        forward
            .targets
            .iter()
            .map(|target| libm::sqrt(target.count) / noise[target.group]),
    )
}

/// Slope of the readings by one of what is varied.
fn slope(forward: &Forward, series: &Series, which: Varied) -> DVector<f64> {
    let modulus = libm::exp(series.modulus.0);
    let term = |i: usize| {
        [
            libm::exp(series.times[i].0),
            modulus * libm::exp(series.weights[i]),
        ]
    };
    match which {
        Varied::Modulus => readings(forward, series),
        Varied::Weight(i) => {
            let [time, weight] = term(i);
            (forward.term(time, series.shift.0) * weight).component_mul(&forward.factors)
        }
        Varied::Time(i) => {
            let [time, weight] = term(i);
            let [later, sooner] =
                [STEP, -STEP].map(|step| forward.term(time * libm::exp(step), series.shift.0));
            ((later - sooner) * (weight / (2.0 * STEP))).component_mul(&forward.factors)
        }
        Varied::Shift => {
            let [more, less] = [STEP, -STEP].map(|step| {
                let mut moved = series.clone();
                moved.shift.0 += step;
                readings(forward, &moved)
            });
            (more - less) / (2.0 * STEP)
        }
    }
}

/// Slopes of the readings by what is varied, over their noise.
pub(super) fn slopes(forward: &Forward, series: &Series, precision: &DVector<f64>) -> DMatrix<f64> {
    let of = |which: Varied| slope(forward, series, which).component_mul(precision);
    DMatrix::from_columns(&series.varied().into_iter().map(of).collect::<Vec<_>>())
}

/// Times, with the weights that are best for them.
struct Problem<'a> {
    forward: &'a Forward,
    series: Series,
    /// Times and shift.
    varied: Vec<Varied>,
    precision: &'a DVector<f64>,
    /// An orthonormal basis of the readings that the weights can give.
    basis: DMatrix<f64>,
}

impl<'a> Problem<'a> {
    fn new(forward: &'a Forward, series: Series, precision: &'a DVector<f64>) -> Self {
        let mut varied = series.varied();
        varied.retain(|which| matches!(which, Varied::Time(_) | Varied::Shift));
        let mut problem = Self {
            forward,
            series,
            varied,
            precision,
            basis: DMatrix::zeros(0, 0),
        };
        problem.solve();
        problem
    }

    /// The weights, and the modulus where it is free.
    fn solve(&mut self) {
        let series = &self.series;
        let mut columns: Vec<DVector<f64>> = series
            .times
            .iter()
            .map(|(time, _)| self.forward.term(libm::exp(*time), series.shift.0))
            .collect();
        let mut target = -left(self.forward, &DVector::zeros(self.precision.len()));
        if series.modulus.1 {
            columns.push(self.forward.settled.clone());
        } else {
            let still = self.forward.settled.component_mul(&self.forward.factors);
            target -= still * libm::exp(series.modulus.0);
        }
        for column in &mut columns {
            column.component_mul_assign(&self.forward.factors);
            column.component_mul_assign(self.precision);
        }
        target.component_mul_assign(self.precision);
        let decomposed = DMatrix::from_columns(&columns).qr();
        self.basis = decomposed.q();
        let solved = decomposed
            .r()
            .solve_upper_triangular(&(self.basis.transpose() * target));
        let logarithm = |value: f64| {
            if value > 0.0 {
                libm::log(value).max(NONE)
            } else {
                NONE
            }
        };
        let Some(solved) = solved else {
            self.series.weights.fill(NONE);
            return;
        };
        let count = self.series.times.len();
        if self.series.modulus.1 {
            self.series.modulus.0 = logarithm(solved[count]);
        }
        let modulus = libm::exp(self.series.modulus.0);
        self.series.weights = solved
            .iter()
            .take(count)
            .map(|weight| logarithm(weight / modulus))
            .collect();
    }
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Problem<'_> {
    type ParameterStorage = Owned<f64, Dyn>;
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;

    fn set_params(&mut self, at: &DVector<f64>) {
        for (&which, &value) in self.varied.iter().zip(at) {
            // Logarithms: no exponential overflows.
            self.series.set(which, value.clamp(-60.0, 60.0));
        }
        self.solve();
    }

    fn params(&self) -> DVector<f64> {
        DVector::from_iterator(
            self.varied.len(),
            self.varied.iter().map(|&which| self.series.get(which)),
        )
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        let readings = readings(self.forward, &self.series);
        Some(left(self.forward, &readings).component_mul(self.precision))
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let of = |&which: &Varied| slope(self.forward, &self.series, which).component_mul(self.precision);
        let slopes = DMatrix::from_columns(&self.varied.iter().map(of).collect::<Vec<_>>());
        let within = &self.basis * (self.basis.transpose() * &slopes);
        Some(slopes - within)
    }
}

/// Readings less what was measured.
pub(super) fn left(forward: &Forward, readings: &DVector<f64>) -> DVector<f64> {
    let measured = forward.targets.iter().map(|target| target.measured);
    readings - DVector::from_iterator(readings.len(), measured)
}

/// Least squares from a start. A time beyond `bounds` (logarithms) is held there.
fn minimise(forward: &Forward, start: &Series, noise: &Noise, bounds: [f64; 2]) -> Series {
    let precision = precision(forward, noise);
    let mut series = start.clone();
    loop {
        let mut problem = Problem::new(forward, series, &precision);
        if !problem.varied.is_empty() {
            (problem, _) = LevenbergMarquardt::new()
                .with_ftol(TOLERANCE)
                .with_xtol(TOLERANCE)
                .with_gtol(0.0)
                .with_patience(PATIENCE)
                .minimize(problem);
        }
        series = problem.series;
        let mut moved = false;
        for (time, held) in &mut series.times {
            let within = time.clamp(bounds[0], bounds[1]);
            if !*held && (*time - within).abs() > 0.0 {
                (*time, *held, moved) = (within, true, true);
            }
        }
        if !moved {
            return series.sorted();
        }
    }
}

/// Noise of what is left with so many parameters, and the criterion.
fn judge(forward: &Forward, series: &Series) -> (Noise, f64) {
    let left = left(forward, &readings(forward, series));
    let spent = series.varied().len() as f64;
    let all = left.len() as f64;
    let mut squares = [0.0; GROUPS];
    let mut counts = [0.0; GROUPS];
    let mut least = [0.0; GROUPS];
    for (target, left) in forward.targets.iter().zip(&left) {
        squares[target.group] += target.count * left * left;
        counts[target.group] += 1.0;
        least[target.group] = ROUNDING * forward.largest(target.quantity);
    }
    let mut noise = [1.0; GROUPS];
    let mut criterion = spent * libm::log(all);
    for k in 0..GROUPS {
        if counts[k] > 0.0 {
            let free = counts[k] * (1.0 - (spent / all).min(0.9));
            noise[k] = libm::sqrt(squares[k] / free).max(least[k]);
            criterion += counts[k] * libm::log((squares[k] / counts[k]).max(least[k] * least[k]));
        }
    }
    (noise, criterion)
}

/// A start without terms.
pub(super) fn begin(forward: &Forward, series: Series) -> Settled {
    let (noise, criterion) = judge(forward, &series);
    Settled {
        series,
        noise,
        criterion,
    }
}

/// Least squares and noise by turns.
pub(super) fn settle(forward: &Forward, start: &Series, noise: &Noise, bounds: [f64; 2]) -> Settled {
    let mut series = start.clone();
    let mut noise = *noise;
    let mut criterion = f64::INFINITY;
    for _ in 0..ROUNDS {
        series = minimise(forward, &series, &noise, bounds);
        (noise, criterion) = judge(forward, &series);
    }
    Settled {
        series,
        noise,
        criterion,
    }
}
