//! The curve of a press between its states, against the full membrane.

mod common;

use common::{AGILUS30, design};
use model_tables::design::Design;
use model_tables::material::Law;
use model_tables::material::preset::SKIN;
use model_tables::membrane::TensionField;
use model_tables::membrane::press::{CURVE, Press, STAGES};

/// The source paper's dome, a finger of the same material that is hardly stretched, and one of the skin analogue.
fn designs() -> [Design; 3] {
    [
        design(4.5, 2.7, 1.0, AGILUS30, 2.3),
        design(9.0, 7.0, 1.0, AGILUS30, 1.02),
        design(9.0, 7.0, 1.0, SKIN, 1.1),
    ]
}

/// Largest relative error of force and indentation at given pressure rises, over a press to a part of the limit.
fn worst(part: f64) -> f64 {
    let mut worst: f64 = 0.0;
    for design in designs() {
        let mut truth = Press::new(&design, TensionField::Relaxed).expect("a rest state");
        let deepest = part * truth.limit().expect("a limit").indentation;
        let mut press = Press::<Law, STAGES>::with_resolution(&design, TensionField::Relaxed, CURVE)
            .expect("a rest state");
        let curve = press.curve(deepest).expect("it grows throughout");
        for k in 1..400 {
            // As dense near the end as at first contact.
            let place = f64::from(k) / 400.0;
            let indentation = deepest
                * if k % 2 == 0 {
                    place
                } else {
                    1e-5_f64.powf(1.0 - place)
                };
            let exact = truth.contact_at(indentation).expect("within the limit");
            let found = curve.at_pressure_rise(exact.pressure_rise);
            worst = worst
                .max((found.force / exact.force - 1.0).abs())
                .max((found.indentation / exact.indentation - 1.0).abs());
        }
    }
    worst
}

#[test]
fn a_curve_is_exact_between_its_states_far_from_the_limit() {
    let error = worst(0.6);
    assert!(error < 1e-7, "{error:e}");
}

#[test]
fn a_curve_is_exact_between_its_states_next_to_the_limit() {
    let error = worst(0.98);
    assert!(error < 1e-6, "{error:e}");
}
