//! What a fit found, in words.

use super::check::Misfit;
use super::data::{Data, Direction};
use super::parameter::Parameter;
use super::{Fit, Held, Measured, Unidentified, touch};
use model_tables::design_file::DesignFile;
use output::rows::significant;

/// Order in the signs of what is left, in standard deviations, that is no chance (one in two hundred).
const ORDERED: f64 = -2.58;
/// What is left, in percent of the largest reading, that is more than the noise of a bench.
const LARGE: f64 = 5.0;
/// Correlation that is worth a word.
const CORRELATED: f64 = 0.95;
/// The part of the deepest indentation by which first touch may be off zero.
const WORTH: f64 = 0.02;

/// Names, units and factors of force and pressure rise.
pub const QUANTITIES: [(&str, &str, f64); 2] = [("force", "N", 1.0), ("pressure rise", "kPa", 1e-3)];

fn digits(number: f64) -> String {
    significant(number, 4)
}

/// Why a parameter has the value it has.
pub fn state(held: Option<Held>) -> &'static str {
    match held {
        None => "fitted",
        Some(Held::Unidentified) => "held: the data do not tell it",
        Some(Held::AtBound) => "held: the data want it below zero",
        Some(Held::NotOfModel) => "held: the design does not rest by a stretch",
    }
}

/// What there is to say, one line each.
pub fn findings(file: &DesignFile, data: &Data, fit: &Fit) -> Vec<String> {
    let mut lines = Vec::new();
    for (k, (name, unit, factor)) in QUANTITIES.into_iter().enumerate() {
        if let (Some(before), Some(after)) = (fit.before[k], fit.after[k]) {
            lines.push(format!(
                "{name}: {} {unit} RMS left of {} with the design, {} at most ({:.2} % and {:.2} % of the largest)",
                digits(factor * after.rms),
                digits(factor * before.rms),
                digits(factor * after.largest),
                after.rms_percent(),
                after.largest_percent(),
            ));
        }
    }
    lines.extend(fit.unidentified.iter().map(unidentifiable));
    for estimate in &fit.estimates {
        if estimate.held == Some(Held::AtBound) {
            lines.push(format!(
                "{} was held at {}: the data want it below zero, which no device has",
                estimate.parameter, estimate.value
            ));
        }
    }
    if fit.freedom == 0 {
        lines.push(
            "as many parameters as measured numbers: the fit must meet them, which proves nothing, and has no standard \
             errors"
                .to_owned(),
        );
    }
    if let Some(correlations) = &fit.correlations {
        for i in 0..fit.fitted.len() {
            for j in 0..i {
                let correlation = correlations[(i, j)];
                if correlation.abs() > CORRELATED {
                    lines.push(format!(
                        "{} and {} are told apart badly (correlation {correlation:.3}): each alone is less sure than both \
                         together",
                        fit.fitted[j], fit.fitted[i]
                    ));
                }
            }
        }
    }
    for (k, (name, ..)) in QUANTITIES.into_iter().enumerate() {
        let left = fit.after[k].map_or(0.0, |misfit| misfit.rms_percent());
        if fit.systematic[k].is_none() && left > LARGE {
            lines.push(format!(
                "the model hardly explains the {name}: {left:.0} % of the largest is left, more than the noise of a bench, in data \
                 too few to see an order; try other parameters or --from-data"
            ));
        }
        if let Some(positive) = fit.one_sided[k] {
            lines.push(format!(
                "what is left of the {name} has one sign in {:.0} % of the numbers: measured is {} than the fit",
                100.0 * positive.max(1.0 - positive),
                if positive > 0.5 { "more" } else { "less" }
            ));
        }
        if let Some(order) = fit.systematic[k]
            && order < ORDERED
        {
            lines.push(format!(
                "the model does not explain the {name}: what is left of it has an order ({order:.1} standard deviations \
                 fewer changes of sign than chance), so standard errors are too small; try other parameters or --from-data"
            ));
        }
    }
    lines.extend(fit.biases.iter().map(ToString::to_string));
    lines.extend(first_touch(data, fit));
    let outliers = fit.residuals.iter().filter(|residual| residual.outlier).count();
    if outliers > 0 {
        lines.push(format!(
            "{outliers} of {} measured numbers are outliers and did not count (residuals.csv names them)",
            fit.residuals.len()
        ));
    }
    if data.incomplete > 0 {
        lines.push(format!(
            "{} rows with fewer than two quantities were left out",
            data.incomplete
        ));
    }
    if let Some(reach) = fit.press_ends {
        lines.push(format!(
            "the press of the fitted device ends at {} mm, before the data do: what is beyond was extrapolated",
            digits(1e3 * reach)
        ));
    }
    lines.extend(hysteresis(data, fit));
    lines.extend(validation(fit));
    if file.calibration.pole_stretch.is_none()
        && fit.fitted.contains(&Parameter::PoleStretch)
        && !matches!(file.rest, model_tables::design_file::RestSection::PoleStretch(_))
    {
        lines.push("calibration.pole_stretch now takes the place of [rest]".to_owned());
    }
    lines
}

