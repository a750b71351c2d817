//! Calibration: bench data and a design -> what the device is, how sure that is, and what the data cannot tell.
//!
//! [`data`] (rows of indentation, force and pressure rise, checked) -> the membrane as the bench would read it, for any
//! values of the [`parameter`]s -> least squares by Levenberg and Marquardt, reweighted robustly, with the noise taken
//! from what is left -> standard errors, correlations, directions that the data do not determine (held, and said) ->
//! [`check`]s: hysteresis, cross-validation, order in what is left.
//!
//! Standard errors are those of noise alone: they hold if the model is right, which [`Fit::systematic`] doubts where what
//! is left has an order.
pub mod check;
pub mod data;
mod identify;
mod model;
mod noise;
pub mod parameter;
mod robust;
mod solve;
pub mod spline;

use crate::design::RestBy;
use crate::design_file::DesignFile;
use crate::membrane::TensionField;
use crate::press::{ModelError, Press, SWEEP};
use check::{Hysteresis, Misfit, Validation};
use data::Data;
use model::{Kind, Model, Target};
use nalgebra::DMatrix;
use parameter::{Parameter, Units, Values};
use solve::{Task, Weighting};
use std::fmt;

pub use identify::Unidentified;
pub use model::Quantity;
pub use noise::Noise;

/// Data so far from the design, as a factor, are in other units or of another device.
const OTHER_UNITS: f64 = 40.0;
/// Stretches over one, and compliances in their unit, that a fit starts from beside the design's.
const STARTS: ([f64; 6], [f64; 2]) = ([0.004, 0.015, 0.05, 0.15, 0.5, 1.3], [0.1, 1.0]);
/// Starts that are followed up.
const FOLLOWED: usize = 2;

/// A parameter of a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Which.
    pub parameter: Parameter,
    /// The design's value.
    pub start: f64,
    /// The fitted value, or the one it was held at.
    pub value: f64,
    /// Its standard error; `None` where it was held, or where there are as many parameters as data.
    pub standard_error: Option<f64>,
    /// Why it was held.
    pub held: Option<Held>,
}

/// Why a parameter was not fitted.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Held {
    /// The data do not tell it from others.
    Unidentified,
    /// The data want it beyond the end of what is possible.
    AtBound,
    /// The design does not rest by a stretch.
    NotOfModel,
}

/// One measured number beside what the design and the fit say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residual {
    /// Index of the row in the data.
    pub row: usize,
    /// What was measured.
    pub quantity: Quantity,
    /// Measured, SI.
    pub measured: f64,
    /// What the design says.
    pub before: f64,
    /// What the fit says.
    pub fitted: f64,
    /// Measured less fitted, in standard deviations.
    pub standardised: f64,
    /// Whether it counted for (almost) nothing.
    pub outlier: bool,
}

/// A calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// Every parameter chosen, fitted or held.
    pub estimates: Vec<Estimate>,
    /// All values.
    pub values: Values,
    /// The parameters that were fitted.
    pub fitted: Vec<Parameter>,
    /// Their correlations; `None` where there are as many parameters as data.
    pub correlations: Option<DMatrix<f64>>,
    /// What the data do not determine.
    pub unidentified: Vec<Unidentified>,
    /// Every measured number.
    pub residuals: Vec<Residual>,
    /// Noise of force and of rise, where they were measured.
    pub noise: [Option<Noise>; 2],
    /// Misfit of the design, force and rise.
    pub before: [Option<Misfit>; 2],
    /// Misfit of the fit.
    pub after: [Option<Misfit>; 2],
    /// Order in the signs of what is left, force and rise, in standard deviations: negative where they cluster.
    pub systematic: [Option<f64>; 2],
    /// Loading against unloading, force and rise.
    pub hysteresis: [Option<Hysteresis>; 2],
    /// What the fit predicts of data it was not fitted to.
    pub validation: Option<Validation>,
    /// The deepest indentation that the press of the fitted device reaches, metres, if the data go beyond it.
    pub press_ends: Option<f64>,
    /// Data less parameters.
    pub freedom: usize,
}

/// Why there is no fit. `Display` is one line with the remedy.
#[derive(Clone, Debug, PartialEq)]
pub enum FitError {
    /// The model has no answer for the design.
    Model(ModelError),
    /// The data are a large factor away from the design.
    Units {
        /// Which of them.
        quantity: Quantity,
        /// Data over design.
        ratio: f64,
    },
    /// There are fewer data than parameters.
    TooFew {
        /// Data.
        data: usize,
        /// Parameters.
        parameters: usize,
    },
    /// The data determine none of the parameters.
    NothingTold,
    /// No parameter was chosen.
    NothingChosen,
    /// The best value of a parameter is nonsense.
    Nonsense {
        /// Which.
        parameter: Parameter,
        /// Its value.
        value: f64,
    },
    /// The method found no least squares.
    Lost,
}

