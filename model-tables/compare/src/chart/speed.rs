//! Time a state against error of the force: one panel a design.

use super::Measured;
use crate::methods::benchmark::{Method, Result, STAGES, STATES};
use output::drawing::{
    Anchor, Axis, BLACK, BLUE, Drawing, GREEN, GREY, Marker, ORANGE, PURPLE, Panel, VERMILION, power,
};

const PANEL: [f64; 2] = [400.0, 560.0];
const LEFT: f64 = 78.0;
const TOP: f64 = 118.0;
const GAP: f64 = 62.0;
const BELOW: f64 = 130.0;
/// Decades of the error, and of microseconds a state.
const ERRORS: [i32; 2] = [-14, 0];
const TIMES: [i32; 2] = [-2, 7];

/// One line of the chart.
struct Series<'a> {
    color: &'static str,
    marker: Marker,
    label: String,
    results: Vec<&'a Result>,
}

fn series(results: &[Result]) -> Vec<Series<'_>> {
    let markers = [
        Marker::Circle,
        Marker::Square,
        Marker::Triangle,
        Marker::Wedge,
        Marker::Diamond,
        Marker::Cross,
    ];
    let of = |keep: &dyn Fn(&Method) -> bool| results.iter().filter(|r| keep(&r.method)).collect::<Vec<_>>();
    let mut all: Vec<Series<'_>> = STAGES
        .iter()
        .zip(markers)
        .map(|(&wanted, marker)| Series {
            color: BLUE,
            marker,
            label: (2 * wanted).to_string(),
            results: of(&|m| matches!(m, Method::Collocation { stages, .. } if *stages == wanted)),
        })
        .collect();
    all.push(Series {
        color: VERMILION,
        marker: Marker::Square,
        label: "shooting".to_owned(),
        results: of(&|m| matches!(m, Method::Shooting { .. })),
    });
    all.push(Series {
        color: PURPLE,
        marker: Marker::Triangle,
        label: "bisection".to_owned(),
        results: of(&|m| matches!(m, Method::Bisection(_))),
    });
    all.push(Series {
        color: GREEN,
        marker: Marker::Circle,
        label: "few states".to_owned(),
        results: of(&|m| matches!(m, Method::FewStates(_))),
    });
    all.push(Series {
        color: ORANGE,
        marker: Marker::Diamond,
        label: "closed form".to_owned(),
        results: of(&|m| matches!(m, Method::LightContact)),
    });
    all
}

/// The chart.
pub(super) fn svg(measured: &[Measured]) -> String {
    let count = measured.len() as f64;
    let width = LEFT + count * PANEL[0] + (count - 1.0) * GAP + 24.0;
    let mut drawing = Drawing::new(width.max(900.0), TOP + PANEL[1] + BELOW);
    drawing.text([LEFT, 30.0], Anchor::Start, 20.0, BLACK, "Speed against accuracy");
    let line = format!(
        "{STATES} states of a press to 60 % of its limit, each warm-started from those before, one thread, one run; \
         the plain membrane. Lower left is better."
    );
    drawing.text([LEFT, 50.0], Anchor::Start, 13.0, GREY, &line);
    key(&mut drawing);
    for (i, design) in measured.iter().enumerate() {
        let left = LEFT + i as f64 * (PANEL[0] + GAP);
        let panel = Panel {
            x: Axis {
                decades: ERRORS.map(f64::from),
                pixels: [left, left + PANEL[0]],
            },
            y: Axis {
                decades: TIMES.map(f64::from),
                pixels: [TOP + PANEL[1], TOP],
            },
        };
        one(&mut drawing, &panel, design);
        if i == 0 {
            drawing.upward(
                [left - 52.0, TOP + 0.5 * PANEL[1]],
                13.0,
                "time a state / \u{b5}s",
            );
        }
    }
    drawing.finish()
}

fn key(drawing: &mut Drawing) {
    let entries = [
        (
            BLUE,
            Marker::Square,
            false,
            "Gauss collocation (this project), a line an order, from coarse to fine",
        ),
        (VERMILION, Marker::Square, false, "shooting"),
        (PURPLE, Marker::Triangle, false, "nested bisection"),
        (GREEN, Marker::Circle, false, "curve through few states"),
        (ORANGE, Marker::Diamond, false, "closed form"),
        (GREY, Marker::Circle, true, "stopped before the end"),
    ];
    let mut x = LEFT + 5.0;
    for (color, marker, hollow, words) in entries {
        drawing.marker(marker, [x, 72.0], color, hollow);
        drawing.text([x + 10.0, 76.5], Anchor::Start, 13.0, BLACK, words);
        x += 34.0 + 6.3 * words.chars().count() as f64;
    }
}

