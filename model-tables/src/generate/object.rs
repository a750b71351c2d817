//! Tables of objects other than a plate: the tables of a reference object, and the law of its weight for other objects. The
//! reference is a ball, or the cup that a design states. A weight converts one ball to another within one percent, but a ball to a
//! cup only within 5 or 10 percent.

use super::{OwnedTables, curve_point};
use crate::curve::Contact;
use crate::table::blend::{MAX_WORDS, blend, last_answered};
use crate::table::law::{BlendLaw, LAW_BITS, Touched, WEIGHT_BITS, Weights};
use crate::table::{ContactLookup as _, LoadedTables};
use crate::units::PressureRise;
use certified_lookup::generate::{AccuracyGoal, beside, lowest_segment_end};

mod band;
mod chip_band;
mod press;
pub mod quoted;
mod solved;

pub use band::{Band, BandRow};
pub(super) use band::{TableError, Unknown};
pub(super) use press::plate_of;
pub use solved::{NoObjects, SolvedObject, SolvedObjects};

/// What the tables of the reference object are held to, as a multiple of what those of the plate are: its share of a blend's error.
const REFERENCE_ACCURACY: f64 = 3.0;

/// Largest error of a blend, percent of the reading of a solved object. A blend with a larger error is not offered. A ball and
/// a cup differ in more than a weight.
const FARTHEST: f64 = 6.0;

/// Largest excess of a law beyond its ends, in units of a weight.
const MARGIN: i32 = 1 << (WEIGHT_BITS - 5);

/// Tables of the reference object, and the errors of a blend of them with the plate's.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectTables {
    /// The reference object's, of the layout of the plate's.
    pub ball: OwnedTables,
    /// The reference object: a ball, or the cup that the design states.
    pub reference: Touched,
    /// The weights over the radius.
    pub law: BlendLaw,
    /// The object of the design, in use until a command changes it.
    pub start: Touched,
    /// Errors are of pressure rises from here on, pascals.
    pub from: f64,
    /// The blend against every solved object.
    pub errors: Vec<BlendError>,
}

/// A blend of integers, as the chip has it, against a solved object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlendError {
    /// The object's radius, millimetres; negative for a cup.
    pub radius_mm: f64,
    /// Whether the law was fitted to it.
    pub fitted: bool,
    /// Errors up to the indentation of the design.
    pub pressed: BlendErrors,
    /// Errors up to the last pressure rise of the blend.
    pub answered: BlendErrors,
}

/// Largest errors of a blend up to a pressure rise, percent of reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlendErrors {
    /// The last pressure rise compared, pascals.
    pub last: f64,
    /// Of the force, percent of reading.
    pub force_percent: f64,
    /// Of the indentation, percent of reading.
    pub indentation_percent: f64,
}

impl ObjectTables {
    /// The tables of an object, as the chip blends them. `None` if the law does not cover the object.
    pub fn blended(&self, plate: &OwnedTables, touched: Touched) -> Option<OwnedTables> {
        let weights = self.law.weights(touched)?;
        Some(answered(plate, &self.ball, &weights))
    }
}

/// A blend up to its last rise.
fn answered(plate: &OwnedTables, ball: &OwnedTables, weights: &Weights) -> OwnedTables {
    let mut tables = blended(plate, ball, weights);
    let plain = |rise| plate.contact_at(rise);
    tables.layout.maximum = last_answered(&plate.layout, weights, plain, |rise| tables.contact_at(rise));
    tables
}

fn blended(plate: &OwnedTables, ball: &OwnedTables, weights: &Weights) -> OwnedTables {
    let mut words = vec![0; plate.words.len()];
    blend(&plate.layout, &plate.words, &ball.words, weights, &mut words);
    OwnedTables {
        layout: plate.layout,
        words,
    }
}

