//! Random objects that the chip is not told: does the truth lie in the band that a design states?
//!
//! Balls of 5 to 200 mm radius are the product's own solid, at other radii than those that the band is made from: solved at
//! 20 radii, between them linear in the curvature. Tilts of 0 to 20 degrees are drawn from the quoted figures. Friction is the
//! product's own solid again.

use model_tables::curve::{Contact, Curve};
use model_tables::design_file::{DesignFile, ObjectSection, ShapeSection};
use model_tables::generate::object::{Band, quoted};
use model_tables::generate::{self, GenerateError, Generated};
use model_tables::object::Friction;
use model_tables::random::Random;
use model_tables::table::ContactLookup as _;
use model_tables::units::PressureRise;
use std::collections::BTreeMap;
use std::fmt;

/// Balls that are solved.
const RADII: usize = 20;
/// Their smallest and largest radius, metres.
const BALLS: [f64; 2] = [5e-3, 200e-3];
/// Frictions of plates that are solved.
const FRICTIONS: [Friction; 4] = [
    Friction::Coulomb(0.1),
    Friction::Coulomb(0.3),
    Friction::Coulomb(0.6),
    Friction::Stick,
];

/// A kind of object.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub enum TouchedKind {
    /// A ball on the axis.
    Ball,
    /// A tilted plate.
    Tilted,
    /// A plate with friction.
    Rubbed,
}

/// Presses of one design onto all that it may touch.
#[derive(Clone, Debug)]
pub struct ObjectWorld {
    plate: Curve,
    /// By radius, metres.
    balls: Vec<(f64, Curve)>,
    rubbed: Vec<Curve>,
    /// Added to radii: twice the wall, metres.
    offset: f64,
    /// How deep the design is pressed, metres.
    deepest: f64,
}

/// A random object, pressed.
#[derive(Clone, Copy, Debug)]
pub struct TouchedObject {
    /// Its number.
    pub index: u64,
    /// What it is.
    pub kind: TouchedKind,
    /// Its radius in metres, tilt in degrees, or number among the frictions.
    pub size: f64,
    /// The truth.
    pub truth: Contact,
}

/// A design that is not told what it touches.
pub fn with_unknown(design: &DesignFile) -> DesignFile {
    DesignFile {
        object: Some(ObjectSection {
            shape: ShapeSection::Plate,
            friction: Friction::NONE,
            unknown: true,
        }),
        ..design.clone()
    }
}

impl ObjectWorld {
    /// Solves the objects of a design without `[object]`.
    ///
    /// # Errors
    /// [`GenerateError`] of the first press that there is not.
    pub fn solve(design: &DesignFile, progress: impl Fn(usize)) -> Result<Self, GenerateError> {
        let onto = |shape: ShapeSection, friction: Friction| {
            let touching = DesignFile {
                object: Some(ObjectSection {
                    shape,
                    friction,
                    unknown: false,
                }),
                ..design.clone()
            };
            generate::solve(&touching)
        };
        let plate = onto(ShapeSection::Plate, Friction::NONE)?;
        let mut balls = Vec::new();
        for number in 0..RADII {
            let part = number as f64 / (RADII - 1) as f64;
            let radius = BALLS[0] * libm::pow(BALLS[1] / BALLS[0], part);
            let radius_mm = 1e3 * radius;
            balls.push((
                radius,
                onto(ShapeSection::Ball { radius_mm }, Friction::NONE)?.curve,
            ));
            progress(number);
        }
        let mut rubbed = Vec::new();
        for friction in FRICTIONS {
            rubbed.push(onto(ShapeSection::Plate, friction)?.curve);
        }
        Ok(Self {
            plate: plate.curve,
            balls,
            rubbed,
            offset: 2e-3 * design.membrane.thickness_mm,
            deepest: plate.end.indentation,
        })
    }

    /// A ball at a depth: pressure and force between those of the next solved ones, linear in the curvature.
    fn ball(&self, radius: f64, depth: f64) -> Contact {
        let after = self.balls.partition_point(|ball| ball.0 < radius);
        let after = after.clamp(1, self.balls.len() - 1);
        let (low, high) = (&self.balls[after - 1], &self.balls[after]);
        let curvature = |radius: f64| 1.0 / (radius + self.offset);
        let part = (curvature(radius) - curvature(low.0)) / (curvature(high.0) - curvature(low.0));
        let (one, other) = (low.1.at_indentation(depth), high.1.at_indentation(depth));
        let between = |one: f64, other: f64| one * libm::pow(other / one, part);
        Contact {
            pressure_rise: between(one.pressure_rise, other.pressure_rise),
            force: between(one.force, other.force),
            indentation: depth,
        }
    }

