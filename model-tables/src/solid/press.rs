//! Pressing a solid fingertip: its rest state, states at asked indentations, the end of the press.

use super::equilibrium::{Balance, Fluid, State, Wall};
use super::inflation;
use super::mesh::Elements;
use super::section::{self, Station};
use super::trail::Trail;
use crate::curve::{Contact, Curve, CurveFailure};
use crate::design::{Design, RestBy};
use crate::limit::{EndsBy, Limit};
use crate::material::{Hyperelastic as _, Law};
use crate::solid::{Failure, SolidError};
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

/// Largest step between indentations on the way, over the height.
const LARGEST_STEP: f64 = 0.035;
/// Step under which the way gives up, over the height.
const SMALLEST_STEP: f64 = 1e-5;
/// Accuracy of the end of the press, over the height.
const LIMIT_TOLERANCE: f64 = 1e-7;

/// States of a curve.
const CURVE_STATES: usize = 96;
/// Deepest over shallowest indentation of a curve.
const CURVE_RANGE: f64 = 500.0;

/// A solid fingertip at rest, ready to be pressed.
#[derive(Clone, Debug)]
pub struct Press {
    wall: Wall,
    /// Outer radial semi-axis, metres.
    length: f64,
    /// Shear modulus, pascals.
    modulus: f64,
    /// The fluid's equation when pressed.
    fluid: Fluid,
    /// Height of the outer pole at rest.
    height: f64,
    /// States found so far, the rest state first.
    trail: Trail,
    /// The state in work.
    work: State,
    rest: Rest,
    limit: Option<Limit>,
}

