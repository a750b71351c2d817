//! Pressing a solid fingertip: its rest state, states at asked indentations, the end of the press.

use super::branch;
use super::equilibrium::SolidWall;
use super::inflation;
use super::mesh::Elements;
use super::object::Surface;
use super::path::{LARGEST_CORRECTION, Path, Stop, corrected};
use super::section::{self, WallPoint};
use super::state::{Balance, Fluid, State};
use super::station::Kept;
use crate::curve::{Contact, Curve, CurveFailure};
use crate::design::{Design, RestBy};
use crate::limit::Limit;
use crate::material::{Hyperelastic as _, Law};
use crate::object::{Object, Shape};
use crate::solid::SolidError;
use core::f64::consts::PI;

/// One element through the wall: pressure and force to about 2 % of a refined mesh.
pub const COARSE: Elements = Elements {
    through: 1,
    along: 24,
};
/// Two elements through the wall: pressure and force to about 1 % of a refined mesh.
pub const FULL: Elements = Elements {
    through: 2,
    along: 24,
};

/// Indentation over the height below which states are scaled from the one there, see [`Kept::approach`]. The contact is far smaller than an element,
/// and its force drowns in the tolerance.
const TOUCH: f64 = 1e-5;

/// States of a curve.
const CURVE_STATES: usize = 96;
/// Deepest over shallowest indentation of a curve.
const CURVE_RANGE: f64 = 500.0;

/// A solid fingertip at rest, ready to be pressed.
#[derive(Clone, Debug)]
pub struct Press {
    wall: SolidWall,
    /// Outer radial semi-axis, metres.
    length: f64,
    /// Shear modulus, pascals.
    modulus: f64,
    /// The fluid's equation when pressed.
    fluid: Fluid,
    /// Height of the outer pole at rest.
    height: f64,
    /// The states on the way.
    path: Path,
    /// The state asked for last.
    asked: Kept,
    rest: Rest,
    limit: Option<Limit>,
}

/// What a state of rest has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest {
    /// Gauge pressure of the fluid, pascals.
    pub pressure: f64,
    /// Stretch of the middle of the wall at the pole, dimensionless.
    pub pole_stretch: f64,
    /// Outer radius of the rim, metres: it is held.
    pub edge_radius: f64,
    /// Height of the outer surface over the base, metres.
    pub height: f64,
    /// Volume of the fluid, cubic metres.
    pub volume: f64,
    /// Strain energy of the wall, joules.
    pub energy: f64,
}

/// A pressed state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PressedState {
    /// How far the plate went down from first touch, metres.
    pub indentation: f64,
    /// Gauge pressure of the fluid, pascals.
    pub pressure: f64,
    /// Pressure over that of the rest state, pascals.
    pub pressure_rise: f64,
    /// Force on the plate, newtons.
    pub force: f64,
    /// Radius of the contact's outer edge, deformed, metres.
    pub contact_radius: f64,
    /// The same edge in the meridian's parameter, radians.
    pub contact_parameter: f64,
    /// Volume of the fluid, cubic metres.
    pub volume: f64,
    /// Strain energy of the wall and of the contact, joules.
    pub energy: f64,
    /// The rest state's strain energy, and the work of plate and fluid along the path from there, joules: the same.
    pub work: f64,
    /// Stretch of the middle of the wall at the pole, dimensionless.
    pub pole_stretch: f64,
}

/// A state in balance beside that of the path from rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OtherState {
    /// Its pressure rise and force.
    pub contact: Contact,
    /// Whether a wall can stay in it: the energy is a minimum. Else it is the least to get over on the way to another.
    pub is_stable: bool,
}

impl PressedState {
    /// Area of the contact, square metres.
    pub fn contact_area(&self) -> f64 {
        PI * self.contact_radius * self.contact_radius
    }
}