impl SolvedObjects {
    /// The reference object's tables in the layout of the plate's. `None` if every such table lets some blend fall.
    pub(super) fn tables(
        &self,
        plate: &OwnedTables,
        end: Contact,
        goal: &AccuracyGoal,
    ) -> Option<ObjectTables> {
        if plate.layout.halvings > 0 || plate.words.len() > MAX_WORDS {
            return None;
        }
        let goal = AccuracyGoal {
            percent_of_reading: goal
                .percent_of_reading
                .map(|percent| REFERENCE_ACCURACY * percent),
            ..*goal
        };
        let tables_from = |before| beside(plate, &self.reference_beyond, curve_point(end), before, &goal);
        let ball = if self.reference.is_cup() {
            // First contact is shared with the plate, and a cup has less indentation there: its tables begin below that, and a blend
            // raises them by less than a micrometre.
            blended(plate, &tables_from([0; 2])?, &Weights::REFERENCE)
        } else {
            tables_from(lowest_segment_end(plate)?)?
        };
        let mut law = self.law(plate.layout.fraction_bits, plate.layout.maximum);
        let errors = loop {
            let errors: Vec<BlendError> = self
                .objects
                .iter()
                .filter_map(|object| {
                    let weights = law.weights(object.touched)?;
                    Some(self.error(&answered(plate, &ball, &weights), object))
                })
                .collect();
            let is_far = |error: &BlendError| {
                let BlendErrors {
                    force_percent,
                    indentation_percent,
                    ..
                } = error.pressed;
                error.radius_mm.is_sign_negative() != self.reference.is_cup()
                    && force_percent.max(indentation_percent) > FARTHEST
            };
            if !errors.iter().any(is_far) && rises(plate, &ball, &law) {
                break errors;
            }
            // The tightest object of the other kind is left out.
            let other = usize::from(!self.reference.is_cup());
            if law.least[other] == 0 {
                return None;
            }
            law.least[other] = self.next_wider(other, law.least[other]);
        };
        law.weights(self.start)?;
        Some(ObjectTables {
            ball,
            reference: self.reference,
            law,
            start: self.start,
            from: self.from,
            errors,
        })
    }

    /// The next wider radius than this of solved balls (0) or cups (1), micrometres; 0 where there is none.
    fn next_wider(&self, side: usize, least: i32) -> i32 {
        let radii = self.objects.iter().filter_map(|object| match object.touched {
            Touched::Ball(radius) if side == 0 => Some(radius),
            Touched::Cup(radius) if side == 1 => Some(radius),
            _ => None,
        });
        radii.filter(|radius| *radius > least).min().unwrap_or(0)
    }

    /// The law in integers.
    fn law(&self, fraction_bits: u32, maximum: i32) -> BlendLaw {
        let counts = |rise: f64| {
            PressureRise::from_pascals(rise, fraction_bits)
                .0
                .clamp(1, maximum)
        };
        let unit = f64::from(1 << LAW_BITS);
        let coefficients = |real: [f64; 3]| {
            let [sum, second, third] =
                [real.iter().sum::<f64>(), real[1], real[2]].map(|real| libm::round(real * unit) as i32);
            [sum - second - third, second, third]
        };
        let both = |of: [solved::Coefficients; 2]| of.map(coefficients);
        BlendLaw {
            reference: press::micrometres(self.scale),
            offset: press::micrometres(self.offset),
            least: self.least.map(press::micrometres),
            last: self.last.map(counts),
            force: both(self.force),
            indentation: both(self.indentation),
        }
    }

    fn error(&self, tables: &OwnedTables, object: &SolvedObject) -> BlendError {
        let bits = tables.layout.fraction_bits;
        let last = PressureRise(tables.layout.maximum).pascals(bits);
        let last = last.min(object.curve.end().pressure_rise);
        let errors = |last: f64| {
            let mut found = BlendErrors {
                last,
                force_percent: 0.0,
                indentation_percent: 0.0,
            };
            for rise in solved::rises(self.from, last) {
                let read = tables.contact_at(PressureRise::from_pascals(rise, bits));
                let truth = object.curve.at_pressure_rise(rise);
                let percent = |got: f64, truth: f64| 100.0 * (got / truth - 1.0).abs();
                found.force_percent = found
                    .force_percent
                    .max(percent(read.force.newtons(), truth.force));
                found.indentation_percent = found
                    .indentation_percent
                    .max(percent(read.indentation.metres(), truth.indentation));
            }
            found
        };
        BlendError {
            radius_mm: object.radius * 1e3,
            fitted: object.fitted,
            pressed: errors(object.fitted_to.min(last)),
            answered: errors(last),
        }
    }
}

/// Whether neither output falls with any weight that the law gives.
fn rises(plate: &OwnedTables, ball: &OwnedTables, law: &BlendLaw) -> bool {
    let ends = [Touched::Ball(law.least[0]), Touched::Cup(law.least[1])]
        .into_iter()
        .filter_map(|tightest| law.weights(tightest));
    let (mut least, mut most) = ([-MARGIN; 2], [MARGIN; 2]);
    for weights in ends {
        for (output, weight) in [weights.force, weights.indentation].into_iter().enumerate() {
            least[output] = least[output].min(weight - MARGIN);
            most[output] = most[output].max(weight + MARGIN);
        }
    }
    let widest = (most[0] - least[0]).max(most[1] - least[1]);
    (0..=widest).all(|step| {
        let [force, indentation] = [0, 1].map(|output| (least[output] + step).min(most[output]));
        let weights = Weights {
            force,
            indentation,
            maximum: i32::MAX,
        };
        let tables = blended(plate, ball, &weights);
        let bytes: Vec<[u8; 4]> = tables.words.iter().map(|word| word.to_le_bytes()).collect();
        LoadedTables::new(tables.layout, &bytes).is_ok()
    })
}
