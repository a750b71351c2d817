//! A state of equilibrium on a mesh that fits it.
//!
//! Newton's method works on a fixed mesh and a fixed kind of pole. Here the mesh is graded for the solution, nodes are
//! put where wrinkles begin or end (the equations have a kink there, and a kink inside an element costs the
//! method its order), and a pole that has gone slack, or taut again, changes its kind.

use crate::material::Hyperelastic;
use crate::membrane::closure::{Closure, NewtonOutcome};
use crate::membrane::equations::{CONTACT_PARAMETER, LocalEquations, POLE, PRESSURE, TensionField};
use crate::membrane::equilibrium::Equilibrium;
use crate::membrane::mesh::{Breaks, Depth};
use crate::membrane::solution::{MAX_ELEMENTS, Pole, Solution};
use core::f64::consts::FRAC_PI_2;
use core::fmt;

/// Why there is no state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unsolved {
    /// Newton's method did not converge.
    Newton(NewtonOutcome),
    /// The membrane would have to push where it leaves the plate, which no membrane in equilibrium does.
    EdgePushes {
        /// The contact parameter.
        position: f64,
    },
    /// The press turns back: with more contact the indentation is less, and a plate that goes on would find the tip snap.
    SnapsThrough,
    /// The membrane goes slack on an object that is no plate.
    SlackOnObject,
    /// The edge of a wrinkled zone, or the kind of the pole, did not settle.
    Unsettled,
}

impl fmt::Display for Unsolved {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Newton(NewtonOutcome::Converged { .. }) => write!(f, "converged"),
            Self::Newton(NewtonOutcome::Inadmissible { position, .. }) => write!(
                f,
                "at parameter {position:.4} of the meridian the membrane lost its tension or its law its stability"
            ),
            Self::Newton(NewtonOutcome::Singular { .. }) => write!(f, "the equations became singular"),
            Self::Newton(NewtonOutcome::Stalled { step }) => {
                write!(f, "Newton's method did not converge, last step {step:.1e}")
            }
            Self::EdgePushes { position } => write!(
                f,
                "at the contact edge, parameter {position:.4} of the meridian, the membrane would have to push"
            ),
            Self::SnapsThrough => write!(
                f,
                "the press turns back there, more contact goes with less indentation, and the tip would snap through"
            ),
            Self::SlackOnObject => write!(
                f,
                "the membrane goes slack on the object, which it can do under a plate alone; set model.kind to \"solid\""
            ),
            Self::Unsettled => write!(f, "the edge of a wrinkled or slack zone did not settle"),
        }
    }
}

/// How fine a mesh is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    /// Elements a unit of depth in the free zone (a unit of depth is a factor `e` next to a singularity).
    pub density: f64,
    /// Elements under the plate.
    pub contact_elements: usize,
    /// Change, relative to the state, that one more Newton iteration may still make.
    pub tolerance: f64,
    /// Last term of an element's polynomial, relative to the solution, above which the element is cut; its square is about
    /// the error that remains. Infinite for a mesh that is laid by the grading alone.
    pub last_term: f64,
}

/// How much finer the mesh of the rest state is than that of a press. It is solved once, and the first indentations
/// are small differences against its height.
pub(crate) const REST_FINENESS: f64 = 3.0;
/// Rounds of mesh and pole adjustment.
const MAX_ROUNDS: usize = 12;
/// Finer meshes for a state whose kinks have their nodes; what they do not resolve, more elements would not.
const MAX_REFINEMENTS: usize = 5;
/// A mesh graded for a contact or a bend that differs by more than this factor is laid anew.
const STALE_GRADING: f64 = 1.4;
/// Largest spacing under the plate, in the meridian's parameter, at one element a unit of depth.
const LARGEST_SPACING: f64 = 0.4;
/// Bend lengths below this are not resolved.
const SMALLEST_BEND: f64 = 1e-6;
/// Bend length at which the contact edge has as good as lost its tension.
const VANISHING_BEND: f64 = 1e-5;
/// Bend lengths beyond this do not shape the mesh.
const LARGEST_BEND: f64 = 0.5;

