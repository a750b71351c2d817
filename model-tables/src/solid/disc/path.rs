//! States of a disc in the order of the fluid's pressure. Each is solved from those before it.
//!
//! A step must pass the same checks as a step of a [press](crate::solid::path). Its state is a minimum of the energy at a held
//! pressure, it is where the previous states predict it, and the stored energy grows by the fluid's work. Steps are halved if they
//! fail, and grow while they pass easily. The pressure takes the place of the indentation: states follow it by their own factors.

use super::error::DiscEnd;
use crate::solid::Failure;
use crate::solid::equilibrium::SolidWall;
use crate::solid::mesh::CREASE;
use crate::solid::state::{Balance, Fluid, State};
use crate::solid::station::hermite;
use core::f64::consts::PI;

/// Displacement in the first step, over the thickness.
const FIRST_STEP: f64 = 0.15;
/// Largest step, moduli.
const LARGEST_STEP: f64 = 0.1;
/// Pressure of a nearly unloaded state, over that of the first step.
const HARDLY: f64 = 1e-4;
/// Smallest step, over the pressure. The path ends if it needs a smaller one.
const SMALLEST_STEP: f64 = 1e-6;
/// Largest growth of a step.
const LARGEST_GROWTH: f64 = 3.0;
/// Share of the allowed error at which a step keeps its length.
const EASY: f64 = 0.5;
/// Largest displacement of a node between prediction and solution, in thicknesses.
const LARGEST_CORRECTION: f64 = 0.1;
/// Allowed energy error of a step, over the work done in it.
const ENERGY_TOLERANCE: f64 = 2e-3;
/// The same for the first step, which is as small as the unbalanced force allows.
const FIRST_ENERGY_TOLERANCE: f64 = 5e-2;
/// Volume, over that of the disc, from which on energies are compared: a blocked disc takes only what its contact gives way.
const MIN_VOLUME: f64 = 1e-3;
/// Relative growth of the volume, over that of the pressure, from which on the pressure counts as at its greatest.
const AT_MAXIMUM: f64 = 30.0;
/// Largest number of halvings on the way to a requested state.
const MAX_HALVINGS: u32 = 12;

/// A state of the path.
#[derive(Clone, Debug)]
pub(super) struct Kept {
    pub(super) state: State,
    pub(super) balance: Balance,
    /// Derivative of the state by the pressure.
    tangent: State,
    /// Derivative of the volume by the pressure.
    pub(super) compliance: f64,
    /// Anchors of its points on the touching body; empty without friction.
    anchors: Vec<f64>,
    /// Energy of the disc and of the contact.
    pub(super) energy: f64,
    /// Work of the fluid since the undeformed state, less the work of friction.
    pub(super) work: f64,
}

impl Kept {
    fn pressure(&self) -> f64 {
        self.state.fluid
    }
}

/// Why a state is not the next state of the path.
#[derive(Clone, Copy, Debug)]
enum Rejected {
    Failed(Failure),
    TouchesFrame,
    Elsewhere,
}

/// Why there is no state.
#[derive(Clone, Copy, Debug)]
pub(super) enum Stop {
    /// The path ends before it, at this pressure.
    Ends(f64, DiscEnd),
    Failed(Failure),
}

/// The equation of a held pressure.
pub(super) fn held(pressure: f64) -> Fluid {
    Fluid {
        by_volume: 0.0,
        volume: 0.0,
        by_pressure: 1.0,
        pressure,
    }
}

/// The states of a disc, the undeformed one first.
#[derive(Clone, Debug)]
pub(super) struct Path {
    stations: Vec<Kept>,
    /// Height of the body over the disc.
    plate: f64,
    /// The first step, and the next.
    first: f64,
    step: f64,
    ends_by: Option<DiscEnd>,
}

impl Path {
    /// The undeformed state alone. `None` if it has no stiffness.
    pub(super) fn new(wall: &mut SolidWall, plate: f64) -> Option<Self> {
        let state = wall.undeformed();
        let tangent = wall.follow(&state, plate)?;
        let fastest = tangent.nodes.as_flattened().iter().map(|x| x.abs());
        let fastest = fastest.fold(0.0, f64::max);
        let step = (FIRST_STEP * wall.mesh.thickness / fastest).min(LARGEST_STEP);
        Some(Self {
            first: step,
            step,
            stations: vec![Kept {
                state,
                balance: Balance::default(),
                compliance: wall.change(&tangent),
                tangent,
                anchors: Vec::new(),
                energy: 0.0,
                work: 0.0,
            }],
            plate,
            ends_by: None,
        })
    }