fn one(drawing: &mut Drawing, panel: &Panel, design: &Measured) {
    let ([left, right], [bottom, top]) = (panel.x.pixels, panel.y.pixels);
    let edge = panel.x.at(design.sweep.uncertainty);
    drawing.area([left, top], [edge - left, bottom - top], "#f3f3f3");
    panel.draw(drawing, [2, 1], [&power, &power]);
    drawing.text(
        [left, top - 9.0],
        Anchor::Start,
        14.0,
        BLACK,
        design.sweep.design.title,
    );
    let words = "largest error of the force over the sweep, relative";
    drawing.text(
        [0.5 * (left + right), bottom + 36.0],
        Anchor::Middle,
        13.0,
        BLACK,
        words,
    );
    let all = series(&design.results);
    let mut labels: Vec<([f64; 2], &str, String)> = Vec::new();
    for series in &all {
        let points: Vec<([f64; 2], bool)> = series
            .results
            .iter()
            .filter(|result| result.found > 0)
            .map(|result| {
                // A worst error of nothing lies at the left edge.
                let error = result.worst.max(1e-30);
                (
                    panel.at([error, result.seconds * 1e6]),
                    result.found < result.asked,
                )
            })
            .collect();
        let line: Vec<[f64; 2]> = points.iter().map(|(at, _)| *at).collect();
        drawing.path(&line, series.color, 1.5);
        for (at, hollow) in &points {
            drawing.marker(series.marker, *at, series.color, *hollow);
        }
        let collocation = series.color == BLUE;
        // Orders are labelled at their coarse end, the others at their fine one.
        if let Some(at) = if collocation { line.first() } else { line.last() } {
            labels.push((*at, series.color, series.label.clone()));
        }
    }
    place(drawing, &labels, [left, right]);
    drawing.text(
        [left + 4.0, bottom - 6.0],
        Anchor::Start,
        10.5,
        GREY,
        "truth not known better",
    );
    failures(drawing, &all, [left, bottom + 58.0]);
}

/// Orders of collocation below the coarse end of their line, the other names above their point.
fn place(drawing: &mut Drawing, labels: &[([f64; 2], &str, String)], [left, right]: [f64; 2]) {
    for ([x, y], color, words) in labels {
        if *color == BLUE {
            drawing.text([x + 1.0, y + 19.0], Anchor::Middle, 12.0, color, words);
        } else {
            let x = (x + 4.0).clamp(left + 34.0, right - 36.0);
            drawing.text([x, y - 9.0], Anchor::Middle, 12.0, color, words);
        }
    }
}

/// What stopped early, and why: one line a kind of method.
fn failures(drawing: &mut Drawing, all: &[Series<'_>], [x, mut y]: [f64; 2]) {
    let mut labelled = 0;
    for series in all {
        let Some(result) = series.results.iter().find(|result| result.failure.is_some()) else {
            continue;
        };
        let name = if series.color == BLUE {
            format!("order {}", series.label)
        } else {
            series.label.clone()
        };
        let reason = result.failure.as_deref().unwrap_or_default();
        let setting = match result.method {
            Method::LightContact => String::new(),
            method => format!(" ({})", method.settings()),
        };
        let words = format!(
            "{name}{setting}: {} of {} states, then:",
            result.found, result.asked
        );
        drawing.text([x, y], Anchor::Start, 10.5, series.color, &words);
        drawing.text(
            [x + 10.0, y + 13.0],
            Anchor::Start,
            10.5,
            series.color,
            &short(reason),
        );
        y += 29.0;
        labelled += 1;
    }
    if labelled == 0 {
        drawing.text(
            [x, y],
            Anchor::Start,
            10.5,
            GREY,
            "every method found every state",
        );
    }
}

/// The reason, cut where the panel ends.
fn short(reason: &str) -> String {
    const MAX_CHARACTERS: usize = 70;
    if reason.chars().count() <= MAX_CHARACTERS {
        reason.to_owned()
    } else {
        let cut: String = reason.chars().take(MAX_CHARACTERS).collect();
        format!("{}\u{2026}", cut.trim_end())
    }
}
