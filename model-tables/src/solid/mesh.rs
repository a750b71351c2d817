//! The undeformed wall, cut into biquadratic elements.
//!
//! A single element through the wall is cubic through it: at each station it has one more function, `y - y^3` with `y` from -1
//! inside to 1 outside. A quadratic element cannot follow the parabola of shear strain across the wall: a dome with a wall of 0.3
//! of its radius would be 5 % too stiff.
//!
//! A dome is `X(t, s) = ((a - h + h s) sin t, (b - h + h s) cos t)`: `a` and `b` are the semi-axes of the outer surface, `h` the
//! wall's thickness, `t` runs from the pole to the rim, `s` from inside to outside. Lengths are in units of `a`. A flat disc of radius `a` is
//! `X(t, s) = (a t / (pi/2), h s)`, with the fluid under it.

use core::f64::consts::{FRAC_PI_2, PI};

/// Nodes of an element.
pub const NODES: usize = 9;
/// Shape functions of an element: those of its nodes, and the cubic ones of its three stations.
pub const FUNCTIONS: usize = NODES + 3;
/// Gauss points of an element.
pub const POINTS: usize = 9;
/// Terms of a biquadratic element's pressure: constant, along, through.
pub const PRESSURES: usize = 3;
/// Terms of the pressure of an element that is cubic through the wall: besides, along times through, and through squared.
pub const CUBIC_PRESSURES: usize = 5;

/// `sqrt(3/5)`: Gauss points of order six on `[-1, 1]` are at 0 and at plus and minus this.
const GAUSS: f64 = 0.774_596_669_241_483_4;
/// Gauss points of order six on `[-1, 1]`.
pub const PLACES: [f64; 3] = [-GAUSS, 0.0, GAUSS];
/// Their weights.
pub const WEIGHTS: [f64; 3] = [5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0];

/// Values of the three quadratic shape functions of an edge at `x` in `[-1, 1]`.
pub fn shape(x: f64) -> [f64; 3] {
    [0.5 * x * (x - 1.0), 1.0 - x * x, 0.5 * x * (x + 1.0)]
}

/// Their slopes.
pub fn slope(x: f64) -> [f64; 3] {
    [x - 0.5, -2.0 * x, x + 0.5]
}

/// Distance from what the rim is bonded to, in wall thicknesses, up to which the wall belongs to the crease at the rim. Where a free surface meets
/// a bonded one the strains are singular: pressed deep, the surface rolls over the base there in a place that is the
/// smaller the finer the mesh, and of no consequence for the rest.
pub const CREASE: f64 = 0.5;

/// By how much shorter than their mean elements are at the pole and at the rim, and longer half way, where there are two or more
/// through the wall and [`FEW`] along it: a light touch and the bonded rim need short ones, and thin domes gain most. It fades
/// with the square of the number along, as the need does; short elements at the rim sharpen the singular corner. One element through
/// the wall feels that corner most: there lengths are even.
const GRADING: f64 = 0.25;
/// Elements along with the full grading.
const FEW: f64 = 24.0;

/// Length of a disc's element at the rim, over the thickness: within about a thickness of the clamp the disc bends sharply.
const DISC_RIM: f64 = 0.25;
/// Most that lengths grow from the rim of a disc to its centre, as an exponent: they are a geometric series.
const DISC_GRADING: f64 = 6.0;

/// Elements of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Elements {
    /// Through the wall.
    pub through: usize,
    /// Along the meridian.
    pub along: usize,
}

impl Elements {
    /// One more through the wall, and 8 for 5 along it.
    #[must_use]
    pub const fn finer(self) -> Self {
        Self {
            through: self.through + 1,
            along: (8 * self.along).div_ceil(5),
        }
    }
}

/// A Gauss point of an element.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// Undeformed volume that it stands for, over the cube of the radial semi-axis.
    pub weight: f64,
    /// Whether it lies in the crease at the rim.
    pub in_crease: bool,
    /// Of each node's shape function: derivatives by the undeformed radius and height, and the value over the undeformed
    /// radius.
    pub gradient: [[f64; FUNCTIONS]; 3],
}

