//! The sections of a design file, in the order of the file.

use super::bounds::Bounds;
use super::calibration::Calibration;
use super::error::Problem;
use super::relaxation;
use super::section::{Fault, Section, line_at};
use super::transducer::transducer;
use super::{
    Accuracy, Axes, DEFAULT_ELEMENTS, DEFAULT_MODEL_PERCENT, DesignFile, MembraneSection, ModelSection,
    ObjectSection, RestSection,
};
use crate::material::Law;
use crate::material::preset::{PRESETS, Preset};
use crate::material::relaxation::Relaxation;
use toml::de::DeTable;

/// Units that lengths are written in by a slip, millimetres.
const LENGTH_SLIPS: &[(&str, f64)] = &[("m", 1e3), ("um", 1e-3)];
/// Lengths of a fingertip, from a hair to a hand; walls and presses from a hundredth of a millimetre on.
const LENGTH: Bounds = Bounds::above(0.0, 1000.0, "mm").usually([0.01, 200.0], LENGTH_SLIPS);
/// Semi-axes.
const SEMI_AXIS: Bounds = Bounds::above(0.0, 1000.0, "mm").usually([0.2, 200.0], LENGTH_SLIPS);
/// Elastic constants, up to that of steel; of soft walls from the softest gels to hard rubber.
const STIFFNESS: Bounds =
    Bounds::above(0.0, 1e12, "Pa").usually([1e3, 3e7], &[("kPa", 1e3), ("MPa", 1e6), ("GPa", 1e9)]);
/// Pole stretches of a rest state.
const STRETCH: Bounds = Bounds::above(1.0, 10.0, "(no stretch is 1)");
/// Pressures, up to 100 bar.
const PRESSURE: Bounds = Bounds::above(0.0, 10_000.0, "kPa");

/// The design in a text.
pub(super) fn parse(text: &str) -> Result<DesignFile, Fault> {
    let document = DeTable::parse(text).map_err(|error| {
        let line = error.span().map(|span| line_at(text, span.start));
        (line, Problem::Syntax(error.message().to_owned()))
    })?;
    let mut root = Section::root(text, document.get_ref());
    let name = name(&mut root)?;
    let membrane = membrane(root.needed_sub(
        "membrane",
        "radial_semi_axis_mm, axial_semi_axis_mm, thickness_mm",
    )?)?;
    let (material, relaxation) = material(root.needed_sub("material", "preset, or law and its constants")?)?;
    let (model, axes) = root
        .sub("model")?
        .map(model)
        .transpose()?
        .unwrap_or((ModelSection::Membrane, ModelSection::Membrane.axes()));
    let rest = match model {
        ModelSection::Membrane => rest(root.needed_sub("rest", REST_OF_MEMBRANE)?)?,
        ModelSection::Solid { .. } | ModelSection::Auto => root
            .sub("rest")?
            .map(|section| rest_of_wall(section, model))
            .transpose()?
            .unwrap_or(RestSection::Unstretched),
    };
    let compliance = root.sub("fluid")?.map(fluid).transpose()?;
    let object = root.sub("object")?.map(ObjectSection::parse).transpose()?;
    let press = root.sub("press")?.map(press).transpose()?;
    let transducer = root.sub("transducer")?.map(transducer).transpose()?;
    let accuracy = root.sub("accuracy")?.map(accuracy).transpose()?;
    let actuator = root.sub("actuator")?.map(actuator).transpose()?;
    let calibration = root.sub("calibration")?.map(Calibration::parse).transpose()?;
    let thickness = membrane.thickness_mm * calibration.as_ref().map_or(1.0, |c| c.thickness_factor);
    let least = membrane.radial_semi_axis_mm.min(membrane.axial_semi_axis_mm);
    if thickness >= least
        && let Some(section) = root.sub("calibration")?
    {
        let allowed = format!(
            "less than {}: the wall stays under the smaller semi-axis, {least} mm",
            least / membrane.thickness_mm
        );
        return Err(section.refuse("thickness_factor", &allowed));
    }
    root.finish()?;
    Ok(DesignFile {
        name,
        membrane,
        material,
        relaxation,
        rest,
        model,
        axes,
        compliance_mm3_per_kpa: compliance.unwrap_or(0.0),
        object,
        max_indentation_mm: press,
        transducer,
        accuracy,
        actuator_diameter_mm: actuator,
        calibration: calibration.unwrap_or_default(),
    })
}

fn name(root: &mut Section<'_>) -> Result<String, Fault> {
    const ALLOWED: &str = "1 to 64 letters, digits, `-` or `_` in quotes";
    let name = root.needed_text("name", ALLOWED)?;
    let plain = name
        .chars()
        .all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_');
    if plain && (1..=64).contains(&name.len()) {
        Ok(name.to_owned())
    } else {
        Err(root.refuse("name", ALLOWED))
    }
}

