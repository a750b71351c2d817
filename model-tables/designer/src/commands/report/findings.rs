//! What a report is made of: the design solved, in SI units.

use super::super::estimate::refusal;
use super::super::model::{self, Model};
use super::super::{bench, read};
use super::cost::{self, Cost};
use super::in_time::{self, TimedPress};
use super::tips::Tips;
use crate::size::question::catalogue::TOUCH_FLOORS;
use model_tables::actuator::{Actuator, Blocked};
use model_tables::constants::Quantity;
use model_tables::design::{Design, RestBy};
use model_tables::design_file::{Axes, Calibration, DesignFile};
use model_tables::generate::{Generated, from_design};
use model_tables::limit::Limit;
use model_tables::membrane::TensionField;
use model_tables::membrane::press::Press;
use model_tables::membrane::rest::Branch;
use model_tables::membrane::state::Wrinkling;
use model_tables::model::ModelError;
use model_tables::model::choice::FINE;
use model_tables::model::state::{MeridianStation, Pressed, RestState};
use model_tables::model::{Fingertip, Kind};
use model_tables::object::Shape;
use model_tables::table::ContactLookup as _;
use model_tables::units::PressureRise;
use output::Refusal;
use output::progress::Progress;
use std::path::Path;

/// States of the curves; with an actuator, whose loop is solved for each.
const STATES: usize = 48;
const STATES_OF_LOOP: usize = 24;
/// Indentations of the shapes, over the deepest.
const SHAPES: [f64; 4] = [0.0, 0.2, 0.6, 1.0];
/// Points of a meridian.
const POINTS: usize = 121;
/// How deep a design is pressed that does not say, over the limit.
const DEPTH: f64 = 0.9;
/// Indentations at which membrane and solid are compared, over the deepest.
const BENDING: [f64; 3] = [0.1, 0.4, 1.0];

/// Everything a report says.
pub(super) struct Findings {
    pub(super) file: DesignFile,
    pub(super) model: Kind,
    /// How `auto` came to it.
    pub(super) note: Option<String>,
    pub(super) rest: RestState,
    pub(super) limit: Limit,
    /// Whether fingertip and actuator share the fluid in these states.
    pub(super) has_actuator: bool,
    /// How deep it is pressed here, metres.
    pub(super) deepest: f64,
    /// States from first touch to the deepest.
    pub(super) states: Vec<Pressed>,
    pub(super) meridians: Vec<Meridian>,
    /// The tables, or the section that they would need.
    pub(super) tables: Result<Generated, &'static str>,
    /// What the tables say of the states.
    pub(super) table_readings: Vec<TableReading>,
    /// Presses at several speeds, where the wall relaxes.
    pub(super) in_time: Vec<TimedPress>,
    pub(super) costs: Vec<Cost>,
    /// The same wall as a solid, where the model is a membrane.
    pub(super) bending: Vec<Bending>,
    /// The actuator over its pressure.
    pub(super) actuator: Vec<(f64, Blocked)>,
    /// The design with the semi-axes that the model takes.
    pub(super) design: Design,
    /// The least that the tip tells; `None` where there are no tables.
    pub(super) least: Option<Least>,
    /// What a reader has to know, a line each.
    pub(super) warnings: Vec<String>,
}

/// The meridian of a state.
pub(super) struct Meridian {
    pub(super) indentation: f64,
    pub(super) force: f64,
    /// Thickness of the undeformed wall, metres.
    pub(super) wall: f64,
    pub(super) points: Vec<MeridianStation>,
}

/// What the tables say of a state.
pub(super) struct TableReading {
    pub(super) pressure_rise: f64,
    pub(super) force: f64,
    pub(super) indentation: f64,
    /// Errors of force and indentation against the model, percent of reading; `None` of tables from data.
    pub(super) errors: Option<[f64; 2]>,
}

