//! The target file of a sizing (TOML).

use model_tables::design_file::bounds::Bounds;
use model_tables::design_file::section::{KeyFault, Section};
use model_tables::design_file::{DesignFileError, document};
use model_tables::material::preset::{PRESETS, Preset};
use std::path::Path;

/// What is wanted, and within which bounds. SI units where a name does not say otherwise.
#[derive(Clone, Debug, PartialEq)]
pub struct Target {
    /// Its name.
    pub name: String,
    /// Indentations, metres, increasing.
    pub indentations: Vec<f64>,
    /// Force wanted at each, newtons, increasing.
    pub forces: Vec<f64>,
    /// Radial semi-axis of the mid-surface, metres.
    pub radial: [f64; 2],
    /// Axial semi-axis, metres.
    pub axial: [f64; 2],
    /// Thickness of the wall, metres.
    pub wall: [f64; 2],
    /// Stretch of the pole at rest, dimensionless.
    pub stretch: [f64; 2],
    /// Materials to choose from.
    pub materials: Vec<&'static Preset>,
    /// Range of the transducer, gauge, kilopascals.
    pub range_kpa: [f64; 2],
    /// Compliance of tubing, actuator and bubbles, cubic millimetres per kilopascal.
    pub compliance_mm3_per_kpa: f64,
    /// How exactly a dimension is made, metres.
    pub tolerance: f64,
}

impl Target {
    /// Reads and checks a target file.
    ///
    /// # Errors
    /// [`DesignFileError`] with the file's name, and the line where there is one.
    pub fn read(path: &Path) -> Result<Self, DesignFileError> {
        Self::parse(&document::read(path)?, &path.display().to_string())
    }

    /// Checks the text of a target file; `file` is the name that errors give it.
    ///
    /// # Errors
    /// [`DesignFileError`] for the first thing that is wrong.
    pub fn parse(text: &str, file: &str) -> Result<Self, DesignFileError> {
        parse(text).map_err(|fault| DesignFileError::at(file, fault))
    }

    /// The deepest indentation, metres.
    pub fn deepest(&self) -> f64 {
        self.indentations.last().copied().unwrap_or_default()
    }
}

/// The materials that a key names, each of [`PRESETS`].
pub(super) fn presets(listed: &mut Section<'_>, key: &'static str) -> Result<Vec<&'static Preset>, KeyFault> {
    let names: Vec<String> = PRESETS
        .iter()
        .map(|preset| format!("{:?}", preset.name))
        .collect();
    let allowed = format!("names in brackets, each of {}", names.join(", "));
    listed
        .texts(key, &allowed)?
        .into_iter()
        .map(|name| Preset::named(name).ok_or_else(|| listed.refuse(key, &allowed)))
        .collect()
}

fn parse(text: &str) -> Result<Target, KeyFault> {
    const LENGTH: Bounds = Bounds::above(0.0, 100.0, "mm");
    let tables = document::tables(text)?;
    let mut root = Section::root(text, tables.get_ref());
    let name = root.name(64, document::NAME)?;
    let mut wanted = root.needed_sub("target", "indentation_mm, force_n")?;
    let indentations = wanted.increasing("indentation_mm", LENGTH, [1, 100])?;
    let forces = wanted.increasing("force_n", Bounds::above(0.0, 1e4, "N"), [1, 100])?;
    if forces.len() != indentations.len() {
        let allowed = format!("as many numbers as indentation_mm has, {}", indentations.len());
        return Err(wanted.refuse("force_n", &allowed));
    }
    wanted.finish()?;
    let mut bounds = root.needed_sub(
        "bounds",
        "radial_semi_axis_mm, axial_semi_axis_mm, thickness_mm, pole_stretch",
    )?;
    let metres = |[low, high]: [f64; 2]| [1e-3 * low, 1e-3 * high];
    let radial = metres(bounds.span("radial_semi_axis_mm", LENGTH)?);
    let axial = metres(bounds.span("axial_semi_axis_mm", LENGTH)?);
    let wall = metres(bounds.span("thickness_mm", LENGTH)?);
    let stretch = bounds.span("pole_stretch", Bounds::above(1.0, 5.0, "(no stretch is 1)"))?;
    bounds.finish()?;
    let mut listed = root.needed_sub("materials", "presets")?;
    let materials = presets(&mut listed, "presets")?;
    listed.finish()?;
    let mut transducer = root.needed_sub("transducer", "range_kpa")?;
    let range_kpa = transducer.needed_pair("range_kpa", Bounds::within(-101.325, 10_000.0, "kPa"))?;
    if range_kpa[1] <= 0.0 {
        return Err(transducer.refuse("range_kpa", "a range that ends above zero"));
    }
    transducer.finish()?;
    let compliance = match root.sub("fluid")? {
        None => 0.0,
        Some(mut fluid) => {
            let bounds = Bounds::within(0.0, 1e6, "mm^3/kPa");
            let compliance = fluid.needed_number("compliance_mm3_per_kpa", bounds)?;
            fluid.finish()?;
            compliance
        }
    };
    let tolerance = match root.sub("making")? {
        None => 0.1,
        Some(mut making) => {
            let tolerance = making.needed_number("tolerance_mm", Bounds::above(0.0, 10.0, "mm"))?;
            making.finish()?;
            tolerance
        }
    };
    root.finish()?;
    Ok(Target {
        name,
        indentations: indentations.iter().map(|depth| 1e-3 * depth).collect(),
        forces,
        radial,
        axial,
        wall,
        stretch,
        materials,
        range_kpa,
        compliance_mm3_per_kpa: compliance,
        tolerance: 1e-3 * tolerance,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const HUMAN: &str = include_str!(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../targets/human-fingertip.toml"
    ));

    #[test]
    fn reads_the_shipped_target() {
        let target = Target::parse(HUMAN, "human.toml").expect("a target");
        assert_eq!(target.forces, [0.32, 1.94]);
        assert!((target.deepest() - 2e-3).abs() < 1e-15 && (target.tolerance - 1e-4).abs() < 1e-15);
        assert_eq!(target.materials.len(), 9);
    }

    #[test]
    fn nonsense_names_its_key() {
        for (from, to, key) in [
            ("[0.32, 1.94]", "[1.94, 0.32]", "`target.force_n`"),
            (
                "[0.32, 1.94]",
                "[1.94]",
                "as many numbers as indentation_mm has, 2",
            ),
            ("[0.3, 1.5]", "[0.3, 1.5, 2]", "`bounds.thickness_mm`"),
            ("\"agilus30\"", "\"rubber\"", "`materials.presets`"),
            ("[0.0, 100.0]", "[-50, -10]", "`transducer.range_kpa`"),
            (
                "tolerance_mm",
                "tolerence_mm",
                "`making.tolerence_mm` is not a known key, did you mean `tolerance_mm`?",
            ),
            ("[bounds]", "[bound]", "`[bounds]` is missing"),
        ] {
            assert!(HUMAN.contains(from), "{from}");
            let error = Target::parse(&HUMAN.replacen(from, to, 1), "t.toml")
                .expect_err("refused")
                .to_string();
            assert!(error.contains(key), "{error}");
        }
        let held = HUMAN.replace("[0.3, 1.5]", "0.8");
        assert!((Target::parse(&held, "t").expect("one number").wall[1] - 0.8e-3).abs() < 1e-12);
    }
}
