//! Random lives of fingertips: whatever moves the pressure within the assumptions of a zero, no reading with status ok is off by more
//! than the zero's bound and three deviations.
//!
//! [`Life::draw`] -> [`Life::live`] sample by sample through the signal path of the firmware -> [`LivesTally`]. No time is skipped.

pub mod tip;
pub mod world;

use model_tables::constants::{AirReference, Quantity, Transducer, TransducerKind, ZeroAssumptions};
use model_tables::random::Random;
use std::fmt;
use tip::{TRANSDUCERS, Tip};
use world::{LifeWorld, Motions};

/// A reading with status ok that is further off than is allowed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wrong {
    /// When, seconds since the life began.
    pub seconds: f64,
    /// Error of the pressure rise, pascals.
    pub error: f64,
    /// Of the zero, pascals.
    pub bound: f64,
    /// One standard deviation, pascals.
    pub sigma: f64,
    /// The true rise then, pascals.
    pub rise: f64,
}

/// What came of some lives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LivesTally {
    /// Lives.
    pub lives: u64,
    /// Resets by a sagging supply.
    pub resets: u64,
    /// Samples with a reading.
    pub readings: u64,
    /// Samples without.
    pub no_reading: u64,
    /// Readings with status ok.
    pub ok: u64,
    /// Those further off than the zero's bound and three deviations, their own white noise left out.
    pub wrong: u64,
    /// Those among them where the filter replaced a corner of a press, with noise of four deviations on it, as an outlier.
    pub replaced: u64,
    /// By how much at most, pascals.
    pub worst: f64,
    /// The first of them; `None` where none is wrong.
    pub first_wrong: Option<Wrong>,
    /// Sum of the squares of error over deviation, of readings with status ok.
    squares: f64,
    /// Largest error over its stated deviation, dimensionless.
    pub most_deviations: f64,
}

impl LivesTally {
    /// A reading with status ok: its error over its deviation, how far the error is beyond what is allowed, and whether a sample was
    /// replaced.
    fn judge(&mut self, deviations: f64, beyond: f64, replaced: bool) {
        self.ok += 1;
        self.squares += deviations * deviations;
        self.most_deviations = self.most_deviations.max(deviations.abs());
        if beyond > 0.0 {
            self.wrong += 1;
            self.replaced += u64::from(replaced);
            self.worst = self.worst.max(beyond);
        }
    }

    /// Root mean square of error over deviation, of readings with status ok.
    pub fn rms_deviations(&self) -> f64 {
        (self.squares / self.ok.max(1) as f64).sqrt()
    }

    /// Share of ok among the readings.
    pub fn ok_share(&self) -> f64 {
        self.ok as f64 / self.readings.max(1) as f64
    }

    /// Adds another.
    pub fn add(&mut self, other: &Self) {
        self.lives += other.lives;
        self.resets += other.resets;
        self.readings += other.readings;
        self.no_reading += other.no_reading;
        self.ok += other.ok;
        self.wrong += other.wrong;
        self.replaced += other.replaced;
        self.worst = self.worst.max(other.worst);
        self.first_wrong = self.first_wrong.or(other.first_wrong);
        self.squares += other.squares;
        self.most_deviations = self.most_deviations.max(other.most_deviations);
    }
}

impl fmt::Display for LivesTally {
    /// A row of the table in FAULTS.md.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} | {} | {} | {:.1} | {} | {} | {:.2} | {:.1} |",
            self.lives,
            self.resets,
            self.readings + self.no_reading,
            100.0 * self.ok_share(),
            self.wrong - self.replaced,
            self.replaced,
            self.rms_deviations(),
            self.most_deviations
        )
    }
}

/// What one life is.
#[derive(Clone, Copy, Debug)]
pub struct Life {
    /// Of [`TRANSDUCERS`].
    pub transducer: usize,
    /// What its design states of its zero.
    pub zero: ZeroAssumptions,
    /// Length of a life, seconds.
    pub length: f64,
    /// An absolute part is lifted while it is pressed, which the zero assumes it is not.
    pub lifted_while_pressed: bool,
    motions: Motions,
    random: u64,
}

