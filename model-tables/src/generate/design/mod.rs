//! From a design to its tables: the full model, and every refusal on the way.

mod error;
mod haptic;
mod in_time;
mod limit;
mod press;
mod unknown;

pub use error::{DesignState, GenerateError};
pub use in_time::InTime;
pub use limit::AccuracyLimit;

use super::feedback::FeedbackCurve;
use super::object::{Band, NoObjects, SolvedObjects, Unknown, plate_of};
use super::{Beside, Certified, ChipSeries, NoTables, tables_with};
use crate::constants::{AirReference, BELOW_ZERO_DEVIATIONS, Transducer, TransducerKind};
use crate::curve::{Contact, Curve};
use crate::design_file::{
    DesignFile, ModelSection, RestSection, ShapeSection, Supply, TransducerKindSection, TransducerSection,
    Transfer,
};
use crate::model::own_error::{Comparison, OwnError};
use crate::model::{Fingertip, Kind};
use press::{ReadPress, measured, pressed};
use sha2::{Digest as _, Sha256};
use std::path::Path;

/// States that the curve is compared with on a finer mesh, about; of the solid, whose states take long, fewer.
const CHECKED: usize = 12;
const CHECKED_SOLID: usize = 6;
/// A relaxing wall's stress of a change in no time over the settled one: less than this.
const MAX_STIFFENED: f64 = 65_535.0;

/// How often the accuracy is doubled at most where worse is allowed: a thousand times what was asked.
const MAX_DOUBLINGS: u32 = 10;

/// The solved design from which tables are made.
#[derive(Clone, Debug)]
pub struct Solved {
    /// Its transducer.
    pub transducer: TransducerSection,
    /// Gauge pressure at rest, pascals.
    pub rest_pressure: f64,
    /// The press, which may go on a little beyond its end.
    pub curve: Curve,
    /// The end that the tables cover.
    pub end: Contact,
    /// The model that solved it, with an actuator's disc that of the fingertip alone that has the loop's deepest state; `None` where the
    /// curve is of data.
    pub fingertip: Option<Fingertip>,
    /// The force of the feedback actuator over the press; `None` where the design has none that presses.
    pub feedback: Option<FeedbackCurve>,
    /// The compliance of that fingertip, cubic metres per pascal; `None` without an actuator's disc.
    pub compliance: Option<f64>,
}

/// Tables of a design, with everything that is written beside them.
#[derive(Clone, Debug, PartialEq)]
pub struct Generated {
    /// The design.
    pub design: DesignFile,
    /// Its transducer.
    pub transducer: TransducerSection,
    /// Gauge pressure at rest, pascals.
    pub rest_pressure: f64,
    /// The end of the press that the tables cover.
    pub end: Contact,
    /// Tables and certificate.
    pub certified: Certified,
    /// The curve against states of the same model on a finer mesh, half way between those that it was made from; `None` where it
    /// is of data.
    pub model_error: Option<Comparison>,
    /// The model that the curve is of; `None` where it was measured.
    pub kind: Option<Kind>,
    /// Parameters of the chip's rules for a relaxing wall; `None` if the wall does not relax.
    pub in_time: Option<InTime>,
    /// The series that the chip computes with; `None` if the wall does not relax.
    pub chip_series: Option<ChipSeries>,
    /// The membrane against the solid of the same wall; `None` where the model is a solid, or there is none.
    pub membrane_error: Option<OwnError>,
    /// Band for an unknown object; `None` if the curve is of data, the object is a punch, or a ball has no press.
    pub band: Option<Band>,
    /// Largest error of the feedback force on finer meshes, percent of reading; `None` where there is none, or the curve is of data.
    pub feedback_mesh_percent: Option<f64>,
}

/// Reads a design file and makes its tables. Build scripts call this.
///
/// # Errors
/// [`GenerateError`]; nothing is written anywhere.
pub fn from_design_file(path: &Path) -> Result<Generated, GenerateError> {
    from_design(DesignFile::read(path).map_err(GenerateError::File)?)
}

/// Solves a design with the full model and makes its tables.
///
/// # Errors
/// [`GenerateError`].
pub fn from_design(design: DesignFile) -> Result<Generated, GenerateError> {
    make(design, 0)
}

