//! A chart of a report with logarithmic axes: magnitudes over the pressure rise.

use super::charts::{BOTTOM, LEFT, LINE, RIGHT, SIZE, Series, TOP};
use super::findings::Findings;
use output::drawing::{self, Anchor, BLACK, BLUE, Drawing, Marker, VERMILION, power};
use output::rows::plain;

/// Least magnitude that is shown, percent: an error of nothing has no logarithm.
const LEAST: f64 = 1e-4;

/// Whole decades that hold every value, at least one.
fn decades(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    let [least, largest] = values
        .map(libm::log10)
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], value| {
            [a.min(value), b.max(value)]
        });
    let first = libm::floor(least);
    (least.is_finite() && largest.is_finite()).then(|| [first, libm::ceil(largest).max(first + 1.0)])
}

/// Magnitudes of the tables' errors against the model over the pressure rise, with what is allowed; `None` of tables from data.
pub(super) fn errors(found: &Findings) -> Option<String> {
    let allowed = found.tables.as_ref().ok().map(|generated| {
        let certificate = &generated.certified.certificate;
        certificate
            .force
            .allowed_percent
            .max(certificate.indentation.allowed_percent)
    })?;
    let of = |output: usize| -> Vec<[f64; 2]> {
        found
            .table_readings
            .iter()
            .filter_map(|reading| {
                Some([
                    1e-3 * reading.pressure_rise,
                    reading.errors?[output].abs().max(LEAST),
                ])
            })
            .collect()
    };
    let series = [
        ("force", BLUE, Marker::Square, 0),
        ("indentation", VERMILION, Marker::Diamond, 1),
    ]
    .map(|(label, color, marker, output)| Series {
        label: label.to_owned(),
        color,
        marker: Some(marker),
        line: true,
        points: of(output),
    });
    let all = |place: usize| {
        series
            .iter()
            .flat_map(move |series| series.points.iter().map(move |at| at[place]))
    };
    let top = TOP + LINE * (series.len() + 1) as f64;
    let panel = drawing::Panel {
        x: drawing::Axis {
            decades: decades(all(0))?,
            pixels: [LEFT, RIGHT],
        },
        y: drawing::Axis {
            decades: decades(all(1).chain([allowed]))?,
            pixels: [BOTTOM, top],
        },
    };
    let largest = |series: &Series| series.points.iter().map(|[_, error]| *error).fold(0.0, f64::max);
    let described: Vec<String> = series
        .iter()
        .map(|series| format!("{}: at most {} %", series.label, plain(largest(series), 2)))
        .collect();
    let mut drawing = Drawing::inline(
        SIZE,
        "Error of the tables against the model",
        &described.join("; "),
    );
    panel.draw(&mut drawing, [1, 1], [&power, &power]);
    let [left, right] = panel.x.pixels;
    let height = panel.y.at(allowed);
    drawing.line([left, height], [right, height], BLACK, 1.2);
    for (row, series) in series.iter().enumerate() {
        let points: Vec<[f64; 2]> = series.points.iter().map(|at| panel.at(*at)).collect();
        drawing.path(&points, series.color, 2.0);
        let y = TOP + LINE * row as f64 - 2.0;
        drawing.line([LEFT + 4.0, y], [LEFT + 32.0, y], series.color, 2.2);
        if let Some(marker) = series.marker {
            for at in points.iter().step_by(points.len().div_ceil(6).max(1)) {
                drawing.marker(marker, *at, series.color, true);
            }
            drawing.marker(marker, [LEFT + 18.0, y], series.color, true);
        }
        drawing.text([LEFT + 42.0, y + 4.5], Anchor::Start, 13.0, BLACK, &series.label);
    }
    let y = TOP + LINE * series.len() as f64 - 2.0;
    drawing.line([LEFT + 4.0, y], [LEFT + 32.0, y], BLACK, 1.2);
    drawing.text(
        [LEFT + 42.0, y + 4.5],
        Anchor::Start,
        13.0,
        BLACK,
        &format!("allowed, {} %", plain(allowed, 3)),
    );
    drawing.text(
        [0.5 * (LEFT + RIGHT), 316.0],
        Anchor::Middle,
        13.0,
        BLACK,
        "pressure rise / kPa",
    );
    drawing.upward(
        [16.0, 0.5 * (BOTTOM + top)],
        13.0,
        "magnitude of the error / % of reading",
    );
    Some(drawing.finish())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decades_hold_every_value_and_nothing_has_none() {
        assert_eq!(decades([0.02, 3.0, 40.0].into_iter()), Some([-2.0, 2.0]));
        assert_eq!(decades([1.0].into_iter()), Some([0.0, 1.0]));
        assert_eq!(decades(core::iter::empty()), None);
        assert_eq!(decades([0.0, 1.0].into_iter()), None);
    }
}
