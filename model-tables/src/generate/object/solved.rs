//! The objects that a law of weights is fitted to, solved by the design's own model.

use super::press::{Depths, Failed, Presses, beyond, micrometres};
use crate::curve::{Contact, Curve, CurveError};
use crate::design_file::{Axes, DesignFile, ShapeSection};
use crate::generate::GenerateError;
use crate::model::{Fingertip, ModelError};
use crate::table::law::Touched;
use std::fmt;

/// Radius of the reference ball over that of the dome at its pole, `a^2 / b` of the state of rest.
const REFERENCE: f64 = 0.7;
/// Largest reference ball, metres: of a flat dome, 0.7 of that radius is so large that a ball of 5 mm has twice its weight, and an error of
/// 2.7 %.
const LARGEST_REFERENCE: f64 = 8.2e-3;
/// The other balls, the same: those that the law is fitted to, and one that it is not.
const BALLS: [(f64, bool); 5] = [
    (0.25, true),
    (0.43, true),
    (1.04, false),
    (1.73, true),
    (4.3, true),
];
/// The cups, the same; those that touch beside the pole first, or have no press, are left out.
const CUPS: [f64; 2] = [2.6, 5.2];
/// The wider cups of a design that states one, over its radius, and whether the law is fitted to them.
const WIDER_CUPS: [(f64, bool); 3] = [(1.5, true), (2.2, false), (4.0, true)];
/// The smallest part of the last pressure rise that counts: of less, objects are told apart by less than what tables are off.
const FROM: f64 = 1.0 / 128.0;
/// The states of an object's curve, on until it has the plate's last pressure.
const DEPTHS: Depths = Depths {
    states: 72,
    most: f64::INFINITY,
};
/// Pressure rises that errors are looked at.
const RISES: usize = 60;

/// Coefficients of a law: of `t`, `t^2`, `t^3`.
pub(super) type Coefficients = [f64; 3];

/// An object with its press.
#[derive(Clone, Debug)]
pub struct SolvedObject {
    /// What it is.
    pub touched: Touched,
    /// Its radius, metres; of a cup negative.
    pub radius: f64,
    /// Whether the law is fitted to it.
    pub fitted: bool,
    /// Its press, as the transducer reads it, until it has the plate's last pressure or ends.
    pub curve: Curve,
    /// Pressure rise where it is as deep as the design is pressed, or the plate's last, pascals: the law is fitted up to there.
    pub fitted_to: f64,
}

/// Solved objects and the law of their weights.
#[derive(Clone, Debug)]
pub struct SolvedObjects {
    pub(super) objects: Vec<SolvedObject>,
    /// The reference object's curve, continued to where the plate's ends.
    pub(super) reference_beyond: Curve,
    /// The object of the tables beside the plate's: a ball, or the cup that the design states.
    pub(super) reference: Touched,
    /// Scale of the law, metres: the reference ball's radius, also where the reference is a cup.
    pub(super) scale: f64,
    /// Twice the wall, metres.
    pub(super) offset: f64,
    /// Smallest radii of balls and of cups; 0: none.
    pub(super) least: [f64; 2],
    /// Last pressure rises of balls and of cups, pascals.
    pub(super) last: [f64; 2],
    pub(super) force: [Coefficients; 2],
    pub(super) indentation: [Coefficients; 2],
    pub(super) start: Touched,
    pub(super) from: f64,
}

/// Why there are no blended tables.
#[derive(Clone, Debug, PartialEq)]
pub enum NoObjects {
    /// The reference object, or a ball that the law is fitted to, has no press.
    Unpressed {
        /// Its radius, millimetres; of a cup negative.
        radius_mm: f64,
        /// Why.
        reason: ModelError,
    },
    /// Its curve does not rise.
    Curve {
        /// Its radius, millimetres; of a cup negative.
        radius_mm: f64,
        /// Where.
        reason: CurveError,
    },
    /// The radius is smaller than those that were solved.
    Radius {
        /// As the design has it, millimetres.
        radius_mm: f64,
        /// Smallest radii of balls and of cups (0: no cups), millimetres.
        least_mm: [f64; 2],
    },
    /// The tables come from data.
    Data,
    /// A ball of the set that a band is of has no press.
    Unknown,
}