/// A solver that keeps its mesh fitting.
#[derive(Clone, Debug)]
pub struct Adaptive<L, const S: usize> {
    /// Newton's method.
    pub equilibrium: Equilibrium<L, S>,
    /// How fine.
    pub resolution: Resolution,
    /// Newton iterations spent so far.
    pub iterations: u64,
}

/// The quantities for which the mesh of a solution was graded.
#[derive(Clone, Debug)]
pub struct Graded<const S: usize> {
    /// The solution.
    pub solution: Solution<S>,
    /// The grading.
    pub depth: Depth,
    /// Kinks that have a node.
    pub breaks: Breaks,
    /// How Newton's method ended.
    pub outcome: NewtonOutcome,
}

impl<const S: usize> Graded<S> {
    /// Room for a solution.
    pub(crate) const BLANK: Self = Self {
        solution: Solution::BLANK,
        depth: Depth {
            contact_parameter: 0.0,
            bend: LARGEST_BEND,
        },
        breaks: Breaks::NONE,
        outcome: NewtonOutcome::Stalled { step: f64::INFINITY },
    };
}

impl<L, const S: usize> Adaptive<L, S> {
    /// Room to work in, to be set.
    pub(crate) const fn blank(membrane: LocalEquations<L>) -> Self {
        Self {
            equilibrium: Equilibrium::blank(membrane),
            resolution: Resolution {
                density: 0.0,
                contact_elements: 0,
                tolerance: 0.0,
                last_term: f64::INFINITY,
            },
            iterations: 0,
        }
    }
}

impl<L: Hyperelastic, const S: usize> Adaptive<L, S> {
    /// Ready to solve.
    pub fn new(membrane: LocalEquations<L>, resolution: Resolution) -> Self {
        let mut adaptive = Self::blank(membrane);
        adaptive.set(resolution);
        adaptive
    }

    /// Makes it ready to solve, as [`Adaptive::new`].
    pub(crate) fn set(&mut self, resolution: Resolution) {
        self.equilibrium.set(resolution.tolerance);
        self.resolution = resolution;
        self.iterations = 0;
    }

    fn membrane(&self) -> &LocalEquations<L> {
        &self.equilibrium.membrane
    }

    /// Turns a guess on any mesh into the state that `closure` asks for.
    ///
    /// # Errors
    /// [`Unsolved`] when Newton's method fails, or mesh and pole do not settle; the guess is then of no more use.
    pub fn settle(&mut self, guess: &mut Graded<S>, closure: &Closure) -> Result<(), Unsolved> {
        let mut refinements = 0;
        for _ in 0..MAX_ROUNDS {
            if Self::stale(guess) {
                *guess = self.relay(guess);
            }
            guess.outcome = self.equilibrium.solve(&mut guess.solution, closure);
            let NewtonOutcome::Converged { iterations, .. } = guess.outcome else {
                return Err(Unsolved::Newton(guess.outcome));
            };
            self.iterations += u64::from(iterations);
            if let Some(position) = Self::turned_edge(&guess.solution) {
                return Err(Unsolved::EdgePushes { position });
            }
            if self.membrane().curvature != 0.0 && self.pole_is_compressed(&guess.solution) {
                return Err(Unsolved::SlackOnObject);
            }
            if self.change_pole(guess) || Self::stale(guess) {
                continue;
            }
            let kinks = self.kinks(&guess.solution);
            guess.breaks = kinks;
            if Self::kinks_are_nodes(&guess.solution, &kinks) {
                if refinements == MAX_REFINEMENTS || !self.is_coarse(&guess.solution) {
                    return Ok(());
                }
                refinements += 1;
            }
            *guess = self.relay(guess);
        }
        Err(Unsolved::Unsettled)
    }

