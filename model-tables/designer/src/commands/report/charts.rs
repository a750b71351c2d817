//! The charts of a report: lines over linear axes, and speed against accuracy.

use super::cost::Cost;
use super::findings::{Findings, Meridian, TableReading};
use super::labels::{DEGREES, KPA, MM, NEWTON, STRETCH, TENSION, Unit};
use model_tables::model::state::{MeridianStation, Pressed};
use output::drawing::{
    self, Anchor, BLACK, BLUE, Drawing, GREEN, GREY, Marker, ORANGE, PURPLE, VERMILION, power,
};
use output::linear::{LinearAxis, LinearPanel};
use output::rows::plain;

pub(super) const SIZE: [f64; 2] = [420.0, 330.0];
pub(super) const LEFT: f64 = 64.0;
pub(super) const RIGHT: f64 = 404.0;
pub(super) const BOTTOM: f64 = 276.0;
pub(super) const TOP: f64 = 16.0;
/// Height of a line of the key.
pub(super) const LINE: f64 = 18.0;
/// One colour and marker a line.
const COLORS: [&str; 4] = [BLACK, BLUE, ORANGE, GREEN];
const MARKERS: [Marker; 4] = [Marker::Circle, Marker::Square, Marker::Diamond, Marker::Triangle];
/// Markers along a line.
const MARKED: usize = 6;

/// A line of a chart.
pub(super) struct Series {
    pub(super) label: String,
    pub(super) color: &'static str,
    /// Markers on the line, so that it is told from others without its colour; or alone.
    pub(super) marker: Option<Marker>,
    pub(super) line: bool,
    pub(super) points: Vec<[f64; 2]>,
}

/// An axis in words: what, and its unit.
struct Named(&'static str, Unit);

impl Named {
    fn label(&self) -> String {
        format!("{} / {}", self.0, self.1.name)
    }
}

fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let [least, largest] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], value| {
        [a.min(value), b.max(value)]
    });
    if largest > least {
        [least, largest]
    } else {
        [least.min(0.0), largest.max(1.0)]
    }
}

/// Lines over two axes in their units; the upward axis begins at zero if it is told to.
fn lines(title: &str, [x, y]: [Named; 2], from_zero: bool, series: &[Series]) -> String {
    let keyed: Vec<&Series> = series.iter().filter(|series| !series.label.is_empty()).collect();
    let top = TOP + LINE * keyed.len() as f64;
    let all = |place: usize| {
        series
            .iter()
            .flat_map(move |series| series.points.iter().map(move |p| p[place]))
    };
    let [low, high] = range(all(1).map(|value| y.1.per_si * value));
    let panel = LinearPanel {
        x: if x.1.name == DEGREES.name {
            LinearAxis::quarter_turn([LEFT, RIGHT])
        } else {
            LinearAxis::from_zero(range(all(0).map(|value| x.1.per_si * value))[1], [LEFT, RIGHT])
        },
        y: if from_zero {
            LinearAxis::from_zero(high, [BOTTOM, top])
        } else {
            LinearAxis::over([low, high], [BOTTOM, top])
        },
    };
    let described: Vec<String> = series
        .iter()
        .filter_map(|series| {
            let ([x0, y0], [x1, y1]) = (*series.points.first()?, *series.points.last()?);
            let label = if series.label.is_empty() {
                y.0
            } else {
                &series.label
            };
            Some(format!(
                "{label}: from {} at {} to {} at {}",
                y.1.text(y0),
                x.1.text(x0),
                y.1.text(y1),
                x.1.text(x1)
            ))
        })
        .collect();
    let mut drawing = Drawing::inline(SIZE, title, &described.join("; "));
    panel.draw(&mut drawing);
    drawing.text(
        [0.5 * (LEFT + RIGHT), 316.0],
        Anchor::Middle,
        13.0,
        BLACK,
        &x.label(),
    );
    drawing.upward([16.0, 0.5 * (BOTTOM + top)], 13.0, &y.label());
    for series in series {
        let points: Vec<[f64; 2]> = series
            .points
            .iter()
            .map(|[a, b]| panel.at([x.1.per_si * a, y.1.per_si * b]))
            .collect();
        if series.line {
            drawing.path(&points, series.color, 2.2);
        }
        if let Some(marker) = series.marker {
            let every = if series.line {
                points.len().div_ceil(MARKED)
            } else {
                1
            };
            for at in points.iter().step_by(every.max(1)) {
                drawing.marker(marker, *at, series.color, true);
            }
        }
    }
    for (i, series) in keyed.iter().enumerate() {
        let y = TOP + LINE * i as f64 - 2.0;
        if series.line {
            drawing.line([LEFT + 4.0, y], [LEFT + 32.0, y], series.color, 2.2);
        }
        if let Some(marker) = series.marker {
            drawing.marker(marker, [LEFT + 18.0, y], series.color, true);
        }
        drawing.text([LEFT + 42.0, y + 4.5], Anchor::Start, 13.0, BLACK, &series.label);
    }
    drawing.finish()
}

