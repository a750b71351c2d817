//! The clamped disc against closed forms, series and energy balances: Kirchhoff's plate, Hencky's membrane, a blocked disc, a foundation.

use core::f64::consts::PI;
use model_tables::material::Law;
use model_tables::object::Friction;
use model_tables::solid::disc::{DISC, Disc, DiscDesign, DiscEnd, DiscError, DiscState, FarSide};
use model_tables::solid::mesh::Elements;

#[path = "common/hencky.rs"]
mod hencky;
use hencky::Hencky;

const C1: f64 = 1e5;
const LAW: Law = Law::NeoHookean { c1: C1 };
const AGILUS30: Law = Law::MooneyRivlin {
    c1: 160_355.0,
    c2: 46_559.0,
};
/// Young's modulus of an incompressible law: `6 C1`.
const YOUNG: f64 = 6.0 * C1;

fn disc(thickness: f64, law: Law, far_side: FarSide) -> DiscDesign {
    DiscDesign {
        diameter: 9e-3,
        thickness,
        law,
        far_side,
        friction: Friction::NONE,
    }
}

fn at(design: &DiscDesign, elements: Elements, pressure: f64) -> DiscState {
    let mut disc = Disc::new(design, elements).expect("a disc");
    disc.at_pressure(pressure).expect("a state")
}

/// `w = P a^4 / (64 D)`, `D = E t^3 / (12 (1 - nu^2))` with `nu = 1/2`, and the volume `pi a^2 w / 3` of that shape.
#[test]
fn a_thin_disc_that_hardly_bends_is_kirchhoffs_plate() {
    let radius = 4.5e-3_f64;
    let mut off = [0.0_f64; 3];
    for ratio in [40.0, 100.0] {
        let thickness = radius / ratio;
        let stiffness = YOUNG * thickness.powi(3) / 9.0;
        for part in [0.02, 0.1] {
            let deflection = part * thickness;
            let pressure = 64.0 * stiffness * deflection / radius.powi(4);
            let state = at(&disc(thickness, LAW, FarSide::Free), DISC, pressure);
            let volume = PI * radius * radius * deflection / 3.0;
            off[0] = off[0].max((state.travel / deflection - 1.0).abs());
            off[1] = off[1].max((state.volume / volume - 1.0).abs());
            off[2] = off[2].max((state.energy / state.work - 1.0).abs());
            assert!(state.force == 0.0 && state.contact_radius == 0.0);
        }
    }
    let [travel, volume, energy] = off.map(|off| 100.0 * off);
    println!("plate: deflection {travel:.2} %, volume {volume:.2} %, energy {energy:.3} %");
    assert!(travel < 1.0 && volume < 1.0 && energy < 0.5);
}

/// Hencky's first coefficient at Poisson's ratios 0.2, 0.3, 0.4: as printed by Fichter (NASA TP 3658, 1997, table 1).
#[test]
fn henckys_series_has_the_printed_coefficients() {
    for (poisson, printed) in [(0.2, 1.6827), (0.3, 1.7244), (0.4, 1.7769)] {
        assert!(
            (Hencky::new(poisson).first() - printed).abs() < 1e-4,
            "{}",
            Hencky::new(poisson).first()
        );
    }
}

#[test]
fn a_very_thin_disc_is_henckys_membrane() {
    let radius = 4.5e-3;
    let thickness = radius / 400.0;
    let hencky = Hencky::new(0.5);
    let mut off = [0.0_f64; 2];
    for strain in [0.003, 0.01] {
        let load = hencky.load(strain);
        let pressure = load * YOUNG * thickness / radius;
        let state = at(&disc(thickness, LAW, FarSide::Free), DISC, pressure);
        let deflection = hencky.deflection(load) * radius;
        off[0] = off[0].max((state.travel / deflection - 1.0).abs());
        off[1] = off[1].max((state.energy / state.work - 1.0).abs());
    }
    let [travel, energy] = off.map(|off| 100.0 * off);
    println!("solid at a 1/400 of its radius against Hencky: deflection {travel:.2} %, energy {energy:.3} %");
    assert!(travel < 2.0 && energy < 0.5);
}

/// Held on every side, an incompressible disc passes the pressure on, moves nowhere and takes no fluid: `F = P pi a^2`.
#[test]
fn a_blocked_disc_passes_the_pressure_on() {
    for thickness in [0.2e-3, 1e-3, 2e-3] {
        for pressure in [1e3, 17.9e3, 100e3] {
            let state = at(
                &disc(thickness, AGILUS30, FarSide::Plate { gap: 0.0 }),
                DISC,
                pressure,
            );
            let force = pressure * PI * 4.5e-3 * 4.5e-3;
            assert!((state.force / force - 1.0).abs() < 0.01);
            assert!(state.volume < 1e-4 * thickness * PI * 4.5e-3 * 4.5e-3);
            assert!((state.centre_stretch - 1.0).abs() < 1e-3);
        }
    }
}

