//! `[actuator]`: the feedback membrane.

use super::DesignFile;
use super::bounds::{Bounds, LENGTH};
use super::material::material;
use super::relaxation;
use super::section::{KeyFault, Section};
use crate::material::Law;
use crate::material::relaxation::Relaxation;
use crate::object::Friction;
use crate::solid::disc::{DiscDesign, FarSide};
use crate::solid::gas::TrappedGas;
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
    /// Air trapped in the line to it, cubic millimetres at ambient pressure; `None`: none.
    pub trapped_air_mm3: Option<f64>,
    /// Its law, and its series if it relaxes; `None`: the tip's, both.
    pub material: Option<(Law, Option<Relaxation>)>,
}

impl ActuatorSection {
    pub(super) fn parse(mut section: Section<'_>) -> Result<Self, KeyFault> {
        let diameter_mm = section.needed_number("diameter_mm", LENGTH)?;
        let thickness_mm = section.number("thickness_mm", LENGTH)?;
        let gap_mm = section.number("gap_mm", Bounds::within(0.0, 1000.0, "mm"))?;
        let foundation_kpa_per_mm =
            section.number("foundation_kpa_per_mm", Bounds::above(0.0, 1e6, "kPa/mm"))?;
        let trapped_air_mm3 = section.number("trapped_air_mm3", Bounds::within(0.0, 1e6, "mm^3"))?;
        match thickness_mm {
            Some(thickness) if thickness >= diameter_mm => {
                let allowed = format!("less than diameter_mm, {diameter_mm} mm");
                return Err(section.refuse("thickness_mm", &allowed));
            }
            Some(_) => {}
            None => {
                for key in ["gap_mm", "foundation_kpa_per_mm", "trapped_air_mm3"] {
                    if section.has(key) {
                        return Err(section.refuse(key, "left out, or given with thickness_mm"));
                    }
                }
            }
        }
        let material = section.sub("material")?.map(material).transpose()?;
        if thickness_mm.is_none() && matches!(material, Some((_, Some(_)))) {
            return Err(section.refuse(
                "material",
                "without relaxation, or given with thickness_mm: the formula is of a settled disc",
            ));
        }
        section.finish()?;
        Ok(Self {
            diameter_mm,
            thickness_mm,
            gap_mm,
            foundation_kpa_per_mm,
            trapped_air_mm3,
            material,
        })
    }

    pub(super) fn print(&self, out: &mut String) -> fmt::Result {
        writeln!(out, "\n[actuator]\ndiameter_mm = {:?}", self.diameter_mm)?;
        let rows = [
            ("thickness_mm", self.thickness_mm),
            ("gap_mm", self.gap_mm),
            ("foundation_kpa_per_mm", self.foundation_kpa_per_mm),
            ("trapped_air_mm3", self.trapped_air_mm3),
        ];
        for (key, value) in rows {
            if let Some(value) = value {
                writeln!(out, "{key} = {value:?}")?;
            }
        }
        if let Some((law, series)) = &self.material {
            writeln!(out, "\n[actuator.material]")?;
            super::print::law(law, out)?;
            if let Some(series) = series {
                relaxation::print("actuator.material.relaxation", series, out)?;
            }
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

    /// The same design with an actuator of another diameter, millimetres. Nothing changes without `[actuator]`.
    #[must_use]
    pub fn with_actuator_diameter(&self, diameter_mm: f64) -> Self {
        let mut file = self.clone();
        if let Some(actuator) = &mut file.actuator {
            actuator.diameter_mm = diameter_mm;
        }
        file
    }

    /// The same fingertip without its actuator, and with another compliance, cubic metres per pascal.
    #[must_use]
    pub fn alone(&self, compliance: f64) -> Self {
        let mut file = self.clone();
        file.actuator = None;
        file.compliance_mm3_per_kpa = compliance * 1e12;
        file.calibration.compliance_mm3_per_kpa = None;
        file
    }

    /// The law of the actuator: its own, or the tip's as it is calibrated.
    pub fn actuator_law(&self) -> Law {
        self.actuator
            .and_then(|actuator| actuator.material)
            .map_or_else(|| self.design().law, |(law, _)| law)
    }

    /// The actuator in time: its own series, or the tip's where it is of the tip's material; `None` where it is elastic.
    pub fn actuator_relaxation(&self) -> Option<Relaxation> {
        self.actuator
            .and_then(|actuator| actuator.material)
            .map_or(self.relaxation, |(_, series)| series)
    }

    /// Gas trapped in the line to the actuator, under a standard atmosphere.
    pub fn trapped_gas(&self) -> TrappedGas {
        let volume = self.actuator.and_then(|actuator| actuator.trapped_air_mm3);
        TrappedGas {
            volume: volume.unwrap_or(0.0) * 1e-9,
            ..TrappedGas::NONE
        }
    }
}