impl Press {
    /// Inflates a design to its rest state. The semi-axes of `design.membrane` are those of the outer surface here. `free`
    /// gives what it inflates to with its rim free, by the pole stretch: where a rest state given by that is looked for.
    /// [`Press::new`] asks the membrane.
    ///
    /// # Errors
    /// [`SolidError::NoStiffness`], [`SolidError::PressureOutOfReach`], [`SolidError::RestUnsolved`],
    /// [`SolidError::RestNotForSolid`] for a rest state given by the equator or the height, [`SolidError::NotAxisymmetric`] and
    /// [`SolidError::CupTooTight`] for what touches, and those of `free`.
    pub fn inflate<E: From<SolidError>>(
        design: &Design,
        elements: Elements,
        free: impl FnMut(f64) -> Result<inflation::FreeRest, E>,
    ) -> Result<Self, E> {
        let length = design.membrane.radial_semi_axis;
        let modulus = design.law.shear_modulus();
        if modulus.is_nan() || modulus <= 0.0 {
            return Err(SolidError::NoStiffness {
                shear_modulus: modulus,
            }
            .into());
        }
        let law = scaled(&design.law, 1.0 / modulus);
        let mut wall = SolidWall::new(
            design.membrane.axial_semi_axis / length,
            design.membrane.thickness / length,
            law,
            elements,
        );
        let mut state = wall.undeformed();
        match design.rest {
            RestBy::Unstretched => {}
            RestBy::Pressure(pascals) => inflation::held(&mut wall, &mut state, pascals, modulus)?,
            RestBy::PoleStretch(stretch) => inflation::bonded(&mut wall, &mut state, length, stretch, free)?,
            RestBy::EquatorRadius(_) | RestBy::Height(_) => return Err(SolidError::RestNotForSolid.into()),
        }
        wall.touch(
            surface(&design.object, &wall, &state, length)?,
            design.object.friction,
        );
        let volume = wall.volume(&state);
        let unit = length * length * length;
        let energy = wall.energy(&state);
        let height = state.nodes[wall.mesh.layers() - 1][1];
        let rest = Rest {
            pressure: state.fluid * modulus,
            pole_stretch: section::pole_stretch(&wall, &state),
            edge_radius: state.nodes[wall.mesh.node(wall.mesh.stations() - 1, wall.mesh.layers() - 1)][0]
                * length,
            height: height * length,
            volume: volume * unit,
            energy: energy * modulus * unit,
        };
        let fluid = Fluid {
            by_volume: 1.0,
            volume,
            by_pressure: design.compliance * modulus / unit,
            pressure: state.fluid,
        };
        let path = Path::new(state, volume, energy, height);
        Ok(Self {
            fluid,
            asked: path.rest().clone(),
            path,
            wall,
            length,
            modulus,
            height,
            rest,
            limit: None,
        })
    }

    /// The rest state.
    pub fn rest(&self) -> &Rest {
        &self.rest
    }

    /// Its elements.
    pub fn elements(&self) -> Elements {
        self.wall.mesh.elements
    }

    /// Newton iterations spent so far.
    pub fn iterations(&self) -> u64 {
        self.wall.iterations
    }

    /// Factorisations spent so far.
    pub fn factorisations(&self) -> u64 {
        self.wall.factorisations
    }

    /// The pressed state at an indentation in metres, 0 ..= limit.
    ///
    /// # Errors
    /// [`SolidError::NotAnIndentation`], [`SolidError::BeyondLimit`], [`SolidError::PressUnsolved`].
    pub fn at_indentation(&mut self, indentation: f64) -> Result<PressedState, SolidError> {
        let contact = self.contact_at(indentation)?;
        let (length, modulus) = (self.length, self.modulus);
        let unit = length * length * length;
        let kept = &self.asked;
        Ok(PressedState {
            indentation,
            pressure: kept.state.fluid * modulus,
            pressure_rise: contact.pressure_rise,
            force: contact.force,
            contact_radius: kept.contact.radius * length,
            contact_parameter: kept.contact.parameter,
            volume: kept.balance.volume * unit,
            energy: kept.energy * modulus * unit,
            work: kept.work * modulus * unit,
            pole_stretch: section::pole_stretch(&self.wall, &kept.state),
        })
    }

