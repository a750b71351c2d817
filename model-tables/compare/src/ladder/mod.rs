//! `designer ladder`: the fidelities over random walls, and what the rule of `auto` lets through.

use crate::campaign::scaling;
use crate::campaign::walls::{self, ASKED, MeasuredWall};
use model_tables::design::RestBy;
use model_tables::model::choice::LADDER;
use output::drawing::{
    Anchor, Axis, BLACK, BLUE, Drawing, GREEN, GREY, Marker, ORANGE, PURPLE, Panel, VERMILION, power,
};
use output::files;
use output::progress::Progress;
use output::rows::{Cell, Rows};
use output::{CommandAnswer, Refusal};
use std::fmt::Write as _;
use std::path::PathBuf;

pub mod objects;
mod page;

const COLUMNS: &[&str] = &["allowed_percent", "model", "designs", "largest_error_percent"];
const COLORS: [&str; LADDER.len()] = [VERMILION, ORANGE, GREEN, BLUE, BLACK];
const MARKERS: [Marker; LADDER.len()] = [
    Marker::Circle,
    Marker::Square,
    Marker::Diamond,
    Marker::Triangle,
    Marker::Wedge,
];
const PANEL: [f64; 2] = [300.0, 330.0];
const LEFT: f64 = 78.0;
const TOP: f64 = 112.0;
const GAP: f64 = 74.0;
/// Accuracies that have a map.
const MAPPED: [f64; 3] = [0.05, 0.02, 0.005];
/// Between which heights unstretched walls stand on the axis of the pre-stretch, one above the other lest they hide each other.
const UNSTRETCHED: [f64; 2] = [0.0024, 0.0065];

/// What is asked.
#[derive(Debug, clap::Args)]
pub struct LadderArguments {
    /// Number of random walls
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u64).range(1..=100_000))]
    designs: u64,
    /// Folder for the files; created if it does not exist
    #[arg(long, value_name = "DIR", default_value = "target/ladder")]
    out: PathBuf,
}

/// Measures, writes the files, and gives a row a file.
///
/// # Errors
/// [`Refusal`] where a design cannot be solved or a file not be written.
pub fn run(arguments: &LadderArguments) -> Result<CommandAnswer, Refusal> {
    files::expect_folder(&arguments.out, &["ladder.csv", "ladder.svg", "LADDER.md"])?;
    let mut measured = Vec::new();
    let progress = Progress::new("random walls");
    // One after another: what is measured is time.
    for index in 0..arguments.designs {
        measured.push(walls::draw(index).measure());
        progress.set((index + 1) as f64 / arguments.designs as f64);
    }
    let scaling = scaling::measure().map_err(|error| Refusal(error.to_string()))?;
    let scenes = objects::measure_all().map_err(|error| Refusal(error.to_string()))?;
    progress.finish();
    let judged: Vec<&MeasuredWall> = measured.iter().filter(|wall| wall.has_truth()).collect();
    let mut rows = Rows::new(COLUMNS);
    for asked in ASKED {
        let taken: Vec<_> = judged.iter().map(|wall| wall.take(asked)).collect();
        for (place, kind) in LADDER.iter().enumerate() {
            let errors = taken
                .iter()
                .filter(|taken| taken.fidelity == place)
                .map(|taken| taken.error);
            let largest = errors.clone().fold(0.0, f64::max);
            rows.push(vec![
                Cell::Number(100.0 * asked),
                Cell::Text(kind.to_string()),
                Cell::Count(errors.count()),
                Cell::Number(100.0 * largest),
            ]);
        }
    }
    let contents = [
        ("ladder.csv", csv(&measured).into_bytes()),
        ("ladder.svg", svg(&judged).into_bytes()),
        (
            "LADDER.md",
            page::markdown(&judged, measured.len() - judged.len(), &scaling, &scenes).into_bytes(),
        ),
    ];
    files::write_all(&arguments.out, &contents)?;
    let mut notes = vec![format!(
        "wrote LADDER.md, ladder.svg and ladder.csv to {}",
        arguments.out.display()
    )];
    if judged.len() < measured.len() {
        notes.push(format!(
            "{} walls are left out: the refined solid has no state for them",
            measured.len() - judged.len()
        ));
    }
    Ok(CommandAnswer { rows, notes })
}

fn pre_stretch(wall: &MeasuredWall) -> f64 {
    match wall.case.design.rest {
        RestBy::PoleStretch(stretch) => stretch - 1.0,
        _ => 0.0,
    }
}

