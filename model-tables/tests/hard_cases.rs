//! Where methods fail and designs end: laws that lose their stability, poles that inflation does not stretch, membranes
//! that would have to push.

mod common;

use common::{AGILUS30, design};
use model_tables::adapt::Failure;
use model_tables::design::{Design, RestBy};
use model_tables::material::Law;
use model_tables::membrane::TensionField;
use model_tables::press::{ModelError, Press};
use model_tables::rest::Quantity;
use model_tables::stability::Mode;
use model_tables::state::Wrinkling;

fn relaxed(design: &Design) -> Result<Press, ModelError> {
    Press::new(design, TensionField::Relaxed)
}

/// `W_11` vanishes at equal stretches of `sqrt(C1 / -C2)` = 2 (Mooney-Rivlin): no pole can be stretched further.
#[test]
fn a_pole_beyond_the_stability_of_its_law_is_refused_by_the_stretch() {
    let law = Law::MooneyRivlin { c1: 100e3, c2: -25e3 };
    match relaxed(&design(6.0, 3.0, 0.5, law, 2.3)).map(|press| *press.rest()) {
        Err(ModelError::LawUnstable { asked, margin }) => {
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
        Err(ModelError::NoRestState {
            quantity: Quantity::PoleStretch,
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
        Err(ModelError::PressUnsolved {
            reached,
            failure: Failure::EdgePushes { .. },
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
        Err(ModelError::NoRestState { least, .. }) => assert!((least / 9e-3 - 0.977).abs() < 1e-3, "{least}"),
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