/// The undeformed wall.
#[derive(Clone, Debug)]
pub struct Mesh {
    /// How many elements.
    pub elements: Elements,
    /// Wall thickness, over the radial semi-axis.
    pub thickness: f64,
    /// Height of the undeformed pole, over the radial semi-axis: of a dome the outer axial semi-axis, of a disc its
    /// thickness.
    pub height: f64,
    /// The meridian's parameter `t` of the stations, radians.
    pub parameters: Vec<f64>,
    /// Radius and height of the nodes: station by station from the pole, each from inside to outside, and behind them the
    /// amplitude of its cubic function, which is zero here.
    pub nodes: Vec<[f64; 2]>,
    /// Gauss points: column by column, within it from inside to outside.
    pub points: Vec<[Point; POINTS]>,
}

impl Mesh {
    /// The wall of an outer half ellipsoid with semi-axes 1 and `height`.
    pub fn new(height: f64, thickness: f64, elements: Elements) -> Self {
        let Elements { through, along } = elements;
        let stations = 2 * along + 1;
        let grading = if through > 1 {
            GRADING * (FEW / along as f64).powi(2).min(1.0)
        } else {
            0.0
        };
        let parameters = (0..stations)
            .map(|station| {
                let part = station as f64 / (stations - 1) as f64;
                FRAC_PI_2 * part - 0.25 * grading * libm::sin(2.0 * PI * part)
            })
            .collect();
        let place = |station: usize, t: f64, through: f64| {
            // Exactly on the axis and on the base plane.
            let (sin, cos) = match station {
                0 => (0.0, 1.0),
                last if last + 1 == stations => (1.0, 0.0),
                _ => (libm::sin(t), libm::cos(t)),
            };
            let inset = thickness * (1.0 - through);
            [(1.0 - inset) * sin, (height - inset) * cos]
        };
        Self::build([height, thickness], elements, parameters, place, |[_, height]| {
            height
        })
    }

    /// A flat disc of radius 1, clamped at its rim, from the height 0 to `thickness`.
    pub fn disc(thickness: f64, elements: Elements) -> Self {
        let along = elements.along;
        let grading = grading(DISC_RIM * thickness * along as f64);
        // Radius of the edge between two columns.
        let edge = |column: usize| {
            let part = (along - column) as f64 / along as f64;
            let from_rim = if grading > 0.0 {
                libm::expm1(grading * part) / libm::expm1(grading)
            } else {
                part
            };
            1.0 - from_rim
        };
        let parameters = (0..=2 * along)
            .map(|station| FRAC_PI_2 * 0.5 * (edge(station / 2) + edge(station.div_ceil(2))))
            .collect();
        let place = |_, t: f64, through: f64| [t / FRAC_PI_2, thickness * through];
        Self::build([thickness; 2], elements, parameters, place, |[radius, _]| {
            1.0 - radius
        })
    }

    /// The mesh with stations at these parameters. `place` gives radius and height of a station, by its number and parameter, at a part of the
    /// wall from inside; `from_bond` how far a place is from what the rim is bonded to.
    fn build(
        [height, thickness]: [f64; 2],
        elements: Elements,
        parameters: Vec<f64>,
        place: impl Fn(usize, f64, f64) -> [f64; 2],
        from_bond: impl Fn([f64; 2]) -> f64,
    ) -> Self {
        let Elements { through, along } = elements;
        let layers = 2 * through + 1;
        let cubic = usize::from(through == 1);
        let mut nodes = Vec::with_capacity(parameters.len() * (layers + cubic));
        for (station, &t) in parameters.iter().enumerate() {
            for layer in 0..layers {
                nodes.push(place(station, t, layer as f64 / (layers - 1) as f64));
            }
            nodes.extend(core::iter::repeat_n([0.0; 2], cubic));
        }
        let mut mesh = Self {
            elements,
            thickness,
            height,
            parameters,
            nodes,
            points: Vec::with_capacity(through * along),
        };
        for column in 0..along {
            for layer in 0..through {
                let corners = mesh.element_nodes(column, layer).map(|node| mesh.nodes[node]);
                mesh.points.push(core::array::from_fn(|i| {
                    let weight = WEIGHTS[i / 3] * WEIGHTS[i % 3];
                    let (point, place) = point(&corners, PLACES[i / 3], PLACES[i % 3], weight);
                    Point {
                        in_crease: from_bond(place) < CREASE * thickness,
                        ..point
                    }
                }));
            }
        }
        mesh
    }

