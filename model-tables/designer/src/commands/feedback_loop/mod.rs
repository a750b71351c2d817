//! `designer loop`: fingertip and feedback actuator together.

mod diameters;
mod in_time;

use super::numbers::{self, Numbers};
use super::{bench, model, read};
use model_tables::design_file::DesignFile;
use model_tables::model::feedback::{Loop, LoopError, LoopState};
use model_tables::solid::disc::{DISC, Disc, DiscDesign};
use output::progress::Ticks;
use output::rows::{Cell, Rows};
use output::{CommandAnswer, Refusal};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

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
    /// The design file, with `[actuator] diameter_mm` and `thickness_mm`
    design: PathBuf,
    /// Indentations of the fingertip in millimetres, separated by commas
    #[arg(long, value_name = "LIST", required_unless_present = "history", conflicts_with = "history",
          value_parser = numbers::list, allow_hyphen_values = true)]
    indentation_mm: Vec<Numbers>,
    /// Diameters of the actuator in millimetres, separated by commas, in place of the design's
    #[arg(long, value_name = "LIST", conflicts_with = "history", value_parser = numbers::list,
          allow_hyphen_values = true)]
    diameter_mm: Vec<Numbers>,
    /// Solve the loop in time: CSV with columns `time_s` and `indentation_mm` or `force_n` (of the touch), linear between two rows; the
    /// first row is the untouched fingertip
    #[arg(long, value_name = "FILE")]
    history: Option<PathBuf>,
}

pub(super) fn run(arguments: &Arguments) -> Result<CommandAnswer, Refusal> {
    let file = &arguments.design;
    let design_file = read(file)?;
    let disc = disc(file, &design_file)?;
    let indentations = &numbers::all("--indentation-mm", &arguments.indentation_mm);
    let diameters = numbers::all("--diameter-mm", &arguments.diameter_mm);
    match &arguments.history {
        Some(history) => in_time::run(file, &design_file, &disc, history),
        None if !diameters.is_empty() => diameters::run(file, &design_file, &diameters, indentations),
        None => at_indentations(file, &design_file, &disc, indentations),
    }
}

/// The actuator of a design.
fn disc(file: &Path, design_file: &DesignFile) -> Result<DiscDesign, Refusal> {
    design_file.disc().ok_or_else(|| {
        Refusal::about(
            file,
            &"the loop needs the actuator as a disc: give [actuator] diameter_mm and thickness_mm",
        )
    })
}

/// Fingertip and actuator at rest, and how `auto` came to the fingertip's model.
fn at_rest(
    file: &Path,
    design_file: &DesignFile,
    disc: &DiscDesign,
) -> Result<(Loop, Option<String>), Refusal> {
    let model = model::of(file, design_file)?;
    let actuator = Disc::new(disc, DISC).map_err(|error| Refusal::about(file, &error))?;
    let haptic =
        Loop::new(model.kind, &model.design, actuator).map_err(|error| Refusal::about(file, &error))?;
    Ok((haptic.with_gas(design_file.trapped_gas()), model.note))
}

/// The columns after the indentation.
fn cells(state: &LoopState) -> [Cell; 6] {
    [
        Cell::Number(state.touch.pressure_rise / 1e3),
        Cell::Number(state.touch.force),
        Cell::Number(state.actuator.force),
        state.transmission().map_or(Cell::Empty, Cell::Number),
        Cell::Number(state.actuator.travel * 1e3),
        Cell::Number(state.volume_moved * 1e9),
    ]
}

/// A line each second while states are solved: a thin actuator takes seconds for one.
struct Solving {
    done: Arc<AtomicUsize>,
    _ticks: Ticks,
}

impl Solving {
    fn begin(count: usize) -> Self {
        let done = Arc::new(AtomicUsize::new(0));
        let (counted, begun) = (done.clone(), Instant::now());
        Self {
            done,
            _ticks: Ticks::begin(move || {
                format!(
                    "loop: {:.0} s, {} of {count} states",
                    begun.elapsed().as_secs_f64(),
                    counted.load(Ordering::Relaxed)
                )
            }),
        }
    }

    fn is_done(&self) {
        self.done.fetch_add(1, Ordering::Relaxed);
    }
}

/// The state at an indentation, metres; beyond the end of the loop, that end.
fn state_at(haptic: &mut Loop, indentation: f64) -> Result<LoopState, LoopError> {
    haptic
        .at_indentation(indentation)
        .map_err(|error| haptic.explained(error, indentation))
}

fn at_indentations(
    file: &Path,
    design_file: &DesignFile,
    disc: &DiscDesign,
    asked: &[f64],
) -> Result<CommandAnswer, Refusal> {
    let solving = Solving::begin(asked.len());
    let (mut haptic, note) = at_rest(file, design_file, disc)?;
    let mut rows = Rows::new(COLUMNS);
    let mut deepest = None;
    for &asked in asked {
        let indentation = bench::depth(&design_file.calibration, asked);
        let state = state_at(&mut haptic, indentation).map_err(|error| Refusal::about(file, &error))?;
        let mut row = vec![Cell::Number(asked)];
        row.extend(cells(&state));
        rows.push(row);
        solving.is_done();
        if deepest.is_none_or(|(depth, _)| indentation > depth) {
            deepest = Some((indentation, state));
        }
    }
    let mut notes: Vec<String> = note.into_iter().collect();
    notes.extend(of_rest(&haptic));
    if let Some((indentation, state)) = deepest.filter(|(_, state)| state.touch.pressure_rise > 0.0) {
        notes.push(of_constant_compliance(&haptic, indentation, &state));
    }
    Ok(CommandAnswer { rows, notes })
}

/// What the actuator does before anything touches, where the fingertip is inflated.
fn of_rest(haptic: &Loop) -> Option<String> {
    let at_rest = haptic.actuator_at_rest();
    (at_rest.pressure > 0.0).then(|| {
        format!(
            "at rest, {:.6} kPa, the actuator presses with {:.6} N and its centre has moved by {:.6} mm: feedback force and travel \
             are from no pressure on",
            at_rest.pressure / 1e3,
            at_rest.force,
            at_rest.travel * 1e3
        )
    })
}

/// How well a constant compliance reproduces a state of the loop.
fn of_constant_compliance(haptic: &Loop, indentation: f64, state: &LoopState) -> String {
    let told = match haptic.with_constant_compliance(indentation) {
        Ok(touch) => format!(
            "pressure rise {:+.2} %, touch force {:+.2} %",
            100.0 * (touch.pressure_rise / state.touch.pressure_rise - 1.0),
            100.0 * (touch.force / state.touch.force - 1.0)
        ),
        Err(error) => format!("no state ({error})"),
    };
    format!(
        "a constant compliance of {:.4} mm^3/kPa, that of actuator, air and tubing at rest, in their place gives at {:.4} mm: {told}",
        haptic.constant_compliance() * 1e12,
        indentation * 1e3
    )
}
