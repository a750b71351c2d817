//! A hand that knows how deep the fingertip is pressed: force without any curvature and the curvature, through the whole signal path.

use fingertip::image::ImageDesign;
use fingertip::link::command::{Command, Outcome};
use fingertip::link::telemetry::{Answer, Message};
use fingertip::signal::design::Design;
use fingertip::signal::loaded_design::LoadedDesign;
use host_tests::design;
use host_tests::world::{World, rest, sample};
use model_tables::design_file::DesignFile;
use model_tables::generate::{self, Generated};
use model_tables::table::known::{KnownContact, doubts};

/// States of balls by an independent finite-element code, of the default design's dome (`model-tables/tests/reference/object.json`):
/// radius in millimetres, pressure in kilopascals, force in newtons, indentation in millimetres. 0: a plate.
const STATES: [[f64; 4]; 24] = [
    [5.0, 0.561_201, 0.064_487_8, 0.25],
    [5.0, 1.319_01, 0.132_129, 0.5],
    [5.0, 3.548_23, 0.279_473, 1.0],
    [5.0, 7.267_72, 0.507_036, 1.5],
    [5.0, 13.057_7, 0.916_671, 2.0],
    [5.0, 21.250_7, 1.615_51, 2.5],
    [8.0, 0.584_123, 0.066_901_6, 0.25],
    [8.0, 1.388_41, 0.138_377, 0.5],
    [8.0, 3.924_68, 0.311_663, 1.0],
    [8.0, 8.498_38, 0.625_282, 1.5],
    [8.0, 15.962_5, 1.243_54, 2.0],
    [8.0, 26.950_6, 2.370_74, 2.5],
    [20.0, 0.621_192, 0.070_859_5, 0.25],
    [20.0, 1.528_24, 0.151_81, 0.5],
    [20.0, 4.849_79, 0.404_914, 1.0],
    [20.0, 11.591, 0.991_338, 1.5],
    [20.0, 23.528_3, 2.323_7, 2.0],
    [20.0, 42.510_8, 5.053_42, 2.5],
    [0.0, 0.671_621, 0.076_402_5, 0.25],
    [0.0, 1.791_01, 0.180_063, 0.5],
    [0.0, 6.744_32, 0.638_795, 1.0],
    [0.0, 18.284, 2.009_65, 1.5],
    [0.0, 41.548_7, 5.758_22, 2.0],
    [0.0, 82.892, 14.650_5, 2.5],
];

/// The default design with an `[object]`.
fn against(object: &str) -> Generated {
    let text = std::fs::read_to_string(design("index-fingertip-elastic")).expect("a shipped design");
    let file = DesignFile::parse(&format!("{text}\n[object]\n{object}\n"), "object.toml").expect("a design");
    generate::from_design(file).expect("tables")
}

/// A fingertip that is pressed to a rise in pascals within half a second, and held.
fn pressed<D: Design + Clone>(design: &D, rise: f64) -> World<D> {
    let untouched = rest(design);
    let mut world = World::zeroed(design.clone(), untouched);
    for step in 1..=600 {
        let part = f64::from(step.min(500)) / 500.0;
        world.step(1000, Ok(sample(design, untouched + part * rise)));
    }
    world
}

/// What a known indentation in millimetres is answered with.
fn ask<D: Design + Clone>(world: &mut World<D>, millimetres: f64) -> Answer {
    let known = (1e6 * millimetres) as i32;
    assert!(world.ask(Command::Indentation { known }).is_none());
    match world.emitted.last() {
        Some(Message::Answer(answer)) => *answer,
        other => panic!("no answer: {other:?}"),
    }
}

/// The errors of the force, percent, from 8 kPa on, and below; the curvatures of balls from 8 kPa on within three sigma.
fn errors(object: &str) -> [f64; 2] {
    let generated = against(object);
    let block = generated.binary();
    let (design, _) = LoadedDesign::read(&block).expect("it was just written");
    let mut most = [0.0_f64; 2];
    for [radius, pressure, force, indentation] in STATES {
        if 1e3 * pressure
            >= design
                .last_rise()
                .pascals(design.parameters().pressure_fraction_bits)
        {
            continue;
        }
        let answer = ask(&mut pressed(&design, 1e3 * pressure), indentation);
        assert_eq!(answer.outcome, Outcome::Done, "{radius} mm at {pressure} kPa");
        let told: KnownContact = answer.known.expect("it is done");
        assert_eq!(answer.findings, told.doubts);
        let percent = 100.0 * (told.force.newtons() / force - 1.0);
        let truth = if radius > 0.0 { 1e6 / radius } else { 0.0 };
        println!(
            "{radius:4} mm {pressure:8.4} kPa: force {percent:+6.2} % within {:.2} %, curvature {:6} for {truth:.0} within {} / km, doubts {}",
            100.0 * told.force_sigma.newtons() / told.force.newtons(),
            told.curvature,
            told.curvature_sigma,
            told.doubts
        );
        let deep = usize::from(pressure < 8.0);
        most[deep] = most[deep].max(percent.abs());
        assert!(
            (told.force.newtons() - force).abs() < 3.5 * told.force_sigma.newtons(),
            "{radius} mm at {pressure} kPa"
        );
        if pressure > 8.0 {
            let off = (f64::from(told.curvature) - truth).abs();
            assert!(
                off < 3.0 * f64::from(told.curvature_sigma),
                "{radius} mm at {pressure} kPa"
            );
        }
        assert_eq!(
            told.doubts & doubts::LIGHT != 0,
            pressure < 0.647,
            "{radius} mm at {pressure} kPa"
        );
    }
    most
}

#[test]
fn a_known_indentation_gives_force_and_curvature_without_knowing_the_object() {
    for object in ["", "unknown = true"] {
        let [deep, light] = errors(object);
        println!("[object] {object}: {deep:.2} % from 8 kPa on, {light:.2} % below");
        assert!(deep < 5.4, "{deep}");
        assert!(light < 14.4, "{light}");
    }
}

#[test]
fn an_indentation_beside_no_reading_is_refused() {
    let generated = against("");
    let block = generated.binary();
    let (design, _) = LoadedDesign::read(&block).expect("it was just written");
    let refused = |answer: Answer| {
        assert_eq!((answer.outcome, answer.known), (Outcome::NoReading, None));
    };
    // Untouched, and beyond the tables.
    refused(ask(&mut World::zeroed(design, rest(&design)), 1.0));
    refused(ask(&mut pressed(&design, 90e3), 2.5));
    // Without `[object]`; on a board such a frame is no command.
    refused(ask(&mut pressed(&ImageDesign, 20e3), 1.5));
}
