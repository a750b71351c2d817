use super::*;
use proptest::prelude::*;

/// A response in closed form, as that of a soft body that is pressed: the first output is linear at first and steeper later, the
/// second has a logarithm at zero and bends over from `bend` on.
#[derive(Clone, Copy, Debug)]
struct Response {
    end: f64,
    first_per_input: f64,
    stiffening: f64,
    second_per_input: f64,
    bend: f64,
}

/// Stiff, hardly bent, soft, and nearly straight.
const RESPONSES: [Response; 4] = [
    Response {
        end: 120e3,
        first_per_input: 230.0,
        stiffening: 2e5,
        second_per_input: 160.0,
        bend: 3e3,
    },
    Response {
        end: 60e3,
        first_per_input: 190.0,
        stiffening: 5e5,
        second_per_input: 700.0,
        bend: 500.0,
    },
    Response {
        end: 8e3,
        first_per_input: 260.0,
        stiffening: 4e4,
        second_per_input: 2200.0,
        bend: 300.0,
    },
    Response {
        end: 20e3,
        first_per_input: 100.0,
        stiffening: 1e9,
        second_per_input: 100.0,
        bend: 2e5,
    },
];

impl CurvePair for Response {
    fn at(&self, input: f64) -> [f64; 2] {
        if input <= 0.0 {
            return [0.0; 2];
        }
        let bent = self.bend * libm::log1p(input / self.bend);
        [
            self.first_per_input * input * (1.0 + input / self.stiffening),
            self.second_per_input * bent * (1.0 + 0.15 * libm::log1p(self.end / input)),
        ]
    }

    fn points(&self) -> Vec<CurvePoint> {
        let (first, last) = (libm::log(0.01), libm::log(self.end));
        let inputs = (0..120).map(|i| libm::exp(first + (last - first) * f64::from(i) / 119.0));
        inputs.map(|input| self.point(input)).collect()
    }
}

impl Response {
    fn point(&self, input: f64) -> CurvePoint {
        CurvePoint {
            input,
            outputs: self.at(input),
        }
    }

    fn last(&self) -> CurvePoint {
        self.point(self.end)
    }
}

/// A response with a step of the first output in it, which no polynomial follows.
struct Stepped(Response);

impl CurvePair for Stepped {
    fn at(&self, input: f64) -> [f64; 2] {
        let [first, second] = self.0.at(input);
        [if input > 500.0 { 1.5 * first } else { first }, second]
    }

    fn points(&self) -> Vec<CurvePoint> {
        let points = self.0.points().into_iter();
        points
            .map(|point| CurvePoint {
                outputs: self.at(point.input),
                ..point
            })
            .collect()
    }
}

fn goal(percent: f64) -> AccuracyGoal {
    AccuracyGoal {
        percent_of_reading: [percent; 2],
        from_percent_of_full_scale: 1.0,
    }
}

/// Tables over the whole response.
fn made(response: &Response, percent: f64, resolution: f64) -> Result<ProvenTables, NoTables> {
    tables(response, response.last(), &goal(percent), resolution)
}

fn units(count: i32, layout: &crate::Layout) -> f64 {
    libm::ldexp(f64::from(count), -(layout.fraction_bits as i32))
}

/// What the proof claims, found again from the closed form itself at every `step`-th input.
#[test]
fn tables_meet_the_accuracy_against_the_closed_form() {
    for response in RESPONSES {
        let made = made(&response, 0.1, 10.0).expect("tables");
        let layout = &made.tables.layout;
        let full = response.at(response.end);
        let mut count = 0;
        while count <= layout.maximum {
            let truth = response.at(units(count, layout));
            let read = made.tables.lookup(count).values;
            for output in 0..2 {
                let allowed = 1.0001e-3 * truth[output].max(0.01 * full[output]);
                assert!(
                    (f64::from(read[output]) - truth[output]).abs() <= allowed,
                    "{response:?} at {count}: {read:?} for {truth:?}"
                );
            }
            count += 1 + count / 1000;
        }
        assert!(made.proof.holds());
        assert!(made.proof.comparison_error < 1e-6);
    }
}

/// Curves that end with the inputs leave nothing beyond them; ones that go on let the last input be a round number.
#[test]
fn tables_reach_the_end_and_hardly_further() {
    let response = RESPONSES[0];
    let before = response.point(response.end / 1.01);
    let layout = tables(&response, before, &goal(0.5), 10.0)
        .expect("tables")
        .tables
        .layout;
    let reached = units(layout.maximum, &layout);
    assert!(reached >= before.input && reached <= before.input * (1.0 + 1.0 / 128.0));
    assert!(32 - layout.maximum.leading_zeros() - layout.maximum.trailing_zeros() <= 8);
    let layout = made(&response, 0.5, 10.0).expect("tables").tables.layout;
    let [last, next] = [layout.maximum, layout.maximum + 1].map(|count| units(count, &layout));
    assert!(last <= response.end * (1.0 + 1e-12) && next > response.end);
}

