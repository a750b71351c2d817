//! `[calibration]`: values of one device, measured on a bench, beside the design it was built from.
//!
//! The design itself stays as drawn. `fit` writes this section; without it, the design is the nominal one again.
//!
//! Three frames meet here. The *model* has the true gauge pressure and counts the indentation from first touch. The *bench* reads
//! `pressure_gain` times the pressure, with rises that are `pressure_offset_kpa` too high. Its stage is at `indentation_offset_mm`
//! at first touch. `rest` and `solve` answer in this frame, as the columns of the data. The *chip* reads through the same
//! transducer, but takes its own zero, which removes the offset, and counts the indentation from first touch. Therefore the tables
//! include the gain, and the stored rest pressure includes gain and offset.

use super::bounds::Bounds;
use super::section::{KeyFault, Section};
use crate::curve::Contact;
use crate::monotone::Monotone;
use std::fmt::{self, Write};

/// `[calibration]`. Its default changes nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    /// Factor on every constant of `[material]`, dimensionless.
    pub material_factor: f64,
    /// Factor on `membrane.thickness_mm`, dimensionless.
    pub thickness_factor: f64,
    /// Pole stretch that replaces `[rest]`, dimensionless; `None`: the design's rest.
    pub pole_stretch: Option<f64>,
    /// Replaces `[fluid] compliance_mm3_per_kpa`, cubic millimetres per kilopascal; `None`: the design's.
    pub compliance_mm3_per_kpa: Option<f64>,
    /// Pascals that the transducer reads per pascal, dimensionless.
    pub pressure_gain: f64,
    /// What the bench's pressure rise reads at rest, kilopascals.
    pub pressure_offset_kpa: f64,
    /// What the bench's indentation reads at first touch, millimetres.
    pub indentation_offset_mm: f64,
    /// Tables from data alone, in the place of the model; `None`: tables of the model.
    pub curve: Option<DataCurve>,
}

/// A press as it was measured: knots of rise, force and indentation, all strictly increasing from above zero.
#[derive(Clone, Debug, PartialEq)]
pub struct DataCurve {
    /// What the transducer reads at rest, kilopascals.
    pub rest_pressure_kpa: f64,
    /// Pressure rise over rest as the transducer reads it, kilopascals.
    pub pressure_rise_kpa: Vec<f64>,
    /// Force, newtons.
    pub force_n: Vec<f64>,
    /// Indentation from first touch, millimetres.
    pub indentation_mm: Vec<f64>,
}

impl Default for Calibration {
    fn default() -> Self {
        Self {
            material_factor: 1.0,
            thickness_factor: 1.0,
            pole_stretch: None,
            compliance_mm3_per_kpa: None,
            pressure_gain: 1.0,
            pressure_offset_kpa: 0.0,
            indentation_offset_mm: 0.0,
            curve: None,
        }
    }
}

/// Knots of a curve from data: what one interpolating polynomial needs, and as many as anyone can read.
const KNOTS: [usize; 2] = [6, 1000];

impl Calibration {
    /// The pressure that the transducer reads, pascals, of a true gauge pressure; and the rise that the bench reads of
    /// a true rise.
    pub fn pressure_read(&self, pascals: f64) -> f64 {
        self.pressure_gain * pascals + 1e3 * self.pressure_offset_kpa
    }

    /// The true indentation, metres, of what the bench's stage reads; at or below zero the plate does not touch.
    pub fn indentation_of(&self, metres_read: f64) -> f64 {
        metres_read - 1e-3 * self.indentation_offset_mm
    }

    /// What the bench's stage reads, metres, of a true indentation.
    pub fn indentation_read(&self, metres: f64) -> f64 {
        metres + 1e-3 * self.indentation_offset_mm
    }

    /// The section of a file.
    pub(super) fn parse(mut section: Section<'_>) -> Result<Self, KeyFault> {
        const FACTOR: Bounds = Bounds::within(0.001, 1000.0, "");
        const GAIN: Bounds = Bounds::within(0.1, 10.0, "");
        let default = Self::default();
        let calibration = Self {
            material_factor: section
                .number("material_factor", FACTOR)?
                .unwrap_or(default.material_factor),
            thickness_factor: section
                .number("thickness_factor", FACTOR)?
                .unwrap_or(default.thickness_factor),
            pole_stretch: section.number("pole_stretch", Bounds::above(1.0, 10.0, "(no stretch is 1)"))?,
            compliance_mm3_per_kpa: section
                .number("compliance_mm3_per_kpa", Bounds::within(0.0, 1e6, "mm^3/kPa"))?,
            pressure_gain: section
                .number("pressure_gain", GAIN)?
                .unwrap_or(default.pressure_gain),
            pressure_offset_kpa: section
                .number("pressure_offset_kpa", Bounds::within(-1000.0, 1000.0, "kPa"))?
                .unwrap_or(default.pressure_offset_kpa),
            indentation_offset_mm: section
                .number("indentation_offset_mm", Bounds::within(-1000.0, 1000.0, "mm"))?
                .unwrap_or(default.indentation_offset_mm),
            curve: DataCurve::parse(&mut section)?,
        };
        section.finish()?;
        Ok(calibration)
    }