fn csv(measured: &[MeasuredWall]) -> String {
    let mut text =
        "design,outer_radius_mm,outer_height_mm,wall_mm,pole_stretch,model,error,seconds_a_state,outcome\n"
            .to_owned();
    for wall in measured {
        let outer = wall.case.design.membrane;
        let start = format!(
            "{},{:.6},{:.6},{:.6},{:.6}",
            wall.case.index,
            outer.radial_semi_axis * 1e3,
            outer.axial_semi_axis * 1e3,
            outer.thickness * 1e3,
            1.0 + pre_stretch(wall)
        );
        if let Some(error) = wall.closed_form {
            let _ = writeln!(text, "{start},closed form,{error:.4e},,ok");
        }
        for (kind, evidence) in LADDER.iter().zip(&wall.fidelities) {
            let Some(evidence) = evidence else { continue };
            let _ = match &evidence.contacts {
                Ok(_) => writeln!(
                    text,
                    "{start},{kind},{:.4e},{:.3e},ok",
                    evidence.error, evidence.seconds
                ),
                Err(error) => writeln!(text, "{start},{kind},,,{}", error.to_string().replace(',', ";")),
            };
        }
    }
    text
}

fn panel(place: usize, x: [f64; 2], y: [f64; 2]) -> Panel {
    let left = LEFT + place as f64 * (PANEL[0] + GAP);
    Panel {
        x: Axis {
            decades: x,
            pixels: [left, left + PANEL[0]],
        },
        y: Axis {
            decades: y,
            pixels: [TOP + PANEL[1], TOP],
        },
    }
}

fn svg(measured: &[&MeasuredWall]) -> String {
    let width = LEFT + (1 + MAPPED.len()) as f64 * (PANEL[0] + GAP);
    let mut drawing = Drawing::new(width, TOP + PANEL[1] + 60.0);
    let title = format!("The ladder of models over {} random walls", measured.len());
    drawing.text([LEFT, 30.0], Anchor::Start, 20.0, BLACK, &title);
    let line = "Errors: the larger of force and pressure rise at any of eight indentations up to 0.35 of the height, against the \
                refined solid. Maps: the model that auto takes.";
    drawing.text([LEFT, 50.0], Anchor::Start, 13.0, GREY, line);
    for (place, kind) in LADDER.iter().enumerate() {
        let x = LEFT + 150.0 * place as f64;
        drawing.marker(MARKERS[place], [x + 5.0, 70.0], COLORS[place], false);
        drawing.text([x + 16.0, 74.0], Anchor::Start, 13.0, BLACK, &kind.to_string());
    }
    costs(&mut drawing, measured);
    for (i, asked) in MAPPED.into_iter().enumerate() {
        map(&mut drawing, 1 + i, asked, measured);
    }
    drawing.finish()
}

/// Error against time.
fn costs(drawing: &mut Drawing, measured: &[&MeasuredWall]) {
    let panel = panel(0, [-4.0, 0.0], [-4.0, 0.0]);
    panel.draw(drawing, [1, 1], [&power, &power]);
    for wall in measured {
        for (place, evidence) in wall.fidelities[..LADDER.len() - 1].iter().enumerate() {
            if let Some(evidence) = evidence
                && evidence.error.is_finite()
            {
                let at = panel.at([evidence.seconds, evidence.error]);
                drawing.marker(MARKERS[place], at, COLORS[place], false);
            }
        }
    }
    label(
        drawing,
        &panel,
        "time of a state / s",
        "largest relative error",
        "What each costs",
    );
}

/// A height for an unstretched wall: any.
fn unstretched(index: u64) -> f64 {
    let [low, high] = UNSTRETCHED;
    let part = (index * 7 % 17) as f64 / 16.0;
    low * libm::pow(high / low, part)
}

/// What `auto` takes.
fn map(drawing: &mut Drawing, place: usize, asked: f64, measured: &[&MeasuredWall]) {
    let panel = panel(place, [-2.2, -0.4], [-2.7, 0.1]);
    panel.draw(drawing, [1, 1], [&power, &power]);
    let mut worst = 0.0_f64;
    for wall in measured {
        let taken = wall.take(asked);
        worst = worst.max(taken.error);
        let outer = wall.case.design.membrane;
        let stretch = match pre_stretch(wall) {
            none if none <= 0.0 => unstretched(wall.case.index),
            some => some,
        };
        let at = panel.at([outer.thickness / outer.radial_semi_axis, stretch]);
        drawing.marker(MARKERS[taken.fidelity], at, COLORS[taken.fidelity], false);
    }
    let y = panel.y.at(1.2 * UNSTRETCHED[1]);
    drawing.line([panel.x.pixels[0], y], [panel.x.pixels[1], y], GREY, 1.0);
    drawing.text(
        [panel.x.pixels[1] - 4.0, y + 14.0],
        Anchor::End,
        11.0,
        PURPLE,
        "unstretched",
    );
    let words = format!("{} % allowed, {:.2} % let through", 100.0 * asked, 100.0 * worst);
    label(drawing, &panel, "wall / outer radius", "pole stretch - 1", &words);
}

fn label(drawing: &mut Drawing, panel: &Panel, across: &str, up: &str, title: &str) {
    let ([left, right], [bottom, top]) = (panel.x.pixels, panel.y.pixels);
    drawing.text([left, top - 8.0], Anchor::Start, 14.0, BLACK, title);
    drawing.text(
        [0.5 * (left + right), bottom + 38.0],
        Anchor::Middle,
        13.0,
        BLACK,
        across,
    );
    drawing.upward([left - 46.0, 0.5 * (bottom + top)], 13.0, up);
}