    /// Pressure rise and force alone, at an indentation in metres, 0 ..= limit.
    ///
    /// # Errors
    /// As [`Press::at_indentation`].
    pub fn contact_at(&mut self, indentation: f64) -> Result<Contact, SolidError> {
        if !(indentation >= 0.0 && indentation.is_finite()) {
            return Err(SolidError::NotAnIndentation { asked: indentation });
        }
        self.solve(indentation)?;
        Ok(self.contact(indentation, self.asked.state.fluid, &self.asked.balance))
    }

    /// The same of a design with another compliance, cubic metres per pascal, from the state of its own. `None` where the one is too far from
    /// the other to be the same state with certainty, and with friction, whose states depend on their way.
    ///
    /// # Errors
    /// As [`Press::at_indentation`].
    pub fn contact_with_compliance(
        &mut self,
        indentation: f64,
        compliance: f64,
    ) -> Result<Option<Contact>, SolidError> {
        self.contact_at(indentation)?;
        if self.wall.has_friction() || indentation < TOUCH * self.height * self.length {
            return Ok(None);
        }
        let fluid = Fluid {
            by_pressure: compliance * self.modulus / (self.length * self.length * self.length),
            ..self.fluid
        };
        let own = &self.asked;
        let plate = self.height - own.indentation;
        let mut state = own.state.clone();
        self.wall.start_sliding(&own.state, plate, &own.anchors);
        let Ok(balance) = self.wall.settle(&mut state, plate, &fluid) else {
            return Ok(None);
        };
        let moved = corrected(&own.state, &state) / self.wall.mesh.thickness;
        let is_near = moved < LARGEST_CORRECTION && self.wall.is_stable(&fluid);
        Ok(is_near.then(|| self.contact(indentation, state.fluid, &balance)))
    }

    /// A state in SI units.
    fn contact(&self, indentation: f64, pressure: f64, balance: &Balance) -> Contact {
        Contact {
            indentation,
            pressure_rise: (pressure - self.fluid.pressure) * self.modulus,
            force: balance.force * self.modulus * self.length * self.length,
        }
    }

    /// Solves the state at an indentation.
    fn solve(&mut self, indentation: f64) -> Result<(), SolidError> {
        let asked = indentation / self.length;
        let touch = TOUCH * self.height;
        // At rest there is nothing to solve.
        let nearest = if asked > 0.0 { asked.max(touch) } else { asked };
        let found = self.path.at(&mut self.wall, &self.fluid, nearest);
        match found {
            Ok(kept) if asked < nearest => {
                self.asked = self.path.rest().clone();
                self.asked.approach(&kept, asked / touch);
                Ok(())
            }
            Ok(kept) => {
                self.asked = kept;
                Ok(())
            }
            Err(Stop::Ends(_)) => Err(SolidError::BeyondLimit {
                asked: indentation,
                limit: self.limit()?,
            }),
            Err(Stop::Failed { reached, failure }) => Err(SolidError::PressUnsolved {
                asked: indentation,
                reached: reached * self.length,
                failure,
            }),
        }
    }

    /// Another state in balance at an indentation in metres, 0 ..= limit, where one is found.
    ///
    /// # Errors
    /// As [`Press::at_indentation`].
    pub fn other_state(&mut self, indentation: f64) -> Result<Option<OtherState>, SolidError> {
        self.contact_at(indentation)?;
        if self.wall.has_friction() {
            // A state beside the path would have come another way.
            return Ok(None);
        }
        let rest = &self.path.rest().state;
        let plate = self.height - self.asked.indentation;
        let found = branch::beside(&mut self.wall, &self.fluid, rest, &self.asked, plate);
        Ok(found.map(|found| OtherState {
            contact: self.contact(indentation, found.state.fluid, &found.balance),
            is_stable: found.is_stable,
        }))
    }

