//! `designer actuator`: the feedback membrane.

use super::{finite, read};
use model_tables::actuator::{Actuator, FREE_DIAMETER};
use output::rows::{Cell, Rows};
use output::{CommandAnswer, Refusal};
use std::path::PathBuf;

const COLUMNS: &[&str] = &[
    "pressure_kpa",
    "contact_diameter_mm",
    "blocked_force_n",
    "volume_change_mm3",
];

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The design file; its `[actuator] diameter_mm` is the free diameter, 9 mm if it has none
    design: PathBuf,
    /// Gauge pressures in kilopascals, separated by commas
    #[arg(long, value_name = "LIST", required = true, value_delimiter = ',',
          value_parser = finite, allow_hyphen_values = true)]
    pressure_kpa: Vec<f64>,
}

pub(super) fn run(arguments: &Arguments) -> Result<CommandAnswer, Refusal> {
    let file = &arguments.design;
    let design_file = read(file)?;
    let design = design_file.design();
    let free_diameter = design_file
        .actuator_diameter_mm
        .map_or(FREE_DIAMETER, |diameter| diameter * 1e-3);
    let actuator = Actuator::new(free_diameter, design.membrane.thickness, &design.law);
    let mut rows = Rows::new(COLUMNS);
    for &pressure in &arguments.pressure_kpa {
        let state = actuator
            .at_pressure(pressure * 1e3)
            .map_err(|error| Refusal::about(file, &error))?;
        rows.push(vec![
            Cell::Number(pressure),
            Cell::Number(state.contact_diameter * 1e3),
            Cell::Number(state.blocked_force),
            Cell::Number(state.volume_change * 1e9),
        ]);
    }
    Ok(CommandAnswer {
        rows,
        notes: Vec::new(),
    })
}
