//! Pressing the fingertip: states at asked indentations, the limit, and the curve between.

use crate::adapt::{Adaptive, Failure, Graded, Resolution};
use crate::curve::Contact;
use crate::design::Membrane as Dimensions;
use crate::design::{Design, RestBy};
use crate::equilibrium::{Closure, Outcome, PressControl};
use crate::history::History;
use crate::inflation::End;
use crate::material::{Hyperelastic, Law, Scaled};
use crate::membrane::{CONTACT_PARAMETER, CONTACT_RADIUS, Membrane, PRESSURE, TensionField};
use crate::rest::{Branch, Quantity, RestFailure};
use crate::stability::Margin;
use crate::state::{self, MeridianPoint, PressedState, Scale, Shape};
use core::f64::consts::{FRAC_PI_2, PI};
use core::fmt;

/// Gauss points an element: order twelve.
pub const STAGES: usize = 6;
/// The mesh of the full model: pressure and force to 1e-8 from an indentation of 1e-5 of the height on.
pub const FULL: Resolution = Resolution {
    density: 2.5,
    contact_elements: 3,
    tolerance: 1e-14,
};
/// A mesh for sweeps, with five Gauss points (`Press<Law, 5>`): force to 1e-8 from an indentation of a hundredth of the
/// height on, in a third of the time.
pub const SWEEP: Resolution = Resolution {
    density: 1.2,
    contact_elements: 1,
    tolerance: 1e-11,
};

/// What ends a press.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EndsBy {
    /// The bulge becomes tangent to the base plane.
    BulgeTouchesBase,
    /// All fluid has been pressed into the compliance: the membrane lies flat.
    FluidDrained,
}

impl EndsBy {
    /// The word used in tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::BulgeTouchesBase => "bulge-touches-base",
            Self::FluidDrained => "fluid-drained",
        }
    }
}

/// The end of a press.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// Largest indentation, metres.
    pub indentation: f64,
    /// Pressure there, pascals.
    pub pressure: f64,
    /// Force there, newtons.
    pub force: f64,
    /// Why it ends.
    pub ends_by: EndsBy,
}

/// Why the model gives no answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ModelError {
    /// A rest state of this pressure, radius or height does not exist; SI units.
    NoRestState {
        /// Which quantity was given.
        quantity: Quantity,
        /// Its value.
        asked: f64,
        /// The least value any rest state has.
        least: f64,
        /// The greatest value.
        greatest: f64,
    },
    /// Inflation ends before this pole stretch, because the law loses its stability.
    LawUnstable {
        /// The pole stretch asked for.
        asked: f64,
        /// Where it loses it, and how.
        margin: Margin,
    },
    /// The rest state was not found.
    RestUnsolved {
        /// What failed.
        failure: Failure,
    },
    /// The indentation lies beyond the end of the press.
    BeyondLimit {
        /// The indentation asked for, metres.
        asked: f64,
        /// The end.
        limit: Limit,
    },
    /// An indentation is a length >= 0.
    NotAnIndentation {
        /// What was asked for, metres.
        asked: f64,
    },
    /// The state was not found.
    PressUnsolved {
        /// The indentation asked for, metres.
        asked: f64,
        /// The largest indentation reached on the way, metres.
        reached: f64,
        /// What failed.
        failure: Failure,
    },
}

