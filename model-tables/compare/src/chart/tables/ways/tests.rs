use super::*;

/// Force `x`, indentation `sqrt x`.
fn root() -> Curve {
    let points = (1..=200)
        .map(|i| {
            let x = libm::exp2(-24.0 * (1.0 - f64::from(i) / 200.0));
            Contact {
                pressure_rise: 1e4 * x,
                force: 3.0 * x,
                indentation: 1e-3 * libm::sqrt(x),
            }
        })
        .collect();
    Curve::new(points).expect("it grows")
}

#[test]
fn each_way_finds_the_function_that_it_has() {
    let curve = root();
    let press = Press::new(&curve, curve.end());
    // Both are powers, and rational in the root but for the force's square of it.
    let powers = press.powers();
    assert!(
        (powers[0][1] - 1.0).abs() < 1e-3 && (powers[1][1] - 0.5).abs() < 1e-3,
        "{powers:?}"
    );
    assert!(press.power(&powers, libm::powf).of_reading < 0.01);
    assert!(press.rational().of_reading < 0.01);
    assert!(press.warped(64).of_full_scale < 0.05);
}

/// A line on the root over `[a, b]` errs by `(sqrt b - sqrt a)^2 / (8 (sqrt a + sqrt b))` at least, which is 0.0208 here; of
/// reading, that over values of 0.5 to 1.
#[test]
fn lines_are_fitted_to_least_largest_error() {
    let curve = root();
    let press = Press::new(&curve, curve.end());
    let [_, values] = press.fitted(&[0.25, 1.0], |place| place);
    let error = |x: f64| values[0] + (x - 0.25) / 0.75 * (values[1] - values[0]) - libm::sqrt(x);
    let worst = (0..=100)
        .map(|i| 0.25 + 0.75 * f64::from(i) / 100.0)
        .map(|x| error(x).abs() / libm::sqrt(x));
    let worst = worst.fold(0.0, f64::max);
    assert!(worst > 0.0208 && worst < 0.0417, "{worst}");
}

/// Lines as the square of their width; cubics as more than that, but not as the fourth power: at 0 the root has no slope.
#[test]
fn more_knots_err_less_by_their_order() {
    let curve = root();
    let press = Press::new(&curve, curve.end());
    let ratio = press.lines(32).of_reading / press.lines(64).of_reading;
    assert!((3.0..9.0).contains(&ratio), "{ratio}");
    let ratio = press.cubics(16).of_reading / press.cubics(32).of_reading;
    assert!((5.0..40.0).contains(&ratio), "{ratio}");
}
