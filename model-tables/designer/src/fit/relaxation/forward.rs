//! What a wall with a series would have read: quasi-linear, over the settled wall's pressure and force at each indentation.
//!
//! `P = P_e + sum g_i h_i` with `h_i` the convolution of `exp(-t / tau_i)` with the changes of `P_e`. The force is half way between the
//! same
//! convolution of `F_e` and the contact's area times the pressure, `A P` with `A = F_e / P_e`, as on the chip. Both are linear in the
//! weights.
//! Each reading has a factor beside, by which the solid in time differs from this (`solid`).

use super::error::HoldError;
use super::record::HoldRecord;
use crate::fit::heading::Measured;
use model_tables::curve::Curve;
use model_tables::design_file::Calibration;
use model_tables::material::relaxation::Term;
use nalgebra::DVector;

/// Longest part of the depth in which the settled pressure counts as straight.
const STRAIGHT: f64 = 1.0 / 400.0;

/// An instant between which the settled wall's readings change evenly.
#[derive(Clone, Copy, Debug)]
struct Node {
    /// Since the instant before, seconds.
    step: f64,
    pressure: f64,
    force: f64,
    /// Index of the row that it is, if it is one.
    row: Option<usize>,
}

/// A measured number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HoldTarget {
    pub(super) trial: usize,
    pub(super) row: usize,
    pub(super) quantity: Measured,
    /// Without the bench's offset and gain, SI.
    pub(super) measured: f64,
    /// Rows that it is the mean of.
    pub(super) count: f64,
    /// Readings of one noise: pressure or force, pressing or held.
    pub(super) group: usize,
}

/// Groups of readings of one noise.
pub(super) const GROUPS: usize = 4;

/// The record, and what the settled wall would read.
#[derive(Clone, Debug)]
pub(super) struct Forward {
    nodes: Vec<Vec<Node>>,
    /// `[trial][row]`: where its targets are, pressure and force.
    places: Vec<Vec<[Option<usize>; 2]>>,
    pub(super) targets: Vec<HoldTarget>,
    /// The settled wall's readings.
    pub(super) settled: DVector<f64>,
    /// Temperature of each trial less that of the series.
    pub(super) warmer: Vec<f64>,
    /// What the solid in time reads over this model, for each target.
    pub(super) factors: DVector<f64>,
}

impl Forward {
    /// `curve` is that of the settled wall, `temperature` that of the series.
    pub(super) fn new(
        record: &HoldRecord,
        calibration: &Calibration,
        curve: &Curve,
        temperature: f64,
    ) -> Result<Self, HoldError> {
        let mut forward = Self {
            nodes: Vec::new(),
            places: Vec::new(),
            targets: Vec::new(),
            settled: DVector::zeros(0),
            warmer: Vec::new(),
            factors: DVector::zeros(0),
        };
        let mut settled = Vec::new();
        let offset = calibration.pressure_read(0.0);
        for (at, trial) in record.trials.iter().enumerate() {
            let true_depth = calibration.indentation_of(trial.depth);
            if true_depth > curve.end().indentation * (1.0 + 1e-9) {
                return Err(HoldError::TooDeep {
                    title: trial.title(),
                    depth: trial.depth,
                    reason: format!("its press ends at {:.4} mm", 1e3 * curve.end().indentation),
                });
            }
            let mut nodes: Vec<Node> = Vec::new();
            let mut places = Vec::new();
            let mut before = (trial.rows[0].time, 0.0);
            for (i, row) in trial.rows.iter().enumerate() {
                let indentation = if i == 0 {
                    0.0
                } else {
                    calibration.indentation_of(row.indentation).max(0.0)
                };
                let parts = libm::ceil((indentation - before.1).abs() / (STRAIGHT * true_depth)).max(1.0);
                for part in 1..=parts as u32 {
                    let share = f64::from(part) / parts;
                    let there = curve.at_indentation(before.1 + share * (indentation - before.1));
                    nodes.push(Node {
                        step: (row.time - before.0) / parts,
                        pressure: there.pressure_rise,
                        force: there.force,
                        row: (f64::from(part) >= parts).then_some(i),
                    });
                }
                before = (row.time, indentation);
                let mut place = [None; 2];
                let rise = row.rise.map(|rise| (rise - offset) / calibration.pressure_gain);
                let end = nodes[nodes.len() - 1];
                for (k, (quantity, measured, still)) in [
                    (Measured::PressureRise, rise, end.pressure),
                    (Measured::Force, row.force, end.force),
                ]
                .into_iter()
                .enumerate()
                {
                    let Some(measured) = measured else { continue };
                    place[k] = Some(forward.targets.len());
                    forward.targets.push(HoldTarget {
                        trial: at,
                        row: i,
                        quantity,
                        measured,
                        count: row.count,
                        group: 2 * k + usize::from(i >= trial.held_from),
                    });
                    settled.push(still);
                }
                places.push(place);
            }
            forward.nodes.push(nodes);
            forward.places.push(places);
            forward
                .warmer
                .push(trial.temperature.map_or(0.0, |celsius| celsius - temperature));
        }
        forward.factors = DVector::repeat(settled.len(), 1.0);
        forward.settled = DVector::from_vec(settled);
        Ok(forward)
    }

    /// Readings of a term of weight 1, whose time a kelvin shortens by `exp(-shift)`.
    pub(super) fn term(&self, time: f64, shift: f64) -> DVector<f64> {
        let mut readings = DVector::zeros(self.targets.len());
        for ((nodes, places), warmer) in self.nodes.iter().zip(&self.places).zip(&self.warmer) {
            let term = Term {
                time: time * libm::exp(-shift * warmer),
                weight: 1.0,
            };
            let (mut pressure, mut force) = (0.0, 0.0);
            let mut before = [0.0; 2];
            let mut known = (-1.0, term.over(0.0));
            for node in nodes {
                if (node.step - known.0).abs() > 1e-12 * node.step {
                    known = (node.step, term.over(node.step));
                }
                let decay = known.1;
                pressure = decay.left * pressure + decay.taken * (node.pressure - before[0]);
                force = decay.left * force + decay.taken * (node.force - before[1]);
                before = [node.pressure, node.force];
                let Some(row) = node.row else { continue };
                let area = if node.pressure > 0.0 {
                    node.force / node.pressure
                } else {
                    0.0
                };
                let [of_pressure, of_force] = places[row];
                if let Some(at) = of_pressure {
                    readings[at] = pressure;
                }
                if let Some(at) = of_force {
                    readings[at] = 0.5 * (force + area * pressure);
                }
            }
        }
        readings
    }

    /// Largest reading of a quantity.
    pub(super) fn largest(&self, quantity: Measured) -> f64 {
        let of = self.targets.iter().filter(|target| target.quantity == quantity);
        of.fold(0.0, |most, target| most.max(target.measured.abs()))
    }

    /// Target of a reading.
    pub(super) fn place(&self, trial: usize, row: usize, quantity: usize) -> Option<usize> {
        self.places[trial][row][quantity]
    }
}
