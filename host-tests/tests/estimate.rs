//! A design that is loaded at run time, as the design tool and the simulators have it, and the one that is folded into the
//! image: the same reports, bit for bit.

use fingertip::image::ImageDesign;
use fingertip::link::command::Command;
use fingertip::link::telemetry::Message;
use fingertip::signal::contact::contact;
use fingertip::signal::design::{Design, NoSuchObject, Parameters};
use fingertip::signal::loaded_design::LoadedDesign;
use fingertip::signal::report::Report;
use fingertip::signal::tip_design::TipDesign;
use fingertip::signal::wall::Memory;
use fingertip::signal::zero::surroundings::Surroundings;
use fingertip::status::{Fault, Warnings};
use fingertip::transducer::driver::Sample;
use fingertip::units::Millipascals;
use host_tests::world::{World, full_scale, rest, sample};
use host_tests::{design, workspace};
use model_tables::design_file::DesignFile;
use model_tables::generate::{self, Generated};
use model_tables::material::series::WallSeries;
use model_tables::random::Random;
use model_tables::table::ContactLookup as _;
use model_tables::table::Reading;
use model_tables::table::law::Touched;
use model_tables::units::PressureRise;

/// The design of the image, solved anew.
fn generated() -> Generated {
    let path = std::env::var_os("FINGERTIP_DESIGN").map_or_else(
        || design("index-fingertip-elastic"),
        |path| workspace().join(path),
    );
    let generated = generate::from_design_file(&path).expect("the image was built from it");
    assert_eq!(
        ImageDesign::CONSTANTS.hash,
        generated.hash(),
        "the image is of another design"
    );
    generated
}

/// The reviewed tables and wall of the design that relaxes, as they fold into an image.
#[allow(clippy::unreadable_literal, unreachable_pub, dead_code)] // generated source
mod golden {
    include!("../../model-tables/golden/index-fingertip/tables.rs");
}

#[derive(Clone, Copy, Debug)]
struct RelaxingImage;

impl RelaxingImage {
    const PARAMETERS: Parameters = Parameters::of(
        golden::DESIGN,
        golden::TABLES.layout.fraction_bits,
        PressureRise(golden::TABLES.layout.maximum),
    );
}

impl Design for RelaxingImage {
    type Wall = Memory<{ golden::RELAXATION.step.count }>;
    type Around = [Surroundings; 1];

    fn parameters(&self) -> &Parameters {
        &Self::PARAMETERS
    }

    fn series(&self) -> Option<&WallSeries> {
        Some(&golden::RELAXATION)
    }

    fn lookup(&self, rise: PressureRise) -> Reading {
        golden::TABLES.contact_at(rise)
    }
}

fn loaded(block: &[u8]) -> LoadedDesign<'_> {
    LoadedDesign::read(block).expect("it was just written").0
}

#[test]
fn a_loaded_design_is_that_of_the_image() {
    let generated = generated();
    let block = generated.binary();
    let loaded = loaded(&block);
    assert_eq!(loaded.parameters(), ImageDesign.parameters());
    let end = ImageDesign::PARAMETERS.last_rise.0;
    for count in (-2_000..end + 2_000).step_by(97).chain([-i32::MAX, -1, i32::MAX]) {
        let rise = PressureRise(count);
        let [tool, chip] = [
            contact(&loaded, rise, Warnings::NONE),
            contact(&ImageDesign, rise, Warnings::NONE),
        ];
        assert_eq!(tool, chip, "{count}");
    }
}

/// The reports, and what else goes on the line, of presses, pauses, faults, outliers, commands and drift, drawn from a seed.
fn life<D: Design + Copy>(design: D, seed: u64) -> (Vec<Report>, Vec<Message>) {
    let mut random = Random(seed);
    let (rest, full) = (rest(&design), full_scale(&design));
    let mut world = World::zeroed(design, rest);
    let (mut from, mut to) = (0.0, 0.0);
    let mut reports = vec![];
    for millisecond in 0..20_000 {
        let share = f64::from(millisecond % 250) / 250.0;
        if millisecond % 250 == 0 {
            from = to;
            to = [0.0, full * 1.1 * random.unit()][random.below(2) as usize];
        }
        let drift = 1e-4 * f64::from(millisecond);
        let pascals = rest + drift + from + (to - from) * share + 5.0 * random.normal();
        let mut next = Ok(sample(&design, pascals));
        let mut later = 1000;
        match random.below(400) {
            0 => next = Err(Fault::SensorOpen),
            1 => {
                next = next.map(|sound| Sample {
                    pressure: Millipascals(random.bits() as i32),
                    ..sound
                });
            }
            2 => later = 30_000,
            3 => {
                world.ask(Command::Tare);
            }
            _ => {}
        }
        reports.push(world.step(later, next));
    }
    (reports, world.emitted)
}

