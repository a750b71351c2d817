//! What touches, by the models of it: tables of a plate, the same with their band, tables blended for the object, and the full solution.

use model_tables::curve::Contact;
use model_tables::design::Design;
use model_tables::design_file::{Axes, DesignFile};
use model_tables::generate::{self, GenerateError, Generated, OwnedTables};
use model_tables::model::choice::FINE;
use model_tables::model::{Fingertip, Kind, ModelError};
use model_tables::object::{Friction, Object, Shape};
use model_tables::table::ContactLookup as _;
use model_tables::table::law::Touched;
use model_tables::units::PressureRise;
use std::fmt::Write as _;

/// Walls of the printed dome, millimetres.
const WALLS: [f64; 3] = [0.5, 1.0, 1.5];
/// Balls, millimetres: none of a radius that a law is fitted to.
const BALLS: [f64; 5] = [4.0, 6.0, 10.0, 25.0, 100.0];
/// Depths over the deepest.
const PARTS: [f64; 3] = [0.1, 0.4, 1.0];
/// The deepest, millimetres.
const DEEPEST: f64 = 2.5;
/// A coefficient of friction.
const FRICTION: f64 = 0.3;
/// Percent that a scene may allow.
const ALLOWED: [f64; 3] = [25.0, 5.0, 2.0];

/// Errors of force and indentation in one state, percent of the reading's truth.
#[derive(Clone, Copy, Debug, Default)]
pub struct ObjectErrors([f64; 2]);

impl ObjectErrors {
    fn of(tables: &OwnedTables, truth: &Contact) -> Self {
        let bits = tables.layout.fraction_bits;
        let read = tables.contact_at(PressureRise::from_pascals(truth.pressure_rise, bits));
        Self([
            100.0 * (read.force.newtons() / truth.force - 1.0),
            100.0 * (read.indentation.metres() / truth.indentation - 1.0),
        ])
    }

    /// The larger.
    pub fn largest(&self) -> f64 {
        self.0[0].abs().max(self.0[1].abs())
    }

    fn words(&self) -> String {
        format!("{:+.1} / {:+.1}", self.0[0], self.0[1])
    }
}

/// An object on a wall.
#[derive(Clone, Debug)]
pub struct ObjectScene {
    /// Wall, millimetres.
    pub wall: f64,
    /// Radius of a ball, millimetres; `None` for a plate with friction.
    pub radius: Option<f64>,
    /// By `PARTS`: of tables of a plate, whether the truth lies in their band, and of tables blended for the object.
    pub states: Vec<(ObjectErrors, bool, ObjectErrors)>,
}

/// Why a scene was not measured.
#[derive(Debug)]
pub enum NoScene {
    /// No tables.
    Tables(GenerateError),
    /// No state.
    State(ModelError),
}

impl std::fmt::Display for NoScene {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Tables(error) => error.fmt(f),
            Self::State(error) => error.fmt(f),
        }
    }
}

fn tip(wall: f64) -> Result<(DesignFile, Generated), NoScene> {
    let text = format!(
        "name = \"wall\"\n[membrane]\nradial_semi_axis_mm = 9.0\naxial_semi_axis_mm = 7.0\nthickness_mm = {wall:?}\n\
         [material]\npreset = \"agilus30\"\n[model]\nkind = \"solid\"\n[object]\n[press]\nmax_indentation_mm = {DEEPEST:?}\n\
         [transducer]\nkind = \"ratiometric\"\nrange_kpa = [-10.0, 300.0]\nresolution_pa = 2.0\n[accuracy]\n\
         force_percent_of_reading = 0.1\nindentation_percent_of_reading = 0.1\nfrom_percent_of_full_scale = 1.0\n"
    );
    let file =
        DesignFile::parse(&text, "wall.toml").map_err(|error| NoScene::Tables(GenerateError::File(error)))?;
    let generated = generate::from_design(file.clone()).map_err(NoScene::Tables)?;
    Ok((file, generated))
}

