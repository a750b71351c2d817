//! The page and the chart of blends.

use super::{BlendWay, DOMES, DomeBlends, SMALLEST, WAYS};
use output::drawing::{
    Anchor, Axis, BLACK, BLUE, Drawing, GREEN, GREY, ORANGE, PURPLE, Panel, VERMILION, power, spread,
};
use std::fmt::Write as _;

/// Name of the chart beside the page.
pub const CHART: &str = "objects.svg";
const COLORS: [&str; WAYS.len()] = [GREY, ORANGE, PURPLE, VERMILION, "#8c564b", GREEN, BLUE, BLACK];

/// The rows of the first table: the ways on one dome.
pub fn ways(dome: &DomeBlends) -> String {
    let mut text = String::from(
        "| way | tables | bytes | instructions a report | F, % | H, % | F, % of 3 mm | H, % of 3 mm |\n|---|---|---|---|---|---|---|---|\n",
    );
    for way in WAYS {
        let (worst, _) = dome.worst(way);
        let small = dome.smaller(way).map_or_else(
            || "- | -".to_owned(),
            |error| format!("{:.1} | {:.1}", error.percent[0], error.percent[1]),
        );
        let powers = if way == BlendWay::LogarithmsOfTables {
            " and two powers"
        } else {
            ""
        };
        let _ = writeln!(
            text,
            "| {way} | {} | {} | {}{powers} | {:.1} | {:.1} | {small} |",
            way.tables(),
            way.tables() * dome.bytes + way.constants(),
            way.lookups() * dome.instructions,
            worst.percent[0],
            worst.percent[1]
        );
    }
    text
}

/// The row of a dome in the second table.
pub fn row(dome: &DomeBlends) -> String {
    let (worst, radii) = dome.worst(BlendWay::TwoWeights);
    let others = [BlendWay::OneWeight, BlendWay::TwoBalls].map(|way| dome.worst(way).0.largest());
    let place = |i: usize| format!("{} mm, {:.1} kPa", radii[i], 1e-3 * worst.at[i]);
    format!(
        "| {} | {:.1} | {:.2} | {} | {:.2} | {} | {:.1} | {:.1} |\n",
        dome.name,
        dome.reference_mm,
        worst.percent[0],
        place(0),
        worst.percent[1],
        place(1),
        others[0],
        others[1]
    )
}

/// The page; `costs` are the rows of what states cost.
pub fn markdown(domes: &[DomeBlends], costs: &str) -> String {
    let mut text = format!(
        "# Objects: blends of tables, and what they cost\n\n\
         Written by `cargo campaign blends --out DIR`; a test computes parts of it again. The chip has the tables of a flat plate and of \
         one reference ball. When a host sends the radius of another ball, the chip blends the two sets of coefficients once, with a \
         weight for the force and one for the indentation. This page compares this blend with other ways, and lists its error on \
         other domes. Errors are the largest over balls of {SMALLEST} to 50 mm radius to which no law is fitted, from 0.7 kPa to a depth of \
         0.35 of the height, in percent of the truth. The truth is the design's own press onto the ball (solid 2 x 60).\n\n\
         ## Ways to read a ball\n\n\
         The dome is {}. `Rd` is the radius of curvature of its pole, `h` its wall, `q(R) = 1 + Rd / (R + 2 h)`. The scaled plate has \
         powers of `q` that fit the reference ball. The nearest of three tables and the parabola also have a second ball, of half of the \
         curvature. Bytes are those of tables and constants. A way that is linear in the coefficients is blended once, when the object \
         changes; the logarithms are not linear, and cost two lookups and two powers in each report. Instructions of a lookup are computed \
         from its structure.\n\n![Error of each way over the radius of the ball]({CHART})\n\n",
        DOMES[0].0
    );
    if let Some(dome) = domes.first() {
        text.push_str(&ways(dome));
    }
    text.push_str(
        "\n## The chip's blend on other domes\n\n*At* is the ball and the pressure of the largest error. The last two columns are the larger \
         error of force and indentation of two other ways.\n\n\
         | outer semi-axes and wall, mm | reference ball, mm | F, % | at | H, % | at | one weight, ln q, % | parabola, % |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    for dome in domes {
        text.push_str(&row(dome));
    }
    text.push_str(
        "\n## What a state costs\n\nPlate and balls are pressed to the same 25 depths down to the design's largest indentation, in turn, in one \
         process (`cargo campaign cost` prints the same). The time is CPU time; of 15 sweeps the fastest counts. A membrane factors its \
         equations in each Newton iteration.\n\n",
    );
    text.push_str(costs);
    text
}

const LEFT: f64 = 80.0;
const TOP: f64 = 70.0;
const SIZE: [f64; 2] = [460.0, 380.0];
/// Radii that the axis names, millimetres.
const NAMED: [f64; 6] = [3.0, 5.0, 10.0, 20.0, 30.0, 50.0];

/// The larger error of force and indentation of each way over the radius, of one dome.
pub fn svg(dome: &DomeBlends) -> String {
    let mut drawing = Drawing::new(LEFT + SIZE[0] + 260.0, TOP + SIZE[1] + 60.0);
    let title = format!("Ways to read a ball: {}", dome.name);
    drawing.text([LEFT, 28.0], Anchor::Start, 18.0, BLACK, &title);
    let line = "The larger error of force and indentation from 0.7 kPa on, percent.";
    drawing.text([LEFT, 48.0], Anchor::Start, 13.0, GREY, line);
    let panel = Panel {
        x: Axis {
            decades: [libm::log10(2.8), libm::log10(55.0)],
            pixels: [LEFT, LEFT + SIZE[0]],
        },
        y: Axis {
            decades: [-1.0, 2.0],
            pixels: [TOP + SIZE[1], TOP],
        },
    };
    panel.draw(&mut drawing, [1, 1], [&|_| String::new(), &power]);
    let bottom = TOP + SIZE[1];
    for radius in NAMED {
        let at = [panel.x.at(radius), bottom + 17.0];
        drawing.text(at, Anchor::Middle, 12.0, BLACK, &radius.to_string());
    }
    let middle = [LEFT + 0.5 * SIZE[0], bottom + 38.0];
    drawing.text(middle, Anchor::Middle, 13.0, BLACK, "radius of the ball / mm");
    drawing.upward([LEFT - 46.0, TOP + 0.5 * SIZE[1]], 13.0, "largest error / %");
    let ends: Vec<[f64; 2]> = (0..WAYS.len())
        .map(|way| {
            let points: Vec<[f64; 2]> = dome
                .balls
                .iter()
                .map(|(radius, errors)| panel.at([*radius, errors[way].largest()]))
                .collect();
            drawing.path(&points, COLORS[way], 1.8);
            points.last().copied().unwrap_or([LEFT + SIZE[0], bottom])
        })
        .collect();
    let mut heights: Vec<f64> = ends.iter().map(|end| end[1] + 4.0).collect();
    spread(&mut heights, 16.0, [TOP + 8.0, bottom]);
    for ((way, color), (end, y)) in WAYS.iter().zip(COLORS).zip(ends.iter().zip(heights)) {
        let x = LEFT + SIZE[0] + 10.0;
        drawing.line([end[0] + 2.0, end[1]], [x - 2.0, y - 4.0], color, 0.6);
        drawing.text([x, y], Anchor::Start, 12.0, color, &way.to_string());
    }
    drawing.finish()
}
