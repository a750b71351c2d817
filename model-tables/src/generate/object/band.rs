//! The band of an unknown object: the largest deviations of force and indentation from the reading.
//!
//! The set of objects is: balls of 5 mm radius or more on the axis, plates tilted by up to 20 degrees, plates with friction, and
//! the cup that a design states. Effects are not combined. Balls and cups are solved by the design's own model, and pressed as deep
//! as the design is; tilts and friction are [quoted].

use super::ObjectTables;
use super::press::{Depths, Presses, micrometres};
use super::quoted;
use crate::curve::{Contact, Curve};
use crate::design_file::{DesignFile, ShapeSection};
use crate::generate::OwnedTables;
use crate::model::Fingertip;
use crate::table::ContactLookup as _;
use crate::table::law::Touched;
use crate::units::PressureRise;
use std::fmt;

/// Radii of the balls that a band is made from, metres: the smallest of the set, and one between it and the plate.
const BALLS: [f64; 2] = [5e-3, 20e-3];
/// Their states.
const DEPTHS: Depths = Depths {
    states: 36,
    most: 33.0 / 32.0,
};
/// A band begins at this part of the tables' last rise at most: below it the zero leaves more open.
const BEGIN: f64 = 1.0 / 256.0;
/// Pressure rises of a row that are looked at.
const RISES: usize = 24;
/// Largest radius that the choice of a reference object looks at, micrometres, and how many it looks at.
const LARGEST: f64 = 300_000.0;
const CHOICES: usize = 96;
/// Digits of a percent are rounded outwards.
const TENTHS: f64 = 10.0;

/// How far the truth may lie from a reading.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    /// The object of the tables.
    pub tables_of: Touched,
    /// Smallest ball of the set, millimetres.
    pub smallest_ball_mm: f64,
    /// Smallest cup of the set, millimetres; `None` where the design states none.
    pub cup_mm: Option<f64>,
    /// By pressure rise, one row beside the other.
    pub rows: Vec<BandRow>,
}

/// A band over a part of the pressure rises: the truth less the reading, percent of the reading, least and most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandRow {
    /// From this pressure rise, pascals.
    pub from: f64,
    /// To this one, pascals.
    pub to: f64,
    /// Of the force, percent of reading.
    pub force_percent: [f64; 2],
    /// Of the indentation, percent of reading.
    pub indentation_percent: [f64; 2],
}

/// What tables may be off by themselves.
#[derive(Clone, Copy, Debug)]
pub(in crate::generate) struct TableError {
    /// Percent of reading.
    pub(in crate::generate) percent: f64,
    /// From this reading on, newtons or metres; below it as much as there.
    pub(in crate::generate) from: f64,
}

/// Least and most of force and indentation that objects of the set have at one pressure.
#[derive(Clone, Copy)]
struct Extent([[f64; 2]; 2]);

impl Extent {
    fn take(&mut self, force: f64, indentation: f64) {
        for (range, value) in self.0.iter_mut().zip([force, indentation]) {
            *range = [range[0].min(value), range[1].max(value)];
        }
    }
}

/// The objects of the set, solved.
#[derive(Clone, Debug)]
pub(in crate::generate) struct Unknown {
    plate: Curve,
    /// Of [`BALLS`].
    balls: Vec<Curve>,
    /// Radius in millimetres, and press.
    cup: Option<(f64, Curve)>,
    /// Of the dome at rest, metres.
    height: f64,
}

impl Unknown {
    /// The objects of a design whose plate has this curve and model; nothing where a ball has no press, or the design touches a punch.
    pub(in crate::generate) fn solve(
        design: &DesignFile,
        tip: &Fingertip,
        plate: &Curve,
        end: Contact,
    ) -> Option<Self> {
        let shape = design.object.map_or(ShapeSection::Plate, |object| object.shape);
        let presses = Presses::of(design, tip, end.pressure_rise, end.indentation);
        let balls = BALLS.map(|radius| presses.curve(radius, DEPTHS).ok());
        let cup = match shape {
            ShapeSection::Punch { .. } => return None,
            ShapeSection::Ball { radius_mm } if radius_mm < 0.0 => {
                Some((-radius_mm, presses.curve(1e-3 * radius_mm, DEPTHS).ok()?))
            }
            _ => None,
        };
        Some(Self {
            plate: plate.clone(),
            balls: balls.into_iter().collect::<Option<_>>()?,
            cup,
            height: tip.rest().height,
        })
    }

    /// Force and indentation of the smallest ball over the plate's at a pressure rise; where that ball is too deep, of the smallest one
    /// that is not, between those that were solved.
    fn sharpest(&self, rise: f64) -> [f64; 2] {
        let over = |curve: &Curve, rise: f64| {
            let (own, plate) = (curve.at_pressure_rise(rise), self.plate.at_pressure_rise(rise));
            [own.force / plate.force, own.indentation / plate.indentation]
        };
        let mut before: Option<(f64, [f64; 2])> = None;
        for curve in &self.balls {
            let end = curve.end().pressure_rise;
            if rise <= end && before.is_none() {
                return over(curve, rise);
            }
            let at = (end, over(curve, end));
            match before {
                Some(from) if rise <= end => return along(from, at, rise),
                // A larger ball that ends no later has nothing to add.
                Some(from) if end <= from.0 => {}
                _ => before = Some(at),
            }
        }
        let plate = (self.plate.end().pressure_rise, [1.0; 2]);
        before.map_or([1.0; 2], |from| along(from, plate, rise))
    }

