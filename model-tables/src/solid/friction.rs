//! Friction between the outer surface and an object: Coulomb's law, by return mapping (Simo and Laursen, "An augmented Lagrangian treatment
//! of contact problems involving friction", Comput. Struct. 42 (1992) 97).
//!
//! A touching point is connected to the object by a stiff spring along the object's meridian. Its traction is `k (s - a)`, with
//! `s` the place of the point on the object and `a` that of its anchor; beyond `mu p` the anchor follows. A point that comes
//! into contact within a step is anchored where it was when its penetration, taken as linear over the step, passed zero. Points
//! are fixed to the wall, so that each keeps its anchor. What sliding changes of the pressure's part in the traction is left
//! out of the linear equations, which keeps them symmetric.

use super::mesh::shape;
use super::object::{Action, Surface};
use super::plate::{PLACES, POINTS, WEIGHTS, area};
use crate::object::Friction;

/// Traction over the distance from the anchor, over contact pressure over penetration: so soft that iterations settle which points slide, and
/// so stiff that a point is held within 0.25 % of the wall of its anchor where the contact pressure is a tenth of the modulus.
const TANGENTIAL: f64 = 0.2;
/// Coefficient of what sticks: a point that hardly touches is not held, and rubber seldom holds on to more. Three times as much changes force and
/// pressure of the printed dome by less than 0.1 %.
const STICK: f64 = 1.0;
/// About the largest traction, relative to it, the spring gives way gradually by so much to either side.
const ROUNDING: f64 = 0.2;

/// A point of the outer surface in the state that a step starts from.
#[derive(Clone, Copy, Debug)]
struct Trace {
    depth: f64,
    /// Its place along the object's meridian.
    arc: f64,
    /// Its anchor; NaN if it does not touch.
    anchor: f64,
}

/// Action of friction on a point.
#[derive(Clone, Copy, Debug)]
struct Traction {
    /// Per undeformed area, against an increasing place.
    value: f64,
    /// Its derivative by the place.
    slope: f64,
    /// The anchor at the end of the step.
    anchor: f64,
    /// The anchor at the start of the step, or when the point touched.
    from: f64,
}

/// The friction of a wall's outer edges since the start of a step.
#[derive(Clone, Debug)]
pub(super) struct Sliding {
    coefficient: f64,
    /// Contact pressure over penetration.
    normal: f64,
    /// Traction over the distance from the anchor.
    stiffness: f64,
    traces: Vec<[Trace; POINTS]>,
}

/// A traction that would be `x` times the largest if the anchor held, over the largest, and its derivative by `x`.
fn saturate(x: f64) -> (f64, f64) {
    let from = 1.0 - ROUNDING;
    if x <= from {
        (x, 1.0)
    } else if x < 1.0 + ROUNDING {
        let past = x - from;
        (x - past * past / (4.0 * ROUNDING), 1.0 - past / (2.0 * ROUNDING))
    } else {
        (1.0, 0.0)
    }
}

impl Sliding {
    /// The friction of `edges` edges. `None` without friction.
    pub(super) fn new(law: Friction, stiffness: f64, edges: usize) -> Option<Self> {
        let none = Trace {
            depth: -1.0,
            arc: 0.0,
            anchor: f64::NAN,
        };
        (law != Friction::NONE).then(|| Self {
            coefficient: match law {
                Friction::Coulomb(coefficient) => coefficient,
                Friction::Stick => STICK,
            },
            normal: stiffness,
            stiffness: TANGENTIAL * stiffness,
            traces: vec![[none; POINTS]; edges],
        })
    }

    /// Starts a step: an edge is at this place over the apex, its points have these anchors.
    pub(super) fn start(&mut self, edge: usize, surface: &Surface, place: &[[f64; 3]; 2], anchors: &[f64]) {
        for (i, trace) in self.traces[edge].iter_mut().enumerate() {
            let at = super::object::at(&shape(PLACES[i]), place);
            *trace = Trace {
                depth: surface.depth(at[0], at[1]),
                arc: surface.arc(at).value,
                anchor: anchors.get(POINTS * edge + i).copied().unwrap_or(f64::NAN),
            };
        }
    }

