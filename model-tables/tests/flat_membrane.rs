//! The clamped flat membrane in the membrane model: Hencky's membrane at small strains, the very thin solid disc, and the fluid's work.

use model_tables::material::Law;
use model_tables::material::preset::AGILUS30;
use model_tables::membrane::disc::{FlatMembrane, FlatMembraneError};
use model_tables::object::Friction;
use model_tables::solid::disc::{DISC, Disc, DiscDesign, FarSide};

#[path = "common/hencky.rs"]
mod hencky;
use hencky::Hencky;

const DIAMETER: f64 = 9e-3;
const RADIUS: f64 = 4.5e-3;

/// Young's modulus of the law at no strain is three times its shear modulus, `2 (C1 + C2)`.
#[test]
fn at_small_strains_it_is_henckys_membrane() {
    let hencky = Hencky::new(0.5);
    assert!((hencky.first() - 1.845).abs() < 0.01, "{}", hencky.first());
    let mut off = 0.0_f64;
    for (law, young) in [
        (Law::NeoHookean { c1: 1e5 }, 6e5),
        (AGILUS30, 6.0 * (160_355.0 + 46_559.0)),
    ] {
        for thickness in [0.01e-3, 0.1e-3] {
            for strain in [1e-4, 0.003, 0.01] {
                let load = hencky.load(strain);
                let mut membrane = FlatMembrane::new(DIAMETER, thickness, law).expect("a membrane");
                let state = membrane
                    .at_pressure(load * young * thickness / RADIUS)
                    .expect("a state");
                let deflection = hencky.deflection(load) * RADIUS;
                off = off.max((state.height / deflection - 1.0).abs());
                assert!(((state.pole_stretch - 1.0) / strain - 1.0).abs() < 0.05);
                assert!((state.edge_radius / RADIUS - 1.0).abs() < 1e-9);
            }
        }
    }
    println!("membrane against Hencky: deflection {:.2} %", 100.0 * off);
    assert!(off < 0.02);
}

/// `dE = P dV`, by Simpson's rule over the volume from one pressure to another.
#[test]
fn the_fluids_work_is_the_strain_energy() {
    let mut membrane = FlatMembrane::new(DIAMETER, 0.2e-3, AGILUS30).expect("a membrane");
    let mut at = |pressure: f64| membrane.at_pressure(pressure).expect("a state");
    for pressure in [1e3, 10e3, 40e3] {
        let [low, middle, high] = [0.99, 1.0, 1.01].map(|factor| at(factor * pressure));
        let work = (high.volume - low.volume) * (low.pressure + 4.0 * middle.pressure + high.pressure) / 6.0;
        assert!(((high.energy - low.energy) / work - 1.0).abs() < 1e-4, "{work}");
    }
}

/// Beyond small strains the solid is the truth: a disc of 1/200 of its radius hardly bends.
#[test]
fn a_very_thin_solid_disc_is_the_membrane() {
    let thickness = RADIUS / 200.0;
    let design = DiscDesign {
        diameter: DIAMETER,
        thickness,
        law: AGILUS30,
        far_side: FarSide::Free,
        friction: Friction::NONE,
    };
    let mut solid = Disc::new(&design, DISC).expect("a disc");
    let mut membrane = FlatMembrane::new(DIAMETER, thickness, AGILUS30).expect("a membrane");
    let (solid, membrane) = (
        solid.at_pressure(1e3).expect("a state"),
        membrane.at_pressure(1e3).expect("a state"),
    );
    assert!(membrane.pole_stretch > 1.03);
    assert!((solid.travel / membrane.height - 1.0).abs() < 0.01);
    assert!((solid.volume / membrane.volume - 1.0).abs() < 0.01);
}

/// A neo-Hookean sheet has a greatest pressure; half of what is just below it is answered, what is above is refused with that pressure.
#[test]
fn no_state_is_made_up() {
    let mut membrane = FlatMembrane::new(DIAMETER, 0.2e-3, Law::NeoHookean { c1: 1e5 }).expect("a membrane");
    let Err(FlatMembraneError::BeyondMaximum { greatest, .. }) = membrane.at_pressure(1e6) else {
        panic!("refused with the maximum")
    };
    assert!(membrane.at_pressure(0.999 * greatest).is_ok());
    assert!(membrane.at_pressure(1.01 * greatest).is_err());
    for asked in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            membrane.at_pressure(asked),
            Err(FlatMembraneError::NotAPressure { .. })
        ));
    }
    for (diameter, thickness) in [(0.0, 1e-3), (9e-3, -1e-3), (f64::NAN, 1e-3)] {
        assert!(matches!(
            FlatMembrane::new(diameter, thickness, AGILUS30),
            Err(FlatMembraneError::NotAMembrane)
        ));
    }
}