/// The least that a tip tells, as the chip reads its tables.
pub(super) struct Least {
    /// The force at six noise floors of the transducer, where a touch begins, newtons.
    pub(super) touch: f64,
    /// One step of the transducer there, newtons.
    pub(super) step: f64,
    /// An hour of weather there, newtons; `None` of a gauge part.
    pub(super) weather: Option<f64>,
    /// Readings a second.
    pub(super) rate: f64,
}

/// Membrane and solid at one indentation.
pub(super) struct Bending {
    pub(super) indentation: f64,
    pub(super) membrane: f64,
    pub(super) solid: f64,
}

/// Solves everything.
pub(super) fn gather(path: &Path, progress: &Progress) -> Result<Findings, Refusal> {
    let file = read(path)?;
    let refuse = |error: ModelError| Refusal::about(path, &bench::as_read(&file.calibration, error));
    let Model { kind, design, note } = model::of(path, &file)?;
    progress.set(0.1);
    let mut tip = match kind {
        Kind::Membrane => Fingertip::Membrane(Box::new(
            Press::new(&design, TensionField::Relaxed).map_err(|error| refuse(error.into()))?,
        )),
        Kind::Solid(_) => Fingertip::of(kind, &design).map_err(refuse)?,
    };
    let limit = tip.limit().map_err(refuse)?;
    let end = DEPTH * limit.indentation;
    let deepest = match design.object.shape {
        // A press into a cup ends earlier than that onto the plate, whose tables go so deep.
        Shape::Cup { .. } => file.max_indentation_mm.map_or(end, |depth| end.min(depth / 1e3)),
        _ => file.max_indentation_mm.map_or(end, |depth| depth / 1e3),
    };
    progress.set(0.2);
    let mut tips = Tips::of(&file, kind, &design, tip, deepest);
    let count = if tips.haptic.is_some() {
        STATES_OF_LOOP
    } else {
        STATES
    };
    let states = (0..=count)
        .map(|k| {
            let part = k as f64 / count as f64;
            let depth = deepest * part * libm::sqrt(part);
            tips.at(depth)?.at_indentation(depth)
        })
        .collect::<Result<Vec<_>, _>>()
        .map_err(refuse)?;
    let meridians = SHAPES
        .iter()
        .map(|part| {
            let depth = part * deepest;
            meridian(tips.at(depth)?, &design, depth)
        })
        .collect::<Result<Vec<_>, _>>()
        .map_err(refuse)?;
    // The deepest was the last: an actuator is from here on the compliance that it has there.
    let has_actuator = tips.haptic.is_some();
    let (mut tip, compliance) = (tips.tip, tips.compliance);
    let limit = if has_actuator {
        tip.limit().map_err(refuse)?
    } else {
        limit
    };
    let pressed = Design { compliance, ..design };
    progress.set(0.4);
    let tables = tables(&file).map_err(|error| refusal(path, error))?;
    progress.set(0.6);
    let table_readings = tables.as_ref().map_or_else(
        |_| Vec::new(),
        |generated| table_readings(generated, &file, &states),
    );
    let in_time = tables
        .as_ref()
        .map_or_else(|_| Vec::new(), |generated| in_time::presses(&file, generated));
    let costs = cost::costs(&file, kind, &pressed, deepest);
    progress.set(0.9);
    let bending = if kind == Kind::Membrane {
        let outer = Design {
            compliance,
            ..file.design_to(Axes::Outer)
        };
        bending(&outer, &mut tip, deepest)
    } else {
        Vec::new()
    };
    let mut warnings = warnings(&file, &mut tip, limit, deepest);
    warnings.extend(bench::caution(&file));
    Ok(Findings {
        least: tables.as_ref().ok().map(least),
        actuator: actuator(&file, &design),
        design,
        rest: tip.rest(),
        model: kind,
        note,
        limit,
        has_actuator,
        deepest,
        states,
        meridians,
        tables,
        table_readings,
        in_time,
        costs,
        bending,
        warnings,
        file,
    })
}

