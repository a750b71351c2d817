//! Press-and-hold records and a design -> the series of its wall, how sure that is, and what the records cannot tell.
//!
//! [`record`] (trials from the untouched tip to the end of a hold) -> `forward` (quasi-linear: the settled wall's pressure and force at
//! each
//! indentation, convolved) -> `least_squares` (times and weights of so many terms) -> `search` (how many: by the Bayesian information
//! criterion) -> `identifiability` (standard errors, depths compared, the relaxed modulus). The reduced model errs by up to 5 % while the plate
//! moves and by
//! 1 % early in a hold; `solid` solves the wall in time with the series found, and what that reads over the reduced model enters the next
//! round, until the series stays.

mod error;
mod forward;
pub mod hold;
mod identifiability;
mod least_squares;
pub mod record;
mod search;
mod solid;

pub use error::HoldError;
pub use identifiability::{DepthComparison, FittedTerm, Identifiability};

use super::check::Misfit;
use super::heading::Measured;
use super::robust;
use forward::{Forward, GROUPS};
use least_squares::{Series, Settled, Varied};
use model_tables::curve::Curve;
use model_tables::design_file::{Axes, DesignFile};
use model_tables::material::relaxation::{Relaxation, Term};
use model_tables::model::choice::elements_in_time;
use model_tables::model::{Fingertip, Kind};
use record::HoldRecord;

/// Shortest time that is looked for, over the shortest interval between rows; the longest over the longest hold.
const TIMES: [f64; 2] = [0.02, 20.0];
/// Shortest relaxation time that a design takes, seconds.
const SHORTEST: f64 = 1e-4;
/// Rounds with the solid, and the one in which the number of terms is searched anew.
const ROUNDS: usize = 8;
const SEARCHED: usize = 2;
/// Change of `g(t)` between two rounds, over it, that is none.
const SETTLED: f64 = 1e-4;
/// Readings at the end of a hold below this part of the settled wall's are no relaxing wall's.
const BELOW_SETTLED: f64 = 0.97;
/// Temperatures of the trials, kelvin apart, from which on the shift is fitted; and its start per kelvin.
const APART: f64 = 1.0;
const FIRST_SHIFT: f64 = 0.1;
/// Sum of the weights below which a wall is elastic: twice the solid's own error in time.
const RELAXES: f64 = 0.005;
/// Readings that a fit takes at least.
const MIN_ROWS: usize = 20;

/// What the solid in time reads over the reduced model, largest difference from 1: pressing and held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolidDifference {
    /// Residual while the plate moves, relative.
    pub pressing: f64,
    /// Residual in the hold, relative.
    pub held: f64,
}

/// A reading beside the fit's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HoldResidual {
    /// Index of the trial.
    pub trial: usize,
    /// Index of the row in it.
    pub row: usize,
    /// What was measured.
    pub quantity: Measured,
    /// Measured, newtons or pascals, without the design's calibration of the transducer.
    pub measured: f64,
    /// The settled wall's reading, newtons or pascals.
    pub settled: f64,
    /// The fit's prediction, newtons or pascals.
    pub fitted: f64,
    /// Measured less fitted, in standard deviations of the noise.
    pub standardised: f64,
}

/// A series found in a record.
#[derive(Clone, Debug, PartialEq)]
pub struct RelaxationFit {
    /// For a design.
    pub series: Relaxation,
    /// The same terms with their errors.
    pub terms: Vec<FittedTerm>,
    /// Relaxed modulus over the design's; 1 where it was held.
    pub modulus: f64,
    /// Standard error of the modulus's logarithm, dimensionless; `None` where it was not fitted.
    pub modulus_error: Option<f64>,
    /// Relaxed moduli over the design's that fit as well, with a series for each; `None` where the modulus is
    /// determined.
    pub open_moduli: Option<[f64; 2]>,
    /// Standard error of the shift, per kelvin; `None` where it was not fitted.
    pub shift_error: Option<f64>,
    /// Depths compared; `None` where the record has one depth.
    pub depths: Option<DepthComparison>,
    /// The solid beside the reduced model, or why it was not solved.
    pub solid: Result<SolidDifference, String>,
    /// Noise of a reading: pressure pressing and held, pascals, force pressing and held, newtons; 0 where nothing was read.
    pub noise: [f64; GROUPS],
    /// What is left: force and pressure, each relative to its largest reading.
    pub misfit: [Option<Misfit>; 2],
    /// Order in the residuals, in standard deviations: negative where signs cluster; `None` where they are too few.
    pub order: Option<f64>,
    /// Every reading.
    pub residuals: Vec<HoldResidual>,
    /// The longest hold, seconds.
    pub hold: f64,
}

