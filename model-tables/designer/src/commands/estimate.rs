//! `designer estimate`: what the chip's table stage says at a pressure rise, bit for bit.

use super::numbers::{self, Numbers};
use super::{estimate_in_time, read, tip};
use fingertip::signal::contact::contact;
use fingertip::signal::design::Design;
use fingertip::signal::loaded_design::LoadedDesign;
use fingertip::status::{Status, Warnings};
use model_tables::design_file::DesignFile;
use model_tables::generate::{GenerateError, Generated, from_design, from_design_or_worse};
use model_tables::units::PressureRise;
use output::rows::{Cell, Rows};
use output::{CommandAnswer, Refusal};
use std::path::{Path, PathBuf};

const COLUMNS: &[&str] = &["pressure_rise_pa", "force_n", "indentation_mm", "status"];
/// Of a design whose actuator presses.
const WITH_FEEDBACK: &[&str] = &[
    "pressure_rise_pa",
    "force_n",
    "indentation_mm",
    "status",
    "feedback_force_n",
];

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The design file, or a tip file of `designer tip`
    design: PathBuf,
    /// Pressure rises above the rest pressure in pascals, separated by commas; or a range start:step:end
    #[arg(long, value_name = "LIST", required_unless_present = "history", value_parser = numbers::list, allow_hyphen_values = true)]
    pressure_rise_pa: Vec<Numbers>,
    /// CSV with columns `time_s` and `pressure_rise_kpa` or `pressure_rise_pa`, and `temperature_c` where the wall's is known; the first row is
    /// the untouched, recovered fingertip
    #[arg(long, value_name = "FILE", conflicts_with = "pressure_rise_pa")]
    history: Option<PathBuf>,
    /// Answer even if the tables do not reach the accuracy that the design requires
    #[arg(long)]
    allow_worse: bool,
}

/// The tables of a design; those that do not reach the accuracy asked for only where worse is allowed.
pub(super) fn generated(file: &Path, design: DesignFile, allow_worse: bool) -> Result<Generated, Refusal> {
    let made = if allow_worse {
        from_design_or_worse(design)
    } else {
        from_design(design)
    };
    let generated = made.map_err(|error| refusal(file, error))?;
    match generated.shortfall() {
        Some(shortfall) if !allow_worse => Err(Refusal::about(
            file,
            &format!("{shortfall}; or take these with --allow-worse"),
        )),
        _ => Ok(generated),
    }
}

/// A refusal of the generator; errors of the file name it themselves.
pub(super) fn refusal(file: &Path, error: GenerateError) -> Refusal {
    match error {
        GenerateError::File(error) => Refusal::of(error),
        error => Refusal::about(file, &error),
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<CommandAnswer, Refusal> {
    let file = &arguments.design;
    let block = tip::block(file)?;
    if let Some(history) = &arguments.history {
        if block.is_some() {
            return Err(Refusal::about(
                file,
                &"--history needs the design, whose series a temperature shifts; this is a tip file: give the design it was made of",
            ));
        }
        return estimate_in_time::run(file, history, arguments.allow_worse);
    }
    let (block, notes) = if let Some(block) = block {
        (block, Vec::new())
    } else {
        let generated = generated(file, read(file)?, arguments.allow_worse)?;
        let mut notes: Vec<String> = generated.own_error().iter().map(ToString::to_string).collect();
        notes.extend(generated.band.iter().map(ToString::to_string));
        (generated.binary(), notes)
    };
    let (design, _) = LoadedDesign::read(&block).map_err(|error| Refusal::about(file, &error))?;
    let bits = design.parameters().pressure_fraction_bits;
    let feels = design.feedback(PressureRise(0)).is_some();
    let mut rows = Rows::new(if feels { WITH_FEEDBACK } else { COLUMNS });
    for &pascals in &numbers::all("--pressure-rise-pa", &arguments.pressure_rise_pa) {
        let rise = PressureRise::from_pascals(pascals, bits);
        let reading = contact(&design, rise, Warnings::NONE);
        let status = Status::qualified(reading.warnings);
        let mut row = vec![
            Cell::Number(pascals),
            Cell::Number(reading.force.newtons()),
            Cell::Number(reading.indentation.metres() * 1e3),
            Cell::Text(status.to_string()),
        ];
        row.extend(design.feedback(rise).map(|force| Cell::Number(force.newtons())));
        rows.push(row);
    }
    Ok(CommandAnswer { rows, notes })
}
