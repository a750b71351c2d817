use super::*;
use crate::material::Law;

fn membrane(tension_field: TensionField) -> LocalEquations<Law> {
    touching(tension_field, 0.0)
}

fn touching(tension_field: TensionField, curvature: f64) -> LocalEquations<Law> {
    LocalEquations {
        aspect: 0.7,
        law: Law::MooneyRivlin { c1: 0.4, c2: 0.1 },
        tension_field,
        curvature,
    }
}

/// Every derivative of [`LocalEquations::point`] against central differences of fourth order.
fn check_derivatives(m: &LocalEquations<Law>, zone: Zone, t: f64, y: [f64; 2], pressure: f64, radius: f64) {
    let at = |t: f64, u: f64, w: f64, p: f64, r: f64| {
        m.point(zone, &m.meridian(t), [u, w], p, r, 1.2)
            .expect("an admissible state")
            .0
    };
    let h = 1e-4;
    let values = |p: &GaussPoint| [p.rate[0], p.rate[1], p.integrand[0], p.integrand[1]];
    let slope = |of: &dyn Fn(f64) -> GaussPoint| {
        let (a, b, c, d) = (
            values(&of(h)),
            values(&of(-h)),
            values(&of(2.0 * h)),
            values(&of(-2.0 * h)),
        );
        core::array::from_fn::<f64, 4, _>(|i| (8.0 * (a[i] - b[i]) - (c[i] - d[i])) / (12.0 * h))
    };
    let [u, w] = y;
    let point = at(t, u, w, pressure, radius);
    let check = |what: &str, found: [f64; 4], expected: [f64; 4]| {
        for i in 0..4 {
            let off = (found[i] - expected[i]).abs();
            assert!(
                off < 1e-8 * (1.0 + expected[i].abs()),
                "{zone:?} by {what} [{i}]: {found:?} {expected:?}"
            );
        }
    };
    let rows = |of: &dyn Fn(usize) -> f64, integrals: &dyn Fn(usize) -> f64| {
        [of(0), of(1), integrals(0), integrals(1)]
    };
    check(
        "u",
        rows(&|i| point.rate_by_state[i][0], &|i| {
            point.integrand_by_state[i][0]
        }),
        slope(&|d| at(t, u + d, w, pressure, radius)),
    );
    check(
        "w",
        rows(&|i| point.rate_by_state[i][1], &|i| {
            point.integrand_by_state[i][1]
        }),
        slope(&|d| at(t, u, w + d, pressure, radius)),
    );
    check(
        "t",
        rows(&|i| point.rate_by_position[i], &|i| {
            point.integrand_by_position[i]
        }),
        slope(&|d| at(t + d, u, w, pressure, radius)),
    );
    for (name, index, change) in [
        ("pressure", PRESSURE, (1.0, 0.0)),
        ("radius", CONTACT_RADIUS, (0.0, 1.0)),
    ] {
        check(
            name,
            rows(&|i| point.rate_by_parameter[i][index], &|i| {
                point.integrand_by_parameter[i][index]
            }),
            slope(&|d| at(t, u, w, pressure + change.0 * d, radius + change.1 * d)),
        );
    }
}

#[test]
fn derivatives_are_exact_where_the_membrane_is_taut() {
    let m = membrane(TensionField::Plain);
    check_derivatives(&m, Zone::Free, 0.9, [1.3, 0.4], 1.1, 0.3);
    check_derivatives(&m, Zone::Free, 1.4, [1.1, -0.2], 0.8, 0.6);
    check_derivatives(&m, Zone::Free, 0.2, [1.05, 0.1], 0.2, 0.0);
    check_derivatives(&m, Zone::Contact, 0.4, [1.2, 0.3], 0.0, 0.0);
    check_derivatives(&m, Zone::Contact, 0.4, [0.99, -0.02], 0.0, 0.0);
}

#[test]
fn derivatives_are_exact_where_hoop_wrinkles_stand() {
    let m = membrane(TensionField::Relaxed);
    let (_, response) = m
        .point(Zone::Free, &m.meridian(1.3), [0.8, 0.2], 0.9, 0.2, 1.2)
        .expect("admissible");
    assert!(response.wrinkled && response.w2.abs() < f64::MIN_POSITIVE);
    check_derivatives(&m, Zone::Free, 1.3, [0.8, 0.2], 0.9, 0.2);
}

