//! What a state costs as the pre-stretch goes to 1, and as the mesh grows.

use crate::campaign::scaling::PRINTED;
use crate::methods::shooting::Shooting;
use model_tables::design::{Design, RestBy};
use model_tables::membrane::TensionField;
use model_tables::membrane::adapt::Resolution;
use model_tables::membrane::press::{FULL, MembraneError, Press};
use output::Refusal;
use output::drawing::{
    Anchor, Axis, BLACK, BLUE, Drawing, GREEN, GREY, Marker, ORANGE, Panel, VERMILION, power,
};
use std::fmt::Write as _;
use std::time::Instant;

/// States of a sweep, to half of the limit.
const STATES: usize = 32;
/// Repetitions, the fastest of which counts.
const REPETITIONS: usize = 5;
const DENSITIES: [f64; 7] = [0.6, 0.9, 1.3, 2.0, 3.0, 4.0, 5.0];

/// A measured sweep.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cost {
    series: &'static str,
    /// Pole stretch over 1, or elements a unit of depth.
    x: f64,
    /// Microseconds a state.
    microseconds: f64,
    /// Newton iterations a state; 0 where not counted.
    iterations: f64,
}

fn design(stretch: f64) -> Design {
    Design {
        rest: RestBy::PoleStretch(stretch),
        ..PRINTED
    }
}

/// Times a sweep of ours.
fn ours(
    series: &'static str,
    x: f64,
    stretch: f64,
    field: TensionField,
    resolution: Resolution,
) -> Result<Cost, MembraneError> {
    let press: Press = Press::with_resolution(&design(stretch), field, resolution)?;
    let limit = press.clone().limit()?.indentation;
    let mut best = f64::INFINITY;
    let mut iterations = 0.0;
    for _ in 0..REPETITIONS {
        let mut press = press.clone();
        let before = press.iterations();
        let start = Instant::now();
        for k in 1..=STATES {
            press.contact_at(0.5 * limit * k as f64 / STATES as f64)?;
        }
        best = best.min(start.elapsed().as_secs_f64());
        iterations = (press.iterations() - before) as f64 / STATES as f64;
    }
    Ok(Cost {
        series,
        x,
        microseconds: best * 1e6 / STATES as f64,
        iterations,
    })
}

/// Times a sweep of shooting; `None` where it fails.
fn shooting(stretch: f64) -> Option<Cost> {
    let limit = Press::new(&design(stretch), TensionField::Plain)
        .and_then(|mut press| press.limit())
        .ok()?
        .indentation;
    let method = Shooting::new(&design(stretch), 1e-8).ok()?;
    let mut best = f64::INFINITY;
    for _ in 0..REPETITIONS {
        let mut method = method.clone();
        let start = Instant::now();
        for k in 1..=STATES {
            method
                .at_indentation(0.5 * limit * k as f64 / STATES as f64)
                .ok()?;
        }
        best = best.min(start.elapsed().as_secs_f64());
    }
    Some(Cost {
        series: "shooting",
        x: stretch - 1.0,
        microseconds: best * 1e6 / STATES as f64,
        iterations: 0.0,
    })
}

/// Measures all.
pub(super) fn measure(stride: usize) -> Result<Vec<Cost>, Refusal> {
    let mut costs = Vec::new();
    let refuse = |error: MembraneError| Refusal(format!("the cost of a state: {error}"));
    for k in (0..=16).step_by(stride) {
        let over_one = 1e-3 * libm::pow(2000.0, f64::from(k) / 16.0);
        let stretch = 1.0 + over_one;
        costs.push(ours("relaxed", over_one, stretch, TensionField::Relaxed, FULL).map_err(refuse)?);
        costs.extend(ours("plain", over_one, stretch, TensionField::Plain, FULL));
        costs.extend(shooting(stretch));
    }
    for (series, stretch) in [("mesh at 1.005", 1.005), ("mesh at 2.3", 2.3)] {
        for density in DENSITIES.into_iter().step_by(stride) {
            let resolution = Resolution { density, ..FULL };
            costs.push(ours(series, density, stretch, TensionField::Relaxed, resolution).map_err(refuse)?);
        }
    }
    Ok(costs)
}

