//! Blends of the tables of a plate and of a reference ball, beside other ways to read a ball: error, bytes, instructions; several domes.
//!
//! Every way reads the tables that the chip has, in integers, and is compared with the design's own presses onto balls of radii to
//! which no law is fitted.

pub mod page;

use model_tables::curve::{Contact, Curve, CurveError};
use model_tables::design::Design;
use model_tables::design_file::{Axes, DesignFile};
use model_tables::generate::object::ObjectTables;
use model_tables::generate::{self, GenerateError, Generated, OwnedTables};
use model_tables::model::choice::FINE;
use model_tables::model::{Fingertip, Kind, ModelError};
use model_tables::object::{Friction, Object, Shape};
use model_tables::table::ContactLookup as _;
use model_tables::table::law::{BlendLaw, Touched};
use model_tables::units::PressureRise;
use std::fmt;

/// Radii of the balls, millimetres: the asked range, and a smaller one.
pub const RADII: [f64; 11] = [3.0, 5.0, 6.0, 7.0, 9.0, 12.0, 15.0, 20.0, 25.0, 35.0, 50.0];
/// Smallest radius of the asked range, millimetres.
pub const SMALLEST: f64 = 5.0;
/// Smallest pressure rise that is compared, pascals.
const FROM: f64 = 700.0;
/// States of a press, and the shallowest over the deepest.
const STATES: usize = 28;
const SHALLOWEST: f64 = 0.02;
/// Deepest press of a dome over its height.
const DEEPEST: f64 = 0.35;
/// How much deeper than that the second ball is pressed, to have the plate's pressures.
const DEEPER: f64 = 1.6;

/// Domes beside the default one: outer semi-axes and wall, millimetres, and the material. No constant was chosen on them.
pub const DOMES: [(&str, [f64; 3], &str); 7] = [
    ("9 x 7 x 1, Agilus30", [9.0, 7.0, 1.0], "preset = \"agilus30\""),
    ("8 x 8 x 1.5, Agilus30", [8.0, 8.0, 1.5], "preset = \"agilus30\""),
    (
        "7 x 9 x 1.2, neo-Hookean",
        [7.0, 9.0, 1.2],
        "law = \"neo-hookean\"\nc1_pa = 150000.0",
    ),
    (
        "9 x 7 x 1, as soft as skin",
        [9.0, 7.0, 1.0],
        "law = \"mooney-rivlin\"\nc1_pa = 13400.0\nc2_pa = 29500.0",
    ),
    ("6 x 6 x 0.8, Agilus30", [6.0, 6.0, 0.8], "preset = \"agilus30\""),
    (
        "8 x 8 x 0.8, neo-Hookean",
        [8.0, 8.0, 0.8],
        "law = \"neo-hookean\"\nc1_pa = 100000.0",
    ),
    ("10 x 6 x 1, Agilus30", [10.0, 6.0, 1.0], "preset = \"agilus30\""),
];

/// A way to read a ball.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum BlendWay {
    /// The plate's tables.
    PlateAlone,
    /// The plate's, scaled by a power of `q = 1 + Rd / (R + 2 h)`; the powers are those that fit the reference ball best.
    ScaledByPower,
    /// Of three tables the one with the nearest curvature.
    NearestOfThree,
    /// One weight for both outputs, linear in the curvature `1 / R`.
    LinearInCurvature,
    /// One weight `ln q(R) / ln q(R_ref)` for both outputs, linear between the tables.
    OneWeight,
    /// The same between the logarithms of the tables.
    LogarithmsOfTables,
    /// A parabola in `1 / (R + 2 h)` through the plate and two balls.
    TwoBalls,
    /// A weight for each output, by a law that is fitted for the design.
    TwoWeights,
}

/// All of them, that of the chip last.
pub const WAYS: [BlendWay; 8] = [
    BlendWay::PlateAlone,
    BlendWay::ScaledByPower,
    BlendWay::NearestOfThree,
    BlendWay::LinearInCurvature,
    BlendWay::OneWeight,
    BlendWay::LogarithmsOfTables,
    BlendWay::TwoBalls,
    BlendWay::TwoWeights,
];