/// The same. If no tables meet the accuracy, they are those of the nearest reachable one: the required accuracy, doubled as often
/// as necessary. [`Generated::shortfall`] states the accuracy that was not reached.
///
/// # Errors
/// [`GenerateError`].
pub fn from_design_or_worse(design: DesignFile) -> Result<Generated, GenerateError> {
    make(design, MAX_DOUBLINGS)
}

fn make(design: DesignFile, doublings: u32) -> Result<Generated, GenerateError> {
    let missing = |section| GenerateError::MissingSection { section };
    haptic::is_tabled(&design)?;
    is_convolved(&design)?;
    let accuracy = design.accuracy.ok_or(missing("accuracy"))?;
    // A punch is no ball: its tables are of itself alone.
    let blends = design
        .object
        .is_some_and(|object| !matches!(object.shape, ShapeSection::Punch { .. }));
    let touching = if blends { plate_of(&design) } else { design.clone() };
    let Solved {
        transducer,
        rest_pressure,
        curve,
        end,
        fingertip,
        feedback,
        compliance,
    } = solve(&touching)?;
    let alone = compliance.map_or_else(|| touching.clone(), |compliance| touching.alone(compliance));
    let objects = match &fingertip {
        _ if !blends => None,
        None => return Err(GenerateError::Objects(NoObjects::Data)),
        Some(fingertip) => Some(SolvedObjects::solve(&design, fingertip, &curve, end)?),
    };
    let in_time = match &design.relaxation {
        None => None,
        Some(relaxation) => Some(in_time::fitted(&design, &touching, relaxation, end)?),
    };
    let period = 1e-6 * f64::from(kind(transducer.kind).period());
    let whole = design.relaxation.as_ref();
    let chip_series = whole.map(|whole| ChipSeries::fewest(whole, period, &accuracy));
    let is_unknown = design.object.is_some_and(|object| object.unknown);
    // The presses on balls would be of the fingertip alone.
    let unknown = fingertip
        .as_ref()
        .filter(|_| compliance.is_none())
        .and_then(|tip| Unknown::solve(&design, tip, &curve, end));
    let from = accuracy.from_percent_of_full_scale / 100.0;
    let (mut model_error, mut membrane_error, mut feedback_mesh_percent) = (None, None, None);
    let kind = fingertip.as_ref().map(Fingertip::kind);
    if let Some(mut fingertip) = fingertip {
        if compliance.is_some() {
            let found = haptic::convergence(&touching, &fingertip, &curve, feedback.as_ref(), end, from);
            feedback_mesh_percent = found
                .as_ref()
                .map(|(_, percent)| *percent)
                .filter(|_| feedback.is_some());
            model_error = found.map(|(touch, _)| touch);
        } else {
            model_error = convergence(&touching, &fingertip, &curve, end, from);
        }
        if matches!(fingertip, Fingertip::Membrane(_)) {
            membrane_error = Some(OwnError::of(&mut fingertip, &alone, end.indentation, from));
        }
    }
    is_near_enough(
        model_error.as_ref(),
        membrane_error.as_ref(),
        accuracy.model_percent,
    )?;
    let beside = Beside { objects, feedback };
    let mut allowed = in_time::accuracy(accuracy, design.relaxation.as_ref());
    let mut doubled = 0;
    let mut certified = loop {
        match tables_with(&curve, end, &allowed, transducer.resolution_pa, &beside) {
            Err(NoTables::Inaccurate { .. }) if doubled < doublings => {
                allowed.force_percent_of_reading *= 2.0;
                allowed.indentation_percent_of_reading *= 2.0;
                doubled += 1;
            }
            found => break found.map_err(GenerateError::NoTables)?,
        }
    };
    if let Some(object) = &mut certified.object
        && is_unknown
    {
        let unknown = unknown
            .as_ref()
            .ok_or(GenerateError::Objects(NoObjects::Unknown))?;
        object.start = unknown.narrowest(&certified.tables, object);
    }
    let band = unknown.and_then(|unknown| unknown::band(&unknown, &certified));
    Ok(Generated {
        design,
        transducer,
        rest_pressure,
        end,
        certified,
        model_error,
        kind,
        in_time,
        chip_series,
        membrane_error,
        band,
        feedback_mesh_percent,
    })
}

