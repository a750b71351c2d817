//! Calibration: bench data and a design -> what the device is, how sure that is, and what the data cannot tell.
//!
//! [`data`] (rows of indentation, force and pressure rise, checked) -> the membrane as the bench would read it, for any
//! values of the [`parameter`]s -> least squares by Levenberg and Marquardt, reweighted robustly, with the noise taken
//! from what is left -> standard errors, correlations, directions that the data do not determine (held, and reported) ->
//! [`check`]s: hysteresis, cross-validation, order in what is left.
//!
//! Standard errors are those of noise alone, with what it costs that the weights are found in the same data (`error_inflation`): they hold
//! if the model is right, which [`Fit::systematic`] doubts where what is left has an order.

mod bias;
pub mod check;
mod clipping;
mod columns;
pub mod data;
mod data_error;
mod error;
mod error_inflation;
pub mod findings;
mod heading;
mod identify;
mod kind;
mod model;
mod noise;
mod non_negative;
pub mod parameter;
mod plausible;
mod ready;
mod record;
pub mod relaxation;
mod robust;
mod search;
mod solve;
pub mod spline;
mod touch;
pub mod trial_zeros;
pub mod write;

use check::{Hysteresis, Misfit, Validation};
use data::Data;
use kind::Kind;
use model::Model;
use model_tables::design::RestBy;
use model_tables::design_file::DesignFile;
use model_tables::membrane::TensionField;
use model_tables::membrane::press::{Press, SWEEP};
use model_tables::model::ModelError;
use nalgebra::DMatrix;
use parameter::{Parameter, ParameterValues, Units};
use search::Found;
use solve::Task;
use trial_zeros::{TrialZero, TrialZeros};

pub use bias::Bias;
pub use error::FitError;
pub use heading::Measured;
pub use identify::Unidentified;
pub use model::{DataQuantity, states_solved};
pub use noise::NoiseModel;
pub use plausible::check_shape;

/// A parameter of a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Which.
    pub parameter: Parameter,
    /// The design's value, in the parameter's unit.
    pub start: f64,
    /// The fitted value, or the one it was held at, in the parameter's unit.
    pub value: f64,
    /// Its standard error, in the parameter's unit; `None` where it was held, or where there are as many parameters as
    /// data.
    pub standard_error: Option<f64>,
    /// Why it was held; `None` where it was fitted.
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
    pub quantity: DataQuantity,
    /// Measured, newtons or pascals.
    pub measured: f64,
    /// The design's prediction, newtons or pascals.
    pub before: f64,
    /// The fit's prediction, newtons or pascals.
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
    pub values: ParameterValues,
    /// The parameters that were fitted.
    pub fitted: Vec<Parameter>,
    /// Their correlations; `None` where there are as many parameters as data.
    pub correlations: Option<DMatrix<f64>>,
    /// What the data do not determine.
    pub unidentified: Vec<Unidentified>,
    /// Every measured number.
    pub residuals: Vec<Residual>,
    /// Noise of force and of rise, where they were measured.
    pub noise: [Option<NoiseModel>; 2],
    /// Misfit of the design, force and rise.
    pub before: [Option<Misfit>; 2],
    /// Misfit of the fit.
    pub after: [Option<Misfit>; 2],
    /// Order in the signs of what is left, force and rise, in standard deviations: negative where they cluster.
    pub systematic: [Option<f64>; 2],
    /// The sign that all, or nearly all, of what is left has: force and rise.
    pub one_sided: [Option<f64>; 2],
    /// Zeros that were found for each trial; empty where none were asked.
    pub trial_zeros: Vec<TrialZero>,
    /// Errors of the bench in what is left, the best founded first.
    pub biases: Vec<Bias>,
    /// Loading against unloading, force and rise.
    pub hysteresis: [Option<Hysteresis>; 2],
    /// What the fit predicts of data it was not fitted to; `None` where the data are too few.
    pub validation: Option<Validation>,
    /// The deepest indentation that the press of the fitted device reaches, metres; `None` where the data end before
    /// it.
    pub press_ends: Option<f64>,
    /// The deepest indentation of the data, from the zeros of their trials on, metres.
    pub deepest: f64,
    /// Data less parameters.
    pub freedom: usize,
}

/// Calibrates a design: fits the chosen parameters to the data.
///
/// # Errors
/// [`FitError`].
pub fn fit(file: &DesignFile, data: &Data, chosen: &[Parameter]) -> Result<Fit, FitError> {
    fit_per_trial(file, data, chosen, &[])
}

/// As [`fit`], with zeros of its own for each trial of the quantities in `per_trial`.
///
/// # Errors
/// [`FitError`].
pub fn fit_per_trial(
    file: &DesignFile,
    data: &Data,
    chosen: &[Parameter],
    per_trial: &[Measured],
) -> Result<Fit, FitError> {
    let mut free = chosen.to_vec();
    free.sort_unstable();
    free.dedup();
    let chosen = free.clone();
    if chosen.is_empty() {
        return Err(FitError::NothingChosen);
    }
    let zeros = TrialZeros::begin(data, per_trial);
    zeros.check(&chosen)?;
    let targets = model::targets(data);
    let kind = Kind::of(file)?;
    let start = ParameterValues::of(file, pole_stretch(file, kind)?);
    if !rests_by_stretch(file, kind) {
        free.retain(|parameter| *parameter != Parameter::PoleStretch);
    }
    let units = units(file, data);
    let model = Model::new(kind, file, data, &free, zeros);
    plausible::check_depth(data, &model.zeros(), model.height()?)?;
    let before = model
        .predict(&start, data, &targets)
        .map_err(|error| plausible::beyond(data, per_trial, error))?;
    plausible::check_swapped(&targets, &before)?;
    plausible::check_units(&targets, &before)?;
    let found = search::search(&model, data, &targets, units, &start, free)?;
    let task = Task {
        model: &model,
        data,
        targets: &targets,
        free: &found.free,
        units,
    };
    finish(file, &task, &chosen, &start, &before, &found)
}