fn membrane(mut section: Section<'_>) -> Result<MembraneSection, Fault> {
    let membrane = MembraneSection {
        radial_semi_axis_mm: section.needed_number("radial_semi_axis_mm", SEMI_AXIS)?,
        axial_semi_axis_mm: section.needed_number("axial_semi_axis_mm", SEMI_AXIS)?,
        thickness_mm: section.needed_number("thickness_mm", LENGTH)?,
    };
    let least = membrane.radial_semi_axis_mm.min(membrane.axial_semi_axis_mm);
    if membrane.thickness_mm >= least {
        let allowed = format!("less than the smaller semi-axis, {least} mm");
        return Err(section.refuse("thickness_mm", &allowed));
    }
    section.finish()?;
    Ok(membrane)
}

fn material(mut section: Section<'_>) -> Result<(Law, Option<Relaxation>), Fault> {
    const LAWS: &str = "\"neo-hookean\", \"mooney-rivlin\" or \"yeoh\"";
    // The higher constants may have either sign; whether the law is then stable is the solver's to say.
    const HIGHER: Bounds = Bounds::within(-1e12, 1e12, "Pa");
    let names = || {
        let names: Vec<String> = PRESETS
            .iter()
            .map(|preset| format!("{:?}", preset.name))
            .collect();
        format!("one of {}", names.join(", "))
    };
    if let Some(name) = section.text("preset", &names())? {
        let preset = Preset::named(name).ok_or_else(|| section.refuse("preset", &names()))?;
        if section.has("law") {
            return Err(section.refuse("law", "left out, as preset is given"));
        }
        let relaxation = section.sub("relaxation")?.map(relaxation::parse).transpose()?;
        section.finish()?;
        return Ok((preset.law, relaxation));
    }
    let law = match section.needed_text("law", LAWS)? {
        "neo-hookean" => Law::NeoHookean {
            c1: section.needed_number("c1_pa", STIFFNESS)?,
        },
        "mooney-rivlin" => {
            let c1 = section.needed_number("c1_pa", STIFFNESS)?;
            let c2 = section.needed_number("c2_pa", HIGHER)?;
            if c1 + c2 <= 0.0 {
                // Its shear modulus is 2 (C1 + C2).
                return Err(section.refuse(
                    "c2_pa",
                    "more than -c1_pa, or the material has no stiffness at rest",
                ));
            }
            Law::MooneyRivlin { c1, c2 }
        }
        "yeoh" => Law::Yeoh {
            c1: section.needed_number("c1_pa", STIFFNESS)?,
            c2: section.needed_number("c2_pa", HIGHER)?,
            c3: section.needed_number("c3_pa", HIGHER)?,
        },
        _ => return Err(section.refuse("law", LAWS)),
    };
    let relaxation = section.sub("relaxation")?.map(relaxation::parse).transpose()?;
    section.finish()?;
    Ok((law, relaxation))
}

const REST_KEYS: &str = "exactly one of pole_stretch, pressure_kpa, equator_radius_mm, height_mm";
/// What a membrane without a rest state lacks.
const REST_OF_MEMBRANE: &str = "exactly one of pole_stretch, pressure_kpa, equator_radius_mm, height_mm; a fingertip that is not \
                                stretched at rest has none, and is no membrane: give [model] kind = \"auto\" or \"solid\"";

fn rest(mut section: Section<'_>) -> Result<RestSection, Fault> {
    let given: Vec<(&str, RestSection)> = [
        (
            "pole_stretch",
            section
                .number("pole_stretch", STRETCH)?
                .map(RestSection::PoleStretch),
        ),
        (
            "pressure_kpa",
            section
                .number("pressure_kpa", PRESSURE)?
                .map(RestSection::PressureKpa),
        ),
        (
            "equator_radius_mm",
            section
                .number("equator_radius_mm", LENGTH)?
                .map(RestSection::EquatorRadiusMm),
        ),
        (
            "height_mm",
            section.number("height_mm", LENGTH)?.map(RestSection::HeightMm),
        ),
    ]
    .into_iter()
    .filter_map(|(key, value)| value.map(|value| (key, value)))
    .collect();
    match given[..] {
        [(_, rest)] => {
            section.finish()?;
            Ok(rest)
        }
        [] => {
            // A misspelt key is the likelier reason, and the better message.
            let missing = section.missing("pole_stretch", REST_KEYS);
            section.finish()?;
            Err(missing)
        }
        [(first, _), (second, _), ..] => {
            Err(section.refuse(second, &format!("left out, as {first} is given: {REST_KEYS}")))
        }
    }
}

