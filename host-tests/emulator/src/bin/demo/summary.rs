//! What the run comes to.

use crate::say::say;
use emulator::accuracy::{RunAccuracy, force_errors, is_wrong};
use emulator::plant::Plant;
use emulator::record::{Recording, Row};
use fingertip::status::{Fault, Status, Warnings};

/// No fault of anything: the zero is being measured.
pub(crate) const ZEROING: Status = Status::Fault(Fault::Zeroing);

/// Prints accuracy phase by phase and over all, then what else came over the wire.
pub(crate) fn print(record: &Recording, plant: &Plant, accuracy: &RunAccuracy) {
    say!(
        "\n                       median error / %        within 2 sigma of {} Pa / %      rms error",
        plant.transducer().noise
    );
    say!("phase      readings   force  indentation   pressure   force  indentation   pressure / Pa");
    for phase in phases(plant) {
        let of_phase = |row: &&Row| plant.scenario().phase_at(row.time) == phase;
        print_line(
            phase,
            &RunAccuracy::of(record.rows.iter().filter(of_phase), plant),
        );
    }
    print_line("all", accuracy);
    say!("(median errors: percent of reading, from 5 % of full scale up)");
    if plant.timed().is_some() {
        print_comparison(record, plant);
    }
    let count = |wanted: fn(&Status) -> bool| record.rows.iter().filter(|row| wanted(&row.status)).count();
    let ok = count(|status| *status == Status::Ok);
    say!(
        "\n{} reports: {ok} ok, of them {} wrong; {} with a warning, {} before there was a zero, {} faults without values; \
         {} frames lost, {} broken",
        record.rows.len(),
        record.rows.iter().filter(|row| is_wrong(row, plant)).count(),
        count(|status| matches!(status, Status::Warning(_))),
        count(|status| *status == ZEROING),
        count(|status| matches!(status, Status::Fault(_)) && *status != ZEROING),
        record.lost,
        record.broken.len()
    );
    let unverified = |status: &Status| matches!(status, Status::Warning(warnings) if warnings.contains(Warnings::ZERO_UNVERIFIED));
    if ok == 0 && record.rows.iter().any(|row| unverified(&row.status)) {
        say!(
            "note: the fingertip was not confirmed to be unloaded: this zero needs a tare (cargo demo --scenario long-rest)"
        );
    }
}

/// Prints what static tables of a plate make of the same pressure.
fn print_comparison(record: &Recording, plant: &Plant) {
    say!("\nmean error of the force / % of the peak force");
    say!("phase       firmware  static plate tables");
    for phase in phases(plant) {
        let of_phase = |row: &&Row| plant.scenario().phase_at(row.time) == phase;
        let rows = record.rows.iter().filter(of_phase);
        if let Some([firmware, tables]) = force_errors(rows, plant) {
            say!("{phase:<10} {firmware:>9.2}  {tables:>19.2}");
        }
    }
}

fn print_line(name: &str, accuracy: &RunAccuracy) {
    let percent = |share: f64, decimals: usize| {
        if share.is_nan() {
            "-".to_owned()
        } else {
            format!("{:.decimals$}", share * 100.0)
        }
    };
    let within = |share: f64| percent(if accuracy.readings == 0 { f64::NAN } else { share }, 1);
    say!(
        "{name:<9} {:>9}  {:>6}  {:>11}   {:>8}  {:>6}  {:>11}   {:>13.2}",
        accuracy.readings,
        percent(accuracy.force_median, 3),
        percent(accuracy.indentation_median, 3),
        within(accuracy.pressure_within),
        within(accuracy.force_within),
        within(accuracy.indentation_within),
        accuracy.pressure_error
    );
}

/// The names of the scenario's phases, each once, in order.
fn phases(plant: &Plant) -> Vec<&str> {
    let mut names: Vec<&str> = vec![];
    for phase in &plant.scenario().phase {
        if !names.contains(&phase.name.as_str()) {
            names.push(&phase.name);
        }
    }
    names
}