impl fmt::Display for BlendWay {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::PlateAlone => "plate alone",
            Self::ScaledByPower => "plate, scaled by a power",
            Self::NearestOfThree => "nearest of three tables",
            Self::LinearInCurvature => "one weight, linear in 1 / R",
            Self::OneWeight => "one weight, ln q",
            Self::LogarithmsOfTables => "one weight, ln q, of logarithms",
            Self::TwoBalls => "parabola through two balls",
            Self::TwoWeights => "two weights, fitted (the chip's)",
        })
    }
}

impl BlendWay {
    /// Tables that the image has.
    pub const fn tables(self) -> usize {
        match self {
            Self::PlateAlone | Self::ScaledByPower => 1,
            Self::LinearInCurvature | Self::OneWeight | Self::LogarithmsOfTables | Self::TwoWeights => 2,
            Self::NearestOfThree | Self::TwoBalls => 3,
        }
    }

    /// Lookups a report: of what is linear in the coefficients, these are blended once when the object changes.
    pub const fn lookups(self) -> u32 {
        match self {
            Self::LogarithmsOfTables => 2,
            _ => 1,
        }
    }

    /// Bytes of the constants beside tables.
    pub const fn constants(self) -> usize {
        match self {
            Self::PlateAlone => 0,
            Self::ScaledByPower => 16,
            Self::NearestOfThree => 8,
            Self::LinearInCurvature => 4,
            Self::OneWeight | Self::LogarithmsOfTables | Self::TwoBalls => 12,
            Self::TwoWeights => size_of::<BlendLaw>(),
        }
    }
}

/// The largest errors of a way on one ball.
#[derive(Clone, Copy, Debug, Default)]
pub struct WayError {
    /// Of force and indentation, percent of the truth, without sign.
    pub percent: [f64; 2],
    /// The pressure rise where each is, pascals.
    pub at: [f64; 2],
}

impl WayError {
    /// The larger error of the two.
    pub fn largest(&self) -> f64 {
        self.percent[0].max(self.percent[1])
    }
}

/// One dome.
#[derive(Clone, Debug)]
pub struct DomeBlends {
    /// Its dimensions and material.
    pub name: String,
    /// Bytes of one table.
    pub bytes: usize,
    /// Instructions of one lookup, by its structure.
    pub instructions: u32,
    /// Radius of the reference ball, millimetres.
    pub reference_mm: f64,
    /// By ball: its radius in millimetres, and the error of each of [`WAYS`].
    pub balls: Vec<(f64, [WayError; WAYS.len()])>,
}

/// Why a dome was not measured.
#[derive(Debug)]
pub enum NoBlends {
    /// No tables.
    Tables(GenerateError),
    /// No state.
    State(ModelError),
    /// The second ball's curve.
    Curve(CurveError),
    /// No tables of a ball.
    NoBall,
}

impl fmt::Display for NoBlends {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Tables(error) => error.fmt(f),
            Self::State(error) => error.fmt(f),
            Self::Curve(error) => error.fmt(f),
            Self::NoBall => f.write_str("the design has no tables of a ball"),
        }
    }
}

impl std::error::Error for NoBlends {}

/// What the ways read from.
struct Sources<'a> {
    plate: &'a OwnedTables,
    object: &'a ObjectTables,
    /// Radius of the second ball, metres, and its press.
    second: (f64, Curve),
    /// Radius of curvature at the pole, `a^2 / b`, metres.
    pole: f64,
    /// Twice the wall, metres.
    offset: f64,
    /// Powers of `q` that fit the reference ball.
    powers: [f64; 2],
}

fn values(tables: &OwnedTables, rise: f64) -> [f64; 2] {
    let bits = tables.layout.fraction_bits;
    let read = tables.contact_at(PressureRise::from_pascals(rise, bits));
    [read.force.newtons(), read.indentation.metres()]
}

