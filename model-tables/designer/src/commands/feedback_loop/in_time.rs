//! `designer loop --history`: the loop in time.

use super::super::history::{self, FORCE, INDENTATION};
use super::super::time_rows::{self, TimeRows};
use super::super::warn;
use super::{COLUMNS, Solving, at_rest, cells, state_at};
use model_tables::design_file::DesignFile;
use model_tables::material::relaxation::Relaxation;
use model_tables::solid::disc::{DISC, DiscDesign, DiscInTime};
use model_tables::solid::history::History;
use output::rows::{Cell, Rows};
use output::{CommandAnswer, Refusal};
use std::path::Path;

/// The time, and the columns of the loop.
const IN_TIME: &[&str] = &[
    "time_s", COLUMNS[0], COLUMNS[1], COLUMNS[2], COLUMNS[3], COLUMNS[4], COLUMNS[5], COLUMNS[6],
];

/// The rows of a file: the loop of walls that relax step by step, an elastic one row by row.
pub(super) fn run(
    file: &Path,
    design: &DesignFile,
    disc: &DiscDesign,
    rows: &Path,
) -> Result<CommandAnswer, Refusal> {
    let read = time_rows::read(rows, &[INDENTATION, FORCE])?;
    if design.calibration.curve.is_some() {
        warn(
            file,
            &"its tables come from the data in [calibration]; this loop is the model's",
        );
    }
    let none = Relaxation::new(&[], 20.0, 0.0);
    let of_tip = design.relaxation.unwrap_or(none);
    let of_disc = design.actuator_relaxation().unwrap_or(none);
    let elastic = of_tip.terms().is_empty() && of_disc.terms().is_empty();
    if elastic && read.column == INDENTATION {
        return row_by_row(file, design, disc, rows, &read);
    }
    let elements = history::elements(file, design)?;
    let calibration = &design.calibration;
    let drive = |row: &_| history::drive(calibration, read.column, row);
    let begin = history::check(rows, &read.rows, drive)?;
    let actuator = DiscInTime::new(disc, &of_disc, DISC).map_err(|error| Refusal::about(file, &error))?;
    let start = [read.rows[0].time, begin];
    let mut haptic = History::with_actuator(
        &design.design(),
        &of_tip,
        elements,
        start,
        actuator,
        design.trapped_gas(),
    )
    .map_err(|error| Refusal::about(file, &error))?;
    let mut answer = Rows::new(IN_TIME);
    let solving = Solving::begin(read.rows.len());
    for (i, row) in read.rows.iter().enumerate() {
        let instant = if i == 0 {
            haptic.now()
        } else {
            haptic
                .advance(row.time, drive(row))
                .map_err(|error| Refusal::about(rows, &error))?
        };
        solving.is_done();
        let disc = haptic.actuator().expect("a history with an actuator");
        let transmission = instant.in_contact().then(|| disc.force / instant.force);
        answer.push(vec![
            Cell::Number(row.time),
            Cell::Number(if read.column == INDENTATION {
                row.value
            } else {
                1e3 * calibration.indentation_read(instant.indentation)
            }),
            Cell::Number(1e-3 * instant.pressure_rise),
            Cell::Number(instant.force),
            Cell::Number(disc.force),
            transmission.map_or(Cell::Empty, Cell::Number),
            Cell::Number(disc.travel * 1e3),
            Cell::Number(disc.volume * 1e9),
        ]);
    }
    let notes = history::note_of_auto(design, elements).into_iter().collect();
    Ok(CommandAnswer { rows: answer, notes })
}

/// Nothing relaxes, and a state depends on nothing before it.
fn row_by_row(
    file: &Path,
    design: &DesignFile,
    disc: &DiscDesign,
    rows: &Path,
    read: &TimeRows,
) -> Result<CommandAnswer, Refusal> {
    let calibration = &design.calibration;
    history::check(rows, &read.rows, |row| {
        history::drive(calibration, INDENTATION, row)
    })?;
    let solving = Solving::begin(read.rows.len());
    let (mut haptic, note) = at_rest(file, design, disc)?;
    let mut answer = Rows::new(IN_TIME);
    for row in &read.rows {
        let metres = calibration.indentation_of(1e-3 * row.value);
        let state = state_at(&mut haptic, metres.max(0.0))
            .map_err(|error| Refusal::about(rows, &format_args!("time_s = {}: {error}", row.time)))?;
        let mut out = vec![Cell::Number(row.time), Cell::Number(row.value)];
        out.extend(cells(&state));
        answer.push(out);
        solving.is_done();
    }
    let mut notes: Vec<String> = note.into_iter().collect();
    notes.extend(super::of_rest(&haptic));
    notes.push("fingertip and actuator are elastic: each row is its state at rest".to_owned());
    Ok(CommandAnswer { rows: answer, notes })
}
