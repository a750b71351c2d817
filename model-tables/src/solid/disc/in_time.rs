//! A disc in time: a wall that may relax, under a pressure that changes step by step.
//!
//! A time step begins from the previous state, is solved for one pressure or for several in turn, and is then accepted.

use super::path::{held, touches_frame};
use super::{Clamped, DiscDesign, DiscEnd, DiscError, DiscState, FarSide, Found};
use crate::material::relaxation::Relaxation;
use crate::solid::Failure;
use crate::solid::equilibrium::SolidWall;
use crate::solid::memory::Memory;
use crate::solid::mesh::Elements;
use crate::solid::state::{Balance, State};
use core::f64::consts::PI;

/// Largest distance of a node from its predicted place after a step, over the radius. For a fingertip the same limit applies over its height.
const LARGEST_BEND: f64 = 6e-4;
/// Allowed energy error of a step, over the work done in it and over the largest work so far.
const ENERGY_TOLERANCE: [f64; 2] = [0.05, 5e-3];
/// The same while no work has been done before.
const FIRST_ENERGY_TOLERANCE: f64 = 0.4;
/// Volume, over that of the disc, from which on energies are compared: a blocked disc takes only what its contact gives way.
const MIN_VOLUME: f64 = 1e-3;
/// Largest growth of the step length from one step to the next.
const LARGEST_GROWTH: f64 = 2.0;

/// A disc in time, at the end of its latest step.
#[derive(Clone, Debug)]
pub struct DiscInTime {
    wall: SolidWall,
    plate: f64,
    length: f64,
    modulus: f64,
    /// Whether the body over the disc stores energy.
    on_foundation: bool,
    state: State,
    balance: Balance,
    anchors: Vec<f64>,
    /// Derivative of the volume by the pressure, of a state that follows at once.
    compliance: f64,
    /// Relaxed strain energy of the disc, and energy of a foundation.
    energy: f64,
    /// Work of stresses and foundation so far, and its largest value; work of the fluid so far.
    work: f64,
    most_work: f64,
    supplied: f64,
    /// Length of the latest step, seconds, and the displacements in it.
    seconds: f64,
    onward: State,
    /// The present step.
    trial: State,
    guess: State,
    of_trial: Balance,
}

/// Work in a step.
#[derive(Clone, Copy, Debug)]
pub(in crate::solid) struct StepWork {
    energy: f64,
    work: f64,
    supplied: f64,
}

impl DiscInTime {
    /// An undeformed disc without pressure, and without any past deformation. A relaxation without terms makes it elastic.
    ///
    /// # Errors
    /// As [`Disc::new`](super::Disc::new).
    pub fn new(design: &DiscDesign, relaxation: &Relaxation, elements: Elements) -> Result<Self, DiscError> {
        let Clamped {
            mut wall,
            plate,
            length,
            modulus,
        } = Clamped::new(design, elements)?;
        if !relaxation.terms().is_empty() {
            wall.memory = Some(Memory::new(&wall.mesh, relaxation));
        }
        let state = wall.undeformed();
        let tangent = wall.follow(&state, plate).ok_or(DiscError::Unsolved {
            asked: 0.0,
            failure: Failure::Singular,
        })?;
        let mut onward = state.clone();
        onward.clear();
        Ok(Self {
            compliance: wall.change(&tangent),
            wall,
            plate,
            length,
            modulus,
            on_foundation: matches!(design.far_side, FarSide::Foundation { .. }),
            trial: state.clone(),
            guess: state.clone(),
            state,
            balance: Balance::default(),
            of_trial: Balance::default(),
            anchors: Vec::new(),
            energy: 0.0,
            work: 0.0,
            most_work: 0.0,
            supplied: 0.0,
            seconds: 0.0,
            onward,
        })
    }

    /// The state at the end of the latest step. `energy` is the relaxed one, and `work` that of the stresses, elastic and lost.
    pub fn now(&self) -> DiscState {
        let found = Found {
            state: &self.state,
            balance: &self.balance,
            compliance: self.compliance,
            energy: self.energy,
            work: self.work,
        };
        found.in_units(&self.wall, self.plate, self.length, self.modulus)
    }

