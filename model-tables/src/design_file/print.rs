//! The canonical text of a design: the same design always gives the same bytes.

use super::{
    Axes, DEFAULT_MODEL_PERCENT, DesignFile, ModelSection, RestSection, SourceResistance, Supply,
    TransducerKindSection, TransducerSection, Transfer, relaxation, zero,
};
use crate::constants::Quantity;
use crate::material::Law;
use std::fmt::{self, Write};

pub(super) fn canonical(file: &DesignFile) -> String {
    let mut text = String::new();
    print(file, &mut text).expect("writing to a string does not fail");
    text
}

/// `{:?}` of an `f64` is the shortest text that reads back as the same bits, and is valid TOML.
fn print(file: &DesignFile, out: &mut String) -> fmt::Result {
    writeln!(out, "name = \"{}\"", file.name)?;
    let membrane = &file.membrane;
    writeln!(out, "\n[membrane]")?;
    writeln!(out, "radial_semi_axis_mm = {:?}", membrane.radial_semi_axis_mm)?;
    writeln!(out, "axial_semi_axis_mm = {:?}", membrane.axial_semi_axis_mm)?;
    writeln!(out, "thickness_mm = {:?}", membrane.thickness_mm)?;
    writeln!(out, "\n[material]")?;
    law(&file.material, out)?;
    if let Some(relaxation) = &file.relaxation {
        relaxation::print("material.relaxation", relaxation, out)?;
    }
    if file.rest != RestSection::Unstretched {
        writeln!(out, "\n[rest]")?;
    }
    match file.rest {
        RestSection::Unstretched => {}
        RestSection::PoleStretch(stretch) => writeln!(out, "pole_stretch = {stretch:?}")?,
        RestSection::PressureKpa(pressure) => writeln!(out, "pressure_kpa = {pressure:?}")?,
        RestSection::EquatorRadiusMm(radius) => writeln!(out, "equator_radius_mm = {radius:?}")?,
        RestSection::HeightMm(height) => writeln!(out, "height_mm = {height:?}")?,
    }
    writeln!(out, "\n[fluid]")?;
    writeln!(out, "compliance_mm3_per_kpa = {:?}", file.compliance_mm3_per_kpa)?;
    match file.model {
        // What designs are unless they say otherwise.
        ModelSection::Membrane if file.axes == Axes::Mid => {}
        ModelSection::Membrane => writeln!(out, "\n[model]\nkind = \"membrane\"")?,
        ModelSection::Auto => writeln!(out, "\n[model]\nkind = \"auto\"")?,
        ModelSection::Solid { through, along } => {
            writeln!(
                out,
                "\n[model]\nkind = \"solid\"\nthrough = {through}\nalong = {along}"
            )?;
        }
    }
    // A default that came later is not printed: the hashes of older designs stay.
    if file.axes != file.model.axes() {
        let axes = match file.axes {
            Axes::Mid => "mid",
            Axes::Outer => "outer",
        };
        writeln!(out, "axes = \"{axes}\"")?;
    }
    if let Some(object) = &file.object {
        object.print(out)?;
    }
    if let Some(depth) = file.max_indentation_mm {
        writeln!(out, "\n[press]\nmax_indentation_mm = {depth:?}")?;
    }
    if let Some(section) = &file.transducer {
        transducer(section, out)?;
    }
    file.zero.print(out)?;
    zero::print_air(file.air, out)?;
    if let Some(accuracy) = &file.accuracy {
        writeln!(out, "\n[accuracy]")?;
        let rows = [
            ("force_percent_of_reading", accuracy.force_percent_of_reading),
            (
                "indentation_percent_of_reading",
                accuracy.indentation_percent_of_reading,
            ),
            ("from_percent_of_full_scale", accuracy.from_percent_of_full_scale),
        ];
        for (key, value) in rows {
            writeln!(out, "{key} = {value:?}")?;
        }
        if accuracy.model_percent != DEFAULT_MODEL_PERCENT {
            writeln!(out, "model_percent = {:?}", accuracy.model_percent)?;
        }
    }
    if let Some(actuator) = &file.actuator {
        actuator.print(out)?;
    }
    file.calibration.print(out)
}

/// The keys of a law.
pub(super) fn law(law: &Law, out: &mut String) -> fmt::Result {
    match *law {
        Law::NeoHookean { c1 } => writeln!(out, "law = \"neo-hookean\"\nc1_pa = {c1:?}"),
        Law::MooneyRivlin { c1, c2 } => {
            writeln!(out, "law = \"mooney-rivlin\"\nc1_pa = {c1:?}\nc2_pa = {c2:?}")
        }
        Law::Yeoh { c1, c2, c3 } => {
            writeln!(
                out,
                "law = \"yeoh\"\nc1_pa = {c1:?}\nc2_pa = {c2:?}\nc3_pa = {c3:?}"
            )
        }
    }
}

fn transducer(section: &TransducerSection, out: &mut String) -> fmt::Result {
    writeln!(out, "\n[transducer]")?;
    match section.kind {
        TransducerKindSection::Ratiometric {
            output_fraction_at_range: [low, high],
            supply,
            source,
        } => {
            writeln!(
                out,
                "kind = \"ratiometric\"\noutput_fraction_at_range = [{low:?}, {high:?}]"
            )?;
            // A default that came later is not printed: the hashes of older designs stay.
            match supply {
                Supply::Reference => {}
                Supply::Measured => writeln!(out, "supply = \"measured\"")?,
            }
            if source != SourceResistance::IDEAL {
                writeln!(
                    out,
                    "source_ohm = {:?}\npull_up_ohm = {:?}",
                    source.ohm, source.pull_up_ohm
                )?;
            }
        }
        TransducerKindSection::Abp2 { address, transfer } => {
            let transfer = match transfer {
                Transfer::A => "A",
                Transfer::B => "B",
            };
            writeln!(
                out,
                "kind = \"abp2\"\naddress = {address:#04x}\ntransfer = \"{transfer}\""
            )?;
        }
        TransducerKindSection::Ms5837 => writeln!(out, "kind = \"ms5837-02ba\"")?,
        TransducerKindSection::Dps310 { address } => {
            writeln!(out, "kind = \"dps310\"\naddress = {address:#04x}")?;
        }
    }
    // As with the supply: gauge, which every older design was.
    match section.quantity {
        Quantity::Gauge => {}
        Quantity::Absolute => writeln!(out, "quantity = \"absolute\"")?,
    }
    let [low, high] = section.range_kpa;
    writeln!(out, "range_kpa = [{low:?}, {high:?}]")?;
    writeln!(out, "resolution_pa = {:?}", section.resolution_pa)?;
    writeln!(out, "noise_pa = {:?}", section.noise_pa)
}
