//! The chart of a run: pressure, force and indentation over time with the truth behind the reports, and the
//! errors below.

use crate::accuracy::{force_error, indentation_error};
use crate::record::Row;
use fingertip::status::{Fault, Status};
use model_tables::curve::{Contact, Curve};
use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::{
    BLACK, Cartesian2d, ChartBuilder, ChartContext, Color, DrawingArea, IntoDrawingArea, IntoFont,
    LineSeries, Polygon, RGBAColor, RGBColor, Rectangle, SVGBackend, Text, WHITE,
};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::fmt;

/// Width and height in pixels.
/// A page or a phone shows it 400 pixels wide: letters are then 11 pixels high.
const SIZE: (u32, u32) = (720, 1560);
/// More of it for a panel of the feedback force, pixels.
const MORE: u32 = 340;
/// Left of the panels, pixels.
const MARGIN: u32 = 14;
/// Left of the data, pixels.
const LABELS: u32 = 104;
/// Heights of letters, pixels: title, subtitle, and everything else.
const TITLE: u32 = 26;
const SUBTITLE: u32 = 20;
const LETTERS: u32 = 20;
/// Width of a letter over its height, about: the font's true width is the viewer's business.
const WIDTH_OF_LETTER: f64 = 0.53;
/// Height of a line of the key, pixels.
const KEY_LINE: i32 = 28;
/// More points than this are thinned out: the eye sees no more.
const POINTS: usize = 1500;
/// Gap that ends a line, seconds.
const GAP: f64 = 0.02;

// Colours that the colour-blind tell apart (Okabe and Ito 2008).
const TRUTH: RGBColor = RGBColor(150, 150, 150);
const REPORT: RGBColor = RGBColor(0, 114, 178);
const SECOND: RGBColor = RGBColor(213, 94, 0);
const FAULT: RGBColor = RGBColor(204, 121, 167);
/// Before the first zero: nothing is wrong.
const ZEROING: RGBColor = RGBColor(120, 150, 180);
const WARNING: RGBColor = RGBColor(230, 159, 0);
/// Opacity of the shades behind the data.
const SHADE: f64 = 0.28;
const BAND_SHADE: f64 = 0.09;

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Panel<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// What stands over the chart and how its scales are set.
#[derive(Clone, Debug)]
pub struct Caption {
    /// The first line.
    pub title: String,
    /// The second line.
    pub subtitle: String,
    /// The contact at the end of the range: errors are shown from 5 % of it up.
    pub full_scale: Contact,
    /// Tables of the settled wall on a plate, shown beside the report; `None`: not shown.
    pub static_tables: Option<Curve>,
    /// What the truth is: see [`crate::fingertip_design::RunTruth::words`].
    pub truth: &'static str,
    /// Largest error that the median may have, percent of reading: the band in the lowest panel.
    pub target_percent: f64,
}

/// The drawing failed.
#[derive(Debug)]
pub struct ChartError(String);

impl fmt::Display for ChartError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "cannot draw the chart: {}", self.0)
    }
}

impl std::error::Error for ChartError {}

fn drawing(error: impl fmt::Display) -> ChartError {
    ChartError(error.to_string())
}

/// One of the upper panels.
struct Quantity {
    label: &'static str,
    /// Truth and report of a row.
    of: fn(&Row) -> [Option<f64>; 2],
    /// It of a contact of the static tables, where they have it.
    of_static: Option<fn(&Contact) -> f64>,
}

/// A quantity of the contact, true and reported.
fn pair(row: &Row, of: fn(&Contact) -> f64) -> [Option<f64>; 2] {
    [Some(of(&row.truth)), row.reported.as_ref().map(of)]
}

const QUANTITIES: [Quantity; 3] = [
    Quantity {
        label: "pressure rise / kPa",
        of: |row| pair(row, |contact| contact.pressure_rise * 1e-3),
        of_static: None,
    },
    Quantity {
        label: "force / N",
        of: |row| pair(row, |contact| contact.force),
        of_static: Some(|contact| contact.force),
    },
    Quantity {
        label: "indentation / mm",
        of: |row| pair(row, |contact| contact.indentation * 1e3),
        of_static: Some(|contact| contact.indentation * 1e3),
    },
];
/// Where there is an actuator.
const FEEDBACK: Quantity = Quantity {
    label: "feedback force / N",
    of: |row| [row.feedback.truth, row.feedback.reported],
    of_static: None,
};

