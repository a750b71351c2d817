//! Presses the fingertip: states at given indentations, the limit of the press, and the curve between states.

mod error;
mod limit;
mod load_stepping;
#[cfg(feature = "std")]
mod sampled;

pub use error::MembraneError;
#[cfg(feature = "std")]
pub use sampled::curve_depths;

use crate::curve::Contact;
use crate::design::Membrane as Dimensions;
use crate::design::{Design, RestBy};
use crate::limit::Limit;
use crate::material::stability::Margin;
use crate::material::{Hyperelastic, Law, Scaled};
use crate::membrane::adapt::{Adaptive, Graded, Resolution};
use crate::membrane::closure::{Closure, PressControl};
use crate::membrane::continuation::Predictor;
use crate::membrane::equations::{CONTACT_PARAMETER, CONTACT_RADIUS, PRESSURE, TensionField};
use crate::membrane::press::workspace::Workspace;
use crate::membrane::rest::Branch;
use crate::membrane::solution::Solution;
use crate::membrane::state::{self, MeridianPoint, PressShape, PressedState, UnitScale};
use crate::object::{Friction, Object, Shape as ObjectShape};
use core::f64::consts::{FRAC_PI_2, PI};
use load_stepping::Stop;

pub mod workspace;

/// Gauss points an element: order twelve.
pub const STAGES: usize = 6;
/// The mesh of the full model: pressure and force to 1e-8 from an indentation of 1e-5 of the height on.
pub const FULL: Resolution = Resolution {
    density: 2.5,
    contact_elements: 3,
    tolerance: 1e-14,
    last_term: 1e-7,
};
/// A mesh twice as fine, to hold the full model to.
pub const FINER: Resolution = Resolution {
    density: 2.0 * FULL.density,
    contact_elements: 2 * FULL.contact_elements,
    ..FULL
};
/// A mesh for curves: what [`FULL`] gives to 1e-8, in half the time.
pub const CURVE: Resolution = Resolution {
    density: 1.6,
    contact_elements: 2,
    tolerance: 1e-12,
    last_term: 1e-6,
};
/// A mesh for sweeps, with five Gauss points (`Press<Law, 5>`): force to 1e-8 from an indentation of a hundredth of the
/// height on, in a third of the time.
pub const SWEEP: Resolution = Resolution {
    density: 1.2,
    contact_elements: 1,
    tolerance: 1e-11,
    last_term: 3e-6,
};

/// Largest step between indentations on the way up, over the height.
const LARGEST_STEP: f64 = 0.06;
/// Step under which the way up gives up, relative to the indentation.
const SMALLEST_STEP: f64 = 1e-4;

/// A fingertip at rest, ready to be pressed: of the law `L`, solved with `S` Gauss points an element.
#[derive(Clone, Debug)]
pub struct Press<L = Law, const S: usize = STAGES> {
    solver: Adaptive<Scaled<L>, S>,
    scale: UnitScale,
    compliance: f64,
    rest: Graded<S>,
    rest_shape: PressShape,
    branch: Branch,
    predictor: Predictor<S>,
    limit: Option<Result<Limit, MembraneError>>,
}

impl Press {
    /// Inflates a design to its rest state, on the mesh of the full model.
    ///
    /// # Errors
    /// [`MembraneError::NoRestState`] and [`MembraneError::RestUnsolved`].
    pub fn new(design: &Design, tension_field: TensionField) -> Result<Self, MembraneError> {
        Self::with_resolution(design, tension_field, FULL)
    }
}

impl<const S: usize> Press<Law, S> {
    /// Inflates a design to its rest state, on a mesh of a given resolution.
    ///
    /// # Errors
    /// [`MembraneError::NoRestState`] and [`MembraneError::RestUnsolved`].
    pub fn with_resolution(
        design: &Design,
        tension_field: TensionField,
        resolution: Resolution,
    ) -> Result<Self, MembraneError> {
        let Design {
            membrane,
            law,
            rest,
            compliance,
            object,
        } = design;
        Self::inflate(membrane, *law, *rest, *compliance, tension_field, resolution)?.touching(object)
    }
}

impl<L: Hyperelastic, const S: usize> Press<L, S> {
    /// Inflates a membrane of any law to its rest state; `compliance` in cubic metres per pascal.
    ///
    /// The press passes through the caller's stack: where that is small, inflate it in a [`Workspace`].
    ///
    /// # Errors
    /// [`MembraneError::NoRestState`] and [`MembraneError::RestUnsolved`].
    pub fn inflate(
        dimensions: &Dimensions,
        law: L,
        rest: RestBy,
        compliance: f64,
        tension_field: TensionField,
        resolution: Resolution,
    ) -> Result<Self, MembraneError> {
        let mut workspace = Workspace::new(law);
        workspace.inflate(dimensions, rest, compliance, tension_field, resolution)?;
        Ok(workspace.into_press())
    }