    /// What the objects of the set have at a pressure rise.
    fn extent(&self, rise: f64) -> Extent {
        let plate = self.plate.at_pressure_rise(rise);
        let (force, indentation) = (plate.force, plate.indentation);
        let mut found = Extent([[force; 2], [indentation; 2]]);
        let [by_force, by_depth] = self.sharpest(rise);
        found.take(by_force * force, by_depth * indentation);
        if let Some((_, cup)) = &self.cup {
            let held = rise.min(cup.end().pressure_rise);
            let (own, plate) = (cup.at_pressure_rise(held), self.plate.at_pressure_rise(held));
            found.take(
                own.force / plate.force * force,
                own.indentation / plate.indentation * indentation,
            );
        }
        for tilted in quoted::tilted_force(quoted::MAX_TILT) {
            let product = quoted::tilted_product(quoted::MAX_TILT);
            found.take(tilted * force, product / tilted * indentation);
        }
        let depth = indentation / self.height;
        let rubbed = self.plate.at_pressure_rise(rise / quoted::rubbed_pressure(depth));
        found.take(quoted::rubbed_force(depth) * force, rubbed.indentation);
        found
    }

    /// Force and indentation of the extent over what tables read at a pressure rise, and what they read.
    fn over(&self, tables: &OwnedTables, rise: f64) -> Option<[([f64; 2], f64); 2]> {
        let bits = tables.layout.fraction_bits;
        let reading = tables.contact_at(PressureRise::from_pascals(rise, bits));
        let Extent([force, indentation]) = self.extent(rise);
        let read = [reading.force.newtons(), reading.indentation.metres()];
        (read[0] > 0.0 && read[1] > 0.0).then(|| {
            [
                (force.map(|value| value / read[0]), read[0]),
                (indentation.map(|value| value / read[1]), read[1]),
            ]
        })
    }

    /// The band of a design's tables, of force and indentation each with their own error.
    pub(in crate::generate) fn band(
        &self,
        tables: &OwnedTables,
        tables_of: Touched,
        own: [TableError; 2],
    ) -> Option<Band> {
        let last = last_rise(tables);
        let edges = edges(last);
        let rows = edges.windows(2).map(|pair| {
            let (from, to) = (pair[0], pair[1]);
            let mut found = [[0.0_f64; 2]; 2];
            for step in 0..=RISES {
                let rise = from * libm::pow(to / from, step as f64 / RISES as f64);
                let over = self.over(tables, rise)?;
                for ((found, (over, read)), own) in found.iter_mut().zip(over).zip(&own) {
                    let [least, most] = over.map(|ratio| 100.0 * (ratio - 1.0));
                    // Below it tables keep within the same error in absolute terms.
                    let own = own.percent * (own.from / read).max(1.0);
                    *found = [found[0].min(least - own), found[1].max(most + own)];
                }
            }
            let [force, indentation] = found.map(|[least, most]| {
                [
                    libm::floor(least * TENTHS) / TENTHS,
                    libm::ceil(most * TENTHS) / TENTHS,
                ]
            });
            Some(BandRow {
                from,
                to,
                force_percent: force,
                indentation_percent: indentation,
            })
        });
        Some(Band {
            tables_of,
            smallest_ball_mm: BALLS[0] * 1e3,
            cup_mm: self.cup.as_ref().map(|(radius_mm, _)| *radius_mm),
            rows: rows.collect::<Option<_>>()?,
        })
    }

    /// The object whose blend leaves the smallest band: the least of the largest logarithms of truth over reading.
    pub(in crate::generate) fn narrowest(&self, plate: &OwnedTables, objects: &ObjectTables) -> Touched {
        let smallest = micrometres(BALLS[0]).max(objects.law.least[0]);
        let balls = (0..CHOICES).map(|step| {
            let part = step as f64 / (CHOICES - 1) as f64;
            let radius = f64::from(smallest) * libm::pow(LARGEST / f64::from(smallest), part);
            Touched::Ball(libm::round(radius) as i32)
        });
        let Some(shortest) = objects.blended(plate, Touched::Ball(smallest)) else {
            return Touched::Plate;
        };
        // Where all of them answer.
        let last = last_rise(&shortest);
        let width = |touched: Touched| {
            let tables = objects.blended(plate, touched)?;
            let mut widest = 0.0_f64;
            for step in 0..=2 * RISES {
                let rise = last * libm::pow(BEGIN, 1.0 - step as f64 / (2 * RISES) as f64);
                for (ratios, _) in self.over(&tables, rise)? {
                    widest = ratios
                        .iter()
                        .fold(widest, |widest, ratio| widest.max(libm::log(*ratio).abs()));
                }
            }
            Some((touched, widest))
        };
        std::iter::once(Touched::Plate)
            .chain(balls)
            .filter_map(width)
            .min_by(|(_, one), (_, other)| one.total_cmp(other))
            .map_or(Touched::Plate, |(touched, _)| touched)
    }
}

