//! The design file: the TOML text that states a fingertip, read by build script and command line alike.
//!
//! Values keep the units of the file (their key names say which), so that reading what was printed gives the
//! same design; [`DesignFile::design`] converts to SI. Every error is one line and names the key, the value
//! found and what is allowed.

mod actuator;
pub mod bounds;
mod calibration;
pub mod document;
mod error;
pub mod hand;
mod material;
mod object;
mod print;
mod relaxation;
pub mod section;
mod sections;
mod transducer;
mod zero;

use crate::constants::{AIR, AirReference, Quantity};
use crate::design::{Design, Membrane, RestBy};
use crate::material::Law;
use crate::material::relaxation::Relaxation;
use crate::object::Object;
use sha2::{Digest, Sha256};
use std::path::Path;

pub use actuator::ActuatorSection;
pub use calibration::{Calibration, DataCurve};
pub use error::{DesignFileError, Problem};
pub use object::{ObjectSection, ShapeSection};
pub use zero::ZeroSection;

/// Elements of a solid where a design does not say: through the wall and along it. Enough for a few tenths of a percent.
pub const DEFAULT_ELEMENTS: [u32; 2] = [2, 60];

/// Largest error of the model itself where a design does not say, percent of reading.
pub const DEFAULT_MODEL_PERCENT: f64 = 5.0;

/// A design file's content.
#[derive(Clone, Debug, PartialEq)]
pub struct DesignFile {
    /// The design's name: letters, digits, `-` and `_`.
    pub name: String,
    /// `[membrane]`.
    pub membrane: MembraneSection,
    /// `[material]`: constants in pascals, those of the preset if it names one.
    pub material: Law,
    /// `[material.relaxation]`; `None`: the wall is elastic.
    pub relaxation: Option<Relaxation>,
    /// `[rest]`.
    pub rest: RestSection,
    /// `[model]`.
    pub model: ModelSection,
    /// `[model] axes`: what the semi-axes of `[membrane]` are measured to.
    pub axes: Axes,
    /// `[fluid] compliance_mm3_per_kpa`: tubing, actuator and bubbles, cubic millimetres per kilopascal.
    pub compliance_mm3_per_kpa: f64,
    /// `[object]`: what touches; `None`: a flat, frictionless plate, and only that.
    pub object: Option<ObjectSection>,
    /// `[press] max_indentation_mm`: end of the tables, millimetres; `None` in a file that makes no tables.
    pub max_indentation_mm: Option<f64>,
    /// `[transducer]`; `None` in a file that makes no tables.
    pub transducer: Option<TransducerSection>,
    /// `[zero]`: what may move the zero beside a press.
    pub zero: ZeroSection,
    /// `[air] reference`: who measures the air around an absolute transducer.
    pub air: AirReference,
    /// `[accuracy]`; `None` in a file that makes no tables.
    pub accuracy: Option<Accuracy>,
    /// `[actuator]`: the feedback membrane; `None`: the design has none.
    pub actuator: Option<ActuatorSection>,
    /// `[calibration]`.
    pub calibration: Calibration,
}

/// `[membrane]`: undeformed, millimetres. [`DesignFile::axes`] tells of which surface the semi-axes are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MembraneSection {
    /// Radial semi-axis, millimetres, > 0.
    pub radial_semi_axis_mm: f64,
    /// Axial semi-axis, millimetres, > 0.
    pub axial_semi_axis_mm: f64,
    /// Wall thickness, millimetres, > 0.
    pub thickness_mm: f64,
}

/// `[model]`: what the fingertip is solved with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModelSection {
    /// `kind = "membrane"`, also where the section is left out.
    Membrane,
    /// `kind = "solid"`, with elements through the wall and along the meridian.
    Solid {
        /// `through`.
        through: u32,
        /// `along`.
        along: u32,
    },
    /// `kind = "auto"`: the cheapest that meets `[accuracy]`.
    Auto,
}

impl ModelSection {
    /// The semi-axes that the model is solved with, and those of a file that names none.
    pub const fn axes(self) -> Axes {
        match self {
            Self::Membrane => Axes::Mid,
            Self::Solid { .. } | Self::Auto => Axes::Outer,
        }
    }
}

/// A surface of the undeformed wall, which its semi-axes are measured to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axes {
    /// The middle of the wall.
    Mid,
    /// The outer surface.
    Outer,
}

/// `[rest]`: exactly one of its keys; left out for a solid that is not inflated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RestSection {
    /// No section: as it was made.
    Unstretched,
    /// `pole_stretch`, > 1.
    PoleStretch(f64),
    /// `pressure_kpa`, gauge, > 0.
    PressureKpa(f64),
    /// `equator_radius_mm`, deformed.
    EquatorRadiusMm(f64),
    /// `height_mm` of the inflated dome over its base.
    HeightMm(f64),
}

