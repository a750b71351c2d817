//! `[material.relaxation]`: the relaxation series of the wall.

use super::bounds::Bounds;
use super::section::{KeyFault, Section};
use crate::material::preset::{PRESETS, Preset};
use crate::material::relaxation::{MAX_TERMS, Relaxation, Term};
use std::fmt::{self, Write};

/// Relaxation times, from a tenth of a millisecond to three hours.
const TIME: Bounds = Bounds::within(1e-4, 1e4, "s");
/// Weights: glass is ten thousand times as stiff as rubber.
const WEIGHT: Bounds = Bounds::within(0.0, 1e5, "times the relaxed stress");
/// Temperatures that a fingertip stands.
const TEMPERATURE: Bounds = Bounds::within(-60.0, 150.0, "degrees Celsius");
/// Shifts; glass formers have up to about 1 per kelvin.
const SHIFT: Bounds = Bounds::within(0.0, 5.0, "per kelvin");

/// The section of a file: a material's own series by `preset`, or `tau_s` and `g`.
pub(super) fn parse(mut section: Section<'_>) -> Result<Relaxation, KeyFault> {
    let names = || {
        let with_series = PRESETS.iter().filter(|preset| preset.relaxation.is_some());
        let names: Vec<String> = with_series.map(|preset| format!("{:?}", preset.name)).collect();
        format!("a material with a published series: {}", names.join(", "))
    };
    if let Some(name) = section.text("preset", &names())? {
        let series = Preset::named(name).and_then(|preset| preset.relaxation);
        let series = series.ok_or_else(|| section.refuse("preset", &names()))?;
        for key in ["tau_s", "g", "temperature_c", "shift_per_kelvin"] {
            if section.has(key) {
                return Err(section.refuse(key, "left out, as preset is given"));
            }
        }
        section.finish()?;
        return Ok(series);
    }
    let times = section.increasing("tau_s", TIME, [1, MAX_TERMS])?;
    let weights = section.as_many("g", WEIGHT, times.len())?;
    let shift = section.number("shift_per_kelvin", SHIFT)?.unwrap_or(0.0);
    let temperature = if shift > 0.0 {
        section.needed_number("temperature_c", TEMPERATURE)?
    } else {
        // Without a shift the series is the same at every temperature.
        section.number("temperature_c", TEMPERATURE)?.unwrap_or(20.0)
    };
    section.finish()?;
    let terms: Vec<Term> = times
        .into_iter()
        .zip(weights)
        .map(|(time, weight)| Term { time, weight })
        .collect();
    Ok(Relaxation::new(&terms, temperature, shift))
}

/// The section of this name in a design's canonical text.
pub(super) fn print(name: &str, relaxation: &Relaxation, out: &mut String) -> fmt::Result {
    let column = |of: fn(&Term) -> f64| relaxation.terms().iter().map(of).collect::<Vec<_>>();
    writeln!(out, "\n[{name}]")?;
    writeln!(out, "tau_s = {:?}", column(|term| term.time))?;
    writeln!(out, "g = {:?}", column(|term| term.weight))?;
    writeln!(out, "temperature_c = {:?}", relaxation.temperature)?;
    writeln!(out, "shift_per_kelvin = {:?}", relaxation.shift)
}
