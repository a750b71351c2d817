//! The feedback actuator as a solid: a flat disc clamped at its rim, with the fluid's pressure under it.
//!
//! Its force acts on the far side, see [`FarSide`]: nothing, a rigid plate at a gap, or a foundation whose pressure is proportional
//! to its deflection (Winkler), per undeformed area. The clamp holds the rim over the whole thickness; its frame is flush with the
//! disc's outer face.
//!
//! The path goes by pressure from zero. At a held pressure above its maximum pressure, the disc has no state.

mod error;
mod in_time;
mod path;

pub use error::{DiscEnd, DiscError, DiscLimit};
pub use in_time::DiscInTime;
pub(super) use in_time::StepWork;

use super::equilibrium::SolidWall;
use super::mesh::{Elements, Mesh};
use super::object::Surface;
use super::section::{self, WallPoint};
use super::state::{Balance, State};
use crate::material::{Hyperelastic as _, Law};
use crate::object::Friction;
use core::f64::consts::PI;
use core::fmt;
use path::{Kept, Path, Stop};

/// Elements of a disc: deflection and volume to 0.3 % of a refined mesh where the thickness is 0.2 of the radius, 1.5 % at 0.45.
pub const DISC: Elements = Elements {
    through: 2,
    along: 32,
};
/// Contact pressure of a rigid plate over penetration, in moduli over thicknesses. So stiff that the clamp takes less than 1 % of the force of
/// a disc that lies on the plate all over; a dome's contact, which has no clamp beside it, takes less.
const RIGID: f64 = 2e4;
/// Largest unbalanced force, in moduli times square radii: about ten times the rounding error.
const TOLERANCE: f64 = 2e-13;
/// Height of a plate that nothing reaches.
const NO_PLATE: f64 = 1e6;

/// The body over a disc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FarSide {
    /// Nothing.
    Free,
    /// A rigid plate.
    Plate {
        /// Its distance from the undeformed face, metres, >= 0.
        gap: f64,
    },
    /// A soft foundation, such as skin.
    Foundation {
        /// Its distance from the undeformed face, metres, >= 0.
        gap: f64,
        /// Its pressure over the depth to which it is pushed in, pascals per metre, > 0.
        stiffness: f64,
    },
}

impl fmt::Display for FarSide {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Free => f.write_str("nothing"),
            Self::Plate { gap } => write!(f, "a plate at {:?} mm", gap * 1e3),
            Self::Foundation { gap, stiffness } => {
                write!(
                    f,
                    "a foundation of {:?} kPa/mm at {:?} mm",
                    stiffness * 1e-6,
                    gap * 1e3
                )
            }
        }
    }
}

/// A disc, in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiscDesign {
    /// Free diameter, metres, > 0.
    pub diameter: f64,
    /// Undeformed thickness, metres, > 0 and less than the diameter.
    pub thickness: f64,
    /// Its law.
    pub law: Law,
    /// The body over it.
    pub far_side: FarSide,
    /// Friction of the body over it.
    pub friction: Friction,
}

/// A disc at a pressure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiscState {
    /// Gauge pressure of the fluid, pascals.
    pub pressure: f64,
    /// Force on the body over the disc, newtons.
    pub force: f64,
    /// Radius of the contact's outer edge, deformed, metres.
    pub contact_radius: f64,
    /// Volume of fluid that the disc has taken, cubic metres.
    pub volume: f64,
    /// Derivative of this volume by the pressure, cubic metres per pascal.
    pub compliance: f64,
    /// Displacement of the outer face at the centre, metres.
    pub travel: f64,
    /// Stretch of the middle of the disc at the centre, dimensionless.
    pub centre_stretch: f64,
    /// Strain energy of the disc, and energy in the contact or the foundation, joules.
    pub energy: f64,
    /// Work of the fluid along the path from the undeformed state, less the work of friction, joules. It equals `energy`.
    pub work: f64,
}

impl DiscState {
    /// Area of the contact, square metres.
    pub fn contact_area(&self) -> f64 {
        PI * self.contact_radius * self.contact_radius
    }
}

/// A state as it was solved.
struct Found<'a> {
    state: &'a State,
    balance: &'a Balance,
    compliance: f64,
    energy: f64,
    work: f64,
}

impl Found<'_> {
    /// In SI units, of a disc of this radius and shear modulus with what is over it at a height.
    fn in_units(&self, wall: &SolidWall, plate: f64, length: f64, modulus: f64) -> DiscState {
        let unit = length * length * length;
        let outer = wall.mesh.layers() - 1;
        DiscState {
            pressure: self.state.fluid * modulus,
            force: self.balance.force * modulus * length * length,
            contact_radius: section::contact_edge(wall, self.state, plate).radius * length,
            volume: self.balance.volume * unit,
            compliance: self.compliance * unit / modulus,
            travel: (self.state.nodes[outer][1] - wall.mesh.thickness) * length,
            centre_stretch: section::pole_stretch(wall, self.state),
            energy: self.energy * modulus * unit,
            work: self.work * modulus * unit,
        }
    }
}

/// A disc in its clamp, undeformed. Lengths in its radius, stresses in its shear modulus.
struct Clamped {
    wall: SolidWall,
    /// Height of the body over it.
    plate: f64,
    /// Its radius, metres.
    length: f64,
    /// Its shear modulus, pascals.
    modulus: f64,
}

