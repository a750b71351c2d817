use super::*;
use crate::fit::data::DataChoice;
use std::fmt::Write as _;

/// Pressure that saturates: `P = 3 (1 - exp(-H))` kPa, `F = H^1.5` N, H in millimetres.
fn bench(rows: usize, deepest: f64) -> Data {
    let mut text = String::from("indentation_mm,force_n,pressure_rise_kpa\n");
    for k in 1..=rows {
        let depth = deepest * k as f64 / rows as f64;
        let wobble = 1.0 + 0.003 * (k as f64 * 2.399).sin();
        let (force, rise) = (depth.powf(1.5) * wobble, 3.0 * (1.0 - (-depth).exp()));
        let _ = writeln!(text, "{depth},{force},{rise}");
    }
    Data::parse(&text, "bench.csv", &DataChoice::default()).expect("good data")
}

#[test]
fn follows_a_monotone_law_and_grows() {
    let curve = from_data(&bench(60, 3.0)).expect("a curve");
    let mut before = 0.0;
    for k in 1..=300 {
        let rise = curve.end * f64::from(k) / 300.0;
        let force = curve.force.at(rise);
        assert!(force > before);
        before = force;
        let depth = -(1.0 - rise / 3000.0).ln();
        if depth > 0.3 {
            assert!((force / depth.powf(1.5) - 1.0).abs() < 0.02, "{depth}: {force}");
            let found = curve.indentation.as_ref().expect("measured").at(rise);
            assert!((1e3 * found / depth - 1.0).abs() < 0.02, "{depth}: {found}");
        }
    }
    assert!(curve.force.held_out.rms_percent() < 1.0, "{:?}", curve.force);
    assert_eq!(curve.falls, Some([0, 59]));
    // Whatever is the last row is refused by those before it.
    assert_eq!(curve.force.refused, 1);
}

#[test]
fn a_saturating_pressure_is_told() {
    // dF/dP grows as sqrt(H) exp(H): at 3 mm some 20 times what it is in the middle of the pressures.
    let found = from_data(&bench(60, 3.0))
        .expect("a curve")
        .saturation
        .expect("it saturates");
    assert!(found.ratio > 5.0 && found.from > 2000.0, "{found:?}");
    assert_eq!(from_data(&bench(60, 0.8)).expect("a curve").saturation, None);
}

#[test]
fn outliers_do_not_count() {
    let mut data = bench(60, 2.0);
    let clean = from_data(&data).expect("a curve").force.at(2000.0);
    data.rows[40].force = Some(9.0);
    let curve = from_data(&data).expect("a curve");
    assert_eq!(curve.force.outliers, 1);
    assert!((curve.force.at(2000.0) / clean - 1.0).abs() < 0.01);
}

#[test]
fn non_negative_least_squares_has_its_optimality_conditions() {
    let matrix = DMatrix::from_fn(12, 4, |i, j| {
        ((1 + i * (j + 2)) as f64 * 0.7).sin() + 0.2 * j as f64
    });
    let target = DVector::from_fn(12, |i, _| (i as f64 * 1.3).cos() - 0.3);
    let x = non_negative(&matrix, &target).expect("a solution");
    let gradient = matrix.transpose() * (&target - &matrix * &x);
    for k in 0..4 {
        assert!(x[k] >= 0.0 && gradient[k] < 1e-9);
        assert!((x[k] * gradient[k]).abs() < 1e-9);
    }
    assert!(x.iter().any(|x| *x == 0.0) && x.iter().any(|x| *x > 0.0), "{x}");
}

#[test]
fn too_little_is_refused() {
    assert_eq!(from_data(&bench(5, 1.0)), Err(NoCurve::TooFew { found: 5 }));
}