    fn traction(&self, trace: &Trace, depth: f64, arc: f64) -> Option<Traction> {
        if depth <= 0.0 {
            return None;
        }
        // Where the anchor is, and how it follows the place.
        let (from, follows) = if trace.anchor.is_nan() {
            let part = (trace.depth / (trace.depth - depth)).clamp(0.0, 1.0);
            (trace.arc + part * (arc - trace.arc), part)
        } else {
            (trace.anchor, 0.0)
        };
        let value = self.stiffness * (arc - from);
        let most = self.coefficient * self.normal * depth;
        let (share, slope) = saturate(value.abs() / most);
        let (value, slope) = if share < 1.0 - ROUNDING {
            (value, 1.0)
        } else {
            (libm::copysign(share * most, value), slope)
        };
        Some(Traction {
            value,
            slope: slope * self.stiffness * (1.0 - follows),
            anchor: arc - value / self.stiffness,
            from,
        })
    }

    /// Adds friction's action on an edge at a place over the apex.
    pub(super) fn add(
        &self,
        edge: usize,
        surface: &Surface,
        undeformed: &[[f64; 3]; 2],
        place: &[[f64; 3]; 2],
        action: &mut Action,
    ) {
        for (i, trace) in self.traces[edge].iter().enumerate() {
            let n = shape(PLACES[i]);
            let at = super::object::at(&n, place);
            let arc = surface.arc(at);
            let Some(traction) = self.traction(trace, surface.depth(at[0], at[1]), arc.value) else {
                continue;
            };
            let weight = WEIGHTS[i] * area(undeformed, PLACES[i]);
            action.energy += weight * traction.value * traction.value / (2.0 * self.stiffness);
            action.add(weight, &n, &arc, traction.value, traction.slope);
        }
    }

