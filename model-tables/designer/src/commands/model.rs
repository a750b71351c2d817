//! Which model answers for a design.

use model_tables::design::{Design, Membrane};
use model_tables::design_file::{DesignFile, ModelSection};
use model_tables::model::choice::{self, Wanted};
use model_tables::model::own_error::OwnError;
use model_tables::model::{Fingertip, Kind};
use model_tables::solid::inflation::mid_surface;
use model_tables::solid::mesh::Elements;
use output::Refusal;
use std::path::Path;

/// A model, and the design as it wants it.
pub(super) struct Model {
    /// Which.
    pub(super) kind: Kind,
    /// Semi-axes of the mid-surface for a membrane, of the outer surface for a solid.
    pub(super) design: Design,
    /// How `auto` came to it.
    pub(super) note: Option<String>,
}

/// One line about the error of the model itself down to an indentation in metres; 0 is the press that the design describes.
pub(super) fn note_of_error(design_file: &DesignFile, model: &mut Fingertip, deepest: f64) -> String {
    let wanted = Wanted::of(design_file);
    let deepest = if deepest > 0.0 { deepest } else { wanted.deepest };
    OwnError::of(model, design_file, deepest, wanted.from).to_string()
}

/// The model of a design; `auto` climbs its ladder.
pub(super) fn of(file: &Path, design_file: &DesignFile) -> Result<Model, Refusal> {
    let design = design_file.design();
    let (kind, note) = match design_file.model {
        ModelSection::Membrane => {
            return Ok(Model {
                kind: Kind::Membrane,
                design,
                note: None,
            });
        }
        ModelSection::Solid { through, along } => {
            let elements = Elements {
                through: through as usize,
                along: along as usize,
            };
            (Kind::Solid(elements), None)
        }
        ModelSection::Auto => {
            let wanted = Wanted::of(design_file);
            let taken = choice::choose(&design, &wanted).map_err(|error| Refusal::about(file, &error))?;
            let evidence = match taken.judged {
                Some((judge, error)) => format!("by the {judge} at most {:.2} % off", 100.0 * error),
                None => "no finer one has every state".to_owned(),
            };
            let note = format!(
                "auto takes the {}: {evidence}, {:.2} % allowed",
                taken.kind,
                100.0 * wanted.error
            );
            (taken.kind, Some(note))
        }
    };
    let membrane: Membrane = match kind {
        Kind::Membrane => mid_surface(&design.membrane),
        Kind::Solid(_) => design.membrane,
    };
    Ok(Model {
        kind,
        design: Design { membrane, ..design },
        note,
    })
}