impl Sources<'_> {
    fn reference(&self) -> f64 {
        1e-6 * f64::from(self.object.law.reference)
    }

    fn q(&self, radius: f64) -> f64 {
        1.0 + self.pole / (radius + self.offset)
    }

    /// Place of a radius on the law's axis: 0 a plate, 1 the reference ball.
    fn place(&self, radius: f64) -> f64 {
        (self.reference() + self.offset) / (radius + self.offset)
    }

    /// Force and indentation by one way; nothing where it has no answer.
    fn read(&self, way: BlendWay, radius: f64, rise: f64) -> Option<[f64; 2]> {
        let plate = values(self.plate, rise);
        let ball = || values(&self.object.ball, rise);
        let mixed = |weight: f64, ball: [f64; 2]| [0, 1].map(|i| plate[i] + weight * (ball[i] - plate[i]));
        let one_weight = libm::log(self.q(radius)) / libm::log(self.q(self.reference()));
        let second = || {
            (rise <= self.second.1.end().pressure_rise).then(|| {
                let contact = self.second.1.at_pressure_rise(rise);
                [contact.force, contact.indentation]
            })
        };
        Some(match way {
            BlendWay::PlateAlone => plate,
            BlendWay::ScaledByPower => [0, 1].map(|i| plate[i] * libm::pow(self.q(radius), self.powers[i])),
            BlendWay::NearestOfThree => {
                let (t, middle) = (self.place(radius), self.place(self.second.0));
                if t < 0.5 * middle {
                    plate
                } else if t < 0.5 * (1.0 + middle) {
                    second()?
                } else {
                    ball()
                }
            }
            BlendWay::LinearInCurvature => mixed(self.reference() / radius, ball()),
            BlendWay::OneWeight => mixed(one_weight, ball()),
            BlendWay::LogarithmsOfTables => {
                let ball = ball();
                [0, 1].map(|i| plate[i] * libm::pow(ball[i] / plate[i], one_weight))
            }
            BlendWay::TwoBalls => {
                let (ball, second) = (ball(), second()?);
                let (t, m) = (self.place(radius), self.place(self.second.0));
                let of_ball = t * (t - m) / (1.0 - m);
                let of_second = t * (t - 1.0) / (m * (m - 1.0));
                [0, 1].map(|i| plate[i] + of_ball * (ball[i] - plate[i]) + of_second * (second[i] - plate[i]))
            }
            BlendWay::TwoWeights => {
                let touched = Touched::Ball(libm::round(1e6 * radius) as i32);
                let tables = self.object.blended(self.plate, touched)?;
                values(&tables, rise)
            }
        })
    }
}

/// The powers of `q` with which the largest error on the reference ball is least.
fn powers(plate: &OwnedTables, ball: &OwnedTables, q: f64) -> [f64; 2] {
    let last = PressureRise(plate.layout.maximum).pascals(plate.layout.fraction_bits);
    [0, 1].map(|output| {
        let logarithms: Vec<f64> = (0..=60)
            .map(|k| FROM * libm::pow(last / FROM, f64::from(k) / 60.0))
            .map(|rise| libm::log(values(ball, rise)[output] / values(plate, rise)[output]))
            .collect();
        let least = logarithms.iter().copied().fold(f64::INFINITY, f64::min);
        let most = logarithms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        0.5 * (least + most) / libm::log(q)
    })
}

/// The design of a dome of [`DOMES`].
///
/// # Errors
/// [`NoBlends`] where it is none.
pub fn dome([radial, axial, wall]: [f64; 3], material: &str) -> Result<DesignFile, NoBlends> {
    let text = format!(
        "name = \"dome\"\n[membrane]\nradial_semi_axis_mm = {radial:?}\naxial_semi_axis_mm = {axial:?}\nthickness_mm = {wall:?}\n\
         [material]\n{material}\n[model]\nkind = \"solid\"\n[object]\n[press]\nmax_indentation_mm = {:?}\n\
         [transducer]\nkind = \"ratiometric\"\nrange_kpa = [-10.0, 300.0]\nresolution_pa = 10.0\n[accuracy]\n\
         force_percent_of_reading = 0.1\nindentation_percent_of_reading = 0.1\nfrom_percent_of_full_scale = 1.0\n",
        DEEPEST * axial
    );
    DesignFile::parse(&text, "dome.toml").map_err(|error| NoBlends::Tables(GenerateError::File(error)))
}