impl fmt::Display for ModelError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NoRestState {
                quantity,
                asked,
                least,
                greatest,
            } => {
                let (what, unit, factor) = match quantity {
                    Quantity::PoleStretch => {
                        return write!(
                            f,
                            "inflation does not lead to a pole stretch of {asked}: it stretches the pole to \
                             {greatest:.6}, and then the equator bulges instead; ask for less"
                        );
                    }
                    Quantity::Pressure => ("pressure", "kPa", 1e-3),
                    Quantity::EquatorRadius => ("equator radius", "mm", 1e3),
                    Quantity::Height => ("height", "mm", 1e3),
                };
                write!(
                    f,
                    "no rest state has a {what} of {} {unit}: inflation reaches {:.6} to {:.6} {unit}; ask for a \
                     value in between, or give the rest state by pole_stretch",
                    asked * factor,
                    least * factor,
                    greatest * factor
                )
            }
            Self::LawUnstable { asked, margin } => write!(
                f,
                "no rest state has a pole stretch of {asked}: on the way there the law loses its stability at stretches of \
                 {:.4} along and {:.4} around ({}); ask for less, or fit the law up to such stretches",
                margin.meridional_stretch, margin.hoop_stretch, margin.mode
            ),
            Self::RestUnsolved { failure } => {
                write!(
                    f,
                    "the rest state was not found ({failure}); try a smaller pole stretch"
                )
            }
            Self::BeyondLimit { asked, limit } => write!(
                f,
                "indentation {} mm is beyond the limit of {:.6} mm, where the press ends ({}); ask for less",
                asked * 1e3,
                limit.indentation * 1e3,
                limit.ends_by.word()
            ),
            Self::NotAnIndentation { asked } => {
                write!(
                    f,
                    "indentation {} mm is not possible: it must be a number of at least 0",
                    asked * 1e3
                )
            }
            Self::PressUnsolved {
                asked,
                reached,
                failure,
            } => write!(
                f,
                "the state at indentation {} mm was not found ({failure}); the last one found is at {:.6} mm",
                asked * 1e3,
                reached * 1e3
            ),
        }
    }
}

impl core::error::Error for ModelError {}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Newton(Outcome::Converged { .. }) => write!(f, "converged"),
            Self::Newton(Outcome::Inadmissible { position, .. }) => write!(
                f,
                "at parameter {position:.4} of the meridian the membrane lost its tension or its law its stability"
            ),
            Self::Newton(Outcome::Singular { .. }) => write!(f, "the equations became singular"),
            Self::Newton(Outcome::Stalled { step }) => {
                write!(f, "Newton's method did not converge, last step {step:.1e}")
            }
            Self::EdgePushes { position } => write!(
                f,
                "at the contact edge, parameter {position:.4} of the meridian, the membrane would have to push"
            ),
            Self::Unsettled => write!(f, "the edge of a wrinkled or slack zone did not settle"),
        }
    }
}

/// First indentation on the way from rest, over the height.
const FIRST_INDENTATION: f64 = 1e-4;
/// Largest factor between indentations on the way up.
const LARGEST_FACTOR: f64 = 4.0;
/// Largest step between indentations on the way up, over the height.
const LARGEST_STEP: f64 = 0.06;
/// Step under which the way up gives up, relative to the indentation.
const SMALLEST_STEP: f64 = 1e-4;
/// Indentation over the height up to which a press is followed before its fluid counts as drained.
const NEARLY_FLAT: f64 = 0.9995;
/// Contact radius over edge radius, minus one, that counts as rounding.
const EDGE_ROUNDING: f64 = 1e-10;

/// A fingertip at rest, ready to be pressed: of the law `L`, solved with `S` Gauss points an element.
#[derive(Clone, Debug)]
pub struct Press<L = Law, const S: usize = STAGES> {
    solver: Adaptive<Scaled<L>, S>,
    scale: Scale,
    compliance: f64,
    rest: Graded<S>,
    rest_shape: Shape,
    branch: Branch,
    history: History<S>,
    limit: Option<Limit>,
}

impl Press {
    /// Inflates a design to its rest state, on the mesh of the full model.
    ///
    /// # Errors
    /// [`ModelError::NoRestState`] and [`ModelError::RestUnsolved`].
    pub fn new(design: &Design, tension_field: TensionField) -> Result<Self, ModelError> {
        Self::with_resolution(design, tension_field, FULL)
    }
}

impl<const S: usize> Press<Law, S> {
    /// Inflates a design to its rest state, on a mesh of a given resolution.
    ///
    /// # Errors
    /// [`ModelError::NoRestState`] and [`ModelError::RestUnsolved`].
    pub fn with_resolution(
        design: &Design,
        tension_field: TensionField,
        resolution: Resolution,
    ) -> Result<Self, ModelError> {
        let Design {
            membrane,
            law,
            rest,
            compliance,
        } = design;
        Self::inflate(membrane, *law, *rest, *compliance, tension_field, resolution)
    }
}

