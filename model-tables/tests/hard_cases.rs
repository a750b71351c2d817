//! Where methods fail and designs end: laws that lose their stability, poles that inflation does not stretch, membranes
//! that would have to push.

mod common;

use common::{AGILUS30, design};
use model_tables::design::{Design, RestBy};
use model_tables::limit::EndsBy;
use model_tables::material::Law;
use model_tables::material::preset::Preset;
use model_tables::material::stability::Mode;
use model_tables::membrane::TensionField;
use model_tables::membrane::adapt::Unsolved;
use model_tables::membrane::press::{MembraneError, Press};
use model_tables::membrane::rest::RestQuantity;
use model_tables::membrane::state::Wrinkling;

fn relaxed(design: &Design) -> Result<Press, MembraneError> {
    Press::new(design, TensionField::Relaxed)
}

/// `W_11` vanishes at equal stretches of `sqrt(C1 / -C2)` = 2 (Mooney-Rivlin): no pole can be stretched further.
#[test]
fn a_pole_beyond_the_stability_of_its_law_is_refused_by_the_stretch() {
    let law = Law::MooneyRivlin { c1: 100e3, c2: -25e3 };
    match relaxed(&design(6.0, 3.0, 0.5, law, 2.3)).map(|press| *press.rest()) {
        Err(MembraneError::LawUnstable { asked, margin }) => {
            assert!((asked - 2.3).abs() < 1e-15);
            assert!((margin.meridional_stretch - 2.0).abs() < 1e-9, "{margin:?}");
            assert!((margin.hoop_stretch - 2.0).abs() < 1e-9);
            assert_eq!(margin.mode, Mode::Necking);
        }
        other => panic!("{other:?}"),
    }
    let stable = relaxed(&design(6.0, 3.0, 0.5, law, 1.5)).expect("stable below");
    assert!(stable.rest_stability().is_stable());
}

/// A long membrane of a softening law bulges at its equator before its pole is stretched far: just below the greatest
/// pole stretch there is a state, just above it none nearby.
#[test]
fn a_pole_that_inflation_does_not_stretch_so_far_is_refused_by_its_greatest_stretch() {
    let law = Law::Yeoh {
        c1: 100e3,
        c2: -5.36e3,
        c3: -107.0,
    };
    let long = |stretch| design(6.0, 7.458, 0.5, law, stretch);
    let greatest = match relaxed(&long(1.3)).map(|press| *press.rest()) {
        Err(MembraneError::NoRestState {
            quantity: RestQuantity::PoleStretch,
            greatest,
            ..
        }) => greatest,
        other => panic!("{other:?}"),
    };
    assert!(greatest > 1.1 && greatest < 1.3, "{greatest}");
    let below = relaxed(&long(greatest - 1e-3)).expect("a state below");
    assert!(below.rest_stability().is_stable());
    assert!(relaxed(&long(greatest + 1e-3)).is_err());
}

/// A plain membrane pressed from a low pre-stretch loses its tension at the contact edge. The equations have solutions
/// beyond, with the tangent reversed at the edge, which violate virtual work by tens of percent: none may come out.
#[test]
fn a_plain_membrane_that_would_push_at_the_contact_edge_is_refused() {
    let plate = design(9.0, 14.46, 0.5, Law::NeoHookean { c1: 100e3 }, 1.005);
    let mut plain = Press::new(&plate, TensionField::Plain).expect("rest");
    let reached = match plain.at_indentation(3e-3) {
        Err(MembraneError::PressUnsolved {
            reached,
            failure: Unsolved::EdgePushes { .. },
            ..
        }) => reached,
        other => panic!("{other:?}"),
    };
    let (at, step) = (0.8 * reached, 1e-3 * reached);
    let state = plain.at_indentation(at).expect("before the end");
    let energy = |press: &mut Press, h: f64| press.at_indentation(h).expect("state").shape.energy;
    let rate = (energy(&mut plain, at + step) - energy(&mut plain, at - step)) / (2.0 * step);
    assert!((rate / state.force - 1.0).abs() < 1e-5);
    // A membrane that wrinkles and slackens goes on.
    let beyond = relaxed(&plate)
        .expect("rest")
        .at_indentation(3e-3)
        .expect("relaxed");
    assert_eq!(beyond.shape.wrinkling, Wrinkling::Slack);
}