    /// The anchors of an edge's points at the end of a step, and the energy lost by sliding in it.
    pub(super) fn finish(
        &self,
        edge: usize,
        surface: &Surface,
        undeformed: &[[f64; 3]; 2],
        place: &[[f64; 3]; 2],
    ) -> ([f64; POINTS], f64) {
        let mut dissipated = 0.0;
        let mut anchors = [f64::NAN; POINTS];
        for (i, trace) in self.traces[edge].iter().enumerate() {
            let at = super::object::at(&shape(PLACES[i]), place);
            let depth = surface.depth(at[0], at[1]);
            let Some(traction) = self.traction(trace, depth, surface.arc(at).value) else {
                continue;
            };
            let before = if trace.anchor.is_nan() {
                0.0
            } else {
                self.stiffness * (trace.arc - trace.anchor)
            };
            // The mean of the traction over the step.
            let mean = 0.5 * (before + traction.value);
            dissipated += WEIGHTS[i] * area(undeformed, PLACES[i]) * mean * (traction.anchor - traction.from);
            anchors[i] = traction.anchor;
        }
        (anchors, dissipated)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STIFFNESS: f64 = 1e3;
    /// A flat disc of radius 0.2, dipped in by 0.01.
    const DISC: [[f64; 3]; 2] = [[0.0, 0.1, 0.2], [0.01, 0.01, 0.01]];
    const AREA: f64 = core::f64::consts::PI * 0.04;

    /// The disc swells by a part of its radius; radial forces do work over the nodes' radii.
    fn swollen(law: Friction, by: f64) -> (Action, f64) {
        let mut sliding = Sliding::new(law, STIFFNESS, 1).expect("friction");
        let surface = Surface::Plate;
        let anchors: Vec<f64> = PLACES.map(|x| 0.1 * (1.0 + x)).to_vec();
        sliding.start(0, &surface, &DISC, &anchors);
        let place = [DISC[0].map(|r| r * (1.0 + by)), DISC[1]];
        let mut action = Action::default();
        sliding.add(0, &surface, &DISC, &place, &mut action);
        let (_, dissipated) = sliding.finish(0, &surface, &DISC, &place);
        (action, dissipated)
    }

    /// What sticks is held by `k r by`: energy `k by^2 / 2`, with `k` of the spring, times the second moment `2 pi integral of r^3 dr`.
    #[test]
    fn what_sticks_stores_its_energy() {
        for law in [Friction::Stick, Friction::Coulomb(0.5)] {
            // Within 0.8 of the largest traction.
            let (action, dissipated) = swollen(law, 0.01);
            let moment = core::f64::consts::PI * 0.2_f64.powi(4) / 2.0;
            assert!((action.energy / (0.5 * TANGENTIAL * STIFFNESS * 1e-4 * moment) - 1.0).abs() < 1e-12);
            assert!(dissipated.abs() < 1e-15 && action.force.abs() < 1e-15);
        }
    }

    /// What slides is held by `mu p`, whatever it slid; its pull on a uniform radial motion is `mu p` times the area.
    #[test]
    fn what_slides_is_held_by_the_coefficient() {
        let coefficient = 1e-3;
        for by in [0.5, 1.0] {
            let (action, dissipated) = swollen(Friction::Coulomb(coefficient), by);
            let pull: f64 = action.first[..3].iter().sum();
            let expected = coefficient * STIFFNESS * 0.01 * AREA;
            assert!((pull / expected - 1.0).abs() < 1e-12, "{pull} {expected}");
            assert!(dissipated > 0.0);
        }
    }

    /// Forces are the derivatives of what is stored while nothing slides, on every surface.
    #[test]
    fn derivatives_of_a_sticking_edge_are_exact() {
        for surface in [
            Surface::Plate,
            Surface::Ball(0.4),
            Surface::Cup(3.0),
            Surface::Punch { flat: 0.1, rim: 0.15 },
        ] {
            let mut sliding = Sliding::new(Friction::Stick, STIFFNESS, 1).expect("friction");
            let start = [[0.02, 0.1, 0.19], [0.05, 0.06, 0.08]];
            let anchors: Vec<f64> = PLACES
                .map(|x| surface.arc(super::super::object::at(&shape(x), &start)).value - 0.01)
                .to_vec();
            sliding.start(0, &surface, &start, &anchors);
            let place = [[0.021, 0.103, 0.194], [0.051, 0.063, 0.079]];
            let of = |place: &[[f64; 3]; 2]| {
                let mut action = Action::default();
                sliding.add(0, &surface, &DISC, place, &mut action);
                action
            };
            let found = of(&place);
            assert!(found.energy > 0.0);
            for j in 0..6 {
                let [below, above] = [-1e-6, 1e-6].map(|by| {
                    let mut moved = place;
                    moved[j / 3][j % 3] += by;
                    of(&moved)
                });
                assert!(
                    ((above.energy - below.energy) / 2e-6 - found.first[j]).abs() < 1e-6,
                    "{surface:?} {j}"
                );
                for i in 0..6 {
                    let slope = (above.first[i] - below.first[i]) / 2e-6;
                    assert!((slope - found.second[i][j]).abs() < 1e-4, "{surface:?} {i} {j}");
                }
            }
        }
    }

    /// A point that comes into contact half way through a step is anchored where it was then.
    #[test]
    fn a_point_is_anchored_where_it_touched() {
        let mut sliding = Sliding::new(Friction::Stick, STIFFNESS, 1).expect("friction");
        let above = [DISC[0], [-0.01; 3]];
        sliding.start(0, &Surface::Plate, &above, &[]);
        let place = [DISC[0].map(|r| r + 0.02), DISC[1]];
        let (anchors, _) = sliding.finish(0, &Surface::Plate, &DISC, &place);
        for (anchor, x) in anchors.iter().zip(PLACES) {
            assert!((anchor - (0.1 * (1.0 + x) + 0.01)).abs() < 1e-15);
        }
    }
}
