//! The haptic loop against brute force: the fluid's volume counted, state by state.

use model_tables::design::{Design, Membrane, RestBy};
use model_tables::material::Law;
use model_tables::model::Kind;
use model_tables::model::feedback::{Loop, LoopError};
use model_tables::object::{Friction, Object};
use model_tables::solid::disc::{DISC, Disc, DiscDesign, FarSide};
use model_tables::solid::gas::TrappedGas;
use model_tables::solid::press::{COARSE, Press};

const AGILUS30: Law = Law::MooneyRivlin {
    c1: 160_355.0,
    c2: 46_559.0,
};

fn printed(compliance: f64) -> Design {
    Design {
        membrane: Membrane {
            radial_semi_axis: 9e-3,
            axial_semi_axis: 7e-3,
            thickness: 1e-3,
        },
        law: AGILUS30,
        rest: RestBy::Unstretched,
        compliance,
        object: Object::PLATE,
    }
}

fn actuator(far_side: FarSide, law: Law, thickness: f64) -> Disc {
    let design = DiscDesign {
        diameter: 9e-3,
        thickness,
        law,
        far_side,
        friction: Friction::NONE,
    };
    Disc::new(&design, DISC).expect("a disc")
}

/// Bisects the compliance of a fingertip alone until the volume that has left it is what the actuator, the tubing and 20 mm^3 of air have taken at its
/// pressure: air at twice the absolute pressure has half its volume.
#[test]
fn the_volume_is_where_brute_force_finds_it() {
    let tubing = 0.2e-12;
    let (air, ambient) = (20e-9, 101_325.0);
    let mut off = 0.0_f64;
    for far_side in [FarSide::Free, FarSide::Plate { gap: 0.3e-3 }] {
        for indentation in [0.5e-3, 2e-3] {
            let mut disc = actuator(far_side, AGILUS30, 1e-3);
            let mut at = |compliance: f64| {
                let mut press = Press::new(&printed(compliance), COARSE).expect("at rest");
                let state = press.at_indentation(indentation).expect("a state");
                let taken = disc.at_pressure(state.pressure).expect("a state").volume;
                let left = press.rest().volume - state.volume;
                let smaller = air - air * ambient / (ambient + state.pressure);
                (left - taken - tubing * state.pressure - smaller, taken, state)
            };
            let (mut low, mut high) = (tubing, 10e-12);
            for _ in 0..45 {
                let middle = 0.5 * (low + high);
                if at(middle).0 < 0.0 {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            let (_, taken, brute) = at(0.5 * (low + high));
            let mut haptic = Loop::new(
                Kind::Solid(COARSE),
                &printed(tubing),
                actuator(far_side, AGILUS30, 1e-3),
            )
            .expect("at rest")
            .with_gas(TrappedGas { volume: air, ambient });
            let found = haptic.at_indentation(indentation).expect("a state");
            for (found, brute) in [
                (found.volume_moved, taken),
                (found.touch.pressure_rise, brute.pressure_rise),
                (found.touch.force, brute.force),
            ] {
                off = off.max((found / brute - 1.0).abs());
            }
        }
    }
    println!("loop against brute force: {off:.1e}");
    assert!(off < 1e-6, "{off:.1e}");
}

/// Held on every side an actuator takes no fluid: the tip is the one alone, and the force is the pressure on the free area.
#[test]
fn a_blocked_actuator_leaves_the_tip_alone() {
    let blocked = actuator(FarSide::Plate { gap: 0.0 }, AGILUS30, 1e-3);
    let mut haptic = Loop::new(Kind::Solid(COARSE), &printed(0.0), blocked).expect("at rest");
    let state = haptic.at_indentation(2e-3).expect("a state");
    let alone = Press::new(&printed(0.0), COARSE)
        .expect("at rest")
        .at_indentation(2e-3)
        .expect("a state");
    assert!((state.touch.force / alone.force - 1.0).abs() < 2e-3);
    let passed_on = state.touch.pressure_rise * core::f64::consts::PI * 4.5e-3 * 4.5e-3;
    assert!((state.actuator.force / passed_on - 1.0).abs() < 0.01);
    let rest = haptic.at_indentation(0.0).expect("at rest");
    assert!(rest.transmission().is_none() && rest.volume_moved == 0.0);
}

/// A soft thin actuator with nothing over it takes whatever the tip gives until it stands no more.
#[test]
fn what_cannot_balance_is_refused_with_the_reason() {
    let soft = actuator(FarSide::Free, Law::NeoHookean { c1: 200.0 }, 0.1e-3);
    let mut haptic = Loop::new(Kind::Solid(COARSE), &printed(0.0), soft).expect("at rest");
    let refused = haptic.at_indentation(3e-3);
    assert!(
        matches!(refused, Err(LoopError::NoBalance { failed: Some(_), .. })),
        "{refused:?}"
    );
}

/// A free disc of 0.05 mm: fingertips of some compliances on the way have no state 3 mm deep, and the loop has one. Its end is one number,
/// whatever was asked, and no state lies beyond it.
#[test]
fn the_end_of_a_loop_depends_on_nothing_but_the_design() {
    let thin = || {
        let disc = actuator(FarSide::Free, AGILUS30, 0.05e-3);
        Loop::new(Kind::Solid(COARSE), &printed(0.0), disc).expect("at rest")
    };
    let limit = thin().limit().expect("an end");
    assert!(limit.indentation > 3e-3, "{limit:?}");
    for (before, asked) in [(None, 1.05), (Some(3.4e-3), 1.2)] {
        let mut haptic = thin();
        if let Some(before) = before {
            haptic.at_indentation(before).expect("a state");
        }
        let asked = asked * limit.indentation;
        let refused = haptic.at_indentation(asked).expect_err("beyond");
        let told = haptic.explained(refused, asked);
        let LoopError::BeyondLimit { limit: end, .. } = told else {
            panic!("{told:?}")
        };
        assert!((end - limit.indentation).abs() < 1e-15, "{end}");
    }
    let mut haptic = thin();
    haptic
        .at_indentation(limit.indentation)
        .expect("the end is a state");
    let state = haptic.at_indentation(3e-3).expect("a state");
    // Both share the fluid: what the tip alone has lost, the disc has taken.
    let taken = state.volume_moved / state.touch.pressure_rise;
    assert!((taken / state.compliance - 1.0).abs() < 1e-6, "{taken:e}");
}

const SKIN: FarSide = FarSide::Foundation {
    gap: 0.0,
    stiffness: 20e6,
};

/// The compliance at rest is the volume of a small pressure over that pressure; what is out of reach changes nothing of it.
#[test]
fn the_compliance_at_rest_is_that_of_a_small_pressure() {
    let over = |far_side: FarSide| {
        let mut disc = actuator(far_side, AGILUS30, 1e-3);
        let at_rest = disc.at_pressure(0.0).expect("at rest").compliance;
        let small = disc.at_pressure(0.1).expect("a state");
        println!(
            "{far_side:?}: {at_rest:e} at rest, {:e} at 0.1 Pa",
            small.volume / 0.1
        );
        assert!(
            (at_rest / (small.volume / 0.1) - 1.0).abs() < 1e-4,
            "{far_side:?}"
        );
        at_rest
    };
    over(SKIN);
    let free = over(FarSide::Free);
    for gap in [0.01e-3, 0.1e-3, 0.2e-3] {
        let gapped = over(FarSide::Plate { gap });
        assert!((gapped / free - 1.0).abs() < 1e-9, "{gap}");
    }
}

/// The volume that has left the fingertip is the actuator's at that pressure, at every indentation from a touch of a tenth of a millimetre on: to
/// a hundred-thousandth, as the actuator's compliances are.
#[test]
fn no_fluid_is_lost_at_any_indentation() {
    let mut off = 0.0_f64;
    for far_side in [SKIN, FarSide::Free, FarSide::Plate { gap: 0.2e-3 }] {
        let mut haptic = Loop::new(
            Kind::Solid(COARSE),
            &printed(0.0),
            actuator(far_side, AGILUS30, 1e-3),
        )
        .expect("at rest");
        let mut disc = actuator(far_side, AGILUS30, 1e-3);
        for step in 5..=100 {
            let state = haptic.at_indentation(f64::from(step) * 0.02e-3).expect("a state");
            let volume = disc.at_pressure(state.actuator.pressure).expect("a state").volume;
            off = off.max((state.volume_moved / volume - 1.0).abs());
        }
        println!("{far_side:?}: volume off by at most {off:.1e}");
    }
    assert!(off < 1e-5, "{off:.1e}");
}
