use super::*;
use crate::material::Law;
use crate::material::relaxation::Term;
use crate::solid::batch::{Batch, Stiffness};
use crate::solid::element::first_invariant;
use crate::solid::mesh::{CUBIC_PRESSURES, Elements, NODES, PRESSURES};

const LAWS: [Law; 2] = [
    Law::MooneyRivlin { c1: 0.3, c2: 0.2 },
    Law::Yeoh {
        c1: 0.5,
        c2: 0.2,
        c3: -0.05,
    },
];

fn series() -> Relaxation {
    let term = |time, weight| Term { time, weight };
    Relaxation::new(&[term(0.1, 3.0), term(2.0, 0.7)], 20.0, 0.0)
}

/// Stretched, bent and sheared, by so much.
fn bent(mesh: &Mesh, by: f64) -> State {
    let bend = |[r, z]: [f64; 2]| [r + by * (0.1 * r + 0.1 * r * z), z + by * (0.2 * r * r - 0.1 * z)];
    State {
        nodes: mesh.nodes.iter().map(|x| bend(*x)).collect(),
        pressures: vec![[0.0; CUBIC_PRESSURES]; mesh.points.len()],
        fluid: 0.0,
    }
}

#[test]
fn what_is_remembered_is_no_pressure_and_is_nothing_at_rest() {
    for law in LAWS {
        let material = Material::new(law, false);
        let undeformed = deviatoric_stress(&material, [1.0, 0.0, 1.0, 0.0, 1.0]);
        assert!(undeformed.iter().all(|x| x.abs() < 1e-15), "{undeformed:?}");
        // Of determinant 1: in the plane 1.2 * 0.9 + 0.1 * 0.2.
        let hoop = 1.0 / 1.1;
        let deformation = [1.2, 0.1, hoop, -0.2, 0.9];
        let (s, c) = (deviatoric_stress(&material, deformation), strain(deformation));
        let along = s[0] * c[0] + 2.0 * s[1] * c[1] + s[2] * c[2] + s[3] * c[3];
        assert!(
            first_invariant(deformation) > 3.1 && along.abs() < 1e-13,
            "{along}"
        );
    }
}

/// In the second step after another: central differences of the forces.
#[test]
fn stiffness_is_the_derivative_of_the_forces() {
    for law in LAWS {
        let mesh = Mesh::new(0.8, 0.2, Elements { through: 2, along: 3 });
        let material = Material::new(law, false);
        let mut memory = Memory::new(&mesh, &series());
        memory.begin(0.05);
        memory.end(&mesh, &material, &bent(&mesh, 0.5));
        memory.take();
        memory.begin(0.2);
        let state = bent(&mesh, 1.0);
        for (b, batch) in Batch::<NODES, PRESSURES>::all(&mesh, 1.0).iter().enumerate() {
            let none = [[0.0; CUBIC_PRESSURES]; LANES];
            let held = Some(memory.held(b));
            let mut stiffness = Stiffness::default();
            batch.stiffness(&material, &state.nodes, &none, held, &mut stiffness);
            let lane = batch.count - 1;
            for j in 0..NODES {
                for c in 0..2 {
                    let [below, above] = [-1e-5, 1e-5].map(|by| {
                        let mut nodes = state.nodes.clone();
                        nodes[batch.nodes[lane][j]][c] += by;
                        batch.forces(&material, &nodes, &none, held)
                    });
                    for i in 0..NODES {
                        let found = match c {
                            0 => [stiffness.radial[i.min(j)][i.max(j)], stiffness.mixed[j][i]],
                            _ => [stiffness.mixed[i][j], stiffness.axial[i.min(j)][i.max(j)]],
                        };
                        for (row, found) in found.iter().enumerate() {
                            let slope = (above.nodes[row][i].0[lane] - below.nodes[row][i].0[lane]) / 2e-5;
                            let found = found.0[lane];
                            assert!(
                                (slope - found).abs() < 1e-6 * (1.0 + found.abs()),
                                "{slope} {found}"
                            );
                        }
                    }
                }
            }
        }
    }
}

/// Stretched in no time the memory bears `g(0) - 1` times the relaxed stress, and after a long time at rest nothing.
#[test]
fn a_stretch_is_borne_and_forgotten() {
    let mesh = Mesh::new(0.8, 0.2, Elements { through: 2, along: 3 });
    let material = Material::new(LAWS[0], false);
    let mut memory = Memory::new(&mesh, &series());
    let state = bent(&mesh, 1.0);
    let borne = |memory: &Memory| -> Vec<[f64; 2]> {
        let points = memory.points.iter().flatten();
        let sum = |point: &Point| point.terms.iter().map(|term| term[0]).sum();
        points.map(|point| [sum(point), point.stress[0]]).collect()
    };
    memory.begin(0.0);
    memory.end(&mesh, &material, &state);
    memory.take();
    for [sum, relaxed] in borne(&memory) {
        assert!((sum - 3.7 * relaxed).abs() < 1e-12, "{sum} {relaxed}");
    }
    memory.begin(200.0);
    memory.end(&mesh, &material, &state);
    memory.take();
    for [sum, _] in borne(&memory) {
        assert!(sum.abs() < 1e-12, "{sum}");
    }
}