impl<L: Hyperelastic, const S: usize> Press<L, S> {
    /// Inflates a membrane of any law to its rest state; `compliance` in cubic metres per pascal.
    ///
    /// # Errors
    /// [`ModelError::NoRestState`] and [`ModelError::RestUnsolved`].
    pub fn inflate(
        dimensions: &Dimensions,
        law: L,
        rest: RestBy,
        compliance: f64,
        tension_field: TensionField,
        resolution: Resolution,
    ) -> Result<Self, ModelError> {
        let modulus = law.shear_modulus();
        let scale = Scale::new(dimensions, modulus);
        let membrane = Membrane {
            aspect: dimensions.axial_semi_axis / dimensions.radial_semi_axis,
            law: Scaled {
                law,
                factor: 1.0 / modulus,
            },
            tension_field,
        };
        let mut solver = Adaptive::new(membrane, resolution);
        let by = |solver: &mut Adaptive<Scaled<L>, S>, quantity, asked, unit: f64| {
            solver
                .rest_by(quantity, asked / unit)
                .map_err(|failure| match failure {
                    RestFailure::OutOfReach { least, greatest, .. } => ModelError::NoRestState {
                        quantity,
                        asked,
                        least: least * unit,
                        greatest: greatest * unit,
                    },
                    RestFailure::Solver(failure) => ModelError::RestUnsolved { failure },
                })
        };
        let (rest, branch) = match rest {
            RestBy::PoleStretch(stretch) => {
                let rest = solver.rest_by_pole_stretch(stretch).map_err(|end| match end {
                    End::Turns { greatest } => ModelError::NoRestState {
                        quantity: Quantity::PoleStretch,
                        asked: stretch,
                        least: 1.0,
                        greatest,
                    },
                    End::Unstable(margin) => ModelError::LawUnstable {
                        asked: stretch,
                        margin,
                    },
                    End::Lost(failure) => ModelError::RestUnsolved { failure },
                })?;
                (rest, Branch::Only)
            }
            RestBy::Pressure(pascals) => by(&mut solver, Quantity::Pressure, pascals, scale.pressure)?,
            RestBy::EquatorRadius(metres) => by(&mut solver, Quantity::EquatorRadius, metres, scale.length)?,
            RestBy::Height(metres) => by(&mut solver, Quantity::Height, metres, scale.length)?,
        };
        let rest_shape = state::shape(&solver.equilibrium, &scale, &rest.solution);
        Ok(Self {
            solver,
            scale,
            compliance: compliance * scale.pressure / scale.volume(),
            history: History::new(&rest),
            rest,
            rest_shape,
            branch,
            limit: None,
        })
    }

    /// The rest state.
    pub fn rest(&self) -> &Shape {
        &self.rest_shape
    }

    /// Which of several rest states this is.
    pub fn branch(&self) -> Branch {
        self.branch
    }

    /// How far the law is from losing its stability, at the latest state or, before any, at rest.
    pub fn stability(&self) -> Margin {
        self.solver.stability(self.latest())
    }

    /// The same at rest.
    pub fn rest_stability(&self) -> Margin {
        self.solver.stability(&self.rest)
    }

    /// Newton iterations spent so far.
    pub fn iterations(&self) -> u64 {
        self.solver.iterations
    }

    /// The pressed state at an indentation in metres, 0 ..= limit.
    ///
    /// # Errors
    /// [`ModelError::NotAnIndentation`], [`ModelError::BeyondLimit`], [`ModelError::PressUnsolved`].
    pub fn at_indentation(&mut self, indentation: f64) -> Result<PressedState, ModelError> {
        let contact = self.contact_at(indentation)?;
        if indentation == 0.0 {
            return Ok(PressedState {
                indentation: 0.0,
                pressure_rise: 0.0,
                force: 0.0,
                contact_radius: 0.0,
                contact_parameter: 0.0,
                shape: self.rest_shape,
            });
        }
        let solution = &self.latest().solution;
        Ok(PressedState {
            indentation,
            pressure_rise: contact.pressure_rise,
            force: contact.force,
            contact_radius: solution.parameters[CONTACT_RADIUS] * self.scale.length,
            contact_parameter: solution.parameters[CONTACT_PARAMETER],
            shape: state::shape(&self.solver.equilibrium, &self.scale, solution),
        })
    }

