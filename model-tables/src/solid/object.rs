//! The object that touches the outer surface: a rigid body of revolution on the axis. `friction` is separate.
//!
//! The penalty is that of the [`plate`], with the penetration along the object's normal in place of the height. Along an edge of an
//! element, the penetration is the parabola through those of its three nodes. This is accurate because an edge is short compared
//! with every radius of curvature; at a punch's rim it is divided into parts. The force is therefore as smooth as on a plate.
//!
//! Lengths are in outer radial semi-axes; heights of the wall are taken over the object's apex.

use super::mesh::shape;
use super::plate;
use crate::object::Shape;
use core::f64::consts::FRAC_PI_2;

/// Parts of an edge on a punch, whose curvature jumps.
const PUNCH_PARTS: usize = 4;

/// The surface of an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Surface {
    /// Flat.
    Plate,
    /// A ball of this radius.
    Ball(f64),
    /// A hollow of this radius.
    Cup(f64),
    /// Flat up to a radius, then a quarter of a circle of radius `rim`, then straight up.
    Punch {
        /// Radius of the flat part.
        flat: f64,
        /// Radius of the rounded rim.
        rim: f64,
    },
}

/// A quantity of a point - its penetration, or its place along the object's meridian - with derivatives by radius and height.
#[derive(Clone, Copy, Debug)]
pub(super) struct Local {
    pub(super) value: f64,
    first: [f64; 2],
    /// By radius twice, by both, by height twice.
    second: [f64; 3],
}

/// An object's action on one outer edge, with derivatives by its three radii, then its three heights.
#[derive(Clone, Copy, Debug, Default)]
pub struct Action {
    /// Energy in the contact, dimensionless.
    pub energy: f64,
    /// Axial force on the object, dimensionless.
    pub force: f64,
    /// First derivatives of the dimensionless energy.
    pub first: [f64; 6],
    /// Second derivatives of the energy.
    pub second: [[f64; 6]; 6],
}

/// Penetration into a circle that is centred at `centre` and passes through the origin below or above it: `sign` is 1 inside a
/// ball, -1 outside a hollow. Without cancellation where the radius is large.
fn circle(sign: f64, [r, z]: [f64; 2], [centre_r, centre_z]: [f64; 2], radius: f64) -> Local {
    let (x, y) = (r - centre_r, z - centre_z);
    let distance = libm::hypot(x, y);
    // radius^2 - distance^2, with y = z - centre_z and |centre_z| the radius.
    let squares = z * (2.0 * centre_z - z) - x * x;
    let (n, m) = (x / distance, y / distance);
    Local {
        value: sign * squares / (radius + distance),
        first: [-sign * n, -sign * m],
        second: [m * m, -n * m, n * n].map(|part| -sign * part / distance),
    }
}

/// `start + radius atan(x / y)`: `y` falls with the height (`sign` 1) or grows with it (-1).
fn angle(sign: f64, x: f64, y: f64, radius: f64, start: f64) -> Local {
    let squared = x * x + y * y;
    let over = radius / squared;
    let twice = 2.0 * over / squared;
    Local {
        value: start + radius * libm::atan2(x, y),
        first: [over * y, sign * over * x],
        second: [
            -twice * x * y,
            sign * 0.5 * twice * (y * y - x * x),
            twice * x * y,
        ],
    }
}

impl Surface {
    /// The surface of a shape, in units of `length`, metres. `None` for a shape without axial symmetry.
    pub fn new(shape: Shape, length: f64) -> Option<Self> {
        Some(match shape {
            Shape::Plate => Self::Plate,
            Shape::Ball { radius } => Self::Ball(radius / length),
            Shape::Cup { radius } => Self::Cup(radius / length),
            Shape::Punch { radius, rim } => Self::Punch {
                flat: (radius - rim) / length,
                rim: rim / length,
            },
            Shape::Cylinder { .. } => return None,
        })
    }

    fn penetration(&self, at: [f64; 2]) -> Local {
        let flat = |along: usize, value: f64, sign: f64| Local {
            value,
            first: if along == 0 { [sign, 0.0] } else { [0.0, sign] },
            second: [0.0; 3],
        };
        match *self {
            Self::Plate => flat(1, at[1], 1.0),
            Self::Ball(radius) => circle(1.0, at, [0.0, radius], radius),
            Self::Cup(radius) => circle(-1.0, at, [0.0, -radius], radius),
            Self::Punch { flat: edge, rim } => {
                if at[0] <= edge {
                    flat(1, at[1], 1.0)
                } else if at[1] >= rim {
                    flat(0, edge + rim - at[0], -1.0)
                } else {
                    circle(1.0, at, [edge, rim], rim)
                }
            }
        }
    }

