//! A press in time: a wall that relaxes, under a plate that presses, holds and retracts.
//!
//! The plate's travel, or its force, is given at instants and is linear between them. Each interval is divided into steps short
//! enough that every point of the wall moves nearly linearly in each, as `memory` assumes; there is no other approximation in time.
//! With an actuator, fluid moves between the two, and both are solved in each step. A plate cannot pull. If the wall recovers more
//! slowly than the plate retracts, contact is lost, and the wall moves alone around its fluid until the plate touches it again.

mod error;
mod outlet;
mod step;

pub use error::HistoryError;

use super::Failure;
use super::disc::{DiscEnd, DiscInTime, DiscState, StepWork};
use super::equilibrium::SolidWall;
use super::memory::Memory;
use super::mesh::Elements;
use super::press;
use super::state::{Balance, Fluid, State};
use crate::design::{Design, RestBy};
use crate::limit::EndsBy;
use crate::material::Hyperelastic as _;
use crate::material::relaxation::Relaxation;
use crate::object::Friction;
use crate::solid::gas::TrappedGas;
use outlet::Outlet;

/// Largest travel of a plate near the wall in a step, over the height.
const LARGEST_TRAVEL: f64 = 2.5e-3;
/// Largest distance of a node from where a step is expected to lead it, over the height. Its way within the step bends by less than a quarter of
/// this.
const LARGEST_BEND: f64 = 6e-4;
/// Travel of the first step that leads to the wall, over the largest: the contact is then smaller than an element, and smaller still it is lost
/// in the energy's tolerance.
const FIRST_TRAVEL: f64 = 1.0 / 16.0;
/// The first step after the plate's speed has changed in contact: its travel over the largest, its length in time over the step before. The fast
/// terms of the series follow a turn at once, also where the plate then stands still.
const AFTER_TURN: f64 = 1.0 / 64.0;
/// Largest growth of the step length from one step to the next.
const LARGEST_GROWTH: f64 = 2.0;
/// Smallest change of speed, over the larger of both speeds, after which the motion counts as new.
const TURN: f64 = 0.3;
/// Travel, over the height, in which no next state is found where there is none.
const SMALLEST_TRAVEL: f64 = 1e-6;
/// Largest number of halvings of a step that fails.
const MAX_HALVINGS: u32 = 24;
/// Largest number of steps of one interval, including refused ones. A press of the whole height needs a fifth of them.
const MAX_STEPS: u32 = 2_000;
/// Allowed energy error of a step, over the work done in it and over the largest work so far.
const ENERGY_TOLERANCE: [f64; 2] = [0.05, 5e-3];
/// The same for the first step, in which the contact is smaller than an element.
const FIRST_ENERGY_TOLERANCE: f64 = 0.4;
/// Accuracy of a given force, relative.
const FORCE_TOLERANCE: f64 = 1e-6;
/// Newton iterations for a given force.
const FORCE_ITERATIONS: usize = 30;

/// The given quantity at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drive {
    /// The plate's travel from first touch of the untouched wall, metres; negative: above it.
    Indentation(f64),
    /// The force on the plate, newtons, >= 0; without one the plate just does not touch.
    Force(f64),
}

/// An instant of a press.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instant {
    /// The plate's travel, metres.
    pub indentation: f64,
    /// Pressure over that of the untouched wall, pascals. Below zero where the wall recovers.
    pub pressure_rise: f64,
    /// Force on the plate, newtons.
    pub force: f64,
    /// Downward displacement of the pole of the outer surface, metres.
    pub apex_depression: f64,
}

impl Instant {
    /// Whether the plate touches.
    pub fn in_contact(&self) -> bool {
        self.force > 0.0
    }
}

/// Why a step was not taken.
#[derive(Clone, Copy)]
enum Rejected {
    Failed(Failure),
    Touches(EndsBy),
    /// The actuator has no state.
    Actuator(DiscEnd),
    /// The step is too long, by this factor.
    TooLong(f64),
}

/// A step as it was solved.
struct Solved {
    indentation: f64,
    balance: Balance,
    /// Share of the allowed error that it uses.
    share: f64,
    /// Strain energy of the wall at its end.
    energy: f64,
    /// Work of the wall's stresses in it, and what the fluid carried out.
    work: f64,
    /// Of the actuator.
    of_actuator: Option<StepWork>,
}

/// A press in time, at its latest instant. Lengths in outer radial semi-axes, stresses in relaxed shear moduli.
#[derive(Clone, Debug)]
pub struct History {
    wall: SolidWall,
    fluid: Fluid,
    /// Volume of all the fluid.
    whole: f64,
    /// The volumes into which the fluid moves, if there are any.
    outlet: Option<Box<Outlet>>,
    /// Outer radial semi-axis, metres.
    length: f64,
    /// Relaxed shear modulus, pascals.
    modulus: f64,
    /// Height of the outer pole at rest.
    height: f64,
    time: f64,
    state: State,
    indentation: f64,
    force: f64,
    /// How the wall goes on: with the plate where that holds it, by the tangent of the latest state; with time where it is free, by the
    /// displacements in the latest step.
    onward: State,
    /// Length of the latest step, seconds.
    seconds: f64,
    /// Limit of the next step.
    next: Next,
    /// Speed of the plate, or rate of its force, in the latest interval.
    speed: f64,
    /// Relaxed strain energy of the wall.
    energy: f64,
    /// Work of the wall's stresses and of the fluid that left so far, and its largest value.
    work: f64,
    most_work: f64,
    /// Work of the plate so far.
    supplied: f64,
    /// Volume of the fluid inside.
    volume: f64,
    steps: u64,
    trial: State,
    guess: State,
}

