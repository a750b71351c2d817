//! `designer solve`: pressed states.

use super::at_force::{self, NoForce};
use super::model::{self, Model};
use super::numbers::{self, Numbers};
use super::{Field, bench, read, refuse_plain, warn, warn_of_instability};
use model_tables::curve::Contact;
use model_tables::design_file::{Calibration, DesignFile};
use model_tables::limit::Limit;
use model_tables::material::stability::Margin;
use model_tables::membrane::press::Press;
use model_tables::membrane::state::PressedState;
use model_tables::model::ModelError;
use model_tables::model::mesh_error::MeshError;
use model_tables::model::{Fingertip, Kind};
use model_tables::solid;
use model_tables::solid::mesh::Elements;
use output::rows::{Cell, Rows, plain};
use output::{CommandAnswer, Refusal};
use std::path::PathBuf;

const COLUMNS: &[&str] = &[
    "indentation_mm",
    "pressure_kpa",
    "pressure_rise_kpa",
    "force_n",
    "contact_radius_mm",
    "contact_area_mm2",
    "pole_stretch",
    "edge_angle_deg",
    "min_tension_n_per_m",
    "wrinkled",
];

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The design file
    design: PathBuf,
    /// Indentations in millimetres, separated by commas, or a range start:step:end; for a calibrated design, as its bench reads them
    #[arg(long, value_name = "LIST", required_unless_present = "force_n",
          value_parser = numbers::list, allow_hyphen_values = true)]
    indentation_mm: Vec<Numbers>,
    /// Forces in newtons, in place of indentations
    #[arg(long, value_name = "LIST", conflicts_with = "indentation_mm",
          value_parser = numbers::list, allow_hyphen_values = true)]
    force_n: Vec<Numbers>,
    /// Behaviour of the membrane under compression
    #[arg(long, value_name = "FIELD", value_enum, default_value_t = Field::Relaxed)]
    tension_field: Field,
}

/// A state that is asked for.
#[derive(Clone, Copy)]
struct Asked {
    /// As the bench reads its indentation, millimetres.
    read_mm: f64,
    /// From first touch on, metres.
    depth: f64,
}

/// The states that the options ask for; `limit` and `contact_at` are those of the press.
fn asked<P, E: Into<ModelError>>(
    arguments: &Arguments,
    calibration: &Calibration,
    press: &mut P,
    limit: impl Fn(&mut P) -> Result<Limit, E>,
    contact_at: impl Fn(&mut P, f64) -> Result<Contact, E>,
) -> Result<Vec<Asked>, Refusal> {
    let file = &arguments.design;
    let refuse = |error: E| Refusal::about(file, &bench::as_read(calibration, error));
    let forces = numbers::all("--force-n", &arguments.force_n);
    if forces.is_empty() {
        let indentations = numbers::all("--indentation-mm", &arguments.indentation_mm);
        let asked = |read_mm| Asked {
            read_mm,
            depth: bench::depth(calibration, read_mm),
        };
        return Ok(indentations.into_iter().map(asked).collect());
    }
    let end = limit(press).map_err(refuse)?;
    forces
        .into_iter()
        .map(|force| {
            let depth =
                at_force::depth(force, &end, |depth| contact_at(press, depth)).map_err(
                    |error| match error {
                        NoForce::Beyond(reason) => Refusal::about(file, &reason),
                        NoForce::Model(error) => refuse(error),
                    },
                )?;
            Ok(Asked {
                read_mm: 1e3 * calibration.indentation_read(depth),
                depth,
            })
        })
        .collect()
}