fn model(found: &Findings, points: impl Fn(&Pressed) -> [f64; 2]) -> Series {
    Series {
        label: String::new(),
        color: BLUE,
        marker: None,
        line: true,
        points: found.states.iter().map(points).collect(),
    }
}

/// What the transducer reads of a rise.
fn rise(found: &Findings, state: &Pressed) -> f64 {
    found.file.calibration.pressure_gain * state.pressure_rise
}

/// Force over the indentation.
pub(super) fn force(found: &Findings) -> String {
    let axes = [Named("indentation", MM), Named("force", NEWTON)];
    let series = model(found, |state| [state.indentation, state.force]);
    lines("Force against indentation", axes, true, &[series])
}

/// A line by a name, in SI units.
pub(super) struct Labelled {
    pub(super) label: String,
    pub(super) points: Vec<[f64; 2]>,
}

/// Forces over the indentation.
pub(super) fn labelled_forces(title: &str, forces: &[Labelled]) -> String {
    let series: Vec<Series> = forces
        .iter()
        .enumerate()
        .map(|(i, line)| Series {
            label: line.label.clone(),
            color: COLORS[i % COLORS.len()],
            marker: Some(MARKERS[i % MARKERS.len()]),
            line: true,
            points: line.points.clone(),
        })
        .collect();
    lines(
        title,
        [Named("indentation", MM), Named("force", NEWTON)],
        true,
        &series,
    )
}

/// Feedback force over touch force.
pub(super) fn feedback(line: Labelled) -> String {
    let axes = [Named("touch force", NEWTON), Named("feedback force", NEWTON)];
    let series = Series {
        label: line.label,
        color: BLUE,
        marker: None,
        line: true,
        points: line.points,
    };
    lines("Feedback force against touch force", axes, true, &[series])
}

/// Pressure rise over the indentation.
pub(super) fn pressure(found: &Findings) -> String {
    let axes = [Named("indentation", MM), Named("pressure rise", KPA)];
    let series = model(found, |state| [state.indentation, rise(found, state)]);
    lines("Pressure rise against indentation", axes, true, &[series])
}

/// Contact radius over the indentation.
pub(super) fn contact(found: &Findings) -> String {
    let axes = [Named("indentation", MM), Named("contact radius", MM)];
    let series = model(found, |state| [state.indentation, state.contact_radius]);
    lines("Contact radius against indentation", axes, true, &[series])
}

/// What the model gives over the pressure rise and, where there are tables, what they say.
fn known(
    found: &Findings,
    of_model: fn(&Pressed) -> f64,
    of_tables: fn(&TableReading) -> f64,
) -> Vec<Series> {
    let mut series = model(found, |state| [rise(found, state), of_model(state)]);
    if found.table_readings.is_empty() {
        return vec![series];
    }
    "model".clone_into(&mut series.label);
    let readings = found.table_readings.iter().step_by(3);
    let tables = Series {
        label: "tables on the chip".to_owned(),
        color: VERMILION,
        marker: Some(Marker::Circle),
        line: false,
        points: readings
            .map(|reading| [reading.pressure_rise, of_tables(reading)])
            .collect(),
    };
    vec![series, tables]
}

/// Force over the pressure rise.
pub(super) fn readout(found: &Findings) -> String {
    let axes = [Named("pressure rise", KPA), Named("force", NEWTON)];
    let series = known(found, |state| state.force, |reading| reading.force);
    lines("Force against pressure rise", axes, true, &series)
}

/// Indentation over the pressure rise: the other table.
pub(super) fn depth(found: &Findings) -> String {
    let axes = [Named("pressure rise", KPA), Named("indentation", MM)];
    let series = known(found, |state| state.indentation, |reading| reading.indentation);
    lines("Indentation against pressure rise", axes, true, &series)
}

/// A quantity along the meridian, a line a state.
fn along(found: &Findings, title: &str, upward: Named, of: fn(&MeridianStation) -> f64) -> String {
    let series: Vec<Series> = found
        .meridians
        .iter()
        .zip(COLORS.into_iter().zip(MARKERS))
        .map(
            |(
                Meridian {
                    indentation, points, ..
                },
                (color, marker),
            )| Series {
                label: if *indentation > 0.0 {
                    format!("indentation {}", MM.text(*indentation))
                } else {
                    "at rest".to_owned()
                },
                color,
                marker: Some(marker),
                line: true,
                points: points.iter().map(|point| [point.parameter, of(point)]).collect(),
            },
        )
        .collect();
    lines(title, [Named("from the pole", DEGREES), upward], false, &series)
}

/// Stretches and tensions along the meridian.
pub(super) fn meridians(found: &Findings) -> [String; 4] {
    [
        along(
            found,
            "Stretch along the meridian",
            Named("meridional stretch", STRETCH),
            |p| p.stretches[0],
        ),
        along(found, "Stretch around", Named("hoop stretch", STRETCH), |p| {
            p.stretches[1]
        }),
        along(
            found,
            "Tension along the meridian",
            Named("meridional tension", TENSION),
            |p| p.tensions[0],
        ),
        along(found, "Tension around", Named("hoop tension", TENSION), |p| {
            p.tensions[1]
        }),
    ]
}

