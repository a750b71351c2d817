//! `designer loop`: fingertip and feedback actuator together.

use super::{bench, finite, model, read};
use model_tables::model::feedback::Loop;
use model_tables::solid::disc::{DISC, Disc};
use output::rows::{Cell, Rows};
use output::{CommandAnswer, Refusal};
use std::path::PathBuf;

const COLUMNS: &[&str] = &[
    "indentation_mm",
    "pressure_rise_kpa",
    "touch_force_n",
    "feedback_force_n",
    "transmission",
    "actuator_travel_mm",
    "volume_moved_mm3",
];

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The design file, with `[actuator] thickness_mm`
    design: PathBuf,
    /// Indentations of the fingertip in millimetres, separated by commas
    #[arg(long, value_name = "LIST", required = true, value_delimiter = ',',
          value_parser = finite, allow_hyphen_values = true)]
    indentation_mm: Vec<f64>,
}

pub(super) fn run(arguments: &Arguments) -> Result<CommandAnswer, Refusal> {
    let file = &arguments.design;
    let design_file = read(file)?;
    let disc = design_file.disc().ok_or_else(|| {
        Refusal::about(
            file,
            &"the loop needs the actuator as a disc: give [actuator] diameter_mm and thickness_mm",
        )
    })?;
    let model = model::of(file, &design_file)?;
    let actuator = Disc::new(&disc, DISC).map_err(|error| Refusal::about(file, &error))?;
    let mut haptic =
        Loop::new(model.kind, &model.design, actuator).map_err(|error| Refusal::about(file, &error))?;
    let mut rows = Rows::new(COLUMNS);
    let mut deepest = None;
    for &asked in &arguments.indentation_mm {
        let indentation = bench::depth(&design_file.calibration, asked);
        let state = haptic
            .at_indentation(indentation)
            .map_err(|error| Refusal::about(file, &error))?;
        rows.push(vec![
            Cell::Number(asked),
            Cell::Number(state.touch.pressure_rise / 1e3),
            Cell::Number(state.touch.force),
            Cell::Number(state.actuator.force),
            state.transmission().map_or(Cell::Empty, Cell::Number),
            Cell::Number(state.actuator.travel * 1e3),
            Cell::Number(state.volume_moved * 1e9),
        ]);
        if deepest.is_none_or(|(depth, _)| indentation > depth) {
            deepest = Some((indentation, state));
        }
    }
    let mut notes: Vec<String> = model.note.into_iter().collect();
    let at_rest = haptic.actuator_at_rest();
    if at_rest.pressure > 0.0 {
        notes.push(format!(
            "at rest, {:.6} kPa, the actuator presses with {:.6} N and its centre has moved by {:.6} mm: feedback force and travel \
             are from no pressure on",
            at_rest.pressure / 1e3,
            at_rest.force,
            at_rest.travel * 1e3
        ));
    }
    if let Some((indentation, state)) = deepest.filter(|(_, state)| state.touch.pressure_rise > 0.0) {
        let constant = at_rest.compliance;
        let told = match haptic.with_constant_compliance(indentation) {
            Ok(touch) => format!(
                "pressure rise {:+.2} %, touch force {:+.2} %",
                100.0 * (touch.pressure_rise / state.touch.pressure_rise - 1.0),
                100.0 * (touch.force / state.touch.force - 1.0)
            ),
            Err(error) => format!("no state ({error})"),
        };
        notes.push(format!(
            "a constant compliance of {:.4} mm^3/kPa, the actuator's at rest, in its place gives at {:.4} mm: {told}",
            constant * 1e12,
            indentation * 1e3
        ));
    }
    Ok(CommandAnswer { rows, notes })
}
