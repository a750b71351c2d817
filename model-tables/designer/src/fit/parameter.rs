//! What a fit may change, and the scale on which it does.

use model_tables::design_file::{Calibration, DesignFile, RestSection};
use std::fmt;

/// A quantity that a fit may change, in the order in which it is kept when the data cannot tell two apart.
#[derive(Clone, Copy, Debug, Eq, PartialEq, Ord, PartialOrd)]
pub enum Parameter {
    /// Factor on every constant of the material.
    Material,
    /// Stretch of the pole at rest.
    PoleStretch,
    /// Compliance of tubing, actuator and bubbles, cubic millimetres per kilopascal.
    Compliance,
    /// What the transducer reads of a pascal.
    PressureGain,
    /// Factor on the wall's thickness.
    Thickness,
    /// What the stage reads at first touch, millimetres.
    IndentationOffset,
    /// What the pressure rise reads at rest, kilopascals.
    PressureOffset,
    /// What the load cell reads without a load, newtons: the bench's alone, no part of the device.
    ForceOffset,
}

/// Number of parameters.
pub const COUNT: usize = 8;

impl Parameter {
    /// All of them.
    pub const ALL: [Self; COUNT] = [
        Self::Material,
        Self::PoleStretch,
        Self::Compliance,
        Self::PressureGain,
        Self::Thickness,
        Self::IndentationOffset,
        Self::PressureOffset,
        Self::ForceOffset,
    ];

    /// What a fit changes unless told otherwise.
    pub const USUAL: [Self; 3] = [Self::Material, Self::PoleStretch, Self::Compliance];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Material => "material",
            Self::PoleStretch => "pole-stretch",
            Self::Compliance => "compliance",
            Self::PressureGain => "pressure-gain",
            Self::Thickness => "thickness",
            Self::IndentationOffset => "indentation-offset",
            Self::PressureOffset => "pressure-offset",
            Self::ForceOffset => "force-offset",
        }
    }

    /// Its key in `[calibration]`; empty for what is no part of the device.
    pub fn key(self) -> &'static str {
        match self {
            Self::Material => "material_factor",
            Self::PoleStretch => "pole_stretch",
            Self::Compliance => "compliance_mm3_per_kpa",
            Self::PressureGain => "pressure_gain",
            Self::Thickness => "thickness_factor",
            Self::IndentationOffset => "indentation_offset_mm",
            Self::PressureOffset => "pressure_offset_kpa",
            Self::ForceOffset => "",
        }
    }

    /// The parameter of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|parameter| parameter.name() == name)
    }

    /// The values that are possible; a fit that wants to leave them has found nonsense.
    pub fn bounds(self) -> [f64; 2] {
        match self {
            Self::Material | Self::Thickness => [0.01, 100.0],
            Self::PoleStretch => [1.0002, 5.0],
            Self::Compliance => [0.0, 1e5],
            Self::PressureGain => [0.1, 10.0],
            Self::IndentationOffset | Self::PressureOffset | Self::ForceOffset => [-1000.0, 1000.0],
        }
    }

    /// The value on the scale of the fit: logarithms where factors count.
    pub(super) fn coordinate(self, value: f64, units: &Units) -> f64 {
        match self {
            Self::Material | Self::Thickness | Self::PressureGain => libm::log(value),
            Self::PoleStretch => libm::log(value - 1.0),
            Self::Compliance => value / units.compliance,
            Self::IndentationOffset => value / units.indentation,
            Self::PressureOffset => value / units.rise,
            Self::ForceOffset => value / units.force,
        }
    }

    /// The value at a place on the scale of the fit.
    pub(super) fn value(self, coordinate: f64, units: &Units) -> f64 {
        match self {
            Self::Material | Self::Thickness | Self::PressureGain => libm::exp(coordinate),
            Self::PoleStretch => 1.0 + libm::exp(coordinate),
            Self::Compliance => coordinate * units.compliance,
            Self::IndentationOffset => coordinate * units.indentation,
            Self::PressureOffset => coordinate * units.rise,
            Self::ForceOffset => coordinate * units.force,
        }
    }
}

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// One unit of those coordinates that are no logarithms: what would be a large change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Units {
    /// Cubic millimetres per kilopascal.
    pub(super) compliance: f64,
    /// Millimetres.
    pub(super) indentation: f64,
    /// Kilopascals.
    pub(super) rise: f64,
    /// Newtons.
    pub(super) force: f64,
}

impl Units {
    /// Of the zeros of a trial: indentation, force, pressure rise, SI.
    pub(super) fn of_zeros(&self) -> [f64; 3] {
        [1e-3 * self.indentation, self.force, 1e3 * self.rise]
    }
}

/// A value for every parameter, in the units of the design file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParameterValues([f64; COUNT]);

impl ParameterValues {
    /// The calibration that a design has; `pole_stretch` is that of its rest state.
    pub fn of(file: &DesignFile, pole_stretch: f64) -> Self {
        let calibration = &file.calibration;
        Self(Parameter::ALL.map(|parameter| {
            match parameter {
                Parameter::Material => calibration.material_factor,
                Parameter::PoleStretch => pole_stretch,
                Parameter::Compliance => calibration
                    .compliance_mm3_per_kpa
                    .unwrap_or(file.compliance_mm3_per_kpa),
                Parameter::PressureGain => calibration.pressure_gain,
                Parameter::Thickness => calibration.thickness_factor,
                Parameter::IndentationOffset => calibration.indentation_offset_mm,
                Parameter::PressureOffset => calibration.pressure_offset_kpa,
                Parameter::ForceOffset => 0.0,
            }
        }))
    }

    /// One of them.
    pub fn get(&self, parameter: Parameter) -> f64 {
        self.0[parameter as usize]
    }

    /// Changes one of them.
    pub fn set(&mut self, parameter: Parameter, value: f64) {
        self.0[parameter as usize] = value;
    }

    /// The `[calibration]` with these values: `fitted` ones, and others where the design had them.
    pub fn calibration(&self, file: &DesignFile, fitted: &[Parameter]) -> Calibration {
        let given = |parameter: Parameter| fitted.contains(&parameter).then(|| self.get(parameter));
        let before = &file.calibration;
        Calibration {
            material_factor: self.get(Parameter::Material),
            thickness_factor: self.get(Parameter::Thickness),
            pole_stretch: given(Parameter::PoleStretch).or(before.pole_stretch),
            compliance_mm3_per_kpa: given(Parameter::Compliance).or(before.compliance_mm3_per_kpa),
            pressure_gain: self.get(Parameter::PressureGain),
            pressure_offset_kpa: self.get(Parameter::PressureOffset),
            indentation_offset_mm: self.get(Parameter::IndentationOffset),
            curve: None,
        }
    }

    /// Whether the rest state is given by its pole stretch, once `free` parameters are fitted.
    pub(super) fn rest_by_stretch(file: &DesignFile, free: &[Parameter]) -> bool {
        free.contains(&Parameter::PoleStretch)
            || file.calibration.pole_stretch.is_some()
            || matches!(file.rest, RestSection::PoleStretch(_))
    }
}
