//! The curve of a press: pressure rise, force and indentation, each as a function of any of the others.

/// One point of a press.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Contact {
    /// Pressure over the rest pressure, pascals, >= 0.
    pub pressure_rise: f64,
    /// Force on the plate, newtons, >= 0.
    pub force: f64,
    /// Indentation of the pole, metres, >= 0.
    pub indentation: f64,
}

#[cfg(feature = "std")]
pub use sampled::{Curve, CurveError, CurveFailure};

#[cfg(feature = "std")]
mod sampled {
    use super::Contact;
    use std::fmt;

    /// Points of one interpolating polynomial: degree five.
    const STENCIL: usize = 6;

    /// A press interpolated between solved states.
    ///
    /// At first contact the pressure rise is proportional to the force, and the indentation behaves as
    /// `H ~ dP (A - B ln dP)`, so neither is a polynomial in the other. `ln(F / dP)` and `ln(H / dP)` as
    /// functions of `ln dP` are smooth all the way down, and are what is interpolated (locally, with
    /// polynomials of degree five). Below the first state the asymptotes themselves are used.
    #[derive(Clone, Debug)]
    pub struct Curve {
        points: Vec<Contact>,
        by_rise: Vec<[f64; 3]>,
        by_indentation: Vec<[f64; 3]>,
    }

