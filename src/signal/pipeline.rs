//! The stages, called in order.

use crate::signal::calibration::{Calibration, Gain};
use crate::signal::contact::contact;
use crate::signal::design::Design;
use crate::signal::drift::{Drift, Pace};
use crate::signal::filter::{Filter, GROUP_DELAY, Leaps};
use crate::signal::fluid::{Fall, Fluid};
use crate::signal::report::{Measurement, Report};
use crate::signal::scale::Scale;
use crate::signal::stuck::StuckDetector;
use crate::signal::tare::gates::Gates;
use crate::signal::tare::{Tare, TareRefusal};
use crate::signal::temperature::Temperature;
use crate::signal::touch::{Thresholds, TouchDetector};
use crate::signal::uncertainty::{Uncertainty, through_tables};
use crate::signal::zero::{StartUp, Zero};
use crate::status::{Fault, Touch, Warnings};
use crate::transducer;
use crate::transducer::driver::Sample;
use crate::units::{Centidegrees, Microseconds, Millipascals, Pressure};
use core::marker::PhantomData;
use model_tables::units::Nanometres;

/// The signal path of one fingertip.
#[derive(Clone, Debug)]
pub struct Pipeline<D> {
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
    design: PhantomData<D>,
}

impl<D: Design> Pipeline<D> {
    /// From one sample to the next, microseconds.
    pub const PERIOD: u32 = transducer::period(&D::CONSTANTS.transducer.kind);

    /// Two samples further apart than this are not next to each other, microseconds.
    const GAP: u64 = 20 * Self::PERIOD as u64;

    const SCALE: Scale = Scale::of(D::PRESSURE_FRACTION_BITS);
    const GATES: Gates = Gates::of(&D::CONSTANTS, D::PRESSURE_FRACTION_BITS);
    const LEAPS: Leaps = Leaps::of(&D::CONSTANTS, D::PRESSURE_FRACTION_BITS, Self::PERIOD);
    const THRESHOLDS: Thresholds = Thresholds::of(&D::CONSTANTS, D::PRESSURE_FRACTION_BITS);
    const PACE: Pace = Pace::of(&D::CONSTANTS, D::PRESSURE_FRACTION_BITS, Self::GATES.travel());
    const FALL: Fall = Fall::of(&D::CONSTANTS, D::PRESSURE_FRACTION_BITS, Self::GATES.far);
    const UNCERTAINTY: Uncertainty =
        Uncertainty::of(&D::CONSTANTS, D::PRESSURE_FRACTION_BITS, Self::GATES.reach());

    /// A signal path that has seen nothing yet, with what is stored of this fingertip. `standing` qualifies every
    /// reading.
    pub fn new(start_up: StartUp, calibration: Calibration, standing: Warnings) -> Self {
        let gates = match calibration.zero_counts(Self::SCALE) {
            Some(zero) => Self::GATES.with_stored(zero),
            None => Self::GATES,
        };
        Self {
            calibration,
            standing,
            stuck: StuckDetector::NEW,
            temperature: Temperature::new(
                calibration.coefficient,
                calibration.temperature,
                D::PRESSURE_FRACTION_BITS,
            ),
            celsius: None,
            tare: Tare::new(gates, start_up),
            gain: Gain::new(calibration.gain),
            filter: Filter::new(Self::LEAPS),
            detector: TouchDetector::new(Self::THRESHOLDS),
            touch: Touch::Unknown,
            drift: Drift::new(Self::PACE),
            fluid: Fluid::new(Self::FALL),
            measured: Microseconds(0),
            spacing: 0,
            design: PhantomData,
        }
    }

    /// The report of one sample, or of its absence. `now` is when the transducer gave it.
    // A boundary that stays in the image, so that the instructions of a report can be counted there.
    #[inline(never)]
    pub fn step(&mut self, now: Microseconds, sample: Result<Sample, Fault>) -> Report {
        let age = sample.map_or(Self::PERIOD / 2, |sample| sample.age);
        let measured = Microseconds(now.0.saturating_sub(u64::from(age)));
        let sample = sample.and_then(|sample| self.stuck.step(measured, sample.raw).map(|()| sample));
        // A reading is of the sample before this one, however long ago that was.
        let before = core::mem::replace(&mut self.measured, measured);
        let spacing = measured.0.saturating_sub(before.0);
        let uneven = spacing.abs_diff(core::mem::replace(&mut self.spacing, spacing));
        let outcome = match sample {
            Ok(sample) => {
                if spacing == 0 || spacing > Self::GAP {
                    self.tare.interrupt(measured);
                    self.filter.interrupt();
                }
                self.measure(measured, sample, uneven <= u64::from(Self::PERIOD) / 4)
            }
            Err(fault) => {
                self.tare.interrupt(measured);
                self.filter.interrupt();
                Err(fault)
            }
        };
        let delay = u64::from(GROUP_DELAY * Self::PERIOD);
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
        let Pressure(pressure) = Self::SCALE.pressure(sample.pressure);
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
        let warnings = warnings
            .and(self.standing)
            .and(self.fluid.suspicions())
            .and(Warnings::ZERO_AGED.when(aged && verified))
            .and(Warnings::TEMPERATURE.when(missed > Self::THRESHOLDS.touch.0));
        let contact = contact::<D>(rise, warnings);
        let sigma = Self::UNCERTAINTY.rise(verified, drifted, missed);
        Ok(Measurement {
            pressure_rise: rise,
            force: contact.force,
            indentation: contact.indentation,
            sigma: through_tables::<D>(rise, &contact, sigma),
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
        let millipascals = (counts * 1000) >> D::PRESSURE_FRACTION_BITS;
        let zero = Millipascals(i32::try_from(millipascals).ok()?);
        let quantity = D::CONSTANTS.transducer.quantity;
        Some(self.calibration.rezeroed(zero, self.celsius, quantity))
    }

    /// The calibration was stored, and is what the next zero of a gauge transducer is compared with; nothing: what was
    /// stored is void, and the design's rest pressure is.
    pub fn calibrated(&mut self, calibration: Option<Calibration>) {
        self.standing = self.standing.without(Warnings::CALIBRATION_REFUSED);
        self.fluid.clear();
        // What was stored is the zero that serves. Temperature goes on being compensated as since start-up.
        self.tare.refer_to(match (calibration, self.zero()) {
            (Some(_), Some(zero)) => Self::GATES.with_stored(zero.pressure),
            _ => Self::GATES,
        });
        self.calibration = calibration.unwrap_or_default();
        self.gain = Gain::new(self.calibration.gain);
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