#[test]
fn reports_of_a_loaded_design_are_those_of_the_image() {
    let generated = generated();
    same_lives(&generated.binary(), ImageDesign);
}

/// The design of a board that a tip can be loaded onto, with its own tables and with the same ones loaded.
#[test]
fn reports_of_a_board_that_takes_a_tip_are_those_of_the_image() {
    let generated = generated();
    let block = generated.binary();
    for design in [TipDesign::Image(ImageDesign), TipDesign::Loaded(loaded(&block))] {
        assert_eq!(life(design, 7), life(ImageDesign, 7));
    }
}

/// With the memory of a wall that relaxes.
#[test]
fn reports_of_a_loaded_wall_that_relaxes_are_those_of_the_image() {
    let generated = generate::from_design_file(&design("index-fingertip")).expect("it is shipped");
    let block = generated.binary();
    let tool = loaded(&block);
    assert_eq!(tool.parameters(), RelaxingImage.parameters());
    assert_eq!(tool.series(), RelaxingImage.series());
    same_lives(&block, RelaxingImage);
}

fn same_lives<D: Design + Copy>(block: &[u8], image: D) {
    let loaded = loaded(block);
    for seed in 0..4 {
        let (tool, chip) = (life(loaded, seed), life(image, seed));
        for (tool, chip) in tool.0.iter().zip(&chip.0) {
            assert_eq!(tool, chip, "seed {seed}");
        }
        assert_eq!(tool.1, chip.1, "seed {seed}");
        // Not the same by being nothing.
        let readings = chip.0.iter().filter(|report| report.outcome.is_ok()).count();
        assert!(readings > 10_000, "seed {seed}: {readings} readings");
    }
}

/// The default design with a ball of 8 mm.
fn with_object() -> Generated {
    let text = std::fs::read_to_string(design("index-fingertip")).expect("a shipped design");
    let text = format!("{text}\n[object]\nradius_mm = 8.0\n");
    let file = DesignFile::parse(&text, "object.toml").expect("a design");
    generate::from_design(file).expect("tables")
}

/// What the generator certifies of an object is what the loaded design answers, and a design without `[object]` refuses.
#[test]
fn what_is_touched_changes_the_answers_bit_for_bit() {
    let generated = with_object();
    let objects = generated.certified.object.as_ref().expect("of balls");
    let plate = &generated.certified.tables;
    let block = generated.binary();
    let mut loaded = loaded(&block);
    for touched in [
        None,
        Some(Touched::Ball(5_000)),
        Some(Touched::Cylinder(5_000)),
        Some(Touched::Plate),
    ] {
        if let Some(touched) = touched {
            loaded.touch(touched).expect("an object that it has");
        }
        let touched = touched.unwrap_or(Touched::Ball(8_000));
        let expected = objects.blended(plate, touched).expect("an object that it has");
        for count in (0..plate.layout.maximum).step_by(997) {
            let rise = PressureRise(count);
            assert_eq!(
                loaded.lookup(rise),
                expected.contact_at(rise),
                "{touched} {count}"
            );
        }
    }
    // A pen and a ball of one radius are not the same, nor is a ball a plate.
    let force = |touched| {
        let tables = objects.blended(plate, touched).expect("an object that it has");
        tables.contact_at(PressureRise(plate.layout.maximum / 4)).force
    };
    let [ball, pen, flat] = [Touched::Ball(5_000), Touched::Cylinder(5_000), Touched::Plate].map(force);
    assert!(ball < pen && pen < flat, "{ball:?} {pen:?} {flat:?}");
    // Tighter than what was solved: what was touched before still is.
    assert_eq!(loaded.touch(Touched::Ball(1_000)), Err(NoSuchObject));
    let rise = PressureRise(plate.layout.maximum / 4);
    assert_eq!(loaded.lookup(rise).force, flat);
    let mut image = ImageDesign;
    assert_eq!(image.touch(Touched::Plate), Err(NoSuchObject));
}
