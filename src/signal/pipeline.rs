//! The stages, called in order.

use crate::signal::calibration::{Calibration, Gain};
use crate::signal::contact::feedback;
use crate::signal::design::{Design, NoSuchObject, Parameters, Rise, Wall};
use crate::signal::filter::{Filter, GROUP_DELAY};
use crate::signal::fluid::FluidHealth;
use crate::signal::report::{Measurement, Report};
use crate::signal::stuck::StuckDetector;
use crate::signal::temperature::Temperature;
use crate::signal::touch::TouchDetector;
use crate::signal::zero::estimator::Estimator;
use crate::signal::zero::surroundings::{AirRefusal, Around as _};
use crate::signal::zero::tare::TareRefusal;
use crate::signal::zero::{StartUp, Zero};
use crate::status::{Fault, Touch, Warnings};
use crate::transducer::driver::Sample;
use crate::units::{Centidegrees, Microseconds, Millipascals, Pressure};
use model_tables::constants::AIR;
#[cfg(band)]
use model_tables::table::band::ChipBand;
use model_tables::table::known::KnownContact;
use model_tables::table::law::Touched;
use model_tables::units::{Nanometres, PressureRise};

/// The signal path of one fingertip.
#[derive(Clone, Debug)]
pub struct Pipeline<D: Design> {
    design: D,
    calibration: Calibration,
    /// Warnings of every reading since start-up.
    standing: Warnings,
    stuck: StuckDetector,
    temperature: Temperature,
    /// The last measured temperature.
    celsius: Option<Centidegrees>,
    zero: Estimator,
    around: D::Around,
    gain: Gain,
    filter: Filter,
    detector: TouchDetector,
    touch: Touch,
    fluid: FluidHealth,
    wall: D::Wall,
    /// Time of the last sample, and its distance from the one before it.
    measured: Microseconds,
    spacing: u64,
}

impl<D: Design> Pipeline<D> {
    /// A new signal path of a design, with the stored calibration of this fingertip. Every reading has the warnings `standing`.
    pub fn new(design: D, start_up: StartUp, calibration: Calibration, standing: Warnings) -> Self {
        let parameters = design.parameters();
        let limits = match calibration.zero_counts(parameters.scale) {
            Some(zero) => design.limits().with_stored(zero),
            None => design.limits(),
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
            zero: Estimator::new(limits, start_up),
            around: D::Around::NEW,
            gain: Gain::new(calibration.gain),
            filter: Filter::new(parameters.step_limits),
            detector: TouchDetector::new(parameters.thresholds),
            touch: Touch::Unknown,
            fluid: FluidHealth::new(parameters.fall),
            wall: D::Wall::NEW,
            measured: Microseconds(0),
            spacing: 0,
            design,
        }
    }

    /// The report of one sample, or of its absence. `now` is when the transducer gave it.
    // Not inlined, so that the instructions of a report can be counted in the image.
    #[inline(never)]
    pub fn step(&mut self, now: Microseconds, sample: Result<Sample, Fault>) -> Report {
        let period = self.parameters().period;
        let age = sample.map_or(period / 2, |sample| sample.age);
        let measured = Microseconds(now.0.saturating_sub(u64::from(age)));
        let sample = sample.and_then(|sample| self.stuck.step(measured, sample.raw).map(|()| sample));
        // A reading belongs to the sample before this one, whatever the time between them.
        let before = core::mem::replace(&mut self.measured, measured);
        let spacing = measured.0.saturating_sub(before.0);
        let uneven = spacing.abs_diff(core::mem::replace(&mut self.spacing, spacing));
        let outcome = match sample {
            Ok(sample) => {
                if spacing == 0 || spacing > self.parameters().gap() {
                    self.interrupt(measured);
                }
                self.measure([before, measured], sample, uneven <= u64::from(period) / 4)
            }
            Err(fault) => {
                self.interrupt(measured);
                Err(fault)
            }
        };
        let delay = u64::from(GROUP_DELAY * period);
        self.design
            .note(outcome.as_ref().ok().and_then(Measurement::pair));
        Report {
            time: match outcome {
                Ok(_) => before,
                Err(_) => Microseconds(measured.0.saturating_sub(delay)),
            },
            outcome,
        }
    }