#[test]
fn less_accuracy_takes_fewer_bytes() {
    let bytes = |percent| made(&RESPONSES[1], percent, 10.0).expect("tables").tables.bytes();
    let (fine, middle, coarse) = (bytes(0.02), bytes(0.1), bytes(1.0));
    assert!(fine > middle && middle > coarse, "{fine} {middle} {coarse}");
}

#[test]
fn two_runs_give_the_same_tables() {
    let run = || made(&RESPONSES[2], 0.2, 5.0).expect("tables");
    assert_eq!(run(), run());
}

#[test]
fn the_unit_is_as_fine_as_the_tolerance_asks_and_the_sensor_has_use_for() {
    let response = RESPONSES[2];
    let bits = |percent, resolution| fraction_bits(&response, response.last(), &goal(percent), resolution)[0];
    // 1/128 of the resolution: 1/64 of 2. Of 64 that would be 1/2, but there are 2^17 counts at least.
    assert_eq!(bits(0.01, 2.0), 6);
    let counts = libm::ldexp(response.end, bits(0.01, 64.0) as i32);
    assert!((131_072.0..262_144.0).contains(&counts), "{counts}");
    // The second output: at most 2200 (1 + 0.15 ln(8e5)) = 6.7e3 an input, full scale 2.2e6. A quarter of 10 % of 1 % of it is
    // 550, or 0.08 inputs: over 1/16.
    assert!(bits(10.0, 1e-3) <= 4);
    assert_eq!(bits(0.1, 1e-3), bits(0.2, 1e-3) + 1);
}

/// 44 million in a word of 31 bits: in whole units the highest octave has 15 bits free, and the sums would be shifted by 7 or 8.
#[test]
fn the_unit_leaves_the_sums_room_in_their_word() {
    let response = RESPONSES[0];
    let [coarsest, _] = fraction_bits(&response, response.last(), &goal(0.1), 1e3);
    let free = ((response.end as u32) << coarsest).leading_zeros() / 2;
    assert!(44.2e6 * f64::from(1 << free) < 2_147_483_648.0);
    assert!(made(&response, 0.1, 1e3).is_ok());
}

#[test]
fn says_how_far_off_an_accuracy_is_that_cannot_be_had() {
    let stepped = Stepped(RESPONSES[1]);
    let end = CurvePoint {
        input: RESPONSES[1].end,
        outputs: stepped.at(RESPONSES[1].end),
    };
    let error = tables(&stepped, end, &goal(0.01), 10.0).expect_err("no table follows a step");
    assert!(
        matches!(error, NoTables::Inaccurate { share_of_allowed } if share_of_allowed > 1.0),
        "{error}"
    );
}

#[test]
fn refuses_outputs_that_do_not_fit_their_word() {
    let response = Response {
        first_per_input: 100.0 * RESPONSES[0].first_per_input,
        ..RESPONSES[0]
    };
    let error = made(&response, 0.1, 10.0);
    assert!(matches!(error, Err(NoTables::TooLarge { .. })));
}

/// A sensor so coarse that a count of it is far beyond the tolerance at the lowest inputs.
#[test]
fn a_coarse_sensor_leaves_the_first_counts_fine() {
    let response = Response {
        end: 1200.0,
        first_per_input: 150.0,
        stiffening: 4e3,
        second_per_input: 2e4,
        bend: 40.0,
    };
    let coarse = made(&response, 0.1, 200.0).expect("tables");
    assert!(coarse.proof.holds());
    let fine = made(&response, 0.1, 1.0).expect("tables");
    assert!(coarse.tables.bytes() <= fine.tables.bytes());
}

/// What a sensor of 50 tells of 60 000: the first output grows about as the input does, so half a step is about `25 / 60e3 = 0.042 %` of
/// it at the end.
#[test]
fn what_the_sensor_cannot_tell_is_not_made() {
    let response = RESPONSES[1];
    let [first, second] = resolvable_percent(&response, response.last(), &goal(0.1), 50.0);
    assert!((0.039..0.05).contains(&first), "{first}");
    assert!(second < first, "{second}");
    let asked = |percent| attainable(&response, response.last(), &goal(percent), 50.0).percent_of_reading[0];
    assert_eq!(asked(1e-4).to_bits(), second.to_bits());
    assert_eq!(asked(0.1).to_bits(), 0.1_f64.to_bits());
}

/// However much is asked of it, a coarse sensor gets tables that stop where it does: no larger ones for asking more.
#[test]
fn more_than_the_sensor_tells_is_not_refused() {
    for (response, resolution) in [(RESPONSES[1], 50.0), (RESPONSES[2], 50.0), (RESPONSES[2], 1e3)] {
        let made = made(&response, 1e-6, resolution).expect("tables");
        let [first, second] = made.resolvable_percent;
        for errors in &made.proof.outputs {
            assert_eq!(errors.allowed_percent.to_bits(), first.min(second).to_bits());
            assert!(errors.share_of_allowed() <= 1.0);
        }
    }
}