impl SolidDifference {
    /// The largest of the factors by which the solid differs from the reduced model.
    fn take(&mut self, forward: &Forward) {
        for (target, factor) in forward.targets.iter().zip(&forward.factors) {
            let most = if target.group % 2 == 0 {
                &mut self.pressing
            } else {
                &mut self.held
            };
            *most = most.max((factor - 1.0).abs());
        }
    }
}

/// Fits the series; with `free_modulus` the relaxed modulus too.
///
/// # Errors
/// [`HoldError`].
pub fn fit_relaxation(
    file: &DesignFile,
    record: &HoldRecord,
    free_modulus: bool,
) -> Result<RelaxationFit, HoldError> {
    let temperatures: Vec<f64> = record
        .trials
        .iter()
        .filter_map(|trial| trial.temperature)
        .collect();
    let mean = temperatures.iter().sum::<f64>() / temperatures.len() as f64;
    let temperature = match (temperatures.is_empty(), file.relaxation) {
        (false, _) => mean,
        (true, Some(series)) => series.temperature,
        (true, None) => 20.0,
    };
    let spread = temperatures
        .iter()
        .fold(0.0_f64, |most, celsius| most.max((celsius - mean).abs()));
    let known = file.relaxation.map_or(0.0, |series| series.shift);
    let tells_shift = temperatures.len() == record.trials.len() && 2.0 * spread > APART;
    let elements = elements_in_time(file.model);
    let curve = curve(file, record)?;
    let mut forward = Forward::new(record, &file.calibration, &curve, temperature)?;
    if forward.targets.len() < MIN_ROWS {
        return Err(HoldError::TooFew(forward.targets.len()));
    }
    if !free_modulus {
        check_settled(record, &forward)?;
    }
    let hold = record
        .trials
        .iter()
        .map(hold::HoldTrial::hold)
        .fold(0.0, f64::max);
    let start = Series {
        times: Vec::new(),
        weights: Vec::new(),
        modulus: (0.0, free_modulus),
        shift: (
            if tells_shift && known <= 0.0 {
                FIRST_SHIFT
            } else {
                known
            },
            tells_shift,
        ),
    };
    let bounds = bounds(record, hold);
    let mut settled = search::search(&forward, start.clone(), bounds);
    if settled.series.weights.is_empty() {
        return Err(HoldError::Elastic);
    }
    let mut difference =
        Err("the design's model is a membrane: a wall in time is solved as a solid".to_owned());
    if let Some(elements) = elements {
        difference = Ok(SolidDifference {
            pressing: 0.0,
            held: 0.0,
        });
        for round in 0..ROUNDS {
            match solid::factors(file, elements, record, &forward, &settled.series) {
                Ok(factors) => forward.factors = factors,
                Err(error) => {
                    difference = Err(error.to_string());
                    break;
                }
            }
            let next = if round == SEARCHED {
                search::search(&forward, start.clone(), bounds)
            } else {
                least_squares::settle(&forward, &settled.series, &settled.noise, bounds)
            };
            if next.series.weights.is_empty() {
                return Err(HoldError::Elastic);
            }
            let moved = moved(&settled.series, &next.series, hold);
            settled = next;
            if round > SEARCHED && moved < SETTLED {
                break;
            }
        }
    }
    if let Ok(difference) = &mut difference {
        difference.take(&forward);
    }
    if settled.series.terms().map(|[_, weight]| weight).sum::<f64>() < RELAXES {
        return Err(HoldError::Elastic);
    }
    let more = search::next(&forward, &settled, bounds);
    Ok(finish(
        record,
        &forward,
        &settled,
        more.as_ref(),
        hold,
        temperature,
        difference,
    ))
}

