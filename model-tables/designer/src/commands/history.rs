//! `designer history`: a press in time, of a wall that relaxes.

use super::time_rows::{self, TimeRow, TimeRows};
use super::{read, warn};
use model_tables::design_file::{Calibration, DesignFile, ModelSection};
use model_tables::material::relaxation::Relaxation;
use model_tables::model::choice::elements_in_time;
use model_tables::solid::history::{Drive, History};
use model_tables::solid::mesh::Elements;
use output::progress::Progress;
use output::rows::{Cell, Rows};
use output::{CommandAnswer, Refusal};
use std::path::{Path, PathBuf};

const COLUMNS: &[&str] = &[
    "time_s",
    "indentation_mm",
    "pressure_rise_kpa",
    "force_n",
    "contact",
    "apex_depression_mm",
];
pub(super) const INDENTATION: &str = "indentation_mm";
pub(super) const FORCE: &str = "force_n";

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The design file
    design: PathBuf,
    /// CSV with columns `time_s` and `indentation_mm` or `force_n`, linear between two rows; the first row is the untouched fingertip
    #[arg(long, value_name = "FILE")]
    history: PathBuf,
}

/// The elements of a wall in time: a design's own, or those that are enough for a few tenths of a percent.
pub(super) fn elements(file: &Path, design: &DesignFile) -> Result<Elements, Refusal> {
    elements_in_time(design.model).ok_or_else(|| {
        Refusal::about(
            file,
            &"a press in time needs a wall that bends, model.kind is \"membrane\": set it to \"solid\" or \"auto\", with the \
              semi-axes of the outer surface and no [rest]",
        )
    })
}

/// What a row drives, of a column [`INDENTATION`] or [`FORCE`].
pub(super) fn drive(calibration: &Calibration, column: &str, row: &TimeRow) -> Drive {
    if column == INDENTATION {
        Drive::Indentation(calibration.indentation_of(1e-3 * row.value))
    } else {
        Drive::Force(row.value)
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<CommandAnswer, Refusal> {
    let file = &arguments.design;
    let design = read(file)?;
    let TimeRows { column, rows } = time_rows::read(&arguments.history, &[INDENTATION, FORCE])?;
    let calibration = &design.calibration;
    if calibration.curve.is_some() {
        warn(
            file,
            &"its tables come from the data in [calibration]; this press is the model's",
        );
    }
    // Without a series the wall is elastic.
    let relaxation = design.relaxation.unwrap_or(Relaxation::new(&[], 20.0, 0.0));
    let elements = elements(file, &design)?;
    let drive = |row: &TimeRow| drive(calibration, column, row);
    let begin = check(&arguments.history, &rows, drive)?;
    let mut history = History::new(&design.design(), &relaxation, elements, rows[0].time, begin)
        .map_err(|error| Refusal::about(file, &error))?;
    let mut answer = Rows::new(COLUMNS);
    let progress = Progress::new("history");
    for (i, row) in rows.iter().enumerate() {
        let instant = if i == 0 {
            history.now()
        } else {
            history
                .advance(row.time, drive(row))
                .map_err(|error| Refusal::about(&arguments.history, &error))?
        };
        progress.set((i + 1) as f64 / rows.len() as f64);
        answer.push(vec![
            Cell::Number(row.time),
            if column == INDENTATION {
                Cell::Number(row.value)
            } else {
                Cell::Number(1e3 * calibration.indentation_read(instant.indentation))
            },
            Cell::Number(1e-3 * calibration.pressure_read(instant.pressure_rise)),
            Cell::Number(instant.force),
            Cell::word(if instant.in_contact() { "yes" } else { "no" }),
            Cell::Number(1e3 * instant.apex_depression),
        ]);
    }
    progress.finish();
    let notes = note_of_auto(&design, elements).into_iter().collect();
    Ok(CommandAnswer { rows: answer, notes })
}

/// The solid that `auto` takes in time; `None` where the design says which.
pub(super) fn note_of_auto(design: &DesignFile, elements: Elements) -> Option<String> {
    (design.model == ModelSection::Auto).then(|| {
        format!(
            "in time auto takes the solid {} x {}",
            elements.through, elements.along
        )
    })
}

/// Rounding of a first touch in other units, metres.
const TOUCH: f64 = 1e-12;

/// The first row is the untouched fingertip, and no force pulls. Where the plate is in it, metres.
pub(super) fn check(
    file: &Path,
    rows: &[TimeRow],
    drive: impl Fn(&TimeRow) -> Drive,
) -> Result<f64, Refusal> {
    let begin = match drive(&rows[0]) {
        Drive::Indentation(metres) => metres,
        Drive::Force(_) => 0.0,
    };
    if begin > TOUCH {
        return Err(Refusal::about(
            file,
            &format_args!(
                "the first row is {:.6} mm deep: it has to be the untouched fingertip, with an indentation of at most first touch",
                1e3 * begin
            ),
        ));
    }
    for (i, row) in rows.iter().enumerate() {
        if let Drive::Force(newtons) = drive(row) {
            if newtons < 0.0 {
                return Err(Refusal::about(
                    file,
                    &format_args!(
                        "force_n is {newtons} at time_s = {}: a plate does not pull, give 0 or more",
                        row.time
                    ),
                ));
            }
            if i == 0 && newtons > 0.0 {
                return Err(Refusal::about(
                    file,
                    &format_args!(
                        "the first row has a force of {newtons} N: it has to be the untouched fingertip, with 0"
                    ),
                ));
            }
        }
    }
    Ok(begin.min(0.0))
}