    /// Where a point is along the object's meridian, from the apex on.
    pub(super) fn arc(&self, [r, z]: [f64; 2]) -> Local {
        let straight = |value: f64, first: [f64; 2]| Local {
            value,
            first,
            second: [0.0; 3],
        };
        match *self {
            Self::Plate => straight(r, [1.0, 0.0]),
            Self::Ball(radius) => angle(1.0, r, radius - z, radius, 0.0),
            Self::Cup(radius) => angle(-1.0, r, radius + z, radius, 0.0),
            Self::Punch { flat, rim } => {
                if r <= flat {
                    straight(r, [1.0, 0.0])
                } else if z >= rim {
                    straight(flat + rim * FRAC_PI_2 + z - rim, [0.0, 1.0])
                } else {
                    angle(1.0, r - flat, rim - z, rim, flat)
                }
            }
        }
    }

    /// How deep a point is in the object, at a radius and a height over its apex; negative outside.
    pub fn depth(&self, radius: f64, height: f64) -> f64 {
        self.penetration([radius, height]).value
    }

    /// Whether an edge with these radii and heights over the apex is more than `distance` away.
    fn is_away(&self, r: &[f64; 3], z: &[f64; 3], distance: f64) -> bool {
        match self {
            Self::Plate | Self::Ball(_) | Self::Punch { .. } => z.iter().all(|z| *z < -distance),
            Self::Cup(_) => (0..3).all(|i| self.depth(r[i], z[i]) < -distance),
        }
    }

    /// The action of the object, its apex at a height, on an edge whose nodes are at these radii and heights and were at
    /// `undeformed` ones; the contact pressure is `stiffness` times the penetration. `None` where the edge is further away than
    /// `distance`.
    pub fn action(
        &self,
        stiffness: f64,
        undeformed: &[[f64; 3]; 2],
        [r, z]: &[[f64; 3]; 2],
        apex: f64,
        distance: f64,
    ) -> Option<Action> {
        if *self == Self::Plate {
            return z
                .iter()
                .any(|z| *z >= apex - distance)
                .then(|| of_plate(&plate::action(stiffness, undeformed, z, apex)));
        }
        let z = z.map(|z| z - apex);
        (!self.is_away(r, &z, distance)).then(|| self.curved(stiffness, undeformed, &[*r, z]))
    }

    fn curved(&self, stiffness: f64, undeformed: &[[f64; 3]; 2], place: &[[f64; 3]; 2]) -> Action {
        let mut action = Action::default();
        let parts = match self {
            Self::Punch { .. } => PUNCH_PARTS,
            Self::Plate | Self::Ball(_) | Self::Cup(_) => 1,
        };
        for part in 0..parts {
            let width = 2.0 / parts as f64;
            let start = -1.0 + width * part as f64;
            let shapes = [0.0, 0.5, 1.0].map(|share| shape(start + share * width));
            let points = shapes.map(|n| self.penetration(at(&n, place)));
            let undeformed = [0, 1].map(|c| shapes.map(|n| at(&n, undeformed)[c]));
            let of_part = plate::action(stiffness, &undeformed, &points.map(|point| point.value), 0.0);
            action.energy += of_part.energy;
            // How each penetration goes with radii and heights.
            let by: [[f64; 6]; 3] =
                core::array::from_fn(|k| core::array::from_fn(|i| points[k].first[i / 3] * shapes[k][i % 3]));
            for k in 0..3 {
                // The slope of the traction is there once for each pair of places.
                action.add(1.0, &shapes[k], &points[k], of_part.first[k], 0.0);
                for l in 0..3 {
                    for i in 0..6 {
                        for j in 0..6 {
                            action.second[i][j] += of_part.second[k][l] * by[k][i] * by[l][j];
                        }
                    }
                }
            }
        }
        action
    }
}

/// Radius and height where the shape functions have these values, or their derivatives.
pub(super) fn at(n: &[f64; 3], place: &[[f64; 3]; 2]) -> [f64; 2] {
    place.map(|y| n[0] * y[0] + n[1] * y[1] + n[2] * y[2])
}

impl Action {
    /// Adds that of a point with a weight, where the shape functions have the values `n`: of a traction against a local quantity, and
    /// its derivative by that.
    pub(super) fn add(&mut self, weight: f64, n: &[f64; 3], local: &Local, traction: f64, slope: f64) {
        let Local { first, second, .. } = local;
        self.force += weight * traction * first[1];
        let by = |c: usize, d: usize| weight * (slope * first[c] * first[d] + traction * second[c + d]);
        let by = [[by(0, 0), by(0, 1)], [by(1, 0), by(1, 1)]];
        for i in 0..6 {
            self.first[i] += weight * traction * first[i / 3] * n[i % 3];
            for j in 0..6 {
                self.second[i][j] += by[i / 3][j / 3] * n[i % 3] * n[j % 3];
            }
        }
    }
}

