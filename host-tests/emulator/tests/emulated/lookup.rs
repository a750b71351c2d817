//! What the lookup of both tables costs in the image that is shipped, as it runs.

use crate::{design, firmware};
use emulator::bench;
use emulator::inlined;
use emulator::record::{Recorder, Row};
use emulator::scenario::Scenario;
use host_tests::assert_measured_figure;
use model_tables::generate;

/// The lookup of a reading, not the one that its uncertainty takes.
const LOOKUP: &[(&str, &str)] = &[("Tables", "lookup"), ("contact", "contact")];
/// Most instructions from the tared pressure to both results and their flag: one above the certificate's count.
const MAX_INSTRUCTIONS: f64 = 29.0;
/// Virtual time: the start and half of the press.
const TIME: f64 = 1.0;

#[test]
fn both_results_and_their_flag_take_few_instructions() {
    let own = inlined::find(firmware(), LOOKUP).expect("the lookup is inlined in the image");
    let scenario = Scenario::named("press-hold-release").expect("it is shipped");
    let plant = design()
        .plant(scenario)
        .expect("the default design can be pressed");
    let recorder = Recorder::new(|_: &Row| {});
    let outcome = bench::run_watching(firmware(), plant, TIME, &[], &own, recorder).expect("it runs");

    let arrivals = own.iter().map(|at| outcome.arrivals[at].len());
    let (lookups, all) = arrivals.fold((0, 0), |(most, sum), count| (most.max(count), sum + count));
    // One lookup a reading, and readings from a fifth of a second on.
    let readings = outcome.listener.into_record().rows;
    let readings = readings.iter().filter(|row| row.reported.is_some()).count();
    assert!(
        lookups >= readings && lookups <= readings + 2 && readings > 500,
        "{lookups} of {readings}"
    );
    let taken = all as f64 / lookups as f64;
    let generated = generate::from_design_file(&design().path).expect("the default design");
    let counted = generated.certified.tables.instructions();
    println!(
        "the lookup of both tables, inlined in the image: {taken:.2} instructions a reading; the certificate says {counted}"
    );
    assert_measured_figure(
        "instructions of the lookup, from the tared pressure to both results and their flag",
        taken,
        0.01,
    );
    assert!(taken <= MAX_INSTRUCTIONS, "{taken}");
    // The certificate's figure is counted from the tables' shape.
    assert!((taken - f64::from(counted)).abs() <= 1.0, "{taken} for {counted}");
}
