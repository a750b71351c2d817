//! One fingertip with everything that moves its pressure beside a press, sample by sample.

use super::tip::{FRACTION_BITS, REST, Tip};
use super::{LivesTally, Wrong};
use fingertip::signal::calibration::Calibration;
use fingertip::signal::design::Design as _;
use fingertip::signal::pipeline::Pipeline;
use fingertip::signal::zero::StartUp;
use fingertip::status::{Fault, ResetCause, Status, Warnings};
use fingertip::transducer::driver::Sample;
use fingertip::units::{Centidegrees, Microseconds, Millipascals};
use model_tables::constants::{AirReference, Quantity, TransducerKind};
use model_tables::random::Random;
use std::f64::consts::TAU;

/// Pascals, kelvins and seconds of what moves a pressure.
#[derive(Clone, Copy, Debug, Default)]
pub struct Motions {
    /// One standard deviation of a sample's white noise.
    pub noise: f64,
    /// Steps of the part's word, pascals.
    pub step: f64,
    /// Largest drift of the part, pascals an hour.
    pub drift: f64,
    /// Largest weather, pascals an hour, of an absolute part.
    pub weather: f64,
    /// How far a kelvin moves the offset.
    pub per_kelvin: f64,
    /// Change of pressure from one attitude of the hand to another, pascals.
    pub head: f64,
    /// Pressure that the largest press leaves for good, pascals.
    pub hysteresis: f64,
    /// Pressure that it leaves for a while, pascals.
    pub creep: f64,
    /// Time in which creep falls to a third, seconds.
    pub creep_time: f64,
    /// Amplitude of the hum, and its frequency in hertz.
    pub hum: f64,
    /// Frequency of the hum, hertz.
    pub hum_hertz: f64,
}

/// The world of one life.
#[derive(Debug)]
pub struct LifeWorld<'a> {
    /// What is done to it.
    pub random: Random,
    /// What moves the pressure.
    pub motions: Motions,
    /// The air around, pascals, but for a lift.
    pub air: f64,
    /// Pressure that a lift has added to the air, pascals.
    pub height: f64,
    /// Where the attitude of the hand has put the fluid, from 0 to 1 of the head.
    pub attitude: f64,
    /// Temperature of the air and of what the fingertip holds, degrees Celsius.
    pub surrounding: f64,
    tip: Tip,
    pipeline: Pipeline<Tip>,
    tally: &'a mut LivesTally,
    /// Microseconds.
    now: u64,
    period: u64,
    drifted: f64,
    drift: f64,
    weather: f64,
    celsius: f64,
    remains: f64,
    crept: f64,
    deepest: f64,
    gaussian: Box<[f64]>,
    /// True rises and noise of the last samples, newest first.
    truth: [f64; 3],
    noise: [f64; 3],
    /// What changes slowly is moved on when so many samples have passed.
    until_slow: u32,
    slow_shift: f64,
}

/// Deviates drawn once, then at random.
const NORMALS: usize = 4096;

/// Samples between two steps of what changes slowly.
const SLOW: u32 = 16;

impl<'a> LifeWorld<'a> {
    /// A fingertip that is switched on untouched, and told so.
    pub fn new(tip: Tip, motions: Motions, mut random: Random, tally: &'a mut LivesTally) -> Self {
        let gaussian = (0..NORMALS).map(|_| random.normal()).collect();
        let absolute = tip.parameters().constants.transducer.quantity == Quantity::Absolute;
        let air = if absolute {
            random.uniform(66_000.0, 104_000.0)
        } else {
            0.0
        };
        let celsius = random.uniform(15.0, 30.0);
        let mut world = Self {
            air,
            height: 0.0,
            attitude: 0.5,
            surrounding: celsius,
            pipeline: Pipeline::new(tip, StartUp::Measured, Calibration::default(), Warnings::NONE),
            now: 0,
            period: u64::from(tip.parameters().period),
            drifted: 0.0,
            drift: 0.0,
            weather: 0.0,
            celsius,
            remains: 0.0,
            crept: 0.0,
            deepest: 0.0,
            gaussian,
            truth: [0.0; 3],
            noise: [0.0; 3],
            until_slow: 0,
            slow_shift: 0.0,
            random,
            motions,
            tip,
            tally,
        };
        world.tell_the_air();
        world.rest(1.0);
        world.tare();
        world.rest(0.5);
        world
    }