impl From<ModelError> for FitError {
    fn from(error: ModelError) -> Self {
        Self::Model(error)
    }
}

/// Calibrates a design: fits the chosen parameters to the data.
///
/// # Errors
/// [`FitError`].
pub fn fit(file: &DesignFile, data: &Data, chosen: &[Parameter]) -> Result<Fit, FitError> {
    let mut free = chosen.to_vec();
    free.sort_unstable();
    free.dedup();
    let chosen = free.clone();
    if chosen.is_empty() {
        return Err(FitError::NothingChosen);
    }
    let targets = model::targets(data);
    let kind = Kind::of(file)?;
    let start = Values::of(file, pole_stretch(file, kind)?);
    if !rests_by_stretch(file, kind) {
        free.retain(|parameter| *parameter != Parameter::PoleStretch);
    }
    let units = units(file, data);
    let model = Model::new(kind, file, data, &free);
    let before = model.predict(&start, data, &targets)?;
    check_units(&targets, &before)?;
    let found = search(&model, data, &targets, units, &start, free)?;
    let task = Task {
        model: &model,
        data,
        targets: &targets,
        free: &found.free,
        units,
    };
    finish(file, &task, &chosen, &start, &before, &found)
}

/// Where a search ended.
struct Found {
    free: Vec<Parameter>,
    unidentified: Vec<Unidentified>,
    at_bound: Vec<Parameter>,
    values: Values,
    weighting: Weighting,
}

impl Found {
    fn held(&self, parameter: Parameter, by_stretch: bool) -> Option<Held> {
        if self.at_bound.contains(&parameter) {
            Some(Held::AtBound)
        } else if self.free.contains(&parameter) {
            None
        } else if parameter == Parameter::PoleStretch && !by_stretch {
            Some(Held::NotOfModel)
        } else {
            Some(Held::Unidentified)
        }
    }
}

/// Fits the free parameters, and again without those that the data do not tell or that are not possible.
fn search(
    model: &Model,
    data: &Data,
    targets: &[Target],
    units: Units,
    start: &Values,
    mut free: Vec<Parameter>,
) -> Result<Found, FitError> {
    let mut origin = *start;
    let mut unidentified = Vec::new();
    let mut at_bound = Vec::new();
    let (values, weighting) = loop {
        if free.is_empty() {
            return Err(FitError::NothingTold);
        }
        if free.len() > targets.len() {
            return Err(FitError::TooFew {
                data: targets.len(),
                parameters: free.len(),
            });
        }
        let task = Task {
            model,
            data,
            targets,
            free: &free,
            units,
        };
        if unidentified.is_empty()
            && let Some(found) = dependent(&task, &origin)?
        {
            free.retain(|parameter| *parameter != found.held);
            unidentified.push(found);
            continue;
        }
        let (values, weighting) = best(&task, &origin)?;
        let predicted = task.predict(&values)?;
        let jacobian = task.jacobian(&values, &predicted, &weighting.factors())?;
        if let Some(found) = identify::untold(&jacobian, &free, true) {
            free.retain(|parameter| *parameter != found.held);
            unidentified.push(found);
            continue;
        }
        if values.get(Parameter::Compliance) < 0.0 {
            free.retain(|parameter| *parameter != Parameter::Compliance);
            at_bound.push(Parameter::Compliance);
            origin.set(Parameter::Compliance, 0.0);
            continue;
        }
        break (values, weighting);
    };
    for &parameter in &free {
        let value = values.get(parameter);
        let [low, high] = parameter.bounds();
        if (value < low * 1.000_01 && low > 0.0) || value > 0.999 * high {
            return Err(FitError::Nonsense { parameter, value });
        }
    }
    Ok(Found {
        free,
        unidentified,
        at_bound,
        values,
        weighting,
    })
}

