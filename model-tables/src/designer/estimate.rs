//! `designer estimate`: what the chip's table stage says at a pressure rise, bit for bit.

use super::rows::{Cell, Rows};
use super::{Answer, Refusal, finite};
use crate::generate::{GenerateError, from_design_file};
use crate::units::PressureRise;
use std::path::{Path, PathBuf};

const COLUMNS: &[&str] = &["pressure_rise_pa", "force_n", "indentation_mm", "status"];

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The design file
    design: PathBuf,
    /// Pressure rises over the rest pressure in pascals, separated by commas
    #[arg(long, value_name = "LIST", required = true, value_delimiter = ',',
          value_parser = finite, allow_hyphen_values = true)]
    pressure_rise_pa: Vec<f64>,
}

/// A refusal of the generator; errors of the file name it themselves.
pub(super) fn refusal(file: &Path, error: GenerateError) -> Refusal {
    match error {
        GenerateError::File(error) => error.into(),
        error => Refusal::about(file, &error),
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<Answer, Refusal> {
    let file = &arguments.design;
    let generated = from_design_file(file).map_err(|error| refusal(file, error))?;
    let tables = &generated.certified.tables;
    let bits = tables.layout.pressure_fraction_bits;
    let last = PressureRise(tables.layout.maximum).pascals(bits);
    let mut rows = Rows::new(COLUMNS);
    for &pascals in &arguments.pressure_rise_pa {
        let reading = tables.lookup(PressureRise::from_pascals(pascals, bits));
        let status = if reading.saturated {
            format!("warning: saturated: lower bounds as the tables end at {last} Pa")
        } else if reading.negative {
            "warning: negative: below the rest pressure and read as no contact".to_owned()
        } else {
            "ok".to_owned()
        };
        rows.push(vec![
            Cell::Number(pascals),
            Cell::Number(reading.force.newtons()),
            Cell::Number(reading.indentation.metres() * 1e3),
            Cell::Text(status),
        ]);
    }
    Ok(Answer {
        rows,
        notes: Vec::new(),
    })
}