/// The equator wrinkles at rest below a pole stretch that depends on the aspect (independent analysis, Agilus30).
#[test]
fn the_equator_of_a_flat_membrane_wrinkles_below_its_stretch() {
    for (aspect, least) in [(0.45, 1.089), (0.5, 1.070), (0.6, 1.034), (0.65, 1.018)] {
        let wrinkling = |stretch| {
            let press = relaxed(&design(9.0, 9.0 * aspect, 1.0, AGILUS30, stretch)).expect("rest");
            press.rest().wrinkling
        };
        assert_eq!(wrinkling(least - 1.5e-3), Wrinkling::Wrinkled, "{aspect}");
        assert_eq!(wrinkling(least + 1.5e-3), Wrinkling::Taut, "{aspect}");
    }
    let round = relaxed(&design(9.0, 9.0 * 0.71, 1.0, AGILUS30, 1.0005)).expect("rest");
    assert_eq!(round.rest().wrinkling, Wrinkling::Taut);
}

/// At `b0/a0` = 0.6 the equator of a plain membrane shrinks to 0.977 `a0` near a pole stretch of 1.04 and is back at `a0` near 1.12
/// (independent analysis): in between two states have one radius, below there is none.
#[test]
fn an_equator_smaller_than_inflation_makes_it_is_refused() {
    let by_radius = |part: f64| Design {
        rest: RestBy::EquatorRadius(part * 9e-3),
        ..design(9.0, 5.4, 1.0, AGILUS30, 1.1)
    };
    let plain = |part: f64| Press::new(&by_radius(part), TensionField::Plain).map(|press| *press.rest());
    match plain(0.97) {
        Err(MembraneError::NoRestState { least, .. }) => {
            assert!((least / 9e-3 - 0.977).abs() < 1e-3, "{least}");
        }
        other => panic!("{other:?}"),
    }
    let back = plain(0.99999).expect("the more stretched state");
    assert!((back.pole_stretch - 1.12).abs() < 0.01, "{}", back.pole_stretch);
}

/// Relaxing the compression changes the force at equal indentation by as much as 39 % (independent analysis, Agilus30,
/// 9 mm, `b0/a0` = 0.45, pole stretch 1.02).
#[test]
fn wrinkles_soften_a_flat_weakly_stretched_membrane() {
    let flat = design(9.0, 4.05, 1.0, AGILUS30, 1.02);
    let (mut plain, mut relaxed) = (
        Press::new(&flat, TensionField::Plain).expect("rest"),
        relaxed(&flat).expect("rest"),
    );
    let mut most: f64 = 0.0;
    for k in 1..40 {
        let h = 0.05e-3 * f64::from(k);
        if let (Ok(a), Ok(b)) = (relaxed.at_indentation(h), plain.at_indentation(h)) {
            most = most.min(a.force / b.force - 1.0);
        }
    }
    assert!((-0.42..-0.33).contains(&most), "{most}");
}

/// Force by virtual work over the force of a state, less 1: `dE/dH` at constant volume, by differences of sixth order.
fn work_error(press: &mut Press, indentation: f64, step: f64) -> f64 {
    let force = press.at_indentation(indentation).expect("a state").force;
    let mut energy = |shift: f64| {
        let h = indentation * (step * shift).exp();
        press.at_indentation(h).expect("a state beside it").shape.energy
    };
    let rate = [45.0, -9.0, 1.0]
        .iter()
        .zip(1..)
        .map(|(weight, k)| weight / 60.0 * (energy(f64::from(k)) - energy(f64::from(-k))))
        .sum::<f64>();
    rate / (step * indentation * force) - 1.0
}

