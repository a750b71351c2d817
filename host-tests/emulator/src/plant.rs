//! The fingertip, the plate that presses it and the transducer in its fluid: time to a voltage.

use crate::scenario::Scenario;
use crate::timed::TimedPress;
use crate::transducer::{ElectricalOutput, EmulatedTransducer, Part, Wiring};
use model_tables::curve::{Contact, Curve};
use model_tables::generate::feedback::FeedbackCurve;
use model_tables::random::Random;
use std::sync::Arc;

/// A report is made of samples up to one period before and after its time, and a part takes up to a period to measure one.
const REACH: f64 = 1.5;

/// The world outside the board. Its truth is the full model, solved afresh: it knows no table.
#[derive(Clone, Debug)]
pub struct Plant {
    curve: Curve,
    /// Gauge pressure of the untouched fingertip, pascals.
    rest_pressure: f64,
    /// The deepest the design is made for, metres.
    max_indentation: f64,
    transducer: EmulatedTransducer,
    scenario: Scenario,
    noise: Random,
    /// Shares of reading of force and indentation that the tables may be off.
    tables_allowed: [f64; 2],
    /// The feedback actuator at the other end of the line; `None`: there is none that presses.
    feedback: Option<FeedbackCurve>,
    /// The contact in time, where the scenario is not a travel on an elastic plate's curve.
    timed: Option<Arc<TimedPress>>,
    /// A share of the largest indentation and its pressure rise: most of the time the plate stands still.
    last: (f64, f64),
}

impl Plant {
    /// The fingertip whose press is `curve`, going through `scenario`.
    pub fn new(
        curve: Curve,
        rest_pressure: f64,
        max_indentation: f64,
        transducer: EmulatedTransducer,
        scenario: Scenario,
    ) -> Self {
        let noise = Random(scenario.seed);
        Self {
            curve,
            rest_pressure,
            max_indentation,
            transducer,
            scenario,
            noise,
            tables_allowed: [0.0; 2],
            feedback: None,
            timed: None,
            last: (0.0, 0.0),
        }
    }

    /// The same where the tables may be off by these shares of reading of force and indentation.
    #[must_use]
    pub fn with_tables_allowed(self, tables_allowed: [f64; 2]) -> Self {
        Self {
            tables_allowed,
            ..self
        }
    }

    /// The same with a feedback actuator at the other end of the line, which `curve` knows of.
    #[must_use]
    pub fn with_feedback(self, feedback: Option<FeedbackCurve>) -> Self {
        Self { feedback, ..self }
    }

    /// The same with a contact in time that its scenario gives.
    #[must_use]
    pub fn with_timed(self, timed: Option<TimedPress>) -> Self {
        Self {
            timed: timed.map(Arc::new),
            ..self
        }
    }

    /// The contact in time, where the scenario is a press by force or onto other objects.
    pub fn timed(&self) -> Option<&TimedPress> {
        self.timed.as_deref()
    }

    /// The same fingertip going through another scenario, which is a travel on its curve.
    #[must_use]
    pub fn through(&self, scenario: Scenario) -> Self {
        Self {
            noise: Random(scenario.seed),
            scenario,
            timed: None,
            last: (0.0, 0.0),
            ..self.clone()
        }
    }

    /// The same with another transducer in its fluid.
    #[must_use]
    pub fn with_transducer(self, transducer: EmulatedTransducer) -> Self {
        Self { transducer, ..self }
    }

    /// What the transducer measures of the untouched fingertip in air of a pressure, both in pascals.
    pub fn rest_in(&self, air: f64) -> f64 {
        self.transducer.measured(self.rest_pressure, air)
    }

    /// Shares of reading of force and indentation that the tables may be off.
    pub fn tables_allowed(&self) -> [f64; 2] {
        self.tables_allowed
    }

