//! `designer estimate --history`: what the chip's stages say of a pressure over time, bit for bit.

use super::estimate::generated;
use super::read;
use super::time_rows::{self, TimeRow};
use fingertip::signal::contact::contact;
use fingertip::signal::design::{Design, LoadedDesign};
use fingertip::signal::relaxation::{Factor, RelaxedReading, Relaxing, SeriesStep, TermStep};
use fingertip::status::{Status, Warnings};
use model_tables::design_file::{DesignFile, ModelSection, RestSection};
use model_tables::material::relaxation::{MAX_TERMS, Relaxation};
use model_tables::units::PressureRise;
use output::rows::{Cell, Rows};
use output::{CommandAnswer, Refusal};
use std::path::Path;

const COLUMNS: &[&str] = &[
    "time_s",
    "pressure_rise_pa",
    "elastic_pressure_pa",
    "force_n",
    "indentation_mm",
    "status",
];
const KILOPASCALS: &str = "pressure_rise_kpa";
const PASCALS: &str = "pressure_rise_pa";

/// The nearest factor that the chip multiplies with; one too small for its word is 0.
fn factor(value: f64) -> Factor {
    let (mantissa, exponent) = libm::frexp(value);
    let scaled = libm::round(libm::ldexp(mantissa, 32));
    // Rounded up to the next power of two.
    let (scaled, exponent) = if scaled < 4_294_967_296.0 {
        (scaled, exponent)
    } else {
        (2_147_483_648.0, exponent + 1)
    };
    match u32::try_from(32 - exponent) {
        Ok(shift @ 0..=95) if value > 0.0 => Factor {
            mantissa: scaled as u32,
            shift,
        },
        _ => Factor::default(),
    }
}

/// A series over a step of time in seconds; terms that it has not take nothing.
fn series_step(relaxation: &Relaxation, seconds: f64) -> SeriesStep<MAX_TERMS> {
    let mut terms = [TermStep::default(); MAX_TERMS];
    let empty = MAX_TERMS - relaxation.terms().len();
    let mut sum = 1.0;
    for (step, term) in terms[empty..].iter_mut().zip(relaxation.terms()) {
        let decay = term.over(seconds);
        *step = TermStep {
            lost: factor(-libm::expm1(-seconds / term.time)),
            taken: factor(decay.taken),
        };
        sum += decay.taken;
    }
    SeriesStep {
        terms,
        inverse: factor(1.0 / sum),
    }
}

/// A wall that relaxes has to be of the kind that the convolution holds for.
fn check(file: &Path, design: &DesignFile) -> Result<(), Refusal> {
    let reason = if design.model == ModelSection::Membrane {
        "model.kind is \"membrane\": with [material.relaxation] set it to \"solid\" or \"auto\""
    } else if design.rest != RestSection::Unstretched || design.calibration.pole_stretch.is_some() {
        "[rest] is given: with [material.relaxation] a wall rests unstretched, leave it out"
    } else if design.design().compliance > 0.0 {
        "fluid.compliance_mm3_per_kpa is above 0: with [material.relaxation] the circuit is rigid, set it to 0"
    } else {
        return Ok(());
    };
    Err(Refusal::about(file, &reason))
}

pub(super) fn run(file: &Path, history: &Path, allow_worse: bool) -> Result<CommandAnswer, Refusal> {
    let design_file = read(file)?;
    let relaxation = design_file.relaxation;
    if relaxation.is_some() {
        check(file, &design_file)?;
    }
    let read = time_rows::read(history, &[KILOPASCALS, PASCALS])?;
    let unit = if read.column == KILOPASCALS { 1e3 } else { 1.0 };
    let generated = generated(file, design_file, allow_worse)?;
    let block = generated.binary();
    let (design, _) = LoadedDesign::read(&block).map_err(|error| Refusal::about(file, &error))?;
    let bits = design.parameters().pressure_fraction_bits;
    let mut wall = relaxation.map(|series| Wall::new(series, f64::from(design.parameters().period) * 1e-6));
    let mut rows = Rows::new(COLUMNS);
    let mut before: Option<TimeRow> = None;
    for row in &read.rows {
        let pascals = unit * row.value;
        let rise = PressureRise::from_pascals(pascals, bits);
        let reading = if let Some(wall) = &mut wall {
            wall.to(&design, before.as_ref(), row, unit)
        } else {
            let still = contact(&design, rise, Warnings::NONE);
            RelaxedReading {
                elastic: rise,
                force: still.force,
                indentation: still.indentation,
                warnings: still.warnings,
            }
        };
        before = Some(*row);
        rows.push(vec![
            Cell::Number(row.time),
            Cell::Number(pascals),
            Cell::Number(reading.elastic.pascals(bits)),
            Cell::Number(reading.force.newtons()),
            Cell::Number(reading.indentation.metres() * 1e3),
            Cell::Text(Status::qualified(reading.warnings).to_string()),
        ]);
    }
    Ok(CommandAnswer {
        rows,
        notes: Vec::new(),
    })
}

/// The wall's state on the chip, and the steps of its time.
struct Wall {
    series: Relaxation,
    period: f64,
    state: Relaxing<MAX_TERMS>,
    /// A whole period at the temperature of the latest step.
    whole: SeriesStep<MAX_TERMS>,
    temperature: f64,
}

impl Wall {
    fn new(series: Relaxation, period: f64) -> Self {
        Self {
            whole: series_step(&series, period),
            temperature: series.temperature,
            series,
            period,
            state: Relaxing::default(),
        }
    }

    /// A step of so many seconds at a temperature.
    fn step(&mut self, seconds: f64, temperature: f64) -> SeriesStep<MAX_TERMS> {
        let moved = (temperature - self.temperature).abs() > 0.0;
        if moved {
            self.whole = series_step(&self.series.at(temperature), self.period);
            self.temperature = temperature;
        }
        if seconds < self.period {
            series_step(&self.series.at(temperature), seconds)
        } else {
            self.whole
        }
    }

    /// From a row to the next: whole periods, and a last shorter step that ends on its time. The first row is reached in no time.
    fn to(
        &mut self,
        design: &impl Design,
        before: Option<&TimeRow>,
        row: &TimeRow,
        unit: f64,
    ) -> RelaxedReading {
        let bits = design.parameters().pressure_fraction_bits;
        let own = self.series.temperature;
        let from = before.unwrap_or(row);
        let span = row.time - from.time;
        let temperatures = [from, row].map(|row| row.temperature.unwrap_or(own));
        // A whole number of periods but for rounding is one.
        let whole = libm::floor(span / self.period + 1e-9);
        let steps = whole as u64 + u64::from(span - whole * self.period > 1e-9 * self.period || whole < 1.0);
        let mut reading = RelaxedReading::default();
        for i in 1..=steps {
            let (seconds, part) = if i < steps {
                (self.period, i as f64 * self.period / span)
            } else {
                (span - (steps - 1) as f64 * self.period, 1.0)
            };
            let seconds = if (seconds - self.period).abs() <= 2e-9 * self.period {
                self.period
            } else {
                seconds
            };
            let temperature = temperatures[0] + part * (temperatures[1] - temperatures[0]);
            let pascals = unit * (from.value + part * (row.value - from.value));
            let step = self.step(seconds, temperature);
            reading = self
                .state
                .step(design, &step, PressureRise::from_pascals(pascals, bits));
        }
        reading
    }
}