impl fmt::Display for NoObjects {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unpressed { radius_mm, reason } => write!(
                f,
                "the {} of {:.3} mm that tables of objects need has no press ({reason}): {}",
                kind(*radius_mm),
                radius_mm.abs(),
                remedy(*radius_mm)
            ),
            Self::Curve { radius_mm, reason } => write!(
                f,
                "the curve of the {} of {:.3} mm that tables of objects need cannot be used ({reason}): {}",
                kind(*radius_mm),
                radius_mm.abs(),
                remedy(*radius_mm)
            ),
            Self::Radius {
                radius_mm,
                least_mm: [ball, cup],
            } => {
                write!(
                    f,
                    "object.radius_mm = {radius_mm} is tighter than the objects that were solved: allowed are balls from {ball:.3} mm"
                )?;
                if *cup > 0.0 {
                    write!(f, " and cups to -{cup:.3} mm")
                } else {
                    write!(f, ", and no cups for this design")
                }
            }
            Self::Unknown => write!(
                f,
                "object.unknown is true, and this design has no press onto a ball of 5 or of 20 mm: give object.radius_mm, or leave out \
                 [object]"
            ),
            Self::Data => write!(
                f,
                "the tables come from the data in [calibration], and those of other objects cannot: leave out [object]"
            ),
        }
    }
}

fn kind(radius_mm: f64) -> &'static str {
    if radius_mm < 0.0 { "cup" } else { "ball" }
}

fn remedy(radius_mm: f64) -> &'static str {
    if radius_mm < 0.0 {
        "give a wider cup as object.radius_mm, or leave out [object]"
    } else {
        "leave out [object]"
    }
}

/// Pressure rises from one to another, evenly spaced in their logarithm.
pub(super) fn rises(from: f64, to: f64) -> impl Iterator<Item = f64> {
    (0..=RISES).map(move |i| from * libm::pow(to / from, i as f64 / RISES as f64))
}

impl SolvedObjects {
    /// Solves the objects of a design whose plate has this curve and model.
    ///
    /// # Errors
    /// [`GenerateError::Objects`].
    pub fn solve(
        design: &DesignFile,
        fingertip: &Fingertip,
        curve: &Curve,
        end: Contact,
    ) -> Result<Self, GenerateError> {
        Self::try_solve(design, fingertip, curve, end).map_err(GenerateError::Objects)
    }