    /// The contact at a time in seconds.
    pub fn truth(&self, time: f64) -> Contact {
        if let Some(timed) = &self.timed {
            return timed.at(self.scenario.place(time));
        }
        self.curve
            .at_indentation(self.scenario.indentation_share(time) * self.max_indentation)
    }

    /// What the actuator presses the wearer with at a time in seconds, newtons; `None` without one.
    pub fn feedback_truth(&self, time: f64) -> Option<f64> {
        let feedback = self.feedback.as_ref()?;
        let gained = feedback.gained.at_pressure_rise(self.truth(time).pressure_rise);
        Some(feedback.at_rest + gained.force)
    }

    /// The contact at the deepest indentation: what "full scale" means.
    pub fn full_scale(&self) -> Contact {
        self.curve.at_indentation(self.max_indentation)
    }

    /// The press as a function.
    pub fn curve(&self) -> &Curve {
        &self.curve
    }

    /// The scenario it goes through.
    pub fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// The transducer in its fluid.
    pub fn transducer(&self) -> EmulatedTransducer {
        self.transducer
    }

    /// The lowest and the highest pressure rise, pascals, while the samples of a report of this time in seconds are measured:
    /// [`REACH`] sample periods before and after it.
    pub fn pressure_rises(&self, time: f64) -> [f64; 2] {
        let reach = REACH * self.transducer.period();
        let (from, until) = (time - reach, time + reach);
        if let Some(timed) = &self.timed {
            return timed.pressure_rises(from, until);
        }
        // Between two phases' ends the plate moves one way.
        self.scenario
            .phase_ends()
            .filter(|end| (from..until).contains(end))
            .chain([from, until])
            .map(|time| self.truth(time).pressure_rise)
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], rise| {
                [low.min(rise), high.max(rise)]
            })
    }

    /// What the transducer does to the board at a time in seconds. Each call draws new noise.
    pub fn output(&mut self, time: f64) -> ElectricalOutput {
        // Drawn in every case, so that a fault leaves the noise after it as it would have been.
        let noise = self.transducer.noise * self.noise.normal();
        let share = self.scenario.indentation_share(time);
        if self.timed.is_some() {
            self.last.1 = self.truth(time).pressure_rise;
        } else if share.to_bits() != self.last.0.to_bits() {
            self.last = (share, self.truth(time).pressure_rise);
        }
        let gauge = self.rest_pressure + self.last.1 + noise;
        let pressure = self.transducer.measured(gauge, 1e3 * self.scenario.air_kpa);
        let wiring = self.scenario.wiring(time);
        match (self.transducer.part, wiring) {
            (Part::Analogue, wiring) => {
                let supply = match wiring {
                    Wiring::Sag => 0.9 * self.transducer.supply,
                    Wiring::Unsupplied => 0.0,
                    _ => self.transducer.supply,
                };
                let output = match wiring {
                    Wiring::Open => 1.0,
                    Wiring::Short => 0.0,
                    _ => supply * self.transducer.output(pressure),
                };
                ElectricalOutput::Share(output, supply)
            }
            (_, wiring) => ElectricalOutput::Pressure(pressure, wiring),
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::scenario::{Phase, WireFault};
    use model_tables::constants::Quantity;

    /// A press with the asymptotes of a first contact, in closed form: no solver, no table.
    pub(crate) fn closed_form(rise: f64) -> Contact {
        Contact {
            pressure_rise: rise,
            force: 2e-4 * rise * (1.0 + rise / 5e4),
            indentation: rise * (6e-7 - 4e-8 * libm::log(rise)),
        }
    }

    pub(crate) fn press(max_rise: f64, scenario: Scenario) -> Plant {
        let points = (0..80)
            .map(|i| closed_form(libm::exp(libm::log(max_rise) * f64::from(i) / 79.0)))
            .collect();
        let curve = Curve::new(points).expect("the closed form is monotone");
        let max_indentation = curve.end().indentation;
        let transducer = EmulatedTransducer {
            quantity: Quantity::Gauge,
            range: [0.0, 100e3],
            output_at_range: [0.1, 0.9],
            noise: 10.0,
            resolution: 5.0,
            part: Part::Analogue,
            supply: 1.0,
        };
        Plant::new(curve, 2e3, max_indentation, transducer, scenario)
    }

    pub(crate) fn ramp() -> Scenario {
        let phase = |name: &str, duration_ms, to_percent| Phase {
            name: name.to_owned(),
            duration_ms,
            to_percent,
            to_force_n: None,
            radius_mm: None,
        };
        Scenario {
            about: "a ramp".to_owned(),
            seed: 3,
            air_kpa: 101.325,
            design: None,
            phase: vec![
                phase("rest", 100.0, None),
                phase("press", 400.0, Some(100.0)),
                phase("hold", 100.0, None),
            ],
            wire: vec![],
            event: vec![],
            repeats: false,
        }
    }

    #[test]
    fn the_truth_is_the_press_at_the_plates_indentation() {
        let plant = press(8e3, ramp());
        assert_eq!(plant.truth(0.05), Contact::default());
        assert_eq!(plant.truth(0.55), plant.full_scale());
        let middle = plant.truth(0.3);
        assert!((middle.indentation - 0.5 * plant.full_scale().indentation).abs() < 1e-12);
        let expected = closed_form(middle.pressure_rise);
        assert!((middle.force / expected.force - 1.0).abs() < 1e-6);
        assert!((middle.indentation / expected.indentation - 1.0).abs() < 1e-6);
    }

    fn share(plant: &mut Plant, time: f64) -> f64 {
        match plant.output(time) {
            ElectricalOutput::Share(share, _) => share,
            ElectricalOutput::Pressure(..) => unreachable!("the transducer is analogue"),
        }
    }

    #[test]
    fn the_output_is_the_absolute_pressure_with_its_noise() {
        let mut plant = press(8e3, ramp());
        let n = 20_000;
        let mean = |plant: &mut Plant, time| (0..n).map(|_| share(plant, time)).sum::<f64>() / f64::from(n);
        // 2 kPa at rest and 10 kPa at the end: 0.1 + 0.8 p / 100 kPa. Five standard errors of 10 Pa noise.
        let tolerance = 5.0 * 10.0 / libm::sqrt(f64::from(n)) * 0.8 / 100e3;
        assert!((mean(&mut plant, 0.05) - 0.116).abs() < tolerance);
        assert!((mean(&mut plant, 0.55) - 0.18).abs() < tolerance);
    }

    #[test]
    fn an_absolute_transducer_gives_the_air_too() {
        let mut scenario = ramp();
        scenario.air_kpa = 80.0;
        let mut plant = press(8e3, scenario);
        plant.transducer.noise = 0.0;
        let gauge = share(&mut plant, 0.05);
        plant.transducer.quantity = Quantity::Absolute;
        plant.transducer.range = [20e3, 250e3];
        // 2 kPa above the air at rest: 0.1 + 0.8 (82 - 20) / (250 - 20).
        assert!((gauge - 0.116).abs() < 1e-12);
        assert!((share(&mut plant, 0.05) - (0.1 + 0.8 * 62.0 / 230.0)).abs() < 1e-12);
    }

    #[test]
    fn a_broken_wire_goes_to_a_rail_and_leaves_the_later_noise_alone() {
        let mut faulty = ramp();
        faulty.wire = vec![WireFault {
            is: Wiring::Short,
            from_ms: 10.0,
            until_ms: Some(20.0),
        }];
        let (mut sound, mut faulty) = (press(8e3, ramp()), press(8e3, faulty));
        for ms in 0..40 {
            let time = f64::from(ms) * 1e-3;
            let (sound, faulty) = (share(&mut sound, time), share(&mut faulty, time));
            if (10..20).contains(&ms) {
                assert!(faulty.abs() < 1e-15);
            } else {
                assert_eq!(sound.to_bits(), faulty.to_bits());
            }
        }
    }
}
