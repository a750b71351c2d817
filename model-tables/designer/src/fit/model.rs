//! The design's model as a fit sees it: what the bench would read, for any values of the parameters.
//!
//! A membrane's pressure and force are proportional to modulus times wall, a solid's to its modulus, so a curve is
//! solved once for a rest state and a compliance (of a solid: and a wall), and scaled for the rest.

use super::data::{Data, DataRow};
use super::heading::Measured;
use super::kind::Kind;
use super::parameter::{Parameter, ParameterValues};
use super::ready::Ready;
use super::trial_zeros::TrialZeros;
use model_tables::curve::{Contact, Curve};
use model_tables::design::{Design, RestBy};
use model_tables::design_file::DesignFile;
use model_tables::membrane::press::MembraneError;
use model_tables::model::ModelError;
use std::cell::RefCell;
use std::fmt;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Shallowest indentation of a curve over the shallowest of the data, and over the deepest at least; the asymptotes
/// carry on from there.
const SHALLOWEST: [f64; 2] = [0.8, 5e-3];
/// Factor between the indentations of a curve.
const STEP: f64 = 1.3;
/// The last state of a press that ends, over its limit.
const NEARLY: f64 = 0.9995;
/// States of a curve at most: a press of any depth from a thousandth of it on.
const MAX_STATES: usize = 64;
/// States that a fit of a membrane, and of a solid, solves at most: many times what data of such a device take.
const MAX_WORK: [usize; 2] = [60_000, 2_500];
/// Curves that are kept.
const KEPT: usize = 512;

/// A quantity that is measured and predicted.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum DataQuantity {
    /// Force, newtons.
    Force,
    /// Pressure rise, pascals.
    Rise,
}

impl fmt::Display for DataQuantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Force => "force",
            Self::Rise => "pressure rise",
        })
    }
}

/// One number to explain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Target {
    /// Index of the row.
    pub(super) row: usize,
    /// What is measured.
    pub(super) quantity: DataQuantity,
    /// Its value, SI.
    pub(super) measured: f64,
}

/// What there is to explain: of a row with an indentation its force and its rise, of one without its force.
pub(super) fn targets(data: &Data) -> Vec<Target> {
    let mut targets = Vec::new();
    for (row, measured) in data.rows.iter().enumerate() {
        let mut push = |quantity, measured: Option<f64>| {
            targets.extend(measured.map(|measured| Target {
                row,
                quantity,
                measured,
            }));
        };
        push(DataQuantity::Force, measured.force);
        if measured.indentation.is_some() {
            push(DataQuantity::Rise, measured.rise);
        }
    }
    targets
}

/// A press of unit factors, and its way on beyond the last state.
#[derive(Debug)]
pub(super) struct Shape {
    curve: Curve,
    /// `d ln / d ln H` of rise and force at the end.
    end_slopes: [f64; 2],
    /// Whether the press ended before all of the data was covered.
    pub(super) ends: bool,
}

impl Shape {
    fn at_indentation(&self, indentation: f64) -> Contact {
        let end = self.curve.end();
        if indentation <= end.indentation {
            return self.curve.at_indentation(indentation);
        }
        // Smooth, so that a fit finds its way back; whoever ends here is told.
        let ratio = indentation / end.indentation;
        Contact {
            indentation,
            pressure_rise: end.pressure_rise * libm::pow(ratio, self.end_slopes[0]),
            force: end.force * libm::pow(ratio, self.end_slopes[1]),
        }
    }

    fn force_at_rise(&self, rise: f64) -> f64 {
        let end = self.curve.end();
        if rise <= end.pressure_rise {
            return self.curve.at_pressure_rise(rise).force;
        }
        end.force * libm::pow(rise / end.pressure_rise, self.end_slopes[1] / self.end_slopes[0])
    }

    /// Deepest solved indentation, metres.
    pub(super) fn deepest(&self) -> f64 {
        self.curve.end().indentation
    }
}

/// Rest state, compliance and wall of unit factors, as the leading 52 bits.
type Key = [u64; 3];

/// What solving gave.
type Solved = Result<Rc<Shape>, ModelError>;

/// The model with what it has solved.
#[derive(Debug)]
pub(super) struct Model {
    design: Design,
    /// Which model.
    pub(super) kind: Kind,
    rest: RestBy,
    by_stretch: bool,
    deepest: f64,
    shallowest: f64,
    largest_rise: f64,
    cache: RefCell<Vec<(Key, Solved)>>,
    /// Of each trial; they move while it is fitted.
    zeros: RefCell<TrialZeros>,
    /// States solved, by this fit alone.
    work: Arc<AtomicUsize>,
}