    /// The section in a design's canonical text; nothing where it changes nothing.
    pub(super) fn print(&self, out: &mut String) -> fmt::Result {
        if *self == Self::default() {
            return Ok(());
        }
        writeln!(out, "\n[calibration]")?;
        writeln!(out, "material_factor = {:?}", self.material_factor)?;
        writeln!(out, "thickness_factor = {:?}", self.thickness_factor)?;
        if let Some(stretch) = self.pole_stretch {
            writeln!(out, "pole_stretch = {stretch:?}")?;
        }
        if let Some(compliance) = self.compliance_mm3_per_kpa {
            writeln!(out, "compliance_mm3_per_kpa = {compliance:?}")?;
        }
        writeln!(out, "pressure_gain = {:?}", self.pressure_gain)?;
        writeln!(out, "pressure_offset_kpa = {:?}", self.pressure_offset_kpa)?;
        writeln!(out, "indentation_offset_mm = {:?}", self.indentation_offset_mm)?;
        if let Some(curve) = &self.curve {
            writeln!(out, "rest_pressure_kpa = {:?}", curve.rest_pressure_kpa)?;
            writeln!(out, "curve_pressure_rise_kpa = {:?}", curve.pressure_rise_kpa)?;
            writeln!(out, "curve_force_n = {:?}", curve.force_n)?;
            writeln!(out, "curve_indentation_mm = {:?}", curve.indentation_mm)?;
        }
        Ok(())
    }
}

/// Points through which a curve from data is handed on, and its deepest over its shallowest pressure rise.
const POINTS: usize = 256;
const RANGE: f64 = 1e5;

impl DataCurve {
    /// The last knot, in SI units.
    ///
    /// # Panics
    /// If there are no knots; a design file always has some.
    pub fn end(&self) -> Contact {
        let last = |knots: &[f64]| *knots.last().expect("a curve has knots");
        Contact {
            pressure_rise: 1e3 * last(&self.pressure_rise_kpa),
            force: last(&self.force_n),
            indentation: 1e-3 * last(&self.indentation_mm),
        }
    }

    /// Points of the monotone curve from the origin through the knots, down to an indentation in metres, at
    /// geometrically growing pressure rises.
    ///
    /// # Panics
    /// If the knots do not increase; those of a design file do.
    pub fn points(&self, deepest: f64) -> Vec<Contact> {
        let from_zero = |knots: &[f64]| [&[0.0], knots].concat();
        let [rise, force, indentation] =
            [&self.pressure_rise_kpa, &self.force_n, &self.indentation_mm].map(|knots| from_zero(knots));
        let through = |y: Vec<f64>| Monotone::new(rise.clone(), y).expect("knots increase");
        let (force, depth) = (through(force), through(indentation));
        // Where the curve itself is that deep.
        let (mut low, mut end) = (0.0, rise[rise.len() - 1]);
        while end - low > 1e-14 * end {
            let middle = 0.5 * (low + end);
            if middle <= low || middle >= end {
                break;
            }
            if depth.at(middle) < 1e3 * deepest {
                low = middle;
            } else {
                end = middle;
            }
        }
        (0..=POINTS)
            .map(|k| end * libm::pow(RANGE, k as f64 / POINTS as f64 - 1.0))
            .map(|rise| Contact {
                pressure_rise: 1e3 * rise,
                force: force.at(rise),
                indentation: 1e-3 * depth.at(rise),
            })
            .collect()
    }

    const KEYS: [&'static str; 4] = [
        "curve_pressure_rise_kpa",
        "curve_force_n",
        "curve_indentation_mm",
        "rest_pressure_kpa",
    ];

    fn parse(section: &mut Section<'_>) -> Result<Option<Self>, KeyFault> {
        const KNOT: Bounds = Bounds::above(0.0, 1e6, "");
        let given = Self::KEYS.map(|key| section.has(key));
        if given == [false; 4] {
            return Ok(None);
        }
        if let Some(missing) = given.iter().position(|given| !given) {
            let others = "what belongs to the other keys of a curve from data";
            return Err(section.missing(Self::KEYS[missing], others));
        }
        let rest = section.needed_number("rest_pressure_kpa", Bounds::within(-101.325, 10_000.0, "kPa"))?;
        let mut columns = Vec::new();
        for key in &Self::KEYS[..3] {
            let knots = section.increasing(key, KNOT, KNOTS)?;
            if let Some(first) = columns.first().map(Vec::len)
                && knots.len() != first
            {
                let allowed = format!("as many numbers as {} has, {first}", Self::KEYS[0]);
                return Err(section.refuse(key, &allowed));
            }
            columns.push(knots);
        }
        let [pressure_rise_kpa, force_n, indentation_mm] =
            <[Vec<f64>; 3]>::try_from(columns).expect("three keys were read");
        Ok(Some(Self {
            rest_pressure_kpa: rest,
            pressure_rise_kpa,
            force_n,
            indentation_mm,
        }))
    }
}