/// A law that has nearly lost its stability changes its stretches within a few hundredths of the meridian: the rest state
/// and first contact need a mesh that sees it (margin of stability 0.015).
#[test]
fn a_nearly_unstable_law_is_resolved_at_first_contact() {
    let law = Law::Yeoh {
        c1: 49_252.0,
        c2: -4_196.44,
        c3: 210.974,
    };
    let dome = design(3.6, 1.627, 0.582, law, 2.4937);
    let mut press = Press::new(&dome, TensionField::Plain).expect("rest");
    assert!(press.rest_stability().value < 0.03);
    let height = press.rest().height;
    for (part, bound) in [(2e-4, 1e-4), (1e-3, 1e-5), (1e-2, 1e-6), (0.1, 1e-6)] {
        let error = work_error(&mut press, part * height, 0.04);
        assert!(error.abs() < bound, "{part}: {error:e}");
    }
}

/// Hoop wrinkles that begin between two samples of the mesh still relax: at their onset, which lies between the two
/// indentations, the force obeys virtual work as it does elsewhere.
#[test]
fn a_wrinkled_zone_thinner_than_an_element_is_found() {
    let law = Law::Yeoh {
        c1: 487_085.85,
        c2: -41_856.92,
        c3: 543.616,
    };
    let flat = design(
        13.735_708_475_724_271,
        8.278_878_5,
        0.893,
        law,
        1.003_481_905_109_167_7,
    );
    let mut press = relaxed(&flat).expect("rest");
    for indentation in [2.26e-3, 2.27e-3, 2.28e-3, 2.2848e-3, 2.29e-3] {
        let error = work_error(&mut press, indentation, 1e-4);
        assert!(error.abs() < 1e-7, "{indentation}: {error:e}");
    }
}

/// With a compliance between those of base touch and of drained fluid the bulge touches the base and lifts off again: the
/// press ends at the first touch, whichever indentation is asked for first.
#[test]
fn a_bulge_that_lifts_off_again_has_ended_the_press() {
    let dome = Design {
        compliance: 4.945_788_756_510_176e-11,
        ..design(
            5.832_042_998,
            5.211_643_574,
            0.100_270_626_6,
            Law::NeoHookean { c1: 150_370.779 },
            1.310_032_979,
        )
    };
    let mut press = relaxed(&dome).expect("rest");
    let height = press.rest().height;
    match press.at_indentation(0.96 * height) {
        Err(MembraneError::BeyondLimit { limit, .. }) => {
            assert_eq!(limit.ends_by, EndsBy::BulgeTouchesBase);
            let part = limit.indentation / height;
            assert!((0.9..0.92).contains(&part), "{part}");
            let state = press
                .at_indentation(0.9999 * limit.indentation)
                .expect("before the end");
            assert!(state.contact_radius < state.shape.edge_radius);
            assert!((state.contact_radius / state.shape.edge_radius - 1.0).abs() < 1e-4);
        }
        other => panic!("{other:?}"),
    }
}

/// A plain membrane may lose its tension at the contact edge and have it again when pressed farther, which stretches it:
/// in between there is no state, beyond there are, and both are told whatever was asked before.
#[test]
fn a_plain_membrane_is_pressed_beyond_the_indentations_without_a_state() {
    let law = Law::MooneyRivlin {
        c1: 901_870.78,
        c2: 529_710.466,
    };
    let long = design(2.730_212_177, 4.560_046_486, 0.034_823_148, law, 1.016_446_31);
    let mut press = Press::new(&long, TensionField::Plain).expect("rest");
    let height = press.rest().height;
    for _ in 0..2 {
        for part in [0.1, 0.19, 0.3, 0.45] {
            let error = work_error(&mut press, part * height, 5e-3);
            assert!(error.abs() < 1e-6, "{part}: {error:e}");
        }
        let between = press.at_indentation(0.22 * height);
        assert!(
            matches!(
                between,
                Err(MembraneError::PressUnsolved {
                    failure: Unsolved::EdgePushes { .. },
                    ..
                })
            ),
            "{between:?}"
        );
    }
    let limit = press.limit().expect("the end lies beyond");
    assert_eq!(limit.ends_by, EndsBy::BulgeTouchesBase);
}

