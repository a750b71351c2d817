//! `[material]`: the law of a wall and its constants, or a preset, and its relaxation.

use super::bounds::Bounds;
use super::relaxation;
use super::section::{KeyFault, Section};
use crate::material::Law;
use crate::material::preset::{PRESETS, Preset};
use crate::material::relaxation::Relaxation;

/// Elastic constants, up to that of steel; of soft walls from the softest gels to hard rubber.
const STIFFNESS: Bounds =
    Bounds::above(0.0, 1e12, "Pa").usually([1e3, 3e7], &[("kPa", 1e3), ("MPa", 1e6), ("GPa", 1e9)]);

pub(super) fn material(mut section: Section<'_>) -> Result<(Law, Option<Relaxation>), KeyFault> {
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
