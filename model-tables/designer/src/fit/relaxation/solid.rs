//! The solid in time beside the reduced model: the factors between their readings.

use super::forward::Forward;
use super::least_squares::{Series, readings};
use super::record::HoldRecord;
use model_tables::design_file::{Axes, DesignFile};
use model_tables::material::relaxation::{Relaxation, Term};
use model_tables::solid::history::{Drive, History, HistoryError};
use model_tables::solid::mesh::Elements;
use nalgebra::DVector;

/// Readings below this part of the largest have no factor.
const MIN_REDUCED: f64 = 1e-3;

/// What the solid reads over what the reduced model reads with a series, for each target.
///
/// # Errors
/// [`HistoryError`] where the solid has no press in time.
pub(super) fn factors(
    file: &DesignFile,
    elements: Elements,
    record: &HoldRecord,
    forward: &Forward,
    series: &Series,
) -> Result<DVector<f64>, HistoryError> {
    let terms: Vec<Term> = series
        .terms()
        .map(|[time, weight]| Term { time, weight })
        .collect();
    let relaxation = Relaxation::new(&terms, 0.0, series.shift.0.max(0.0));
    let reduced = readings(forward, series).component_div(&forward.factors);
    let modulus = libm::exp(series.modulus.0);
    let mut largest = [0.0_f64; 2];
    for (target, reading) in forward.targets.iter().zip(&reduced) {
        let most = &mut largest[target.group / 2];
        *most = most.max(reading.abs());
    }
    let mut factors = DVector::repeat(forward.targets.len(), 1.0);
    let design = file.design_to(Axes::Outer);
    for (at, trial) in record.trials.iter().enumerate() {
        let begin = trial.rows[0].time;
        let mut history = History::new(&design, &relaxation.at(forward.warmer[at]), elements, begin, 0.0)?;
        for (i, row) in trial.rows.iter().enumerate().skip(1) {
            let indentation = file.calibration.indentation_of(row.indentation).max(0.0);
            let instant = history.advance(row.time, Drive::Indentation(indentation))?;
            for (k, truth) in [instant.pressure_rise, instant.force].into_iter().enumerate() {
                if let Some(place) = forward.place(at, i, k)
                    && reduced[place] > MIN_REDUCED * largest[k]
                {
                    factors[place] = modulus * truth / reduced[place];
                }
            }
        }
    }
    Ok(factors)
}
