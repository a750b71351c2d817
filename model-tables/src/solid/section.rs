//! Quantities of a state along the meridian: contact, touch of the base, stretches and section forces.

use super::element;
use super::element::positions;
use super::equilibrium::{SolidWall, edge};
use super::mesh::{CREASE, FUNCTIONS, PLACES, WEIGHTS, function, shape, slope};
use super::state::State;
use crate::limit::EndsBy;
use core::f64::consts::FRAC_PI_2;

/// Samples of an edge where a crossing is looked for.
const SAMPLES: usize = 24;

/// The outer edge of the contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactEdge {
    /// Deformed radius, over the radial semi-axis.
    pub radius: f64,
    /// Meridian's parameter, radians: 0 at the pole, pi/2 at the rim.
    pub parameter: f64,
}

/// A station of the meridian: the middle of the wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallPoint {
    /// Meridian's parameter, radians: 0 at the pole, pi/2 at the rim.
    pub parameter: f64,
    /// Deformed radius, over the radial semi-axis.
    pub radius: f64,
    /// Its height over the base.
    pub height: f64,
    /// Stretch along the meridian, dimensionless.
    pub meridional_stretch: f64,
    /// Stretch around, dimensionless.
    pub hoop_stretch: f64,
    /// Wall thickness over the undeformed one.
    pub thickness_stretch: f64,
    /// Shear: by how much the right angle between the directions along and through changes where in the wall it changes most,
    /// radians; positive where the outside runs ahead towards the rim.
    pub shear: f64,
    /// Force across the section along the meridian, per deformed length around.
    pub meridional_tension: f64,
    /// Force across the section around, per deformed length along.
    pub hoop_tension: f64,
    /// Angle of the tangent, radians: 0 is horizontal, pi/2 vertical.
    pub angle: f64,
    /// Whether the outer surface is in contact here.
    pub in_contact: bool,
}

impl WallPoint {
    /// In metres and newtons per metre, from units of length and stress.
    #[must_use]
    pub fn in_units(self, length: f64, stress: f64) -> Self {
        Self {
            radius: self.radius * length,
            height: self.height * length,
            meridional_tension: self.meridional_tension * length * stress,
            hoop_tension: self.hoop_tension * length * stress,
            ..self
        }
    }
}

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Where the outer surface leaves what touches it, whose apex is at the height `plate`.
pub fn contact_edge(wall: &SolidWall, state: &State, plate: f64) -> ContactEdge {
    let along = wall.mesh.elements.along;
    let outer = wall.mesh.layers() - 1;
    // From the rim inwards: the first place that touches.
    for column in (0..along).rev() {
        let [r, z] = edge(&wall.mesh, &state.nodes, column, outer);
        let depth = |x: f64| {
            let n = shape(x);
            wall.surface().depth(dot(&n, &r), dot(&n, &z) - plate)
        };
        let found = |x: f64| ContactEdge {
            radius: dot(&shape(x), &r),
            parameter: wall.mesh.parameter(column, x),
        };
        let place = |i: usize| -1.0 + 2.0 * i as f64 / SAMPLES as f64;
        for i in (0..SAMPLES).rev() {
            if depth(place(i)) > 0.0 {
                let (mut touching, mut free) = (place(i), place(i + 1));
                if depth(free) > 0.0 {
                    return found(free);
                }
                for _ in 0..40 {
                    let middle = 0.5 * (touching + free);
                    if depth(middle) > 0.0 {
                        touching = middle;
                    } else {
                        free = middle;
                    }
                }
                return found(touching);
            }
        }
    }
    ContactEdge::default()
}

/// The least radius of a hollow sphere that the outer surface fits in when it touches at the pole: a sphere through the pole and a point
/// at a radius `r`, lower by `s`, has the radius `(r^2 + s^2) / 2 s`.
pub fn least_cup(wall: &SolidWall, state: &State) -> f64 {
    let outer = wall.mesh.layers() - 1;
    let height = state.nodes[outer][1];
    (1..wall.mesh.stations())
        .map(|station| {
            let [r, z] = state.nodes[wall.mesh.node(station, outer)];
            let s = height - z;
            (r * r + s * s) / (2.0 * s)
        })
        .fold(0.0, f64::max)
}

/// Whether, and with which side, the wall has gone through the base plane; the crease does not count.
pub fn touches_base(wall: &SolidWall, state: &State) -> Option<EndsBy> {
    let layers = wall.mesh.layers();
    let crease = CREASE * wall.mesh.thickness;
    let below = |layer: usize| {
        (0..wall.mesh.stations()).any(|station| {
            let node = wall.mesh.node(station, layer);
            wall.mesh.nodes[node][1] > crease && state.nodes[node][1] < 0.0
        })
    };
    if below(layers - 1) {
        Some(EndsBy::BulgeTouchesBase)
    } else if below(0) {
        Some(EndsBy::WallTouchesBase)
    } else {
        None
    }
}

/// Stretch of the middle of the wall at the pole.
pub fn pole_stretch(wall: &SolidWall, state: &State) -> f64 {
    station(wall, state, 0.0, -1.0).meridional_stretch
}

