//! Error of each model over the indentation: one panel a design.

use super::Measured;
use crate::methods::approximations::{Approximation, SAMPLES};
use output::drawing::{
    Anchor, Axis, BLACK, BLUE, Drawing, GREEN, GREY, ORANGE, PURPLE, Panel, VERMILION, power, spread,
};

const PANEL: [f64; 2] = [360.0, 430.0];
const LEFT: f64 = 78.0;
const TOP: f64 = 90.0;
/// Between panels: the labels stand there.
const GAP: f64 = 200.0;
const ERRORS: [i32; 2] = [-13, 0];
const INDENTATIONS: [i32; 2] = [-5, 1];
/// Smaller errors are not drawn.
const SEEN: f64 = 1e-13;
const COLORS: [&str; 7] = [ORANGE, VERMILION, PURPLE, GREEN, BLUE, GREY, BLACK];

/// The chart.
pub(super) fn svg(measured: &[Measured]) -> String {
    let width = LEFT + measured.len() as f64 * (PANEL[0] + GAP);
    let mut drawing = Drawing::new(width.max(700.0), TOP + PANEL[1] + 60.0);
    let title = "The ladder of models: what each gives away";
    drawing.text([LEFT, 30.0], Anchor::Start, 20.0, BLACK, title);
    let line = "Relative error of the force against the membrane on a finer mesh of higher order, and microseconds a state. A line \
                that ends: beyond what the model covers.";
    drawing.text([LEFT, 50.0], Anchor::Start, 13.0, GREY, line);
    for (i, design) in measured.iter().enumerate() {
        let left = LEFT + i as f64 * (PANEL[0] + GAP);
        let panel = Panel {
            x: Axis {
                decades: INDENTATIONS.map(f64::from),
                pixels: [left, left + PANEL[0]],
            },
            y: Axis {
                decades: ERRORS.map(f64::from),
                pixels: [TOP + PANEL[1], TOP],
            },
        };
        one(&mut drawing, &panel, design);
        if i == 0 {
            let words = "relative error of the force";
            drawing.upward([left - 52.0, TOP + 0.5 * PANEL[1]], 13.0, words);
        }
    }
    drawing.finish()
}

fn one(drawing: &mut Drawing, panel: &Panel, design: &Measured) {
    let ([left, right], [bottom, top]) = (panel.x.pixels, panel.y.pixels);
    panel.draw(drawing, [1, 1], [&power, &power]);
    drawing.text(
        [left, top - 9.0],
        Anchor::Start,
        14.0,
        BLACK,
        design.sweep.design.title,
    );
    let middle = 0.5 * (left + right);
    drawing.text(
        [middle, bottom + 38.0],
        Anchor::Middle,
        13.0,
        BLACK,
        "indentation / mm",
    );
    let mut labels = Vec::new();
    for (evidence, color) in design.ladder.iter().zip(COLORS) {
        let points: Vec<[f64; 2]> = evidence
            .samples
            .iter()
            .filter_map(|sample| {
                // The last sample is itself a state of the curves: nothing to see there.
                let error = sample.force.ok().filter(|&error| error > SEEN)?;
                Some(panel.at([sample.indentation * 1e3, error]))
            })
            .collect();
        drawing.path(&points, color, 1.8);
        let Some(&[x, y]) = points.last() else { continue };
        let words = match evidence.approximation {
            Approximation::LightContact => "closed form".to_owned(),
            Approximation::FewStates(states) => format!("{states} states"),
            Approximation::Sweep => "membrane, swept".to_owned(),
            Approximation::Membrane => "membrane".to_owned(),
        };
        let words = format!("{words}, {:.3} us", evidence.seconds * 1e6 / SAMPLES as f64);
        labels.push(([x, y], color, words));
    }
    let mut heights: Vec<f64> = labels.iter().map(|([_, y], _, _)| y + 4.0).collect();
    spread(&mut heights, 15.0, [top + 8.0, bottom]);
    for ((at, color, words), y) in labels.iter().zip(heights) {
        let x = right + 8.0;
        if (y - 4.0 - at[1]).abs() > 3.0 || right - at[0] > 12.0 {
            drawing.line([at[0] + 2.0, at[1]], [x - 2.0, y - 4.0], color, 0.6);
        }
        drawing.text([x, y], Anchor::Start, 12.0, color, words);
    }
}
