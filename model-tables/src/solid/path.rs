//! The path of a press from rest: states in balance, each solved from those before it.
//!
//! **Why there may be two states at one indentation.** A thin dome under a flat plate first lies flat against it. From an
//! indentation of about two wall thicknesses on, it can also buckle: the middle of the contact lifts off, inwards, and the plate
//! touches along a ring (Updike and Kalnins, "Axisymmetric postbuckling and nonsymmetric buckling of a spherical shell compressed
//! between rigid plates", J. Appl. Mech. 39 (1972) 172). Both are minima of the energy, on every mesh, so the dimple is not a
//! discretisation error. A long step of Newton's method may end in either. A press from rest stays flat as long as that state
//! exists.
//!
//! **Checks of a step.** The state must be a minimum of the energy (no negative pivot, see [`SolidWall::is_stable`]). It must be
//! where the previous states predict it, to `LARGEST_CORRECTION`. The stored energy must grow by the work of plate and fluid, to
//! `ENERGY_TOLERANCE`. A state of another branch, or one with the pole folded in, is in equilibrium but fails these checks; then
//! the step is halved. Steps grow while they pass easily.
//!
//! **Reproducibility.** The path's indentations depend only on the design and the mesh, and a requested state is solved from its
//! two neighbours on the path. The result therefore has the same bits, whatever other states are requested.

use super::Failure;
use super::equilibrium::{SolidWall, Tangent};
use super::section::{self, ContactEdge};
use super::state::{Balance, Fluid, State};
use super::station::{Kept, WallPoint, between, force, hermite, work};
use crate::limit::EndsBy;

/// The first step, over the height.
const FIRST_STEP: f64 = 4e-3;
/// Largest step, over the height.
const LARGEST_STEP: f64 = 0.035;
/// Smallest step, over the height. The path ends if no state is found within it.
const SMALLEST_STEP: f64 = 1e-5;
/// Accuracy of the end of a press at the base, over the height.
const LIMIT_TOLERANCE: f64 = 1e-7;
/// Largest growth of a step.
const LARGEST_GROWTH: f64 = 3.0;
/// Share of the allowed error at which a step keeps its length.
const EASY: f64 = 0.5;
/// Largest displacement of a node between prediction and solution, in walls. The states of a dome that lies flat and one that has buckled are
/// further apart than that wherever both last.
pub(super) const LARGEST_CORRECTION: f64 = 0.1;
/// Allowed energy error of a step, over the work done in it.
const ENERGY_TOLERANCE: f64 = 5e-3;
/// The same in the first step, where the contact is smaller than an element and its force no power of the indentation.
const FIRST_ENERGY_TOLERANCE: f64 = 0.2;
/// Largest number of halvings on the way to a requested state.
const MAX_HALVINGS: usize = 12;

/// Why a state is not the next state of the path.
#[derive(Clone, Copy, Debug)]
enum Rejected {
    Failed(Failure),
    Touches(EndsBy),
    /// The state is in balance, but on another branch, or too far from the last state to decide.
    Elsewhere,
}

/// Why there is no state.
#[derive(Clone, Copy, Debug)]
pub enum Stop {
    /// The press ends before it.
    Ends(EndsBy),
    /// The state was not found between two states of the path, of which this is the first.
    Failed {
        /// The last indentation found.
        reached: f64,
        /// The failure of the solver.
        failure: Failure,
    },
}

/// The states of a press, the rest state first.
#[derive(Clone, Debug)]
pub struct Path {
    stations: Vec<WallPoint>,
    /// Height of the outer pole at rest.
    height: f64,
    /// The next step.
    step: f64,
    /// Steps that keep their length, after one that failed.
    cautious: u32,
    ends_by: Option<EndsBy>,
    /// The state being solved.
    work: State,
    guess: State,
}

impl Path {
    /// The rest state alone.
    pub fn new(rest: State, volume: f64, energy: f64, height: f64) -> Self {
        // There is no contact yet.
        let mut tangent = rest.clone();
        tangent.clear();
        Self {
            work: rest.clone(),
            guess: rest.clone(),
            stations: vec![WallPoint {
                kept: Kept {
                    indentation: 0.0,
                    balance: Balance {
                        volume,
                        ..Balance::default()
                    },
                    contact: ContactEdge::default(),
                    anchors: Vec::new(),
                    energy,
                    work: energy,
                    state: rest,
                },
                tangent: Tangent {
                    state: tangent,
                    force: 0.0,
                },
            }],
            step: FIRST_STEP * height,
            height,
            cautious: 0,
            ends_by: None,
        }
    }

    fn last(&self) -> &WallPoint {
        &self.stations[self.stations.len() - 1]
    }