    /// Pressure rise and force alone, at an indentation in metres, 0 ..= limit: without the sums and searches over
    /// the meridian that the full state takes.
    ///
    /// # Errors
    /// As [`Press::at_indentation`].
    pub fn contact_at(&mut self, indentation: f64) -> Result<Contact, ModelError> {
        if !(indentation >= 0.0 && indentation.is_finite()) {
            return Err(ModelError::NotAnIndentation { asked: indentation });
        }
        if indentation == 0.0 {
            return Ok(Contact::default());
        }
        if let Err(stop) = self.reach(indentation / self.scale.length) {
            return Err(match stop {
                Stop::BeyondLimit => ModelError::BeyondLimit {
                    asked: indentation,
                    limit: self.limit()?,
                },
                Stop::Failed { reached, failure } => ModelError::PressUnsolved {
                    asked: indentation,
                    reached: reached * self.scale.length,
                    failure,
                },
            });
        }
        let parameters = &self.latest().solution.parameters;
        let radius = parameters[CONTACT_RADIUS] * self.scale.length;
        let rise = parameters[PRESSURE] - self.rest.solution.parameters[PRESSURE];
        Ok(Contact {
            indentation,
            pressure_rise: rise * self.scale.pressure,
            force: parameters[PRESSURE] * self.scale.pressure * PI * radius * radius,
        })
    }

    /// The end of the press.
    ///
    /// # Errors
    /// [`ModelError::PressUnsolved`] if the way there fails.
    pub fn limit(&mut self) -> Result<Limit, ModelError> {
        if let Some(limit) = self.limit {
            return Ok(limit);
        }
        let height = self.rest.solution.height;
        let edge = self.edge();
        let scale = self.scale;
        let unit = scale.length;
        let end = |indentation: f64, pressure: f64, ends_by: EndsBy| Limit {
            indentation: indentation * unit,
            pressure: pressure * scale.pressure,
            force: pressure * PI * edge * edge * scale.tension * unit,
            ends_by,
        };
        let mut at = self.history.latest().map_or(0.0, |g| height - g.solution.height);
        let mut step = LARGEST_STEP * height;
        let limit = loop {
            // A step may not leap over what happens just before the end.
            let next = (at + step).min(NEARLY_FLAT * height);
            if at >= NEARLY_FLAT * height {
                // Nothing but the base is left under the plate.
                let rest = &self.rest.solution;
                let pressure = rest.parameters[PRESSURE] + rest.volume / self.compliance;
                break end(height, pressure, EndsBy::FluidDrained);
            }
            let stop = match self.reach(next) {
                Ok(()) => {
                    at = next;
                    continue;
                }
                Err(stop) => stop,
            };
            // The edge lies between: land on it.
            let closure = self.closure(PressControl::ContactRadius(edge));
            if let (Stop::BeyondLimit, Some(latest)) = (stop, self.history.latest())
                && let mut landed = latest.clone()
                && self.solver.settle(&mut landed, &closure).is_ok()
            {
                let [_, w] = landed.solution.nodes[landed.solution.elements()];
                let indentation = height - landed.solution.height;
                if w < 0.0 && indentation >= at && indentation <= next {
                    break end(
                        indentation,
                        landed.solution.parameters[PRESSURE],
                        EndsBy::BulgeTouchesBase,
                    );
                }
            }
            step *= 0.5;
            if step < SMALLEST_STEP * height {
                let failure = match stop {
                    Stop::Failed { failure, .. } => failure,
                    Stop::BeyondLimit => Failure::Unsettled,
                };
                return Err(ModelError::PressUnsolved {
                    asked: next * unit,
                    reached: at * unit,
                    failure,
                });
            }
        };
        self.limit = Some(limit);
        Ok(limit)
    }

    /// Hoop stretch of the clamped edge: its radius over `a0`.
    fn edge(&self) -> f64 {
        self.rest.solution.nodes[self.rest.solution.elements()][0]
    }

    fn latest(&self) -> &Graded<S> {
        self.history.latest().unwrap_or(&self.rest)
    }

    fn closure(&self, control: PressControl) -> Closure {
        let rest = &self.rest.solution;
        Closure::Press {
            control,
            equator_stretch: self.edge(),
            fluid: rest.volume + self.compliance * rest.parameters[PRESSURE],
            compliance: self.compliance,
        }
    }