    /// Why points do not make a curve.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub enum CurveError {
        /// Fewer points than one interpolating polynomial needs.
        TooFewPoints {
            /// How many were given.
            found: usize,
            /// How many are needed.
            needed: usize,
        },
        /// Rise, force and indentation must all grow strictly from point to point, from above zero.
        NotMonotone {
            /// The last point before the offence.
            before: Contact,
            /// The offending point.
            after: Contact,
        },
    }

    impl fmt::Display for CurveError {
        fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            match self {
                Self::TooFewPoints { found, needed } => {
                    write!(f, "a curve needs at least {needed} points, found {found}")
                }
                Self::NotMonotone { before, after } => write!(
                    f,
                    "pressure and force do not grow strictly with indentation: at {:.6} mm the pressure rise is \
                     {:.6} Pa and the force {:.6} N, at {:.6} mm {:.6} Pa and {:.6} N",
                    before.indentation * 1e3,
                    before.pressure_rise,
                    before.force,
                    after.indentation * 1e3,
                    after.pressure_rise,
                    after.force
                ),
            }
        }
    }

    impl core::error::Error for CurveError {}

    /// Why a model gives no curve; its own errors are `E`.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub enum CurveFailure<E> {
        /// A state is missing.
        Model(E),
        /// Pressure or force do not grow with indentation.
        Shape(CurveError),
    }

    impl<E> CurveFailure<E> {
        /// From that of a model with errors of another kind.
        pub fn of<M: Into<E>>(failure: CurveFailure<M>) -> Self {
            match failure {
                CurveFailure::Model(error) => Self::Model(error.into()),
                CurveFailure::Shape(error) => Self::Shape(error),
            }
        }
    }

    impl<E: fmt::Display> fmt::Display for CurveFailure<E> {
        fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            match self {
                Self::Model(error) => error.fmt(f),
                Self::Shape(error) => error.fmt(f),
            }
        }
    }

    impl<E: fmt::Debug + fmt::Display> core::error::Error for CurveFailure<E> {}

    impl Curve {
        /// A curve through states of increasing indentation, the state of rest left out.
        ///
        /// # Errors
        /// [`CurveError`] when the points are too few, or not strictly increasing in all three.
        pub fn new(points: Vec<Contact>) -> Result<Self, CurveError> {
            if points.len() < STENCIL {
                return Err(CurveError::TooFewPoints {
                    found: points.len(),
                    needed: STENCIL,
                });
            }
            let mut before = Contact::default();
            for &after in &points {
                let grows = after.pressure_rise > before.pressure_rise
                    && after.force > before.force
                    && after.indentation > before.indentation;
                if !grows {
                    return Err(CurveError::NotMonotone { before, after });
                }
                before = after;
            }
            let by_rise = points
                .iter()
                .map(|p| logarithms(p.pressure_rise, p.force, p.indentation))
                .collect();
            let by_indentation = points
                .iter()
                .map(|p| logarithms(p.indentation, p.pressure_rise, p.force))
                .collect();
            Ok(Self {
                points,
                by_rise,
                by_indentation,
            })
        }

        /// The solved states the curve runs through.
        pub fn points(&self) -> &[Contact] {
            &self.points
        }

        /// The last point: largest rise, force and indentation.
        pub fn end(&self) -> Contact {
            self.points[self.points.len() - 1]
        }

        /// The contact at a pressure rise in pascals, held at the ends of the curve (0 .. [`Curve::end`]).
        pub fn at_pressure_rise(&self, pressure_rise: f64) -> Contact {
            if pressure_rise.is_nan() || pressure_rise <= 0.0 {
                return Contact::default();
            }
            let end = self.end();
            if pressure_rise >= end.pressure_rise {
                return end;
            }
            let first = self.points[0];
            if pressure_rise < first.pressure_rise {
                let force = first.force * (pressure_rise / first.pressure_rise);
                let indentation = toe(self.points[0], self.points[1], pressure_rise);
                return Contact {
                    pressure_rise,
                    force,
                    indentation,
                };
            }
            let [force, indentation] = interpolate(&self.by_rise, pressure_rise);
            Contact {
                pressure_rise,
                force,
                indentation,
            }
        }

        /// The contact at an indentation in metres, held at the ends of the curve (0 .. [`Curve::end`]).
        pub fn at_indentation(&self, indentation: f64) -> Contact {
            if indentation.is_nan() || indentation <= 0.0 {
                return Contact::default();
            }
            let end = self.end();
            if indentation >= end.indentation {
                return end;
            }
            let first = self.points[0];
            if indentation < first.indentation {
                let pressure_rise = self.toe_rise(indentation);
                return self.at_pressure_rise(pressure_rise);
            }
            let [pressure_rise, force] = interpolate(&self.by_indentation, indentation);
            Contact {
                pressure_rise,
                force,
                indentation,
            }
        }

        /// Inverse of the indentation's asymptote by bisection; it is monotone below the first state.
        fn toe_rise(&self, indentation: f64) -> f64 {
            let (mut low, mut high) = (0.0, self.points[0].pressure_rise);
            while high - low > 1e-15 * high {
                let middle = 0.5 * (low + high);
                if middle <= low || middle >= high {
                    break;
                }
                if toe(self.points[0], self.points[1], middle) < indentation {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            0.5 * (low + high)
        }
    }

    /// `[ln x, ln(y / x), ln(z / x)]`.
    fn logarithms(x: f64, y: f64, z: f64) -> [f64; 3] {
        [libm::log(x), libm::log(y / x), libm::log(z / x)]
    }

    /// `H = dP (A - B ln dP)` through the first two states (facts of first contact: `H = (P0 rc^2 / 2 T0)
    /// ln(K / rc)` with `dP ~ rc^2`).
    fn toe(first: Contact, second: Contact, pressure_rise: f64) -> f64 {
        let (x1, x2) = (libm::log(first.pressure_rise), libm::log(second.pressure_rise));
        let (y1, y2) = (
            first.indentation / first.pressure_rise,
            second.indentation / second.pressure_rise,
        );
        pressure_rise * (y1 + (y2 - y1) / (x2 - x1) * (libm::log(pressure_rise) - x1))
    }

    /// Local interpolation of both columns at `x`, returned as values (not logarithms).
    fn interpolate(rows: &[[f64; 3]], x: f64) -> [f64; 2] {
        let t = libm::log(x);
        let after = rows.partition_point(|row| row[0] < t);
        let start = after.saturating_sub(STENCIL / 2).min(rows.len() - STENCIL);
        let stencil = &rows[start..start + STENCIL];
        let (mut first, mut second) = (0.0, 0.0);
        for (i, row) in stencil.iter().enumerate() {
            let mut weight = 1.0;
            for (j, other) in stencil.iter().enumerate() {
                if i != j {
                    weight *= (t - other[0]) / (row[0] - other[0]);
                }
            }
            first += weight * row[1];
            second += weight * row[2];
        }
        [x * libm::exp(first), x * libm::exp(second)]
    }

    #[cfg(test)]
    mod tests {
        use super::*;

        /// A press with the right asymptotes and a closed form: `F = k dP (1 + dP/s)`, `H = dP (A - B ln dP)`.
        fn closed_form(rise: f64) -> Contact {
            Contact {
                pressure_rise: rise,
                force: 2e-4 * rise * (1.0 + rise / 5e4),
                indentation: rise * (6e-7 - 4e-8 * libm::log(rise)),
            }
        }

        fn sampled(n: usize) -> Curve {
            let points = (0..n)
                .map(|i| closed_form(libm::exp(libm::log(60e3) * (i as f64 / (n - 1) as f64))))
                .collect();
            Curve::new(points).expect("the closed form is monotone")
        }

        #[test]
        fn interpolates_between_states_with_high_order() {
            let worst = |curve: &Curve| {
                (1..2000)
                    .map(|i| closed_form(30.0 * f64::from(i)))
                    .map(|truth| {
                        let got = curve.at_pressure_rise(truth.pressure_rise);
                        (got.force / truth.force - 1.0)
                            .abs()
                            .max((got.indentation / truth.indentation - 1.0).abs())
                    })
                    .fold(0.0, f64::max)
            };
            let (coarse, fine) = (worst(&sampled(40)), worst(&sampled(80)));
            assert!(fine < 1e-7, "{fine:e}");
            assert!(
                coarse / fine > 20.0,
                "observed order too low: {coarse:e} -> {fine:e}"
            );
        }

        #[test]
        fn follows_the_asymptotes_below_the_first_state() {
            let curve = sampled(80);
            for rise in [1e-6, 1e-3, 0.5] {
                let (got, truth) = (curve.at_pressure_rise(rise), closed_form(rise));
                assert!((got.force / truth.force - 1.0).abs() < 3e-5);
                assert!((got.indentation / truth.indentation - 1.0).abs() < 1e-9);
            }
        }

        #[test]
        fn indentation_and_pressure_rise_are_inverse() {
            let curve = sampled(80);
            for i in 1..200 {
                let point = curve.at_pressure_rise(0.02 * f64::from(i * i));
                let back = curve.at_indentation(point.indentation);
                assert!((back.pressure_rise / point.pressure_rise - 1.0).abs() < 1e-7);
                assert!((back.force / point.force - 1.0).abs() < 1e-7);
            }
        }

        #[test]
        fn holds_at_the_ends() {
            let curve = sampled(20);
            assert_eq!(curve.at_pressure_rise(0.0), Contact::default());
            assert_eq!(curve.at_pressure_rise(-1.0), Contact::default());
            assert_eq!(curve.at_pressure_rise(f64::NAN), Contact::default());
            assert_eq!(curve.at_pressure_rise(1e9), curve.end());
            assert_eq!(curve.at_indentation(1.0), curve.end());
        }

        #[test]
        fn refuses_points_that_do_not_grow() {
            let mut points = sampled(20).points().to_vec();
            points[7].force = points[6].force;
            assert!(matches!(
                Curve::new(points.clone()),
                Err(CurveError::NotMonotone { .. })
            ));
            points.truncate(3);
            assert!(matches!(
                Curve::new(points),
                Err(CurveError::TooFewPoints { found: 3, needed: 6 })
            ));
        }
    }
}
