//! The target file of a haptic loop (TOML), with `[transmission]` where that of a fingertip has `[target]`.

use super::Circuit;
use crate::size::target::presets;
use model_tables::design_file::bounds::Bounds;
use model_tables::design_file::section::{KeyFault, Section};
use model_tables::design_file::{DesignFileError, document};
use model_tables::material::preset::Preset;
use model_tables::solid::disc::FarSide;
use toml::de::DeTable;

/// Free dimensions of a loop.
pub const DIMENSIONS: usize = 5;
/// Their keys in `[bounds]`: of the fingertip's outer surface and wall, of the actuator.
pub const NAMES: [&str; DIMENSIONS] = [
    "radial_semi_axis_mm",
    "axial_semi_axis_mm",
    "thickness_mm",
    "actuator_diameter_mm",
    "actuator_thickness_mm",
];

/// What is wanted of a loop, and within which bounds. SI units where a name does not tell another one.
#[derive(Clone, Debug, PartialEq)]
pub struct WantedLoop {
    /// Its name.
    pub name: String,
    /// Feedback force over touch force.
    pub ratio: f64,
    /// Indentation of the fingertip at which it is wanted, metres.
    pub indentation: f64,
    /// What is over the actuator.
    pub far_side: FarSide,
    /// Bounds of the dimensions, metres.
    pub bounds: [[f64; 2]; DIMENSIONS],
    /// Materials of the fingertip to choose from.
    pub materials: Vec<&'static Preset>,
    /// Materials of the actuator; empty: the fingertip's.
    pub actuators: Vec<&'static Preset>,
    /// Range of the transducer, gauge, kilopascals.
    pub range_kpa: [f64; 2],
    /// Compliance of the tubing, cubic metres per pascal.
    pub tube: f64,
    /// Air trapped in the line at ambient pressure, cubic metres.
    pub air: f64,
    /// How exactly a dimension is made, metres.
    pub tolerance: f64,
    /// Further air whose effect is stated, cubic metres.
    pub disturbing_air: f64,
    /// Further compliance whose effect is stated, cubic metres per pascal.
    pub disturbing_tube: f64,
    /// Change of temperature whose effect is stated, kelvins.
    pub disturbing_kelvin: f64,
}

impl WantedLoop {
    /// Whether the text of a target file is one of a loop.
    pub fn is_in(text: &str) -> bool {
        DeTable::parse(text).is_ok_and(|document| document.get_ref().contains_key("transmission"))
    }

    /// Checks the text of a target file; `file` is the name that errors give it.
    ///
    /// # Errors
    /// [`DesignFileError`] for the first thing that is wrong.
    pub fn parse(text: &str, file: &str) -> Result<Self, DesignFileError> {
        parse(text).map_err(|fault| DesignFileError::at(file, fault))
    }

    /// Whether a dimension has two bounds.
    pub fn is_free(&self, dimension: usize) -> bool {
        let [low, high] = self.bounds[dimension];
        high > low
    }

    /// The actuator's materials beside one of the fingertip.
    pub(super) fn actuator_materials(&self, tip: &'static Preset) -> Vec<&'static Preset> {
        if self.actuators.is_empty() {
            vec![tip]
        } else {
            self.actuators.clone()
        }
    }

    pub(super) fn circuit(&self) -> Circuit {
        Circuit {
            air: self.air,
            tube: self.tube,
            warmer: 0.0,
        }
    }
}

fn parse(text: &str) -> Result<WantedLoop, KeyFault> {
    const LENGTH: Bounds = Bounds::above(0.0, 100.0, "mm");
    const COMPLIANCE: Bounds = Bounds::within(0.0, 1e6, "mm^3/kPa");
    const VOLUME: Bounds = Bounds::within(0.0, 1e6, "mm^3");
    let tables = document::tables(text)?;
    let mut root = Section::root(text, tables.get_ref());
    let name = root.name(64, document::NAME)?;
    let mut wanted = root.needed_sub("transmission", "feedback_over_touch, indentation_mm")?;
    let ratio = wanted.needed_number("feedback_over_touch", Bounds::above(0.0, 100.0, "N/N"))?;
    let indentation = 1e-3 * wanted.needed_number("indentation_mm", LENGTH)?;
    let gap = wanted.number("gap_mm", Bounds::within(0.0, 100.0, "mm"))?;
    let gap = 1e-3 * gap.unwrap_or(0.0);
    let far_side = match wanted.number("foundation_kpa_per_mm", Bounds::above(0.0, 1e6, "kPa/mm"))? {
        Some(stiffness) => FarSide::Foundation {
            gap,
            stiffness: 1e6 * stiffness,
        },
        None => FarSide::Plate { gap },
    };
    wanted.finish()?;
    let mut bounded = root.needed_sub("bounds", &NAMES.join(", "))?;
    let mut bounds = [[0.0; 2]; DIMENSIONS];
    for (bound, key) in bounds.iter_mut().zip(NAMES) {
        *bound = bounded.span(key, LENGTH)?.map(|length| 1e-3 * length);
    }
    bounded.finish()?;
    let mut listed = root.needed_sub("materials", "presets")?;
    let tips = presets(&mut listed, "presets")?;
    let actuators = if listed.has("actuator_presets") {
        presets(&mut listed, "actuator_presets")?
    } else {
        Vec::new()
    };
    listed.finish()?;
    let mut transducer = root.needed_sub("transducer", "range_kpa")?;
    let range_kpa = transducer.needed_pair("range_kpa", Bounds::within(-101.325, 10_000.0, "kPa"))?;
    if range_kpa[1] <= 0.0 {
        return Err(transducer.refuse("range_kpa", "a range that ends above zero"));
    }
    transducer.finish()?;
    let [mut tube, mut air] = [0.0; 2];
    if let Some(mut fluid) = root.sub("fluid")? {
        tube = fluid.number("compliance_mm3_per_kpa", COMPLIANCE)?.unwrap_or(0.0);
        air = fluid.number("trapped_air_mm3", VOLUME)?.unwrap_or(0.0);
        fluid.finish()?;
    }
    // A printer's tenth; a bubble of 2 mm; ten centimetres of soft tube; between a cold and a warm room.
    let [mut tolerance, mut more_air, mut more_tube, mut kelvin] = [0.1, 5.0, 0.05, 10.0];
    if let Some(mut making) = root.sub("making")? {
        let tolerances = Bounds::above(0.0, 10.0, "mm");
        tolerance = making.number("tolerance_mm", tolerances)?.unwrap_or(tolerance);
        more_air = making.number("air_mm3", VOLUME)?.unwrap_or(more_air);
        more_tube = making
            .number("compliance_mm3_per_kpa", COMPLIANCE)?
            .unwrap_or(more_tube);
        kelvin = making
            .number("kelvin", Bounds::within(-50.0, 50.0, "K"))?
            .unwrap_or(kelvin);
        making.finish()?;
    }
    root.finish()?;
    Ok(WantedLoop {
        name,
        ratio,
        indentation,
        far_side,
        bounds,
        materials: tips,
        actuators,
        range_kpa,
        tube: 1e-12 * tube,
        air: 1e-9 * air,
        tolerance: 1e-3 * tolerance,
        disturbing_air: 1e-9 * more_air,
        disturbing_tube: 1e-12 * more_tube,
        disturbing_kelvin: kelvin,
    })
}