/// Solves a design down to `max_indentation_mm`, as its transducer reads it.
///
/// # Errors
/// [`GenerateError`].
pub fn solve(design: &DesignFile) -> Result<Solved, GenerateError> {
    let missing = |section| GenerateError::MissingSection { section };
    let indentation = design.max_indentation_mm.ok_or(missing("press"))?;
    let transducer = design.transducer.ok_or(missing("transducer"))?;
    if design.air == AirReference::Part {
        return Err(GenerateError::SecondTransducer);
    }
    let found = if let Some(data) = &design.calibration.curve {
        let curve = measured(data, indentation * 1e-3)?;
        let rest_pressure = data.rest_pressure_kpa * 1e3;
        ReadPress {
            rest_pressure,
            end: curve.end(),
            feedback: haptic::over_data(design, rest_pressure, &curve)?,
            curve,
            fingertip: None,
            compliance: None,
        }
    } else {
        let fingertip = Fingertip::for_curve(design).map_err(GenerateError::Model)?;
        if design.disc().is_some() {
            haptic::pressed(design, &transducer, indentation, fingertip.kind())?
        } else {
            pressed(fingertip, design, &transducer, indentation)?
        }
    };
    let ReadPress {
        rest_pressure,
        curve,
        end,
        fingertip,
        feedback,
        compliance,
    } = found;
    in_range(&transducer, DesignState::Rest, rest_pressure)?;
    in_range(
        &transducer,
        DesignState::Pressed { indentation },
        rest_pressure + end.pressure_rise,
    )?;
    is_felt(&transducer, end.pressure_rise)?;
    Ok(Solved {
        transducer,
        rest_pressure,
        curve,
        end,
        fingertip,
        feedback,
        compliance,
    })
}

/// Refuses a wall that relaxes in a design that the convolution does not hold for.
fn is_convolved(design: &DesignFile) -> Result<(), GenerateError> {
    let Some(relaxation) = &design.relaxation else {
        return Ok(());
    };
    let reason = if relaxation.instantaneous() >= MAX_STIFFENED {
        "material.relaxation.g adds up to 65 535 or more, which the chip does not compute with: give less"
    } else if design.model == ModelSection::Membrane {
        "model.kind is \"membrane\": with [material.relaxation] set it to \"solid\" or \"auto\""
    } else if design.rest != RestSection::Unstretched || design.calibration.pole_stretch.is_some() {
        "[rest] is given: with [material.relaxation] a wall rests unstretched, leave it out"
    } else if design.design().compliance > 0.0 {
        "fluid.compliance_mm3_per_kpa is above 0: with [material.relaxation] the circuit is rigid, set it to 0"
    } else {
        return Ok(());
    };
    Err(GenerateError::NotConvolved(reason))
}

/// Refuses a model that is further off than `accuracy.model_percent` allows.
fn is_near_enough(
    mesh: Option<&Comparison>,
    membrane: Option<&OwnError>,
    allowed: f64,
) -> Result<(), GenerateError> {
    if let Some(found) = membrane
        && found.percent().is_some_and(|percent| percent > allowed)
    {
        let error = found.to_string();
        return Err(GenerateError::CoarseMembrane { error, allowed });
    }
    match mesh {
        Some(found) if found.percent() > allowed => {
            let error = OwnError::Compared(found.clone()).to_string();
            Err(GenerateError::CoarseMesh { error, allowed })
        }
        _ => Ok(()),
    }
}

/// Refuses a press that never leaves what the firmware takes for noise around zero.
fn is_felt(transducer: &TransducerSection, rise: f64) -> Result<(), GenerateError> {
    let (resolution, noise) = (transducer.resolution_pa, transducer.noise_pa);
    let key = if noise > resolution {
        ("noise_pa", noise)
    } else {
        ("resolution_pa", resolution)
    };
    let least = BELOW_ZERO_DEVIATIONS as f64 * key.1;
    if rise > least {
        return Ok(());
    }
    Err(GenerateError::Unfelt { rise, least, key })
}

