//! The page: errors of the fidelities over walls, indentations and pre-stretches, and what `auto` lets through.

use super::objects::{self, ObjectScene};
use super::pre_stretch;
use crate::campaign::scaling::{self, Cost};
use crate::campaign::walls::{ASKED, Evidence, FROM, MeasuredWall};
use model_tables::model::choice::{LADDER, PARTS};
use std::fmt::Write as _;

/// Walls over the outer radius, and pole stretches less one, that the walls are sorted by: upper ends.
const WALLS: [(&str, f64); 3] = [
    ("< 0.03", 0.03),
    ("0.03 .. 0.08", 0.08),
    ("> 0.08", f64::INFINITY),
];
const STRETCHES: [(&str, f64); 4] = [
    ("unstretched", 0.0),
    ("< 1.1", 0.1),
    ("1.1 .. 1.3", 0.3),
    ("> 1.3", f64::INFINITY),
];

/// Half of the values, and nine of ten, are no larger; and the largest.
fn spread(values: impl Iterator<Item = f64>) -> Option<[f64; 3]> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let last = values.len().checked_sub(1)?;
    Some([values[last / 2], values[last * 9 / 10], values[last]])
}

/// In percent, to two digits.
fn percent(error: f64) -> String {
    if error.is_infinite() {
        return "no state".to_owned();
    }
    let digits = if error >= 0.1 {
        0
    } else if error >= 0.01 {
        1
    } else {
        2
    };
    format!("{:.digits$}", 100.0 * error)
}

fn evidence(wall: &MeasuredWall, place: usize) -> Option<&Evidence> {
    wall.fidelities[place].as_ref()
}

/// The larger relative error of force and pressure rise at one indentation.
fn error_at(wall: &MeasuredWall, place: usize, part: usize) -> Option<f64> {
    let truth = evidence(wall, LADDER.len() - 1)?.contacts.as_ref().ok()?;
    let found = evidence(wall, place)?.contacts.as_ref().ok()?;
    let (end, truth, found) = (truth.last()?, &truth[part], &found[part]);
    let of = |found: f64, truth: f64, full: f64| (found - truth).abs() / truth.abs().max(FROM * full);
    Some(of(found.force, truth.force, end.force).max(of(
        found.pressure_rise,
        truth.pressure_rise,
        end.pressure_rise,
    )))
}

pub(super) fn markdown(
    measured: &[&MeasuredWall],
    left_out: usize,
    scaling: &[Cost],
    scenes: &[ObjectScene],
) -> String {
    let refined = LADDER.len() - 1;
    let mut text = format!(
        "# Which model a wall needs\n\n\
         Written by `cargo designer ladder --designs {} --out DIR`, with every number in `ladder.csv`. Times are those of the machine \
         that wrote the page; a test recomputes the walls that the last table names. \
         Random walls: outer radius 5 to 12 mm, height 0.6 to 1.4 of the radius, wall 0.1 to 1.5 mm, three materials. One wall \
         in three is unstretched; the others are stretched by 1 % to 100 % at the pole and bonded there. *Error* is the larger \
         relative error of force and pressure rise against the {}, from 1 % of full scale on. It is found at eight indentations \
         up to 0.35 of the height",
        measured.len() + left_out,
        LADDER[refined]
    );
    let _ = match left_out {
        0 => writeln!(text, "."),
        some => writeln!(text, "; {some} walls have no such state there and are left out."),
    };
    text.push_str("\n![Error against time, and what auto takes](ladder.svg)\n");
    costs(&mut text, measured);
    by_elements(&mut text, scaling);
    let _ = writeln!(
        text,
        "\n## By wall and stretch\n\nMedian error of the membrane and of the solid 1 x 24, percent, with the number of walls.\n"
    );
    by_wall(&mut text, measured);
    let _ = writeln!(
        text,
        "\n## By indentation\n\nMedian error, percent, over every wall that has the model; of the membrane also by wall over radius.\n"
    );
    by_indentation(&mut text, measured);
    text.push_str(&objects::markdown(scenes));
    choices(&mut text, measured);
    text
}

fn costs(text: &mut String, measured: &[&MeasuredWall]) {
    text.push_str(
        "\n## Error and time\n\nTime is that of a state on one core of the machine that wrote the page, rest state included.\n\n\
         | model | walls | median error, % | nine of ten, % | largest, % | median time, ms |\n|---|---|---|---|---|---|\n",
    );
    let mut row = |name: &str, errors: Vec<f64>, time: Option<f64>| {
        if let Some([median, most, largest]) = spread(errors.iter().copied()) {
            let _ = writeln!(
                text,
                "| {name} | {} | {} | {} | {} | {} |",
                errors.len(),
                percent(median),
                percent(most),
                percent(largest),
                time.map_or_else(|| "-".to_owned(), |seconds| format!("{:.2}", 1e3 * seconds))
            );
        }
    };
    let closed = measured.iter().filter_map(|wall| wall.closed_form).collect();
    row("closed form of light contact", closed, None);
    for (place, kind) in LADDER.iter().enumerate() {
        let of = || measured.iter().filter_map(|wall| evidence(wall, place));
        let time = spread(of().map(|evidence| evidence.seconds)).map(|spread| spread[0]);
        row(
            &kind.to_string(),
            of().map(|evidence| evidence.error).collect(),
            time,
        );
    }
}