impl Clamped {
    fn new(design: &DiscDesign, elements: Elements) -> Result<Self, DiscError> {
        let modulus = design.law.shear_modulus();
        if modulus.is_nan() || modulus <= 0.0 {
            return Err(DiscError::NoStiffness {
                shear_modulus: modulus,
            });
        }
        let length = 0.5 * design.diameter;
        let thickness = design.thickness / length;
        let is_disc = design.thickness > 0.0 && design.thickness < design.diameter && length.is_finite();
        let (plate, stiffness) = match design.far_side {
            FarSide::Free => (NO_PLATE, RIGID / thickness),
            FarSide::Plate { gap } => (thickness + gap / length, RIGID / thickness),
            FarSide::Foundation { gap, stiffness } => {
                (thickness + gap / length, stiffness * length / modulus)
            }
        };
        if !(is_disc && plate >= thickness && stiffness > 0.0 && stiffness.is_finite()) {
            return Err(DiscError::NotADisc { design: *design });
        }
        let mut wall = SolidWall::of(
            Mesh::disc(thickness, elements),
            design.law.stiffened(1.0 / modulus),
        );
        let on_foundation = matches!(design.far_side, FarSide::Foundation { .. });
        wall.resist(stiffness, on_foundation, TOLERANCE / thickness);
        wall.touch(Surface::Plate, design.friction);
        Ok(Self {
            wall,
            plate,
            length,
            modulus,
        })
    }
}

/// A clamped disc, and the states found so far.
#[derive(Clone, Debug)]
pub struct Disc {
    wall: SolidWall,
    /// Its radius, metres.
    length: f64,
    /// Its shear modulus, pascals.
    modulus: f64,
    path: Path,
}

impl Disc {
    /// The undeformed disc.
    ///
    /// # Errors
    /// [`DiscError::NoStiffness`], [`DiscError::NotADisc`] for lengths or a stiffness out of their ranges.
    pub fn new(design: &DiscDesign, elements: Elements) -> Result<Self, DiscError> {
        let Clamped {
            mut wall,
            plate,
            length,
            modulus,
        } = Clamped::new(design, elements)?;
        let path = Path::new(&mut wall, plate).ok_or(DiscError::Unsolved {
            asked: 0.0,
            failure: super::Failure::Singular,
        })?;
        Ok(Self {
            wall,
            length,
            modulus,
            path,
        })
    }

    /// The disc at a gauge pressure in pascals, 0 ..= limit.
    ///
    /// # Errors
    /// [`DiscError::NotAPressure`], [`DiscError::BeyondLimit`], [`DiscError::Unsolved`].
    pub fn at_pressure(&mut self, pressure: f64) -> Result<DiscState, DiscError> {
        let kept = self.solve(pressure)?;
        let found = Found {
            state: &kept.state,
            balance: &kept.balance,
            compliance: kept.compliance,
            energy: kept.energy,
            work: kept.work,
        };
        Ok(DiscState {
            pressure,
            ..found.in_units(&self.wall, self.path.plate(), self.length, self.modulus)
        })
    }

    /// Volume of the wall within the clamp, cubic metres.
    pub fn wall_volume(&self) -> f64 {
        PI * self.wall.mesh.thickness * self.length * self.length * self.length
    }

    fn solve(&mut self, pressure: f64) -> Result<Kept, DiscError> {
        if !(pressure >= 0.0 && pressure.is_finite()) {
            return Err(DiscError::NotAPressure { asked: pressure });
        }
        match self.path.at(&mut self.wall, pressure / self.modulus) {
            Ok(kept) => Ok(kept),
            Err(Stop::Ends(last, ends_by)) => Err(DiscError::BeyondLimit {
                asked: pressure,
                limit: DiscLimit {
                    pressure: last * self.modulus,
                    ends_by,
                },
            }),
            Err(Stop::Failed(failure)) => Err(DiscError::Unsolved {
                asked: pressure,
                failure,
            }),
        }
    }

    /// The largest pressure of the disc, pascals, and why there is no state above it. `None` if it is above `highest`.
    pub fn limit(&mut self, highest: f64) -> Option<DiscLimit> {
        let (pressure, ends_by) = self.path.end(&mut self.wall, highest / self.modulus)?;
        Some(DiscLimit {
            pressure: pressure * self.modulus,
            ends_by,
        })
    }

    /// The meridian at a pressure in pascals, 0 ..= limit: the middle of the disc from the centre to the rim, at `points` equally spaced undeformed
    /// radii, at least 3. Heights are over the undeformed inner face.
    ///
    /// # Errors
    /// As [`Disc::at_pressure`].
    pub fn profile(&mut self, pressure: f64, points: usize) -> Result<Vec<WallPoint>, DiscError> {
        let kept = self.solve(pressure)?;
        let contact = section::contact_edge(&self.wall, &kept.state, self.path.plate()).parameter;
        let intervals = points.max(3) - 1;
        Ok((0..=intervals)
            .map(|i| {
                let share = i as f64 / intervals as f64;
                section::station(&self.wall, &kept.state, share, contact).in_units(self.length, self.modulus)
            })
            .collect())
    }
}
