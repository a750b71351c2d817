//! The stages, called in order.

use crate::signal::calibration::{Calibration, Gain};
use crate::signal::contact::{contact, through_tables};
use crate::signal::design::{Design, Parameters};
use crate::signal::drift::Drift;
use crate::signal::filter::{Filter, GROUP_DELAY};
use crate::signal::fluid::Fluid;
use crate::signal::report::{Measurement, Report};
use crate::signal::stuck::StuckDetector;
use crate::signal::tare::{Tare, TareRefusal};
use crate::signal::temperature::Temperature;
use crate::signal::touch::TouchDetector;
use crate::signal::zero::{StartUp, Zero};
use crate::status::{Fault, Touch, Warnings};
use crate::transducer::driver::Sample;
use crate::units::{Centidegrees, Microseconds, Millipascals, Pressure};
use model_tables::units::Nanometres;

/// The signal path of one fingertip.
#[derive(Clone, Debug)]
pub struct Pipeline<D> {
    design: D,
    calibration: Calibration,
    /// What qualifies every reading since start-up.
    standing: Warnings,
    stuck: StuckDetector,
    temperature: Temperature,
    /// The last one measured.
    celsius: Option<Centidegrees>,
    tare: Tare,
    gain: Gain,
    filter: Filter,
    detector: TouchDetector,
    touch: Touch,
    drift: Drift,
    fluid: Fluid,
    /// When the last sample was measured, and how long after the one before it.
    measured: Microseconds,
    spacing: u64,
}

impl<D: Design> Pipeline<D> {
    /// A signal path of a design that has seen nothing yet, with what is stored of this fingertip. `standing` qualifies every
    /// reading.
    pub fn new(design: D, start_up: StartUp, calibration: Calibration, standing: Warnings) -> Self {
        let parameters = design.parameters();
        let gates = match calibration.zero_counts(parameters.scale) {
            Some(zero) => parameters.gates.with_stored(zero),
            None => parameters.gates,
        };
        Self {
            calibration,
            standing,
            stuck: StuckDetector::NEW,
            temperature: Temperature::new(
                calibration.coefficient,
                calibration.temperature,
                parameters.pressure_fraction_bits,
            ),
            celsius: None,
            tare: Tare::new(gates, start_up),
            gain: Gain::new(calibration.gain),
            filter: Filter::new(parameters.leaps),
            detector: TouchDetector::new(parameters.thresholds),
            touch: Touch::Unknown,
            drift: Drift::new(parameters.pace),
            fluid: Fluid::new(parameters.fall),
            measured: Microseconds(0),
            spacing: 0,
            design,
        }
    }

    /// The report of one sample, or of its absence. `now` is when the transducer gave it.
    // A boundary that stays in the image, so that the instructions of a report can be counted there.
    #[inline(never)]
    pub fn step(&mut self, now: Microseconds, sample: Result<Sample, Fault>) -> Report {
        let period = self.parameters().period;
        let age = sample.map_or(period / 2, |sample| sample.age);
        let measured = Microseconds(now.0.saturating_sub(u64::from(age)));
        let sample = sample.and_then(|sample| self.stuck.step(measured, sample.raw).map(|()| sample));
        // A reading is of the sample before this one, however long ago that was.
        let before = core::mem::replace(&mut self.measured, measured);
        let spacing = measured.0.saturating_sub(before.0);
        let uneven = spacing.abs_diff(core::mem::replace(&mut self.spacing, spacing));
        let outcome = match sample {
            Ok(sample) => {
                if spacing == 0 || spacing > self.parameters().gap() {
                    self.tare.interrupt(measured);
                    self.filter.interrupt();
                }
                self.measure(measured, sample, uneven <= u64::from(period) / 4)
            }
            Err(fault) => {
                self.tare.interrupt(measured);
                self.filter.interrupt();
                Err(fault)
            }
        };
        let delay = u64::from(GROUP_DELAY * period);
        Report {
            time: match outcome {
                Ok(_) => before,
                Err(_) => Microseconds(measured.0.saturating_sub(delay)),
            },
            outcome,
        }
    }

