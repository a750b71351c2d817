//! Error against bytes and against instructions: a column a design.

use super::page::WAYS;
use super::{Design, Measured, OURS, bytes, instructions};
use output::drawing::{
    Anchor, Axis, BLACK, BLUE, Drawing, GREEN, GREY, Marker, ORANGE, PURPLE, Panel, VERMILION,
};

const PANEL: [f64; 2] = [400.0, 330.0];
const LEFT: f64 = 86.0;
const TOP: f64 = 192.0;
const GAP: [f64; 2] = [46.0, 86.0];
/// Decades of the error in percent, of bytes, of instructions.
const ERRORS: [f64; 2] = [-4.0, 2.0];
const BYTES: [f64; 2] = [1.0, 5.0];
const INSTRUCTIONS: [f64; 2] = [1.0, 3.0];
/// What the front is drawn in.
const FRONT: &str = "#f0c800";

/// Colour and marker of a way.
fn look(way: &str) -> (&'static str, Marker) {
    match way {
        "uniform_q15" => (GREY, Marker::Triangle),
        "uniform_q31" => (GREY, Marker::Square),
        "linear_f32" => (PURPLE, Marker::Square),
        "cubic_f32" => (PURPLE, Marker::Circle),
        "warped_f32" => (GREY, Marker::Wedge),
        "octave_linear" => (BLUE, Marker::Triangle),
        "octave_quadratic" => (BLUE, Marker::Square),
        "octave_cubic" => (BLUE, Marker::Circle),
        "rational_f32" => (GREEN, Marker::Diamond),
        "power_libm" => (ORANGE, Marker::Diamond),
        "power_micromath" => (ORANGE, Marker::Cross),
        _ => (VERMILION, Marker::Circle),
    }
}

/// The chart.
pub(super) fn svg(designs: &[Design]) -> String {
    let count = designs.len() as f64;
    let width = LEFT + count * PANEL[0] + (count - 1.0) * GAP[0] + 24.0;
    let mut drawing = Drawing::new(width, TOP + 2.0 * PANEL[1] + GAP[1] + 62.0);
    let title = "Force and indentation from one pressure: error against bytes and instructions";
    drawing.text([LEFT, 30.0], Anchor::Start, 20.0, BLACK, title);
    let lines = [
        "Largest error of both, percent of reading from 1 % of full scale up (of that 1 % below). Lower left is better; the yellow \
         line joins what nothing beats in both.",
        "Instructions of both as a function, counted on the emulated chip.",
    ];
    for (y, line) in [50.0, 66.0].into_iter().zip(lines) {
        drawing.text([LEFT, y], Anchor::Start, 12.5, GREY, line);
    }
    key(&mut drawing);
    for (i, design) in designs.iter().enumerate() {
        let left = LEFT + i as f64 * (PANEL[0] + GAP[0]);
        for (j, (decades, of, words)) in [
            (BYTES, bytes as fn(&Measured) -> f64, "bytes of both tables"),
            (INSTRUCTIONS, instructions, "instructions of both"),
        ]
        .into_iter()
        .enumerate()
        {
            let top = TOP + j as f64 * (PANEL[1] + GAP[1]);
            let panel = Panel {
                x: Axis {
                    decades,
                    pixels: [left, left + PANEL[0]],
                },
                y: Axis {
                    decades: ERRORS,
                    pixels: [top + PANEL[1], top],
                },
            };
            panel.draw(&mut drawing, [1, 1], [&plain, &plain]);
            drawing.text([left, top - 9.0], Anchor::Start, 14.0, BLACK, design.name);
            let below = [left + 0.5 * PANEL[0], top + PANEL[1] + 38.0];
            drawing.text(below, Anchor::Middle, 13.0, BLACK, words);
            if i == 0 {
                drawing.upward([left - 56.0, top + 0.5 * PANEL[1]], 13.0, "largest error / %");
            }
            one(&mut drawing, &panel, design, of);
        }
    }
    drawing.finish()
}

fn one(drawing: &mut Drawing, panel: &Panel, design: &Design, of: fn(&Measured) -> f64) {
    let mut front: Vec<[f64; 2]> = design
        .measured
        .iter()
        .filter(|point| design.on_front(point, of))
        .map(|point| panel.at([of(point), point.errors.of_reading]))
        .collect();
    front.sort_by(|a, b| a[0].total_cmp(&b[0]));
    drawing.path(&front, FRONT, 7.0);
    for (way, ..) in WAYS {
        let (color, marker) = look(way);
        let points: Vec<[f64; 2]> = design
            .measured
            .iter()
            .filter(|point| point.way == way)
            .map(|point| panel.at([of(point), point.errors.of_reading]))
            .collect();
        drawing.path(&points, color, 1.0);
        for &at in &points {
            drawing.marker(marker, at, color, way != OURS);
        }
    }
}

/// The ways by their markers, in three columns.
fn key(drawing: &mut Drawing) {
    for (i, (way, words, _)) in WAYS.iter().enumerate() {
        let (column, row) = (i / 4, i % 4);
        let (x, y) = (LEFT + 8.0 + 400.0 * column as f64, 90.0 + 20.0 * row as f64);
        let (color, marker) = look(way);
        drawing.marker(marker, [x, y], color, *way != OURS);
        drawing.text([x + 12.0, y + 4.5], Anchor::Start, 13.0, BLACK, words);
    }
}

/// A decade as a plain number.
fn plain(decade: i32) -> String {
    match decade {
        -4 => "0.0001".to_owned(),
        -3 => "0.001".to_owned(),
        -2 => "0.01".to_owned(),
        -1 => "0.1".to_owned(),
        5 => "100 000".to_owned(),
        4 => "10 000".to_owned(),
        _ => libm::pow(10.0, f64::from(decade)).to_string(),
    }
}
