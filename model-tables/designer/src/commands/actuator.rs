//! `designer actuator`: the feedback membrane.

use super::numbers::{self, Numbers};
use super::read;
use model_tables::actuator::{Actuator, FREE_DIAMETER};
use model_tables::design_file::DesignFile;
use model_tables::membrane::disc::FlatMembrane;
use model_tables::solid::disc::{DISC, Disc, DiscDesign, FarSide};
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
    /// The design file; `[actuator] diameter_mm` is the free diameter (default 9 mm); with `thickness_mm` the disc is solved as a solid
    design: PathBuf,
    /// Gauge pressures in kilopascals, separated by commas; or a range start:step:end
    #[arg(long, value_name = "LIST", required = true, value_parser = numbers::list, allow_hyphen_values = true)]
    pressure_kpa: Vec<Numbers>,
}

pub(super) fn run(arguments: &Arguments) -> Result<CommandAnswer, Refusal> {
    let file = &arguments.design;
    let design_file = read(file)?;
    match design_file.disc() {
        Some(disc) => of_disc(arguments, &disc),
        None => by_formula(arguments, &design_file),
    }
}

/// The disc as a solid.
fn of_disc(arguments: &Arguments, design: &DiscDesign) -> Result<CommandAnswer, Refusal> {
    let refuse = |error| Refusal::about(&arguments.design, &error);
    let mut disc = Disc::new(design, DISC).map_err(refuse)?;
    let mut rows = Rows::new(COLUMNS);
    let mut notes = Vec::new();
    for &pressure in &numbers::all("--pressure-kpa", &arguments.pressure_kpa) {
        let state = disc.at_pressure(pressure * 1e3).map_err(refuse)?;
        rows.push(vec![
            Cell::Number(pressure),
            Cell::Number(2e3 * state.contact_radius),
            Cell::Number(state.force),
            Cell::Number(state.volume * 1e9),
        ]);
        notes.push(format!(
            "at {pressure} kPa the centre has moved by {:.6} mm and is stretched by {:.6}",
            state.travel * 1e3,
            state.centre_stretch
        ));
        if design.far_side == FarSide::Free
            && let Ok(mut membrane) = FlatMembrane::new(design.diameter, design.thickness, design.law)
            && let Ok(shape) = membrane.at_pressure(pressure * 1e3)
        {
            notes.push(format!(
                "a membrane of its size, which does not bend, would move by {:.6} mm there and take {:.6} mm^3",
                shape.height * 1e3,
                shape.volume * 1e9
            ));
        }
    }
    Ok(CommandAnswer { rows, notes })
}

/// The paper's formula.
fn by_formula(arguments: &Arguments, design_file: &DesignFile) -> Result<CommandAnswer, Refusal> {
    let file = &arguments.design;
    let design = design_file.design();
    let free_diameter = design_file
        .actuator
        .map_or(FREE_DIAMETER, |actuator| actuator.diameter_mm * 1e-3);
    let actuator = Actuator::new(
        free_diameter,
        design.membrane.thickness,
        &design_file.actuator_law(),
    );
    let mut rows = Rows::new(COLUMNS);
    for &pressure in &numbers::all("--pressure-kpa", &arguments.pressure_kpa) {
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
        notes: vec![format!(
            "the paper's formula, whose contact grows without bound towards {:.1} kPa: a disc clamped at its rim and held against a plate \
             passes on pressure times free area, which is less; [actuator] thickness_mm gives the disc as a solid",
            actuator.youngs_modulus / 1e3
        )],
    })
}
