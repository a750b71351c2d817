//! The page: words and tables around the charts. Everything is in the one file: no script, no font, no picture from elsewhere.

use super::feedback;
use super::findings::Findings;
use super::in_time;
use super::inputs::{Row, inputs, rows};
use super::labels::{KPA, MILLISECONDS, MM, MM3, NEWTON, PERCENT, count};
use super::shapes;
use super::{charts, logarithmic};
use maud::{Markup, PreEscaped, html};
use model_tables::design_file::DesignFile;
use model_tables::generate::object::Band;
use model_tables::generate::{Errors, Generated, TABLE_VERSION};
use model_tables::model::Kind;
use model_tables::model::own_error::OwnError;
use output::rows::plain;
use std::fmt::Write as _;
use std::path::Path;

const STYLE: &str = include_str!("style.css");

/// The whole page.
pub(super) fn html(found: &Findings, path: &Path) -> String {
    let name = &found.file.name;
    let body = html! {
        main {
            (head(found, path))
            (shapes_section(found))
            (warnings(found))
            (inputs(found))
            (press(found))
            (meridians(found))
            (tables(found))
            @if !found.in_time.is_empty() { (in_time::section(&found.in_time, found.tables.as_ref().ok().and_then(|tables| tables.chip_series.as_ref()))) }
            (speed(found))
            @if !found.actuator.is_empty() { (actuator(found)) }
            @if let Some(haptic) = &feedback::pressing(&found.file, found.model, &found.design, found.deepest) {
                (feedback::section(haptic))
            }
        }
        footer {
            p.soft {
                "Written by " code { "designer report" } " of model-tables " (env!("CARGO_PKG_VERSION")) ", tables version "
                (TABLE_VERSION) ". Indentations count from first touch. The same states as numbers: " code { "designer solve" }
                ", " code { "designer profile" } ", " code { "designer table" } "."
            }
        }
    };
    // Written so that a parser of XML takes it too.
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\" xmlns=\"http://www.w3.org/1999/xhtml\">\n<head>\n<meta charset=\"utf-8\"/>\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n<title>{name}: fingertip report</title>\n\
         <style>\n{STYLE}</style>\n</head>\n<body>\n{}\n</body>\n</html>\n",
        body.into_string()
    )
}