fn by_elements(text: &mut String, scaling: &[Cost]) {
    let _ = writeln!(
        text,
        "\n## By elements\n\nThe printed fingertip, 9 x 7 mm outside, wall 1 mm, unstretched, pressed in {} states {} mm apart, each from those before \
         it, on one core (`cargo bench -p compare` times the same). *Error* is the largest of force and pressure against \
         the last row.\n\n| through x along | a state, ms | Newton iterations a state | largest error, % |\n|---|---|---|---|",
        scaling::STATES,
        1e3 * scaling::STEP
    );
    for cost in scaling {
        let _ = writeln!(
            text,
            "| {} x {} | {:.2} | {:.1} | {} |",
            cost.elements.through,
            cost.elements.along,
            1e3 * cost.seconds,
            cost.iterations,
            percent(cost.error)
        );
    }
}

fn by_wall(text: &mut String, measured: &[&MeasuredWall]) {
    let _ = write!(text, "| pole stretch \\ wall over radius |");
    for (name, _) in WALLS {
        let _ = write!(text, " {name} |");
    }
    text.push_str("\n|---|---|---|---|\n");
    let below = |ends: &[f64], value: f64| ends.iter().position(|&end| value <= end);
    let (walls, stretches) = (WALLS.map(|x| x.1), STRETCHES.map(|x| x.1));
    for (row, (name, _)) in STRETCHES.iter().enumerate() {
        let _ = write!(text, "| {name} |");
        for column in 0..WALLS.len() {
            let here: Vec<&&MeasuredWall> = measured
                .iter()
                .filter(|wall| {
                    let outer = wall.case.design.membrane;
                    below(&walls, outer.thickness / outer.radial_semi_axis) == Some(column)
                        && below(&stretches, pre_stretch(wall)) == Some(row)
                })
                .collect();
            let median = |place: usize| {
                spread(here.iter().filter_map(|wall| Some(evidence(wall, place)?.error)))
                    .map_or_else(|| "-".to_owned(), |spread| percent(spread[0]))
            };
            let _ = write!(text, " {}, {} ({}) |", median(0), median(1), here.len());
        }
        text.push('\n');
    }
}

fn by_indentation(text: &mut String, measured: &[&MeasuredWall]) {
    text.push_str("| model \\ indentation over the deepest |");
    for part in PARTS {
        let _ = write!(text, " {part} |");
    }
    let _ = writeln!(text, "\n|---|{}", "---|".repeat(PARTS.len()));
    for (place, kind) in LADDER[..LADDER.len() - 1].iter().enumerate() {
        let _ = write!(text, "| {kind} |");
        for part in 0..PARTS.len() {
            let errors = measured.iter().filter_map(|wall| error_at(wall, place, part));
            let median = spread(errors).map_or_else(|| "-".to_owned(), |spread| percent(spread[0]));
            let _ = write!(text, " {median} |");
        }
        text.push('\n');
    }
    let mut above = 0.0;
    for (name, end) in WALLS {
        let _ = write!(text, "| membrane, wall {name} |");
        let here = measured.iter().filter(|wall| {
            let outer = wall.case.design.membrane;
            let wall = outer.thickness / outer.radial_semi_axis;
            wall > above && wall <= end
        });
        for part in 0..PARTS.len() {
            let errors = here.clone().filter_map(|wall| error_at(wall, 0, part));
            let median = spread(errors).map_or_else(|| "-".to_owned(), |spread| percent(spread[0]));
            let _ = write!(text, " {median} |");
        }
        text.push('\n');
        above = end;
    }
}

fn choices(text: &mut String, measured: &[&MeasuredWall]) {
    text.push_str(
        "\n## What `kind = \"auto\"` takes\n\n\
         `auto` takes the cheapest fidelity whose difference from the solid 2 x 60 is at most the allowed error less that \
         solid's own error. This own error is 0.6 %, or 1 % if the wall is thinner than 0.02 of the radius or pressed deeper \
         than 0.36 of the height. If there is none, `auto` takes the cheapest fidelity that is close enough to the refined \
         one. The table lists how many walls get which fidelity, and the largest error that was accepted, with the number of \
         its wall (`compare::campaign::walls::draw`):\n\n\
         | allowed, % |",
    );
    for kind in LADDER {
        let _ = write!(text, " {kind} |");
    }
    let _ = writeln!(
        text,
        " let through, % | wall |\n|---|{}---|---|",
        "---|".repeat(LADDER.len())
    );
    for asked in ASKED {
        let taken: Vec<_> = measured.iter().map(|wall| wall.take(asked)).collect();
        let _ = write!(text, "| {} |", percent(asked));
        for place in 0..LADDER.len() {
            let _ = write!(
                text,
                " {} |",
                taken.iter().filter(|taken| taken.fidelity == place).count()
            );
        }
        let worst = measured
            .iter()
            .zip(&taken)
            .max_by(|(_, a), (_, b)| a.error.total_cmp(&b.error));
        let _ = match worst {
            Some((wall, taken)) => writeln!(text, " {:.2} | {} |", 100.0 * taken.error, wall.case.index),
            None => writeln!(text, " - | - |"),
        };
    }
}
