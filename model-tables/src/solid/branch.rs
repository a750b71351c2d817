//! States in balance that are not on the path of a press: those of a thin dome that buckles inwards, see [`super::path`].
//!
//! The search starts from a few guesses. Everything that it finds is a state in balance. If it finds none, there may still be one.

use super::equilibrium::SolidWall;
use super::section;
use super::state::{Balance, Fluid, State};
use super::station::Kept;

/// How much of the cap beyond the plate is mirrored in it, part by part: all of it where bending has no stiffness (Pogorelov, "Bendings of surfaces
/// and stability of shells", 1988), less in a wall that has.
const MIRRORED: [f64; 5] = [0.25, 0.35, 0.5, 0.7, 1.0];
/// Beyond a state that is no minimum of the energy, the way from the path's state to it once more, this many times.
const BEYOND: [f64; 2] = [4.0, 8.0];
/// Smallest relative difference of force or pressure at which two states at one indentation count as different.
const DISTINCT: f64 = 5e-3;
/// Energy of a state over that of the path's, from which on it is none of a press: elements fold onto themselves.
const MAX_ENERGY: f64 = 2.0;

/// A state beside the path.
pub(super) struct Beside {
    pub(super) state: State,
    pub(super) balance: Balance,
    /// Whether it is a minimum of the energy, in which a wall can stay. Otherwise it is the crest between two minima.
    pub(super) is_stable: bool,
}

/// A state beside the path's at the same height of the plate, if one is found: a stable one, or else one that is not.
pub(super) fn beside(
    wall: &mut SolidWall,
    fluid: &Fluid,
    rest: &State,
    kept: &Kept,
    plate: f64,
) -> Option<Beside> {
    let mut crest = None;
    for part in MIRRORED {
        let Some(found) = settle(wall, fluid, kept, plate, mirror(wall, rest, kept, plate, part)) else {
            continue;
        };
        if found.is_stable {
            return Some(found);
        }
        for part in BEYOND {
            let mut guess = found.state.clone();
            guess.add(part, &found.state);
            guess.add(-part, &kept.state);
            let beyond = settle(wall, fluid, kept, plate, guess);
            if let Some(beyond) = beyond.filter(|beyond| beyond.is_stable) {
                return Some(beyond);
            }
        }
        crest = Some(found);
    }
    crest
}

/// The state that a guess converges to. `None` if that is the state of the path.
fn settle(wall: &mut SolidWall, fluid: &Fluid, kept: &Kept, plate: f64, mut state: State) -> Option<Beside> {
    let balance = wall.settle(&mut state, plate, fluid).ok()?;
    let distinct = |a: f64, b: f64| (a - b).abs() > DISTINCT * a.abs().max(b.abs());
    let is_other = distinct(balance.force, kept.balance.force) || distinct(state.fluid, kept.state.fluid);
    let energy = wall.energy(&state) + balance.contact_energy;
    let is_of_press = energy < MAX_ENERGY * kept.energy && section::touches_base(wall, &state).is_none();
    (is_other && is_of_press).then(|| Beside {
        is_stable: wall.is_stable(fluid),
        state,
        balance,
    })
}

/// A state with a part of the cap that the plate has pressed flat pushed on, away from it.
fn mirror(wall: &SolidWall, rest: &State, kept: &Kept, plate: f64, part: f64) -> State {
    let (stride, layers) = (wall.mesh.stride(), wall.mesh.layers());
    let mut state = kept.state.clone();
    let stations = state.nodes.chunks_exact_mut(stride);
    for (nodes, rest) in stations.zip(rest.nodes.chunks_exact(stride)) {
        let beyond = rest[layers - 1][1] - plate;
        for node in &mut nodes[..layers] {
            node[1] -= part * beyond.max(0.0);
        }
    }
    state
}