/// What the next step may be at most.
#[derive(Clone, Copy, Debug)]
struct Next {
    seconds: f64,
    travel: f64,
}

impl History {
    /// The untouched wall, which has always been so, at a time in seconds, with the plate at an indentation of at most 0, metres. The
    /// semi-axes of `design.membrane` are those of the outer surface.
    ///
    /// # Errors
    /// [`HistoryError::Inflated`], [`HistoryError::Compliant`], [`HistoryError::NoStiffness`], [`HistoryError::Friction`],
    /// [`HistoryError::Object`].
    pub fn new(
        design: &Design,
        relaxation: &Relaxation,
        elements: Elements,
        time: f64,
        indentation: f64,
    ) -> Result<Self, HistoryError> {
        if design.compliance > 0.0 {
            return Err(HistoryError::Compliant);
        }
        Self::closed(design, relaxation, elements, time, indentation)
    }

    /// The same with an undeformed actuator, gas in the line, and the design's compliance.
    ///
    /// # Errors
    /// As [`History::new`], but for the compliance.
    pub fn with_actuator(
        design: &Design,
        relaxation: &Relaxation,
        elements: Elements,
        [time, indentation]: [f64; 2],
        actuator: DiscInTime,
        gas: TrappedGas,
    ) -> Result<Self, HistoryError> {
        let mut history = Self::closed(design, relaxation, elements, time, indentation)?;
        let (length, modulus) = (history.length, history.modulus);
        let outlet = Outlet::new(actuator, gas, design.compliance, length, modulus);
        history.outlet = Some(Box::new(outlet));
        Ok(history)
    }

    fn closed(
        design: &Design,
        relaxation: &Relaxation,
        elements: Elements,
        time: f64,
        indentation: f64,
    ) -> Result<Self, HistoryError> {
        if design.rest != RestBy::Unstretched {
            return Err(HistoryError::Inflated);
        }
        if design.object.friction != Friction::NONE {
            return Err(HistoryError::Friction);
        }
        let modulus = design.law.shear_modulus();
        if modulus.is_nan() || modulus <= 0.0 {
            return Err(HistoryError::NoStiffness(modulus));
        }
        let length = design.membrane.radial_semi_axis;
        let mut wall = SolidWall::new(
            design.membrane.axial_semi_axis / length,
            design.membrane.thickness / length,
            design.law.stiffened(1.0 / modulus),
            elements,
        );
        wall.memory = Some(Memory::new(&wall.mesh, relaxation));
        let state = wall.undeformed();
        let surface = press::surface(&design.object, &wall, &state, length).map_err(HistoryError::Object)?;
        wall.touch(surface, design.object.friction);
        let mut onward = state.clone();
        onward.clear();
        let height = state.nodes[wall.mesh.layers() - 1][1];
        let volume = wall.volume(&state);
        Ok(Self {
            fluid: Fluid {
                by_volume: 1.0,
                volume,
                by_pressure: 0.0,
                pressure: 0.0,
            },
            whole: volume,
            volume,
            outlet: None,
            energy: wall.energy(&state),
            wall,
            length,
            modulus,
            height,
            time,
            trial: state.clone(),
            guess: state.clone(),
            state,
            indentation: indentation.min(0.0) / length,
            force: 0.0,
            onward,
            seconds: 0.0,
            next: Next {
                seconds: f64::INFINITY,
                travel: FIRST_TRAVEL * LARGEST_TRAVEL * height,
            },
            speed: 0.0,
            work: 0.0,
            most_work: 0.0,
            supplied: 0.0,
            steps: 0,
        })
    }

    /// Steps of time so far.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// The actuator at the latest instant, if there is one.
    pub fn actuator(&self) -> Option<DiscState> {
        Some(self.outlet.as_ref()?.disc.now())
    }

    /// Work at the actuator so far, joules, as [`DiscInTime::works`].
    pub fn actuator_works(&self) -> Option<[f64; 2]> {
        Some(self.outlet.as_ref()?.disc.works())
    }

    /// Work so far, joules: of the plate, and of the stresses in the wall, elastic and lost, with what the fluid carried out. Their difference is the
    /// error in time.
    pub fn works(&self) -> [f64; 2] {
        let unit = self.modulus * self.length * self.length * self.length;
        [self.supplied, self.work].map(|work| work * unit)
    }

    /// Newton iterations so far.
    pub fn iterations(&self) -> u64 {
        self.wall.iterations
    }

    /// Factorisations so far.
    pub fn factorisations(&self) -> u64 {
        self.wall.factorisations
    }