    /// The largest `I1` in the wall at an indentation in metres, 0 ..= limit, outside the crease at the rim.
    ///
    /// # Errors
    /// As [`Press::at_indentation`].
    pub fn largest_invariant(&mut self, indentation: f64) -> Result<f64, SolidError> {
        self.contact_at(indentation)?;
        Ok(self.wall.largest_invariant(&self.asked.state))
    }

    /// The end of the press: the last state of the path from rest, and why there is none after it.
    ///
    /// # Errors
    /// None: the last state found is an end.
    pub fn limit(&mut self) -> Result<Limit, SolidError> {
        if let Some(limit) = self.limit {
            return Ok(limit);
        }
        let (kept, ends_by) = self.path.end(&mut self.wall, &self.fluid);
        let limit = Limit {
            indentation: kept.indentation * self.length,
            pressure: kept.state.fluid * self.modulus,
            force: kept.balance.force * self.modulus * self.length * self.length,
            ends_by,
        };
        self.limit = Some(limit);
        Ok(limit)
    }

    /// The meridian of the state at an indentation in metres (0 is the rest state): the middle of the wall from the pole to
    /// the rim, at `points` equally spaced parameters, at least 3.
    ///
    /// # Errors
    /// As [`Press::at_indentation`].
    pub fn profile(&mut self, indentation: f64, points: usize) -> Result<Vec<WallPoint>, SolidError> {
        let state = self.at_indentation(indentation)?;
        let kept = &self.asked;
        let intervals = points.max(3) - 1;
        Ok((0..=intervals)
            .map(|i| {
                let share = i as f64 / intervals as f64;
                section::station(&self.wall, &kept.state, share, state.contact_parameter)
                    .in_units(self.length, self.modulus)
            })
            .collect())
    }

    /// The curve of a press down to `deepest`, metres: states from a five-hundredth of it on.
    ///
    /// # Errors
    /// As [`Press::at_indentation`], and [`CurveFailure::Shape`] if pressure or force do not grow throughout.
    pub fn curve(&mut self, deepest: f64) -> Result<Curve, CurveFailure<SolidError>> {
        let points: Result<Vec<Contact>, SolidError> = curve_depths(deepest)
            .map(|indentation| self.contact_at(indentation))
            .collect();
        Curve::new(points.map_err(CurveFailure::Model)?).map_err(CurveFailure::Shape)
    }
}

/// Indentations of the states of a curve down to `deepest`, metres, increasing.
pub fn curve_depths(deepest: f64) -> impl Iterator<Item = f64> {
    (0..=CURVE_STATES).map(move |k| {
        let ratio = k as f64 / CURVE_STATES as f64;
        deepest * libm::pow(CURVE_RANGE, ratio - 1.0)
    })
}

/// The surface of an object in units of `length`, metres, that touches a wall at rest at its pole.
pub(super) fn surface(
    object: &Object,
    wall: &SolidWall,
    rest: &State,
    length: f64,
) -> Result<Surface, SolidError> {
    if let Shape::Cup { radius } = object.shape {
        let least = section::least_cup(wall, rest) * length;
        if radius < least {
            return Err(SolidError::CupTooTight { radius, least });
        }
    }
    Surface::new(object.shape, length).ok_or(SolidError::NotAxisymmetric)
}

/// A law in other units.
fn scaled(law: &Law, factor: f64) -> Law {
    match *law {
        Law::NeoHookean { c1 } => Law::NeoHookean { c1: factor * c1 },
        Law::MooneyRivlin { c1, c2 } => Law::MooneyRivlin {
            c1: factor * c1,
            c2: factor * c2,
        },
        Law::Yeoh { c1, c2, c3 } => Law::Yeoh {
            c1: factor * c1,
            c2: factor * c2,
            c3: factor * c3,
        },
    }
}
