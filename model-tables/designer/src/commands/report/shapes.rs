//! Pressed shapes: sections through the axis, wall and all, to one scale.

use super::findings::{Findings, Meridian};
use super::labels::{MM, NEWTON};
use model_tables::model::state::MeridianStation;
use output::drawing::{Anchor, BLACK, BLUE, Drawing, GREY, VERMILION};

const WIDTH: f64 = 300.0;
/// From the axis to the widest place of any state, pixels.
const HALF: f64 = 128.0;
/// Room for the tallest state.
const TALLEST: f64 = 172.0;
/// Room below the base for the scale.
const BELOW: f64 = 42.0;
/// Thickness of plate and base, pixels.
const SLAB: f64 = 7.0;
const FLUID: &str = "#d6ebf7";
/// Lengths that a scale bar may have, millimetres.
const BARS: [f64; 10] = [0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0];

/// A picture a state.
pub(super) fn draw(found: &Findings) -> Vec<String> {
    let outer = || {
        found.meridians.iter().flat_map(|meridian| {
            meridian
                .points
                .iter()
                .map(|point| surface(point, 0.5 * meridian.wall))
        })
    };
    let widest = outer().map(|[r, _]| r).fold(0.0, f64::max);
    let tallest = outer().map(|[_, z]| z).fold(0.0, f64::max);
    let scale = (HALF / widest).min(TALLEST / tallest);
    let base = scale * tallest + SLAB + 4.0;
    found
        .meridians
        .iter()
        .map(|meridian| one(meridian, scale, base))
        .collect()
}

/// A point of the wall that was `outside` of its middle, metres.
fn surface(point: &MeridianStation, outside: f64) -> [f64; 2] {
    let shift = outside * point.thickness_stretch;
    [
        point.radius + shift * libm::sin(point.angle),
        point.height + shift * libm::cos(point.angle),
    ]
}

/// A state; its base lies at `base`.
fn one(meridian: &Meridian, scale: f64, base: f64) -> String {
    let centre = 0.5 * WIDTH;
    let title = if meridian.indentation > 0.0 {
        format!("Section, pressed by {}", MM.text(meridian.indentation))
    } else {
        "Section at rest".to_owned()
    };
    let edge = meridian
        .points
        .iter()
        .filter(|point| point.in_contact && meridian.indentation > 0.0)
        .map(|point| point.radius)
        .fold(0.0, f64::max);
    let description = format!(
        "Half-ellipsoid dome on its base under a flat plate, to scale; force {}, contact radius {}",
        NEWTON.text(meridian.force),
        MM.text(edge)
    );
    let mut drawing = Drawing::inline([WIDTH, base + BELOW], &title, &description);
    // Both halves: from the left rim over the pole to the right, cut off at the base.
    let all = |part: f64| -> Vec<[f64; 2]> {
        let at = |side: f64, point: &MeridianStation| {
            let [r, z] = surface(point, part * meridian.wall);
            [centre + side * scale * r, base - scale * z.max(0.0)]
        };
        let left = meridian.points.iter().rev().map(|point| at(-1.0, point));
        let right = meridian.points.iter().skip(1).map(|point| at(1.0, point));
        let mut points: Vec<[f64; 2]> = left.chain(right).collect();
        if let (Some(first), Some(last)) = (points.first().copied(), points.last().copied()) {
            points.insert(0, [first[0], base]);
            points.push([last[0], base]);
        }
        points
    };
    let (inside, outside) = (all(-0.5), all(0.5));
    drawing.polygon(&inside, FLUID);
    let wall: Vec<[f64; 2]> = outside
        .iter()
        .copied()
        .chain(inside.iter().rev().copied())
        .collect();
    drawing.polygon(&wall, BLUE);
    let top = outside.iter().map(|[_, y]| *y).fold(base, f64::min);
    drawing.area(
        [centre - HALF - 12.0, top - SLAB],
        [2.0 * (HALF + 12.0), SLAB],
        GREY,
    );
    drawing.area([centre - HALF - 12.0, base], [2.0 * (HALF + 12.0), SLAB], GREY);
    scale_bar(&mut drawing, scale, base);
    drawing.finish()
}