/// A plate acts on heights alone.
fn of_plate(plate: &plate::PlateAction) -> Action {
    let mut action = Action {
        energy: plate.energy,
        force: plate.force,
        ..Action::default()
    };
    action.first[3..].copy_from_slice(&plate.first);
    for (row, of_plate) in action.second[3..].iter_mut().zip(&plate.second) {
        row[3..].copy_from_slice(of_plate);
    }
    action
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::PI;

    const STIFFNESS: f64 = 1e3;
    /// A flat disc of radius 0.2 at height 1.
    const DISC: [[f64; 3]; 2] = [[0.0, 0.1, 0.2], [1.0, 1.0, 1.0]];
    const SURFACES: [Surface; 4] = [
        Surface::Plate,
        Surface::Ball(0.4),
        Surface::Cup(3.0),
        Surface::Punch {
            flat: 0.107,
            rim: 0.05,
        },
    ];

    fn action(surface: Surface, place: &[[f64; 3]; 2], apex: f64) -> Action {
        surface
            .action(STIFFNESS, &DISC, place, apex, 0.1)
            .expect("an edge nearby")
    }

    /// A flat disc and a ball that dips into it by `d`: penetration along the normal `R - sqrt(r^2 + (R - d)^2)`, integrated by a fine
    /// midpoint rule.
    #[test]
    fn a_ball_is_pushed_back_over_its_cap() {
        let (radius, dip) = (40.0, 3e-4);
        let found = action(Surface::Ball(radius), &DISC, 1.0 - dip);
        let (mut force, mut energy) = (0.0, 0.0);
        let steps = 200_000;
        for i in 0..steps {
            let r = 0.2 * (f64::from(i) + 0.5) / f64::from(steps);
            let distance = r.hypot(radius - dip);
            let depth = (radius - distance).max(0.0);
            let area = 2.0 * PI * r * 0.2 / f64::from(steps);
            force += STIFFNESS * depth * area * (radius - dip) / distance;
            energy += 0.5 * STIFFNESS * depth * depth * area;
        }
        assert!(
            (found.force / force - 1.0).abs() < 1e-6,
            "{} {force}",
            found.force
        );
        assert!((found.energy / energy - 1.0).abs() < 1e-6);
    }

    /// A huge ball and a huge hollow are plates.
    #[test]
    fn a_huge_radius_is_a_plate() {
        let bent = [DISC[0], [1.0, 0.99, 0.96]];
        let plate = action(Surface::Plate, &bent, 0.99);
        for surface in [Surface::Ball(1e9), Surface::Cup(1e9)] {
            let found = action(surface, &bent, 0.99);
            assert!((found.force / plate.force - 1.0).abs() < 1e-7);
            for i in 0..6 {
                assert!((found.first[i] - plate.first[i]).abs() < 1e-7 * plate.force);
            }
        }
    }

    /// First and second derivatives, with the contact's end and a punch's rim in the edge.
    #[test]
    fn derivatives_are_those_of_the_energy() {
        for surface in SURFACES {
            for place in [
                [[0.0, 0.1, 0.2], [1.0, 0.9995, 0.998]],
                [[0.02, 0.11, 0.21], [1.003, 1.002, 1.004]],
                [[0.05, 0.12, 0.18], [1.001, 0.9975, 1.002]],
            ] {
                let of = |place: &[[f64; 3]; 2]| action(surface, place, 0.99);
                let found = of(&place);
                assert!(found.energy > 0.0, "{surface:?}");
                assert!((found.force - found.first[3..].iter().sum::<f64>()).abs() < 1e-9);
                for j in 0..6 {
                    let [below, above] = [-1e-6, 1e-6].map(|by| {
                        let mut moved = place;
                        moved[j / 3][j % 3] += by;
                        of(&moved)
                    });
                    let slope = (above.energy - below.energy) / 2e-6;
                    assert!(
                        (slope - found.first[j]).abs() < 1e-6,
                        "{surface:?} {j}: {slope} {}",
                        found.first[j]
                    );
                    for i in 0..6 {
                        let slope = (above.first[i] - below.first[i]) / 2e-6;
                        assert!(
                            (slope - found.second[i][j]).abs() < 2e-3 * found.second[3][3].abs(),
                            "{surface:?} {i} {j}: {slope} {}",
                            found.second[i][j]
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn a_surface_that_only_touches_feels_nothing() {
        for surface in SURFACES {
            let cap = [DISC[0], [1.0, 0.99, 0.96]];
            let action = action(surface, &cap, 1.0);
            assert!(action.force == 0.0 && action.energy == 0.0, "{surface:?}");
        }
    }
}
