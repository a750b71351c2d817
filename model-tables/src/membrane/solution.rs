//! A mesh of the meridian with values on it.

use crate::membrane::equations::{CONTACT_PARAMETER, POLE, Zone};
use crate::solver::collocation::{Gauss, PARAMETERS, STATES, Span};
use core::f64::consts::FRAC_PI_2;

/// Most elements a mesh may have.
pub const MAX_ELEMENTS: usize = 64;

/// Shift of a node, over the spacing there, up to which two meshes count as nearly the same.
const LARGEST_SHIFT: f64 = 0.1;

/// State of the membrane at its pole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pole {
    /// Taut: the pole parameter is the stretch of the pole.
    Taut,
    /// Slack up to a free boundary `t_s`, where both stretches are 1: the pole parameter is `t_s`.
    Slack,
}

/// A mesh with values on it.
#[derive(Clone, Debug)]
pub struct Solution<const S: usize> {
    /// Taut or slack.
    pub pole: Pole,
    /// Elements under the plate.
    pub contact_elements: usize,
    /// Elements of the free zone.
    pub free_elements: usize,
    /// Position of each node within its zone, 0 ..= 1: `contact_elements + 1` values, then `free_elements + 1`.
    pub fractions: [f64; MAX_ELEMENTS + 2],
    /// State at each node, the contact edge once.
    pub nodes: [[f64; STATES]; MAX_ELEMENTS + 1],
    /// State at each Gauss point.
    pub stages: [[[f64; STATES]; S]; MAX_ELEMENTS],
    /// Meridional stretch at each Gauss point.
    pub stretches: [[f64; S]; MAX_ELEMENTS],
    /// Pole, pressure, contact radius, contact parameter, each dimensionless.
    pub parameters: [f64; PARAMETERS],
    /// Height of the dome, over the radial semi-axis.
    pub height: f64,
    /// Volume of the dome, over the cube of the radial semi-axis.
    pub volume: f64,
}

impl<const S: usize> Solution<S> {
    /// Room for a solution.
    pub(crate) const BLANK: Self = Self {
        pole: Pole::Taut,
        contact_elements: 0,
        free_elements: 0,
        fractions: [0.0; MAX_ELEMENTS + 2],
        nodes: [[0.0; STATES]; MAX_ELEMENTS + 1],
        stages: [[[0.0; STATES]; S]; MAX_ELEMENTS],
        stretches: [[0.0; S]; MAX_ELEMENTS],
        parameters: [0.0; PARAMETERS],
        height: 0.0,
        volume: 0.0,
    };

    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.contact_elements + self.free_elements
    }

    /// Where the membrane begins to be taut: 0, or the edge of the slack core.
    pub fn start(&self) -> f64 {
        if self.pole == Pole::Slack {
            self.parameters[POLE]
        } else {
            0.0
        }
    }

    /// Whether the meshes differ so little (a moving kink) that values on them can be combined one by one.
    pub fn has_nearly_the_mesh_of(&self, other: &Self) -> bool {
        let count = self.elements() + 2;
        self.pole == other.pole
            && self.contact_elements == other.contact_elements
            && self.free_elements == other.free_elements
            && (0..count).all(|k| {
                let neighbour = if k == 0 || k == self.contact_elements + 1 {
                    k + 1
                } else {
                    k - 1
                };
                let spacing = (other.fractions[k] - other.fractions[neighbour]).abs();
                (self.fractions[k] - other.fractions[k]).abs() <= LARGEST_SHIFT * spacing
            })
    }

    /// State and a guess of the meridional stretch at `t`, by the collocation polynomials; a slack core is `[1, 0]`.
    pub fn at(&self, gauss: &Gauss<S>, t: f64) -> ([f64; STATES], f64) {
        self.at_from(gauss, t, &mut 0)
    }

    /// The same, looking for the element from `element` on, which it leaves where it found `t`.
    fn at_from(&self, gauss: &Gauss<S>, t: f64, element: &mut usize) -> ([f64; STATES], f64) {
        if t < self.start() {
            return ([1.0, 0.0], 1.0);
        }
        let mut span = self.span(*element);
        while *element + 1 < self.elements() {
            let next = self.span(*element + 1);
            if next.start > t {
                break;
            }
            span = next;
            *element += 1;
        }
        let e = *element;
        let theta = (t - span.start) / span.length;
        let nearest = gauss
            .nodes
            .iter()
            .position(|&node| node >= theta)
            .unwrap_or(S - 1);
        (
            gauss.evaluate(self.nodes[e], &self.stages[e], theta),
            self.stretches[e][nearest],
        )
    }

    /// Puts the values of this solution on the mesh of `onto`.
    pub fn resample(&self, gauss: &Gauss<S>, onto: &mut Self) {
        let mut element = 0;
        for e in 0..onto.elements() {
            let span = onto.span(e);
            (onto.nodes[e], _) = self.at_from(gauss, span.start, &mut element);
            for j in 0..S {
                (onto.stages[e][j], onto.stretches[e][j]) =
                    self.at_from(gauss, span.start + gauss.nodes[j] * span.length, &mut element);
            }
        }
        let elements = onto.elements();
        onto.nodes[elements] = self.nodes[self.elements()];
    }

    /// The zone of element `e`.
    pub fn zone(&self, e: usize) -> Zone {
        if e < self.contact_elements {
            Zone::Contact
        } else {
            Zone::Free
        }
    }

    /// Where element `e` lies.
    pub fn span(&self, e: usize) -> Span {
        let contact_parameter = self.parameters[CONTACT_PARAMETER];
        let mut span = Span::default();
        if e < self.contact_elements {
            let (a, b) = (self.fractions[e], self.fractions[e + 1]);
            let start = self.start();
            span.start = start + (contact_parameter - start) * a;
            span.length = (contact_parameter - start) * (b - a);
            span.start_by[CONTACT_PARAMETER] = a;
            span.length_by[CONTACT_PARAMETER] = b - a;
            if self.pole == Pole::Slack {
                span.start_by[POLE] = 1.0 - a;
                span.length_by[POLE] = a - b;
            }
        } else {
            let (a, b) = (self.fractions[e + 1], self.fractions[e + 2]);
            let start = if self.contact_elements == 0 {
                self.start()
            } else {
                contact_parameter
            };
            span.start = start + (FRAC_PI_2 - start) * a;
            span.length = (FRAC_PI_2 - start) * (b - a);
            span.start_by[CONTACT_PARAMETER] = 1.0 - a;
            span.length_by[CONTACT_PARAMETER] = a - b;
        }
        span
    }
}
