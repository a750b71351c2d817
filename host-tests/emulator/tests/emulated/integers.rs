//! The chip computes what the host computes, bit for bit.

use crate::design;
use emulator::bench::{self, Listener, Moment};
use emulator::image::Image;
use emulator::plant::Plant;
use emulator::scenario::Scenario;
use fingertip::image::ImageDesign;
use fingertip::link::telemetry::{Decoder, Message};
use fingertip::signal::report::Measurement;
use probes::lookup_sweep;
use std::ops::ControlFlow;

/// More than the sweep takes, virtual seconds.
const LIMIT: f64 = 30.0;

/// Keeps the readings until the greeting that ends them.
#[derive(Default)]
struct Readings {
    decoder: Decoder,
    readings: Vec<Measurement>,
}

impl Listener for Readings {
    fn hear(&mut self, byte: u8, _moment: Moment, _plant: &Plant) -> ControlFlow<()> {
        match self.decoder.push(byte) {
            Some(Ok(frame)) => match frame.message {
                Message::Report { report, .. } => {
                    self.readings
                        .push(report.outcome.expect("the sweep has no faults"));
                    ControlFlow::Continue(())
                }
                _ => ControlFlow::Break(()),
            },
            Some(Err(error)) => panic!("a broken frame: {error}"),
            None => ControlFlow::Continue(()),
        }
    }
}

#[test]
fn host_and_chip_give_the_same_integers_everywhere_in_and_around_the_tables() {
    let image = Image::build("lookup_probe", Some(&design().path)).expect("the probe builds");
    let scenario = Scenario::named("press-hold-release").expect("it is shipped");
    let plant = design()
        .plant(scenario)
        .expect("the default design can be pressed");
    let outcome = bench::run(&image, plant, LIMIT, &[], Readings::default()).expect("the image runs");
    let expected: Vec<Measurement> = lookup_sweep::inputs(&ImageDesign::PARAMETERS)
        .map(|rise| lookup_sweep::answer(&ImageDesign, rise))
        .collect();
    assert!(expected.len() >= 10_000);
    let readings = outcome.listener.readings;
    assert_eq!(readings.len(), expected.len());
    for (i, (chip, host)) in readings.iter().zip(&expected).enumerate() {
        assert_eq!(chip, host, "input {i}");
    }
    // Not the same by being nothing: force and indentation take thousands of values.
    let mut forces: Vec<i32> = readings.iter().map(|reading| reading.force.0).collect();
    forces.sort_unstable();
    forces.dedup();
    assert!(forces.len() > 5_000, "{} different forces", forces.len());
}
