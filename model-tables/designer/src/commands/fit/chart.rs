//! The chart of a fit: measured, design and fit, over the depth.

use crate::fit::data::Data;
use crate::fit::{DataQuantity, Fit, Residual};
use model_tables::design_file::DesignFile;
use output::drawing::{Anchor, BLACK, BLUE, Drawing, GREY, Marker, ORANGE, VERMILION};
use output::linear::{LinearAxis, LinearPanel};

const WIDTH: f64 = 960.0;
const HEIGHT: f64 = 430.0;

/// The whole chart.
pub(super) fn draw(file: &DesignFile, data: &Data, fit: &Fit) -> String {
    let mut drawing = Drawing::new(WIDTH, HEIGHT);
    let title = format!("{}: {}", file.name, data.name);
    drawing.text([20.0, 26.0], Anchor::Start, 16.0, BLACK, &title);
    let of = |quantity: DataQuantity| -> Vec<&Residual> {
        fit.residuals
            .iter()
            .filter(|residual| residual.quantity == quantity)
            .collect()
    };
    let panels: Vec<(Vec<&Residual>, &str, f64)> = [
        (of(DataQuantity::Force), "force / N", 1.0),
        (of(DataQuantity::Rise), "pressure rise / kPa", 1e-3),
    ]
    .into_iter()
    .filter(|panel| !panel.0.is_empty())
    .collect();
    let by_depth = data.rows.iter().any(|row| row.indentation.is_some());
    let width = (WIDTH - 30.0) / panels.len() as f64;
    for (i, (residuals, label, factor)) in panels.iter().enumerate() {
        let left = 75.0 + width * i as f64;
        let place = |residual: &Residual| {
            let row = &data.rows[residual.row];
            if by_depth {
                row.indentation.map(|depth| 1e3 * depth)
            } else {
                row.rise.map(|rise| 1e-3 * rise)
            }
        };
        let largest = |of: &dyn Fn(&Residual) -> Option<f64>| {
            residuals
                .iter()
                .filter_map(|residual| of(residual))
                .fold(0.0, f64::max)
        };
        let panel = LinearPanel {
            x: LinearAxis::from_zero(largest(&place), [left, left + width - 90.0]),
            y: LinearAxis::from_zero(
                largest(&|residual| Some(factor * residual.measured.max(residual.fitted))),
                [HEIGHT - 60.0, 60.0],
            ),
        };
        panel.draw(&mut drawing);
        let middle = 0.5 * (panel.x.pixels[0] + panel.x.pixels[1]);
        let depth = if by_depth {
            "indentation / mm"
        } else {
            "pressure rise / kPa"
        };
        drawing.text([middle, HEIGHT - 22.0], Anchor::Middle, 13.0, BLACK, depth);
        drawing.upward([left - 52.0, 0.5 * HEIGHT], 13.0, label);
        let mut sorted: Vec<(f64, &Residual)> = residuals
            .iter()
            .filter_map(|residual| Some((place(residual)?, *residual)))
            .collect();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (x, residual) in &sorted {
            let color = if residual.outlier { ORANGE } else { GREY };
            let at = panel.at([*x, factor * residual.measured]);
            drawing.marker(Marker::Circle, at, color, true);
        }
        let line = |of: fn(&Residual) -> f64| -> Vec<[f64; 2]> {
            sorted
                .iter()
                .filter(|(_, residual)| factor * of(residual) <= panel.y.end)
                .map(|(x, residual)| panel.at([*x, factor * of(residual)]))
                .collect()
        };
        drawing.path(&line(|residual| residual.before), VERMILION, 1.6);
        drawing.path(&line(|residual| residual.fitted), BLUE, 2.2);
        if i == 0 {
            let legend = [
                (GREY, "measured"),
                (ORANGE, "outlier"),
                (VERMILION, "design"),
                (BLUE, "fit"),
            ];
            for (k, (color, word)) in legend.into_iter().enumerate() {
                let y = 82.0 + 19.0 * k as f64;
                if k < 2 {
                    drawing.marker(Marker::Circle, [left + 24.0, y - 4.0], color, true);
                } else {
                    drawing.line([left + 12.0, y - 4.0], [left + 36.0, y - 4.0], color, 2.2);
                }
                drawing.text([left + 44.0, y], Anchor::Start, 12.5, BLACK, word);
            }
        }
    }
    drawing.finish()
}