    /// Work so far, joules: of the fluid, and of the stresses in the disc and in its foundation. Their difference is the error in time.
    pub fn works(&self) -> [f64; 2] {
        let unit = self.modulus * self.length * self.length * self.length;
        [self.supplied, self.work].map(|work| work * unit)
    }

    /// Its radius, metres, and shear modulus, pascals: the units of what follows.
    pub(in crate::solid) fn units(&self) -> [f64; 2] {
        [self.length, self.modulus]
    }

    /// Begins a step of `seconds`, and discards the present one.
    pub(in crate::solid) fn begin(&mut self, seconds: f64) {
        if let Some(memory) = &mut self.wall.memory {
            memory.begin(seconds);
        }
        self.wall.start_sliding(&self.state, self.plate, &self.anchors);
        let ratio = if self.seconds > 0.0 {
            (seconds / self.seconds).min(LARGEST_GROWTH)
        } else {
            0.0
        };
        self.guess.copy_from(&self.state);
        self.guess.add(ratio, &self.onward);
        self.trial.copy_from(&self.guess);
    }

    /// Solves the step at hand for a pressure at its end: the volume then, and its derivative by the pressure as Newton's method needs it.
    pub(in crate::solid) fn settle(&mut self, pressure: f64) -> Result<[f64; 2], DiscEnd> {
        let found = self.wall.settle(&mut self.trial, self.plate, &held(pressure));
        self.of_trial = found.map_err(|failure| match failure {
            Failure::InsideOut => DiscEnd::WallFolds,
            _ => DiscEnd::NoFurtherState,
        })?;
        if touches_frame(&self.wall, &self.trial) {
            return Err(DiscEnd::BulgeTouchesFrame);
        }
        Ok([self.of_trial.volume, self.wall.compliance()])
    }

    /// Share of the allowed bend that the present step uses.
    pub(in crate::solid) fn share(&self) -> f64 {
        let (trial, guess) = (self.trial.nodes.as_flattened(), self.guess.nodes.as_flattened());
        let bends = trial.iter().zip(guess).map(|(x, y)| (x - y).abs());
        bends.fold(0.0, f64::max) / LARGEST_BEND
    }

    /// The work in the present step. A state in balance on another branch fails this check.
    pub(in crate::solid) fn work_of_step(&mut self) -> Option<StepWork> {
        let mut energy = self.wall.potential(&self.trial);
        if self.on_foundation {
            energy += self.of_trial.contact_energy;
        }
        let mut work = energy - self.energy;
        if let Some(memory) = &mut self.wall.memory {
            work += memory.end(&self.wall.mesh, &self.wall.material, &self.trial);
        }
        let mean = 0.5 * (self.state.fluid + self.trial.fluid);
        let supplied = mean * (self.of_trial.volume - self.balance.volume);
        let [of_step, of_all] = if self.most_work > 0.0 {
            ENERGY_TOLERANCE
        } else {
            [FIRST_ENERGY_TOLERANCE, 0.0]
        };
        let least = self.trial.fluid.abs() * MIN_VOLUME * PI * self.wall.mesh.thickness;
        let allowed = of_step * supplied.abs().max(work.abs()).max(least) + of_all * self.most_work;
        ((work - supplied).abs() <= allowed + f64::EPSILON).then_some(StepWork {
            energy,
            work,
            supplied,
        })
    }

    /// Takes the step of so many seconds as it was solved. `None` if the equations are singular there.
    pub(in crate::solid) fn take(&mut self, step: StepWork, seconds: f64) -> Option<()> {
        let tangent = self.wall.follow(&self.trial, self.plate)?;
        self.compliance = self.wall.change(&tangent);
        let (anchors, lost) = self.wall.finish_sliding(&self.trial, self.plate);
        self.anchors = anchors;
        if let Some(memory) = &mut self.wall.memory {
            memory.take();
        }
        self.energy = step.energy;
        self.work += step.work + lost;
        self.most_work = self.most_work.max(self.work);
        self.supplied += step.supplied;
        self.onward.copy_from(&self.trial);
        self.onward.add(-1.0, &self.state);
        self.state.copy_from(&self.trial);
        self.balance = self.of_trial;
        self.seconds = seconds;
        Some(())
    }
}