    /// Solves the state at a dimensionless indentation, over as many states in between as it takes.
    fn reach(&mut self, indentation: f64) -> Result<(), Stop> {
        let height = self.rest.solution.height;
        if indentation >= height {
            return Err(Stop::BeyondLimit);
        }
        if self.history.latest().is_none() {
            let mut first = indentation.min(FIRST_INDENTATION * height);
            loop {
                *self.history.working() = self.first_contact(first);
                let Err(stop) = self.attempt(first) else { break };
                first *= 0.1;
                if first < 1e-10 * height {
                    return Err(stop);
                }
            }
        }
        let mut factor = LARGEST_FACTOR;
        let mut largest_step = LARGEST_STEP * height;
        loop {
            let at = height - self.latest().solution.height;
            let next = indentation
                .clamp(at / factor, at * factor)
                .clamp(at - largest_step, at + largest_step);
            let arrives = next.to_bits() == indentation.to_bits();
            self.history.predict(next);
            let mut result = self.attempt(next);
            if matches!(result, Err(Stop::Failed { .. })) {
                self.history.repeat();
                result = self.attempt(next);
            }
            if matches!(result, Err(Stop::Failed { .. }))
                && let Some(other) = self.solver.with_other_pole(self.latest())
            {
                *self.history.working() = other;
                result = self.attempt(next);
            }
            match result {
                Ok(()) if arrives => return Ok(()),
                Ok(()) => {
                    factor = libm::sqrt(factor * LARGEST_FACTOR);
                    largest_step = (2.0 * largest_step).min(LARGEST_STEP * height);
                }
                Err(stop) => {
                    let tried = (next - at).abs();
                    largest_step = 0.5 * tried;
                    factor = libm::sqrt((next / at).max(at / next));
                    if tried < SMALLEST_STEP * at {
                        return Err(match stop {
                            Stop::Failed { failure, .. } => Stop::Failed {
                                reached: at,
                                failure: self.solver.edge_pushes(self.latest()).unwrap_or(failure),
                            },
                            Stop::BeyondLimit => stop,
                        });
                    }
                }
            }
        }
    }

    /// Solves from the state in work; an admissible result becomes the latest.
    fn attempt(&mut self, indentation: f64) -> Result<(), Stop> {
        let closure = self.closure(PressControl::Height(self.rest.solution.height - indentation));
        let edge = self.edge();
        let state = self.history.working();
        self.solver
            .settle(state, &closure)
            .map_err(|failure| Stop::Failed {
                reached: 0.0,
                failure,
            })?;
        if state.solution.parameters[CONTACT_RADIUS] > edge * (1.0 + EDGE_ROUNDING) {
            return Err(Stop::BeyondLimit);
        }
        self.history.accept(indentation, &self.solver.equilibrium.gauss);
        Ok(())
    }

    /// A guess from the rest state: the asymptotics of first contact.
    ///
    /// `H = (P0 r^2 / 2 T0) ln(K / r)`, with the edge radius for the design's length `K`; under the plate the pole's
    /// state, outside the rest state with the plate's share taken off the vertical balance.
    fn first_contact(&self, indentation: f64) -> Graded<S> {
        let rest = &self.rest.solution;
        let [pole_stretch, pressure, ..] = rest.parameters;
        let tension = rest.nodes[0][1] / pole_stretch;
        let edge = self.edge();
        let mut radius = 0.1 * edge;
        for _ in 0..30 {
            let logarithm = libm::log(edge / radius).max(0.3);
            radius = libm::sqrt(2.0 * tension * indentation / (pressure * logarithm)).min(0.5 * edge);
        }
        let gauss = &self.solver.equilibrium.gauss;
        let contact_parameter = libm::asin((radius / pole_stretch).min(0.9));
        let mut pressed = self.rest.clone();
        pressed.depth.contact_parameter = 0.0;
        // An unpressed solution laid on a mesh with a contact zone, then corrected.
        pressed.solution.parameters[CONTACT_PARAMETER] = contact_parameter;
        pressed.solution.parameters[CONTACT_RADIUS] = radius;
        let mut laid = self.solver.lay_contact(&pressed, contact_parameter);
        let correct = |t: f64| {
            let ([u, w], stretch) = rest.at(gauss, t);
            let x = libm::sin(t);
            let k_rest = 0.5 * pressure * u * u * x;
            let n_squared = w * w + k_rest * k_rest;
            let k = if t > contact_parameter {
                0.5 * pressure * (u * u * x - radius * radius / x)
            } else {
                0.0
            };
            ([u, libm::sqrt((n_squared - k * k).max(w * w))], stretch)
        };
        let solution = &mut laid.solution;
        for e in 0..solution.elements() {
            let span = solution.span(e);
            (solution.nodes[e], _) = correct(span.start);
            for j in 0..S {
                (solution.stages[e][j], solution.stretches[e][j]) =
                    correct(span.start + gauss.nodes[j] * span.length);
            }
        }
        (solution.nodes[solution.elements()], _) = correct(FRAC_PI_2);
        laid
    }