/// States solved by every fit of this process, for a line of progress.
static SOLVED: AtomicUsize = AtomicUsize::new(0);

/// States that all fits of this process have solved so far.
pub fn states_solved() -> usize {
    SOLVED.load(Ordering::Relaxed)
}

impl Model {
    /// Ready to predict the data; `free` parameters will be changed.
    pub(super) fn new(
        kind: Kind,
        file: &DesignFile,
        data: &Data,
        free: &[Parameter],
        zeros: TrialZeros,
    ) -> Self {
        Self::sharing(kind, file, data, free, zeros, Arc::default())
    }

    /// The zeros of the trials as they are now.
    pub(super) fn zeros(&self) -> TrialZeros {
        self.zeros.borrow().clone()
    }

    /// Other zeros of the trials.
    pub(super) fn set_zeros(&self, zeros: TrialZeros) {
        *self.zeros.borrow_mut() = zeros;
    }

    /// The count of its work, for models that share it.
    pub(super) fn work(&self) -> Arc<AtomicUsize> {
        Arc::clone(&self.work)
    }

    /// As [`Model::new`], its work counted with that of others.
    pub(super) fn sharing(
        kind: Kind,
        file: &DesignFile,
        data: &Data,
        free: &[Parameter],
        zeros: TrialZeros,
        work: Arc<AtomicUsize>,
    ) -> Self {
        let mut nominal = file.clone();
        nominal.calibration = model_tables::design_file::Calibration::default();
        let design = nominal.design();
        let largest = |of: fn(&DataRow) -> Option<f64>| data.rows.iter().filter_map(of).fold(0.0, f64::max);
        let deepest = zeros.deepest(data);
        Self {
            kind,
            rest: file.design().rest,
            by_stretch: ParameterValues::rest_by_stretch(file, free),
            deepest,
            shallowest: data
                .rows
                .iter()
                .filter_map(|row| zeros.indentation(row))
                .filter(|&indentation| indentation > 0.0)
                .fold(deepest, f64::min),
            largest_rise: largest(|row| row.indentation.map_or(row.rise, |_| None)),
            design,
            cache: RefCell::new(Vec::new()),
            zeros: RefCell::new(zeros),
            work,
        }
    }

    /// Whether the fit has solved as many states as it may.
    pub(super) fn is_spent(&self) -> bool {
        let most = if self.kind.is_cheap() {
            MAX_WORK[0]
        } else {
            MAX_WORK[1]
        };
        self.work.load(Ordering::Relaxed) > most
    }

    /// Height of the design at rest, metres.
    ///
    /// # Errors
    /// [`ModelError`] when there is no rest state.
    pub(super) fn height(&self) -> Result<f64, ModelError> {
        let design = Design {
            rest: self.rest,
            ..self.design
        };
        Ok(Ready::new(self.kind, &design)?.height())
    }

    /// What multiplies pressure and force, over that of the design: modulus, of a membrane times wall.
    pub(super) fn stiffness(&self, values: &ParameterValues) -> f64 {
        let wall = match self.kind {
            Kind::Membrane => values.get(Parameter::Thickness),
            Kind::Wall(_) => 1.0,
        };
        values.get(Parameter::Material) * wall
    }

    /// The press of unit factors for these values.
    ///
    /// # Errors
    /// [`ModelError`] when there is no rest state or the press fails.
    pub(super) fn shape(&self, values: &ParameterValues) -> Result<Rc<Shape>, ModelError> {
        let scale = self.stiffness(values);
        let rest = if self.by_stretch {
            RestBy::PoleStretch(values.get(Parameter::PoleStretch))
        } else {
            match self.rest {
                RestBy::Pressure(pressure) => RestBy::Pressure(pressure / scale),
                geometric => geometric,
            }
        };
        let compliance = values.get(Parameter::Compliance) * 1e-12 * scale;
        let given = match rest {
            RestBy::Unstretched => 0.0,
            RestBy::PoleStretch(given)
            | RestBy::Pressure(given)
            | RestBy::EquatorRadius(given)
            | RestBy::Height(given) => given,
        };
        let wall = match self.kind {
            Kind::Membrane => 1.0,
            Kind::Wall(_) => values.get(Parameter::Thickness),
        };
        // A step of the fit in stiffness alone moves the compliance by a rounding, and no more.
        let key: Key = [given, compliance, wall].map(|value| (value.to_bits() + (1 << 11)) >> 12);
        if let Some((_, found)) = self.cache.borrow().iter().find(|(known, _)| *known == key) {
            return found.clone();
        }
        let mut design = Design {
            rest,
            compliance,
            ..self.design
        };
        design.membrane.thickness *= wall;
        let most_indentation = self.deepest - 1e-3 * values.get(Parameter::IndentationOffset).min(0.0);
        let found = self
            .solve(&design, 1.02 * most_indentation, scale, values)
            .map(Rc::new);
        let mut cache = self.cache.borrow_mut();
        if cache.len() >= KEPT {
            drop(cache.remove(0));
        }
        cache.push((key, found.clone()));
        found
    }