fn meridian(tip: &mut Fingertip, design: &Design, indentation: f64) -> Result<Meridian, ModelError> {
    Ok(Meridian {
        indentation,
        force: tip.contact_at(indentation)?.force,
        wall: design.membrane.thickness,
        points: tip.profile(indentation, POINTS)?,
    })
}

/// The tables of a design that has everything they need; otherwise the first section that is missing.
fn tables(
    file: &DesignFile,
) -> Result<Result<Generated, &'static str>, model_tables::generate::GenerateError> {
    let missing = [
        (file.max_indentation_mm.is_none(), "press"),
        (file.transducer.is_none(), "transducer"),
        (file.accuracy.is_none(), "accuracy"),
    ]
    .into_iter()
    .find_map(|(missing, section)| missing.then_some(section));
    match missing {
        Some(section) => Ok(Err(section)),
        None => Ok(Ok(from_design(file.clone())?)),
    }
}

/// Pascals by which an hour of weather moves the zero of an absolute part.
const WEATHER: f64 = 100.0;

fn least(generated: &Generated) -> Least {
    let transducer = &generated.transducer;
    let tables = &generated.certified.tables;
    let bits = tables.layout.fraction_bits;
    let force_at = |pascals: f64| {
        tables
            .contact_at(PressureRise::from_pascals(pascals, bits))
            .force
            .newtons()
    };
    let touch = TOUCH_FLOORS * transducer.noise_pa.max(transducer.resolution_pa);
    // The slope over a half of it on either side, so that the steps of the tables do not count.
    let slope = (force_at(1.5 * touch) - force_at(0.5 * touch)) / touch;
    Least {
        touch: force_at(touch),
        step: slope * transducer.resolution_pa,
        weather: (transducer.quantity == Quantity::Absolute).then_some(slope * WEATHER),
        rate: 1e6 / f64::from(generated.transducer().kind.period()),
    }
}

fn table_readings(generated: &Generated, file: &DesignFile, states: &[Pressed]) -> Vec<TableReading> {
    let plate = &generated.certified.tables;
    // The chip begins with what the design states.
    let blended = generated
        .certified
        .object
        .as_ref()
        .and_then(|object| object.blended(plate, object.start));
    let tables = blended.as_ref().unwrap_or(plate);
    let bits = tables.layout.fraction_bits;
    let from = file
        .accuracy
        .map_or(0.0, |accuracy| accuracy.from_percent_of_full_scale / 100.0);
    let error = |found: f64, truth: f64, full: f64| 100.0 * (found - truth) / truth.max(from * full);
    let deepest = states.last().map_or(0.0, |state| state.indentation);
    states
        .iter()
        .filter(|state| state.indentation > 0.0 || file.calibration.curve.is_some())
        .map(|state| {
            // The transducer's own zero takes its offset away.
            let pressure_rise = match &file.calibration.curve {
                None => file.calibration.pressure_gain * state.pressure_rise,
                // Over the rises of the data, which need not be the model's.
                Some(_) => generated.end.pressure_rise * state.indentation / deepest,
            };
            let reading = tables.contact_at(PressureRise::from_pascals(pressure_rise, bits));
            let (force, indentation) = (reading.force.newtons(), reading.indentation.metres());
            TableReading {
                pressure_rise,
                force,
                indentation,
                errors: file.calibration.curve.is_none().then(|| {
                    [
                        error(force, state.force, generated.end.force),
                        error(indentation, state.indentation, generated.end.indentation),
                    ]
                }),
            }
        })
        .collect()
}

/// Forces of the membrane and of a solid of the same wall; nothing where the solid has no such rest state.
fn bending(outer: &Design, membrane: &mut Fingertip, deepest: f64) -> Vec<Bending> {
    if !matches!(outer.rest, RestBy::PoleStretch(_)) {
        return Vec::new();
    }
    let Ok(mut solid) = Fingertip::of(Kind::Solid(FINE), outer) else {
        return Vec::new();
    };
    let mut both = |part: f64| -> Result<Bending, ModelError> {
        let indentation = part * deepest;
        Ok(Bending {
            indentation,
            membrane: membrane.contact_at(indentation)?.force,
            solid: solid.contact_at(indentation)?.force,
        })
    };
    BENDING.into_iter().map_while(|part| both(part).ok()).collect()
}