/// The chart as SVG.
///
/// # Errors
/// [`ChartError`] when there is nothing to draw or the drawing fails.
pub fn svg(rows: &[Row], caption: &Caption) -> Result<String, ChartError> {
    let mut text = String::new();
    {
        let more = if feels(rows) { MORE } else { 0 };
        let root = SVGBackend::with_string(&mut text, (SIZE.0, SIZE.1 + more)).into_drawing_area();
        root.fill(&WHITE).map_err(drawing)?;
        draw(&root, rows, caption)?;
        root.present().map_err(drawing)?;
    }
    Ok(text)
}

/// Whether there is an actuator.
fn feels(rows: &[Row]) -> bool {
    rows.iter().any(|row| row.feedback.truth.is_some())
}

fn draw(root: &Area<'_>, rows: &[Row], caption: &Caption) -> Result<(), ChartError> {
    let (Some(first), Some(last)) = (rows.first(), rows.last()) else {
        return Err(drawing("the firmware sent no report"));
    };
    let time = first.time..last.time;
    let (head, body) = root.split_vertically(heading_height(caption));
    heading(&head, caption)?;
    let feedback = if feels(rows) { &[FEEDBACK][..] } else { &[] };
    let quantities: Vec<&Quantity> = QUANTITIES.iter().chain(feedback).collect();
    let panels = body.split_evenly((quantities.len() + 1, 1));
    let spells = spells(rows);
    for (quantity, area) in quantities.iter().zip(&panels) {
        let beside = |row: &Row| -> Option<f64> {
            let (tables, of) = (caption.static_tables.as_ref()?, quantity.of_static?);
            Some(of(&tables.at_pressure_rise(row.reported?.pressure_rise)))
        };
        let values = rows
            .iter()
            .flat_map(quantity.of)
            .chain(rows.iter().map(beside))
            .flatten();
        let (low, top) = values.fold((0.0_f64, f64::MIN_POSITIVE), |(low, top), value| {
            (low.min(value), top.max(value))
        });
        let scale = low - 0.04 * (top - low)..top + 0.08 * (top - low);
        let mut panel = panel(area, quantity.label, time.clone(), scale.clone(), "")?;
        shade(&mut panel, &spells, scale)?;
        line(
            &mut panel,
            thinned(rows).map(|row| (row.time, beside(row))),
            SECOND,
        )?;
        let truth: Vec<(f64, f64)> = thinned(rows)
            .filter_map(|row| Some((row.time, (quantity.of)(row)[0]?)))
            .collect();
        let wide = TRUTH.stroke_width(6);
        panel.draw_series(LineSeries::new(truth, wide)).map_err(drawing)?;
        let points = thinned(rows).map(|row| (row.time, (quantity.of)(row)[1]));
        line(&mut panel, points, REPORT)?;
    }
    errors(&panels[quantities.len()], rows, caption, time, &spells)
}