/// The rest of a wall: unstretched, inflated with its rim held, or (`auto`) inflated as a membrane and then bonded.
fn rest_of_wall(mut section: Section<'_>, model: ModelSection) -> Result<RestSection, Fault> {
    let auto = model == ModelSection::Auto;
    let (keys, refused): (_, &[&'static str]) = if auto {
        (
            "pressure_kpa (rim held) or pole_stretch (inflated, then bonded), or no [rest] at all for an unstretched wall",
            &["equator_radius_mm", "height_mm"],
        )
    } else {
        (
            "pressure_kpa, or no [rest] at all for an unstretched solid",
            &["pole_stretch", "equator_radius_mm", "height_mm"],
        )
    };
    let pressure = section.number("pressure_kpa", PRESSURE)?;
    let stretch = if auto {
        section.number("pole_stretch", STRETCH)?
    } else {
        None
    };
    for key in refused {
        if section.has(key) {
            return Err(section.refuse(
                key,
                &format!("left out: with this model.kind [rest] takes {keys}"),
            ));
        }
    }
    match (pressure, stretch) {
        (Some(_), Some(_)) => Err(section.refuse("pole_stretch", "left out, as pressure_kpa is given")),
        (Some(pressure), None) => {
            section.finish()?;
            Ok(RestSection::PressureKpa(pressure))
        }
        (None, Some(stretch)) => {
            section.finish()?;
            Ok(RestSection::PoleStretch(stretch))
        }
        (None, None) => {
            // A misspelt key is the likelier reason, and the better message.
            let missing = section.missing("pressure_kpa", keys);
            section.finish()?;
            Err(missing)
        }
    }
}

fn fluid(mut section: Section<'_>) -> Result<f64, Fault> {
    let bounds = Bounds::within(0.0, 1e6, "mm^3/kPa");
    let compliance = section.number("compliance_mm3_per_kpa", bounds)?;
    section.finish()?;
    Ok(compliance.unwrap_or(0.0))
}

fn model(mut section: Section<'_>) -> Result<(ModelSection, Axes), Fault> {
    const AXES: &str = "\"mid\" (middle of the wall) or \"outer\" (outer surface)";
    const KINDS: &str = "\"membrane\", \"solid\" or \"auto\"";
    let model = match section.text("kind", KINDS)? {
        None | Some("membrane") => ModelSection::Membrane,
        Some("solid") => ModelSection::Solid {
            through: elements(&mut section, "through", 1.0, 8.0)?.unwrap_or(DEFAULT_ELEMENTS[0]),
            along: elements(&mut section, "along", 4.0, 400.0)?.unwrap_or(DEFAULT_ELEMENTS[1]),
        },
        Some("auto") => ModelSection::Auto,
        Some(_) => return Err(section.refuse("kind", KINDS)),
    };
    let axes = match section.text("axes", AXES)? {
        None => model.axes(),
        Some("mid") => Axes::Mid,
        Some("outer") => Axes::Outer,
        Some(_) => return Err(section.refuse("axes", AXES)),
    };
    section.finish()?;
    Ok((model, axes))
}

/// A number of elements, if the key is there.
fn elements(
    section: &mut Section<'_>,
    key: &'static str,
    least: f64,
    most: f64,
) -> Result<Option<u32>, Fault> {
    let number = section.number(key, Bounds::within(least, most, "(a whole number)"))?;
    match number {
        Some(number) if libm::fmod(number, 1.0) > 0.0 => Err(section.refuse(key, "a whole number")),
        other => Ok(other.map(|number| number as u32)),
    }
}

fn press(mut section: Section<'_>) -> Result<f64, Fault> {
    let depth = section.needed_number("max_indentation_mm", LENGTH)?;
    section.finish()?;
    Ok(depth)
}

fn accuracy(mut section: Section<'_>) -> Result<Accuracy, Fault> {
    const PERCENT: Bounds = Bounds::within(0.001, 10.0, "%");
    let accuracy = Accuracy {
        force_percent_of_reading: section.needed_number("force_percent_of_reading", PERCENT)?,
        indentation_percent_of_reading: section.needed_number("indentation_percent_of_reading", PERCENT)?,
        from_percent_of_full_scale: section
            .needed_number("from_percent_of_full_scale", Bounds::within(0.01, 100.0, "%"))?,
        model_percent: section
            .number("model_percent", Bounds::above(0.0, f64::MAX, "%"))?
            .unwrap_or(DEFAULT_MODEL_PERCENT),
    };
    section.finish()?;
    Ok(accuracy)
}

fn actuator(mut section: Section<'_>) -> Result<f64, Fault> {
    let diameter = section.needed_number("diameter_mm", LENGTH)?;
    section.finish()?;
    Ok(diameter)
}