    /// The meridian of the state at an indentation in metres (0 is the rest state), from the pole to the equator.
    ///
    /// `points` of them, at least 3: equally spaced in the parameter within the contact and within the free zone,
    /// with one on the contact edge. A point at which the law gives no answer is left out.
    ///
    /// # Errors
    /// As [`Press::at_indentation`].
    pub fn profile(
        &mut self,
        indentation: f64,
        points: usize,
    ) -> Result<impl Iterator<Item = MeridianPoint>, ModelError> {
        let edge = self.at_indentation(indentation)?.contact_parameter;
        let graded = if indentation == 0.0 {
            &self.rest
        } else {
            self.latest()
        };
        let intervals = points.max(3) - 1;
        let under_plate = if edge > 0.0 {
            let share = libm::round(intervals as f64 * edge / FRAC_PI_2) as usize;
            share.clamp(1, intervals - 1)
        } else {
            0
        };
        let parameter = move |i: usize| {
            if i < under_plate {
                edge * i as f64 / under_plate as f64
            } else {
                let share = (i - under_plate) as f64 / (intervals - under_plate) as f64;
                // Exact at both ends.
                edge * (1.0 - share) + FRAC_PI_2 * share
            }
        };
        let (equilibrium, scale, solution) = (&self.solver.equilibrium, &self.scale, &graded.solution);
        Ok((0..=intervals).filter_map(move |i| {
            let t = parameter(i);
            state::meridian_point(
                equilibrium,
                scale,
                solution,
                t,
                equilibrium.height_at(solution, t),
            )
        }))
    }
}

/// Why a state was not reached.
#[derive(Clone, Copy, Debug)]
enum Stop {
    BeyondLimit,
    Failed { reached: f64, failure: Failure },
}

#[cfg(feature = "std")]
impl<L: Hyperelastic, const S: usize> Press<L, S> {
    /// The curve of a press down to `deepest`, metres: states from `deepest * 1e-6` on.
    ///
    /// # Errors
    /// As [`Press::at_indentation`], and [`CurveFailure::Shape`] if pressure or force do not grow throughout.
    pub fn curve(&mut self, deepest: f64) -> Result<crate::curve::Curve, CurveFailure> {
        let mut points = Vec::new();
        for k in 0..=CURVE_STATES {
            let ratio = k as f64 / CURVE_STATES as f64;
            let indentation = deepest * libm::pow(CURVE_RANGE, ratio - 1.0);
            points.push(self.contact_at(indentation).map_err(CurveFailure::Model)?);
        }
        crate::curve::Curve::new(points).map_err(CurveFailure::Shape)
    }
}

/// States of a curve.
#[cfg(feature = "std")]
const CURVE_STATES: usize = 96;
/// Deepest over shallowest indentation of a curve.
#[cfg(feature = "std")]
const CURVE_RANGE: f64 = 1e5;

/// Why there is no curve.
#[cfg(feature = "std")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CurveFailure {
    /// A state is missing.
    Model(ModelError),
    /// Pressure or force do not grow with indentation.
    Shape(crate::curve::CurveError),
}

#[cfg(feature = "std")]
impl fmt::Display for CurveFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Model(error) => error.fmt(f),
            Self::Shape(error) => error.fmt(f),
        }
    }
}

#[cfg(feature = "std")]
impl core::error::Error for CurveFailure {}
