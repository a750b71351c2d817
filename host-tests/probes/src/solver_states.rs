//! The states of the full model that the chip solves for comparison with the host: a pre-stretched fingertip at rest, pressed,
//! and pressed a little further. In `f64`, like all of the model, and no part of the signal path.

use model_tables::design::{Design, Membrane, RestBy};
use model_tables::material::Law;
use model_tables::membrane::TensionField;
use model_tables::membrane::press::workspace::Workspace;
use model_tables::membrane::press::{MembraneError, Press, SWEEP};
use model_tables::object::Object;

/// Gauss points an element, those of the sweep mesh.
pub const STAGES: usize = 5;

/// What the chip keeps a press in.
pub type Room = Workspace<Law, STAGES>;

const MILLIMETRE: f64 = 1e-3;

/// `model-tables/designs/paper-prestretched.toml`: the chip reads no files.
pub const DESIGN: Design = Design {
    membrane: Membrane {
        radial_semi_axis: 4.5 * MILLIMETRE,
        axial_semi_axis: 2.7 * MILLIMETRE,
        thickness: 1.0 * MILLIMETRE,
    },
    law: Law::MooneyRivlin {
        c1: 160_355.0,
        c2: 46_559.0,
    },
    rest: RestBy::PoleStretch(2.3),
    compliance: 0.0,
    object: Object::PLATE,
};

/// Metres. The first is reached from rest, over states in between; the second from its neighbour.
pub const INDENTATIONS: [f64; 2] = [1.0 * MILLIMETRE, 1.05 * MILLIMETRE];

/// How many states there are.
pub const LENGTH: usize = 1 + INDENTATIONS.len();

/// A state as the chip sends it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolverState {
    /// Pressure at rest, and its rise in the pressed states, pascals.
    pub pressure: f64,
    /// Newtons.
    pub force: f64,
    /// Newton iterations that this state took.
    pub iterations: u64,
}

impl SolverState {
    /// Bytes on the wire.
    pub const BYTES: usize = 24;

    /// Three little-endian words: pressure, force, iterations.
    pub fn to_bytes(self) -> [u8; Self::BYTES] {
        let words = [self.pressure.to_bits(), self.force.to_bits(), self.iterations];
        let mut bytes = [0; Self::BYTES];
        for (bytes, word) in bytes.chunks_exact_mut(8).zip(words) {
            bytes.copy_from_slice(&word.to_le_bytes());
        }
        bytes
    }

    /// The inverse of [`SolverState::to_bytes`].
    pub fn from_bytes(bytes: [u8; Self::BYTES]) -> Self {
        let [pressure, force, iterations] =
            core::array::from_fn(|i| u64::from_le_bytes(core::array::from_fn(|k| bytes[8 * i + k])));
        Self {
            pressure: f64::from_bits(pressure),
            force: f64::from_bits(force),
            iterations,
        }
    }
}

/// The rest state, and the press that goes on from it.
///
/// # Errors
/// As [`Workspace::inflate`].
#[inline(never)] // its stack is free again for the next
pub fn rest(room: &mut Room) -> Result<(SolverState, &mut Press<Law, STAGES>), MembraneError> {
    let Design {
        membrane,
        rest,
        compliance,
        ..
    } = DESIGN;
    let press = room.inflate(&membrane, rest, compliance, TensionField::Relaxed, SWEEP)?;
    let state = SolverState {
        pressure: press.rest().pressure,
        force: 0.0,
        iterations: press.iterations(),
    };
    Ok((state, press))
}

/// A pressed state.
///
/// # Errors
/// As [`Press::contact_at`].
#[inline(never)]
pub fn pressed(press: &mut Press<Law, STAGES>, indentation: f64) -> Result<SolverState, MembraneError> {
    let before = press.iterations();
    let contact = press.contact_at(indentation)?;
    Ok(SolverState {
        pressure: contact.pressure_rise,
        force: contact.force,
        iterations: press.iterations() - before,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_survives_the_wire() {
        let state = SolverState {
            pressure: 1.5,
            force: -0.1,
            iterations: 7,
        };
        let bytes = state.to_bytes();
        assert_eq!(bytes[..8], [0, 0, 0, 0, 0, 0, 0xf8, 0x3f]);
        assert_eq!(bytes[16..], [7, 0, 0, 0, 0, 0, 0, 0]);
        assert_eq!(SolverState::from_bytes(bytes), state);
    }
}
