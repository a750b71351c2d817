//! A map as SVG: a panel a method, a square a cell.

use super::survey::{Across, METHODS, ROWS, STRETCH, Survey, VERDICTS, Verdict};
use output::drawing::{Anchor, BLACK, Drawing, GREY, Marker, power};

const CELL: f64 = 20.0;
const LEFT: f64 = 84.0;
const GAP: f64 = 44.0;
/// Above the first row of the legend, a row of it, and from its last to the panels.
const LEGEND: [f64; 3] = [66.0, 24.0, 60.0];
/// Width of a letter of the legend, generously: fonts differ.
const LETTER: f64 = 7.2;

/// Apart in lightness too; the silent failure is black with a cross.
fn color(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Exact => "#0072b2",
        Verdict::Coarse => "#7fc4ec",
        Verdict::Declared => "#f0e442",
        Verdict::Refused => "#e07b00",
        Verdict::NoState => "#dddddd",
        Verdict::Silent => "#111111",
    }
}

fn label(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Exact => "force within 1e-6",
        Verdict::Coarse => "force within 1 %",
        Verdict::Declared => "compressed, and says so",
        Verdict::Refused => "refuses a state that exists",
        Verdict::NoState => "refuses, and no state is known",
        Verdict::Silent => "silently wrong: > 1 % off, or no state is known",
    }
}

/// The map.
pub(super) fn svg(survey: &Survey) -> String {
    let chart = &survey.chart;
    let (wide, high) = (CELL * chart.columns as f64, CELL * ROWS as f64);
    let panels = METHODS.len() as f64;
    let width = LEFT + panels * wide + (panels - 1.0) * GAP + 24.0;
    let entries = legend(width);
    let top = entries.last().map_or(0.0, |([_, y], _)| y + LEGEND[2]);
    let mut drawing = Drawing::new(width, top + high + 60.0);
    drawing.text([LEFT, 30.0], Anchor::Start, 20.0, BLACK, "Where methods fail");
    drawing.text([LEFT, 52.0], Anchor::Start, 13.0, GREY, chart.title);
    for ([x, y], verdict) in entries {
        drawing.area([x, y], [14.0, 14.0], color(verdict));
        if verdict == Verdict::Silent {
            drawing.marker(Marker::Cross, [x + 7.0, y + 7.0], "#ffffff", false);
        }
        drawing.text([x + 20.0, y + 12.0], Anchor::Start, 12.0, BLACK, label(verdict));
    }
    for (i, method) in METHODS.iter().enumerate() {
        let left = LEFT + i as f64 * (wide + GAP);
        drawing.text([left, top - 12.0], Anchor::Start, 14.0, BLACK, method.title());
        for cell in &survey.cells {
            let (column, row) = (cell.column as f64, cell.row as f64);
            // Cells of a coarse survey are cut off at the panel's end.
            let side = CELL * survey.stride as f64;
            let size = [side.min(wide - CELL * column), side.min(high - CELL * row)];
            let corner = [left + CELL * column, top + high - CELL * row - size[1]];
            let verdict = cell.verdicts[i];
            drawing.area(corner, size.map(|side| side - 1.0), color(verdict));
            if verdict == Verdict::Silent {
                let middle = [corner[0] + 0.5 * size[0], corner[1] + 0.5 * size[1]];
                drawing.marker(Marker::Cross, middle, "#ffffff", false);
            }
        }
        axes(&mut drawing, survey, [left, top], i == 0);
    }
    drawing.finish()
}

/// Where each verdict's square stands: from left to right, in as many rows as the width takes.
fn legend(width: f64) -> Vec<([f64; 2], Verdict)> {
    let [mut x, mut y] = [LEFT, LEGEND[0]];
    VERDICTS
        .into_iter()
        .map(|verdict| {
            let wide = 20.0 + LETTER * label(verdict).chars().count() as f64;
            if x > LEFT && x + wide > width {
                [x, y] = [LEFT, y + LEGEND[1]];
            }
            let at = [x, y];
            x += wide + 0.5 * GAP;
            (at, verdict)
        })
        .collect()
}

fn axes(drawing: &mut Drawing, survey: &Survey, [left, top]: [f64; 2], first: bool) {
    let chart = &survey.chart;
    let (wide, high) = (CELL * chart.columns as f64, CELL * ROWS as f64);
    let bottom = top + high;
    let [low, end] = chart.range;
    let mut tick = |part: f64, label: &str| {
        let x = left + part * wide;
        drawing.line([x, bottom], [x, bottom + 5.0], GREY, 1.0);
        drawing.text([x, bottom + 19.0], Anchor::Middle, 12.0, BLACK, label);
    };
    if chart.across == Across::Indentation {
        for decade in -4..=0 {
            let part = libm::log(libm::pow(10.0, f64::from(decade)) / low) / libm::log(end / low);
            tick(part, &power(decade));
        }
    } else {
        let step = match end - low {
            span if span > 1.0 => 0.5,
            span if span > 0.5 => 0.2,
            _ => 0.05,
        };
        let [from, to] = [libm::ceil(low / step - 1e-9), libm::floor(end / step + 1e-9)];
        for k in from as i32..=to as i32 {
            let value = step * f64::from(k);
            tick((value - low) / (end - low), &format!("{value:.2}"));
        }
    }
    drawing.text(
        [left + 0.5 * wide, bottom + 42.0],
        Anchor::Middle,
        13.0,
        BLACK,
        chart.words,
    );
    for over_one in [0.002, 0.01, 0.05, 0.2, 1.0, 2.0] {
        let part = libm::log(over_one / STRETCH[0]) / libm::log(STRETCH[1] / STRETCH[0]);
        let y = bottom - part * high;
        drawing.line([left - 5.0, y], [left, y], GREY, 1.0);
        if first {
            let label = format!("{}", 1.0 + over_one);
            drawing.text([left - 9.0, y + 4.0], Anchor::End, 12.0, BLACK, &label);
        }
    }
    if first {
        drawing.upward([left - 58.0, top + 0.5 * high], 13.0, "pole stretch at rest");
    }
}
