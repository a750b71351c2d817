//! `designer estimate --history`: what the chip's stages say of a pressure over time, bit for bit.

use super::estimate::generated;
use super::read;
use super::time_rows::{self, TimeRow};
use fingertip::signal::contact::contact;
use fingertip::signal::design::Design;
use fingertip::signal::loaded_design::LoadedDesign;
use fingertip::signal::relaxation::{RelaxedReading, Relaxing};
use fingertip::status::{Status, Warnings};
use model_tables::material::relaxation::{MAX_TERMS, Relaxation};
use model_tables::material::series::{SeriesStep, WallSeries};
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
/// Of a design whose actuator presses.
const WITH_FEEDBACK: &[&str] = &[
    "time_s",
    "pressure_rise_pa",
    "elastic_pressure_pa",
    "force_n",
    "indentation_mm",
    "status",
    "feedback_force_n",
];
const KILOPASCALS: &str = "pressure_rise_kpa";
const PASCALS: &str = "pressure_rise_pa";

pub(super) fn run(file: &Path, history: &Path, allow_worse: bool) -> Result<CommandAnswer, Refusal> {
    let design_file = read(file)?;
    let read = time_rows::read(history, &[KILOPASCALS, PASCALS])?;
    let unit = if read.column == KILOPASCALS { 1e3 } else { 1.0 };
    let generated = generated(file, design_file, allow_worse)?;
    let relaxation = generated.chip_series.map(|chip| chip.series);
    let block = generated.binary();
    let (design, _) = LoadedDesign::read(&block).map_err(|error| Refusal::about(file, &error))?;
    let bits = design.parameters().pressure_fraction_bits;
    let period = f64::from(design.parameters().period) * 1e-6;
    if relaxation.is_some() {
        check_span(history, &read.rows, period)?;
    }
    let mut wall = relaxation
        .zip(design.series())
        .map(|(series, whole)| History::new(series, *whole, period));
    let feels = design.feedback(PressureRise(0)).is_some();
    let mut rows = Rows::new(if feels { WITH_FEEDBACK } else { COLUMNS });
    let mut before: Option<TimeRow> = None;
    for row in &read.rows {
        let pascals = unit * row.value;
        let rise = PressureRise::from_pascals(pascals, bits);
        let (elastic, contact) = match &mut wall {
            Some(wall) => {
                let reading = wall.to(&design, before.as_ref(), row, unit);
                (reading.elastic, reading.contact)
            }
            None => (rise, contact(&design, rise, Warnings::NONE)),
        };
        before = Some(*row);
        let mut cells = vec![
            Cell::Number(row.time),
            Cell::Number(pascals),
            Cell::Number(elastic.pascals(bits)),
            Cell::Number(contact.force.newtons()),
            Cell::Number(contact.indentation.metres() * 1e3),
            Cell::Text(Status::qualified(contact.warnings).to_string()),
        ];
        cells.extend(design.feedback(rise).map(|force| Cell::Number(force.newtons())));
        rows.push(cells);
    }
    Ok(CommandAnswer {
        rows,
        notes: Vec::new(),
    })
}

/// Report periods that a record may take: a quarter of a minute of one core.
const MAX_PERIODS: f64 = 1e8;

/// Refuses a record whose time is more report periods than can be stepped.
fn check_span(file: &Path, rows: &[TimeRow], period: f64) -> Result<(), Refusal> {
    let span = rows.last().map_or(0.0, |last| last.time - rows[0].time);
    if span / period <= MAX_PERIODS {
        return Ok(());
    }
    Err(Refusal::about(
        file,
        &format_args!(
            "its rows span {span:e} s, {:.1e} report periods of {} ms: at most {MAX_PERIODS:e} can be stepped, {:e} s; cut the record",
            span / period,
            1e3 * period,
            MAX_PERIODS * period
        ),
    ))
}

/// The wall's state on the chip, and the steps of its time.
struct History {
    series: Relaxation,
    period: f64,
    state: Relaxing<MAX_TERMS>,
    /// A whole period at the temperature of the latest step.
    whole: WallSeries,
    temperature: f64,
}

impl History {
    /// `whole` is a period at the series' own temperature: the chip's.
    fn new(series: Relaxation, whole: WallSeries, period: f64) -> Self {
        Self {
            whole,
            temperature: series.temperature,
            series,
            period,
            state: Relaxing::NEW,
        }
    }

    /// A step of so many seconds at a temperature.
    fn step(&mut self, seconds: f64, temperature: f64) -> WallSeries {
        let moved = (temperature - self.temperature).abs() > 0.0;
        if moved {
            self.whole.step = SeriesStep::over(&self.series.at(temperature), self.period);
            self.temperature = temperature;
        }
        if seconds < self.period {
            WallSeries {
                step: SeriesStep::over(&self.series.at(temperature), seconds),
                ..self.whole
            }
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
            let wall = self.step(seconds, temperature);
            reading = self
                .state
                .step(design, &wall, PressureRise::from_pascals(pascals, bits));
        }
        reading
    }
}