/// Standard errors and checks of what was found.
fn finish(
    file: &DesignFile,
    task: &Task<'_>,
    chosen: &[Parameter],
    start: &Values,
    before: &[f64],
    found: &Found,
) -> Result<Fit, FitError> {
    let Found {
        free,
        values,
        weighting,
        ..
    } = found;
    let data = task.data;
    let predicted = task.predict(values)?;
    let jacobian = task.jacobian(values, &predicted, &weighting.factors())?;
    let residuals: Vec<Residual> = task
        .targets
        .iter()
        .enumerate()
        .map(|(i, target)| Residual {
            row: target.row,
            quantity: target.quantity,
            measured: target.measured,
            before: before[i],
            fitted: predicted[i],
            standardised: (target.measured - predicted[i]) / weighting.sigma[i],
            outlier: weighting.outliers[i],
        })
        .collect();
    let counted: Vec<f64> = residuals
        .iter()
        .filter(|residual| !residual.outlier)
        .map(|residual| residual.standardised)
        .collect();
    let slopes = task.slopes(values);
    let covariance =
        identify::covariance(&jacobian, &counted).map(|covariance| &slopes * covariance * slopes.transpose());
    let estimates = chosen
        .iter()
        .map(|&parameter| Estimate {
            parameter,
            start: start.get(parameter),
            value: values.get(parameter),
            standard_error: free
                .iter()
                .position(|&known| known == parameter)
                .and_then(|place| Some(libm::sqrt(covariance.as_ref()?[(place, place)]))),
            held: found.held(parameter, rests_by_stretch(file, task.model.kind)),
        })
        .collect();
    let shape = task.model.shape(values)?;
    let deepest = data
        .rows
        .iter()
        .filter_map(|row| row.indentation)
        .fold(0.0, f64::max);
    let reach = shape.deepest() + 1e-3 * values.get(Parameter::IndentationOffset);
    let of = |quantity: Quantity| -> Vec<&Residual> {
        residuals
            .iter()
            .filter(|residual| residual.quantity == quantity)
            .collect()
    };
    let both = [of(Quantity::Force), of(Quantity::Rise)];
    let misfit = |value: fn(&Residual) -> f64| {
        both.each_ref().map(|residuals| {
            Misfit::of(
                residuals
                    .iter()
                    .filter(|r| !r.outlier)
                    .map(|r| [r.measured, value(r)]),
            )
        })
    };
    Ok(Fit {
        before: misfit(|residual| residual.before),
        after: misfit(|residual| residual.fitted),
        systematic: both.each_ref().map(|residuals| check::order(data, residuals)),
        hysteresis: both.each_ref().map(|residuals| Hysteresis::of(data, residuals)),
        noise: [0, 1].map(|k| (!both[k].is_empty()).then_some(weighting.noise[k])),
        validation: check::validate(file, task, values, weighting),
        correlations: covariance.as_ref().map(identify::correlations),
        press_ends: (shape.ends && deepest > reach).then_some(reach),
        freedom: counted.len().saturating_sub(free.len()),
        estimates,
        unidentified: found.unidentified.clone(),
        residuals,
        values: *values,
        fitted: free.clone(),
    })
}

/// Whether the rest state can be given by a stretch: a membrane's always, that of a wall if its design does so.
fn rests_by_stretch(file: &DesignFile, kind: Kind) -> bool {
    matches!(kind, Kind::Membrane) || matches!(file.design().rest, RestBy::PoleStretch(_))
}

/// Stretch of the pole at rest; 1 of a wall that does not rest by one.
fn pole_stretch(file: &DesignFile, kind: Kind) -> Result<f64, ModelError> {
    match (kind, file.design().rest) {
        (_, RestBy::PoleStretch(stretch)) => Ok(stretch),
        (Kind::Wall(_), _) => Ok(1.0),
        (Kind::Membrane, _) => {
            let press = Press::<_, 5>::with_resolution(&file.design(), TensionField::Relaxed, SWEEP)?;
            Ok(press.rest().pole_stretch)
        }
    }
}

/// What would be a large change of the parameters that are no factors.
fn units(file: &DesignFile, data: &Data) -> Units {
    let largest = |of: fn(&data::Row) -> Option<f64>| data.rows.iter().filter_map(of).fold(0.0, f64::max);
    let radius = file.membrane.radial_semi_axis_mm;
    let deepest = match 1e3 * largest(|row| row.indentation) {
        0.0 => 0.3 * file.membrane.axial_semi_axis_mm,
        deepest => deepest,
    };
    let rise = match 1e-3 * largest(|row| row.rise) {
        // The force spread over a contact of that depth; 1 N/mm^2 is 1000 kPa.
        0.0 => 1e3 * largest(|row| row.force) / (core::f64::consts::PI * radius * deepest),
        rise => rise,
    };
    Units {
        // The volume that the plate takes, over the pressure that it meets.
        compliance: core::f64::consts::PI * radius * deepest * deepest / rise,
        indentation: 0.1 * deepest,
        rise: 0.1 * rise,
    }
}

/// Data of another unit or device are no work for a fit.
fn check_units(targets: &[Target], predicted: &[f64]) -> Result<(), FitError> {
    for quantity in [Quantity::Force, Quantity::Rise] {
        let ratios: Vec<f64> = targets
            .iter()
            .zip(predicted)
            .filter(|(target, predicted)| {
                target.quantity == quantity && target.measured > 0.0 && **predicted > 0.0
            })
            .map(|(target, predicted)| target.measured / predicted)
            .collect();
        let ratio = robust::median(&ratios);
        if !ratios.is_empty() && !(1.0 / OTHER_UNITS..=OTHER_UNITS).contains(&ratio) {
            return Err(FitError::Units { quantity, ratio });
        }
    }
    Ok(())
}