/// A text in lines that fit beside the margin, in letters of that height.
fn wrapped(text: &str, letters: u32) -> Vec<String> {
    let most = (f64::from(SIZE.0 - 2 * MARGIN) / (WIDTH_OF_LETTER * f64::from(letters))) as usize;
    let mut lines: Vec<String> = vec![];
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= most => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// Lines of title, subtitle and key, with their room.
fn heading_height(caption: &Caption) -> u32 {
    let title = wrapped(&caption.title, TITLE).len() as u32 * (TITLE + 8);
    let subtitle = wrapped(&caption.subtitle, SUBTITLE).len() as u32 * (SUBTITLE + 6);
    title + subtitle + 3 * KEY_LINE as u32 + 20
}

fn heading(area: &Area<'_>, caption: &Caption) -> Result<(), ChartError> {
    let title = ("sans-serif", TITLE).into_font().color(&BLACK);
    let subtitle = ("sans-serif", SUBTITLE).into_font().color(&RGBColor(70, 70, 70));
    let mut y = 14;
    for line in wrapped(&caption.title, TITLE) {
        area.draw(&Text::new(line, (MARGIN as i32, y), title.clone()))
            .map_err(drawing)?;
        y += TITLE as i32 + 8;
    }
    for line in wrapped(&caption.subtitle, SUBTITLE) {
        area.draw(&Text::new(line, (MARGIN as i32, y), subtitle.clone()))
            .map_err(drawing)?;
        y += SUBTITLE as i32 + 6;
    }
    let truth = format!("truth: {}", caption.truth);
    let mut entries = vec![
        Entry::line(&truth, TRUTH, 6),
        Entry::line("reported by the firmware", REPORT, 3),
        Entry::area("zeroing", ZEROING.mix(SHADE)),
        Entry::area("warning", WARNING.mix(SHADE)),
        Entry::area("fault: no values", FAULT.mix(SHADE)),
    ];
    if caption.static_tables.is_some() {
        entries.push(Entry::line("static plate tables", SECOND, 3));
    }
    key(area, (MARGIN as i32, y + 18), &entries)
}

/// An empty panel with its axes.
fn panel<'a, 'b>(
    area: &Area<'b>,
    label: &str,
    time: std::ops::Range<f64>,
    values: std::ops::Range<f64>,
    time_label: &str,
) -> Result<Panel<'a, 'b>, ChartError> {
    let mut panel = ChartBuilder::on(area)
        .margin_right(28)
        .margin_left(MARGIN)
        .margin_top(6)
        .set_left_and_bottom_label_area_size(if time_label.is_empty() { 40 } else { 66 })
        .y_label_area_size(LABELS - MARGIN)
        .build_cartesian_2d(time, values)
        .map_err(drawing)?;
    panel
        .configure_mesh()
        .y_desc(label)
        .x_desc(time_label)
        .x_labels(6)
        .y_labels(6)
        .x_label_formatter(&|seconds| format!("{seconds:.1}"))
        .label_style(("sans-serif", LETTERS))
        .axis_desc_style(("sans-serif", LETTERS))
        .light_line_style(WHITE)
        .bold_line_style(BLACK.mix(0.12))
        .draw()
        .map_err(drawing)?;
    Ok(panel)
}

/// One entry of a key: a swatch and what it stands for.
struct Entry {
    name: String,
    colour: RGBAColor,
    /// Height of the swatch in pixels.
    height: i32,
}

impl Entry {
    fn line(name: &str, colour: RGBColor, height: i32) -> Self {
        Self {
            name: name.to_owned(),
            colour: colour.to_rgba(),
            height,
        }
    }

    fn area(name: &str, colour: RGBAColor) -> Self {
        Self {
            name: name.to_owned(),
            colour,
            height: 14,
        }
    }
}

/// Draws the entries side by side from `at` on, in as many lines as they need, outside the data.
fn key(area: &Area<'_>, at: (i32, i32), entries: &[Entry]) -> Result<(), ChartError> {
    let middle = Pos::new(HPos::Left, VPos::Center);
    let style = ("sans-serif", LETTERS).into_font().color(&BLACK).pos(middle);
    let (mut x, mut y) = at;
    for entry in entries {
        let letters = WIDTH_OF_LETTER * f64::from(LETTERS) * entry.name.chars().count() as f64;
        let width = 31 + letters as i32 + 20;
        if x > at.0 && x + width > SIZE.0 as i32 {
            (x, y) = (at.0, y + KEY_LINE);
        }
        let corners = [(x, y - entry.height / 2), (x + 24, y + (entry.height + 1) / 2)];
        let swatch = Rectangle::new(corners, entry.colour.filled());
        area.draw(&swatch).map_err(drawing)?;
        area.draw(&Text::new(entry.name.clone(), (x + 31, y), style.clone()))
            .map_err(drawing)?;
        x += width;
    }
    Ok(())
}

/// A line with gaps where there is no value.
fn line(
    panel: &mut Panel<'_, '_>,
    points: impl Iterator<Item = (f64, Option<f64>)>,
    colour: RGBColor,
) -> Result<(), ChartError> {
    let style = colour.stroke_width(2);
    let mut pieces: Vec<Vec<(f64, f64)>> = vec![vec![]];
    for (time, value) in points {
        let Some(value) = value else {
            pieces.push(vec![]);
            continue;
        };
        if let Some(piece) = pieces.last_mut() {
            piece.push((time, value));
        }
    }
    for piece in pieces.into_iter().filter(|piece| !piece.is_empty()) {
        panel
            .draw_series(LineSeries::new(piece, style))
            .map_err(drawing)?;
    }
    Ok(())
}

/// A stretch of time with one status that is not `ok`.
struct Spell {
    time: std::ops::Range<f64>,
    status: Status,
}

fn spells(rows: &[Row]) -> Vec<Spell> {
    let mut spells: Vec<Spell> = vec![];
    for row in rows.iter().filter(|row| row.status != Status::Ok) {
        match spells.last_mut() {
            Some(last) if last.status == row.status && row.time - last.time.end < GAP => {
                last.time.end = row.time;
            }
            _ => spells.push(Spell {
                time: row.time..row.time,
                status: row.status,
            }),
        }
    }
    spells
}

/// Shades the spells over the height of a panel.
fn shade(
    panel: &mut Panel<'_, '_>,
    spells: &[Spell],
    values: std::ops::Range<f64>,
) -> Result<(), ChartError> {
    let boxes = spells.iter().map(|spell| {
        let corners = [(spell.time.start, values.start), (spell.time.end, values.end)];
        let colour = match spell.status {
            Status::Fault(Fault::Zeroing) => ZEROING,
            Status::Fault(_) => FAULT,
            Status::Warning(_) | Status::Ok => WARNING,
        };
        Rectangle::new(corners, colour.mix(SHADE).filled())
    });
    panel.draw_series(boxes).map_err(drawing)?;
    Ok(())
}

type Error = fn(&Row, Contact) -> Option<f64>;

/// The lines of the lowest panel.
const ERRORS: [(Error, RGBColor, &str); 2] = [
    (indentation_error, SECOND, "indentation"),
    (force_error, REPORT, "force"),
];

/// The lowest panel: errors in percent of reading, with the band they should keep to.
fn errors(
    area: &Area<'_>,
    rows: &[Row],
    caption: &Caption,
    time: std::ops::Range<f64>,
    spells: &[Spell],
) -> Result<(), ChartError> {
    let full_scale = caption.full_scale;
    let target = caption.target_percent;
    let mut sizes: Vec<f64> = rows
        .iter()
        .flat_map(|row| [force_error(row, full_scale), indentation_error(row, full_scale)])
        .flatten()
        .map(|share| (100.0 * share).abs())
        .collect();
    sizes.sort_by(f64::total_cmp);
    // A few outliers do not set the scale.
    let usual = sizes.get(sizes.len() * 99 / 100).copied().unwrap_or(0.0);
    let limit = (1.3 * usual).max(2.0 * target);
    let label = "error / % of reading";
    let (strip, area) = area.split_vertically(2 * KEY_LINE as u32);
    let mut panel = panel(&area, label, time.clone(), -limit..limit, "time / s")?;
    shade(&mut panel, spells, -limit..limit)?;
    let band = vec![
        (time.start, -target),
        (time.end, -target),
        (time.end, target),
        (time.start, target),
    ];
    let band = Polygon::new(band, BLACK.mix(BAND_SHADE).filled());
    panel.draw_series([band]).map_err(drawing)?;
    for (error, colour, _) in ERRORS {
        let points = thinned(rows).map(|row| {
            let percent = error(row, full_scale).map(|share| (100.0 * share).clamp(-limit, limit));
            (row.time, percent)
        });
        line(&mut panel, points, colour)?;
    }
    let mut entries: Vec<Entry> = ERRORS
        .iter()
        .map(|(_, colour, name)| Entry::line(name, *colour, 3))
        .collect();
    let band = format!("\u{b1}{target} %");
    entries.push(Entry::area(&band, BLACK.mix(BAND_SHADE)));
    entries.push(Entry::area("shown from 5 % of full scale up", WHITE.mix(0.0)));
    key(&strip, (MARGIN as i32, 14), &entries)
}

/// Every n-th row, few enough to draw.
fn thinned(rows: &[Row]) -> impl Iterator<Item = &Row> {
    rows.iter().step_by(rows.len().div_ceil(POINTS).max(1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::tests::{press, ramp};
    use crate::record::FeedbackPair;
    use fingertip::status::{Touch, Warnings};
    use model_tables::random::Random;

    fn rows() -> (Vec<Row>, Contact) {
        let plant = press(8e3, ramp());
        let mut noise = Random(1);
        let rows = (0..600).map(|ms| {
            let time = f64::from(ms) * 1e-3;
            let truth = plant.truth(time);
            let rise = truth.pressure_rise + 3.0 * noise.normal();
            let status = match ms {
                0..80 => Status::Fault(Fault::Zeroing),
                300..340 => Status::Warning(Warnings::SATURATED),
                _ => Status::Ok,
            };
            Row {
                time,
                truth,
                status,
                reported: (ms >= 80).then(|| plant.curve().at_pressure_rise(rise)),
                sigma: None,
                touch: Touch::Unknown,
                feedback: FeedbackPair::default(),
            }
        });
        (rows.collect(), plant.full_scale())
    }

    fn caption(full_scale: Contact) -> Caption {
        Caption {
            title: "press-hold-release on index-fingertip-elastic".to_owned(),
            subtitle: "median error: force 0.1 %, indentation 0.1 %".to_owned(),
            full_scale,
            static_tables: None,
            truth: "settled wall, not in time",
            target_percent: 0.5,
        }
    }

    #[test]
    fn names_every_axis_with_its_unit_and_every_line() {
        let (rows, full_scale) = rows();
        let svg = svg(&rows, &caption(full_scale)).expect("it can be drawn");
        for words in [
            "pressure rise / kPa",
            "force / N",
            "indentation / mm",
            "error / % of reading",
            "time / s",
            "truth: settled wall, not in time",
            "reported by the firmware",
            "fault: no values",
            "warning",
            "press-hold-release on index-fingertip-elastic",
        ] {
            assert!(svg.contains(words), "{words}");
        }
        if let Some(path) = std::env::var_os("CHART_TO_LOOK_AT") {
            std::fs::write(path, svg).expect("it can be written");
        }
    }

    #[test]
    fn a_feedback_force_has_a_panel_where_there_is_one() {
        let (mut rows, full_scale) = rows();
        let without = svg(&rows, &caption(full_scale)).expect("it can be drawn");
        assert!(!without.contains("feedback force / N") && without.contains("height=\"1560\""));
        for row in &mut rows {
            row.feedback = FeedbackPair {
                truth: Some(0.1 * row.truth.force),
                reported: row.reported.map(|reported| 0.1 * reported.force),
            };
        }
        let with = svg(&rows, &caption(full_scale)).expect("it can be drawn");
        assert!(with.contains("feedback force / N") && with.contains("height=\"1900\""));
    }

    #[test]
    fn a_line_has_a_gap_where_there_is_no_value_and_spells_end_with_their_status() {
        let (rows, _) = rows();
        let spells = spells(&rows);
        assert_eq!(spells.len(), 2);
        assert!((spells[0].time.end - 0.079).abs() < 1e-9);
        assert!((spells[1].time.start - 0.3).abs() < 1e-9);
    }

    #[test]
    fn letters_are_eleven_pixels_high_on_400_pixels_and_zeroing_is_no_fault() {
        let (rows, full_scale) = rows();
        let svg = svg(&rows, &caption(full_scale)).expect("it can be drawn");
        // plotters writes the height in points of 1 / 1.24 pixel.
        let least = svg
            .split("font-size=\"")
            .skip(1)
            .filter_map(|text| text.split('"').next()?.parse::<f64>().ok())
            .fold(f64::INFINITY, f64::min);
        assert!(1.24 * least * 400.0 / f64::from(SIZE.0) >= 11.0, "{least}");
        let fill = |colour: RGBColor| format!("#{:02X}{:02X}{:02X}", colour.0, colour.1, colour.2);
        // Beside its entry in the key each panel has the shade: of zeroing, and no fault.
        assert_eq!(svg.matches(&fill(ZEROING)).count(), 5);
        assert_eq!(svg.matches(&fill(FAULT)).count(), 1);
    }

    #[test]
    fn a_long_title_is_wrapped_within_the_chart() {
        let lines = wrapped(&"letters and words ".repeat(10), TITLE);
        assert!(lines.len() > 2);
        for line in &lines {
            let width = WIDTH_OF_LETTER * f64::from(TITLE) * line.chars().count() as f64;
            assert!(width <= f64::from(SIZE.0), "{line}");
        }
        assert_eq!(wrapped("short", TITLE), ["short"]);
    }

    #[test]
    fn refuses_to_draw_nothing() {
        let caption = caption(Contact::default());
        assert!(svg(&[], &caption).is_err());
    }
}