    pub(super) fn plate(&self) -> f64 {
        self.plate
    }

    fn last(&self) -> &Kept {
        &self.stations[self.stations.len() - 1]
    }

    /// The state at a pressure.
    pub(super) fn at(&mut self, wall: &mut SolidWall, pressure: f64) -> Result<Kept, Stop> {
        if let Some((last, ends_by)) = self.end(wall, pressure)
            && last < pressure
        {
            return Err(Stop::Ends(last, ends_by));
        }
        let after = self.stations.partition_point(|kept| kept.pressure() < pressure);
        let above = self.stations[after].clone();
        if above.pressure() <= pressure {
            return Ok(above);
        }
        let mut below = self.stations[after - 1].clone();
        let mut halvings = 0;
        // Solves for the requested state. If it is not found, solves for a state half way before it first.
        let mut target = pressure;
        // The energy error allowed up to the next state of the path is allowed up to here.
        let whole = above.work - below.work;
        loop {
            let guess = between(&below, &above, target);
            match self.solve(wall, &below, target, &guess, Some(whole)) {
                Ok((kept, _)) if target >= pressure => return Ok(kept),
                Ok((kept, _)) => {
                    below = kept;
                    target = pressure;
                }
                Err(_) if halvings < MAX_HALVINGS => {
                    halvings += 1;
                    target = 0.5 * (below.pressure() + target);
                }
                Err(Rejected::Failed(failure)) => return Err(Stop::Failed(failure)),
                Err(Rejected::TouchesFrame | Rejected::Elsewhere) => {
                    return Err(Stop::Failed(Failure::Elsewhere));
                }
            }
        }
    }

    /// The pressure at the end of the path, and the reason. `None` if the end is above the given pressure.
    pub(super) fn end(&mut self, wall: &mut SolidWall, highest: f64) -> Option<(f64, DiscEnd)> {
        while self.ends_by.is_none() && (self.stations.len() == 1 || self.last().pressure() < highest) {
            self.extend(wall);
        }
        self.ends_by.map(|ends_by| (self.last().pressure(), ends_by))
    }

    /// The next state of the path, or its end.
    fn extend(&mut self, wall: &mut SolidWall) {
        loop {
            let last = self.last();
            let next = last.pressure() + self.step;
            match self.solve(wall, last, next, &self.beyond(next), None) {
                Ok((kept, strain)) => {
                    let growth = libm::sqrt(EASY / strain.max(1e-3)).min(LARGEST_GROWTH);
                    self.step = (self.step * growth).min(LARGEST_STEP);
                    if self.stations.len() == 1 && self.plate <= wall.mesh.thickness {
                        self.lie(wall, &kept);
                    }
                    self.stations.push(kept);
                    return;
                }
                Err(rejected) => {
                    self.step *= 0.5;
                    if self.step < SMALLEST_STEP * (next - self.step).max(self.first) {
                        self.ends_by = Some(reason(wall, self.last(), rejected));
                        return;
                    }
                }
            }
        }
    }

    /// A face that only touches what is over it follows as if it were free. The slopes of one that is hardly loaded, [`HARDLY`] of this state's
    /// pressure, hold down to no load; of this state itself, where there is no such one.
    fn lie(&mut self, wall: &mut SolidWall, loaded: &Kept) {
        let mut guess = self.stations[0].state.clone();
        guess.add(-HARDLY, &self.stations[0].state);
        guess.add(HARDLY, &loaded.state);
        let pressure = HARDLY * loaded.pressure();
        let hardly = self.solve(wall, &self.stations[0], pressure, &guess, Some(loaded.work));
        let slopes = hardly.as_ref().map_or(loaded, |(kept, _)| kept);
        self.stations[0].tangent = slopes.tangent.clone();
        self.stations[0].compliance = slopes.compliance;
    }

    /// A guess beyond the last state: the parabola with its value and slope, through the one before.
    fn beyond(&self, pressure: f64) -> State {
        let count = self.stations.len();
        let last = &self.stations[count - 1];
        let step = pressure - last.pressure();
        let mut guess = last.state.clone();
        guess.add(step, &last.tangent);
        if count > 1 {
            let before = &self.stations[count - 2];
            let back = last.pressure() - before.pressure();
            let ratio = (step / back) * (step / back);
            guess.add(ratio, &before.state);
            guess.add(-ratio, &last.state);
            guess.add(ratio * back, &last.tangent);
        }
        guess
    }

