//! A sized membrane as a design file: solved by the model that its wall needs, moved to the target by that, with its tables.

use super::question::judge::tabled;
use super::refine::refine;
use super::target::Target;
use super::{Sized, Start, judge, root_mean_square};
use model_tables::design_file::DesignFile;
use model_tables::generate::Generated;
use model_tables::model::{Fingertip, Kind};

/// A misfit by the wall's own model over that by the membrane from which on the design is moved.
const MOVED: f64 = 0.01;

/// A design with its tables.
#[derive(Clone, Debug)]
pub struct Confirmed {
    /// What was sized; force, misfit and pressures are those of [`Confirmed::kind`].
    pub sized: Sized,
    /// Its design file, with `NAME` for its name.
    pub text: String,
    /// The model that its wall needs; `None` where the tables are of data.
    pub kind: Option<Kind>,
    /// Its tables.
    pub generated: Generated,
}

/// The name in the text of a design that has none yet.
pub const NAME: &str = "NAME";

impl Confirmed {
    /// Solves a design by the model that its wall needs and makes its tables. Where that model's forces are further off the target than
    /// the membrane's, the membrane is sized again to a target that has the ratio of the two taken out.
    ///
    /// # Errors
    /// One line, of what gives no tables.
    pub fn of(target: &Target, sized: &Sized) -> Result<Self, String> {
        let first = Self::solved(target, sized)?;
        if first.sized.misfit <= sized.misfit + MOVED {
            return Ok(first);
        }
        let wanted = target
            .forces
            .iter()
            .zip(sized.forces.iter().zip(&first.sized.forces))
            .map(|(wanted, (membrane, wall))| wanted * membrane / wall)
            .collect();
        let aim = Target {
            forces: wanted,
            ..target.clone()
        };
        let moved = judge(target, sized.material, &refine(&aim, &Start::of(sized)))
            .ok()
            .filter(|moved| moved.is_possible(target))
            .and_then(|moved| Self::solved(target, &moved).ok());
        Ok(match moved {
            Some(moved) if moved.sized.misfit < first.sized.misfit => moved,
            _ => first,
        })
    }

    fn solved(target: &Target, sized: &Sized) -> Result<Self, String> {
        let (text, generated) = tabled(|percent| design(sized, target, percent))?;
        let file = DesignFile::parse(&text, "design").map_err(|error| error.to_string())?;
        let mut tip = Fingertip::for_curve(&file).map_err(|error| error.to_string())?;
        let forces = target
            .indentations
            .iter()
            .map(|depth| tip.contact_at(*depth).map(|contact| contact.force))
            .collect::<Result<Vec<f64>, _>>()
            .map_err(|error| error.to_string())?;
        let misfit = root_mean_square(
            forces
                .iter()
                .zip(&target.forces)
                .map(|(force, wanted)| force / wanted - 1.0),
        );
        Ok(Self {
            kind: generated.kind,
            sized: Sized {
                misfit,
                forces,
                rest_pressure: generated.rest_pressure,
                peak_pressure: generated.rest_pressure + generated.end.pressure_rise,
                ..sized.clone()
            },
            text,
            generated,
        })
    }
}

impl Start {
    fn of(sized: &Sized) -> Self {
        let membrane = sized.design.membrane;
        Self {
            material: sized.material,
            radial: membrane.radial_semi_axis,
            axial: membrane.axial_semi_axis,
            wall: membrane.thickness,
            stretch: sized.stretch(),
        }
    }
}

/// The design file of a sized membrane, its tables of an accuracy in percent.
fn design(sized: &Sized, target: &Target, percent: f64) -> String {
    let model = "[model]\nkind = \"auto\"\naxes = \"mid\"\n\n";
    sized.text(NAME, target, "misfit of the membrane", model, percent)
}