    /// The rest state.
    pub fn rest(&self) -> &Kept {
        &self.stations[0].kept
    }

    /// The state at an indentation.
    ///
    /// # Errors
    /// [`Stop`].
    pub fn at(&mut self, wall: &mut SolidWall, fluid: &Fluid, indentation: f64) -> Result<Kept, Stop> {
        while self.last().kept.indentation < indentation {
            if let Err(ends_by) = self.extend(wall, fluid) {
                let end = &self.last().kept;
                // The end itself, in other units and back.
                return if indentation <= end.indentation * (1.0 + 4.0 * f64::EPSILON) {
                    Ok(end.clone())
                } else {
                    Err(Stop::Ends(ends_by))
                };
            }
        }
        let after = self
            .stations
            .partition_point(|station| station.kept.indentation < indentation);
        if self.stations[after].kept.indentation <= indentation {
            return Ok(self.stations[after].kept.clone());
        }
        let (mut below, above) = (self.stations[after - 1].clone(), self.stations[after].clone());
        // The state asked for, and before it those on the way there that turn out to be needed.
        let mut targets = vec![indentation];
        loop {
            let target = targets[targets.len() - 1];
            let asked = targets.len() == 1;
            self.interpolate(&below, &above, target);
            let found = self.balance(wall, fluid, &below, target).and_then(|balance| {
                // The energy error allowed up to the next state of the path is allowed up to here.
                let whole = above.kept.work - below.kept.work;
                if asked {
                    let [_, stiffness] = between(&below, &above, target, force);
                    let (kept, _) =
                        self.check(wall, fluid, &below, target, balance, stiffness, Some(whole))?;
                    return Ok((kept, None));
                }
                let tangent = wall.tangent(fluid).ok_or(Rejected::Failed(Failure::Singular))?;
                let (kept, _) =
                    self.check(wall, fluid, &below, target, balance, tangent.force, Some(whole))?;
                Ok((kept, Some(tangent)))
            });
            match found {
                Ok((kept, None)) => return Ok(kept),
                Ok((kept, Some(tangent))) => {
                    targets.pop();
                    below = WallPoint { kept, tangent };
                }
                Err(_) if targets.len() <= MAX_HALVINGS => {
                    targets.push(0.5 * (below.kept.indentation + target));
                }
                Err(rejected) => {
                    return Err(Stop::Failed {
                        reached: below.kept.indentation,
                        failure: match rejected {
                            Rejected::Failed(failure) => failure,
                            Rejected::Touches(_) | Rejected::Elsewhere => Failure::Elsewhere,
                        },
                    });
                }
            }
        }
    }

    /// The end of the press: the last state, and why there is none after it.
    pub fn end(&mut self, wall: &mut SolidWall, fluid: &Fluid) -> (&Kept, EndsBy) {
        let ends_by = loop {
            if let Err(ends_by) = self.extend(wall, fluid) {
                break ends_by;
            }
        };
        (&self.last().kept, ends_by)
    }

    /// The next state of the path.
    fn extend(&mut self, wall: &mut SolidWall, fluid: &Fluid) -> Result<(), EndsBy> {
        if let Some(ends_by) = self.ends_by {
            return Err(ends_by);
        }
        loop {
            let last = self.last().clone();
            let next = last.kept.indentation + self.step;
            self.predict(next);
            let found = self.balance(wall, fluid, &last, next).and_then(|balance| {
                let tangent = wall.tangent(fluid).ok_or(Rejected::Failed(Failure::Singular))?;
                let (kept, strain) = self.check(wall, fluid, &last, next, balance, tangent.force, None)?;
                Ok((WallPoint { kept, tangent }, strain))
            });
            match found {
                Ok((station, strain)) => {
                    if self.cautious == 0 {
                        let growth = libm::sqrt(EASY / strain.max(1e-3)).min(LARGEST_GROWTH);
                        self.step = (self.step * growth).min(LARGEST_STEP * self.height);
                    } else if self.cautious < u32::MAX {
                        self.cautious -= 1;
                    }
                    self.stations.push(station);
                    return Ok(());
                }
                Err(rejected) => {
                    self.step *= 0.5;
                    self.cautious = 2;
                    let (floor, ends_by) = match rejected {
                        Rejected::Touches(ends_by) => {
                            self.cautious = u32::MAX;
                            (LIMIT_TOLERANCE, ends_by)
                        }
                        Rejected::Failed(Failure::InsideOut) => (SMALLEST_STEP, EndsBy::WallFolds),
                        Rejected::Failed(_) | Rejected::Elsewhere => (SMALLEST_STEP, EndsBy::NoFurtherState),
                    };
                    if self.step < floor * self.height {
                        let touches = matches!(rejected, Rejected::Touches(_));
                        let softens = !touches && wall.softens(&last.kept.state);
                        let ends_by = if softens { EndsBy::MaterialSoftens } else { ends_by };
                        self.ends_by = Some(ends_by);
                        return Err(ends_by);
                    }
                }
            }
        }
    }