/// The ways on one dome, whose design has `[object]`.
///
/// # Errors
/// [`NoBlends`].
pub fn measure(name: &str, file: &DesignFile) -> Result<DomeBlends, NoBlends> {
    let generated: Generated = generate::from_design(file.clone()).map_err(NoBlends::Tables)?;
    let plate = &generated.certified.tables;
    let object = generated.certified.object.as_ref().ok_or(NoBlends::NoBall)?;
    let outer = file.design_to(Axes::Outer);
    let deepest = generated.end.indentation;
    let press = |radius: f64| {
        let object = Object {
            shape: Shape::Ball { radius },
            friction: Friction::NONE,
        };
        let kind = generated.kind.unwrap_or(Kind::Solid(FINE));
        Fingertip::of(kind, &Design { object, ..outer }).map_err(NoBlends::State)
    };
    let states = |radius: f64, deepest: f64| -> Result<Vec<Contact>, NoBlends> {
        let mut tip = press(radius)?;
        let mut found = Vec::new();
        for k in 0..STATES {
            let part = libm::pow(SHALLOWEST, 1.0 - k as f64 / (STATES - 1) as f64);
            match tip.contact_at(part * deepest) {
                Ok(contact) => found.push(contact),
                // The press ends.
                Err(_) if part > 0.7 => break,
                Err(error) => return Err(NoBlends::State(error)),
            }
        }
        Ok(found)
    };
    let membrane = &outer.membrane;
    let offset = 2.0 * membrane.thickness;
    let reference = 1e-6 * f64::from(object.law.reference);
    // Half the reference ball's curvature.
    let radius = 2.0 * reference + offset;
    let second = Curve::new(states(radius, DEEPER * deepest)?).map_err(NoBlends::Curve)?;
    let pole = membrane.radial_semi_axis * membrane.radial_semi_axis / membrane.axial_semi_axis;
    let mut sources = Sources {
        plate,
        object,
        second: (radius, second),
        pole,
        offset,
        powers: [0.0; 2],
    };
    sources.powers = powers(plate, &object.ball, sources.q(reference));
    let mut balls = Vec::new();
    for radius_mm in RADII {
        let radius = 1e-3 * radius_mm;
        if radius < 1e-6 * f64::from(object.law.least[0]) {
            continue;
        }
        let mut errors = [WayError::default(); WAYS.len()];
        for truth in states(radius, deepest)? {
            if truth.pressure_rise < FROM {
                continue;
            }
            for (way, error) in WAYS.into_iter().zip(&mut errors) {
                let Some(read) = sources.read(way, radius, truth.pressure_rise) else {
                    continue;
                };
                for (i, truth_of) in [truth.force, truth.indentation].into_iter().enumerate() {
                    let percent = 100.0 * (read[i] / truth_of - 1.0).abs();
                    if percent > error.percent[i] {
                        (error.percent[i], error.at[i]) = (percent, truth.pressure_rise);
                    }
                }
            }
        }
        balls.push((radius_mm, errors));
    }
    Ok(DomeBlends {
        name: name.to_owned(),
        bytes: plate.bytes(),
        instructions: plate.instructions(),
        reference_mm: 1e3 * reference,
        balls,
    })
}

impl DomeBlends {
    /// The largest errors of a way over the balls of the asked range, and the radius where each is, millimetres.
    pub fn worst(&self, way: BlendWay) -> (WayError, [f64; 2]) {
        let place = WAYS.iter().position(|other| *other == way).unwrap_or(0);
        let (mut worst, mut radii) = (WayError::default(), [f64::NAN; 2]);
        for (radius, errors) in self.balls.iter().filter(|ball| ball.0 >= SMALLEST) {
            for i in 0..2 {
                if errors[place].percent[i] > worst.percent[i] {
                    worst.percent[i] = errors[place].percent[i];
                    worst.at[i] = errors[place].at[i];
                    radii[i] = *radius;
                }
            }
        }
        (worst, radii)
    }

    /// The errors of a way on a ball smaller than the asked range; nothing where the chip has no such ball.
    pub fn smaller(&self, way: BlendWay) -> Option<WayError> {
        let place = WAYS.iter().position(|other| *other == way)?;
        let ball = self.balls.iter().find(|ball| ball.0 < SMALLEST)?;
        Some(ball.1[place])
    }
}