    /// The measurement of the first of two times, from a sample of the second one.
    #[inline]
    fn measure(
        &mut self,
        [at, time]: [Microseconds; 2],
        sample: Sample,
        even: bool,
    ) -> Result<Measurement, Fault> {
        if sample.temperature.is_some() {
            self.celsius = sample.temperature;
            self.temperature.step(sample.temperature, self.touch);
        }
        let Pressure(pressure) = self.parameters().scale.pressure(sample.pressure);
        let pressure = Pressure(pressure.saturating_sub(self.temperature.correction()));
        let before = self.zero.zero();
        if self.wall.lowers_the_pressure() {
            self.zero.disregard();
        }
        if let Some(level) = self.zero.step(time, pressure) {
            self.look(time, level, before);
        }
        let (rise, zero) = self.zero.rise(pressure)?;
        if self.zero.take_moved() {
            self.zero_moved();
        }
        let rise = self.gain.apply_to(rise);
        let rejected = self.filter.rejected();
        let (rise, warnings) = match self.filter.step(rise, zero.and(sample.warnings()), even) {
            Ok(filtered) => filtered,
            Err(fault) => return Err(self.unfiltered(fault)),
        };
        if self.filter.rejected() != rejected {
            self.zero.disregard();
        }
        if sample.pressure.0 < self.parameters().lowest_read {
            self.wall.lose_track();
        }
        let verified = !warnings.contains(Warnings::ZERO_UNVERIFIED);
        let missed = self.temperature.missed();
        if let Some(around) = self.around.as_mut().first_mut() {
            around.warm(sample.temperature);
        }
        let moved = self.moved_around();
        let (bound, above) = (
            self.zero.bound().saturating_add(moved),
            self.zero.above().saturating_add(moved),
        );
        let touch = self.detector.step(rise, above.saturating_add(missed), verified);
        let parameters = self.design.parameters();
        let (contact, sigma) = self.wall.read(
            &self.design,
            Rise {
                time: at,
                rise,
                sigma: parameters.uncertainty.rise(bound, missed),
                warnings,
            },
        );
        let lowered = self.wall.lowers_the_pressure();
        // While the pressure is below rest, a new touch may stay hidden.
        self.touch = match touch {
            Touch::Untouched if lowered => Touch::Unknown,
            touch => touch,
        };

        let doubtful =
            missed != 0 && self.zero.is_ok() && bound.saturating_add(missed) > parameters.limits.bound;
        // A rise this far below zero is not reported as ok before the window ends.
        let fallen =
            verified && !lowered && bound <= parameters.limits.bound && rise.0 < -parameters.limits.bound;
        let moved = moved != 0 && verified && bound > parameters.limits.bound;
        Ok(Measurement {
            pressure_rise: rise,
            force: contact.force,
            indentation: contact.indentation,
            sigma,
            touch: self.touch,
            warnings: contact
                .warnings
                .and(Warnings::ZERO_AGED.when(fallen || moved))
                .and(self.standing)
                .and(self.fluid.suspicions())
                .and(Warnings::TEMPERATURE.when(doubtful)),
            feedback: feedback(&self.design, rise, sigma.pressure_rise),
        })
    }

    /// A jump is not a pressure, so the window must not count it as hum.
    #[cold]
    fn unfiltered(&mut self, fault: Fault) -> Fault {
        if fault == Fault::Jump {
            self.zero.disregard();
        }
        fault
    }

    /// A quiet window ended at pressure `level`. The zero may have moved from `before`.
    #[cold]
    fn look(&mut self, time: Microseconds, level: Pressure, before: Option<Zero>) {
        if let (Some(before), Some(now)) = (before, self.zero()) {
            let shift = PressureRise(before.pressure.0.saturating_sub(now.pressure.0));
            let shift = self.gain.apply_to(shift);
            self.filter.shift(shift.0);
            self.wall.shift(&self.design, shift);
        }
        let lowest = self.zero.lowest().0;
        self.fluid.look(time, level.0.saturating_sub(lowest));
        if let Ok((rise, _)) = self.zero.rise(level)
            && self.gain.apply_to(rise) <= self.parameters().thresholds.touch
        {
            self.detector.forget();
        }
    }

    /// A gap in the samples.
    #[cold]
    fn interrupt(&mut self, time: Microseconds) {
        self.zero.interrupt(time);
        self.fluid.interrupt();
        self.filter.interrupt();
    }

    /// Largest movement of the zero by the measured surroundings, counts, >= 0.
    #[inline]
    fn moved_around(&self) -> i32 {
        let rates = &self.parameters().rates;
        let around = self.around.as_ref().first();
        around.map_or(0, |around| around.moved(rates, self.measured))
    }

    /// Adds the movement by the surroundings so far to the bound, because another zero was requested.
    #[inline]
    fn fold_surroundings(&mut self) {
        let (moved, now) = (self.moved_around(), self.measured);
        if let Some(around) = self.around.as_mut().first_mut() {
            around.begin(now);
            self.zero.widen(moved);
        }
    }

    /// Takes the air pressure around an absolute part from the host, in pascals. The zero moves with it.
    ///
    /// # Errors
    /// [`AirRefusal`].
    pub fn air(&mut self, now: Microseconds, pascals: i32) -> Result<(), AirRefusal> {
        let Parameters {
            pressure_fraction_bits: bits,
            ref rates,
            ..
        } = *self.design.parameters();
        let around = self.around.as_mut().first_mut();
        let around = around
            .filter(|_| rates.weather > 0)
            .ok_or(AirRefusal::NotInDesign)?;
        if !(AIR[0]..=AIR[1]).contains(&pascals) {
            return Err(AirRefusal::OutOfBounds);
        }
        let moved = around.tell(rates, Pressure::from_pascals(pascals, bits), now);
        self.zero.widen(moved.widen);
        self.zero.shift(moved.shift);
        let shift = PressureRise(moved.shift.saturating_neg());
        self.filter.shift(self.gain.apply_to(shift).0);
        Ok(())
    }

