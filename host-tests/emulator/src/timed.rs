//! A press in time: of a wall that relaxes, by force, or onto one object after another. The truth is the product's own
//! model: the solid in time, or the elastic press onto each object.

use crate::scenario::Scenario;
use model_tables::curve::{Contact, Curve};
use model_tables::solid::history::{Drive, History, HistoryError};

/// Instants of a phase in which the plate moves.
const MOVING: u32 = 120;
/// The same where it stands; they lie closer after the change that went before.
const STANDING: u32 = 60;
/// First instant of a phase in which the plate stands, seconds.
const SOON: f64 = 1e-3;
/// Halvings in search of the indentation at a force.
const HALVINGS: u32 = 60;

/// The contact over time, linear between instants.
#[derive(Clone, Debug)]
pub struct TimedPress {
    /// Times in seconds, increasing, and the contact at each.
    points: Vec<(f64, Contact)>,
}

/// Where a phase ends.
#[derive(Clone, Copy)]
enum Goal {
    /// Metres.
    Indentation(f64),
    /// Newtons.
    Force(f64),
}

impl TimedPress {
    /// The solid in time goes through the phases of `scenario`; 100 % is `max_indentation`, metres. The plate keeps the force or the
    /// indentation that the last phase with one gave it.
    ///
    /// # Errors
    /// [`HistoryError`] where the solid has no state.
    pub(crate) fn relaxing(
        mut history: History,
        scenario: &Scenario,
        max_indentation: f64,
    ) -> Result<Self, HistoryError> {
        let mut points = vec![(0.0, Contact::default())];
        let (mut begin, mut goal) = (0.0, Goal::Force(0.0));
        for phase in &scenario.phase {
            let seconds = phase.duration_ms * 1e-3;
            let asked = goal_of(phase.to_percent, phase.to_force_n, max_indentation);
            let from = history.now();
            goal = asked.unwrap_or(goal);
            let count = if asked.is_some() { MOVING } else { STANDING };
            for k in 1..=count {
                let part = f64::from(k) / f64::from(count);
                let passed = if asked.is_some() {
                    part * seconds
                } else {
                    SOON * libm::pow((seconds / SOON).max(1.0), part)
                };
                let share = if asked.is_some() { part } else { 1.0 };
                let drive = match goal {
                    Goal::Indentation(metres) => {
                        Drive::Indentation(from.indentation + share * (metres - from.indentation))
                    }
                    Goal::Force(newtons) => Drive::Force(from.force + share * (newtons - from.force)),
                };
                let now = history.advance(begin + passed, drive)?;
                let contact = Contact {
                    pressure_rise: now.pressure_rise,
                    force: now.force,
                    indentation: now.indentation,
                };
                points.push((begin + passed, contact));
            }
            begin += seconds;
        }
        Ok(Self { points })
    }

    /// Elastic presses through the phases of `scenario`, each onto the object of its phase by its curve in `onto`.
    pub(crate) fn elastic(onto: &[Curve], scenario: &Scenario, max_indentation: f64) -> Self {
        let mut points = vec![(0.0, Contact::default())];
        let (mut begin, mut indentation) = (0.0, 0.0);
        for (phase, curve) in scenario.phase.iter().zip(onto) {
            let seconds = phase.duration_ms * 1e-3;
            let from = curve.at_indentation(indentation);
            let goal = goal_of(phase.to_percent, phase.to_force_n, max_indentation);
            for k in 1..=MOVING {
                let part = f64::from(k) / f64::from(MOVING);
                indentation = match goal {
                    None => from.indentation,
                    Some(Goal::Indentation(metres)) => from.indentation + part * (metres - from.indentation),
                    Some(Goal::Force(newtons)) => {
                        indentation_at(curve, from.force + part * (newtons - from.force))
                    }
                };
                points.push((begin + part * seconds, curve.at_indentation(indentation)));
            }
            begin += seconds;
        }
        Self { points }
    }

    /// The contact at a time in seconds; after the end, the last.
    pub fn at(&self, time: f64) -> Contact {
        let next = self.points.partition_point(|point| point.0 <= time);
        let Some(&(until, to)) = self.points.get(next) else {
            return self.points[self.points.len() - 1].1;
        };
        let (since, from) = self.points[next.max(1) - 1];
        let share = if until > since {
            ((time - since) / (until - since)).max(0.0)
        } else {
            0.0
        };
        let mix = |from: f64, to: f64| from + share * (to - from);
        Contact {
            pressure_rise: mix(from.pressure_rise, to.pressure_rise),
            force: mix(from.force, to.force),
            indentation: mix(from.indentation, to.indentation),
        }
    }

    /// The lowest and the highest pressure rise between two times, pascals.
    pub(crate) fn pressure_rises(&self, from: f64, until: f64) -> [f64; 2] {
        let begin = self.points.partition_point(|point| point.0 < from);
        let end = self.points.partition_point(|point| point.0 < until).max(begin);
        self.points[begin..end]
            .iter()
            .map(|point| point.1)
            .chain([self.at(from), self.at(until)])
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], contact| {
                [low.min(contact.pressure_rise), high.max(contact.pressure_rise)]
            })
    }

    /// The largest true force, newtons.
    pub fn peak_force(&self) -> f64 {
        self.points.iter().map(|point| point.1.force).fold(0.0, f64::max)
    }
}

/// Where a phase ends; `None`: nothing changes.
fn goal_of(to_percent: Option<f64>, to_force: Option<f64>, max_indentation: f64) -> Option<Goal> {
    to_force
        .map(Goal::Force)
        .or_else(|| to_percent.map(|percent| Goal::Indentation(percent * 1e-2 * max_indentation)))
}

/// The indentation of a curve at a force, metres: force rises with indentation.
fn indentation_at(curve: &Curve, force: f64) -> f64 {
    let (mut low, mut high) = (0.0, curve.end().indentation);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if curve.at_indentation(middle).force < force {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::tests::{closed_form, press, ramp};

    #[test]
    fn a_press_by_force_has_that_force_and_then_the_way_back() {
        let mut scenario = ramp();
        let curve = press(8e3, ramp()).curve().clone();
        let force = 0.4 * curve.end().force;
        scenario.phase[1].to_percent = None;
        scenario.phase[1].to_force_n = Some(force);
        let timed = TimedPress::elastic(
            &[curve.clone(), curve.clone(), curve.clone()],
            &scenario,
            curve.end().indentation,
        );
        assert_eq!(timed.at(0.05), Contact::default());
        // The ramp goes from 0.1 s to 0.5 s.
        assert!((timed.at(0.3).force / (0.5 * force) - 1.0).abs() < 1e-3);
        for time in [0.5, 0.55, 9.0] {
            let held = timed.at(time);
            assert!((held.force / force - 1.0).abs() < 1e-6, "{held:?}");
            let expected = closed_form(held.pressure_rise);
            assert!((expected.force / force - 1.0).abs() < 1e-5, "{expected:?}");
        }
        assert!((timed.peak_force() / force - 1.0).abs() < 1e-6);
        let [low, high] = timed.pressure_rises(0.3, 0.6);
        assert!((low - timed.at(0.3).pressure_rise).abs() < 1e-9 && low < high);
        assert!((high - timed.at(0.55).pressure_rise).abs() < 1e-6);
    }
}
