//! The search for the least squares: several starts, and again without the parameters that the data do not tell or that are not
//! possible.

use super::Held;
use super::data::Data;
use super::error::FitError;
use super::identify::{self, Unidentified};
use super::model::{Model, Target};
use super::parameter::{Parameter, ParameterValues, Units};
use super::solve::{Task, Weighting};

/// Stretches over one, and compliances in their unit, that a fit starts from beside the design's.
const STARTS: ([f64; 6], [f64; 2]) = ([0.004, 0.015, 0.05, 0.15, 0.5, 1.3], [0.1, 1.0]);
/// Starts that are followed up.
const FOLLOWED: usize = 2;

/// Where a search ended.
pub(super) struct Found {
    pub(super) free: Vec<Parameter>,
    pub(super) unidentified: Vec<Unidentified>,
    at_bound: Vec<Parameter>,
    pub(super) values: ParameterValues,
    pub(super) weighting: Weighting,
}

impl Found {
    pub(super) fn held(&self, parameter: Parameter, by_stretch: bool) -> Option<Held> {
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
pub(super) fn search(
    model: &Model,
    data: &Data,
    targets: &[Target],
    units: Units,
    start: &ParameterValues,
    mut free: Vec<Parameter>,
) -> Result<Found, FitError> {
    let mut origin = *start;
    let mut unidentified = Vec::new();
    let mut at_bound = Vec::new();
    let (values, weighting) = loop {
        if free.is_empty() {
            return Err(FitError::NothingTold);
        }
        let parameters = free.len() + model.zeros().count();
        if parameters > targets.len() {
            return Err(FitError::TooFew {
                data: targets.len(),
                parameters,
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
        let jacobian = task.told(&values, &predicted, &weighting.factors())?;
        if let Some(found) = identify::unidentifiable(&jacobian, &free, true) {
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

/// Parameters that act as one, found before anything is fitted.
fn dependent(task: &Task<'_>, start: &ParameterValues) -> Result<Option<Unidentified>, FitError> {
    let sigma = Weighting::unknown(task.targets).sigma;
    let factors: Vec<f64> = sigma.iter().map(|sigma| 1.0 / sigma).collect();
    let jacobian = task.told(start, &task.predict(start)?, &factors)?;
    Ok(identify::unidentifiable(&jacobian, task.free, false))
}

/// The best of the fits from several starts.
fn best(task: &Task<'_>, start: &ParameterValues) -> Result<(ParameterValues, Weighting), FitError> {
    let weighting = Weighting::unknown(task.targets);
    let cost = |values: &ParameterValues, factor: f64| -> Option<f64> {
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
    let mut found: Option<(f64, ParameterValues)> = None;
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
    if task.model.is_spent() {
        return Err(FitError::Unsettled);
    }
    let (_, values) = found.ok_or(FitError::Lost)?;
    let settled = task.settle(&values)?;
    if task.model.is_spent() {
        return Err(FitError::Unsettled);
    }
    Ok(settled)
}

/// What a prediction has to be multiplied by to meet the data best.
fn proportion(task: &Task<'_>, values: &ParameterValues, sigma: &[f64]) -> Option<f64> {
    let predicted = task.predict(values).ok()?;
    let (mut above, mut below) = (0.0, 0.0);
    for ((predicted, target), sigma) in predicted.iter().zip(task.targets).zip(sigma) {
        above += predicted * target.measured / (sigma * sigma);
        below += predicted * predicted / (sigma * sigma);
    }
    Some(above / below)
}
