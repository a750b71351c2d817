//! What static tables say of a wall that relaxes, pressed at several speeds.

use super::labels::{KPA, MM, NEWTON, PERCENT, SECONDS};
use maud::{Markup, html};
use model_tables::design_file::{Axes, DesignFile};
use model_tables::generate::{ChipSeries, Generated};
use model_tables::model::choice::{FINE, elements_in_time};
use model_tables::solid::history::{Drive, History};
use model_tables::table::ContactLookup as _;
use model_tables::units::PressureRise;
use output::rows::plain;

/// Times of a press, seconds.
const TIMES: [f64; 4] = [0.1, 1.0, 10.0, 100.0];
/// Its force over that of the deepest press.
const FORCE: f64 = 1.0 / 3.0;
/// Instants of a press.
const INSTANTS: u32 = 20;

/// A press in so many seconds to a force, and what static tables make of its pressure.
pub(super) struct TimedPress {
    seconds: f64,
    pressure_rise: f64,
    force: f64,
    indentation: f64,
    stated_force: f64,
    stated_indentation: f64,
}

/// The presses of a design whose wall relaxes; none where it has no press in time.
pub(super) fn presses(file: &DesignFile, generated: &Generated) -> Vec<TimedPress> {
    let Some(series) = file.relaxation else {
        return Vec::new();
    };
    let elements = elements_in_time(file.model).unwrap_or(FINE);
    let force = FORCE * generated.end.force;
    let tables = &generated.certified.tables;
    let bits = tables.layout.fraction_bits;
    let press = |seconds: f64| {
        let mut history = History::new(&file.design_to(Axes::Outer), &series, elements, 0.0, 0.0).ok()?;
        for i in 1..=INSTANTS {
            let part = f64::from(i) / f64::from(INSTANTS);
            history.advance(part * seconds, Drive::Force(part * force)).ok()?;
        }
        let instant = history.now();
        let pressure_rise = file.calibration.pressure_gain * instant.pressure_rise;
        let reading = tables.contact_at(PressureRise::from_pascals(pressure_rise, bits));
        Some(TimedPress {
            seconds,
            pressure_rise,
            force: instant.force,
            indentation: instant.indentation,
            stated_force: reading.force.newtons(),
            stated_indentation: reading.indentation.metres(),
        })
    };
    TIMES.into_iter().map_while(press).collect()
}

/// Their table.
pub(super) fn section(presses: &[TimedPress], chip: Option<&ChipSeries>) -> Markup {
    let error = |read: f64, truth: f64| PERCENT.given(&plain(100.0 * (read / truth - 1.0), 3));
    html! {
        section {
            h2 { "In time" }
            p {
                "The wall relaxes. The chip's stages take that into account; static tables alone would read a press to a third of the \
                 largest force so, at its end:"
            }
            @if let Some(chip) = chip { p { (chip) "." } }
            div.wide {
                table {
                    caption { "Static tables in time" }
                    thead { tr {
                        th scope="col" { "pressed in" } th scope="col" { "pressure rise" } th scope="col" { "force" }
                        th scope="col" { "tables: force" } th scope="col" { "error" } th scope="col" { "indentation" }
                        th scope="col" { "tables: indentation" } th scope="col" { "error" }
                    } }
                    tbody {
                        @for press in presses {
                            tr {
                                td { (SECONDS.say(press.seconds)) }
                                td.value { (KPA.say(press.pressure_rise)) }
                                td.value { (NEWTON.say(press.force)) }
                                td.value { (NEWTON.say(press.stated_force)) }
                                td.value { (error(press.stated_force, press.force)) }
                                td.value { (MM.say(press.indentation)) }
                                td.value { (MM.say(press.stated_indentation)) }
                                td.value { (error(press.stated_indentation, press.indentation)) }
                            }
                        }
                    }
                }
            }
        }
    }
}