    /// Solves from a guess for the state after another one, and checks it. The allowed energy error is a share of `scale`, or
    /// of the work done since. Returns the state, and the share of the allowed error that it uses.
    fn solve(
        &self,
        wall: &mut SolidWall,
        below: &Kept,
        pressure: f64,
        guess: &State,
        scale: Option<f64>,
    ) -> Result<(Kept, f64), Rejected> {
        let mut state = guess.clone();
        wall.start_sliding(&below.state, self.plate, &below.anchors);
        let balance = wall
            .settle(&mut state, self.plate, &held(pressure))
            .map_err(Rejected::Failed)?;
        if touches_frame(wall, &state) {
            return Err(Rejected::TouchesFrame);
        }
        let tangent = wall
            .follow(&state, self.plate)
            .ok_or(Rejected::Failed(Failure::Singular))?;
        let (anchors, dissipated) = wall.finish_sliding(&state, self.plate);
        let compliance = wall.change(&tangent);
        let step = pressure - below.pressure();
        // P dV is d(PV) - V dP: a trapezium with the slopes of both ends, of fourth order.
        let (first, last) = (below.balance.volume, balance.volume);
        let moved = pressure * last - below.pressure() * first;
        // The response from the undeformed state is linear.
        let bent = if below.pressure() > 0.0 {
            step / 12.0 * (below.compliance - compliance)
        } else {
            0.0
        };
        let done = moved - step * (0.5 * (first + last) + bent) - dissipated;
        let energy = wall.potential(&state) + balance.contact_energy;
        let missing = (energy - below.energy - done).abs();
        let tolerance = if below.pressure() > 0.0 {
            ENERGY_TOLERANCE
        } else {
            FIRST_ENERGY_TOLERANCE
        };
        let least = step * MIN_VOLUME * PI * wall.mesh.thickness;
        let allowed = tolerance * scale.unwrap_or(done).abs().max(least);
        let corrections = guess.nodes.as_flattened().iter().zip(state.nodes.as_flattened());
        let corrected = corrections.map(|(guess, found)| (guess - found).abs());
        let corrected = corrected.fold(0.0, f64::max) / wall.mesh.thickness;
        let strain = (missing / allowed).max(corrected / LARGEST_CORRECTION);
        if strain.is_nan() || strain > 1.0 || !wall.is_stable(&held(pressure)) {
            return Err(Rejected::Elsewhere);
        }
        let kept = Kept {
            work: below.work + done,
            state,
            balance,
            tangent,
            compliance,
            anchors,
            energy,
        };
        Ok((kept, strain))
    }
}

/// Cubic of Hermite between two states.
fn between(below: &Kept, above: &Kept, pressure: f64) -> State {
    let step = above.pressure() - below.pressure();
    let w = hermite((pressure - below.pressure()) / step);
    let mut guess = below.state.clone();
    guess.clear();
    guess.add(w[0], &below.state);
    guess.add(w[1], &above.state);
    guess.add(step * w[2], &below.tangent);
    guess.add(step * w[3], &above.tangent);
    guess
}

/// Whether the outer face has crossed the frame. The crease at the rim is ignored.
pub(super) fn touches_frame(wall: &SolidWall, state: &State) -> bool {
    let mesh = &wall.mesh;
    let crease = CREASE * mesh.thickness;
    (0..mesh.stations()).any(|station| {
        let node = mesh.node(station, mesh.layers() - 1);
        let [radius, height] = state.nodes[node];
        mesh.nodes[node][0] < 1.0 - crease && radius > 1.0 && height < mesh.thickness
    })
}

/// Why a path has no state after this one.
fn reason(wall: &SolidWall, last: &Kept, rejected: Rejected) -> DiscEnd {
    let growth = last.compliance * last.pressure() / last.balance.volume;
    match rejected {
        Rejected::TouchesFrame => DiscEnd::BulgeTouchesFrame,
        Rejected::Failed(Failure::InsideOut) => DiscEnd::WallFolds,
        Rejected::Failed(_) | Rejected::Elsewhere if growth > AT_MAXIMUM => DiscEnd::PressureMaximum,
        Rejected::Failed(_) | Rejected::Elsewhere if wall.softens(&last.state) => DiscEnd::MaterialSoftens,
        Rejected::Failed(_) | Rejected::Elsewhere => DiscEnd::NoFurtherState,
    }
}