impl Life {
    /// The life of a number: half of them of designs that state what moves their zero.
    pub fn draw(seed: u64, index: u64, length: [f64; 2]) -> Self {
        let mut random = Random(seed.wrapping_mul(0x9E37_79B9).wrapping_add(index));
        let transducer = (index % TRANSDUCERS.len() as u64) as usize;
        let (_, part) = &TRANSDUCERS[transducer];
        let absolute = part.quantity == Quantity::Absolute;
        let analogue = matches!(part.kind, TransducerKind::Ratiometric { .. });
        let length = random.uniform(length[0], length[1]);
        let mut motions = Motions {
            noise: sample_noise(part),
            step: random.logarithmic(0.1, 10.0),
            drift: 2.0,
            weather: if absolute { 98.0 } else { 0.0 },
            ..Motions::default()
        };
        let mut zero = ZeroAssumptions::NONE;
        if random.unit() < 0.5 {
            motions.drift = random.logarithmic(0.5, 20.0);
            motions.per_kelvin = random.uniform(0.0, 4.0);
            motions.head = random.uniform(0.0, 140.0);
            motions.hysteresis = random.uniform(0.0, 60.0);
            motions.creep = random.uniform(0.0, 60.0);
            motions.creep_time = random.logarithmic(1.0, 60.0);
            let stated = |pascals: f64| (pascals * 1e3).ceil() as i32;
            let kelvins = if analogue { 10.0 } else { 0.0 };
            let always = motions.head + motions.hysteresis + motions.creep + kelvins * motions.per_kelvin;
            zero = ZeroAssumptions {
                drift: stated(motions.drift),
                per_kelvin: stated(motions.per_kelvin),
                fluid_head: stated(motions.head),
                hysteresis: stated(motions.hysteresis),
                creep: stated(motions.creep),
                bound: stated(60.0 + always),
                air: if absolute && random.unit() < 0.5 {
                    AirReference::Host
                } else {
                    AirReference::None
                },
            };
        }
        // The wire of an analogue part picks it up.
        if analogue && random.unit() < 0.25 {
            motions.hum = random.logarithmic(5.0, 200.0);
            motions.hum_hertz = if random.unit() < 0.5 { 50.0 } else { 60.0 } + random.uniform(-0.2, 0.2);
        }
        Self {
            transducer,
            zero,
            length,
            lifted_while_pressed: false,
            motions,
            random: random.bits(),
        }
    }

    /// Lives it.
    pub fn live(&self) -> LivesTally {
        let mut tally = LivesTally {
            lives: 1,
            ..LivesTally::default()
        };
        let (_, part) = TRANSDUCERS[self.transducer];
        let tip = Tip::new(part, self.zero);
        let absolute = part.quantity == Quantity::Absolute;
        let mut world = LifeWorld::new(tip, self.motions, Random(self.random), &mut tally);
        let room = world.surrounding;
        // Long lives are slow ones.
        let slowness = (self.length / 600.0).max(1.0).sqrt();
        while world.seconds() < self.length {
            world.change();
            let [much, long, turn] = [world.random.unit(), world.random.unit(), world.random.unit()];
            // A hand warms what it holds by five kelvins at the most, a room by as much.
            world.surrounding = room + world.random.uniform(-5.0, 5.0);
            match world.random.bits() % 16 {
                0..5 => world.press(80.0 + 9_000.0 * much, 0.02 + long * long, 10.0 * slowness * long),
                5 | 6 => world.press(60.0 * much, 0.05 + long, 5.0 * slowness * long),
                7 => world.press(200.0 * much, 10.0 + 100.0 * long, 0.5),
                8 => {
                    for _ in 0..5 {
                        world.press(3_000.0 * much, 0.075, 0.0);
                    }
                }
                9 => world.turn(turn, 0.3 + 2.0 * long),
                10 => {
                    world.tare();
                    if much < 0.3 {
                        world.rest(5.0 * long);
                        world.undo();
                    }
                }
                11 => world.lose(0.5 * long * long),
                12 => sag_in_a_grasp(&mut world, much, long),
                13 if absolute => {
                    let climb = world.random.uniform(-1_000.0, 1_000.0);
                    if self.lifted_while_pressed {
                        world.run(0.5, |since| 8_000.0 * much * since / 0.5);
                    }
                    world.lift(climb, 10.0 + 50.0 * long);
                    if self.lifted_while_pressed {
                        world.run(0.5, |since| 8_000.0 * much * (1.0 - since / 0.5));
                    }
                    if much < 0.7 {
                        world.rest(1.0);
                        world.tare();
                    }
                }
                _ => world.rest(20.0 * slowness * long),
            }
        }
        tally
    }
}

/// The supply sags under a press or none.
fn sag_in_a_grasp(world: &mut LifeWorld<'_>, much: f64, long: f64) {
    let rise = if much < 0.3 { 0.0 } else { 9_000.0 * much };
    world.run(0.2, |since| rise * since / 0.2);
    world.run(1.0, |_| rise);
    // Nobody is asked to leave it alone where the memory of the zero is lost too: only an untouched one may lose it.
    world.sag(rise > 0.0 || long < 0.5);
    world.run(1.0, |_| rise);
    world.run(0.2, |since| rise * (1.0 - since / 0.2));
    world.rest(3.0);
    if long < 0.8 {
        world.tare();
    }
}

/// One standard deviation of a sample's white noise as the signal path gets it, pascals: a block of the converter is a mean.
pub(super) fn sample_noise(part: &Transducer) -> f64 {
    let averaged = fingertip::signal::uncertainty::averaged(&part.kind);
    f64::from(part.noise) / 1e3 / f64::from(averaged).sqrt()
}