/// A foundation so soft that it hardly takes part sees the free disc's shape: its force is its stiffness times the volume under that, as
/// the outer face of a thin disc displaces what the inner one does. One so stiff that nothing bends is a plate.
#[test]
fn a_foundation_is_free_where_soft_and_blocked_where_stiff() {
    let (thickness, pressure) = (0.1e-3, 50.0);
    let free = at(&disc(thickness, AGILUS30, FarSide::Free), DISC, pressure);
    let on = |stiffness: f64| {
        let far_side = FarSide::Foundation { gap: 0.0, stiffness };
        at(&disc(thickness, AGILUS30, far_side), DISC, pressure)
    };
    let soft = on(10.0);
    assert!((soft.travel / free.travel - 1.0).abs() < 1e-3);
    assert!(
        (soft.force / (10.0 * free.volume) - 1.0).abs() < 0.005,
        "{} {}",
        soft.force,
        10.0 * free.volume
    );
    let stiff = on(1e12);
    assert!((stiff.force / (pressure * PI * 4.5e-3 * 4.5e-3) - 1.0).abs() < 0.01);
    let between = on(pressure / free.travel);
    assert!(between.travel < free.travel && between.force < stiff.force && between.force > soft.force);
}

/// Up to the plate a disc is free; then it bears on it, and the fluid's work is in the disc and in nothing else.
#[test]
fn a_disc_bears_on_a_plate_at_a_gap() {
    let gap = 0.3e-3;
    let mut free = Disc::new(&disc(1e-3, AGILUS30, FarSide::Free), DISC).expect("a disc");
    for friction in [Friction::NONE, Friction::Coulomb(0.5), Friction::Stick] {
        let design = DiscDesign {
            friction,
            ..disc(1e-3, AGILUS30, FarSide::Plate { gap })
        };
        let mut gapped = Disc::new(&design, DISC).expect("a disc");
        let before = gapped.at_pressure(5e3).expect("a state");
        let alone = free.at_pressure(5e3).expect("a state");
        assert!((before.travel / alone.travel - 1.0).abs() < 1e-6 && before.force == 0.0);
        let mut last = before;
        for pressure in [8e3, 17.9e3, 50e3, 100e3] {
            let state = gapped.at_pressure(pressure).expect("a state");
            assert!((state.travel - gap).abs() < 1e-4 * gap, "{}", state.travel);
            assert!(state.force > last.force && state.volume > last.volume);
            assert!(state.contact_radius > last.contact_radius && state.contact_radius < 4.5e-3);
            // The clamp carries what the plate does not.
            assert!(state.force < pressure * PI * 4.5e-3 * 4.5e-3);
            assert!(
                (state.energy / state.work - 1.0).abs() < 0.005,
                "{} {}",
                state.energy,
                state.work
            );
            last = state;
        }
    }
}

/// Pressures, and the derivative of the volume, between states of the path are those of the path.
#[test]
fn states_do_not_depend_on_what_was_asked_before() {
    let design = disc(
        1e-3,
        AGILUS30,
        FarSide::Foundation {
            gap: 0.1e-3,
            stiffness: 2e7,
        },
    );
    let mut one = Disc::new(&design, DISC).expect("a disc");
    let mut other = Disc::new(&design, DISC).expect("a disc");
    let first = one.at_pressure(17.9e3).expect("a state");
    for pressure in [60e3, 1e3, 30e3] {
        other.at_pressure(pressure).expect("a state");
    }
    assert_eq!(other.at_pressure(17.9e3).expect("a state"), first);
    let beside = [17.8e3, 18.0e3].map(|pressure| one.at_pressure(pressure).expect("a state").volume);
    assert!(((beside[1] - beside[0]) / 200.0 / first.compliance - 1.0).abs() < 1e-3);
}

#[test]
fn the_mesh_is_fine_enough() {
    let finer = Elements {
        through: 4,
        along: 64,
    };
    for far_side in [FarSide::Free, FarSide::Plate { gap: 0.3e-3 }] {
        for (thickness, error) in [(0.3e-3, 0.003), (1e-3, 0.003), (2e-3, 0.015)] {
            let design = disc(thickness, AGILUS30, far_side);
            let [found, truth] = [DISC, finer].map(|elements| at(&design, elements, 30e3));
            assert!((found.volume / truth.volume - 1.0).abs() < error);
            assert!((found.travel / truth.travel - 1.0).abs() < error);
            // Of what a blocked disc passes on.
            let blocked = 30e3 * PI * 4.5e-3 * 4.5e-3;
            assert!((found.force - truth.force).abs() < 0.005 * blocked);
        }
    }
}

/// A neo-Hookean sheet softens as it inflates: a held pressure has a greatest value. Beyond it there is an error that gives it.
#[test]
fn a_disc_that_does_not_stand_the_pressure_is_refused_with_the_limit() {
    let design = disc(0.2e-3, LAW, FarSide::Free);
    let mut found = Disc::new(&design, DISC).expect("a disc");
    let limit = found.limit(1e9).expect("an end");
    assert!(found.at_pressure(0.999 * limit.pressure).is_ok());
    let asked = 1.1 * limit.pressure;
    assert_eq!(
        found.at_pressure(asked),
        Err(DiscError::BeyondLimit { asked, limit })
    );
    assert!(matches!(
        limit.ends_by,
        DiscEnd::PressureMaximum | DiscEnd::BulgeTouchesFrame
    ));
    for asked in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            found.at_pressure(asked),
            Err(DiscError::NotAPressure { .. })
        ));
    }
    for bad in [
        disc(9e-3, LAW, FarSide::Free),
        disc(1e-3, LAW, FarSide::Plate { gap: -1e-4 }),
        disc(
            1e-3,
            LAW,
            FarSide::Foundation {
                gap: 0.0,
                stiffness: 0.0,
            },
        ),
    ] {
        assert!(matches!(Disc::new(&bad, DISC), Err(DiscError::NotADisc { .. })));
    }
}
