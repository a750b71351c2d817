//! The full model runs on the chip too, in emulated `f64` and without an allocation: what one state costs there.

use crate::design;
use emulator::bench::{self, Listener, Moment};
use emulator::image::Image;
use emulator::plant::Plant;
use emulator::scenario::Scenario;
use host_tests::assert_measured_figure;
use model_tables::design_file::DesignFile;
use probes::solver_states::{self, DESIGN, INDENTATIONS, LENGTH, Room, SolverState};
use std::ops::ControlFlow;
use std::path::Path;

/// More than the states take, virtual seconds.
const LIMIT: f64 = 30.0;
/// What the probe puts its solving in, by owner and name.
const MEASURED: (&str, &str) = ("solver_probe", "measured");
/// Most instructions of one Newton iteration.
const INSTRUCTIONS_PER_ITERATION: u64 = 12_000_000;
/// Most instructions of a state next to one that is known.
const INSTRUCTIONS_PER_STATE: u64 = 25_000_000;
/// Most bytes of RAM, the stack left out: what a press keeps, and what any image has.
const RAM: u64 = 128 * 1024;

/// Keeps the states until the last has come.
#[derive(Default)]
struct States {
    bytes: Vec<u8>,
}

impl Listener for States {
    fn hear(&mut self, byte: u8, _moment: Moment, _plant: &Plant) -> ControlFlow<()> {
        self.bytes.push(byte);
        if self.bytes.len() < LENGTH * SolverState::BYTES {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    }
}

fn on_the_host() -> [SolverState; LENGTH] {
    let mut room = Box::new(Room::new(DESIGN.law));
    let (rest, press) = solver_states::rest(&mut room).expect("it inflates");
    let mut states = [rest; LENGTH];
    for (state, indentation) in states[1..].iter_mut().zip(INDENTATIONS) {
        *state = solver_states::pressed(press, indentation).expect("it can be pressed");
    }
    states
}

#[test]
fn the_full_model_gives_the_same_bits_on_the_chip_and_has_its_price() {
    let image = Image::build("solver_probe", Some(&design().path)).expect("the probe builds");
    let scenario = Scenario::named("press-hold-release").expect("it is shipped");
    let plant = design()
        .plant(scenario)
        .expect("the default design can be pressed");
    let outcome = bench::run(&image, plant, LIMIT, &[MEASURED], States::default()).expect("the image runs");
    assert_eq!(outcome.resets, Vec::<String>::new());
    assert_eq!(outcome.gaps, Vec::<String>::new());

    let (records, rest) = outcome.listener.bytes.as_chunks();
    let chip: Vec<SolverState> = records
        .iter()
        .map(|&bytes| SolverState::from_bytes(bytes))
        .collect();
    assert_eq!((chip.len(), rest.len(), outcome.calls.len()), (LENGTH, 0, LENGTH));
    let bits = |state: &SolverState| (state.pressure.to_bits(), state.force.to_bits(), state.iterations);
    for (i, (chip, host)) in chip.iter().zip(&on_the_host()).enumerate() {
        assert_eq!(
            bits(chip),
            bits(host),
            "state {i}: {chip:?} on the chip, {host:?} on the host"
        );
    }

    let names = ["at rest", "pressed from rest", "pressed a little further"];
    for ((name, state), instructions) in names.iter().zip(&chip).zip(&outcome.calls) {
        let per_iteration = instructions / state.iterations;
        println!(
            "the full model {name}: {instructions} instructions, {} Newton iterations of {per_iteration}; {state:?}",
            state.iterations
        );
        assert!(
            per_iteration <= INSTRUCTIONS_PER_ITERATION,
            "{name}: {per_iteration}"
        );
    }
    let further = outcome.calls[LENGTH - 1];
    assert_measured_figure(
        "instructions of a state of the full model on the chip, millions",
        further as f64 / 1e6,
        0.02,
    );
    assert!(further <= INSTRUCTIONS_PER_STATE, "{further}");
    let size = image.size().expect("it is an image");
    println!(
        "the full model: flash {} bytes, RAM {} bytes and its stack",
        size.flash, size.ram
    );
    assert!(size.ram <= RAM, "{size:?}");
}

#[test]
fn the_states_are_those_of_a_shipped_design() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../model-tables/designs");
    let file = DesignFile::read(&folder.join("paper-prestretched.toml")).expect("it is shipped");
    assert_eq!(file.design(), DESIGN);
}