    fn is_absolute(&self) -> bool {
        self.tip.parameters().constants.transducer.quantity == Quantity::Absolute
    }

    /// Seconds since the life began.
    pub fn seconds(&self) -> f64 {
        self.now as f64 / 1e6
    }

    /// Pascals that the air, the part and the wall add to a press, as of a few samples ago at most.
    fn step_slow(&mut self) {
        let seconds = f64::from(SLOW) * self.period as f64 / 1e6;
        self.drifted += self.drift * seconds / 3_600.0;
        if self.is_absolute() {
            self.air += self.weather * seconds / 3_600.0;
        }
        // A part follows what is around it within a minute.
        self.celsius += (self.surrounding - self.celsius) * (seconds / 60.0).min(1.0);
        self.crept *= (1.0 - seconds / self.motions.creep_time.max(0.1)).max(0.0);
        let warmed = self.motions.per_kelvin * (self.celsius - 22.0);
        let rest = f64::from(REST) + self.air + self.height;
        let wall = self.remains - self.crept;
        self.slow_shift = rest + self.drifted + warmed + wall + self.motions.head * (self.attitude - 0.5);
    }

    fn sample(&mut self, rise: f64) {
        self.now += self.period;
        if self.until_slow == 0 {
            self.until_slow = SLOW;
            self.step_slow();
        }
        self.until_slow -= 1;
        let deviate = self.gaussian[self.random.bits() as usize % NORMALS];
        let noise = self.motions.noise * deviate;
        // Hum swells in five seconds.
        let swollen = (self.seconds() / 5.0).min(1.0);
        let hum = if self.motions.hum > 0.0 {
            self.motions.hum * swollen * (TAU * self.motions.hum_hertz * self.seconds()).sin()
        } else {
            0.0
        };
        let pascals = self.slow_shift + rise + noise + hum;
        let step = self.motions.step;
        let millipascals = ((pascals / step).round() * step * 1000.0).round() as i32;
        let transducer = &self.tip.parameters().constants.transducer;
        let told = !matches!(transducer.kind, TransducerKind::Ratiometric { .. });
        let sample = Sample {
            pressure: Millipascals(millipascals),
            headroom: Millipascals(100_000_000),
            age: (self.period / 2) as u32,
            temperature: told.then_some(Centidegrees((100.0 * self.celsius).round() as i16)),
            ..Sample::default()
        };
        let rejected = self.pipeline.rejected();
        let report = self.pipeline.step(Microseconds(self.now), Ok(sample));
        let replaced = self.pipeline.rejected() > rejected;
        self.truth = [rise, self.truth[0], self.truth[1]];
        self.noise = [noise, self.noise[0], self.noise[1]];
        self.deepest = self.deepest.max(rise);
        let Ok(reading) = report.outcome else {
            self.tally.no_reading += 1;
            return;
        };
        self.tally.readings += 1;
        if report.status() != Status::Ok {
            return;
        }
        let counts = f64::from(1_u32 << FRACTION_BITS);
        let read = f64::from(reading.pressure_rise.0) / counts;
        let sigma = f64::from(reading.sigma.pressure_rise.0) / counts;
        // The reading is the mean of the sample before with its neighbours, or that sample alone.
        let mean = |[newest, middle, oldest]: [f64; 3]| 0.25 * (newest + 2.0 * middle + oldest);
        let of_mean = (read - mean(self.truth), mean(self.noise));
        let of_middle = (read - self.truth[1], self.noise[1]);
        let without = |(error, noise): (f64, f64)| (error - noise).abs();
        let (error, noise) = if without(of_mean) <= without(of_middle) {
            of_mean
        } else {
            of_middle
        };
        let bound = self
            .pipeline
            .zero()
            .map_or(0.0, |zero| f64::from(zero.bound) / counts);
        let beyond = (error - noise).abs() - bound - 3.0 * sigma;
        self.tally.judge(error / sigma, beyond, replaced);
        if beyond > 0.0 && self.tally.first_wrong.is_none() {
            self.tally.first_wrong = Some(Wrong {
                seconds: self.now as f64 / 1e6,
                error,
                bound,
                sigma,
                rise,
            });
        }
    }