/// A row a sweep.
pub(super) fn csv(costs: &[Cost]) -> String {
    let mut text = String::from(
        "series,pole_stretch_less_1_or_density,microseconds_a_state,newton_iterations_a_state\n",
    );
    for cost in costs {
        let _ = writeln!(
            text,
            "{},{:.6},{:.3},{:.3}",
            cost.series, cost.x, cost.microseconds, cost.iterations
        );
    }
    text
}

/// Series, colour, marker, side, label.
const SERIES: [(&str, &str, Marker, usize, &str); 5] = [
    ("relaxed", BLUE, Marker::Circle, 0, "this project, relaxed"),
    ("plain", GREEN, Marker::Diamond, 0, "plain"),
    (
        "shooting",
        VERMILION,
        Marker::Square,
        0,
        "shooting, where it finishes",
    ),
    ("mesh at 2.3", BLUE, Marker::Circle, 1, "pole stretch 2.3"),
    ("mesh at 1.005", ORANGE, Marker::Triangle, 1, "pole stretch 1.005"),
];

/// The chart.
pub(super) fn svg(costs: &[Cost]) -> String {
    const TOP: f64 = 130.0;
    const SIZE: [f64; 2] = [430.0, 340.0];
    let mut drawing = Drawing::new(1090.0, TOP + SIZE[1] + 60.0);
    drawing.text([80.0, 30.0], Anchor::Start, 20.0, BLACK, "What a state costs");
    let lines = [
        format!(
            "Agilus30, 9 x 7 x 1 mm, {STATES} warm-started states to half the limit, one thread, best of {REPETITIONS}"
        ),
        "Numbers at the markers: Newton iterations a state, states on the way to the first included"
            .to_owned(),
    ];
    for (k, line) in lines.iter().enumerate() {
        let y = 52.0 + 18.0 * k as f64;
        drawing.text([80.0, y], Anchor::Start, 13.0, GREY, line);
    }
    let words = [
        "pole stretch at rest, less 1",
        "elements a unit of depth (the full model has 2.5)",
    ];
    for (side, word) in words.iter().enumerate() {
        let left = 80.0 + side as f64 * (SIZE[0] + 120.0);
        let panel = Panel {
            x: Axis {
                decades: if side == 0 { [-3.0, 1.0] } else { [-1.0, 1.0] },
                pixels: [left, left + SIZE[0]],
            },
            y: Axis {
                decades: [1.0, 4.0],
                pixels: [TOP + SIZE[1], TOP],
            },
        };
        panel.draw(&mut drawing, [1, 1], [&power, &power]);
        drawing.upward([left - 46.0, TOP + 0.5 * SIZE[1]], 13.0, "time a state / \u{b5}s");
        let below = [left + 0.5 * SIZE[0], TOP + SIZE[1] + 42.0];
        drawing.text(below, Anchor::Middle, 13.0, BLACK, word);
        let mut x = left;
        for (name, color, marker, _, label) in SERIES.iter().filter(|s| s.3 == side) {
            drawing.marker(*marker, [x + 5.0, TOP - 20.0], color, false);
            drawing.text([x + 15.0, TOP - 16.0], Anchor::Start, 12.5, BLACK, label);
            x += 44.0 + 6.2 * label.len() as f64;
            let points: Vec<&Cost> = costs.iter().filter(|c| c.series == *name).collect();
            let places: Vec<[f64; 2]> = points.iter().map(|c| panel.at([c.x, c.microseconds])).collect();
            drawing.path(&places, color, 1.6);
            for (i, (place, cost)) in places.iter().zip(&points).enumerate() {
                drawing.marker(*marker, *place, color, false);
                if cost.iterations > 0.0 && *name != "plain" && i % 2 == 0 {
                    let at = [place[0], place[1] - 9.0];
                    drawing.text(
                        at,
                        Anchor::Middle,
                        11.0,
                        color,
                        &format!("{:.1}", cost.iterations),
                    );
                }
            }
        }
    }
    drawing.finish()
}