fn hash(file: &DesignFile) -> String {
    file.hash().iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

fn model_words(found: &Findings) -> String {
    match found.model {
        Kind::Membrane => "membrane, relaxed where it would have to push".to_owned(),
        Kind::Solid(elements) => format!(
            "solid, {} elements through the wall and {} along the meridian",
            elements.through, elements.along
        ),
    }
}

/// What the transducer reads of a rise.
fn read(found: &Findings, rise: f64) -> f64 {
    found.file.calibration.pressure_gain * rise
}

fn head(found: &Findings, path: &Path) -> Markup {
    let end = found.states.last();
    let file = path
        .file_name()
        .map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    html! {
        header {
            h1 { (found.file.name) }
            p.soft {
                "Design " code { (file) } ", SHA-256 of its canonical text " code { (hash(&found.file)) } ". Model: "
                (model_words(found)) "."
                @if let Some(note) = &found.note { " " (note) "." }
            }
            dl.key {
                div { dt { "rest pressure" } dd { (KPA.say(found.file.calibration.pressure_read(found.rest.pressure))) } }
                @if let Some(end) = end {
                    div { dt { "pressed to" } dd { (MM.say(found.deepest)) } }
                    div { dt { "force there" } dd { (NEWTON.say(end.force)) } }
                    div { dt { "pressure rise there" } dd { (KPA.say(read(found, end.pressure_rise))) } }
                    div { dt { "contact radius there" } dd { (MM.say(end.contact_radius)) } }
                }
                @if let Ok(generated) = &found.tables {
                    div { dt { "tables" } dd { (count(generated.certified.tables.bytes(), "bytes")) } }
                }
                @if let Some(least) = &found.least {
                    div { dt { "lightest touch" } dd { (NEWTON.say(least.touch)) } }
                    div { dt { "a step of the transducer there" } dd { (NEWTON.say(least.step)) } }
                    div {
                        dt { "an hour of weather there" }
                        dd { @match least.weather { Some(newtons) => (NEWTON.say(newtons)), None => "none: a gauge part" } }
                    }
                    div { dt { "readings" } dd { (count(plain(least.rate, 4), "per second")) } }
                }
            }
        }
    }
}

fn warnings(found: &Findings) -> Markup {
    html! {
        section {
            h2 { "Before you use a number" }
            ul.warnings {
                @for line in &found.warnings { li { (line) } }
                @if let (Some(light), Some(deep)) = (found.bending.first(), found.bending.last()) {
                    li {
                        "A membrane does not bend. A solid of the same wall gives "
                        (NEWTON.say(light.solid)) " in the place of " (NEWTON.say(light.membrane)) " at "
                        (MM.say(light.indentation)) ", and " (NEWTON.say(deep.solid)) " in the place of "
                        (NEWTON.say(deep.membrane)) " at " (MM.say(deep.indentation)) "."
                    }
                }
            }
        }
    }
}

fn figure(svg: String, caption: &Markup) -> Markup {
    html! { figure { (PreEscaped(svg)) figcaption { (caption) } } }
}

fn press(found: &Findings) -> Markup {
    let every = found.states.len().div_ceil(8);
    let shown = found
        .states
        .iter()
        .skip(1)
        .rev()
        .step_by(every)
        .collect::<Vec<_>>();
    html! {
        section {
            h2 { "The press" }
            div.figures {
                (figure(charts::force(found), &html! { "Force of the plate over the indentation." }))
                (figure(charts::pressure(found), &html! { "Pressure over that of the rest state." }))
                (figure(charts::contact(found), &html! { "Radius of the contact, deformed." }))
                (figure(charts::readout(found), &html! {
                    "What a pressure reading says of the force: the fingertip's sensitivity."
                }))
            }
            div.wide {
                table {
                    caption { "States of the press" }
                    thead { tr {
                        th scope="col" { "indentation" } th scope="col" { "force" } th scope="col" { "pressure rise" }
                        th scope="col" { "contact radius" }
                    } }
                    tbody {
                        @for state in shown.iter().rev() {
                            tr {
                                td { (MM.say(state.indentation)) }
                                td.value { (NEWTON.say(state.force)) }
                                td.value { (KPA.say(read(found, state.pressure_rise))) }
                                td.value { (MM.say(state.contact_radius)) }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn shapes_section(found: &Findings) -> Markup {
    html! {
        section {
            h2 { "Pressed shapes, to scale" }
            div class="figures small" {
                @for (svg, meridian) in shapes::draw(found).into_iter().zip(&found.meridians) {
                    (figure(svg, &html! {
                        @if meridian.indentation > 0.0 {
                            (MM.say(meridian.indentation)) ", " (NEWTON.say(meridian.force))
                        } @else { "at rest" }
                    }))
                }
            }
            p.soft { "Sections through the axis, all to one scale: wall, fluid, plate above and base below." }
        }
    }
}

fn meridians(found: &Findings) -> Markup {
    let what = match found.model {
        Kind::Membrane => "Tensions are per deformed length.",
        Kind::Solid(_) => {
            "Of the middle of the wall; tensions are forces across the whole wall per deformed length, and may push."
        }
    };
    html! {
        section {
            h2 { "Stretches and tensions along the meridian" }
            p { "From the pole (0\u{a0}\u{b0}) to the equator (90\u{a0}\u{b0} of the undeformed ellipse's parameter). " (what) }
            div.figures {
                @for (svg, caption) in charts::meridians(found).into_iter().zip([
                    "Deformed over undeformed length along the meridian.",
                    "Deformed over undeformed radius.",
                    "Along the meridian.",
                    "Around the axis.",
                ]) { (figure(svg, &html! { (caption) })) }
            }
        }
    }
}

fn tables(found: &Findings) -> Markup {
    html! {
        section {
            h2 { "Tables and certificate" }
            @match &found.tables {
                Err(missing) => p {
                    "None: the design has no " code { "[" (missing) "]" } ", which tables need."
                },
                Ok(generated) => (certified(found, generated)),
            }
        }
    }
}

fn certified(found: &Findings, generated: &Generated) -> Markup {
    let tables = &generated.certified.tables;
    let certificate = &generated.certified.certificate;
    let transducer = &generated.transducer;
    let [low, high] = transducer.gauge_range_kpa();
    let reached = 1e-3 * (generated.rest_pressure + generated.end.pressure_rise);
    let mut facts: Vec<Row> = vec![
        ("both functions together", count(tables.bytes(), "bytes")),
        ("segments", count(tables.segments(), "segments")),
        (
            "a lookup on the chip",
            count(tables.instructions(), "instructions"),
        ),
        ("inputs checked: every one", count(certificate.inputs, "inputs")),
        ("pressure at the deepest, gauge", KPA.given(&plain(reached, 4))),
        (
            "share of the transducer's range",
            PERCENT.say(100.0 * (reached - low) / (high - low)),
        ),
    ];
    if let Some(model) = &generated.model_error {
        facts.push((
            "model against a finer mesh, force",
            PERCENT.given(&plain(model.force_percent, 2)),
        ));
        facts.push((
            "model against a finer mesh, indentation",
            PERCENT.given(&plain(model.indentation_percent, 2)),
        ));
    }
    match &generated.membrane_error {
        Some(OwnError::Compared(found)) => {
            facts.push((
                "membrane against the solid, force",
                PERCENT.given(&plain(found.force_percent, 2)),
            ));
            facts.push((
                "membrane against the solid, indentation",
                PERCENT.given(&plain(found.indentation_percent, 2)),
            ));
        }
        Some(OwnError::Estimated { percent, .. }) => facts.push((
            "membrane, thickness over radius: no solid to compare",
            PERCENT.given(&plain(*percent, 2)),
        )),
        Some(OwnError::Unknown { .. }) | None => {}
    }
    let [force, indentation] = generated.certified.resolvable_percent;
    facts.push((
        "averaged readings tell, of the force",
        PERCENT.given(&plain(force, 2)),
    ));
    facts.push((
        "averaged readings tell, of the indentation",
        PERCENT.given(&plain(indentation, 2)),
    ));
    html! {
        div.tables {
            (rows("The tables", &facts))
            (errors(&certificate.force, &certificate.indentation))
        }
        @if let Some(band) = &generated.band { (unknown_object(band)) }
        div.figures {
            (figure(charts::depth(found), &html! { "The other table: what a pressure reading says of the indentation." }))
            @if let Some(svg) = logarithmic::errors(found) {
                (figure(svg, &html! { "What the chip reads less what the model gives, at the states of this report: magnitudes." }))
            }
        }
        details {
            summary { "The whole certificate" }
            pre { (generated.certificate()) }
        }
    }
}

/// What an object that the chip is not told leaves open.
fn unknown_object(band: &Band) -> Markup {
    let range = |[least, most]: [f64; 2]| PERCENT.given(&format!("{least:+.1} to {most:+.1}"));
    html! {
        div.wide {
            table {
                caption { "Where the chip is not told what it touches: the truth less the reading" }
                thead { tr { th scope="col" { "pressure rise" } th scope="col" { "force" } th scope="col" { "indentation" } } }
                tbody {
                    @for row in &band.rows {
                        tr {
                            th scope="row" { (plain(1e-3 * row.from, 4)) " to " (KPA.given(&plain(1e-3 * row.to, 4))) }
                            td.value { (range(row.force_percent)) }
                            td.value { (range(row.indentation_percent)) }
                        }
                    }
                }
            }
        }
        p.soft {
            "Percent of reading. Tables of a " (band.tables_of) "; balls of " (band.smallest_ball_mm) " mm radius or more on the axis, solved; \
             plates tilted by up to 20\u{a0}\u{b0} and friction, quoted of a dome of 9 x 7 mm; each alone."
        }
    }
}

fn errors(force: &Errors, indentation: &Errors) -> Markup {
    let line = |what: &'static str, of: &dyn Fn(&Errors) -> Markup| {
        html! {
            tr { th scope="row" { (what) } td.value { (of(force)) } td.value { (of(indentation)) } }
        }
    };
    let yes = |holds: bool| html! { (if holds { "never" } else { "somewhere" }) };
    html! {
        table {
            caption { "Errors over every input" }
            thead { tr { th scope="col" { "of reading" } th scope="col" { "force" } th scope="col" { "indentation" } } }
            tbody {
                (line("largest", &|errors| PERCENT.say(errors.of_reading.max)))
                (line("root mean square", &|errors| PERCENT.say(errors.of_reading.rms)))
                (line("mean", &|errors| PERCENT.say(errors.of_reading.mean)))
                (line("allowed", &|errors| PERCENT.say(errors.allowed_percent)))
                (line("largest of full scale", &|errors| PERCENT.say(errors.of_full_scale.max)))
                (line("falls", &|errors| yes(errors.falling_steps == 0)))
                tr {
                    th scope="row" { "full scale" }
                    td.value { (NEWTON.say(1e-6 * force.full_scale)) }
                    td.value { (MM.say(1e-9 * indentation.full_scale)) }
                }
                tr {
                    th scope="row" { "percent of reading from" }
                    td.value { (NEWTON.say(1e-6 * force.from)) }
                    td.value { (MM.say(1e-9 * indentation.from)) }
                }
            }
        }
    }
}

fn speed(found: &Findings) -> Markup {
    if found.costs.is_empty() {
        return html! {};
    }
    html! {
        section {
            h2 { "Speed and accuracy of the model" }
            p {
                "Eight states up to the deepest, each warm-started from those before, on one thread of the machine that wrote this, \
                 once; errors are the largest of force and pressure rise against the finest model."
            }
            div.figures {
                @if let Some(svg) = charts::speed(&found.costs) {
                    (figure(svg, &html! { "Lower left is better." }))
                }
                table {
                    caption { "Models of this design" }
                    thead { tr { th scope="col" { "model" } th scope="col" { "largest error" } th scope="col" { "time of a state" } } }
                    tbody {
                        @for cost in &found.costs {
                            tr {
                                th scope="row" { (cost.model) @if cost.used { " (this report)" } }
                                td.value {
                                    @match cost.distance {
                                        Some(distance) => (PERCENT.given(&plain(100.0 * distance, 2))),
                                        None => "the reference",
                                    }
                                }
                                td.value { (MILLISECONDS.given(&plain(1e3 * cost.seconds, 2))) }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn actuator(found: &Findings) -> Markup {
    let last = found.actuator.last();
    html! {
        section {
            h2 { "Feedback actuator" }
            div.figures {
                (figure(charts::actuator(found), &html! { "Force of the feedback membrane held against the skin." }))
                @if let Some((pressure, blocked)) = last {
                    (rows("At the highest pressure shown", &[
                        ("pressure", KPA.say(*pressure)),
                        ("blocked force", NEWTON.say(blocked.blocked_force)),
                        ("contact diameter", MM.say(blocked.contact_diameter)),
                        ("volume change", MM3.say(blocked.volume_change)),
                    ]))
                }
            }
        }
    }
}