/// Fingertip and actuator in one state: the tip's meridian and wall above, the disc's inner and outer faces below from its own base, metres; and the
/// height of what is over the disc.
pub(super) fn both_ends(
    description: &str,
    (tip, wall): (&[MeridianStation], f64),
    [inner, outer]: &[Vec<[f64; 2]>; 2],
    over: Option<f64>,
    on_skin: bool,
) -> String {
    let faces = [-0.5, 0.5].map(|part| {
        tip.iter()
            .map(|point| surface(point, part * wall))
            .collect::<Vec<_>>()
    });
    let all = || faces.iter().flatten().chain(inner).chain(outer);
    let widest = all().map(|[r, _]| *r).fold(0.0, f64::max);
    let tallest = |faces: &[Vec<[f64; 2]>]| faces.iter().flatten().map(|[_, z]| *z).fold(0.0, f64::max);
    let scale = (HALF / widest).min(TALLEST / tallest(&faces));
    let discs = [inner.clone(), outer.clone()];
    let lifted = scale * tallest(&discs).max(over.unwrap_or(0.0));
    let tip_base = scale * tallest(&faces) + SLAB + 4.0;
    // The disc's frame is the base of the picture's lower half; what is over it has room above.
    let disc_base = tip_base + SLAB + 26.0 + SLAB + lifted;
    let mut drawing = Drawing::inline(
        [WIDTH, disc_base + SLAB + BELOW],
        "Fingertip and actuator, pressed",
        description,
    );
    let centre = 0.5 * WIDTH;
    let mirrored = |face: &[[f64; 2]], base: f64| -> Vec<[f64; 2]> {
        let at = |side: f64, [r, z]: &[f64; 2]| [centre + side * scale * r, base - scale * z];
        let left = face.iter().rev().map(|point| at(-1.0, point));
        left.chain(face.iter().skip(1).map(|point| at(1.0, point)))
            .collect()
    };
    let slab = [2.0 * (HALF + 12.0), SLAB];
    for (faces, base) in [([&faces[0], &faces[1]], tip_base), ([inner, outer], disc_base)] {
        let [inside, outside] = faces.map(|face| mirrored(face, base));
        let mut fluid = inside.clone();
        if let (Some(first), Some(last)) = (inside.first(), inside.last()) {
            fluid.push([last[0], base]);
            fluid.insert(0, [first[0], base]);
        }
        drawing.polygon(&fluid, FLUID);
        let wall: Vec<[f64; 2]> = outside.iter().chain(inside.iter().rev()).copied().collect();
        drawing.polygon(&wall, BLUE);
        drawing.area([centre - HALF - 12.0, base], slab, GREY);
    }
    let top = mirrored(&faces[1], tip_base)
        .iter()
        .map(|[_, y]| *y)
        .fold(tip_base, f64::min);
    drawing.area([centre - HALF - 12.0, top - SLAB], slab, GREY);
    if let Some(over) = over {
        // Skin lies on the disc where that has come to it, and is drawn as a line.
        let y = disc_base - scale * over;
        if on_skin {
            drawing.line([centre - HALF, y], [centre + HALF, y], VERMILION, 1.5);
        } else {
            drawing.area([centre - HALF - 12.0, y - SLAB], slab, GREY);
        }
    }
    scale_bar(&mut drawing, scale, disc_base + SLAB);
    drawing.finish()
}

/// A bar of a round length under a base.
fn scale_bar(drawing: &mut Drawing, scale: f64, base: f64) {
    let centre = 0.5 * WIDTH;
    let room = 0.6 * HALF;
    let bar = BARS
        .into_iter()
        .rev()
        .find(|bar| bar * 1e-3 * scale <= room)
        .unwrap_or(BARS[0]);
    let [from, to] = [centre - HALF - 12.0, centre - HALF - 12.0 + bar * 1e-3 * scale];
    drawing.line([from, base + 28.0], [to, base + 28.0], BLACK, 2.0);
    for x in [from, to] {
        drawing.line([x, base + 23.0], [x, base + 33.0], BLACK, 2.0);
    }
    drawing.text(
        [to + 8.0, base + 32.5],
        Anchor::Start,
        13.0,
        BLACK,
        &format!("{bar} mm"),
    );
}