/// The scenes of one wall.
///
/// # Errors
/// [`NoScene`] where a table or a state is missing.
pub fn measure(wall: f64) -> Result<Vec<ObjectScene>, NoScene> {
    let (file, generated) = tip(wall)?;
    let plate = &generated.certified.tables;
    let frictionless = |radius: f64| Object {
        shape: Shape::Ball {
            radius: 1e-3 * radius,
        },
        friction: Friction::NONE,
    };
    let rubbing = Object {
        friction: Friction::Coulomb(FRICTION),
        ..Object::PLATE
    };
    let objects = BALLS
        .iter()
        .map(|radius| (Some(*radius), frictionless(*radius)))
        .chain([(None, rubbing)]);
    let mut scenes = Vec::new();
    for (radius, object) in objects {
        let design = Design {
            object,
            ..file.design_to(Axes::Outer)
        };
        let kind = generated.kind.unwrap_or(Kind::Solid(FINE));
        let mut press = Fingertip::of(kind, &design).map_err(NoScene::State)?;
        let touched = radius.map_or(Touched::Plate, |radius| {
            Touched::Ball(libm::round(1e3 * radius) as i32)
        });
        let blended = generated
            .certified
            .object
            .as_ref()
            .and_then(|tables| tables.blended(plate, touched));
        let mut states = Vec::new();
        for part in PARTS {
            let truth = press.contact_at(1e-3 * part * DEEPEST).map_err(NoScene::State)?;
            let of_plate = ObjectErrors::of(plate, &truth);
            let bits = plate.layout.fraction_bits;
            let read = plate.contact_at(PressureRise::from_pascals(truth.pressure_rise, bits));
            let in_band = generated.band.as_ref().is_some_and(|band| {
                band.at(truth.pressure_rise).unwrap_or(&band.widest()).holds(
                    [read.force.newtons(), read.indentation.metres()],
                    [truth.force, truth.indentation],
                )
            });
            let of_blend = blended
                .as_ref()
                .map_or(of_plate, |tables| ObjectErrors::of(tables, &truth));
            states.push((of_plate, in_band, of_blend));
        }
        scenes.push(ObjectScene { wall, radius, states });
    }
    Ok(scenes)
}

/// Every wall.
///
/// # Errors
/// [`NoScene`].
pub fn measure_all() -> Result<Vec<ObjectScene>, NoScene> {
    let mut all = Vec::new();
    for wall in WALLS {
        all.extend(measure(wall)?);
    }
    Ok(all)
}

/// The least that a scene needs for an allowed error, over all of its depths.
fn needed(scene: &ObjectScene, allowed: f64) -> &'static str {
    let largest =
        |of: fn(&(ObjectErrors, bool, ObjectErrors)) -> f64| scene.states.iter().map(of).fold(0.0, f64::max);
    if largest(|state| state.0.largest()) <= allowed {
        "plate"
    } else if scene.radius.is_some() && largest(|state| state.2.largest()) <= allowed {
        "blend"
    } else {
        "full"
    }
}

/// The chapter of the page.
pub fn markdown(scenes: &[ObjectScene]) -> String {
    let mut text = format!(
        "\n## What touches\n\nThe object tables are for the printed dome, 9 x 7 mm outside, Agilus30, unstretched, with three walls. The objects are \
         balls with radii to which no law of weights is fitted, and a plate with a coefficient of friction of {FRICTION}. \
         *Plate*: errors of the tables of a plate, force / indentation, in percent of the truth. The truth is the full solution \
         of the same solid. *Blend*: errors of the blend of the tables of plate and reference ball; there is no blend for \
         friction. *Band*: whether the truth is in the band that the certificate states for the tables of the plate. *Needs*: \
         the simplest model whose force and indentation are within {} % at all three depths.\n\n\
         | wall, mm | object |",
        ALLOWED.map(|percent| percent.to_string()).join(", ")
    );
    for part in PARTS {
        let depth = part * DEEPEST;
        let _ = write!(text, " plate, {depth} mm | blend, {depth} mm |");
    }
    let _ = writeln!(
        text,
        " band | needs |\n|---|---|{}---|---|",
        "---|---|".repeat(PARTS.len())
    );
    for scene in scenes {
        let object = scene
            .radius
            .map_or_else(|| "rough plate".to_owned(), |radius| format!("ball {radius} mm"));
        let _ = write!(text, "| {} | {object} |", scene.wall);
        for (plate, _, blend) in &scene.states {
            let blend = scene.radius.map_or_else(|| "-".to_owned(), |_| blend.words());
            let _ = write!(text, " {} | {blend} |", plate.words());
        }
        let inside = scene.states.iter().filter(|state| state.1).count();
        let needs = ALLOWED.map(|allowed| needed(scene, allowed)).join(", ");
        let _ = writeln!(text, " {inside} of {} | {needs} |", scene.states.len());
    }
    text
}