#[test]
fn derivatives_are_exact_on_a_ball_and_in_a_cup() {
    for curvature in [1.2, -0.6] {
        let m = touching(TensionField::Plain, curvature);
        check_derivatives(&m, Zone::Contact, 0.4, [1.2, 0.3], 0.0, 0.0);
        check_derivatives(&m, Zone::Contact, 0.05, [1.3, 0.5], 0.0, 0.0);
    }
    let m = touching(TensionField::Relaxed, 0.6);
    let (_, response) = m
        .point(Zone::Contact, &m.meridian(1.0), [0.8, 0.2], 0.9, 0.2, 1.2)
        .expect("admissible");
    assert!(response.wrinkled);
    check_derivatives(&m, Zone::Contact, 1.0, [0.8, 0.2], 0.0, 0.0);
}

/// The condition at the contact's edge, against central differences; it is the plate's own for a vanishing curvature.
#[test]
fn derivatives_of_the_contact_edge_are_exact() {
    for curvature in [1.2, -0.6, 1e-12] {
        let m = touching(TensionField::Plain, curvature);
        let of = |y: [f64; 5]| {
            // Not scaled by what it is differentiated by.
            let (value, _) = m
                .contact_edge(&m.meridian(y[4]), [y[0], y[1]], y[2], y[3])
                .expect("on the object");
            value * y[2] * y[3]
        };
        let place = [1.2, 0.3, 0.9, 0.5, 0.4];
        let (value, by) = m
            .contact_edge(&m.meridian(place[4]), [place[0], place[1]], place[2], place[3])
            .expect("on the object");
        for (i, by) in by.iter().enumerate() {
            let [below, above] = [-1e-5, 1e-5].map(|d| {
                let mut moved = place;
                moved[i] += d;
                of(moved)
            });
            let slope = (above - below) / 2e-5;
            assert!(
                (slope - by * place[2] * place[3]).abs() < 1e-8,
                "{curvature} {i}: {slope} {by}"
            );
        }
        let rho = 1.2 * libm::sin(0.4);
        if curvature.abs() < 1e-9 {
            assert!((value - (rho * rho - 0.25)).abs() < 1e-9);
        }
    }
    let beyond = touching(TensionField::Plain, 3.0);
    assert!(
        beyond
            .contact_edge(&beyond.meridian(0.4), [1.2, 0.3], 0.9, 0.5)
            .is_none()
    );
}

#[test]
fn meridians_of_an_interval_are_those_of_its_points() {
    let m = membrane(TensionField::Plain);
    for (start, length) in [(0.0, 0.5), (1e-4, 2e-4), (0.9, 0.49), (0.3, 1.2)] {
        let fractions = [0.0, 0.03, 0.5, 0.8, 1.0];
        for (found, f) in m.meridians(start, length, &fractions).iter().zip(fractions) {
            let expected = m.meridian(start + f * length);
            assert!((found.x - expected.x).abs() < 2e-16 * (1.0 + length));
            assert!((found.x_rate - expected.x_rate).abs() < 3e-16);
            assert!((found.arc_rate - expected.arc_rate).abs() < 3e-16);
        }
    }
}

#[test]
fn response_inverts_the_law() {
    let m = membrane(TensionField::Plain);
    for (l1, u) in [(1.0, 1.0), (2.5, 1.4), (0.9, 1.1), (1.01, 1.2)] {
        let n = m.law.derivatives(l1, u).w1;
        let response = m.respond(n, u, 1.5).expect("a monotone law");
        assert!((response.l1 - l1).abs() < 1e-13, "{l1} {u}: {}", response.l1);
    }
}

#[test]
fn hoop_wrinkles_stand_exactly_below_the_natural_width() {
    let m = membrane(TensionField::Relaxed);
    let n = 0.7;
    let (l1, _) = m.uniaxial(n, 1.0).expect("a monotone law");
    let natural = 1.0 / libm::sqrt(l1);
    assert!(m.respond(n, natural * 0.999, 1.0).expect("narrow").wrinkled);
    let wide = m.respond(n, natural * 1.001, 1.0).expect("wide");
    assert!(!wide.wrinkled && wide.w2 > 0.0);
    // No jump in the stretch where wrinkles begin.
    let narrow = m.respond(n, natural * (1.0 - 1e-12), 1.0).expect("at the edge");
    assert!((narrow.l1 - m.respond(n, natural * (1.0 + 1e-12), 1.0).expect("edge").l1).abs() < 1e-10);
}

#[test]
fn a_slack_free_zone_is_refused() {
    let m = membrane(TensionField::Plain);
    assert!(
        m.point(Zone::Free, &m.meridian(0.5), [1.0, 0.0], 0.0, 0.1, 1.0)
            .is_none()
    );
    assert!(
        m.point(Zone::Free, &m.meridian(0.5), [-1.0, 0.1], 1.0, 0.1, 1.0)
            .is_none()
    );
    assert!(
        m.point(Zone::Free, &m.meridian(0.5), [f64::NAN, 0.1], 1.0, 0.1, 1.0)
            .is_none()
    );
}