/// Standard errors and checks of what was found.
fn finish(
    file: &DesignFile,
    task: &Task<'_>,
    chosen: &[Parameter],
    start: &ParameterValues,
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
    let columns = task.zero_columns(values, &predicted, &weighting.factors())?;
    let zeros = task.model.zeros();
    let trial_zeros = zeros.found(data, &jacobian, &columns, &counted);
    // What the zeros of the trials take up tells nothing of the parameters.
    let reached = trial_zeros::beside(&jacobian, &columns);
    let jacobian = trial_zeros::off(&columns, jacobian);
    let spent = columns.ncols();
    let covariance = identify::covariance(&jacobian, &counted, spent).map(|covariance| {
        let groups = [DataQuantity::Force, DataQuantity::Rise].map(|quantity| error_inflation::Group {
            members: (0..residuals.len())
                .filter(|&i| residuals[i].quantity == quantity && !residuals[i].outlier)
                .collect(),
            largest: weighting.noise[solve::index(quantity)].largest,
        });
        let wider = error_inflation::factors(&jacobian, &weighting.sigma, &predicted, &groups);
        let wider = DMatrix::from_diagonal(&wider.into());
        &slopes * (&wider * covariance * &wider) * slopes.transpose()
    });
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
    let deepest = zeros.deepest(data);
    let reach = shape.deepest() + 1e-3 * values.get(Parameter::IndentationOffset);
    let of = |quantity: DataQuantity| -> Vec<&Residual> {
        residuals
            .iter()
            .filter(|residual| residual.quantity == quantity)
            .collect()
    };
    let both = [of(DataQuantity::Force), of(DataQuantity::Rise)];
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
        one_sided: both.each_ref().map(|residuals| check::one_sided(residuals)),
        biases: biases(task, values, &weighting.factors(), &reached, &residuals),
        trial_zeros,
        systematic: both.each_ref().map(|residuals| check::order(data, residuals)),
        hysteresis: both.each_ref().map(|residuals| Hysteresis::of(data, residuals)),
        noise: [0, 1].map(|k| (!both[k].is_empty()).then_some(weighting.noise[k])),
        validation: check::validate(file, task, values, weighting),
        correlations: covariance.as_ref().map(identify::correlations),
        deepest,
        press_ends: (shape.ends && deepest > reach).then_some(reach),
        freedom: counted.len().saturating_sub(free.len() + spent),
        estimates,
        unidentified: found.unidentified.clone(),
        residuals,
        values: *values,
        fitted: free.clone(),
    })
}

/// Errors of the bench in what a fit leaves.
fn biases(
    task: &Task<'_>,
    values: &ParameterValues,
    factors: &[f64],
    jacobian: &DMatrix<f64>,
    residuals: &[Residual],
) -> Vec<Bias> {
    let fitted: Vec<f64> = residuals.iter().map(|residual| residual.fitted).collect();
    let left: Vec<f64> = residuals
        .iter()
        .map(|residual| residual.measured - residual.fitted)
        .collect();
    bias::find(&bias::Left {
        data: task.data,
        targets: task.targets,
        factors,
        jacobian,
        residuals: &left,
        by_indentation: task.by_indentation(values, &fitted),
    })
}

/// Whether force and pressure of data vanish at the same depth, against the curve of the design with a gain of the transducer and, of a
/// membrane, whatever else is usually fitted; `None` where they do, or where the data do not tell.
pub fn lag(file: &DesignFile, data: &Data) -> Option<Bias> {
    let kind = Kind::of(file).ok()?;
    let start = ParameterValues::of(file, pole_stretch(file, kind).ok()?);
    let targets = model::targets(data);
    let units = units(file, data);
    // A solid's curve is solved once.
    let mut free = vec![Parameter::Material, Parameter::PressureGain];
    if kind.is_cheap() {
        free = vec![
            Parameter::Material,
            Parameter::PoleStretch,
            Parameter::Compliance,
            Parameter::PressureGain,
        ];
    }
    let model = Model::new(kind, file, data, &free, TrialZeros::default());
    let found = search::search(&model, data, &targets, units, &start, free).ok()?;
    let task = Task {
        model: &model,
        data,
        targets: &targets,
        free: &found.free,
        units,
    };
    let fitted = task.predict(&found.values).ok()?;
    let factors = found.weighting.factors();
    let jacobian = task.jacobian(&found.values, &fitted, &factors).ok()?;
    let left: Vec<f64> = targets
        .iter()
        .zip(&fitted)
        .map(|(target, fitted)| target.measured - fitted)
        .collect();
    bias::find(&bias::Left {
        data,
        targets: &targets,
        factors: &factors,
        jacobian: &jacobian,
        residuals: &left,
        by_indentation: task.by_indentation(&found.values, &fitted),
    })
    .into_iter()
    .find(Bias::is_lag)
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
    let largest = |of: fn(&data::DataRow) -> Option<f64>| data.rows.iter().filter_map(of).fold(0.0, f64::max);
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
        force: 0.1 * largest(|row| row.force),
    }
}
