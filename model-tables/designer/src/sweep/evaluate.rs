//! One design of a sweep: its row, or how far it came and the line that refuses the rest.

use super::columns::{CURVE, Datum, REST, TABLES};
use super::space::Space;
use super::vary::{number, plain};
use model_tables::design_file::DesignFile;
use model_tables::generate::{Generated, from_design, from_design_or_worse};
use model_tables::membrane::state::Wrinkling;
use model_tables::model::{Fingertip, ModelError};

/// Where a design was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// As a design file is read.
    Design,
    Rest,
    Curve,
    Tables,
}

impl Stage {
    const fn word(self) -> &'static str {
        match self {
            Self::Design => "design",
            Self::Rest => "rest",
            Self::Curve => "curve",
            Self::Tables => "tables",
        }
    }
}

type Refused = (Stage, String);

/// The row of design `number`, a value a column, and the line that refused it.
pub(super) fn row(space: &Space, design_number: u64) -> (Vec<Datum>, Option<String>) {
    let values = space.values(design_number);
    let mut row = vec![Datum::Integer(design_number as i64)];
    row.extend(
        space
            .variables
            .iter()
            .zip(&values)
            .map(|(variable, value)| match number(value) {
                Some(number) if variable.is_numeric() => Datum::Number(number),
                _ => Datum::Text(value.as_str().map_or_else(|| plain(value), str::to_owned)),
            }),
    );
    let mut outputs = Outputs::default();
    let refused = solve(space, &space.design(&values), &mut outputs).err();
    let (stage, reason) = match &refused {
        None => (Datum::Missing, Datum::Missing),
        Some((stage, reason)) => (Datum::Text(stage.word().to_owned()), Datum::Text(reason.clone())),
    };
    row.push(stage);
    row.push(reason);
    let computed = space.computed;
    for (asked, found, columns) in [
        (computed.rest, outputs.rest, REST.len()),
        (computed.curve, outputs.curve, CURVE.len()),
        (computed.tables, outputs.tables, TABLES.len()),
    ] {
        if asked {
            row.extend(found.unwrap_or_else(|| vec![Datum::Missing; columns]));
        }
    }
    (row, refused.map(|(_, reason)| reason))
}

/// What a design came to.
#[derive(Default)]
struct Outputs {
    rest: Option<Vec<Datum>>,
    curve: Option<Vec<Datum>>,
    tables: Option<Vec<Datum>>,
}

fn solve(space: &Space, text: &str, outputs: &mut Outputs) -> Result<(), Refused> {
    let design = DesignFile::parse(text, "").map_err(|error| (Stage::Design, error.problem.to_string()))?;
    let computed = space.computed;
    if computed.rest || computed.curve {
        // The mesh for curves: of a membrane what `rest` and `solve` give to 1e-8, in half the time.
        let mut tip = Fingertip::for_curve(&design).map_err(|error| (Stage::Rest, error.to_string()))?;
        // The curve first: it goes from shallow to deep, and the limit is at its far side.
        let curve = computed.curve.then(|| curve(space, &design, &mut tip));
        if computed.rest {
            outputs.rest = Some(rest(&design, &mut tip)?);
        }
        outputs.curve = curve.transpose()?;
    }
    if computed.tables {
        outputs.tables = Some(tables(space, design)?);
    }
    Ok(())
}

fn rest(design: &DesignFile, tip: &mut Fingertip) -> Result<Vec<Datum>, Refused> {
    let calibration = &design.calibration;
    let limit = tip.limit().map_err(|error| (Stage::Rest, error.to_string()))?;
    let rest = tip.rest();
    Ok(vec![
        Datum::Text(tip.kind().to_string()),
        Datum::Number(calibration.pressure_read(rest.pressure) * 1e-3),
        Datum::Number(rest.pole_stretch),
        Datum::Number(rest.edge_radius * 1e3),
        Datum::Number(rest.height * 1e3),
        Datum::Number(rest.volume * 1e9),
        Datum::Number(calibration.indentation_read(limit.indentation) * 1e3),
        Datum::Text(limit.ends_by.word().to_owned()),
    ])
}

fn curve(space: &Space, design: &DesignFile, tip: &mut Fingertip) -> Result<Vec<Datum>, Refused> {
    let refuse = |error: ModelError| {
        let read = error.read_by(|metres| design.calibration.indentation_read(metres));
        (Stage::Curve, read.to_string())
    };
    let calibration = &design.calibration;
    let Some(deepest) = design.max_indentation_mm else {
        let reason = "`[press]` is missing: needs max_indentation_mm, the depth of the curve";
        return Err((Stage::Curve, reason.to_owned()));
    };
    let states = space.curve_states;
    let mut lists: [Vec<f64>; 5] = Default::default();
    let mut worst: Option<Wrinkling> = None;
    for state in 1..=states {
        let asked = if state == states {
            deepest
        } else {
            deepest * state as f64 / states as f64
        };
        let depth = calibration.indentation_of(asked / 1e3).max(0.0);
        let state = tip.at_indentation(depth).map_err(refuse)?;
        worst = worst.max(state.wrinkling);
        lists[0].push(asked);
        lists[1].push(calibration.pressure_read(state.pressure_rise) * 1e-3);
        lists[2].push(state.force);
        lists[3].push(state.contact_radius * 1e3);
        lists[4].extend(state.least_tension);
    }
    let is_membrane = worst.is_some();
    let mut columns: Vec<Datum> = lists.into_iter().map(Datum::Numbers).collect();
    if !is_membrane {
        // A wall may push, and has no tension field.
        columns[4] = Datum::Missing;
    }
    columns.push(worst.map_or(Datum::Missing, |worst| Datum::Text(worst.word().to_owned())));
    Ok(columns)
}

fn tables(space: &Space, design: DesignFile) -> Result<Vec<Datum>, Refused> {
    let refuse = |reason: String| (Stage::Tables, reason);
    let made = if space.allow_worse {
        from_design_or_worse(design)
    } else {
        from_design(design)
    };
    let generated: Generated = made.map_err(|error| refuse(error.to_string()))?;
    if let Some(shortfall) = generated.shortfall().filter(|_| !space.allow_worse) {
        return Err(refuse(format!(
            "{shortfall}; or take these with allow_worse = true"
        )));
    }
    let certificate = &generated.certified.certificate;
    let own_error = generated.own_error().and_then(|error| error.percent());
    Ok(vec![
        Datum::Number(generated.end.pressure_rise * 1e-3),
        Datum::Number(generated.end.force),
        Datum::Integer(certificate.inputs as i64),
        Datum::Integer(generated.certified.tables.bytes() as i64),
        Datum::Number(certificate.force.of_reading.max),
        Datum::Number(certificate.indentation.of_reading.max),
        own_error.map_or(Datum::Missing, Datum::Number),
        Datum::Bytes(generated.binary()),
    ])
}
