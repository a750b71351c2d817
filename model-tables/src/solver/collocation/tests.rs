use super::*;

#[test]
fn weights_integrate_polynomials_of_degree_two_s_less_one() {
    fn check<const S: usize>() {
        let gauss = Gauss::<S>::new();
        for degree in 0..2 * S as i32 {
            let sum: f64 = gauss
                .nodes
                .iter()
                .zip(&gauss.weights)
                .map(|(c, b)| b * c.powi(degree))
                .sum();
            assert!(
                (sum - 1.0 / f64::from(degree + 1)).abs() < 1e-15,
                "S = {S}, degree {degree}"
            );
        }
        for (row, c) in gauss.stages.iter().zip(&gauss.nodes) {
            for degree in 0..S as i32 {
                let sum: f64 = row
                    .iter()
                    .zip(&gauss.nodes)
                    .map(|(a, x)| a * x.powi(degree))
                    .sum();
                assert!((sum - c.powi(degree + 1) / f64::from(degree + 1)).abs() < 1e-14);
            }
        }
    }
    check::<1>();
    check::<2>();
    check::<4>();
    check::<6>();
    check::<8>();
}

#[test]
fn the_collocation_polynomial_passes_through_its_points() {
    let gauss = Gauss::<4>::new();
    let of = |t: f64| [1.0 + t * t, t.powi(4) - 2.0 * t];
    let stages = gauss.nodes.map(of);
    for theta in [0.0, 0.1, 0.5, 0.93, 1.0] {
        let found = gauss.evaluate(of(0.0), &stages, theta);
        assert!((found[0] - of(theta)[0]).abs() < 1e-14 && (found[1] - of(theta)[1]).abs() < 1e-14);
    }
}

/// Chebyshev's polynomial of degree four on 0 ..= 1 is `128 t^4 - 256 t^3 + 160 t^2 - 32 t + 1`.
#[test]
fn the_last_term_is_the_coefficient_of_chebyshevs_polynomial() {
    let gauss = Gauss::<4>::new();
    let chebyshev = |t: f64| 1.0 + t * (-32.0 + t * (160.0 + t * (-256.0 + 128.0 * t)));
    let of = |t: f64| [3.0 - t * t * t, 1.0 + t - 0.7 * chebyshev(t)];
    let [smooth, rough] = gauss.last_term(of(0.0), &gauss.nodes.map(of));
    assert!(
        smooth.abs() < 1e-14 && (rough + 0.7).abs() < 1e-14,
        "{smooth} {rough}"
    );
}

/// `y' = (y_1, -y_0 + p_0)`, one Newton step from zero: the condensed map must be the matrix exponential.
fn rotation_error<const S: usize>(h: f64) -> f64 {
    let gauss = Gauss::<S>::new();
    let span = Span {
        start: 0.0,
        length: h,
        ..Span::default()
    };
    let mut point = GaussPoint {
        rate_by_state: [[0.0, 1.0], [-1.0, 0.0]],
        ..GaussPoint::default()
    };
    point.rate_by_parameter[1][0] = 1.0;
    point.integrand_by_state[0] = [1.0, 0.0];
    let mut condensed = Condensed::<S>::default();
    condense(
        &gauss,
        &span,
        [0.0; 2],
        [0.0; 2],
        &[[0.0; 2]; S],
        &[point; S],
        &mut condensed,
    )
    .expect("regular");
    let (sin, cos) = h.sin_cos();
    let exact = [[cos, sin, 1.0 - cos], [-sin, cos, sin]];
    let mut error: f64 = 0.0;
    for (found, expected) in condensed.end.iter().zip(&exact) {
        for (a, b) in found.iter().zip(expected) {
            error = error.max((a - b).abs());
        }
    }
    let integral = [sin, 1.0 - cos, h - sin];
    for (a, b) in condensed.integrals[0].iter().zip(&integral) {
        error = error.max((a - b).abs());
    }
    error
}

#[test]
fn a_linear_system_is_carried_with_order_two_s() {
    assert!(rotation_error::<6>(0.8) < 1e-13);
    let ratio = rotation_error::<2>(0.4) / rotation_error::<2>(0.2);
    // Local error of a method of order four.
    assert!((ratio / 32.0 - 1.0).abs() < 0.15, "{ratio}");
}

#[test]
fn a_moving_element_changes_its_end_by_the_rate_there() {
    // y' = (2 t, 0): y_b - y_a = (t_b^2 - t_a^2, 0); parameter 0 moves the start, parameter 1 the length.
    let gauss = Gauss::<3>::new();
    let mut span = Span {
        start: 0.5,
        length: 0.25,
        ..Span::default()
    };
    span.start_by[0] = 1.0;
    span.length_by[1] = 1.0;
    let points = gauss.nodes.map(|c| {
        let t = span.start + c * span.length;
        GaussPoint {
            rate: [2.0 * t, 0.0],
            rate_by_position: [2.0, 0.0],
            ..GaussPoint::default()
        }
    });
    let mut condensed = Condensed::<3>::default();
    condense(
        &gauss,
        &span,
        [0.0; 2],
        [0.0; 2],
        &[[0.0; 2]; 3],
        &points,
        &mut condensed,
    )
    .expect("regular");
    let [_, _, by_start, by_length, _, _, value] = condensed.end[0];
    assert!((value - (0.75_f64.powi(2) - 0.25)).abs() < 1e-14);
    assert!((by_start - 0.5).abs() < 1e-14, "2 (t_b - t_a)");
    assert!((by_length - 1.5).abs() < 1e-14, "2 t_b");
}