/// The station at a share of the parameter's range, 0 = pole, 1 = rim.
pub fn station(wall: &SolidWall, state: &State, share: f64, contact: f64) -> WallPoint {
    let mesh = &wall.mesh;
    let parameter = FRAC_PI_2 * share;
    let (column, x) = mesh.column_at(parameter);
    let (n, dn) = (shape(x), slope(x));
    let through = mesh.elements.through;
    // Middle of the wall: a layer of nodes.
    let [r, z] = edge(mesh, &state.nodes, column, through);
    let [big_r, big_z] = edge(mesh, &mesh.nodes, column, through);
    let (tangent, undeformed_tangent) = ([dot(&dn, &r), dot(&dn, &z)], [dot(&dn, &big_r), dot(&dn, &big_z)]);
    let (arc, undeformed_arc) = (
        libm::hypot(tangent[0], tangent[1]),
        libm::hypot(undeformed_tangent[0], undeformed_tangent[1]),
    );
    let (radius, undeformed_radius) = (dot(&n, &r), dot(&n, &big_r));
    let meridional_stretch = arc / undeformed_arc;
    // At the pole both directions are one.
    let hoop_stretch = if share <= 0.0 {
        meridional_stretch
    } else {
        radius / undeformed_radius
    };
    let surface = |nodes: &[[f64; 2]], layer: usize| {
        let [r, z] = edge(mesh, nodes, column, layer);
        [dot(&n, &r), dot(&n, &z)]
    };
    let fibre = |nodes: &[[f64; 2]]| {
        let (inner, outer) = (surface(nodes, 0), surface(nodes, mesh.layers() - 1));
        [outer[0] - inner[0], outer[1] - inner[1]]
    };
    let (deformed_fibre, undeformed_fibre) = (fibre(&state.nodes), fibre(&mesh.nodes));
    let [meridional, hoop] = forces(wall, state, column, x, [tangent[0] / arc, tangent[1] / arc]);
    WallPoint {
        parameter,
        radius,
        height: dot(&n, &z),
        meridional_stretch,
        hoop_stretch,
        thickness_stretch: libm::hypot(deformed_fibre[0], deformed_fibre[1])
            / libm::hypot(undeformed_fibre[0], undeformed_fibre[1]),
        shear: shear(wall, state, column, x),
        // Per radian of the undeformed middle and per unit of its parameter.
        meridional_tension: meridional / hoop_stretch,
        hoop_tension: hoop / arc,
        angle: libm::atan2(-tangent[1], tangent[0]),
        in_contact: parameter <= contact,
    }
}

/// The largest shear of the places through the wall.
fn shear(wall: &SolidWall, state: &State, column: usize, x: f64) -> f64 {
    let mesh = &wall.mesh;
    let lean = |positions: &element::Positions, y: f64| {
        let (along, through) = tangents(positions, x, y);
        // The normal points outward: the tangent, from pole to rim, turned left.
        let normal = [-along[1], along[0]];
        libm::atan2(
            through[0] * along[0] + through[1] * along[1],
            through[0] * normal[0] + through[1] * normal[1],
        )
    };
    let mut largest = 0.0_f64;
    for layer in 0..mesh.elements.through {
        let deformed = positions(mesh, &state.nodes, column, layer);
        let undeformed = positions(mesh, &mesh.nodes, column, layer);
        for y in [-1.0, -0.5, 0.0, 0.5, 1.0] {
            let shear = lean(&deformed, y) - lean(&undeformed, y);
            if shear.abs() > largest.abs() {
                largest = shear;
            }
        }
    }
    largest
}

/// Derivatives of the place by the element's two coordinates.
fn tangents([r, z]: &element::Positions, x: f64, y: f64) -> ([f64; 2], [f64; 2]) {
    let (mut along, mut through) = ([0.0; 2], [0.0; 2]);
    for i in 0..FUNCTIONS {
        let [_, by_along, by_through] = function(i, x, y);
        for (c, value) in [r[i], z[i]].into_iter().enumerate() {
            along[c] += by_along * value;
            through[c] += by_through * value;
        }
    }
    (along, through)
}

/// Force across the wall along the middle's `tangent`, per undeformed length around the middle; and around, per unit of the
/// place in the column.
fn forces(wall: &SolidWall, state: &State, column: usize, x: f64, tangent: [f64; 2]) -> [f64; 2] {
    let mesh = &wall.mesh;
    let through = mesh.elements.through;
    let [middle, _] = edge(mesh, &mesh.nodes, column, through);
    let (mut meridional, mut hoop) = (0.0, 0.0);
    for layer in 0..through {
        let deformed = positions(mesh, &state.nodes, column, layer);
        let undeformed = positions(mesh, &mesh.nodes, column, layer);
        let pressures = &state.pressures[column * through + layer];
        for (y, weight) in PLACES.into_iter().zip(WEIGHTS) {
            // On the axis the hoop stretch is the limit beside it.
            let x = x.max(if column == 0 { -1.0 + 1e-6 } else { -1.0 });
            let (point, across, radius) = super::mesh::sample(&undeformed, x, y);
            let stress = element::stress(
                &wall.material,
                element::deformation(&point.gradient, &deformed),
                element::pressure_at(x, y, pressures),
            );
            // The section's undeformed normal times its length: the fibre turned right.
            let normal = [across[1], -across[0]];
            let p = &stress.nominal;
            let traction = [
                p[0] * normal[0] + p[1] * normal[1],
                p[3] * normal[0] + p[4] * normal[1],
            ];
            let around = radius / dot(&shape(x), &middle);
            meridional += weight * around * (traction[0] * tangent[0] + traction[1] * tangent[1]);
            hoop += weight * p[2] * point.weight;
        }
    }
    [meridional, hoop]
}
