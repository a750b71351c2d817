//! `[object]`: the object that touches the fingertip.

use super::bounds::Bounds;
use super::section::{KeyFault, Section};
use crate::object::{Friction, Object, Shape};
use std::fmt::{self, Write};

/// `[object]`, lengths in millimetres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObjectSection {
    /// `shape` and its lengths.
    pub shape: ShapeSection,
    /// `friction`: a Coulomb coefficient or `"stick"`; 0 where not given.
    pub friction: Friction,
    /// `unknown`: what touches is not known; the reference object is the one with the smallest band.
    pub unknown: bool,
}

/// `shape`, with the lengths that it takes, millimetres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ShapeSection {
    /// `"ball"`, without `radius_mm`.
    Plate,
    /// `"ball"`; a negative radius is that of a cup.
    Ball {
        /// `radius_mm`, not 0.
        radius_mm: f64,
    },
    /// `"cylinder"`.
    Cylinder {
        /// `radius_mm`, > 0.
        radius_mm: f64,
    },
    /// `"punch"`.
    Punch {
        /// `radius_mm`, > 0.
        radius_mm: f64,
        /// `rim_mm`, > 0 and at most `radius_mm`.
        rim_mm: f64,
    },
}

/// Radii of objects; of a cup negative.
const RADIUS: Bounds = Bounds::within(-1e6, 1e6, "mm");
/// Lengths that have no sign.
const LENGTH: Bounds = Bounds::above(0.0, 1e6, "mm");
/// Coulomb coefficients.
const COEFFICIENT: Bounds = Bounds::within(0.0, 10.0, "");

impl ObjectSection {
    /// In SI units.
    pub fn object(&self) -> Object {
        const MM: f64 = 1e-3;
        Object {
            shape: match self.shape {
                ShapeSection::Plate => Shape::Plate,
                ShapeSection::Ball { radius_mm } if radius_mm < 0.0 => Shape::Cup {
                    radius: -radius_mm * MM,
                },
                ShapeSection::Ball { radius_mm } => Shape::Ball {
                    radius: radius_mm * MM,
                },
                ShapeSection::Cylinder { radius_mm } => Shape::Cylinder {
                    radius: radius_mm * MM,
                },
                ShapeSection::Punch { radius_mm, rim_mm } => Shape::Punch {
                    radius: radius_mm * MM,
                    rim: rim_mm * MM,
                },
            },
            friction: self.friction,
        }
    }

    /// The section of a file.
    pub(super) fn parse(mut section: Section<'_>) -> Result<Self, KeyFault> {
        const SHAPES: &str = "\"ball\", \"cylinder\" or \"punch\"";
        let shape = match section.text("shape", SHAPES)? {
            None | Some("ball") => match section.number("radius_mm", RADIUS)? {
                None => ShapeSection::Plate,
                Some(radius_mm) if radius_mm.abs() > 0.0 => ShapeSection::Ball { radius_mm },
                Some(_) => {
                    let allowed = "a ball's radius above 0, a cup's below 0, or left out for a plate";
                    return Err(section.refuse("radius_mm", allowed));
                }
            },
            Some("cylinder") => ShapeSection::Cylinder {
                radius_mm: section.needed_number("radius_mm", LENGTH)?,
            },
            Some("punch") => {
                let radius_mm = section.needed_number("radius_mm", LENGTH)?;
                let rim_mm = section.needed_number("rim_mm", LENGTH)?;
                if rim_mm > radius_mm {
                    let allowed = format!("at most radius_mm, {radius_mm} mm: it is the fillet of the rim");
                    return Err(section.refuse("rim_mm", &allowed));
                }
                ShapeSection::Punch { radius_mm, rim_mm }
            }
            Some(_) => return Err(section.refuse("shape", SHAPES)),
        };
        if !matches!(shape, ShapeSection::Punch { .. }) && section.has("rim_mm") {
            return Err(section.refuse("rim_mm", "left out: only shape = \"punch\" has a rim"));
        }
        let friction = match section.number_or_text("friction", COEFFICIENT, "stick")? {
            None => Friction::NONE,
            Some(Some(coefficient)) => Friction::Coulomb(coefficient),
            Some(None) => Friction::Stick,
        };
        let unknown = section.flag("unknown")?.unwrap_or(false);
        if unknown && shape != ShapeSection::Plate {
            return Err(section.refuse("unknown", "false or left out, as object.radius_mm is given"));
        }
        section.finish()?;
        Ok(Self {
            shape,
            friction,
            unknown,
        })
    }

    /// The section in a design's canonical text.
    pub(super) fn print(&self, out: &mut String) -> fmt::Result {
        writeln!(out, "\n[object]")?;
        match self.shape {
            ShapeSection::Plate => {}
            ShapeSection::Ball { radius_mm } => writeln!(out, "radius_mm = {radius_mm:?}")?,
            ShapeSection::Cylinder { radius_mm } => {
                writeln!(out, "shape = \"cylinder\"\nradius_mm = {radius_mm:?}")?;
            }
            ShapeSection::Punch { radius_mm, rim_mm } => {
                writeln!(
                    out,
                    "shape = \"punch\"\nradius_mm = {radius_mm:?}\nrim_mm = {rim_mm:?}"
                )?;
            }
        }
        match self.friction {
            Friction::Coulomb(coefficient) => writeln!(out, "friction = {coefficient:?}")?,
            Friction::Stick => writeln!(out, "friction = \"stick\"")?,
        }
        if self.unknown {
            writeln!(out, "unknown = true")?;
        }
        Ok(())
    }
}