    /// Nodes through the wall.
    pub fn layers(&self) -> usize {
        2 * self.elements.through + 1
    }

    /// Whether the elements are cubic through the wall.
    pub fn is_cubic(&self) -> bool {
        self.elements.through == 1
    }

    /// Pairs of unknowns of a station: its nodes, and the amplitude of a cubic function.
    pub fn stride(&self) -> usize {
        self.layers() + usize::from(self.is_cubic())
    }

    /// Nodes along the meridian.
    pub fn stations(&self) -> usize {
        2 * self.elements.along + 1
    }

    /// The meridian's parameter at a place in `[-1, 1]` of a column.
    pub fn parameter(&self, column: usize, place: f64) -> f64 {
        let n = shape(place);
        (0..3).map(|i| n[i] * self.parameters[2 * column + i]).sum()
    }

    /// The column, and the place in it, with a parameter.
    pub fn column_at(&self, parameter: f64) -> (usize, f64) {
        let along = self.elements.along;
        let column = (1..along)
            .position(|column| parameter < self.parameters[2 * column])
            .unwrap_or(along - 1);
        let t: [f64; 3] = core::array::from_fn(|i| self.parameters[2 * column + i]);
        // All but linear: Newton's method.
        let mut place = 0.0_f64;
        for _ in 0..6 {
            let dn = slope(place);
            let rate = dn[0] * t[0] + dn[1] * t[1] + dn[2] * t[2];
            place -= (self.parameter(column, place) - parameter) / rate;
        }
        (column, place.clamp(-1.0, 1.0))
    }

    /// Number of a node; of the cubic function's amplitude as the layer behind the last.
    pub fn node(&self, station: usize, layer: usize) -> usize {
        station * self.stride() + layer
    }

    /// Nodes of an element: three stations from the pole, each from inside to outside.
    pub fn element_nodes(&self, column: usize, layer: usize) -> [usize; NODES] {
        core::array::from_fn(|i| self.node(2 * column + i / 3, 2 * layer + i % 3))
    }
}

/// The exponent of a geometric series of lengths from 1 to its greatest, whose first is `first` of their mean; 0 where that is no shorter.
fn grading(first: f64) -> f64 {
    // x / (e^x - 1) falls from 1.
    let (mut low, mut high) = (0.0, DISC_GRADING);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if middle / libm::expm1(middle) > first {
            low = middle;
        } else {
            high = middle;
        }
    }
    if first < 1.0 { low } else { 0.0 }
}

/// The Gauss point at `along`, `through` in `[-1, 1]`, and its place.
fn point(corners: &[[f64; 2]; NODES], along: f64, through: f64, weight: f64) -> (Point, [f64; 2]) {
    let (n, m) = (shape(along), shape(through));
    let height: f64 = (0..NODES).map(|i| n[i / 3] * m[i % 3] * corners[i][1]).sum();
    let undeformed = [0, 1].map(|c| core::array::from_fn(|i| corners.get(i).map_or(0.0, |x| x[c])));
    let (point, _, radius) = sample(&undeformed, along, through);
    let point = Point {
        weight: 2.0 * PI * radius * point.weight * weight,
        ..point
    };
    (point, [radius, height])
}

/// Value of a shape function of an element at `along`, `through` in `[-1, 1]`, and its derivatives by both.
pub fn function(i: usize, along: f64, through: f64) -> [f64; 3] {
    let station = if i < NODES { i / 3 } else { i - NODES };
    let (n, dn) = (shape(along)[station], slope(along)[station]);
    let (m, dm) = if i < NODES {
        (shape(through)[i % 3], slope(through)[i % 3])
    } else {
        let square = through * through;
        (through * (1.0 - square), 1.0 - 3.0 * square)
    };
    [n * m, dn * m, n * dm]
}