fn last_rise(tables: &OwnedTables) -> f64 {
    PressureRise(tables.layout.maximum).pascals(tables.layout.fraction_bits)
}

/// Two ends with what was found there, and what lies between them: linear over the logarithm of the pressure.
fn along(from: (f64, [f64; 2]), to: (f64, [f64; 2]), rise: f64) -> [f64; 2] {
    let part = libm::log(rise / from.0) / libm::log(to.0 / from.0);
    let part = if part.is_finite() {
        part.clamp(0.0, 1.0)
    } else {
        1.0
    };
    [0, 1].map(|output| from.1[output] + part * (to.1[output] - from.1[output]))
}

/// Edges of the rows: 1, 2 and 5 times a power of ten, and the last rise, pascals.
fn edges(last: f64) -> Vec<f64> {
    let round = (-4..9).flat_map(|power| {
        [1.0, 2.0, 5.0].map(|digit| {
            if power < 0 {
                digit / libm::pow(10.0, f64::from(-power))
            } else {
                digit * libm::pow(10.0, f64::from(power))
            }
        })
    });
    let round: Vec<f64> = round.collect();
    let begin = round
        .partition_point(|edge| *edge <= BEGIN * last)
        .saturating_sub(1);
    let mut edges: Vec<f64> = round
        .into_iter()
        .skip(begin)
        .take_while(|edge| *edge < last)
        .collect();
    edges.push(last);
    edges
}

impl Band {
    /// The row of a pressure rise in pascals; nothing outside of the band.
    pub fn at(&self, rise: f64) -> Option<&BandRow> {
        self.rows.iter().find(|row| (row.from..=row.to).contains(&rise))
    }

    /// All rows in one.
    pub fn widest(&self) -> BandRow {
        let none = BandRow {
            from: f64::INFINITY,
            to: 0.0,
            force_percent: [0.0; 2],
            indentation_percent: [0.0; 2],
        };
        let join = |one: [f64; 2], other: [f64; 2]| [one[0].min(other[0]), one[1].max(other[1])];
        self.rows.iter().fold(none, |all, row| BandRow {
            from: all.from.min(row.from),
            to: all.to.max(row.to),
            force_percent: join(all.force_percent, row.force_percent),
            indentation_percent: join(all.indentation_percent, row.indentation_percent),
        })
    }
}

impl BandRow {
    /// Whether force and indentation are within the band of the reading, each in its own unit.
    pub fn holds(&self, read: [f64; 2], truth: [f64; 2]) -> bool {
        let bands = [self.force_percent, self.indentation_percent];
        bands.iter().zip(read).zip(truth).all(|((band, read), truth)| {
            let percent = 100.0 * (truth / read - 1.0);
            (band[0]..=band[1]).contains(&percent)
        })
    }
}

impl fmt::Display for Band {
    /// One line: the widest of it, with the set of objects.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let BandRow {
            force_percent: force,
            indentation_percent: indentation,
            ..
        } = self.widest();
        write!(
            f,
            "tables of a {}: where the chip is not told what it touches (balls of {} mm radius or more, plates tilted by up to {} \
             degrees, friction",
            self.tables_of,
            self.smallest_ball_mm,
            quoted::MAX_TILT
        )?;
        if let Some(cup) = self.cup_mm {
            write!(f, ", a cup of {cup} mm")?;
        }
        write!(
            f,
            "), the truth lies {:+.1} to {:+.1} % (force) and {:+.1} to {:+.1} % (indentation) from what is read",
            force[0], force[1], indentation[0], indentation[1]
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_end_at_round_pressures_and_at_the_last() {
        let found = edges(82_944.0);
        assert_eq!(found, [200.0, 500.0, 1e3, 2e3, 5e3, 1e4, 2e4, 5e4, 82_944.0]);
        assert_eq!(edges(50.0), [0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0]);
    }

    #[test]
    fn a_band_holds_what_lies_within_it_alone() {
        let row = BandRow {
            from: 1e3,
            to: 2e3,
            force_percent: [-10.0, 20.0],
            indentation_percent: [-5.0, 30.0],
        };
        assert!(row.holds([2.0, 1.0], [1.81, 1.29]));
        assert!(!row.holds([2.0, 1.0], [1.79, 1.0]));
        assert!(!row.holds([2.0, 1.0], [2.0, 1.31]));
        let band = Band {
            tables_of: Touched::Plate,
            smallest_ball_mm: 5.0,
            cup_mm: None,
            rows: vec![row],
        };
        assert_eq!(band.widest(), row);
        assert!(band.at(999.0).is_none() && band.at(2e3).is_some() && band.at(2_001.0).is_none());
    }
}
