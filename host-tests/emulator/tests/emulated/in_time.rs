//! Presses in time: a grasp and a regrasp of a wall that relaxes, and one object after another.

use crate::{Run, firmware_for};
use emulator::accuracy::{force_errors, is_wrong};
use emulator::bench;
use emulator::fingertip_design::{FingertipDesign, RunTruth, workspace};
use emulator::record::{Recorder, Row};
use emulator::scenario::Scenario;
use fingertip::link::command::{CommandKind, Outcome};
use fingertip::status::Status;
use model_tables::units::PressureRise;

/// A shipped scenario with its own design.
fn run(name: &str) -> Run {
    let scenario = Scenario::named(name).expect("it is shipped");
    let duration = scenario.duration();
    let path = scenario.design.as_ref().expect("it has a design of its own");
    let design = FingertipDesign::read(&workspace().join(path)).expect("it is well formed");
    let plant = design.plant(scenario).expect("the design can be pressed");
    let recorder = Recorder::new(|_: &Row| {});
    let outcome =
        bench::run(firmware_for(&design), plant.clone(), duration, &[], recorder).expect("the image runs");
    Run {
        plant,
        record: outcome.listener.into_record(),
        instructions: outcome.instructions,
        time: outcome.time,
        calls: outcome.calls,
        resets: outcome.resets,
        stack: outcome.stack,
        gaps: outcome.gaps,
    }
}

/// Of the firmware and of static tables, percent of the peak force, where the force is at least nine tenths of the phase's largest.
fn errors(run: &Run, phase: &str) -> [f64; 2] {
    let scenario = run.plant.scenario();
    let of_phase = |row: &&Row| scenario.phase_at(row.time) == phase;
    let rows = || run.record.rows.iter().filter(of_phase);
    let most = rows().map(|row| row.truth.force).fold(0.0, f64::max);
    let pressed = rows().filter(|row| row.truth.force >= 0.9 * most);
    let found = force_errors(pressed, &run.plant).expect("readings");
    println!(
        "{phase}: firmware {:.2} %, static tables {:.2} % of the peak force",
        found[0], found[1]
    );
    found
}

fn nothing_else_happened(run: &Run) {
    assert_eq!(
        (run.record.lost, run.record.broken.len(), run.resets.len()),
        (0, 0, 0)
    );
    assert_eq!(run.gaps, Vec::<String>::new());
    let wrong = run.record.rows.iter().find(|row| is_wrong(row, &run.plant));
    assert!(wrong.is_none(), "{wrong:?}");
}

/// A travel has the settled states of a wall that relaxes: the pressure at the end of a press of a second is that of a press of a day.
#[test]
fn the_truth_of_a_scenario_is_named() {
    let truth = |design: &str, scenario: &str| {
        let path = host_tests::design(design);
        let design = FingertipDesign::read(&path).expect("it is shipped");
        design.truth(&Scenario::named(scenario).expect("it is shipped"))
    };
    assert_eq!(truth("index-fingertip", "regrasp"), RunTruth::InTime);
    assert_eq!(truth("index-fingertip", "press-hold-release"), RunTruth::Settled);
    assert_eq!(
        truth("index-fingertip-elastic", "press-hold-release"),
        RunTruth::Model
    );
    let settled = RunTruth::Settled.to_string();
    assert!(
        settled.contains("settled") && settled.contains("regrasp"),
        "{settled}"
    );
    let relaxing = FingertipDesign::read(&host_tests::design("index-fingertip")).expect("it is shipped");
    let scenario = Scenario::named("press-hold-release").expect("it is shipped");
    let plant = relaxing.plant(scenario).expect("it can be pressed");
    assert_eq!(plant.truth(1.5), plant.truth(1.9), "held, nothing relaxes");
}

