use super::*;
use crate::curve::Contact;
use crate::units::PressureRise;

/// A press in closed form with the right asymptotes: force linear at first and steeper by `(1 + rise/s)^p`,
/// indentation with its logarithm, bending over from `bend` pascals on.
#[derive(Clone, Copy, Debug)]
struct Press {
    end: f64,
    newtons_per_pascal: f64,
    stiffening: f64,
    metres_per_pascal: f64,
    bend: f64,
}

/// About the prestretched Agilus30 dome, the almost unstretched one, a soft one, and a nearly straight one.
const PRESSES: [Press; 4] = [
    Press {
        end: 120e3,
        newtons_per_pascal: 2.3e-4,
        stiffening: 2e5,
        metres_per_pascal: 1.6e-7,
        bend: 3e3,
    },
    Press {
        end: 60e3,
        newtons_per_pascal: 1.9e-4,
        stiffening: 5e5,
        metres_per_pascal: 7e-7,
        bend: 500.0,
    },
    Press {
        end: 8e3,
        newtons_per_pascal: 2.6e-4,
        stiffening: 4e4,
        metres_per_pascal: 2.2e-6,
        bend: 300.0,
    },
    Press {
        end: 20e3,
        newtons_per_pascal: 1e-4,
        stiffening: 1e9,
        metres_per_pascal: 1e-7,
        bend: 2e5,
    },
];

impl Press {
    fn at(&self, rise: f64) -> Contact {
        // x ln(1 + K/x) ~ x (ln K - ln x) at first contact.
        let bent = self.bend * libm::log1p(rise / self.bend);
        Contact {
            pressure_rise: rise,
            force: self.newtons_per_pascal * rise * (1.0 + rise / self.stiffening),
            indentation: self.metres_per_pascal * bent * (1.0 + 0.15 * libm::log1p(self.end / rise)),
        }
    }

    fn curve(&self) -> Curve {
        let (first, last) = (libm::log(0.01), libm::log(self.end));
        let points = (0..120)
            .map(|i| self.at(libm::exp(first + (last - first) * f64::from(i) / 119.0)))
            .collect();
        Curve::new(points).expect("grows strictly")
    }
}

fn accuracy(percent: f64) -> Accuracy {
    Accuracy {
        force_percent_of_reading: percent,
        indentation_percent_of_reading: percent,
        from_percent_of_full_scale: 1.0,
    }
}

/// What the certificate claims, found again from the closed form itself at every `step`-th input.
#[test]
fn tables_meet_the_accuracy_against_the_closed_form() {
    for press in PRESSES {
        let certified = tables(&press.curve(), &accuracy(0.1), 10.0).expect("tables");
        let layout = &certified.tables.layout;
        let end = press.at(press.end);
        let mut count = 0;
        while count <= layout.maximum {
            let rise = PressureRise(count);
            let truth = press.at(rise.pascals(layout.pressure_fraction_bits).max(1e-12));
            let reading = certified.tables.lookup(rise);
            for (got, truth, full) in [
                (reading.force.newtons(), truth.force, end.force),
                (reading.indentation.metres(), truth.indentation, end.indentation),
            ] {
                let allowed = 1.0001e-3 * truth.max(0.01 * full);
                assert!(
                    (got - truth).abs() <= allowed,
                    "{press:?} at {count}: {got} for {truth}"
                );
            }
            count += 1 + count / 1000;
        }
        assert!(certified.certificate.holds());
        assert!(certified.certificate.comparison_error < 1e-6);
    }
}

#[test]
fn tables_reach_the_end_of_the_press_and_no_further() {
    let press = PRESSES[0];
    let layout = tables(&press.curve(), &accuracy(0.5), 10.0)
        .expect("tables")
        .tables
        .layout;
    let last = PressureRise(layout.maximum).pascals(layout.pressure_fraction_bits);
    let next = PressureRise(layout.maximum + 1).pascals(layout.pressure_fraction_bits);
    assert!(last <= press.end * (1.0 + 1e-12) && next > press.end);
}

#[test]
fn less_accuracy_takes_fewer_bytes() {
    let bytes = |percent| {
        tables(&PRESSES[1].curve(), &accuracy(percent), 10.0)
            .expect("tables")
            .tables
            .bytes()
    };
    let (fine, middle, coarse) = (bytes(0.02), bytes(0.1), bytes(1.0));
    assert!(fine > middle && middle > coarse, "{fine} {middle} {coarse}");
}

#[test]
fn two_runs_give_the_same_tables() {
    let run = || tables(&PRESSES[2].curve(), &accuracy(0.2), 5.0).expect("tables");
    assert_eq!(run(), run());
}

#[test]
fn the_unit_is_as_fine_as_the_tolerance_asks_and_the_transducer_has_use_for() {
    let curve = PRESSES[0].curve();
    let bits = |percent, resolution| *fraction_bits(&curve, &accuracy(percent), resolution).start();
    // 1/128 of the resolution: 1/2 Pa of 64 Pa, 1/16 Pa of 8 Pa.
    assert_eq!((bits(0.01, 64.0), bits(0.01, 8.0)), (1, 4));
    // Force: 2.3e-4 N/Pa, full scale 44.2 N; indentation: about 6e-7 m/Pa, full scale 2 mm. 10 % of 1 % of full
    // scale is 2 um or 3 Pa; a quarter of that is over 1/2 Pa.
    assert!(bits(10.0, 1e-3) <= 1);
    assert_eq!(bits(0.1, 1e-3), bits(0.2, 1e-3) + 1);
}

#[test]
fn says_how_far_off_an_accuracy_is_that_cannot_be_had() {
    // A step of the curve that no polynomial follows.
    let mut points = PRESSES[1].curve().points().to_vec();
    for point in &mut points[60..] {
        point.force *= 1.5;
    }
    let curve = Curve::new(points).expect("still grows");
    let error = tables(&curve, &accuracy(0.01), 10.0).expect_err("no table follows a step");
    assert!(
        matches!(error, NoTables::Inaccurate { share_of_allowed } if share_of_allowed > 1.0),
        "{error}"
    );
}

#[test]
fn refuses_outputs_that_do_not_fit_their_word() {
    let points = PRESSES[0]
        .curve()
        .points()
        .iter()
        .map(|point| Contact {
            force: 100.0 * point.force,
            ..*point
        })
        .collect();
    let error = tables(&Curve::new(points).expect("grows"), &accuracy(0.1), 10.0);
    assert!(matches!(error, Err(NoTables::TooLarge { .. })));
}

/// A transducer so coarse that the first count alone is far beyond the tolerance.
#[test]
fn a_finer_unit_is_taken_where_the_first_counts_need_it() {
    let press = Press {
        end: 1200.0,
        newtons_per_pascal: 1.5e-4,
        stiffening: 4e3,
        metres_per_pascal: 2e-5,
        bend: 40.0,
    };
    let curve = press.curve();
    let first = *fraction_bits(&curve, &accuracy(0.1), 200.0).start();
    let certified = tables(&curve, &accuracy(0.1), 200.0).expect("tables");
    assert!(certified.certificate.holds());
    assert!(certified.tables.layout.pressure_fraction_bits > first);
}
