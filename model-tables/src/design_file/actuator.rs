//! `[actuator]`: the feedback membrane.

use super::DesignFile;
use super::bounds::{Bounds, LENGTH};
use super::material::material;
use super::section::{KeyFault, Section};
use crate::material::Law;
use crate::object::Friction;
use crate::solid::disc::{DiscDesign, FarSide};
use core::fmt::{self, Write as _};

/// `[actuator]`, in the units of its keys.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActuatorSection {
    /// Free diameter, millimetres.
    pub diameter_mm: f64,
    /// Thickness, millimetres, > 0; `None`: the paper's formula alone.
    pub thickness_mm: Option<f64>,
    /// Distance of the plate over it, millimetres, >= 0; `None` without a foundation: the disc is free.
    pub gap_mm: Option<f64>,
    /// Stiffness of a foundation over it, kilopascals per millimetre, > 0; `None`: the plate over it is rigid.
    pub foundation_kpa_per_mm: Option<f64>,
    /// Its law; `None`: the tip's.
    pub material: Option<Law>,
}

impl ActuatorSection {
    pub(super) fn parse(mut section: Section<'_>) -> Result<Self, KeyFault> {
        let diameter_mm = section.needed_number("diameter_mm", LENGTH)?;
        let thickness_mm = section.number("thickness_mm", LENGTH)?;
        let gap_mm = section.number("gap_mm", Bounds::within(0.0, 1000.0, "mm"))?;
        let foundation_kpa_per_mm =
            section.number("foundation_kpa_per_mm", Bounds::above(0.0, 1e6, "kPa/mm"))?;
        match thickness_mm {
            Some(thickness) if thickness >= diameter_mm => {
                let allowed = format!("less than diameter_mm, {diameter_mm} mm");
                return Err(section.refuse("thickness_mm", &allowed));
            }
            Some(_) => {}
            None => {
                for key in ["gap_mm", "foundation_kpa_per_mm"] {
                    if section.has(key) {
                        return Err(section.refuse(key, "left out, or given with thickness_mm"));
                    }
                }
            }
        }
        let law = section.sub("material")?.map(material).transpose()?;
        if let Some((_, Some(_))) = law {
            return Err(section.refuse(
                "material",
                "without relaxation: the disc is solved as a settled wall",
            ));
        }
        section.finish()?;
        Ok(Self {
            diameter_mm,
            thickness_mm,
            gap_mm,
            foundation_kpa_per_mm,
            material: law.map(|(law, _)| law),
        })
    }

    pub(super) fn print(&self, out: &mut String) -> fmt::Result {
        writeln!(out, "\n[actuator]\ndiameter_mm = {:?}", self.diameter_mm)?;
        let rows = [
            ("thickness_mm", self.thickness_mm),
            ("gap_mm", self.gap_mm),
            ("foundation_kpa_per_mm", self.foundation_kpa_per_mm),
        ];
        for (key, value) in rows {
            if let Some(value) = value {
                writeln!(out, "{key} = {value:?}")?;
            }
        }
        if let Some(law) = &self.material {
            writeln!(out, "\n[actuator.material]")?;
            super::print::law(law, out)?;
        }
        Ok(())
    }
}

impl DesignFile {
    /// The actuator as a disc, in SI units; `None` without `[actuator] thickness_mm`.
    pub fn disc(&self) -> Option<DiscDesign> {
        let actuator = self.actuator?;
        let gap = actuator.gap_mm.map(|gap| gap * 1e-3);
        let far_side = match (actuator.foundation_kpa_per_mm, gap) {
            (Some(stiffness), gap) => FarSide::Foundation {
                gap: gap.unwrap_or(0.0),
                stiffness: stiffness * 1e6,
            },
            (None, Some(gap)) => FarSide::Plate { gap },
            (None, None) => FarSide::Free,
        };
        Some(DiscDesign {
            diameter: actuator.diameter_mm * 1e-3,
            thickness: actuator.thickness_mm? * 1e-3,
            law: self.actuator_law(),
            far_side,
            friction: Friction::NONE,
        })
    }

    /// The law of the actuator: its own, or the tip's as it is calibrated.
    pub fn actuator_law(&self) -> Law {
        self.actuator
            .and_then(|actuator| actuator.material)
            .unwrap_or_else(|| self.design().law)
    }
}
