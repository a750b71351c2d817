//! Whether data can be those of the design: depth against height, columns in each other's place, units.

use super::Measured;
use super::data::Data;
use super::error::FitError;
use super::model::{DataQuantity, Target};
use super::robust;
use super::touch;
use super::trial_zeros::TrialZeros;
use model_tables::design::RestBy;
use model_tables::design_file::DesignFile;
use model_tables::model::ModelError;

/// Data so far from the design, as a factor, are in other units or of another device.
const OTHER_UNITS: f64 = 40.0;
/// Force and pressure rise that are both so many times the design's come of the unit of the indentation, as a rule.
const MUCH_MORE: f64 = 10.0;
/// First touch over the deepest indentation that is no rounding of the stage's zero.
const OFF_ZERO: f64 = 0.1;

/// Refuses data that go deeper than the tip is high, metres.
pub(super) fn check_depth(data: &Data, zeros: &TrialZeros, height: f64) -> Result<(), FitError> {
    let deepest = zeros.deepest(data);
    if deepest > height {
        return Err(FitError::TooDeep { deepest, height });
    }
    Ok(())
}

/// Why the design has no press as deep as the data: first touch is not where the stage reads zero, where the rows tell that.
pub(super) fn beyond(data: &Data, per_trial: &[Measured], error: ModelError) -> FitError {
    let deepest = TrialZeros::default().deepest(data);
    let touch = (0..data.trials.len())
        .filter_map(|trial| touch::find(data, trial))
        .find(|touch| touch.indentation > OFF_ZERO * deepest);
    match touch {
        Some(touch) if !per_trial.contains(&Measured::Indentation) => {
            FitError::NotFromFirstTouch(touch.indentation)
        }
        _ => error.into(),
    }
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
    check_depth(data, &TrialZeros::default(), ROOM * height)
}

/// Part of what a straight line leaves of force and pressure as they are named, over which the other way round is no better.
const SWAPPED: f64 = 0.5;

/// Force and pressure rise in each other's columns: each then runs as the other does in the design, whatever its size and zero.
pub(super) fn check_swapped(targets: &[Target], predicted: &[f64]) -> Result<(), FitError> {
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
pub(super) fn check_units(targets: &[Target], predicted: &[f64]) -> Result<(), FitError> {
    let ratio = |quantity: DataQuantity| {
        let ratios: Vec<f64> = targets
            .iter()
            .zip(predicted)
            .filter(|(target, predicted)| {
                target.quantity == quantity && target.measured > 0.0 && **predicted > 0.0
            })
            .map(|(target, predicted)| target.measured / predicted)
            .collect();
        (!ratios.is_empty()).then(|| robust::median(&ratios))
    };
    let of_force = ratio(DataQuantity::Force);
    let of_rise = ratio(DataQuantity::Rise);
    if let (Some(force), Some(rise)) = (of_force, of_rise)
        && force.min(rise) > MUCH_MORE
        && force.max(rise) > OTHER_UNITS
    {
        return Err(FitError::DepthUnits {
            ratios: [force, rise],
        });
    }
    for (quantity, ratio) in [(DataQuantity::Force, of_force), (DataQuantity::Rise, of_rise)] {
        if let Some(ratio) = ratio
            && !(1.0 / OTHER_UNITS..=OTHER_UNITS).contains(&ratio)
        {
            return Err(FitError::Units { quantity, ratio });
        }
    }
    Ok(())
}