/// Where pressure falls with inflation, a compliance of `-dV/dP` no longer holds the dome, and where the volume has its
/// maximum no fluid does. On the way to either the pressure rise per force at first contact, `dh/(dV + c dP)` along
/// inflation with the edge held, grows beyond bounds.
#[test]
fn a_dome_that_inflates_by_itself_is_refused() {
    let soft = Law::Yeoh {
        c1: 175_040.534,
        c2: -2_486.226_8,
        c3: -717.316_85,
    };
    let dome = |stretch| design(8.804, 8.077, 0.762, soft, stretch);
    let rise_per_force = |design: &Design| {
        let mut press = relaxed(design).expect("it holds");
        let state = press.at_indentation(1e-4 * press.rest().height).expect("contact");
        state.pressure_rise / state.force
    };
    assert!(rise_per_force(&dome(1.79)) > 10.0 * rise_per_force(&dome(1.6)));
    assert!(matches!(
        relaxed(&dome(1.8)).map(|press| *press.rest()),
        Err(MembraneError::Unheld { largest: None, .. })
    ));
    let softening = Law::Yeoh {
        c1: 459_938.16,
        c2: -15_255.483_5,
        c3: 321.503_16,
    };
    let balloon = design(12.239, 12.08, 1.1, softening, 2.2);
    let with = |compliance| Design {
        compliance,
        ..balloon
    };
    let largest = match relaxed(&with(1e-6)).map(|press| *press.rest()) {
        Err(MembraneError::Unheld {
            largest: Some(largest),
            ..
        }) => largest,
        other => panic!("{other:?}"),
    };
    assert!(relaxed(&with(1.001 * largest)).is_err());
    let (half, nearly) = (
        rise_per_force(&with(0.5 * largest)),
        rise_per_force(&with(0.9 * largest)),
    );
    // As 1 / (1 - c / c_largest).
    assert!((nearly / half / 5.0 - 1.0).abs() < 0.05, "{half} {nearly}");
}

/// A cast silicone whose law has `C3 < 0`, in designs that `size` finds: the press ends where the law softens, with the last state found, and
/// what is asked beyond is refused by that end.
#[test]
fn a_press_whose_law_softens_ends_there_with_its_reason() {
    for (name, [a, b, h], stretch, about) in [
        ("dragon-skin-10", [6.18, 4.934, 1.48], 1.55534, 4.04),
        ("dragon-skin-20", [10.0, 9.0, 1.1308], 1.55379, 6.01),
        ("dragon-skin-30", [4.653, 9.0, 1.251], 1.19557, 5.39),
    ] {
        let law = Preset::named(name).expect("listed").law;
        let mut press = relaxed(&design(a, b, h, law, stretch)).expect("a rest state");
        let limit = press.limit().expect("an end");
        assert_eq!(limit.ends_by, EndsBy::MaterialSoftens, "{name}");
        assert!(
            (1e3 * limit.indentation / about - 1.0).abs() < 0.01,
            "{name}: {limit:?}"
        );
        let last = press
            .at_indentation(limit.indentation)
            .expect("the last state found");
        assert!((limit.force / last.force - 1.0).abs() < 1e-6, "{name}: {limit:?}");
        // Hardly anything is left of the law's stability there, and it was well before.
        assert!(press.stability().value < 0.02, "{name}");
        press.at_indentation(0.5 * limit.indentation).expect("a state");
        assert!(press.stability().value > 0.02, "{name}");
        for asked in [1.01 * limit.indentation, 1.3 * limit.indentation] {
            match press.at_indentation(asked) {
                Err(MembraneError::BeyondLimit { limit: told, .. }) => assert_eq!(told, limit),
                other => panic!("{name}: {other:?}"),
            }
        }
    }
}
