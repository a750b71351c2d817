//! What a state of the printed fingertip costs with more and more elements, and what they gain.

use model_tables::curve::Contact;
use model_tables::design::{Design, Membrane, RestBy};
use model_tables::model::ModelError;
use model_tables::model::choice::REFINED;
use model_tables::object::Object;
use model_tables::solid::SolidError;
use model_tables::solid::mesh::Elements;
use model_tables::solid::press::Press;
use std::time::Instant;

/// The printed fingertip: outer semi-axes 9 and 7 mm, wall 1 mm, Agilus30, unstretched.
pub const PRINTED: Design = Design {
    membrane: Membrane {
        radial_semi_axis: 9e-3,
        axial_semi_axis: 7e-3,
        thickness: 1e-3,
    },
    law: model_tables::material::preset::AGILUS30,
    rest: RestBy::Unstretched,
    compliance: 0.0,
    object: Object::PLATE,
};
/// Elements through the wall and along the meridian, the refined last.
pub const MESHES: [[usize; 2]; 8] = [
    [1, 24],
    [1, 48],
    [1, 96],
    [2, 24],
    [2, 48],
    [2, 60],
    [2, 96],
    [3, 96],
];
/// States of a sweep.
pub const STATES: usize = 25;
/// From one to the next, metres.
pub const STEP: f64 = 1e-4;
/// Sweeps of which the fastest counts.
const SWEEPS: usize = 5;

/// One mesh.
#[derive(Clone, Copy, Debug)]
pub struct Cost {
    /// Its elements.
    pub elements: Elements,
    /// Time of a state, each from those before it, seconds.
    pub seconds: f64,
    /// Newton iterations per state.
    pub iterations: f64,
    /// Largest relative error of force or pressure against the refined mesh.
    pub error: f64,
}

/// Every state of a press, shallowest first.
///
/// # Errors
/// [`SolidError`] of a state.
pub fn sweep(press: &mut Press) -> Result<Vec<Contact>, SolidError> {
    (1..=STATES).map(|k| press.contact_at(STEP * k as f64)).collect()
}

/// Solves the printed fingertip with every mesh.
///
/// # Errors
/// [`ModelError`] of a state.
pub fn measure() -> Result<Vec<Cost>, ModelError> {
    let mut costs = Vec::new();
    let mut truth: Vec<Contact> = Vec::new();
    // The refined first.
    for [through, along] in MESHES.into_iter().rev() {
        let elements = Elements { through, along };
        let rest = Press::new(&PRINTED, elements)?;
        let (mut seconds, mut iterations, mut found) = (f64::INFINITY, 0, Vec::new());
        for _ in 0..SWEEPS {
            let mut press = rest.clone();
            let start = Instant::now();
            found = sweep(&mut press)?;
            seconds = seconds.min(start.elapsed().as_secs_f64());
            iterations = press.iterations() - rest.iterations();
        }
        if elements == REFINED {
            truth.clone_from(&found);
        }
        let error = found
            .iter()
            .zip(&truth)
            .map(|(found, truth)| {
                let force = (found.force / truth.force - 1.0).abs();
                force.max((found.pressure_rise / truth.pressure_rise - 1.0).abs())
            })
            .fold(0.0, f64::max);
        costs.push(Cost {
            elements,
            seconds: seconds / STATES as f64,
            iterations: iterations as f64 / STATES as f64,
            error,
        });
    }
    costs.reverse();
    Ok(costs)
}