    /// Discards the values that were measured over the old zero.
    #[cold]
    fn zero_moved(&mut self) {
        let now = self.measured;
        if let Some(around) = self.around.as_mut().first_mut() {
            around.begin(now);
        }
        self.detector.forget();
        self.touch = Touch::Unknown;
        self.filter.interrupt();
        self.wall = D::Wall::NEW;
    }

    /// The host asserts that the fingertip is unloaded: takes a new zero if the pressure can be a zero.
    /// [`Pipeline::take_tare_answer`] gives the outcome.
    ///
    /// # Errors
    /// [`TareRefusal`] if the refusal is certain at once.
    pub fn tare(&mut self) -> Result<(), TareRefusal> {
        if self.wall.lowers_the_pressure() {
            // A new touch may stay hidden.
            return Err(TareRefusal::Touched);
        }
        self.fold_surroundings();
        self.zero.command()
    }

    /// Takes back the last commanded zero.
    ///
    /// # Errors
    /// [`TareRefusal::NothingToUndo`], [`TareRefusal::Busy`].
    pub fn undo_tare(&mut self) -> Result<(), TareRefusal> {
        self.fold_surroundings();
        self.zero.undo()
    }

    /// The outcome of the last commanded tare, returned once. `None` before it is known and after it was taken.
    pub fn take_tare_answer(&mut self) -> Option<Result<(), TareRefusal>> {
        self.zero.take_answer()
    }

    /// The present zero, drift included, to keep across an unrequested reset. `None` before the first zero.
    pub fn zero(&self) -> Option<Zero> {
        let moved = self.moved_around();
        self.zero.zero().map(|zero| Zero {
            bound: zero.bound.saturating_add(moved),
            ..zero
        })
    }

    /// The calibration with the present zero, to be stored. `None` while that zero is neither ok nor commanded.
    pub fn calibration_to_store(&self) -> Option<Calibration> {
        let zero = self.zero.to_store()?;
        let parameters = self.parameters();
        let moved = self.moved_around();
        if moved > 0 && zero.verified && zero.bound.saturating_add(moved) > parameters.limits.bound {
            return None;
        }
        let counts = i64::from(zero.pressure.0) + i64::from(self.temperature.correction());
        // 2^33 * 1000.
        let millipascals = (counts * 1000) >> parameters.pressure_fraction_bits;
        let zero = Millipascals(i32::try_from(millipascals).ok()?);
        let transducer = &parameters.constants.transducer;
        Some(self.calibration.rezeroed(zero, self.celsius, transducer))
    }

    /// The calibration was stored. The next zero of a gauge transducer is compared with it. With `None`, the stored calibration is
    /// void, and the zero is compared with the design's rest pressure.
    pub fn calibrated(&mut self, calibration: Option<Calibration>) {
        self.standing = self.standing.without(Warnings::CALIBRATION_REFUSED);
        self.fluid.clear();
        // The stored zero is the present one. Temperature compensation continues as since start-up.
        let limits = match (calibration, self.zero()) {
            (Some(_), Some(zero)) => self.design.limits().with_stored(zero.pressure),
            _ => self.design.limits(),
        };
        self.zero.refer_to(limits);
        self.calibration = calibration.unwrap_or_default();
        self.gain = Gain::new(self.calibration.gain);
    }

    /// The parameters of its design.
    #[inline]
    pub fn parameters(&self) -> &Parameters {
        self.design.parameters()
    }

    /// The calibration in use.
    pub fn calibration(&self) -> Calibration {
        self.calibration
    }

    /// Touch state of the last reading.
    pub fn touch(&self) -> Touch {
        self.touch
    }

    #[cfg(test)]
    fn fluid_suspicions(&self) -> Warnings {
        self.fluid.suspicions()
    }

    /// Sets the touched object from now on.
    ///
    /// # Errors
    /// [`NoSuchObject`]; readings stay those of the previous object.
    pub fn touch_object(&mut self, touched: Touched) -> Result<(), NoSuchObject> {
        self.design.touch(touched)
    }

    /// The band of an unknown object. `None` if the object is known.
    #[cfg(band)]
    pub fn band(&self) -> Option<&ChipBand> {
        self.design.band()
    }

    /// The contact from the last reading and a known indentation, above 0; `None` without a valid reading, or without `[object]`.
    pub fn tell(&self, known: Nanometres) -> Option<KnownContact> {
        self.design.tell(known)
    }

    /// Outliers replaced so far.
    pub fn rejected(&self) -> u32 {
        self.filter.rejected()
    }

    /// Compares the reading `read` with the `known` indentation: whether the fingertip is as firm as its model.
    pub fn compare(&mut self, read: Nanometres, known: Nanometres) -> bool {
        self.fluid.compare(read, known)
    }
}

#[cfg(test)]
mod air;
#[cfg(test)]
mod everyday;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod worlds;
