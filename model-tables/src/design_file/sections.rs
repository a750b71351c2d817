//! The sections of a design file, in the order of the file.

use super::actuator::ActuatorSection;
use super::bounds::{Bounds, LENGTH, SEMI_AXIS};
use super::calibration::Calibration;
use super::document;
use super::error::Problem;
use super::hand;
use super::material::material;
use super::section::{KeyFault, Section};
use super::transducer::transducer;
use super::zero::{self, ZeroSection};
use super::{
    Accuracy, Axes, DEFAULT_ELEMENTS, DEFAULT_MODEL_PERCENT, DesignFile, MembraneSection, ModelSection,
    ObjectSection, RestSection,
};
use crate::constants::AirReference;

/// Pole stretches of a rest state.
const STRETCH: Bounds = Bounds::above(1.0, 10.0, "(no stretch is 1)");
/// Pressures, up to 100 bar.
const PRESSURE: Bounds = Bounds::above(0.0, 10_000.0, "kPa");

/// The design in a text.
pub(super) fn parse(text: &str) -> Result<DesignFile, KeyFault> {
    let tables = document::tables(text)?;
    let mut root = Section::root(text, tables.get_ref());
    if let Some(designs) = hand::designs_in(tables.get_ref()) {
        return Err((None, Problem::Hand { designs }));
    }
    let name = root.name(64, document::NAME)?;
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
    let zero = root
        .sub("zero")?
        .map(|section| ZeroSection::parse(section, transducer.as_ref()))
        .transpose()?;
    let air = root
        .sub("air")?
        .map(|section| zero::air(section, transducer.as_ref()))
        .transpose()?;
    let accuracy = root.sub("accuracy")?.map(accuracy).transpose()?;
    let actuator = root.sub("actuator")?.map(ActuatorSection::parse).transpose()?;
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
        zero: zero.unwrap_or_default(),
        air: air.unwrap_or(AirReference::None),
        accuracy,
        actuator,
        calibration: calibration.unwrap_or_default(),
    })
}

fn membrane(mut section: Section<'_>) -> Result<MembraneSection, KeyFault> {
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

const REST_KEYS: &str = "exactly one of pole_stretch, pressure_kpa, equator_radius_mm, height_mm";
/// What a membrane without a rest state lacks.
const REST_OF_MEMBRANE: &str = "exactly one of pole_stretch, pressure_kpa, equator_radius_mm, height_mm; a fingertip that is not \
                                stretched at rest has none, and is no membrane: give [model] kind = \"auto\" or \"solid\"";

fn rest(mut section: Section<'_>) -> Result<RestSection, KeyFault> {
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
fn rest_of_wall(mut section: Section<'_>, model: ModelSection) -> Result<RestSection, KeyFault> {
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

fn fluid(mut section: Section<'_>) -> Result<f64, KeyFault> {
    let bounds = Bounds::within(0.0, 1e6, "mm^3/kPa");
    let compliance = section.number("compliance_mm3_per_kpa", bounds)?;
    section.finish()?;
    Ok(compliance.unwrap_or(0.0))
}

fn model(mut section: Section<'_>) -> Result<(ModelSection, Axes), KeyFault> {
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
) -> Result<Option<u32>, KeyFault> {
    let number = section.number(key, Bounds::within(least, most, "(a whole number)"))?;
    match number {
        Some(number) if libm::fmod(number, 1.0) > 0.0 => Err(section.refuse(key, "a whole number")),
        other => Ok(other.map(|number| number as u32)),
    }
}

fn press(mut section: Section<'_>) -> Result<f64, KeyFault> {
    let depth = section.needed_number("max_indentation_mm", LENGTH)?;
    section.finish()?;
    Ok(depth)
}

fn accuracy(mut section: Section<'_>) -> Result<Accuracy, KeyFault> {
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