    fn try_solve(
        design: &DesignFile,
        fingertip: &Fingertip,
        curve: &Curve,
        end: Contact,
    ) -> Result<Self, NoObjects> {
        let rest = fingertip.rest();
        let pole = rest.edge_radius * rest.edge_radius / rest.height;
        let last = curve.end().pressure_rise;
        let presses = Presses::of(design, fingertip, last, end.indentation);
        // Whole micrometres, as the chip has them.
        let radius = |share: f64| f64::from(micrometres(share * pole)) * 1e-6;
        let deep = |curve: &Curve| curve.at_indentation(end.indentation).pressure_rise.min(last);
        let reference = REFERENCE.min(LARGEST_REFERENCE / pole);
        let scale = radius(reference);
        let solved = |radius: f64, fitted: bool| {
            let radius_mm = radius * 1e3;
            let curve = presses.curve(radius, DEPTHS).map_err(|failed| match failed {
                Failed::Model(reason) => NoObjects::Unpressed { radius_mm, reason },
                Failed::Curve(reason) => NoObjects::Curve { radius_mm, reason },
            })?;
            Ok(SolvedObject {
                touched: if radius < 0.0 {
                    Touched::Cup(micrometres(-radius))
                } else {
                    Touched::Ball(micrometres(radius))
                },
                radius,
                fitted,
                fitted_to: deep(&curve),
                curve,
            })
        };
        let balls = std::iter::once((reference, true))
            .chain(BALLS)
            .map(|(share, fitted)| solved(radius(share), fitted));
        let cup = stated_cup(design);
        let mut objects = Vec::new();
        if let Some(cup) = cup {
            objects.push(solved(-cup, true)?);
            for (times, fitted) in WIDER_CUPS {
                objects.extend(solved(-f64::from(micrometres(times * cup)) * 1e-6, fitted));
            }
            // A ball is no more than told beside the cup: one without a press is left out.
            objects.extend(balls.flatten());
        } else {
            for ball in balls {
                objects.push(ball?);
            }
            let cups = CUPS.map(|share| solved(-radius(share), true));
            objects.extend(cups.into_iter().flatten());
        }
        let reference = objects[0].clone();
        let offset = 2.0 * design.design_to(Axes::Outer).membrane.thickness;
        let mut found = Self {
            reference_beyond: beyond(&reference.curve, curve).map_err(|reason| NoObjects::Curve {
                radius_mm: reference.radius * 1e3,
                reason,
            })?,
            objects,
            reference: reference.touched,
            scale,
            offset,
            least: [0.0; 2],
            last: [last; 2],
            force: [[0.0; 3]; 2],
            indentation: [[0.0; 3]; 2],
            start: Touched::Plate,
            from: FROM * end.pressure_rise,
        };
        found.fit(curve);
        found.start = found.start_of(design)?;
        Ok(found)
    }

    /// The law of balls and that of cups, one of them through the reference.
    fn fit(&mut self, plate: &Curve) {
        let place = |radius: f64| (self.scale + self.offset) / (radius + self.offset);
        let of_cup = matches!(self.reference, Touched::Cup(_));
        for cups in [false, true] {
            let side = usize::from(cups);
            let own = self.objects.iter().filter(|object| (object.radius < 0.0) == cups);
            let least = own.clone().map(|object| object.radius.abs());
            let ends = own.clone().map(|object| object.curve.end().pressure_rise);
            let least = least.fold(f64::INFINITY, f64::min);
            self.least[side] = if least.is_finite() { least } else { 0.0 };
            self.last[side] = ends.fold(self.last[side], f64::min);
            for output in [0, 1] {
                let nodes: Vec<[f64; 2]> = own
                    .clone()
                    .filter(|object| object.fitted)
                    .map(|object| [place(object.radius), self.weight(plate, object, output)])
                    .collect();
                let law = match (cups == of_cup, cups) {
                    (true, _) => law_through(&nodes, place(self.objects[0].radius)),
                    (false, true) => law_of_cups(&nodes),
                    (false, false) => law_of_other_balls(&nodes),
                };
                let laws = if output == 0 {
                    &mut self.force
                } else {
                    &mut self.indentation
                };
                laws[side] = law;
            }
        }
    }

    /// The weight with which the largest error of an output is least, by ternary search: the error is convex in it.
    fn weight(&self, plate: &Curve, object: &SolvedObject, output: usize) -> f64 {
        let reference = &self.objects[0].curve;
        let outputs = |contact: Contact| [contact.force, contact.indentation][output];
        let last = object.fitted_to.min(reference.end().pressure_rise);
        let rows: Vec<[f64; 3]> = rises(self.from, last)
            .map(|rise| [plate, reference, &object.curve].map(|curve| outputs(curve.at_pressure_rise(rise))))
            .collect();
        let error = |weight: f64| {
            rows.iter()
                .map(|[plate, ball, truth]| ((plate + weight * (ball - plate)) / truth - 1.0).abs())
                .fold(0.0, f64::max)
        };
        let (mut low, mut high) = (-8.0, 8.0);
        for _ in 0..120 {
            let [first, second] = [low + (high - low) / 3.0, high - (high - low) / 3.0];
            if error(first) < error(second) {
                high = second;
            } else {
                low = first;
            }
        }
        0.5 * (low + high)
    }

