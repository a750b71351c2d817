use super::*;
use crate::curve::Contact;
use crate::design_file::{DEFAULT_MODEL_PERCENT, DesignFile};
use crate::random::Random;
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
        model_percent: DEFAULT_MODEL_PERCENT,
    }
}

/// Tables over the whole curve.
fn made(curve: &Curve, percent: f64, resolution: f64) -> Result<Certified, NoTables> {
    tables(curve, curve.end(), &accuracy(percent), resolution)
}

/// What the certificate claims, found again from the closed form itself at every `step`-th input.
#[test]
fn tables_meet_the_accuracy_against_the_closed_form() {
    for press in PRESSES {
        let certified = made(&press.curve(), 0.1, 10.0).expect("tables");
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

/// A curve that ends with the press leaves nothing beyond it; one that goes on lets the last input be a round number.
#[test]
fn tables_reach_the_end_of_the_press_and_hardly_further() {
    let press = PRESSES[0];
    let curve = press.curve();
    let before = press.at(press.end / 1.01);
    let last = tables(&curve, before, &accuracy(0.5), 10.0)
        .expect("tables")
        .tables
        .layout;
    let reached = PressureRise(last.maximum).pascals(last.pressure_fraction_bits);
    assert!(reached >= before.pressure_rise && reached <= before.pressure_rise * (1.0 + 1.0 / 128.0));
    assert!(32 - last.maximum.leading_zeros() - last.maximum.trailing_zeros() <= 8);
    let layout = made(&press.curve(), 0.5, 10.0).expect("tables").tables.layout;
    let last = PressureRise(layout.maximum).pascals(layout.pressure_fraction_bits);
    let next = PressureRise(layout.maximum + 1).pascals(layout.pressure_fraction_bits);
    assert!(last <= press.end * (1.0 + 1e-12) && next > press.end);
}

#[test]
fn less_accuracy_takes_fewer_bytes() {
    let bytes = |percent| {
        made(&PRESSES[1].curve(), percent, 10.0)
            .expect("tables")
            .tables
            .bytes()
    };
    let (fine, middle, coarse) = (bytes(0.02), bytes(0.1), bytes(1.0));
    assert!(fine > middle && middle > coarse, "{fine} {middle} {coarse}");
}

#[test]
fn two_runs_give_the_same_tables() {
    let run = || made(&PRESSES[2].curve(), 0.2, 5.0).expect("tables");
    assert_eq!(run(), run());
}

#[test]
fn the_unit_is_as_fine_as_the_tolerance_asks_and_the_transducer_has_use_for() {
    let curve = PRESSES[2].curve();
    let bits = |percent, resolution| fraction_bits(&curve, curve.end(), &accuracy(percent), resolution)[0];
    // 1/128 of the resolution: 1/64 Pa of 2 Pa. Of 64 Pa that would be 1/2 Pa, but the press has 2^17 counts at least.
    assert_eq!(bits(0.01, 2.0), 6);
    let counts = libm::ldexp(curve.end().pressure_rise, bits(0.01, 64.0) as i32);
    assert!((131_072.0..262_144.0).contains(&counts), "{counts}");
    // Indentation: at most 2.2e-6 * (1 + 0.15 ln(8e5)) = 6.7e-6 m/Pa, full scale 2.2 mm. A quarter of 10 % of 1 % of it is
    // 0.55 um, or 0.08 Pa: over 1/16 Pa.
    assert!(bits(10.0, 1e-3) <= 4);
    assert_eq!(bits(0.1, 1e-3), bits(0.2, 1e-3) + 1);
}

/// 44 N in a word of 31 bits: at 1 Pa the highest octave has 15 bits free, and the sums would be shifted by 7 or 8.
#[test]
fn the_unit_leaves_the_sums_room_in_their_word() {
    let press = PRESSES[0];
    let [coarsest, _] = fraction_bits(&press.curve(), press.at(press.end), &accuracy(0.1), 1e3);
    let free = ((press.end as u32) << coarsest).leading_zeros() / 2;
    assert!(44.2e6 * f64::from(1 << free) < 2_147_483_648.0);
    assert!(made(&press.curve(), 0.1, 1e3).is_ok());
}

#[test]
fn says_how_far_off_an_accuracy_is_that_cannot_be_had() {
    // A step of the curve that no polynomial follows.
    let mut points = PRESSES[1].curve().points().to_vec();
    for point in &mut points[60..] {
        point.force *= 1.5;
    }
    let curve = Curve::new(points).expect("still grows");
    let error = made(&curve, 0.01, 10.0).expect_err("no table follows a step");
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
    let error = made(&Curve::new(points).expect("grows"), 0.1, 10.0);
    assert!(matches!(error, Err(NoTables::TooLarge { .. })));
}

/// A transducer so coarse that a count of it is far beyond the tolerance at first contact.
#[test]
fn a_coarse_transducer_leaves_the_first_counts_fine() {
    let press = Press {
        end: 1200.0,
        newtons_per_pascal: 1.5e-4,
        stiffening: 4e3,
        metres_per_pascal: 2e-5,
        bend: 40.0,
    };
    let curve = press.curve();
    let certified = made(&curve, 0.1, 200.0).expect("tables");
    assert!(certified.certificate.holds());
    let fine = made(&curve, 0.1, 1.0).expect("tables");
    assert!(certified.tables.bytes() <= fine.tables.bytes());
}

/// What a transducer of 50 Pa tells of a press of 60 kPa: the force grows about as the pressure does, so half a step is about
/// `25 / 60e3 = 0.042 %` of it at the end.
#[test]
fn what_the_transducer_cannot_tell_is_not_made() {
    let curve = PRESSES[1].curve();
    let [force, indentation] = resolvable_percent(&curve, curve.end(), &accuracy(0.1), 50.0);
    assert!((0.039..0.05).contains(&force), "{force}");
    assert!(indentation < force, "{indentation}");
    let asked = |percent| held_to(&accuracy(percent), [force, indentation]).force_percent_of_reading;
    assert_eq!(asked(1e-4).to_bits(), indentation.to_bits());
    assert_eq!(asked(0.1).to_bits(), 0.1_f64.to_bits());
}

/// However much is asked of it, a coarse transducer gets tables that stop where it does: no larger ones for asking more.
#[test]
fn more_than_the_transducer_tells_is_not_refused() {
    for (press, resolution) in [(PRESSES[1], 50.0), (PRESSES[2], 50.0), (PRESSES[2], 1e3)] {
        let certified = made(&press.curve(), 1e-6, resolution).expect("tables");
        let [force, indentation] = certified.resolvable_percent;
        for errors in [&certified.certificate.force, &certified.certificate.indentation] {
            assert_eq!(errors.allowed_percent.to_bits(), force.min(indentation).to_bits());
            assert!(errors.share_of_allowed() <= 1.0);
        }
    }
}

/// As accurate for a coarse transducer as for a fine one, in a coarser unit.
#[test]
fn what_the_transducer_can_tell_is_made_in_its_unit() {
    let (coarse, fine) = (
        made(&PRESSES[1].curve(), 0.1, 50.0),
        made(&PRESSES[1].curve(), 0.1, 1.0),
    );
    let (coarse, fine) = (coarse.expect("tables"), fine.expect("tables"));
    for certified in [&coarse, &fine] {
        assert_eq!(
            certified.certificate.force.allowed_percent.to_bits(),
            0.1_f64.to_bits()
        );
    }
    let bits = |certified: &Certified| certified.tables.layout.pressure_fraction_bits;
    assert!(bits(&fine) > bits(&coarse));
}

/// A dome of 9 x 7 x 1 mm Agilus30 pressed to 2.8 mm, from a rest state hardly stretched.
fn hardly_stretched(pole_stretch: f64, resolution: f64) -> Solved {
    let text = format!(
        "name = \"hardly\"\n[membrane]\nradial_semi_axis_mm = 9.0\naxial_semi_axis_mm = 7.0\nthickness_mm = 1.0\n[material]\n\
         law = \"mooney-rivlin\"\nc1_pa = 160355.0\nc2_pa = 46559.0\n[rest]\npole_stretch = {pole_stretch}\n[press]\n\
         max_indentation_mm = 2.8\n[transducer]\nkind = \"ratiometric\"\nrange_kpa = [0.0, 200.0]\n\
         resolution_pa = {resolution:?}\noutput_fraction_at_range = [0.1, 0.9]\n"
    );
    solve(&DesignFile::parse(&text, "hardly.toml").expect("a design")).expect("a curve")
}

/// At first contact the tolerance is more than the force itself: sums that merely keep to it fall there, in every shape.
#[test]
fn hardly_stretched_rests_have_small_tables() {
    for (pole_stretch, resolution) in [(1.02, 10.0), (1.005, 10.0), (1.005, 0.01)] {
        let Solved { curve, end, .. } = hardly_stretched(pole_stretch, resolution);
        let certified = tables(&curve, end, &accuracy(0.1), resolution).expect("tables");
        assert!(certified.certificate.holds());
        let (bytes, tried) = (certified.tables.bytes(), certified.tried);
        assert!(
            bytes <= 192 && tried < 1000,
            "{pole_stretch}: {bytes} bytes, {tried} tried"
        );
    }
}

/// The certificates of the first tables that are offered, every input evaluated and by bounds.
fn both_certificates(
    curve: &Curve,
    end: Contact,
    accuracy: &Accuracy,
    resolution: f64,
    spoil: impl Fn(&mut OwnedTables),
) -> [Certificate; 2] {
    let mut both = None;
    // Spoilt tables miss every accuracy, and would be let go before they are certified.
    let any = Accuracy {
        force_percent_of_reading: f64::INFINITY,
        indentation_percent_of_reading: f64::INFINITY,
        ..*accuracy
    };
    search(curve, end, accuracy, resolution, |tables, truth| {
        let mut tables = tables.clone();
        spoil(&mut tables);
        let certify = |every| certify::certify_by(&tables, curve, truth, &any, every);
        both = Some([true, false].map(|every| certify(every).expect("its ends are held")));
        both.as_ref().map(|_| ())
    })
    .unwrap_or_else(|error| panic!("{error}"));
    both.expect("offered")
}

/// What must be the same to the digit, and sums over samples that must be near.
fn assert_same([every, bounded]: [Certificate; 2]) {
    assert!(every.every_input_evaluated && !bounded.every_input_evaluated);
    assert_eq!(every.inputs, bounded.inputs);
    for (every, bounded) in [
        (&every.force, &bounded.force),
        (&every.indentation, &bounded.indentation),
    ] {
        let exact = |errors: &Errors| {
            [
                errors.of_reading.max.to_bits(),
                errors.of_full_scale.max.to_bits(),
                errors.below_percent_of_from.to_bits(),
                errors.equal_steps,
                errors.falling_steps,
                errors.largest_step as u64,
            ]
        };
        assert_eq!(exact(every), exact(bounded));
        if every.falling_steps == 0 {
            assert_eq!(every.range, bounded.range);
        }
        for (every, bounded) in [
            (every.of_reading, bounded.of_reading),
            (every.of_full_scale, bounded.of_full_scale),
        ] {
            assert!(
                (every.rms / bounded.rms - 1.0).abs() < 1e-3,
                "{every:?} {bounded:?}"
            );
            assert!(
                (every.mean - bounded.mean).abs() < 1e-3 * every.rms,
                "{every:?} {bounded:?}"
            );
        }
    }
}

#[test]
fn bounds_certify_shipped_designs_as_evaluation_does() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("designs");
    for entry in std::fs::read_dir(folder).expect("the designs") {
        let file = DesignFile::read(&entry.expect("a file").path()).expect("a shipped design");
        let Solved {
            transducer,
            curve,
            end,
            ..
        } = solve(&file).expect("a curve");
        let accuracy = file.accuracy.expect("shipped with it");
        assert_same(both_certificates(
            &curve,
            end,
            &accuracy,
            transducer.resolution_pa,
            |_| (),
        ));
    }
}

/// Presses and accuracies drawn, and tables spoilt, so that errors are large and outputs fall.
#[test]
fn bounds_certify_drawn_tables_as_evaluation_does() {
    let mut random = Random(1_406);
    let mut fell = 0;
    for spoilt in [0, 0, 0, 1, 12, 200] {
        let end = random.logarithmic(2e3, 1.5e5);
        let press = Press {
            end,
            newtons_per_pascal: random.logarithmic(5e-5, 3e-4),
            stiffening: end * random.logarithmic(1.0, 20.0),
            metres_per_pascal: 2e-3 / end * random.logarithmic(0.3, 10.0),
            bend: end * random.logarithmic(0.02, 1.0),
        };
        let (percent, resolution) = (random.logarithmic(0.05, 1.0), random.logarithmic(0.1, 10.0));
        let curve = press.curve();
        let spoil = |tables: &mut OwnedTables| {
            let last = tables.layout.words() - 1;
            for words in tables.words.chunks_mut(last + 1) {
                words[last] = words[last].wrapping_add(spoilt << 16 | spoilt);
            }
        };
        let both = both_certificates(&curve, curve.end(), &accuracy(percent), resolution, spoil);
        fell += both[0].force.falling_steps + both[0].indentation.falling_steps;
        assert_same(both);
    }
    assert!(fell > 0, "nothing spoilt");
}