/// A point at `along`, `through` in `[-1, 1]` of the element with these radii and heights: with the area of the meridian
/// plane per unit of both for its weight, the derivative of the place by `through`, and the radius.
pub fn sample([r, z]: &[[f64; FUNCTIONS]; 2], along: f64, through: f64) -> (Point, [f64; 2], f64) {
    let [n, m, dn, dm] = [shape(along), shape(through), slope(along), slope(through)];
    let mut radius = 0.0;
    // d(R, Z) / d(along, through)
    let mut jacobian = [[0.0; 2]; 2];
    for i in 0..NODES {
        let (a, b) = (i / 3, i % 3);
        radius += n[a] * m[b] * r[i];
        for (row, x) in jacobian.iter_mut().zip([r[i], z[i]]) {
            row[0] += dn[a] * m[b] * x;
            row[1] += n[a] * dm[b] * x;
        }
    }
    let determinant = jacobian[0][0] * jacobian[1][1] - jacobian[0][1] * jacobian[1][0];
    let mut gradient = [[0.0; FUNCTIONS]; 3];
    for i in 0..FUNCTIONS {
        let [value, by_along, by_through] = function(i, along, through);
        gradient[0][i] = (by_along * jacobian[1][1] - by_through * jacobian[1][0]) / determinant;
        gradient[1][i] = (by_through * jacobian[0][0] - by_along * jacobian[0][1]) / determinant;
        gradient[2][i] = value / radius;
    }
    let point = Point {
        weight: determinant.abs(),
        in_crease: false,
        gradient,
    };
    (point, [jacobian[0][1], jacobian[1][1]], radius)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `2 pi / 3 (a^2 b - (a - h)^2 (b - h))`, which quadratic edges only come near to.
    #[test]
    fn the_points_stand_for_the_walls_volume() {
        for through in [1, 2] {
            let mesh = Mesh::new(0.8, 0.15, Elements { through, along: 24 });
            let sum: f64 = mesh.points.iter().flatten().map(|point| point.weight).sum();
            let volume = 2.0 * PI / 3.0 * (0.8 - 0.85 * 0.85 * 0.65);
            assert!((sum / volume - 1.0).abs() < 1e-6, "{sum} {volume}");
        }
    }

    /// `pi h` of a disc of radius 1, with short elements at the rim where it is thin.
    #[test]
    fn a_disc_has_its_volume_and_short_elements_at_the_rim() {
        for thickness in [0.0025, 0.2] {
            let elements = Elements {
                through: 2,
                along: 32,
            };
            let mesh = Mesh::disc(thickness, elements);
            let sum: f64 = mesh.points.iter().flatten().map(|point| point.weight).sum();
            assert!((sum / (PI * thickness) - 1.0).abs() < 1e-12, "{sum}");
            let last = mesh.node(64, 0);
            assert!(mesh.nodes[0][0].abs() < 1e-15 && (mesh.nodes[last][0] - 1.0).abs() < 1e-15);
            let at_rim = 1.0 - mesh.nodes[mesh.node(62, 0)][0];
            assert!(at_rim < 1.01 * (1.0_f64 / 32.0).min(0.3 * thickness), "{at_rim}");
        }
    }

    #[test]
    fn parameters_and_places_are_inverse() {
        let mesh = Mesh::new(
            0.8,
            0.15,
            Elements {
                through: 2,
                along: 24,
            },
        );
        let lengths: Vec<f64> = mesh
            .parameters
            .windows(3)
            .step_by(2)
            .map(|t| t[2] - t[0])
            .collect();
        assert!(lengths[0] < 0.8 * lengths[12] && lengths[23] < 0.8 * lengths[12]);
        for i in 0..=100 {
            let parameter = FRAC_PI_2 * f64::from(i) / 100.0;
            let (column, place) = mesh.column_at(parameter);
            assert!(
                (mesh.parameter(column, place) - parameter).abs() < 1e-14,
                "{parameter}"
            );
        }
    }
}
