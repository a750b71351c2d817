//! The buyer's question: the lightest touch, the greatest force, readings a second, the time of a grasp, what is grasped, the space -> designs with
//! a transducer of the catalogue that meet all of them.
//!
//! [`SizingQuestion`] and [`catalogue`] -> [`presses`] (coarse solids over shapes and materials, scaled to sizes, against every part) -> [`judge`] (the
//! nearest ones solved by the model that the wall needs, with their tables).

pub mod catalogue;
pub mod judge;
pub mod presses;

use crate::size::target::presets;
use catalogue::{CataloguePart, MEDIA};
use model_tables::design_file::bounds::Bounds;
use model_tables::design_file::section::{KeyFault, Section};
use model_tables::design_file::{DesignFileError, document};
use model_tables::material::preset::{PRESETS, Preset};
use model_tables::object::{Friction, Object, Shape};
use std::path::Path;

/// Bounds of forces.
pub const FORCE: Bounds = Bounds::above(0.0, 1e4, "N");
/// Bounds of rates.
pub const RATE: Bounds = Bounds::above(0.0, 1e6, "a second");
/// Bounds of a grasp: a day.
pub const GRASP: Bounds = Bounds::above(0.0, 86_400.0, "s");
/// Bounds of the radius of what is grasped.
pub const RADIUS: Bounds = Bounds::above(0.0, 1e6, "mm");
/// Bounds of the space.
pub const SPACE: Bounds = Bounds::above(0.0, 200.0, "mm");

/// What is wanted of a fingertip, and the space that it has.
#[derive(Clone, Debug, PartialEq)]
pub struct SizingQuestion {
    /// Its name.
    pub name: String,
    /// The lightest touch to be told, newtons.
    pub lightest_n: f64,
    /// The greatest force to be read, newtons.
    pub greatest_n: f64,
    /// Readings a second.
    pub rate: f64,
    /// How long a grasp lasts, seconds.
    pub grasp_s: f64,
    /// What presses on the transducer, of [`MEDIA`]; `None`: any.
    pub filling: Option<String>,
    /// Radius of a ball that is grasped, millimetres; `None`: a plate.
    pub radius_mm: Option<f64>,
    /// Outer diameter and height that the tip may have, millimetres.
    pub space_mm: [f64; 2],
    /// How exactly a dimension is made, and the thinnest wall, millimetres.
    pub making_mm: [f64; 2],
    /// Materials to choose from.
    pub materials: Vec<&'static Preset>,
    /// Names of transducers to choose from; all of the catalogue where empty.
    pub parts: Vec<String>,
}

impl SizingQuestion {
    /// A question with the least that it needs: lightest touch and greatest force, newtons. A grasp of a second against anything
    /// flat, in the space of a fingertip, 18 mm wide and 9 mm high, of any material that can be bought, with any transducer.
    pub fn new(lightest_n: f64, greatest_n: f64) -> Self {
        Self {
            name: "question".to_owned(),
            lightest_n,
            greatest_n,
            rate: 1.0,
            grasp_s: 1.0,
            filling: None,
            radius_mm: None,
            space_mm: [18.0, 9.0],
            making_mm: [0.1, 0.5],
            materials: PRESETS.iter().filter(|preset| preset.name != "skin").collect(),
            parts: Vec::new(),
        }
    }

    /// Reads and checks a file; `None` where it is a target without `[wanted]`.
    ///
    /// # Errors
    /// [`DesignFileError`] with the file's name, and the line where there is one.
    pub fn read(path: &Path) -> Result<Option<Self>, DesignFileError> {
        let file = path.display().to_string();
        parse(&document::read(path)?).map_err(|fault| DesignFileError::at(&file, fault))
    }

    /// The object in SI units.
    pub fn touched(&self) -> Object {
        self.radius_mm.map_or(Object::PLATE, |radius_mm| Object {
            shape: Shape::Ball {
                radius: 1e-3 * radius_mm,
            },
            friction: Friction::NONE,
        })
    }

