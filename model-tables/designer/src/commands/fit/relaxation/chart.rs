//! The chart of a fitted series: readings of the holds over the settled wall's, measured and fitted.

use crate::fit::Measured;
use crate::fit::relaxation::RelaxationFit;
use crate::fit::relaxation::record::HoldRecord;
use model_tables::design_file::DesignFile;
use output::drawing::{
    Anchor, Axis, BLACK, BLUE, Drawing, GREEN, GREY, Marker, ORANGE, PURPLE, Panel, VERMILION, power,
};

const WIDTH: f64 = 960.0;
const HEIGHT: f64 = 460.0;
const COLORS: [&str; 5] = [BLUE, VERMILION, GREEN, PURPLE, ORANGE];
/// Trials that the legend names.
const NAMED: usize = 8;

/// The whole chart.
pub(super) fn draw(file: &DesignFile, record: &HoldRecord, fit: &RelaxationFit) -> String {
    let mut drawing = Drawing::new(WIDTH, HEIGHT);
    let title = format!("{}: {}", file.name, record.name);
    drawing.text([20.0, 26.0], Anchor::Start, 16.0, BLACK, &title);
    // Of the pressure where it was read.
    let quantity = if fit
        .residuals
        .iter()
        .any(|residual| residual.quantity == Measured::PressureRise)
    {
        Measured::PressureRise
    } else {
        Measured::Force
    };
    // Seconds since the press began, and readings over the settled wall's: measured, fitted.
    let points: Vec<Vec<[f64; 3]>> = (0..record.trials.len())
        .map(|at| {
            let trial = &record.trials[at];
            let of = fit.residuals.iter().filter(|residual| {
                residual.trial == at && residual.quantity == quantity && residual.row >= trial.held_from
            });
            of.map(|residual| {
                let seconds = trial.rows[residual.row].time - trial.rows[0].time;
                let [measured, fitted] =
                    [residual.measured, residual.fitted].map(|reading| reading / residual.settled);
                [seconds, measured, fitted]
            })
            .filter(|point| point.iter().all(|number| *number > 0.0))
            .collect()
        })
        .collect();
    let range = |axis: usize| {
        let values = || points.iter().flatten().map(|point| libm::log10(point[axis]));
        let (low, high) = (
            values().fold(f64::INFINITY, f64::min),
            values().fold(f64::NEG_INFINITY, f64::max),
        );
        let room = 0.04 * (high - low).max(0.1);
        [low - room, high + room]
    };
    let panel = Panel {
        x: Axis {
            decades: range(0),
            pixels: [85.0, WIDTH - 25.0],
        },
        y: Axis {
            decades: range(1),
            pixels: [HEIGHT - 65.0, 50.0],
        },
    };
    panel.draw(&mut drawing, [1, 1], [&power, &power]);
    let middle = 0.5 * (panel.x.pixels[0] + panel.x.pixels[1]);
    drawing.text(
        [middle, HEIGHT - 22.0],
        Anchor::Middle,
        13.0,
        BLACK,
        "time since the press began / s",
    );
    drawing.upward(
        [30.0, 0.5 * HEIGHT],
        13.0,
        &format!("{quantity} over the settled wall's"),
    );
    for (at, points) in points.iter().enumerate() {
        for [seconds, measured, _] in points {
            drawing.marker(Marker::Circle, panel.at([*seconds, *measured]), GREY, true);
        }
        let line: Vec<[f64; 2]> = points
            .iter()
            .map(|[seconds, _, fitted]| panel.at([*seconds, *fitted]))
            .collect();
        let color = COLORS[at % COLORS.len()];
        drawing.path(&line, color, 2.0);
        if at < NAMED {
            let y = 76.0 + 19.0 * at as f64;
            let x = WIDTH - 250.0;
            drawing.line([x, y - 4.0], [x + 24.0, y - 4.0], color, 2.2);
            let trial = &record.trials[at];
            let words = format!("{} fitted, {:.2} mm", trial.name, 1e3 * trial.depth);
            drawing.text([x + 32.0, y], Anchor::Start, 12.5, BLACK, words.trim());
        }
    }
    drawing.finish()
}