/// As accurate for a coarse sensor as for a fine one, in a coarser unit.
#[test]
fn what_the_sensor_can_tell_is_made_in_its_unit() {
    let [coarse, fine] = [50.0, 1.0].map(|resolution| made(&RESPONSES[1], 0.1, resolution).expect("tables"));
    for made in [&coarse, &fine] {
        let allowed = made.proof.outputs[0].allowed_percent;
        assert_eq!(allowed.to_bits(), 0.1_f64.to_bits());
    }
    assert!(fine.tables.layout.fraction_bits > coarse.tables.layout.fraction_bits);
}

/// A second response in the layout of the first: it reads as the first in the lowest segment, and keeps to its accuracy beyond.
#[test]
fn a_further_curve_shares_the_layout() {
    let response = RESPONSES[1];
    let softer = Response {
        first_per_input: 1.1 * response.first_per_input,
        second_per_input: 1.2 * response.second_per_input,
        ..response
    };
    let made = made(&response, 0.1, 10.0).expect("tables");
    let before = lowest_segment_end(&made.tables).expect("segments");
    let beside = beside(&made.tables, &softer, response.last(), before, &goal(0.3)).expect("tables");
    assert_eq!(beside.layout, made.tables.layout);
    let last = beside.layout.maximum;
    let (mut count, mut previous) = (0, [0; 2]);
    while count <= last {
        let read = beside.lookup(count).values;
        assert!(read[0] >= previous[0] && read[1] >= previous[1], "{count}");
        let truth = softer.at(units(count, &beside.layout));
        if count > last / 4 {
            for output in 0..2 {
                assert!(
                    (f64::from(read[output]) / truth[output] - 1.0).abs() < 3.001e-3,
                    "{count}"
                );
            }
        }
        previous = read;
        count += 1 + count / 500;
    }
}

#[test]
fn one_output_alone_shares_the_layout() {
    let response = RESPONSES[0];
    let made = made(&response, 0.1, 10.0).expect("tables");
    let alone = single_beside(&made.tables, &response, response.last(), &goal(0.1)).expect("sums");
    assert_eq!(alone.sums.len(), made.tables.segments());
    assert!(alone.errors.holds() && alone.errors.of_reading.max <= 0.1);
}

/// The proofs of tables, every input evaluated and by bounds.
fn both_proofs(response: &Response, tables: &OwnedTables) -> [Proof; 2] {
    // Spoilt tables miss every accuracy.
    let any = AccuracyGoal {
        percent_of_reading: [f64::INFINITY; 2],
        ..goal(1.0)
    };
    [ProvenBy::Evaluation, ProvenBy::Bounds]
        .map(|by| prove(tables, response, response.last(), &any, by).expect("its ends are held"))
}

/// What must be the same to the digit, and sums over samples that must be near.
fn assert_same([every, bounded]: &[Proof; 2]) {
    assert!(every.every_input_evaluated && !bounded.every_input_evaluated);
    assert_eq!(every.inputs, bounded.inputs);
    for (every, bounded) in every.outputs.iter().zip(&bounded.outputs) {
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

/// Tables whose highest coefficients are off by this much.
fn spoilt(tables: &OwnedTables, by: i32) -> OwnedTables {
    let mut tables = tables.clone();
    let last = tables.layout.words() - 1;
    for words in tables.words.chunks_mut(last + 1) {
        words[last] = words[last].wrapping_add(by << 16 | by);
    }
    tables
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 6, ..ProptestConfig::default() })]

    /// Bounds prove what evaluation does, also of spoilt tables, whose errors are large and whose outputs may fall.
    #[test]
    fn bounds_prove_what_evaluation_does(
        end in 7.6_f64..11.9,
        first in -9.9_f64..-8.1,
        stiffening in 0.0_f64..3.0,
        second in -1.2_f64..2.3,
        bend in -3.9_f64..0.0,
        percent in -3.0_f64..0.0,
        resolution in -2.3_f64..2.3,
        by in prop::sample::select(vec![0, 1, 12, 200]),
    ) {
        let end = libm::exp(end);
        let response = Response {
            end,
            first_per_input: 1e6 * libm::exp(first),
            stiffening: end * libm::exp(stiffening),
            second_per_input: 2e6 / end * libm::exp(second),
            bend: end * libm::exp(bend),
        };
        let tables = fit(&response, response.last(), &goal(libm::exp(percent)), libm::exp(resolution)).expect("tables");
        assert_same(&both_proofs(&response, &spoilt(&tables, by)));
    }
}

/// Tables that fall are told from tables that do not, whichever way they are proven.
#[test]
fn a_fall_is_found_either_way() {
    let response = RESPONSES[1];
    let tables = fit(&response, response.last(), &goal(0.1), 10.0).expect("tables");
    let both = both_proofs(&response, &spoilt(&tables, 2000));
    assert!(both[0].outputs.iter().any(|errors| errors.falling_steps > 0));
    assert_same(&both);
    let [every, _] = both_proofs(&response, &tables);
    assert!(every.outputs.iter().all(|errors| errors.falling_steps == 0));
}