/// Parameters that act as one, found before anything is fitted.
fn dependent(task: &Task<'_>, start: &Values) -> Result<Option<Unidentified>, FitError> {
    let sigma = Weighting::unknown(task.targets).sigma;
    let factors: Vec<f64> = sigma.iter().map(|sigma| 1.0 / sigma).collect();
    let jacobian = task.jacobian(start, &task.predict(start)?, &factors)?;
    Ok(identify::untold(&jacobian, task.free, false))
}

/// The best of the fits from several starts.
fn best(task: &Task<'_>, start: &Values) -> Result<(Values, Weighting), FitError> {
    let weighting = Weighting::unknown(task.targets);
    let cost = |values: &Values, factor: f64| -> Option<f64> {
        let predicted = task.predict(values).ok()?;
        let squares = predicted.iter().zip(task.targets).zip(&weighting.sigma);
        Some(
            squares
                .map(|((predicted, target), sigma)| (factor * predicted - target.measured) / sigma)
                .map(|residual| residual * residual)
                .sum(),
        )
    };
    let mut starts = vec![(cost(start, 1.0).unwrap_or(f64::INFINITY), *start)];
    if task.free.contains(&Parameter::PoleStretch) && task.model.kind.is_cheap() {
        let free_compliance = task.free.contains(&Parameter::Compliance);
        let (stretches, compliances) = STARTS;
        let given = start.get(Parameter::PoleStretch) - 1.0;
        for over_one in [given].into_iter().chain(stretches) {
            for unit in [0.0].into_iter().chain(compliances) {
                let mut values = *start;
                values.set(Parameter::PoleStretch, 1.0 + over_one);
                if free_compliance {
                    values.set(Parameter::Compliance, unit * task.units.compliance);
                } else if unit > 0.0 {
                    continue;
                }
                let factor = if task.free.contains(&Parameter::Material) {
                    proportion(task, &values, &weighting.sigma)
                } else {
                    Some(1.0)
                };
                let Some(factor) = factor.filter(|factor| (0.02..50.0).contains(factor)) else {
                    continue;
                };
                let Some(cost) = cost(&values, factor) else {
                    continue;
                };
                // The same curve, so many times as high: the fluid then gives as much at as many times the pressure.
                values.set(Parameter::Material, factor * values.get(Parameter::Material));
                values.set(Parameter::Compliance, values.get(Parameter::Compliance) / factor);
                starts.push((cost, values));
            }
        }
    }
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut found: Option<(f64, Values)> = None;
    for (_, from) in starts.iter().take(FOLLOWED) {
        let Ok(values) = task.minimise(from, &weighting) else {
            continue;
        };
        if let Some(cost) = cost(&values, 1.0)
            && found.is_none_or(|(least, _)| cost < least)
        {
            found = Some((cost, values));
        }
    }
    let (_, values) = found.ok_or(FitError::Lost)?;
    Ok(task.settle(&values)?)
}

/// What a prediction has to be multiplied by to meet the data best.
fn proportion(task: &Task<'_>, values: &Values, sigma: &[f64]) -> Option<f64> {
    let predicted = task.predict(values).ok()?;
    let (mut above, mut below) = (0.0, 0.0);
    for ((predicted, target), sigma) in predicted.iter().zip(task.targets).zip(sigma) {
        above += predicted * target.measured / (sigma * sigma);
        below += predicted * predicted / (sigma * sigma);
    }
    Some(above / below)
}

impl fmt::Display for FitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Model(error) => error.fmt(f),
            Self::Units { quantity, ratio } => write!(
                f,
                "the {quantity} of the data is {ratio:.3} times what the design gives at the same places: check the units \
                 (N, kPa, mm) and the design"
            ),
            Self::TooFew { data, parameters } => write!(
                f,
                "{data} measured numbers cannot determine {parameters} parameters: measure more, or fit fewer"
            ),
            Self::NothingTold => write!(
                f,
                "the data determine none of the parameters: measure deeper or with less noise, or fit others"
            ),
            Self::NothingChosen => write!(f, "no parameter is to be fitted: choose at least one"),
            Self::Nonsense { parameter, value } => write!(
                f,
                "the data ask for {parameter} = {value:.4}, which no such device has: check units and design, fit other \
                 parameters, or use --from-data"
            ),
            Self::Lost => write!(
                f,
                "no values of the parameters come near the data: check units and design, or use --from-data"
            ),
        }
    }
}

impl core::error::Error for FitError {}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Force => "force",
            Self::Rise => "pressure rise",
        })
    }
}