/// Errors of what was found, and what is left.
fn finish(
    record: &HoldRecord,
    forward: &Forward,
    settled: &Settled,
    more: Option<&Settled>,
    hold: f64,
    temperature: f64,
    solid: Result<SolidDifference, String>,
) -> RelaxationFit {
    let series = &settled.series;
    let errors = identifiability::Errors::of(forward, settled);
    let terms: Vec<Term> = series
        .terms()
        .map(|[time, weight]| Term { time, weight })
        .collect();
    let fitted = least_squares::readings(forward, series);
    let precision = least_squares::precision(forward, &settled.noise);
    let residuals: Vec<HoldResidual> = forward
        .targets
        .iter()
        .enumerate()
        .map(|(i, target)| HoldResidual {
            trial: target.trial,
            row: target.row,
            quantity: target.quantity,
            measured: target.measured,
            settled: forward.settled[i],
            fitted: fitted[i],
            standardised: (target.measured - fitted[i]) * precision[i],
        })
        .collect();
    let of = |quantity: Measured| {
        residuals
            .iter()
            .filter(move |residual| residual.quantity == quantity)
    };
    let misfit = [Measured::Force, Measured::PressureRise]
        .map(|quantity| Misfit::of(of(quantity).map(|residual| [residual.measured, residual.fitted])));
    let orders = [Measured::Force, Measured::PressureRise].map(|quantity| {
        let left: Vec<f64> = of(quantity).map(|residual| residual.standardised).collect();
        robust::runs(&left)
    });
    let order = orders.into_iter().flatten().reduce(f64::min);
    let mut noise = settled.noise;
    for (group, noise) in noise.iter_mut().enumerate() {
        if forward.targets.iter().all(|target| target.group != group) {
            *noise = 0.0;
        }
    }
    RelaxationFit {
        series: Relaxation::new(&terms, temperature, series.shift.0.max(0.0)),
        terms: errors.terms(settled, more, hold),
        modulus: libm::exp(series.modulus.0),
        modulus_error: series.modulus.1.then(|| errors.of_one(Varied::Modulus)),
        open_moduli: identifiability::open_moduli(forward, settled, hold),
        shift_error: series.shift.1.then(|| errors.of_one(Varied::Shift)),
        depths: identifiability::compare_depths(record, forward, settled),
        solid,
        noise,
        misfit,
        order,
        residuals,
        hold,
    }
}

/// The settled wall down to the deepest hold: of the solid that a press in time is of, where there is one.
fn curve(file: &DesignFile, record: &HoldRecord) -> Result<Curve, HoldError> {
    let deepest = record
        .trials
        .iter()
        .fold(0.0_f64, |most, trial| most.max(trial.depth));
    let deepest = file.calibration.indentation_of(deepest);
    let tip = match elements_in_time(file.model) {
        Some(elements) => Fingertip::of(Kind::Solid(elements), &file.design_to(Axes::Outer)),
        None => Fingertip::for_curve(file),
    };
    let mut tip = tip.map_err(|error| HoldError::Model(error.to_string()))?;
    tip.curve(deepest).map_err(|error| {
        let deep = record.trials.iter().max_by(|a, b| a.depth.total_cmp(&b.depth));
        HoldError::TooDeep {
            title: deep.map_or_else(String::new, hold::HoldTrial::title),
            depth: deepest,
            reason: error.to_string(),
        }
    })
}

/// Logarithms of the times that are looked for.
fn bounds(record: &HoldRecord, hold: f64) -> [f64; 2] {
    let pairs = record.trials.iter().flat_map(|trial| trial.rows.windows(2));
    let shortest = pairs.map(|pair| pair[1].time - pair[0].time).fold(hold, f64::min);
    [
        libm::log((TIMES[0] * shortest).max(SHORTEST)),
        libm::log((TIMES[1] * hold).min(identifiability::LONGEST)),
    ]
}

/// Largest change of `g(t)` over it, from the shortest times to the end of the hold.
fn moved(before: &Series, after: &Series, hold: f64) -> f64 {
    (0..=40).fold(0.0, |most: f64, i| {
        let time = hold * libm::pow(10.0, -0.1 * f64::from(i));
        most.max((after.stiffness(time) / before.stiffness(time) - 1.0).abs())
    })
}

/// Refuses a hold that ends below the settled wall.
fn check_settled(record: &HoldRecord, forward: &Forward) -> Result<(), HoldError> {
    for (at, trial) in record.trials.iter().enumerate() {
        for (k, quantity) in ["pressure rise", "force"].into_iter().enumerate() {
            let place = (0..trial.rows.len())
                .rev()
                .find_map(|row| forward.place(at, row, k));
            let Some(place) = place else { continue };
            let ratio = forward.targets[place].measured / forward.settled[place];
            if ratio < BELOW_SETTLED {
                return Err(HoldError::BelowSettled {
                    title: trial.title(),
                    quantity,
                    ratio,
                });
            }
        }
    }
    Ok(())
}