    /// The same state with a pole of the other kind, where that can help: a relaxed membrane under a plate.
    #[inline(never)] // its copies of a solution stay off the caller's stack
    pub fn with_other_pole(&self, graded: &Graded<S>) -> Option<Graded<S>> {
        // Slack lies flat.
        let relaxed =
            self.membrane().tension_field == TensionField::Relaxed && self.membrane().curvature == 0.0;
        (relaxed && graded.solution.contact_elements > 0).then(|| match graded.solution.pole {
            Pole::Taut => self.slacken(graded),
            Pole::Slack => self.lay(graded, Pole::Taut, 1.0),
        })
    }

    /// Where a contact edge is that the membrane does not pull at. The signed tension under the plate and the
    /// unsigned one of the free zone also meet with both tangents reversed, a solution of the equations that is no
    /// membrane: it obeys neither the balance at the edge nor virtual work.
    fn turned_edge(solution: &Solution<S>) -> Option<f64> {
        let [_, w] = solution.nodes[solution.contact_elements];
        (solution.contact_elements > 0 && w <= 0.0).then_some(solution.parameters[CONTACT_PARAMETER])
    }

    /// That the way ends at this state because the contact edge is about to lose its tension: the bend there is
    /// sharper than a mesh can follow.
    pub fn edge_pushes(&self, graded: &Graded<S>) -> Option<Unsolved> {
        let solution = &graded.solution;
        let plain = self.membrane().tension_field == TensionField::Plain;
        (plain && solution.contact_elements > 0 && Self::bend(solution) < VANISHING_BEND).then(|| {
            let position = solution.parameters[CONTACT_PARAMETER];
            Unsolved::EdgePushes { position }
        })
    }

    /// The length over which the tangent turns next to the contact edge, `T1 / P`, in the meridian's parameter.
    fn bend(solution: &Solution<S>) -> f64 {
        let [u, w] = solution.nodes[solution.contact_elements];
        w / (solution.parameters[PRESSURE] * u * u)
    }

    /// The grading that fits a solution.
    fn depth(solution: &Solution<S>) -> Depth {
        let contact_parameter = solution.parameters[CONTACT_PARAMETER];
        if solution.contact_elements == 0 {
            return Depth {
                contact_parameter: 0.0,
                bend: LARGEST_BEND,
            };
        }
        let bend = Self::bend(solution);
        Depth {
            contact_parameter,
            bend: if bend > 0.0 {
                bend.clamp(SMALLEST_BEND, LARGEST_BEND)
            } else {
                SMALLEST_BEND
            },
        }
    }

    /// The same solution on a fresh mesh.
    fn relay(&self, from: &Graded<S>) -> Graded<S> {
        self.lay(from, from.solution.pole, from.solution.parameters[POLE])
    }

    fn stale(graded: &Graded<S>) -> bool {
        let wanted = Self::depth(&graded.solution);
        let off = |a: f64, b: f64| a > STALE_GRADING * b || b > STALE_GRADING * a;
        graded.solution.elements() == 0
            || off(wanted.contact_parameter, graded.depth.contact_parameter)
            || off(wanted.bend, graded.depth.bend)
    }

    /// An unpressed solution on a mesh with a contact zone up to `contact_parameter`; the values stay unpressed.
    pub fn lay_contact(&self, from: &Graded<S>, contact_parameter: f64) -> Graded<S> {
        let depth = Depth {
            contact_parameter,
            bend: LARGEST_BEND,
        };
        self.lay_on(from, Pole::Taut, from.solution.parameters[POLE], depth)
    }

    /// Puts a solution on a mesh graded for it, with nodes at its breaks and the given kind of pole.
    pub fn lay(&self, from: &Graded<S>, pole: Pole, pole_parameter: f64) -> Graded<S> {
        self.lay_on(from, pole, pole_parameter, Self::depth(&from.solution))
    }