    /// The latest instant.
    pub fn now(&self) -> Instant {
        Instant {
            indentation: self.indentation * self.length,
            pressure_rise: self.state.fluid * self.modulus,
            force: self.force * self.modulus * self.length * self.length,
            apex_depression: (self.height - self.apex(&self.state)) * self.length,
        }
    }

    /// Advances to a time in seconds. `drive` gives the plate at that time; its motion until then is linear.
    ///
    /// # Errors
    /// [`HistoryError`]; the history is then of no further use.
    pub fn advance(&mut self, time: f64, drive: Drive) -> Result<Instant, HistoryError> {
        let (begin, whole) = (self.time, time - self.time);
        if whole.is_nan() || whole <= 0.0 {
            return Err(HistoryError::NotAfter {
                asked: time,
                before: begin,
            });
        }
        let (from, to) = match drive {
            Drive::Indentation(metres) => (self.indentation, metres / self.length),
            Drive::Force(newtons) => (self.force, newtons / (self.modulus * self.length * self.length)),
        };
        let speed = (to - from) / whole;
        if (speed - self.speed).abs() > TURN * speed.abs().max(self.speed.abs()) {
            let largest = LARGEST_TRAVEL * self.height;
            if self.force > 0.0 {
                self.next.travel = AFTER_TURN * largest;
                self.next.seconds = self.next.seconds.min(AFTER_TURN * self.seconds);
            } else {
                self.next.travel = FIRST_TRAVEL * largest;
            }
        }
        self.speed = speed;
        let (mut done, mut tried) = (0.0, 0);
        while done < 1.0 {
            let mut halvings = 0;
            let mut seconds = self.proposal(drive, (1.0 - done) * whole);
            loop {
                // The last step ends on the instant.
                let end = if seconds >= (1.0 - done) * whole * (1.0 - 1e-9) {
                    1.0
                } else {
                    done + seconds / whole
                };
                let target = if end < 1.0 { from + end * (to - from) } else { to };
                tried += 1;
                if tried > MAX_STEPS {
                    let now = self.now();
                    return Err(HistoryError::TooManySteps {
                        time: self.time,
                        indentation: now.indentation,
                        force: now.force,
                        steps: MAX_STEPS,
                    });
                }
                match self.step((end - done) * whole, drive, target) {
                    Ok(solved) => {
                        self.take(&solved, (end - done) * whole)
                            .ok_or_else(|| self.ends(Rejected::Failed(Failure::Singular)))?;
                        done = end;
                        self.time = begin + done * whole;
                        break;
                    }
                    Err(rejected) => {
                        halvings += 1;
                        let travel = (end - done) * (to - from).abs();
                        let moves = matches!(drive, Drive::Indentation(_)) && travel > 0.0;
                        let stuck = moves && travel < SMALLEST_TRAVEL * self.height;
                        if halvings > MAX_HALVINGS || stuck && !matches!(rejected, Rejected::TooLong(_)) {
                            return Err(self.ends(rejected));
                        }
                        seconds *= match rejected {
                            Rejected::TooLong(by) => (0.8 / libm::sqrt(by)).clamp(0.1, 0.7),
                            _ => 0.5,
                        };
                    }
                }
            }
        }
        self.time = time;
        Ok(self.now())
    }

    fn ends(&self, rejected: Rejected) -> HistoryError {
        let (time, indentation) = (self.time, self.indentation * self.length);
        match rejected {
            Rejected::Touches(by) => HistoryError::Ends {
                time,
                indentation,
                by,
            },
            Rejected::Actuator(by) => HistoryError::Actuator {
                time,
                pressure: self.state.fluid * self.modulus,
                by,
            },
            Rejected::Failed(failure) => HistoryError::Unsolved {
                time,
                indentation,
                failure,
            },
            Rejected::TooLong(_) => HistoryError::Unsolved {
                time,
                indentation,
                failure: Failure::Elsewhere,
            },
        }
    }

    /// The length of the next step, seconds, with so much left of the interval: a whole part of it.
    fn proposal(&self, drive: Drive, left: f64) -> f64 {
        let mut seconds = self.next.seconds;
        if matches!(drive, Drive::Indentation(_)) && self.speed.abs() > 0.0 {
            // Well above the wall the plate does nothing.
            let gap = (self.height - self.indentation - self.top(&self.state)).max(0.0);
            seconds = seconds.min((self.next.travel + 0.5 * gap) / self.speed.abs());
        }
        let parts = libm::ceil(left / seconds * (1.0 - 1e-9)).max(1.0);
        left / parts
    }

    /// Height of the highest node of the outer surface: beside the pole where that is pressed in.
    fn top(&self, state: &State) -> f64 {
        let mesh = &self.wall.mesh;
        let heights =
            (0..mesh.stations()).map(|station| state.nodes[mesh.node(station, mesh.layers() - 1)][1]);
        heights.fold(f64::NEG_INFINITY, f64::max)
    }

    /// Height of the outer pole.
    fn apex(&self, state: &State) -> f64 {
        state.nodes[self.wall.mesh.layers() - 1][1]
    }
}