    /// A guess for the state at an indentation beyond the last: the parabola with its value and slope, through the one before.
    fn predict(&mut self, indentation: f64) {
        let count = self.stations.len();
        let WallPoint { kept: last, tangent } = &self.stations[count - 1];
        let step = indentation - last.indentation;
        self.guess.copy_from(&last.state);
        self.guess.add(step, &tangent.state);
        // From the rest state the first touch is between.
        if count > 2 {
            let before = &self.stations[count - 2].kept;
            let back = last.indentation - before.indentation;
            let ratio = (step / back) * (step / back);
            self.guess.add(ratio, &before.state);
            self.guess.add(-ratio, &last.state);
            self.guess.add(ratio * back, &tangent.state);
        }
    }

    /// A guess for a state between two.
    fn interpolate(&mut self, below: &WallPoint, above: &WallPoint, indentation: f64) {
        let from = below.kept.indentation;
        let step = above.kept.indentation - from;
        let x = (indentation - from) / step;
        // There is no contact at rest, so there is no slope.
        let w = if from > 0.0 {
            hermite(x)
        } else {
            [1.0 - x, x, 0.0, 0.0]
        };
        self.guess.clear();
        self.guess.add(w[0], &below.kept.state);
        self.guess.add(w[1], &above.kept.state);
        self.guess.add(step * w[2], &below.tangent.state);
        self.guess.add(step * w[3], &above.tangent.state);
    }

    /// Solves from the guess, above the base; friction goes on from the state below.
    fn balance(
        &mut self,
        wall: &mut SolidWall,
        fluid: &Fluid,
        below: &WallPoint,
        indentation: f64,
    ) -> Result<Balance, Rejected> {
        if indentation >= self.height {
            return Err(Rejected::Touches(EndsBy::WallTouchesBase));
        }
        self.work.copy_from(&self.guess);
        let from = &below.kept;
        wall.start_sliding(&from.state, self.height - from.indentation, &from.anchors);
        let balance = wall
            .settle(&mut self.work, self.height - indentation, fluid)
            .map_err(Rejected::Failed)?;
        match section::touches_base(wall, &self.work) {
            Some(ends_by) => Err(Rejected::Touches(ends_by)),
            None => Ok(balance),
        }
    }

    /// Holds the state in work to what it must pass after one of the path; its energy may miss a part of `scale`, or of the work done since. Beside
    /// the state: how much of what is allowed it takes.
    #[expect(
        clippy::too_many_arguments,
        reason = "two states, and what is known of the second"
    )]
    fn check(
        &self,
        wall: &mut SolidWall,
        fluid: &Fluid,
        below: &WallPoint,
        indentation: f64,
        balance: Balance,
        stiffness: f64,
        scale: Option<f64>,
    ) -> Result<(Kept, f64), Rejected> {
        let plate = self.height - indentation;
        let (anchors, dissipated) = wall.finish_sliding(&self.work, plate);
        let mut kept = Kept {
            indentation,
            anchors,
            contact: section::contact_edge(wall, &self.work, plate),
            energy: wall.energy(&self.work) + balance.contact_energy,
            state: self.work.clone(),
            balance,
            work: below.kept.work,
        };
        let done = work(below, &kept, stiffness, fluid) - dissipated;
        kept.work += done;
        let missing = (kept.energy - below.kept.energy - done).abs();
        let allowed = if below.kept.indentation > 0.0 {
            ENERGY_TOLERANCE
        } else {
            FIRST_ENERGY_TOLERANCE
        } * scale.unwrap_or(done).abs();
        let corrected = corrected(&self.guess, &self.work) / wall.mesh.thickness;
        let strain = (missing / allowed).max(corrected / LARGEST_CORRECTION);
        if strain > 1.0 || !wall.is_stable(fluid) {
            return Err(Rejected::Elsewhere);
        }
        Ok((kept, strain))
    }
}

/// Largest displacement of a node between two states, over the radial semi-axis.
pub(super) fn corrected(guess: &State, found: &State) -> f64 {
    let nodes = guess.nodes.as_flattened().iter().zip(found.nodes.as_flattened());
    nodes
        .map(|(guess, found)| (guess - found).abs())
        .fold(0.0, f64::max)
}