pub(super) fn run(arguments: &Arguments) -> Result<CommandAnswer, Refusal> {
    let file = &arguments.design;
    let design_file = read(file)?;
    let calibration = &design_file.calibration;
    if calibration.curve.is_some() {
        warn(
            file,
            &"its tables come from the data in [calibration]; these states are the model's",
        );
    }
    let model = model::of(file, &design_file)?;
    if let Kind::Solid(elements) = model.kind {
        refuse_plain(file, arguments.tension_field)?;
        return solid(arguments, &design_file, &model, elements);
    }
    let mut press = Press::new(&model.design, arguments.tension_field.into())
        .map_err(|error| Refusal::about(file, &error))?;
    let asked = asked(
        arguments,
        calibration,
        &mut press,
        Press::limit,
        Press::contact_at,
    )?;
    // Solved from shallow to deep, given in the order asked.
    let mut order: Vec<usize> = (0..asked.len()).collect();
    order.sort_by(|&a, &b| asked[a].depth.total_cmp(&asked[b].depth));
    let mut states: Vec<Option<PressedState>> = vec![None; order.len()];
    let (mut worst, mut deepest) = (None, 0.0_f64);
    for i in order {
        let Asked { read_mm, depth } = asked[i];
        let state = press
            .at_indentation(depth)
            .map_err(|error| Refusal::about(file, &bench::as_read(calibration, error)))?;
        deepest = deepest.max(depth);
        states[i] = Some(state);
        let margin = press.stability();
        if worst.is_none_or(|(_, least): (f64, Margin)| margin.value < least.value) {
            worst = Some((read_mm, margin));
        }
    }
    if let Some((indentation, margin)) = worst {
        warn_of_instability(file, &format!("at indentation {indentation} mm"), margin);
    }
    let mut tip = Fingertip::Membrane(Box::new(press));
    bench::warn_of_strain(file, &design_file, &mut tip, deepest);
    let error = model::note_of_error(&design_file, &mut tip, deepest);
    let mut rows = Rows::new(COLUMNS);
    for (state, asked) in states.iter().flatten().zip(&asked) {
        rows.push(vec![
            Cell::Number(asked.read_mm),
            Cell::Number(calibration.pressure_read(state.shape.pressure) * 1e-3),
            Cell::Number(calibration.pressure_read(state.pressure_rise) * 1e-3),
            Cell::Number(state.force),
            Cell::Number(state.contact_radius * 1e3),
            Cell::Number(state.contact_area() * 1e6),
            Cell::Number(state.shape.pole_stretch),
            Cell::Number(state.shape.edge_angle.to_degrees()),
            Cell::Number(state.shape.least_tension()),
            Cell::word(state.shape.wrinkling.word()),
        ]);
    }
    Ok(CommandAnswer {
        rows,
        notes: model.note.into_iter().chain([error]).collect(),
    })
}

/// The states of a solid.
fn solid(
    arguments: &Arguments,
    design_file: &DesignFile,
    model: &Model,
    elements: Elements,
) -> Result<CommandAnswer, Refusal> {
    let calibration = &design_file.calibration;
    let refuse = |error: ModelError| Refusal::about(&arguments.design, &bench::as_read(calibration, error));
    let mut press = solid::press::Press::new(&model.design, elements).map_err(refuse)?;
    let mut rows = Rows::new(COLUMNS);
    let mut deepest = 0.0_f64;
    let mut contacts = Vec::new();
    let asked = asked(
        arguments,
        calibration,
        &mut press,
        solid::press::Press::limit,
        solid::press::Press::contact_at,
    )?;
    for Asked { read_mm, depth } in asked {
        let state = press
            .at_indentation(depth)
            .map_err(|error| refuse(error.into()))?;
        deepest = deepest.max(depth);
        contacts.push(Contact {
            indentation: depth,
            pressure_rise: state.pressure_rise,
            force: state.force,
        });
        rows.push(vec![
            Cell::Number(read_mm),
            Cell::Number(calibration.pressure_read(state.pressure) * 1e-3),
            Cell::Number(calibration.pressure_read(state.pressure_rise) * 1e-3),
            Cell::Number(state.force),
            Cell::Number(state.contact_radius * 1e3),
            Cell::Number(state.contact_area() * 1e6),
            Cell::Number(state.pole_stretch),
            // The rim is held over the whole wall, and a wall may push.
            Cell::Empty,
            Cell::Empty,
            Cell::Empty,
        ]);
    }
    let mut notes: Vec<String> = model.note.iter().cloned().collect();
    notes.push(match MeshError::of(&model.design, elements, &contacts) {
        Ok(error) => error.to_string(),
        Err(error) => {
            format!("error of the mesh: not known, as a finer mesh does not have every state ({error})")
        }
    });
    notes.extend(other_state(&mut press, &contacts, calibration));
    let mut tip = Fingertip::Solid(Box::new(press));
    bench::warn_of_strain(&arguments.design, design_file, &mut tip, deepest);
    Ok(CommandAnswer { rows, notes })
}

/// Pressure rise of another state from which on it is one, pascals.
const MIN_OTHER_RISE: f64 = 1e-2;

/// A note on the first of the states beside which another is in balance.
fn other_state(
    press: &mut solid::press::Press,
    contacts: &[Contact],
    calibration: &Calibration,
) -> Option<String> {
    // At first touch every shape of the wall is in balance, with no pressure.
    let other = contacts
        .iter()
        .filter_map(|contact| press.other_state(contact.indentation).ok().flatten())
        .find(|other| other.contact.pressure_rise.abs() > MIN_OTHER_RISE)?;
    let stays = if other.is_stable {
        ""
    } else {
        ", in which the wall does not stay"
    };
    Some(format!(
        "other states exist: at {} mm also one with a pressure rise of {:.6} kPa and a force of {:.6} N{stays}; given are \
         the states that a press from rest passes",
        plain(calibration.indentation_read(other.contact.indentation) * 1e3, 6),
        calibration.pressure_read(other.contact.pressure_rise) * 1e-3,
        other.contact.force
    ))
}
