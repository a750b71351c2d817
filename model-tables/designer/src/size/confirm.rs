//! Sized membranes as design files: each solved by the model that its wall needs, moved to the target by that, with its tables.

use super::question::judge::{ACCURACY, tabled};
use super::refine::refine;
use super::target::Target;
use super::{NOTHING_FOUND, Sized, Sizing, Start, judge, root_mean_square, size};
use model_tables::design_file::DesignFile;
use model_tables::generate::Generated;
use model_tables::model::{Fingertip, Kind};
use rayon::prelude::*;

/// A misfit by the wall's own model over that by the membrane from which on the design is moved.
const MOVED: f64 = 0.01;

/// A design with its tables.
#[derive(Clone, Debug)]
pub struct Confirmed {
    /// What was sized; force, misfit and pressures are those of [`Confirmed::kind`].
    pub sized: Sized,
    /// Its design file, with [`NAME`] for its name.
    text: String,
    /// The model that its wall needs; `None` where the tables are of data.
    pub kind: Option<Kind>,
    /// Its tables.
    pub generated: Generated,
}

/// The name in the text of a design that has none yet.
const NAME: &str = "NAME";

/// What a sizing gives: designs that get tables.
#[derive(Clone, Debug)]
pub struct ConfirmedSizing {
    /// Ranked by the model that each wall needs, the best first; at least one.
    pub designs: Vec<Confirmed>,
    /// The membranes that were found.
    pub found: Sizing,
    /// Why designs are left out, one line each.
    pub left_out: Vec<String>,
}

impl ConfirmedSizing {
    /// Finds at most `best` designs for a target; `advance` is told the part of the search that is done.
    ///
    /// # Errors
    /// One line, where there is none.
    pub fn of(target: &Target, best: usize, advance: &(dyn Fn(f64) + Sync)) -> Result<Self, String> {
        let found = size(target, advance);
        if found.designs.is_empty() {
            return Err(NOTHING_FOUND.to_owned());
        }
        let (mut designs, mut left_out) = (Vec::new(), Vec::new());
        for group in found
            .designs
            .chunks(rayon::current_num_threads().min(best).max(1))
        {
            if designs.len() >= best {
                break;
            }
            let confirmed: Vec<_> = group
                .par_iter()
                .map(|sized| Confirmed::of(target, sized))
                .collect();
            for one in confirmed {
                match one {
                    Ok(one) => designs.push(one),
                    Err(reason) => left_out.push(reason),
                }
            }
        }
        designs.truncate(best);
        if designs.is_empty() {
            return Err(format!(
                "no membrane found gets tables when it is solved by the model that its wall needs: {}; widen `[bounds]`, or take \
                 another range",
                left_out.first().map_or("", String::as_str)
            ));
        }
        designs.sort_by(|a: &Confirmed, b| {
            let (a, b) = (a.sized.rank(), b.sized.rank());
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
        });
        Ok(Self {
            designs,
            found,
            left_out,
        })
    }

    /// Whether no membrane that was found is better than a design in misfit, making and peak pressure at once.
    pub fn is_non_dominated(&self, design: &Confirmed) -> bool {
        !self
            .found
            .designs
            .iter()
            .any(|other| other.dominates(&design.sized))
    }
}

impl Confirmed {
    /// Its design file, by a name.
    pub fn design_file(&self, name: &str) -> String {
        let key = |name: &str| format!("\nname = {name:?}\n");
        self.text.replacen(&key(NAME), &key(name), 1)
    }

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
        let (text, generated) = tabled(ACCURACY, |percent| sized.design_file(NAME, target, percent))?;
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