    /// The same fingertip, not yet pressed, with an object in the plate's place. The indentation is then the travel of the object's
    /// apex from first touch.
    ///
    /// # Errors
    /// [`MembraneError::NotAxisymmetric`] for a cylinder, [`MembraneError::ObjectNotForMembrane`] for anything else but a frictionless plate, ball or cup, and [`MembraneError::CupTooTight`] for a
    /// cup that would touch beside the pole first.
    pub fn touching(mut self, object: &Object) -> Result<Self, MembraneError> {
        let length = self.scale.length;
        let curvature = match object.shape {
            ObjectShape::Plate => 0.0,
            ObjectShape::Ball { radius } => length / radius,
            ObjectShape::Cup { radius } => -length / radius,
            ObjectShape::Cylinder { .. } => return Err(MembraneError::NotAxisymmetric),
            ObjectShape::Punch { .. } => return Err(MembraneError::ObjectNotForMembrane),
        };
        if object.friction != Friction::NONE {
            return Err(MembraneError::ObjectNotForMembrane);
        }
        let crown = self.crown_radius();
        if curvature * crown <= -1.0 {
            return Err(MembraneError::CupTooTight {
                radius: -length / curvature,
                least: crown * length,
            });
        }
        self.solver.equilibrium.membrane.curvature = curvature;
        self.predictor.clear();
        self.limit = None;
        Ok(self)
    }

    /// Radius of curvature of the pole at rest: `2 T / P`.
    fn crown_radius(&self) -> f64 {
        let rest = &self.rest.solution;
        let [stretch, tension] = rest.nodes[0];
        2.0 * tension / (stretch * rest.parameters[PRESSURE])
    }

    /// The rest state.
    pub fn rest(&self) -> &PressShape {
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
    /// [`MembraneError::NotAnIndentation`], [`MembraneError::BeyondLimit`], [`MembraneError::PressUnsolved`].
    pub fn at_indentation(&mut self, indentation: f64) -> Result<PressedState, MembraneError> {
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
            contact_radius: self.contact_radius(solution) * self.scale.length,
            contact_parameter: solution.parameters[CONTACT_PARAMETER],
            shape: state::shape(&self.solver.equilibrium, &self.scale, solution),
        })
    }

    /// Pressure rise and force alone, at an indentation in metres, 0 ..= limit: without the sums and searches over
    /// the meridian that the full state takes.
    ///
    /// # Errors
    /// As [`Press::at_indentation`].
    pub fn contact_at(&mut self, indentation: f64) -> Result<Contact, MembraneError> {
        if !(indentation >= 0.0 && indentation.is_finite()) {
            return Err(MembraneError::NotAnIndentation { asked: indentation });
        }
        if indentation == 0.0 {
            return Ok(Contact::default());
        }
        let reached = if self.has_ended(indentation / self.scale.length) {
            Err(Stop::BeyondLimit)
        } else {
            self.reach(indentation / self.scale.length)
        };
        if let Err(stop) = reached {
            return Err(match stop {
                Stop::BeyondLimit => MembraneError::BeyondLimit {
                    asked: indentation,
                    limit: self.limit()?,
                },
                Stop::Failed { reached, failure } => match self.softened_before(indentation) {
                    Some(limit) => MembraneError::BeyondLimit {
                        asked: indentation,
                        limit,
                    },
                    None => MembraneError::PressUnsolved {
                        asked: indentation,
                        reached: reached * self.scale.length,
                        failure,
                    },
                },
            });
        }
        Ok(self.contact(indentation, self.latest()))
    }

    /// The same of a design with another compliance, cubic metres per pascal, from the state of its own; `None` where Newton's method does
    /// not come to it from there.
    ///
    /// # Errors
    /// As [`Press::at_indentation`].
    pub fn contact_with_compliance(
        &mut self,
        indentation: f64,
        compliance: f64,
    ) -> Result<Option<Contact>, MembraneError> {
        let own = self.contact_at(indentation)?;
        if indentation == 0.0 {
            return Ok(Some(own));
        }
        let control = PressControl::Height(self.latest().solution.height);
        let design = core::mem::replace(
            &mut self.compliance,
            compliance * self.scale.pressure / self.scale.volume(),
        );
        let closure = self.closure(control);
        self.compliance = design;
        let mut state = self.latest().clone();
        let found = self.solver.settle(&mut state, &closure);
        Ok(found.is_ok().then(|| self.contact(indentation, &state)))
    }

    fn contact(&self, indentation: f64, state: &Graded<S>) -> Contact {
        let parameters = &state.solution.parameters;
        let radius = parameters[CONTACT_RADIUS] * self.scale.length;
        let rise = parameters[PRESSURE] - self.rest.solution.parameters[PRESSURE];
        Contact {
            indentation,
            pressure_rise: rise * self.scale.pressure,
            force: parameters[PRESSURE] * self.scale.pressure * PI * radius * radius,
        }
    }

    /// Deformed radius of the contact's edge.
    fn contact_radius(&self, solution: &Solution<S>) -> f64 {
        let [_, _, force_radius, contact_parameter] = solution.parameters;
        if self.solver.equilibrium.membrane.curvature == 0.0 {
            force_radius
        } else {
            solution.nodes[solution.contact_elements][0] * libm::sin(contact_parameter)
        }
    }

    /// Hoop stretch of the clamped edge: its radius over `a0`.
    fn edge(&self) -> f64 {
        self.rest.solution.nodes[self.rest.solution.elements()][0]
    }

    fn latest(&self) -> &Graded<S> {
        self.predictor.latest().unwrap_or(&self.rest)
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
    ) -> Result<impl Iterator<Item = MeridianPoint>, MembraneError> {
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