    fn solve(
        &self,
        design: &Design,
        deepest: f64,
        scale: f64,
        values: &ParameterValues,
    ) -> Result<Shape, ModelError> {
        let mut press = Ready::new(self.kind, design)?;
        let largest_rise = 1.1 * self.largest_rise / (scale * values.get(Parameter::PressureGain));
        let offset = 1e-3 * values.get(Parameter::IndentationOffset);
        let [of_data, of_deepest] = SHALLOWEST;
        let mut indentation = if deepest > 0.0 {
            (of_data * (self.shallowest - offset)).clamp(of_deepest * deepest, 0.2 * deepest)
        } else {
            of_deepest * press.height()
        };
        let mut points: Vec<Contact> = Vec::new();
        let mut ends = false;
        while points.len() < MAX_STATES {
            self.work.fetch_add(1, Ordering::Relaxed);
            SOLVED.fetch_add(1, Ordering::Relaxed);
            match press.contact_at(indentation) {
                Ok(point) => points.push(point),
                Err(error) => {
                    let limit = error.beyond().ok_or(error)?;
                    ends = true;
                    let last = NEARLY * limit.indentation;
                    if points.is_empty() {
                        points.push(press.contact_at(last / STEP)?);
                    }
                    if points.last().is_none_or(|point| point.indentation < last) {
                        points.push(press.contact_at(last)?);
                    }
                    break;
                }
            }
            let last = points[points.len() - 1];
            if last.indentation >= deepest && last.pressure_rise >= largest_rise {
                break;
            }
            indentation *= STEP;
            if last.indentation < deepest && indentation > deepest {
                indentation = deepest;
            }
        }
        let [.., before, end] = points[..] else {
            return Err(MembraneError::NotAnIndentation { asked: deepest }.into());
        };
        let slope = |of: fn(&Contact) -> f64| {
            libm::log(of(&end) / of(&before)) / libm::log(end.indentation / before.indentation)
        };
        let end_slopes = [slope(|c| c.pressure_rise), slope(|c| c.force)];
        let unsolved = ModelError::from(MembraneError::NotAnIndentation { asked: deepest });
        Ok(Shape {
            curve: Curve::new(points).map_err(|_| unsolved)?,
            end_slopes,
            ends,
        })
    }

    /// What the bench would read of each target.
    ///
    /// # Errors
    /// As [`Model::shape`].
    pub(super) fn predict(
        &self,
        values: &ParameterValues,
        data: &Data,
        targets: &[Target],
    ) -> Result<Vec<f64>, ModelError> {
        let compliance = values.get(Parameter::Compliance);
        if compliance < 0.0 {
            // Odd about zero: smooth, so that the fit sees whether it wants to go there, and no such device is solved.
            let with = |compliance: f64| {
                let mut values = *values;
                values.set(Parameter::Compliance, compliance);
                self.predict(&values, data, targets)
            };
            let (zero, mirrored) = (with(0.0)?, with(-compliance)?);
            return Ok(zero.iter().zip(mirrored).map(|(a, b)| 2.0 * a - b).collect());
        }
        let shape = self.shape(values)?;
        let scale = self.stiffness(values);
        let gain = values.get(Parameter::PressureGain);
        let rise_offset = 1e3 * values.get(Parameter::PressureOffset);
        let offset = 1e-3 * values.get(Parameter::IndentationOffset);
        let force_offset = values.get(Parameter::ForceOffset);
        let zeros = self.zeros.borrow();
        Ok(targets
            .iter()
            .map(|target| {
                let row = &data.rows[target.row];
                let rise_offset = rise_offset + zeros.of(row, Measured::PressureRise);
                let force_offset = force_offset + zeros.of(row, Measured::Force);
                if let Some(read) = zeros.indentation(row) {
                    let contact = shape.at_indentation(read - offset);
                    match target.quantity {
                        DataQuantity::Force => scale * contact.force + force_offset,
                        DataQuantity::Rise => gain * scale * contact.pressure_rise + rise_offset,
                    }
                } else {
                    let rise = (row.rise.unwrap_or(0.0) - rise_offset) / gain;
                    scale * shape.force_at_rise(rise / scale) + force_offset
                }
            })
            .collect())
    }
}