/// Solves the design again on a finer mesh at some indentations.
fn convergence(
    design: &DesignFile,
    fingertip: &Fingertip,
    curve: &Curve,
    end: Contact,
    from: f64,
) -> Option<Comparison> {
    let (mut press, better) = fingertip.finer(design).ok()?;
    let checked = match fingertip {
        Fingertip::Membrane(_) => CHECKED,
        Fingertip::Solid(_) => CHECKED_SOLID,
    };
    let gain = design.calibration.pressure_gain;
    let mut found = Comparison {
        better,
        states: 0,
        lightest: f64::INFINITY,
        force_percent: 0.0,
        indentation_percent: 0.0,
    };
    let pairs: Vec<&[Contact]> = curve
        .points()
        .windows(2)
        .filter(|pair| pair[1].indentation >= from * end.indentation)
        .collect();
    for pair in pairs.iter().step_by(pairs.len().div_ceil(checked).max(1)) {
        let indentation = libm::sqrt(pair[0].indentation * pair[1].indentation);
        let state = press.contact_at(indentation).ok()?;
        let read = curve.at_pressure_rise(gain * state.pressure_rise);
        let share = |got: f64, truth: f64, full: f64| 100.0 * (got - truth).abs() / truth.max(from * full);
        let force = share(read.force, state.force, end.force);
        let indentation = share(read.indentation, indentation, end.indentation);
        found.states += 1;
        found.lightest = found.lightest.min(state.indentation);
        found.force_percent = found.force_percent.max(force);
        found.indentation_percent = found.indentation_percent.max(indentation);
    }
    Some(found)
}

fn in_range(transducer: &TransducerSection, state: DesignState, pascals: f64) -> Result<(), GenerateError> {
    let pressure = pascals * 1e-3;
    let range = transducer.gauge_range_kpa();
    if pressure >= range[0] && pressure <= range[1] {
        return Ok(());
    }
    Err(GenerateError::OutOfRange {
        state,
        pressure,
        range,
        absolute: transducer.range_is_absolute().then_some(transducer.range_kpa),
    })
}

impl Generated {
    /// The error of the model itself: of a membrane against the solid, of a solid against a finer mesh; nothing where the curve is of
    /// data.
    pub fn own_error(&self) -> Option<OwnError> {
        let mesh = || self.model_error.clone().map(OwnError::Compared);
        self.membrane_error.clone().or_else(mesh)
    }

    /// First eight bytes of the design's hash, big-endian: [`crate::constants::DesignConstants::hash`].
    pub fn hash(&self) -> u64 {
        let [a, b, c, d, e, f, g, h, ..] = self.design.hash();
        u64::from_be_bytes([a, b, c, d, e, f, g, h])
    }

    /// First eight bytes of the SHA-256 of the certificate, big-endian: [`crate::constants::DesignConstants::certificate`].
    pub fn certificate_hash(&self) -> u64 {
        let [a, b, c, d, e, f, g, h, ..]: [u8; 32] = Sha256::digest(self.certificate()).into();
        u64::from_be_bytes([a, b, c, d, e, f, g, h])
    }

    /// The transducer as the firmware knows it.
    pub fn transducer(&self) -> Transducer {
        let section = &self.transducer;
        Transducer {
            range: section
                .own_range_kpa()
                .map(|kilopascals| integer(kilopascals * 1e3)),
            resolution: integer(section.resolution_pa * 1e3),
            noise: integer(section.noise_pa * 1e3),
            quantity: section.quantity,
            kind: kind(section.kind),
        }
    }
}

/// The nearest integer; a float to integer cast saturates.
pub(super) fn integer(value: f64) -> i32 {
    libm::round(value) as i32
}

fn kind(section: TransducerKindSection) -> TransducerKind {
    const COUNTS: f64 = 16_777_216.0;
    match section {
        TransducerKindSection::Ratiometric {
            output_fraction_at_range,
            supply,
            source,
        } => TransducerKind::Ratiometric {
            output: output_fraction_at_range
                .map(|fraction| libm::round(source.at_converter(fraction) * 65536.0) as u32),
            supply_measured: supply == Supply::Measured,
        },
        TransducerKindSection::Abp2 { address, transfer } => TransducerKind::Abp2 {
            address,
            counts: match transfer {
                Transfer::A => [0.1, 0.9],
                Transfer::B => [0.3, 0.7],
            }
            .map(|fraction| libm::round(fraction * COUNTS) as u32),
        },
        TransducerKindSection::Ms5837 => TransducerKind::Ms5837 { address: 0x76 },
        TransducerKindSection::Dps310 { address } => TransducerKind::Dps310 { address },
    }
}

#[cfg(test)]
mod tests;