/// `[transducer]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransducerSection {
    /// Kilopascals. Of an absolute analogue part the two ends that its datasheet gives, absolute; of every other one gauge
    /// pressures.
    pub range_kpa: [f64; 2],
    /// Smallest change it tells apart, pascals.
    pub resolution_pa: f64,
    /// One standard deviation of one sample at the converter, pascals; `resolution_pa` where not given.
    pub noise_pa: f64,
    /// What it measures against.
    pub quantity: Quantity,
    /// Its kind.
    pub kind: TransducerKindSection,
}

impl TransducerSection {
    /// The ends of the part's own range in its own quantity, kilopascals.
    pub fn own_range_kpa(&self) -> [f64; 2] {
        self.kind.absolute_range_kpa().unwrap_or(self.range_kpa)
    }

    /// Gauge pressures that it reads in any air, kilopascals.
    pub fn gauge_range_kpa(&self) -> [f64; 2] {
        if self.range_is_absolute() {
            in_any_air(self.range_kpa)
        } else {
            self.range_kpa
        }
    }

    /// Whether `range_kpa` is absolute: of an analogue part it describes the part, and not what is wanted of it.
    pub fn range_is_absolute(&self) -> bool {
        self.quantity == Quantity::Absolute && matches!(self.kind, TransducerKindSection::Ratiometric { .. })
    }
}

/// [`AIR`], kilopascals.
pub(crate) fn air_kpa() -> [f64; 2] {
    AIR.map(|pascals| f64::from(pascals) / 1e3)
}

/// What is left of an absolute range above the air around it, whatever that is ([`AIR`]): gauge, kilopascals.
pub(crate) fn in_any_air([low, high]: [f64; 2]) -> [f64; 2] {
    let [thinnest, densest] = air_kpa();
    [low - thinnest, high - densest]
}

/// What an analogue output passes on its way to the converter: its own resistance, and the pull-up to the converter's reference that tells
/// a broken wire.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SourceResistance {
    /// Resistance of the output, or of the divider behind it (its two legs in parallel), ohms, 0 to [`Self::MAX_OHM`]; 0 if the file does
    /// not say.
    pub ohm: f64,
    /// The pull-up, ohms, at least [`Self::MIN_PULL_UP_OHM`]; 1 megohm if the file does not say.
    pub pull_up_ohm: f64,
}

impl SourceResistance {
    /// An ideal output.
    pub const IDEAL: Self = Self {
        ohm: 0.0,
        pull_up_ohm: 1e6,
    };
    /// From a source of more the converter's capacitor does not settle in the time that the boards sample, ohms.
    pub const MAX_OHM: f64 = 10e3;
    /// Below, the pull-up itself would be the load that the datasheets of these parts forbid, ohms.
    pub const MIN_PULL_UP_OHM: f64 = 100e3;

    /// What the converter sees of an output, both fractions of its reference: source and pull-up divide the voltage between the output and
    /// the reference (Kirchhoff's current law).
    pub fn at_converter(self, output: f64) -> f64 {
        (output * self.pull_up_ohm + self.ohm) / (self.pull_up_ohm + self.ohm)
    }
}

/// `kind` of `[transducer]`, with the keys that only it has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TransducerKindSection {
    /// `"ratiometric"`: a voltage proportional to the supply.
    Ratiometric {
        /// Output at the two ends of the range, fractions of the supply.
        output_fraction_at_range: [f64; 2],
        /// What the transducer is supplied with.
        supply: Supply,
        /// What lies between its output and the converter.
        source: SourceResistance,
    },
    /// `"abp2"`: Honeywell ABP2.
    Abp2 {
        /// Seven-bit I2C address.
        address: u8,
        /// Transfer function.
        transfer: Transfer,
    },
    /// `"ms5837-02ba"`: TE MS5837-02BA; its address is fixed.
    Ms5837,
    /// `"dps310"`: Infineon DPS310.
    Dps310 {
        /// Seven-bit I2C address, 0x76 or 0x77.
        address: u8,
    },
}

impl TransducerKindSection {
    /// What a part on a bus measures against; an analogue one may be either.
    pub const fn own_quantity(&self) -> Option<Quantity> {
        match self {
            Self::Ratiometric { .. } => None,
            Self::Abp2 { .. } => Some(Quantity::Gauge),
            Self::Ms5837 | Self::Dps310 { .. } => Some(Quantity::Absolute),
        }
    }