    /// So many seconds of a rise over the seconds since then.
    pub fn run(&mut self, seconds: f64, rise: impl Fn(f64) -> f64) {
        let from = self.now;
        loop {
            let since = (self.now - from) as f64 / 1e6;
            if since >= seconds {
                return;
            }
            self.sample(rise(since));
        }
    }

    /// Untouched.
    pub fn rest(&mut self, seconds: f64) {
        self.run(seconds, |_| 0.0);
    }

    /// Pressed and let go; what a press leaves begins with its release.
    pub fn press(&mut self, rise: f64, ramp: f64, hold: f64) {
        self.deepest = 0.0;
        self.run(ramp, |since| rise * since / ramp);
        self.run(hold, |_| rise);
        self.run(ramp, |since| rise * (1.0 - since / ramp));
        let share = (self.deepest / 10_000.0).min(1.0);
        self.remains = self.motions.hysteresis * share;
        self.crept = self.motions.creep * share;
        self.rest(0.6);
    }

    /// The hand turns in so many seconds, under a press or none.
    pub fn turn(&mut self, attitude: f64, seconds: f64) {
        let steps = 20;
        let from = self.attitude;
        let rise = self.truth[0];
        for step in 1..=steps {
            self.attitude = from + (attitude - from) * f64::from(step) / f64::from(steps);
            self.run(seconds / f64::from(steps), |_| rise);
        }
    }

    /// A lift or stairs, by so many pascals at so many a second at the most, which it gains and loses at 12 Pa/s a second: a tenth
    /// of the acceleration of gravity.
    pub fn lift(&mut self, pascals: f64, rate: f64) {
        const GAIN: f64 = 12.0;
        const STEP: f64 = 0.02;
        let rise = self.truth[0];
        let rate = rate.min((pascals.abs() * GAIN).sqrt());
        let (from, lasts) = (self.height, pascals.abs() / rate + rate / GAIN);
        let travelled = |since: f64| {
            let gaining = since.min(rate / GAIN);
            let losing = (since - lasts + rate / GAIN).max(0.0);
            0.5 * GAIN * (gaining * gaining - losing * losing) + rate * (since - gaining)
        };
        for step in 1..=(lasts / STEP).ceil() as u32 {
            let since = (f64::from(step) * STEP).min(lasts);
            self.height = from + pascals.signum() * travelled(since);
            if step % 5 == 0 {
                self.tell_the_air();
            }
            self.until_slow = 0;
            self.run(STEP, |_| rise);
        }
        self.tell_the_air();
    }

    /// Drift and weather change.
    pub fn change(&mut self) {
        self.drift = self.random.uniform(-1.0, 1.0) * self.motions.drift;
        self.weather = self.random.uniform(-1.0, 1.0) * self.motions.weather;
        self.tell_the_air();
    }

    /// Where the design has a host tell it.
    pub fn tell_the_air(&mut self) {
        if self.tip.parameters().constants.zero.air == AirReference::Host {
            let pascals = (self.air + self.height).round() as i32;
            let _ = self.pipeline.air(Microseconds(self.now), pascals);
        }
    }

    /// The host tares, and the fingertip is unloaded.
    pub fn tare(&mut self) {
        if self.pipeline.tare().is_err() {
            return;
        }
        for _ in 0..3_000 {
            self.sample(0.0);
            if self.pipeline.take_tare_answer().is_some() {
                return;
            }
        }
    }

    /// The last tare is taken back.
    pub fn undo(&mut self) {
        let _ = self.pipeline.undo_tare();
        self.rest(0.6);
    }

    /// Samples are lost for a while.
    pub fn lose(&mut self, seconds: f64) {
        let until = self.now + (seconds * 1e6) as u64;
        while self.now < until {
            self.now += self.period;
            self.pipeline
                .step(Microseconds(self.now), Err(Fault::SamplesLost));
            self.tally.no_reading += 1;
        }
    }

    /// The supply sags under a press or none: a reset, with the zero from before or, where memory was lost too, without.
    pub fn sag(&mut self, kept: bool) {
        let zero = self.pipeline.zero().filter(|_| kept);
        let quantity = self.tip.parameters().constants.transducer.quantity;
        let start_up = StartUp::after(ResetCause::BrownOut, zero, quantity);
        self.pipeline = Pipeline::new(self.tip, start_up, Calibration::default(), Warnings::NONE);
        self.tally.resets += 1;
        self.tell_the_air();
    }
}
