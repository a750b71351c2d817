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
mod ready;
mod record;
pub mod relaxation;
mod robust;
mod search;
mod solve;
pub mod spline;
pub mod write;

use check::{Hysteresis, Misfit, Validation};
use data::Data;
use kind::Kind;
use model::{Model, Target};
use model_tables::design::RestBy;
use model_tables::design_file::DesignFile;
use model_tables::membrane::TensionField;
use model_tables::membrane::press::{Press, SWEEP};
use model_tables::model::ModelError;
use nalgebra::DMatrix;
use parameter::{Parameter, ParameterValues, Units};
use search::Found;
use solve::Task;

pub use bias::Bias;
pub use error::FitError;
pub use heading::Measured;
pub use identify::Unidentified;
pub use model::{DataQuantity, states_solved};
pub use noise::NoiseModel;

/// Data so far from the design, as a factor, are in other units or of another device.
const OTHER_UNITS: f64 = 40.0;

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
    /// Errors of the bench in what is left, the best founded first.
    pub biases: Vec<Bias>,
    /// Loading against unloading, force and rise.
    pub hysteresis: [Option<Hysteresis>; 2],
    /// What the fit predicts of data it was not fitted to; `None` where the data are too few.
    pub validation: Option<Validation>,
    /// The deepest indentation that the press of the fitted device reaches, metres; `None` where the data end before
    /// it.
    pub press_ends: Option<f64>,
    /// Data less parameters.
    pub freedom: usize,
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
    let start = ParameterValues::of(file, pole_stretch(file, kind)?);
    if !rests_by_stretch(file, kind) {
        free.retain(|parameter| *parameter != Parameter::PoleStretch);
    }
    let units = units(file, data);
    let model = Model::new(kind, file, data, &free);
    check_depth(data, model.height()?)?;
    let before = model.predict(&start, data, &targets)?;
    check_swapped(&targets, &before)?;
    check_units(&targets, &before)?;
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
    let covariance = identify::covariance(&jacobian, &counted).map(|covariance| {
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
    let deepest = data
        .rows
        .iter()
        .filter_map(|row| row.indentation)
        .fold(0.0, f64::max);
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
        biases: biases(task, values, &weighting.factors(), &jacobian, &residuals),
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

/// Refuses data that go deeper than the tip is high, metres.
fn check_depth(data: &Data, height: f64) -> Result<(), FitError> {
    let deepest = data
        .rows
        .iter()
        .filter_map(|row| row.indentation)
        .fold(0.0, f64::max);
    if deepest > height {
        return Err(FitError::TooDeep { deepest, height });
    }
    Ok(())
}

/// Height that a tip may have over a guess of it from its dimensions.
const ROOM: f64 = 1.3;

/// Refuses data that no press of the design's shape has, for curves that are made without its model.
///
/// # Errors
/// [`FitError`].
pub fn check_shape(file: &DesignFile, data: &Data) -> Result<(), FitError> {
    let design = file.design();
    let made = design.membrane.axial_semi_axis;
    let height = match design.rest {
        RestBy::Unstretched | RestBy::Pressure(_) => made,
        RestBy::PoleStretch(stretch) => stretch * made,
        RestBy::Height(height) => height,
        RestBy::EquatorRadius(radius) => made * radius / design.membrane.radial_semi_axis,
    };
    check_depth(data, ROOM * height)
}

/// Part of what a straight line leaves of force and pressure as they are named, over which the other way round is no better.
const SWAPPED: f64 = 0.5;

/// Force and pressure rise in each other's columns: each then runs as the other does in the design, whatever its size and zero.
fn check_swapped(targets: &[Target], predicted: &[f64]) -> Result<(), FitError> {
    // Of each row that has both: measured and predicted force, then rise.
    let mut rows: Vec<[[f64; 2]; 2]> = Vec::new();
    for (i, force) in targets.iter().enumerate() {
        if let Some(rise) = targets.get(i + 1)
            && (force.quantity, rise.quantity) == (DataQuantity::Force, DataQuantity::Rise)
            && force.row == rise.row
        {
            rows.push([[force.measured, predicted[i]], [rise.measured, predicted[i + 1]]]);
        }
    }
    if rows.len() < robust::MIN_RESIDUALS {
        return Ok(());
    }
    let left = |measured: usize, by: usize| {
        let pairs: Vec<[f64; 2]> = rows.iter().map(|row| [row[by][1], row[measured][0]]).collect();
        robust::left_of_line(&pairs)
    };
    if left(0, 1) + left(1, 0) < SWAPPED * (left(0, 0) + left(1, 1)) {
        return Err(FitError::Swapped);
    }
    Ok(())
}

/// Data of another unit or device are no work for a fit.
fn check_units(targets: &[Target], predicted: &[f64]) -> Result<(), FitError> {
    for quantity in [DataQuantity::Force, DataQuantity::Rise] {
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