/// The feedback membrane over the pressures that it meets, where the design has one.
fn actuator(file: &DesignFile, design: &Design) -> Vec<(f64, Blocked)> {
    const PARTS: usize = 24;
    let Some(section) = file.actuator else {
        return Vec::new();
    };
    let actuator = Actuator::new(
        section.diameter_mm / 1e3,
        section
            .thickness_mm
            .map_or(design.membrane.thickness, |mm| mm / 1e3),
        &file.actuator_law(),
    );
    let largest = 0.25 * actuator.youngs_modulus;
    let largest = file.transducer.map_or(largest, |transducer| {
        largest.min(1e3 * transducer.gauge_range_kpa()[1])
    });
    (0..=PARTS)
        .filter_map(|k| {
            let pressure = largest * k as f64 / PARTS as f64;
            Some((pressure, actuator.at_pressure(pressure).ok()?))
        })
        .collect()
}

fn warnings(file: &DesignFile, tip: &mut Fingertip, limit: Limit, deepest: f64) -> Vec<String> {
    let mut lines = Vec::new();
    if let Fingertip::Membrane(press) = tip {
        match press.branch() {
            Branch::Only => {}
            Branch::Lower { other } => lines.push(format!(
                "Two rest states: this is the less stretched, the other has a pole stretch of {other:.4} mm/mm."
            )),
            Branch::Upper { other } => lines.push(format!(
                "Two rest states: this is the more stretched, the other has a pole stretch of {other:.4} mm/mm."
            )),
        }
        for (which, margin) in [
            ("At rest", press.rest_stability()),
            ("Pressed deepest", press.stability()),
        ] {
            if !margin.is_stable() {
                lines.push(format!(
                    "{which} the law is not stable at stretches of {:.4} mm/mm along and {:.4} mm/mm around ({}): the state is at \
                     best one of several.",
                    margin.meridional_stretch, margin.hoop_stretch, margin.mode
                ));
            }
        }
        let worst = [0.02, 0.1, 0.3, 0.6, 1.0]
            .iter()
            .filter_map(|part| press.at_indentation(part * deepest).ok())
            .map(|state| state.shape.wrinkling)
            .max();
        match worst {
            Some(Wrinkling::Wrinkled) => lines.push(
                "Somewhere in the press the membrane wrinkles around: it is relaxed there, as a membrane cannot push."
                    .to_owned(),
            ),
            Some(Wrinkling::Slack) => lines.push(
                "Somewhere in the press the membrane is slack under the plate: it is relaxed there, as a membrane cannot push."
                    .to_owned(),
            ),
            _ => {}
        }
    }
    lines.extend(bench::beyond_strain(file, tip, deepest));
    let share = deepest / limit.indentation;
    if share > 0.9 && file.max_indentation_mm.is_some() {
        lines.push(format!(
            "The press goes to {:.1} % of its limit, where the model ends ({}).",
            100.0 * share,
            limit.ends_by.word()
        ));
    }
    if file.calibration == Calibration::default() {
        lines.push(
            "Not calibrated: every number is the model's at the stated inputs. Printed and cast parts differ from them; calibrate \
             with designer fit before you trust a force."
                .to_owned(),
        );
    }
    if file.calibration.curve.is_some() {
        lines.push(
            "The tables come from the data in [calibration]; curves, shapes and tensions are the model's and may differ."
                .to_owned(),
        );
    }
    let left_out = if file.relaxation.is_some() {
        "Settled and without friction, but for what is named in time: temperature, hysteresis and creep beyond the series of the material \
         are not in these numbers. Research software, not a medical device."
    } else {
        "Static and without friction: rate, temperature, hysteresis and creep of the material are not in these numbers. Research \
         software, not a medical device."
    };
    lines.push(left_out.to_owned());
    lines
}