    #[inline]
    fn measure(&mut self, time: Microseconds, sample: Sample, even: bool) -> Result<Measurement, Fault> {
        if sample.temperature.is_some() {
            self.celsius = sample.temperature;
            self.temperature.step(sample.temperature, self.touch);
        }
        let Pressure(pressure) = self.parameters().scale.pressure(sample.pressure);
        let pressure = Pressure(pressure.saturating_sub(self.temperature.correction()));
        let (rise, zero) = self.tare.step(time, pressure, self.drift.counts())?;
        if self.tare.take_moved() {
            self.zero_moved(time);
        }
        let rise = self.gain.apply_to(rise);
        let (rise, warnings) = self.filter.step(rise, zero.and(sample.warnings()), even)?;
        let verified = !warnings.contains(Warnings::ZERO_UNVERIFIED);
        let touch = self.detector.step(rise, verified);
        self.touch = touch;
        self.drift.step(time, rise, touch);
        let (drifted, aged) = self.drift.missed(time, touch);
        self.fluid.step(time, rise, self.zero_over_lowest(), touch);

        let missed = self.temperature.missed();
        let parameters = self.parameters();
        let warnings = warnings
            .and(self.standing)
            .and(self.fluid.suspicions())
            .and(Warnings::ZERO_AGED.when(aged && verified))
            .and(Warnings::TEMPERATURE.when(missed > parameters.thresholds.touch.0));
        let contact = contact(&self.design, rise, warnings);
        let sigma = parameters.uncertainty.rise(verified, drifted, missed);
        Ok(Measurement {
            pressure_rise: rise,
            force: contact.force,
            indentation: contact.indentation,
            sigma: through_tables(&self.design, rise, &contact, sigma),
            touch,
            warnings: contact.warnings,
        })
    }

    /// What was measured over the old zero is void.
    #[cold]
    fn zero_moved(&mut self, time: Microseconds) {
        self.drift.reset(time);
        self.detector.forget();
        self.touch = Touch::Unknown;
        self.filter.interrupt();
    }

    fn zero_over_lowest(&self) -> i32 {
        let zero = self.tare.zero().map_or(self.tare.lowest(), |zero| zero.pressure);
        zero.0
            .saturating_add(self.drift.counts())
            .saturating_sub(self.tare.lowest().0)
    }

    /// Someone says that nothing presses: takes a new zero if it may be one. What came of it is asked with
    /// [`Pipeline::take_tare_answer`].
    ///
    /// # Errors
    /// [`TareRefusal`] when that is plain at once.
    pub fn tare(&mut self) -> Result<(), TareRefusal> {
        let (_, aged) = self.drift.missed(self.measured, self.touch);
        self.tare.command(aged)
    }

    /// Takes back the last commanded zero.
    ///
    /// # Errors
    /// [`TareRefusal::NothingToUndo`], [`TareRefusal::Busy`].
    pub fn undo_tare(&mut self) -> Result<(), TareRefusal> {
        self.tare.undo()
    }

    /// What came of the last commanded tare, once.
    pub fn take_tare_answer(&mut self) -> Option<Result<(), TareRefusal>> {
        self.tare.take_answer()
    }

    /// The zero that serves, drift included: what survives a reset that nobody saw coming.
    pub fn zero(&self) -> Option<Zero> {
        self.tare.zero().map(|zero| Zero {
            pressure: Pressure(zero.pressure.0.saturating_add(self.drift.counts())),
            ..zero
        })
    }

    /// The calibration that serves with the zero that serves, to be stored; nothing while no verified zero is.
    pub fn calibration_to_store(&self) -> Option<Calibration> {
        let zero = self.zero().filter(|zero| zero.verified)?;
        let counts = i64::from(zero.pressure.0) + i64::from(self.temperature.correction());
        // 2^33 * 1000.
        let parameters = self.parameters();
        let millipascals = (counts * 1000) >> parameters.pressure_fraction_bits;
        let zero = Millipascals(i32::try_from(millipascals).ok()?);
        let quantity = parameters.constants.transducer.quantity;
        Some(self.calibration.rezeroed(zero, self.celsius, quantity))
    }

    /// The calibration was stored, and is what the next zero of a gauge transducer is compared with; nothing: what was
    /// stored is void, and the design's rest pressure is.
    pub fn calibrated(&mut self, calibration: Option<Calibration>) {
        self.standing = self.standing.without(Warnings::CALIBRATION_REFUSED);
        self.fluid.clear();
        // What was stored is the zero that serves. Temperature goes on being compensated as since start-up.
        let gates = match (calibration, self.zero()) {
            (Some(_), Some(zero)) => self.parameters().gates.with_stored(zero.pressure),
            _ => self.parameters().gates,
        };
        self.tare.refer_to(gates);
        self.calibration = calibration.unwrap_or_default();
        self.gain = Gain::new(self.calibration.gain);
    }

    /// What the signal path needs of its design.
    #[inline]
    pub fn parameters(&self) -> &Parameters {
        self.design.parameters()
    }

    /// The calibration that serves.
    pub fn calibration(&self) -> Calibration {
        self.calibration
    }

    /// Whether something presses, as of the last reading.
    pub fn touch(&self) -> Touch {
        self.touch
    }

    /// Wild samples replaced so far.
    pub fn rejected(&self) -> u32 {
        self.filter.rejected()
    }

    /// Someone presses to a known indentation while `read` is reported: whether the fingertip is as firm as its model.
    pub fn compare(&mut self, read: Nanometres, known: Nanometres) -> bool {
        self.fluid.compare(read, known)
    }
}

#[cfg(test)]
mod air;
#[cfg(test)]
mod tests;