    fn lay_on(&self, from: &Graded<S>, pole: Pole, pole_parameter: f64, depth: Depth) -> Graded<S> {
        let old = &from.solution;
        let contact_parameter = depth.contact_parameter;
        let pressed = contact_parameter > 0.0;
        let start = if pole == Pole::Slack { pole_parameter } else { 0.0 };
        let mut positions = [0.0; MAX_ELEMENTS + 1];
        let mut density = self.resolution.density * if pressed { 1.0 } else { REST_FINENESS };
        let (contact_elements, free_elements) = loop {
            let mut count = 0;
            let mut take = |t: f64| {
                count += 1;
                if count <= MAX_ELEMENTS {
                    positions[count] = t;
                }
            };
            let breaks = from.breaks.positions().iter().copied();
            let mut contact_elements = 0;
            if pressed {
                let spacing = ((contact_parameter - start) / self.resolution.contact_elements as f64)
                    .min(LARGEST_SPACING / self.resolution.density);
                let mut left = start;
                let inside = breaks.clone().filter(|&t| t > start && t < contact_parameter);
                for right in inside.chain(core::iter::once(contact_parameter)) {
                    let elements = libm::ceil((right - left) / spacing - 1e-9).max(1.0) as usize;
                    for k in 1..elements {
                        take(left + (right - left) * k as f64 / elements as f64);
                    }
                    take(right);
                    contact_elements += elements;
                    left = right;
                }
            }
            let mut left = contact_parameter;
            let mut free_elements = 0;
            let inside = breaks.filter(|&t| t > contact_parameter && t < FRAC_PI_2);
            for right in inside.chain(core::iter::once(FRAC_PI_2)) {
                free_elements += depth.spread(left, right, density, &mut take);
                left = right;
            }
            if contact_elements + free_elements <= MAX_ELEMENTS {
                break (contact_elements, free_elements);
            }
            density *= 0.9;
        };
        positions[0] = start;
        let mut solution = old.clone();
        solution.pole = pole;
        solution.parameters[POLE] = pole_parameter;
        solution.contact_elements = contact_elements;
        solution.free_elements = free_elements;
        for k in 0..=contact_elements {
            solution.fractions[k] = (positions[k] - start) / (contact_parameter - start);
        }
        let zone_start = if pressed { contact_parameter } else { start };
        for k in 0..=free_elements {
            solution.fractions[contact_elements + 1 + k] =
                (positions[contact_elements + k] - zone_start) / (FRAC_PI_2 - zone_start);
        }
        old.resample(&self.equilibrium.gauss, &mut solution);
        self.cut(old, &mut solution);
        Graded {
            solution,
            depth,
            breaks: from.breaks,
            outcome: from.outcome,
        }
    }

    /// Whether the pole of a relaxed membrane came out compressed.
    fn pole_is_compressed(&self, solution: &Solution<S>) -> bool {
        self.membrane().tension_field == TensionField::Relaxed
            && solution.contact_elements > 0
            && solution.pole == Pole::Taut
            && solution.parameters[POLE] < 1.0
    }

    /// Goes over to a slack core when the pole of a relaxed membrane came out compressed.
    fn change_pole(&self, graded: &mut Graded<S>) -> bool {
        let compressed = self.pole_is_compressed(&graded.solution);
        if compressed {
            *graded = self.slacken(graded);
        }
        compressed
    }

    /// The same state with a slack core that ends where the hoop stretch passes 1.
    fn slacken(&self, graded: &Graded<S>) -> Graded<S> {
        let solution = &graded.solution;
        let contact_parameter = solution.parameters[CONTACT_PARAMETER];
        let mut edge = 0.9 * contact_parameter;
        'search: for e in 0..solution.contact_elements {
            let span = solution.span(e);
            for j in 0..S {
                if solution.stages[e][j][0] >= 1.0 {
                    edge = span.start + self.equilibrium.gauss.nodes[j] * span.length;
                    break 'search;
                }
            }
        }
        self.lay(graded, Pole::Slack, edge.min(0.9 * contact_parameter))
    }
}
