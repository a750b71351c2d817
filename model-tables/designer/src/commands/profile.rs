//! `designer profile`: the meridian of one state.

use super::model::{self, Model};
use super::numbers::finite;
use super::{Field, bench, read, refuse_plain};
use model_tables::design_file::DesignFile;
use model_tables::membrane::Zone;
use model_tables::membrane::press::Press;
use model_tables::model::ModelError;
use model_tables::model::{Fingertip, Kind};
use model_tables::solid;
use model_tables::solid::mesh::Elements;
use output::rows::{Cell, Rows};
use output::{CommandAnswer, Refusal};
use std::path::PathBuf;

const COLUMNS: &[&str] = &[
    "parameter_rad",
    "radius_mm",
    "height_mm",
    "meridional_stretch",
    "hoop_stretch",
    "meridional_tension_n_per_m",
    "hoop_tension_n_per_m",
    "angle_deg",
    "zone",
    "wrinkled",
];

/// What `--help` says of the columns.
pub(super) const COLUMN_HELP: &str = "\
Columns:
  parameter_rad               place on the undeformed ellipse: 0 at the pole, pi/2 at the equator
  radius_mm, height_mm        deformed radius, and height over the base
  meridional_stretch          deformed over undeformed length along the meridian; 1 in a slack core
  hoop_stretch                deformed over undeformed radius
  meridional_tension_n_per_m  per deformed length
  hoop_tension_n_per_m        per deformed length
  angle_deg                   of the tangent: 0 is horizontal, 90 vertical, more is overhanging
  zone                        contact (under the plate, edge included) or free
  wrinkled                    no, wrinkled (hoop wrinkles; with `plain`: some tension is negative) or slack

Points are equally spaced in the parameter within the contact and within the free zone; one is on the
contact edge.

For a solid, the points are in the middle of the wall and equally spaced throughout. Tensions are the forces
across the whole wall, and `wrinkled` is empty.

Example:
  cargo designer profile model-tables/designs/index-fingertip.toml --indentation-mm 0.5 --points 41";

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The design file
    design: PathBuf,
    /// Indentation in millimetres; 0 is the rest state
    #[arg(long, value_name = "X", value_parser = finite, allow_hyphen_values = true)]
    indentation_mm: f64,
    /// Number of points
    #[arg(long, value_name = "N", default_value_t = 101,
          value_parser = clap::value_parser!(u32).range(3..=10_000))]
    points: u32,
    /// What the membrane does where it would have to push
    #[arg(long, value_name = "FIELD", value_enum, default_value_t = Field::Relaxed)]
    tension_field: Field,
}

pub(super) fn run(arguments: &Arguments) -> Result<CommandAnswer, Refusal> {
    let file = &arguments.design;
    let design_file = read(file)?;
    let calibration = &design_file.calibration;
    let points = arguments.points as usize;
    let model = model::of(file, &design_file)?;
    if let Kind::Solid(elements) = model.kind {
        refuse_plain(file, arguments.tension_field)?;
        return solid(arguments, &design_file, &model, elements);
    }
    let mut press = Press::new(&model.design, arguments.tension_field.into())
        .map_err(|error| Refusal::about(file, &error))?;
    let depth = bench::depth(calibration, arguments.indentation_mm);
    let meridian = press
        .profile(depth, points)
        .map_err(|error| Refusal::about(file, &bench::as_read(calibration, error)))?;
    let mut rows = Rows::new(COLUMNS);
    let mut found = 0;
    for point in meridian {
        found += 1;
        rows.push(vec![
            Cell::Number(point.parameter),
            Cell::Number(point.radius * 1e3),
            Cell::Number(point.height * 1e3),
            Cell::Number(point.meridional_stretch),
            Cell::Number(point.hoop_stretch),
            Cell::Number(point.meridional_tension),
            Cell::Number(point.hoop_tension),
            Cell::Number(point.angle.to_degrees()),
            Cell::word(point.zone.word()),
            Cell::word(point.wrinkling.word()),
        ]);
    }
    if found < points {
        let missing = points - found;
        let reason = format!(
            "at {missing} of {points} points of the meridian the law gives no stretch for the tension there; ask \
             for another indentation"
        );
        return Err(Refusal::about(file, &reason));
    }
    let error = model::note_of_error(&design_file, &mut Fingertip::Membrane(Box::new(press)), depth);
    Ok(CommandAnswer {
        rows,
        notes: model.note.into_iter().chain([error]).collect(),
    })
}

/// The meridian of a solid: the middle of its wall.
fn solid(
    arguments: &Arguments,
    design_file: &DesignFile,
    model: &Model,
    elements: Elements,
) -> Result<CommandAnswer, Refusal> {
    let calibration = &design_file.calibration;
    let refuse = |error: ModelError| Refusal::about(&arguments.design, &bench::as_read(calibration, error));
    let mut press = solid::press::Press::new(&model.design, elements).map_err(refuse)?;
    let depth = bench::depth(calibration, arguments.indentation_mm);
    let stations = press
        .profile(depth, arguments.points as usize)
        .map_err(|error| refuse(error.into()))?;
    let mut rows = Rows::new(COLUMNS);
    for station in stations {
        let zone = if station.in_contact {
            Zone::Contact
        } else {
            Zone::Free
        };
        rows.push(vec![
            Cell::Number(station.parameter),
            Cell::Number(station.radius * 1e3),
            Cell::Number(station.height * 1e3),
            Cell::Number(station.meridional_stretch),
            Cell::Number(station.hoop_stretch),
            Cell::Number(station.meridional_tension),
            Cell::Number(station.hoop_tension),
            Cell::Number(station.angle.to_degrees()),
            Cell::word(zone.word()),
            Cell::Empty,
        ]);
    }
    let error = model::note_of_error(design_file, &mut Fingertip::Solid(Box::new(press)), depth);
    Ok(CommandAnswer {
        rows,
        notes: model.note.iter().cloned().chain([error]).collect(),
    })
}