    /// What the design says is touched.
    fn start_of(&self, design: &DesignFile) -> Result<Touched, NoObjects> {
        let shape = design.object.map_or(ShapeSection::Plate, |object| object.shape);
        let (touched, radius_mm, side) = match shape {
            ShapeSection::Plate | ShapeSection::Punch { .. } => return Ok(Touched::Plate),
            ShapeSection::Ball { radius_mm } if radius_mm < 0.0 => {
                (Touched::Cup(micrometres(-radius_mm * 1e-3)), radius_mm, 1)
            }
            ShapeSection::Ball { radius_mm } => (Touched::Ball(micrometres(radius_mm * 1e-3)), radius_mm, 0),
            ShapeSection::Cylinder { radius_mm } => {
                (Touched::Cylinder(micrometres(radius_mm * 1e-3)), radius_mm, 0)
            }
        };
        let least = micrometres(self.least[side]);
        if least > 0 && micrometres(radius_mm.abs() * 1e-3) >= least {
            return Ok(touched);
        }
        Err(NoObjects::Radius {
            radius_mm,
            least_mm: self.least.map(|metres| metres * 1e3),
        })
    }
}

/// The radius of the cup that a design states, in whole micrometres as the chip has it, metres.
fn stated_cup(design: &DesignFile) -> Option<f64> {
    match design.object?.shape {
        ShapeSection::Ball { radius_mm } if radius_mm < 0.0 => {
            Some(f64::from(micrometres(-radius_mm * 1e-3)) * 1e-6)
        }
        _ => None,
    }
}

/// `w = u (1 + (u - 1) (a + b u))` with `u = t / reference` by least squares: one at the reference.
fn law_through(nodes: &[[f64; 2]], reference: f64) -> Coefficients {
    let (mut matrix, mut right) = ([[0.0; 2]; 2], [0.0; 2]);
    for &[t, weight] in nodes {
        let u = t / reference;
        let row = [u * (u - 1.0), u * u * (u - 1.0)];
        for i in 0..2 {
            right[i] += row[i] * (weight - u);
            for j in 0..2 {
                matrix[i][j] += row[i] * row[j];
            }
        }
    }
    let [a, b] = two_unknowns(matrix, right);
    let square = reference * reference;
    [(1.0 - a) / reference, (a - b) / square, b / (square * reference)]
}

/// `w = t (c1 + c2 t)` by least squares, of balls beside a reference that is a cup.
fn law_of_other_balls(nodes: &[[f64; 2]]) -> Coefficients {
    let (mut matrix, mut right) = ([[0.0; 2]; 2], [0.0; 2]);
    for &[t, weight] in nodes {
        let row = [t, t * t];
        for i in 0..2 {
            right[i] += row[i] * weight;
            for j in 0..2 {
                matrix[i][j] += row[i] * row[j];
            }
        }
    }
    let [first, second] = two_unknowns(matrix, right);
    [first, second, 0.0]
}

/// Two unknowns by Cramer's rule; with fewer equations than unknowns zeros.
fn two_unknowns([[p, q], [r, s]]: [[f64; 2]; 2], right: [f64; 2]) -> [f64; 2] {
    let determinant = p * s - q * r;
    if determinant.abs() <= 1e-12 * (p * s).abs() {
        return [0.0; 2];
    }
    [
        (right[0] * s - right[1] * q) / determinant,
        (right[1] * p - right[0] * r) / determinant,
    ]
}

/// `w = t (c1 + c2 t)` through two nodes, or `c1 t` through one.
fn law_of_cups(nodes: &[[f64; 2]]) -> Coefficients {
    match *nodes {
        [[t, weight]] => [weight / t, 0.0, 0.0],
        [[t, weight], [u, other], ..] => {
            let second = (weight / t - other / u) / (t - u);
            [weight / t - second * t, second, 0.0]
        }
        [] => [0.0; 3],
    }
}