    /// Why a part is none for this question; `None` where it may be one.
    pub fn unfit(&self, part: &CataloguePart) -> Option<String> {
        if !self.parts.is_empty() && !self.parts.contains(&part.name) {
            return Some("not named".to_owned());
        }
        if let Some(filling) = &self.filling
            && !part.media.contains(filling)
        {
            return Some(format!("{} only", part.media.join(", ")));
        }
        (part.rate() < self.rate).then(|| format!("{:.0} readings a second", part.rate()))
    }
}

fn parse(text: &str) -> Result<Option<SizingQuestion>, KeyFault> {
    const FILLING: &str = "\"air\", \"oil\" or \"water\"";
    let tables = document::tables(text)?;
    let mut root = Section::root(text, tables.get_ref());
    let Some(mut wanted) = root.sub("wanted")? else {
        return Ok(None);
    };
    let lightest = wanted.needed_number("lightest_touch_n", FORCE)?;
    let mut question = SizingQuestion::new(lightest, wanted.needed_number("greatest_force_n", FORCE)?);
    if question.greatest_n <= lightest {
        return Err(wanted.refuse(
            "greatest_force_n",
            &format!("more than lightest_touch_n, {lightest} N"),
        ));
    }
    question.rate = wanted
        .number("readings_per_second", RATE)?
        .unwrap_or(question.rate);
    question.grasp_s = wanted.number("grasp_s", GRASP)?.unwrap_or(question.grasp_s);
    if let Some(filling) = wanted.text("filling", FILLING)? {
        if !MEDIA.contains(&filling) {
            return Err(wanted.refuse("filling", FILLING));
        }
        question.filling = Some(filling.to_owned());
    }
    wanted.finish()?;
    question.name = root.name(64, document::NAME)?;
    if let Some(mut object) = root.sub("object")? {
        question.radius_mm = Some(object.needed_number("radius_mm", RADIUS)?);
        object.finish()?;
    }
    if let Some(mut space) = root.sub("space")? {
        question.space_mm = [
            space.needed_number("diameter_mm", SPACE)?,
            space.needed_number("height_mm", SPACE)?,
        ];
        space.finish()?;
    }
    if let Some(mut making) = root.sub("making")? {
        let [tolerance, thinnest] = question.making_mm;
        question.making_mm = [
            making
                .number("tolerance_mm", Bounds::above(0.0, 10.0, "mm"))?
                .unwrap_or(tolerance),
            making
                .number("thinnest_wall_mm", Bounds::above(0.0, 10.0, "mm"))?
                .unwrap_or(thinnest),
        ];
        making.finish()?;
    }
    if let Some(mut listed) = root.sub("materials")? {
        question.materials = presets(&mut listed, "presets")?;
        listed.finish()?;
    }
    if let Some(mut listed) = root.sub("transducers")? {
        question.parts = listed
            .texts("parts", "names of the catalogue in brackets")?
            .into_iter()
            .map(str::to_owned)
            .collect();
        listed.finish()?;
    }
    root.finish()?;
    Ok(Some(question))
}

#[cfg(test)]
mod tests {
    use super::*;

    const EGG: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../targets/egg.toml"));

    #[test]
    fn reads_the_shipped_question_and_leaves_a_target_alone() {
        let question = parse(EGG).expect("no fault").expect("a question");
        assert!((question.lightest_n - 0.02).abs() < 1e-12);
        assert_eq!(question.filling.as_deref(), Some("water"));
        let target = include_str!(concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../targets/human-fingertip.toml"
        ));
        assert_eq!(parse(target).expect("no fault"), None);
    }

    #[test]
    fn nonsense_names_its_key() {
        for (from, to, key) in [
            (
                "greatest_force_n = 2.0",
                "greatest_force_n = 0.01",
                "wanted.greatest_force_n",
            ),
            ("filling = \"water\"", "filling = \"milk\"", "wanted.filling"),
            ("grasp_s", "grasp_ms", "wanted.grasp_ms"),
            ("height_mm", "hight_mm", "space.hight_mm"),
        ] {
            assert!(EGG.contains(from), "{from}");
            let (_, problem) = parse(&EGG.replacen(from, to, 1)).expect_err("refused");
            assert!(problem.to_string().contains(key), "{problem}");
        }
    }
}