/// Blocked force of the actuator over its pressure.
pub(super) fn actuator(found: &Findings) -> String {
    let series = Series {
        label: String::new(),
        color: PURPLE,
        marker: None,
        line: true,
        points: found
            .actuator
            .iter()
            .map(|(pressure, blocked)| [*pressure, blocked.blocked_force])
            .collect(),
    };
    let axes = [Named("pressure", KPA), Named("blocked force", NEWTON)];
    lines("Blocked force of the actuator", axes, true, &[series])
}

/// Least error that the chart shows, percent.
const MIN_ERROR: f64 = 1e-10;

/// Width of a letter of a label, pixels.
const LETTER: f64 = 7.0;

/// Where the label of a marker begins: the nearest place in the panel that touches nothing in `taken` (left, top, right, bottom), which then
/// holds it too.
fn beside([x, y]: [f64; 2], width: f64, taken: &mut Vec<[f64; 4]>) -> [f64; 2] {
    let mut places = (0..16).flat_map(|step| {
        let away = 7.5 * f64::from(step);
        [
            [x + 9.0, y - away],
            [x - 9.0 - width, y - away],
            [x + 9.0, y + away],
            [x - 9.0 - width, y + away],
        ]
    });
    let held = |[left, middle]: [f64; 2]| [left, middle - 7.0, left + width, middle + 7.0];
    let is_free = |place: &[f64; 2]| {
        let [left, top, right, bottom] = held(*place);
        let is_inside = left > LEFT && right < RIGHT && top > TOP && bottom < BOTTOM;
        is_inside
            && taken
                .iter()
                .all(|other| right < other[0] || left > other[2] || bottom < other[1] || top > other[3])
    };
    let place = places.find(is_free).unwrap_or([x + 9.0, y]);
    taken.push(held(place));
    [place[0], place[1] + 4.0]
}

/// Speed against accuracy of the models.
pub(super) fn speed(costs: &[Cost]) -> Option<String> {
    let shown: Vec<(&Cost, [f64; 2])> = costs
        .iter()
        .filter_map(|cost| {
            let percent = (100.0 * cost.distance?).max(MIN_ERROR);
            Some((cost, [percent, 1e3 * cost.seconds]))
        })
        .collect();
    let decades = |place: usize| -> Option<[i32; 2]> {
        let [least, largest] = shown
            .iter()
            .map(|(_, at)| libm::log10(at[place]))
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], value| {
                [a.min(value), b.max(value)]
            });
        let first = libm::floor(least - 0.2);
        (least.is_finite() && largest.is_finite())
            .then(|| [first as i32, libm::ceil(largest + 0.2).max(first + 1.0) as i32])
    };
    let panel = drawing::Panel {
        x: drawing::Axis {
            decades: decades(0)?.map(f64::from),
            pixels: [LEFT, RIGHT],
        },
        y: drawing::Axis {
            decades: decades(1)?.map(f64::from),
            pixels: [BOTTOM, TOP],
        },
    };
    let words: Vec<String> = shown
        .iter()
        .map(|(cost, [error, time])| {
            format!(
                "{}: {} %, {} ms a state",
                cost.model,
                plain(*error, 2),
                plain(*time, 2)
            )
        })
        .collect();
    let mut drawing = Drawing::inline(
        SIZE,
        "Time of a state against the error of the model",
        &words.join("; "),
    );
    let step = |[first, last]: [f64; 2]| 1 + (last - first) as usize / 6;
    let steps = [step(panel.x.decades), step(panel.y.decades)];
    panel.draw(&mut drawing, steps, [&power, &power]);
    let places: Vec<[f64; 2]> = shown.iter().map(|(_, at)| panel.at(*at)).collect();
    let mut taken: Vec<[f64; 4]> = places
        .iter()
        .map(|[x, y]| [x - 6.0, y - 6.0, x + 6.0, y + 6.0])
        .collect();
    for ((cost, _), at) in shown.iter().zip(places) {
        let color = if cost.used { BLUE } else { GREY };
        drawing.marker(Marker::Circle, at, color, !cost.used);
        let label = if cost.used {
            format!("{} (here)", cost.model)
        } else {
            cost.model.clone()
        };
        let place = beside(at, LETTER * label.chars().count() as f64, &mut taken);
        drawing.text(place, Anchor::Start, 12.0, BLACK, &label);
    }
    drawing.text(
        [0.5 * (LEFT + RIGHT), 316.0],
        Anchor::Middle,
        13.0,
        BLACK,
        "largest error / %",
    );
    drawing.upward([16.0, 0.5 * (BOTTOM + TOP)], 13.0, "time of a state / ms");
    Some(drawing.finish())
}