/// What a state of rest has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest {
    /// Gauge pressure of the fluid, pascals.
    pub pressure: f64,
    /// Stretch of the middle of the wall at the pole.
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
    /// The same edge in the meridian's parameter.
    pub contact_parameter: f64,
    /// Volume of the fluid, cubic metres.
    pub volume: f64,
    /// Strain energy of the wall and of the contact, joules.
    pub energy: f64,
    /// Stretch of the middle of the wall at the pole.
    pub pole_stretch: f64,
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
    /// [`SolidError::PressureOutOfReach`], [`SolidError::RestUnsolved`], [`SolidError::RestNotForSolid`] for a rest state
    /// given by the equator or the height, and those of `free`.
    pub fn inflate<E: From<SolidError>>(
        design: &Design,
        elements: Elements,
        free: impl FnMut(f64) -> Result<inflation::FreeRest, E>,
    ) -> Result<Self, E> {
        let length = design.membrane.radial_semi_axis;
        let modulus = design.law.shear_modulus();
        let law = scaled(&design.law, 1.0 / modulus);
        let mut wall = Wall::new(
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
        let volume = wall.volume(&state);
        let unit = length * length * length;
        let height = state.nodes[wall.mesh.layers() - 1][1];
        let rest = Rest {
            pressure: state.fluid * modulus,
            pole_stretch: section::pole_stretch(&wall, &state),
            edge_radius: state.nodes[wall.mesh.node(wall.mesh.stations() - 1, wall.mesh.layers() - 1)][0]
                * length,
            height: height * length,
            volume: volume * unit,
            energy: wall.energy(&state) * modulus * unit,
        };
        Ok(Self {
            fluid: Fluid {
                by_volume: 1.0,
                volume,
                by_pressure: design.compliance * modulus / unit,
                pressure: state.fluid,
            },
            trail: Trail::new(state.clone(), volume),
            work: state,
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

    /// The pressed state at an indentation in metres, 0 ..= limit.
    ///
    /// # Errors
    /// [`SolidError::NotAnIndentation`], [`SolidError::BeyondLimit`], [`SolidError::PressUnsolved`].
    pub fn at_indentation(&mut self, indentation: f64) -> Result<PressedState, SolidError> {
        let contact = self.contact_at(indentation)?;
        let (length, modulus) = (self.length, self.modulus);
        let unit = length * length * length;
        let kept = self.trail.nearest(indentation / length);
        let plate = self.height - indentation / length;
        let edge = section::contact_edge(&self.wall, &kept.state, plate);
        Ok(PressedState {
            indentation,
            pressure: kept.state.fluid * modulus,
            pressure_rise: contact.pressure_rise,
            force: contact.force,
            contact_radius: edge.radius * length,
            contact_parameter: edge.parameter,
            volume: kept.balance.volume * unit,
            energy: (self.wall.energy(&kept.state) + kept.balance.contact_energy) * modulus * unit,
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
        if let Err(stop) = self.reach(indentation / self.length) {
            return Err(match stop {
                Stop::BeyondLimit(_) => SolidError::BeyondLimit {
                    asked: indentation,
                    limit: self.limit()?,
                },
                Stop::Failed { reached, failure } => SolidError::PressUnsolved {
                    asked: indentation,
                    reached: reached * self.length,
                    failure,
                },
            });
        }
        let kept = self.trail.nearest(indentation / self.length);
        Ok(Contact {
            indentation,
            pressure_rise: (kept.state.fluid - self.fluid.pressure) * self.modulus,
            force: kept.balance.force * self.modulus * self.length * self.length,
        })
    }

    /// The largest `I1` in the wall at an indentation in metres, 0 ..= limit, outside the crease at the rim.
    ///
    /// # Errors
    /// As [`Press::at_indentation`].
    pub fn largest_invariant(&mut self, indentation: f64) -> Result<f64, SolidError> {
        self.contact_at(indentation)?;
        let kept = self.trail.nearest(indentation / self.length);
        Ok(self.wall.largest_invariant(&kept.state))
    }

    /// The end of the press.
    ///
    /// # Errors
    /// [`SolidError::PressUnsolved`] if the way there fails.
    pub fn limit(&mut self) -> Result<Limit, SolidError> {
        if let Some(limit) = self.limit {
            return Ok(limit);
        }
        let mut low = self.trail.deepest();
        let mut step = LARGEST_STEP * self.height;
        let mut ends_by = None;
        // Up to the end, then closing in on it.
        while ends_by.is_none() || step > LIMIT_TOLERANCE * self.height {
            match self.reach(low + step) {
                Ok(()) => low += step,
                Err(Stop::BeyondLimit(reason)) => ends_by = Some(reason),
                Err(Stop::Failed { reached, failure }) => {
                    return Err(SolidError::PressUnsolved {
                        asked: (low + step) * self.length,
                        reached: reached * self.length,
                        failure,
                    });
                }
            }
            if ends_by.is_some() {
                step *= 0.5;
            }
        }
        let kept = self.trail.nearest(low);
        let limit = Limit {
            indentation: low * self.length,
            pressure: kept.state.fluid * self.modulus,
            force: kept.balance.force * self.modulus * self.length * self.length,
            ends_by: ends_by.unwrap_or(EndsBy::BulgeTouchesBase),
        };
        self.limit = Some(limit);
        Ok(limit)
    }

    /// The meridian of the state at an indentation in metres (0 is the rest state): the middle of the wall from the pole to
    /// the rim, at `points` equally spaced parameters, at least 3.
    ///
    /// # Errors
    /// As [`Press::at_indentation`].
    pub fn profile(&mut self, indentation: f64, points: usize) -> Result<Vec<Station>, SolidError> {
        let state = self.at_indentation(indentation)?;
        let kept = self.trail.nearest(indentation / self.length);
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
        let mut points = Vec::with_capacity(CURVE_STATES + 1);
        for k in 0..=CURVE_STATES {
            let ratio = k as f64 / CURVE_STATES as f64;
            let indentation = deepest * libm::pow(CURVE_RANGE, ratio - 1.0);
            points.push(self.contact_at(indentation).map_err(CurveFailure::Model)?);
        }
        Curve::new(points).map_err(CurveFailure::Shape)
    }

    /// Solves the state at a dimensionless indentation, over as many states in between as it takes.
    fn reach(&mut self, indentation: f64) -> Result<(), Stop> {
        let mut largest_step = LARGEST_STEP * self.height;
        loop {
            let at = self.trail.nearest(indentation).indentation;
            if at.to_bits() == indentation.to_bits() {
                return Ok(());
            }
            if indentation >= self.height {
                return Err(Stop::BeyondLimit(EndsBy::WallTouchesBase));
            }
            let next = indentation.clamp(at - largest_step, at + largest_step);
            self.trail.predict(next, &mut self.work);
            let mut result = self.attempt(next);
            if result.is_err() {
                self.work.copy_from(&self.trail.nearest(next).state);
                result = self.attempt(next);
            }
            match result {
                Ok(balance) => {
                    if let Some(reason) = section::touches_base(&self.wall, &self.work) {
                        return Err(Stop::BeyondLimit(reason));
                    }
                    self.trail.keep(next, &self.work, balance);
                    largest_step = (1.5 * largest_step).min(LARGEST_STEP * self.height);
                }
                Err(failure) => {
                    largest_step = 0.5 * (next - at).abs();
                    if largest_step < SMALLEST_STEP * self.height {
                        let softened = self.wall.softens(&self.trail.nearest(at).state);
                        return Err(Stop::Failed {
                            reached: at,
                            failure: if softened { Failure::Softened } else { failure },
                        });
                    }
                }
            }
        }
    }

    /// Solves from the state in work.
    fn attempt(&mut self, indentation: f64) -> Result<Balance, Failure> {
        self.wall
            .settle(&mut self.work, self.height - indentation, &self.fluid)
    }
}

/// Why a state was not reached.
#[derive(Clone, Copy, Debug)]
enum Stop {
    BeyondLimit(EndsBy),
    Failed { reached: f64, failure: Failure },
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