/// First touch where the stage does not read zero there, and no zero of the indentation was fitted.
fn first_touch(data: &Data, fit: &Fit) -> Option<String> {
    let fitted = fit.fitted.contains(&Parameter::IndentationOffset)
        || fit
            .trial_zeros
            .iter()
            .any(|zero| zero.quantity == Measured::Indentation);
    if fitted {
        return None;
    }
    let touches: Vec<String> = (0..data.trials.len())
        .filter_map(|trial| Some((trial, touch::find(data, trial)?)))
        .filter(|(_, touch)| touch.indentation.abs() > WORTH * fit.deepest)
        .map(|(trial, touch)| {
            let name = &data.trials[trial];
            let of = if name.is_empty() {
                String::new()
            } else {
                format!(" in trial {name}")
            };
            format!(
                "{} mm{of} ({} rows before it)",
                significant(1e3 * touch.indentation, 3),
                touch.before
            )
        })
        .collect();
    (!touches.is_empty()).then(|| {
        format!(
            "first touch is where the stage reads {}: count the indentation from there, or fit it with --per-trial indentation-offset",
            touches.join(", ")
        )
    })
}

fn hysteresis(data: &Data, fit: &Fit) -> Vec<String> {
    let mut lines: Vec<String> = QUANTITIES
        .into_iter()
        .enumerate()
        .filter_map(|(k, (name, unit, factor))| {
            let found = fit.hysteresis[k]?;
            Some(format!(
                "hysteresis: unloading less loading, the {name} differs by {} {unit} on average and by {} {unit} ({:.2} % \
                 of the largest) at most; the fit runs between",
                digits(factor * found.mean),
                digits(factor * found.largest),
                found.percent()
            ))
        })
        .collect();
    let known = |direction| data.rows.iter().any(|row| row.direction == direction);
    if lines.is_empty() && !(known(Direction::Loading) && known(Direction::Unloading)) {
        lines.push("hysteresis is not known: the data have no loading and unloading to compare".to_owned());
    }
    lines
}

fn validation(fit: &Fit) -> Vec<String> {
    let Some(validation) = fit.validation else {
        return vec!["too few data for a cross-validation".to_owned()];
    };
    let part = if validation.by_trial {
        "trial"
    } else {
        "every fifth row"
    };
    [validation.force, validation.rise]
        .into_iter()
        .zip(QUANTITIES)
        .filter_map(|(misfit, (name, unit, factor))| {
            let Misfit { rms, largest, .. } = misfit?;
            Some(format!(
                "cross-validation ({} parts, each {part} predicted from the others): {name} to {} {unit} RMS ({:.2} % of the \
                 largest), {} {unit} at most",
                validation.parts,
                digits(factor * rms),
                misfit?.rms_percent(),
                digits(factor * largest),
            ))
        })
        .collect()
}

/// What the data do not tell, in words.
fn unidentifiable(found: &Unidentified) -> String {
    let held = found.held;
    if let [(only, _)] = found.direction[..] {
        return format!("the data do not tell {only}; it was held at the design's value");
    }
    let parts: Vec<String> = found
        .direction
        .iter()
        .map(|(parameter, part)| format!("{part:+.2} {parameter}"))
        .collect();
    let how = if found.deviation.is_finite() {
        format!("so noisy that it is known to {:.1} only", found.deviation)
    } else {
        "which changes nothing that was measured".to_owned()
    };
    format!(
        "the data do not tell the combination {} (logarithms of factors), {how}; {held} was held at the design's value",
        parts.join(" ")
    )
}