    /// The object of a number, at a random depth down to that of the design with a pressure rise of `rises`.
    pub fn draw(&self, seed: u64, index: u64, rises: [f64; 2]) -> TouchedObject {
        let mut random = Random(seed ^ index.wrapping_mul(0xd134_2543_de82_ef95));
        random.bits();
        let kind = match random.bits() % 10 {
            0..6 => TouchedKind::Ball,
            6..9 => TouchedKind::Tilted,
            _ => TouchedKind::Rubbed,
        };
        let size = match kind {
            TouchedKind::Ball => random.logarithmic(BALLS[0], BALLS[1]),
            TouchedKind::Tilted => random.uniform(0.0, quoted::MAX_TILT),
            TouchedKind::Rubbed => (random.bits() % FRICTIONS.len() as u64) as f64,
        };
        loop {
            let depth = random.logarithmic(1e-3 * self.deepest, self.deepest);
            let truth = match kind {
                TouchedKind::Ball => self.ball(size, depth),
                TouchedKind::Rubbed => self.rubbed[size as usize].at_indentation(depth),
                TouchedKind::Tilted => {
                    let plate = self.plate.at_indentation(depth);
                    let [least, most] = quoted::tilted_force(size);
                    let force = random.uniform(least, most);
                    Contact {
                        force: force * plate.force,
                        indentation: quoted::tilted_product(size) / force * plate.indentation,
                        ..plate
                    }
                }
            };
            if (rises[0]..=rises[1]).contains(&truth.pressure_rise) {
                return TouchedObject {
                    index,
                    kind,
                    size,
                    truth,
                };
            }
        }
    }
}

/// How many objects lay in the band.
#[derive(Clone, Debug, Default)]
pub struct BandTally {
    /// Objects, and those outside of the band, by kind.
    pub kinds: BTreeMap<TouchedKind, [u64; 2]>,
    /// The first objects outside.
    pub outside: Vec<TouchedObject>,
    /// Errors of force and indentation, percent of the truth, with the transducer's noise and a zero anywhere within its bound; sorted.
    pub errors: [Vec<f64>; 2],
}

impl BandTally {
    /// Draws so many objects against the tables that a design begins with; nothing for a design without a band.
    pub fn of(generated: &Generated, world: &ObjectWorld, seed: u64, count: u64) -> Option<Self> {
        const SHOWN: usize = 8;
        let band: &Band = generated.band.as_ref()?;
        let plate = &generated.certified.tables;
        let tables = match &generated.certified.object {
            Some(object) => object.blended(plate, band.tables_of)?,
            None => plate.clone(),
        };
        let all = band.widest();
        let transducer = &generated.transducer;
        // Steps are uniform; a hundred samples are averaged, and an ok zero is within six noise floors.
        let deviation = libm::hypot(
            transducer.resolution_pa / libm::sqrt(12.0),
            transducer.noise_pa / 10.0,
        );
        let bound = 6.0 * transducer.resolution_pa.max(transducer.noise_pa);
        let mut tally = Self::default();
        for index in 0..count {
            let object = world.draw(seed, index, [all.from, all.to]);
            let truth = object.truth;
            let bits = tables.layout.fraction_bits;
            let reading = tables.contact_at(PressureRise::from_pascals(truth.pressure_rise, bits));
            let read = [reading.force.newtons(), reading.indentation.metres()];
            let mut random = Random(seed.wrapping_add(index) ^ 0x5bd1_e995);
            let moved = deviation * random.normal() + random.uniform(-bound, bound);
            let noisy = tables.contact_at(PressureRise::from_pascals(truth.pressure_rise + moved, bits));
            let noisy = [noisy.force.newtons(), noisy.indentation.metres()];
            for ((errors, noisy), truth) in tally
                .errors
                .iter_mut()
                .zip(noisy)
                .zip([truth.force, truth.indentation])
            {
                errors.push(100.0 * (noisy / truth - 1.0).abs());
            }
            let holds = band
                .at(truth.pressure_rise)
                .is_some_and(|row| row.holds(read, [truth.force, truth.indentation]));
            let counts = tally.kinds.entry(object.kind).or_default();
            counts[0] += 1;
            if !holds {
                counts[1] += 1;
                if tally.outside.len() < SHOWN {
                    tally.outside.push(object);
                }
            }
        }
        for errors in &mut tally.errors {
            errors.sort_by(f64::total_cmp);
        }
        Some(tally)
    }

    /// The error of force and indentation, percent, that this share of the objects stays within.
    pub fn within(&self, share: f64) -> [f64; 2] {
        [0, 1].map(|output| {
            let errors = &self.errors[output];
            let place = (share * errors.len() as f64) as usize;
            errors
                .get(place.min(errors.len().saturating_sub(1)))
                .copied()
                .unwrap_or(f64::NAN)
        })
    }

    /// The share of the objects that lay in the band.
    pub fn share(&self) -> f64 {
        let [all, outside] = self
            .kinds
            .values()
            .fold([0, 0], |sum, counts| [sum[0] + counts[0], sum[1] + counts[1]]);
        1.0 - outside as f64 / all as f64
    }
}

impl fmt::Display for BandTally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (kind, [all, outside]) in &self.kinds {
            writeln!(f, "{kind:?}: {outside} of {all} outside")?;
        }
        writeln!(f, "in the band: {:.2} %", 100.0 * self.share())?;
        let [median, most] = [self.within(0.5), self.within(0.95)];
        write!(
            f,
            "error with noise and zero, median and 95 %: force {:.1} and {:.1} %, indentation {:.1} and {:.1} %",
            median[0], most[0], median[1], most[1]
        )
    }
}