#[test]
fn a_regrasp_of_a_relaxing_wall_is_read_where_static_tables_are_far_off() {
    let run = run("regrasp");
    // Bounds of a relaxing wall: 4 % while pressed and held and after the release, 10 % in a regrasp after 10 s.
    for (phase, most) in [
        ("press", 4.0),
        ("hold", 4.0),
        ("recover", 4.0),
        ("regrasp", 10.0),
        ("rehold", 10.0),
    ] {
        let [firmware, _] = errors(&run, phase);
        assert!(firmware <= most, "{phase}: {firmware} %");
    }
    for phase in ["press", "regrasp"] {
        let [firmware, tables] = errors(&run, phase);
        assert!(
            tables > 3.0 * firmware,
            "{phase}: static tables {tables} %, firmware {firmware} %"
        );
    }
    nothing_else_happened(&run);
}

#[test]
fn an_object_is_read_better_when_the_chip_is_told() {
    let run = run("objects");
    let answers = &run.record.answers;
    assert_eq!(answers.len(), 4, "{answers:?}");
    for answer in answers {
        assert_eq!(
            (answer.command, answer.outcome),
            (CommandKind::Object, Outcome::Done),
            "{answer:?}"
        );
    }
    // A plate table is 38 % off at most on a ball of 8 mm; a ball that is told is within 1.5 % of the reading.
    let [plate, _] = errors(&run, "plate");
    assert!(plate < 0.5, "{plate} %");
    let [taken_for_a_plate, tables] = errors(&run, "ball");
    assert!(taken_for_a_plate > 10.0, "{taken_for_a_plate} %");
    assert!(
        (taken_for_a_plate - tables).abs() < 0.5,
        "{taken_for_a_plate} % and {tables} %"
    );
    let [told, _] = errors(&run, "ball, told");
    assert!(told < 1.5, "{told} %");
    let [cup, _] = errors(&run, "cup");
    let [told, _] = errors(&run, "cup, told");
    assert!(
        told < 0.5 * cup && told < 4.0,
        "told {told} %, taken for a plate {cup} %"
    );
    nothing_else_happened(&run);
}

/// Nobody names the object: the truth is in the band that the board sends, beside three standard deviations; when it is named, there is
/// no band.
#[test]
fn the_truth_of_an_unknown_object_is_in_the_band_on_the_line() {
    let run = run("unknown");
    nothing_else_happened(&run);
    let bands = &run.record.bands;
    let [first, .., last] = &bands[..] else {
        panic!("{bands:?}");
    };
    assert!(bands.iter().all(|band| band.band == first.band));
    // A band each second while nothing is named, which is at 4.2 s.
    assert!(bands.len() >= 4 && last.time.0 < 4_300_000, "{bands:?}");
    let bits = u32::from(first.pressure_fraction_bits);
    let mut judged = [0; 3];
    for row in run.record.rows.iter().filter(|row| row.status == Status::Ok) {
        let phase = run.plant.scenario().phase_at(row.time);
        let objects = ["plate", "ball of 8 mm", "ball of 20 mm"];
        let Some(object) = objects.iter().position(|object| *object == phase) else {
            continue;
        };
        let (Some(read), Some(sigma)) = (row.reported, row.sigma) else {
            continue;
        };
        let Some(band) = first
            .band
            .at(PressureRise::from_pascals(read.pressure_rise, bits))
        else {
            continue;
        };
        judged[object] += 1;
        for (read, sigma, truth, ends) in [
            (read.force, sigma.force, row.truth.force, band.force),
            (
                read.indentation,
                sigma.indentation,
                row.truth.indentation,
                band.indentation,
            ),
        ] {
            let [least, most] = ends.map(|end| read * (1.0 + 1e-3 * f64::from(end)));
            // The filter lags behind a ramp by a millisecond or two.
            let room = 3.0 * sigma + 0.01 * read;
            assert!(
                (least - room..=most + room).contains(&truth),
                "{phase} at {:.3} s: {read}, {truth}, {band:?}",
                row.time
            );
        }
    }
    assert!(judged.iter().all(|count| *count > 500), "{judged:?}");
}
