use super::*;

#[test]
fn runge_kutta_has_order_four() {
    let error = |steps: usize| {
        let [y] = runge_kutta(|_, y: &[f64; 1]| Some(*y), [0.0, 1.0], steps, [1.0]).expect("defined");
        (y - core::f64::consts::E).abs()
    };
    let order = libm::log2(error(10) / error(20));
    assert!((3.8..4.2).contains(&order), "{order}");
}

#[test]
fn bisection_finds_roots_and_refuses_jumps() {
    let limits = [0.01, 100.0];
    let root = bisect(Unknown::Pressure, Undefined::Below, 1e-8, 1.0, limits, |x| {
        Ok(x * x - 2.0)
    })
    .expect("a root");
    assert!((root - core::f64::consts::SQRT_2).abs() < 1e-8);
    let below = bisect(Unknown::Pressure, Undefined::Below, 1e-8, 3.0, limits, |x| {
        Ok(x * x - 2.0)
    })
    .expect("a root");
    assert!((below - core::f64::consts::SQRT_2).abs() < 1e-8);
    // Undefined below 1.2: the root above is found all the same.
    let edge = bisect(Unknown::Pressure, Undefined::Below, 1e-8, 1.1, limits, |x| {
        if x < 1.2 {
            Err(MethodFailure::Singular)
        } else {
            Ok(x - 1.3)
        }
    });
    assert!((edge.expect("a root") - 1.3).abs() < 1e-7);
    let jump = bisect(Unknown::Contact, Undefined::Below, 1e-8, 1.0, limits, |x| {
        Ok(if x < 1.5 { -1.0 } else { 1.0 })
    });
    assert!(matches!(jump, Err(MethodFailure::Jump { .. })), "{jump:?}");
    let none = bisect(Unknown::PoleStretch, Undefined::Below, 1e-8, 1.0, limits, |_| {
        Ok(-1.0)
    });
    assert_eq!(
        none,
        Err(MethodFailure::NoBracket {
            unknown: Unknown::PoleStretch
        })
    );
}