    /// The range of an absolute part on a bus, which is in its datasheet: kilopascals absolute.
    pub const fn absolute_range_kpa(&self) -> Option<[f64; 2]> {
        match self {
            Self::Ratiometric { .. } | Self::Abp2 { .. } => None,
            // TE, datasheet of 09/2017: 10 to 2000 mbar.
            Self::Ms5837 => Some([1.0, 200.0]),
            // Infineon, datasheet V1.2, table 3.
            Self::Dps310 { .. } => Some([30.0, 120.0]),
        }
    }
}

/// `supply` of a ratiometric transducer.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum Supply {
    /// `"reference"`: the converter's own reference, so that it cancels. The default.
    #[default]
    Reference,
    /// `"measured"`: another one, which the board measures beside the output.
    Measured,
}

/// Transfer function of a Honeywell ABP2.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Transfer {
    /// 10 % to 90 % of 2^24 counts.
    A,
    /// 30 % to 70 % of 2^24 counts.
    B,
}

/// `[accuracy]`: what the tables must meet on every input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accuracy {
    /// Largest error of the force, percent of reading.
    pub force_percent_of_reading: f64,
    /// Largest error of the indentation, percent of reading.
    pub indentation_percent_of_reading: f64,
    /// Where that begins, percent of the output at `max_indentation_mm`; below it the same error in absolute
    /// terms.
    pub from_percent_of_full_scale: f64,
    /// Largest error of the model itself, percent of reading; tables of a worse model are refused.
    pub model_percent: f64,
}

impl DesignFile {
    /// Reads and checks a design file.
    ///
    /// # Errors
    /// [`DesignFileError`] with the file's name, and the line where there is one.
    pub fn read(path: &Path) -> Result<Self, DesignFileError> {
        Self::parse(&document::read(path)?, &path.display().to_string())
    }

    /// Checks the text of a design file; `file` is the name that errors give it.
    ///
    /// # Errors
    /// [`DesignFileError`] for the first thing that is wrong.
    pub fn parse(text: &str, file: &str) -> Result<Self, DesignFileError> {
        sections::parse(text).map_err(|fault| DesignFileError::at(file, fault))
    }

    /// The design's canonical text: every value written out, comments left out.
    pub fn canonical(&self) -> String {
        print::canonical(self)
    }

    /// SHA-256 of [`DesignFile::canonical`].
    pub fn hash(&self) -> [u8; 32] {
        Sha256::digest(self.canonical()).into()
    }

    /// What the model needs of the design as it is calibrated, in SI units: its semi-axes are those of [`ModelSection::axes`].
    pub fn design(&self) -> Design {
        self.design_to(self.model.axes())
    }

    /// The same with the semi-axes of a surface of its choice. They are converted with the thickness that the file gives; a calibration
    /// changes the wall alone.
    pub fn design_to(&self, axes: Axes) -> Design {
        const MM: f64 = 1e-3;
        const KPA: f64 = 1e3;
        let thickness = self.membrane.thickness_mm;
        // Exactly the file's where nothing is converted.
        let outward = match (self.axes, axes) {
            (Axes::Mid, Axes::Outer) => 0.5 * thickness,
            (Axes::Outer, Axes::Mid) => -0.5 * thickness,
            (Axes::Mid, Axes::Mid) | (Axes::Outer, Axes::Outer) => 0.0,
        };
        Design {
            membrane: Membrane {
                radial_semi_axis: (self.membrane.radial_semi_axis_mm + outward) * MM,
                axial_semi_axis: (self.membrane.axial_semi_axis_mm + outward) * MM,
                thickness: self.membrane.thickness_mm * self.calibration.thickness_factor * MM,
            },
            law: self.material.stiffened(self.calibration.material_factor),
            rest: match self
                .calibration
                .pole_stretch
                .map_or(self.rest, RestSection::PoleStretch)
            {
                RestSection::Unstretched => RestBy::Unstretched,
                RestSection::PoleStretch(stretch) => RestBy::PoleStretch(stretch),
                RestSection::PressureKpa(pressure) => RestBy::Pressure(pressure * KPA),
                RestSection::EquatorRadiusMm(radius) => RestBy::EquatorRadius(radius * MM),
                RestSection::HeightMm(height) => RestBy::Height(height * MM),
            },
            compliance: 1e-12
                * self
                    .calibration
                    .compliance_mm3_per_kpa
                    .unwrap_or(self.compliance_mm3_per_kpa),
            object: self.object.as_ref().map_or(Object::PLATE, ObjectSection::object),
        }
    }
}

#[cfg(test)]
mod tests;
