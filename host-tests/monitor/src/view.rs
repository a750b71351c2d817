//! The terminal: the status, values with their unit or the reason why there are none; a chart of the last seconds; what happened.

use crate::keys::HELP;
use crate::readings::{Connection, HISTORY, HistoryPoint, LiveValues, Monitor};
use fingertip::link::wire::PROTOCOL_VERSION;
use fingertip::status::{Status, Touch};
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Modifier, Style};
use ratatui::symbols::Marker;
use ratatui::text::{Line, Span};
use ratatui::widgets::{Axis, Block, Chart, Clear, Dataset, GraphType, Paragraph};
use std::time::Duration;

/// The keys, for the last line: the long form where it fits.
const KEYS: [&str; 2] = [
    "t tare   u undo   s save   i info   x self-test   p pause   c chart   ? all keys   q quit",
    "? keys   t tare   q quit",
];
/// From this width and height on there are borders and a chart.
const ROOMY: [u16; 2] = [60, 17];
/// From this width on the 1-sigma stands beside its value.
const WIDE: u16 = 50;
/// From this width on the band of an unknown object stands behind the 1-sigma.
const BANDED: u16 = 78;
/// Lines of values: status, touch, force, peak, indentation, pressure rise. Of a design with a feedback actuator there is one more.
const VALUES: u16 = 6;

/// Width of the help's longest line, and columns of the help on a smaller screen.
const LONGEST_HELP: usize = 56;
const SHORT_COLUMNS: usize = 3;

/// What the chart shows.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum Plot {
    /// The force.
    #[default]
    Force,
    /// The pressure rise.
    PressureRise,
}

impl Plot {
    /// Title of the chart.
    const fn title(self) -> &'static str {
        match self {
            Self::Force => " force / N over the last seconds, only where it is ok ",
            Self::PressureRise => " pressure rise / Pa over the last seconds, only where it is ok ",
        }
    }

    /// The largest value that an empty chart reaches to, in its unit.
    const fn least_scale(self) -> f64 {
        match self {
            Self::Force => 0.1,
            Self::PressureRise => 100.0,
        }
    }

    /// The other one.
    #[must_use]
    pub const fn next(self) -> Self {
        match self {
            Self::Force => Self::PressureRise,
            Self::PressureRise => Self::Force,
        }
    }
}

/// What the view shows beside the readings.
#[derive(Clone, Debug, Default)]
pub struct ViewContext {
    /// Where the board is.
    pub address: String,
    /// Where rows go; `None`: they are not logged.
    pub log: Option<String>,
    /// What the chart shows.
    pub plot: Plot,
    /// Whether the screen stands still.
    pub paused: bool,
    /// What is being typed; `None`: nothing is.
    pub question: Option<String>,
    /// Whether the keys are explained.
    pub help: bool,
    /// Whether a log is played, and no board is there.
    pub replayed: bool,
}

/// Draws everything; `now` is the time since the start.
pub fn draw(frame: &mut Frame<'_>, monitor: &Monitor, context: &ViewContext, now: Duration) {
    let all = frame.area();
    let shown = monitor.latest(now).and_then(|reading| reading.values);
    let lines = VALUES + u16::from(shown.is_some_and(|values| values.feedback_force_n.is_some()));
    if all.width >= ROOMY[0] && all.height >= ROOMY[1] {
        let [title, values, chart, journal, keys] = Layout::vertical([
            Constraint::Length(1),
            Constraint::Length(lines + 2),
            Constraint::Min(2),
            Constraint::Length(if all.height >= 30 { 6 } else { 4 }),
            Constraint::Length(1),
        ])
        .areas(all);
        frame.render_widget(heading(monitor, context, title.width), title);
        let now_block = Block::bordered().title(" now ");
        frame.render_widget(
            Paragraph::new(readings(monitor, values.width, now)).block(now_block),
            values,
        );
        draw_chart(frame, chart, monitor, context.plot);
        draw_journal(frame, journal, monitor, context);
        draw_keys(frame, keys, context);
    } else {
        // The status first, and whole: it decides what the rest is worth.
        let [values, journal, keys] = Layout::vertical([
            Constraint::Length(lines),
            Constraint::Min(0),
            Constraint::Length(1),
        ])
        .areas(all);
        frame.render_widget(Paragraph::new(readings(monitor, values.width, now)), values);
        let room = usize::from(journal.height);
        let lines = latest_lines(monitor, room);
        frame.render_widget(Paragraph::new(lines), journal);
        draw_keys(frame, keys, context);
    }
    if context.help {
        draw_help(frame, all);
    }
}

/// Cut to a width, with a mark where something is cut.
fn fitted(text: &str, width: usize) -> String {
    if text.chars().count() <= width {
        return text.to_owned();
    }
    let mut cut: String = text.chars().take(width.saturating_sub(1)).collect();
    cut.push('\u{2026}');
    cut
}

fn draw_keys(frame: &mut Frame<'_>, area: Rect, context: &ViewContext) {
    let (text, style) = if let Some(question) = &context.question {
        (question.clone(), Style::new().add_modifier(Modifier::BOLD))
    } else {
        let fits = KEYS
            .iter()
            .find(|keys| keys.len() <= usize::from(area.width))
            .unwrap_or(&KEYS[1]);
        ((*fits).to_owned(), Style::new().add_modifier(Modifier::DIM))
    };
    // Of a long question the end, where it is typed.
    let skipped = text.chars().count().saturating_sub(area.width.into());
    let shown: String = if context.question.is_some() {
        text.chars().skip(skipped).collect()
    } else {
        text
    };
    frame.render_widget(Paragraph::new(shown).style(style), area);
}

fn draw_help(frame: &mut Frame<'_>, all: Rect) {
    frame.render_widget(Clear, all);
    if usize::from(all.height) <= HELP.len() || usize::from(all.width) < LONGEST_HELP {
        // A word a key, in columns.
        let rows = HELP.len().div_ceil(SHORT_COLUMNS);
        let lines: Vec<Line<'_>> = (0..rows)
            .map(|row| {
                let keys = HELP.iter().skip(row).step_by(rows);
                let cells = keys.map(|(key, _, word)| {
                    let cell = format!("{key} {word}");
                    Span::raw(format!("{cell:<10}"))
                });
                Line::from(cells.collect::<Vec<_>>())
            })
            .collect();
        frame.render_widget(Paragraph::new(lines), all);
        return;
    }
    let lines: Vec<Line<'_>> = HELP
        .iter()
        .map(|(key, meaning, _)| Line::from(format!("{key:>3}  {meaning}")))
        .collect();
    frame.render_widget(Paragraph::new(lines).block(Block::new().title("keys")), all);
}

fn heading(monitor: &Monitor, context: &ViewContext, width: u16) -> Paragraph<'static> {
    let (state, style) = match monitor.connection() {
        _ if context.paused => (
            "PAUSED, p goes on".to_owned(),
            Style::new().fg(Color::Black).bg(Color::Yellow),
        ),
        _ if context.replayed => ("replay".to_owned(), Style::new().fg(Color::Cyan)),
        Connection::Connecting => ("connecting".to_owned(), Style::new().fg(Color::Yellow)),
        Connection::Connected => ("connected".to_owned(), Style::new().fg(Color::Green)),
        Connection::Lost(reason) => (
            format!("no connection, trying again: {reason}"),
            Style::new().fg(Color::Red),
        ),
    };
    let name = "fingertip monitor  ".to_owned();
    let address = format!("{}  ", context.address);
    let design = monitor.hello().map_or_else(String::new, |hello| {
        let [major, minor, patch] = hello.firmware;
        format!(
            "  firmware {major}.{minor}.{patch}  design {:016x}",
            hello.design_hash
        )
    });
    let tip = monitor.tip().map_or_else(String::new, |tip| format!("  {tip}"));
    let mut left = usize::from(width);
    let mut spans = Vec::new();
    for (text, style) in [
        (name, Style::new().add_modifier(Modifier::BOLD)),
        (address, Style::new()),
        (state, style),
        (tip, Style::new()),
        (design, Style::new()),
    ] {
        let text = fitted(&text, left);
        left -= text.chars().count().min(left);
        spans.push(Span::styled(text, style));
    }
    Paragraph::new(Line::from(spans))
}

fn readings(monitor: &Monitor, width: u16, now: Duration) -> Vec<Line<'static>> {
    let latest = monitor.latest(now);
    let status = latest.map(|reading| reading.status);
    let (word, color) = match (status, monitor.connection(), monitor.other_version()) {
        (None, Connection::Lost(_), _) => ("no report: no connection".to_owned(), Color::Red),
        (None, _, Some(version)) => (
            format!("no report: protocol {version}, not {PROTOCOL_VERSION}"),
            Color::Red,
        ),
        (None, ..) => ("no report".to_owned(), Color::Red),
        (Some(status @ Status::Ok), ..) => (status.to_string(), Color::Green),
        (Some(status @ Status::Warning(_)), ..) => (status.to_string(), Color::Yellow),
        (Some(status @ Status::Fault(_)), ..) => (status.to_string(), Color::Red),
    };
    let ok = latest.and_then(|reading| reading.ok());
    let bold = Style::new().add_modifier(Modifier::BOLD);
    let wide = width >= WIDE;
    let value = |name: &str, pair: Option<[f64; 2]>, decimals: usize, unit: &str| {
        let text = match pair {
            Some([value, sigma]) if wide => {
                format!("{value:>10.decimals$} {unit:<2}   1-sigma {sigma:.decimals$} {unit}")
            }
            Some([value, _]) => format!("{value:>10.decimals$} {unit:<2}"),
            None if wide => format!("{:>10}    not shown: {word}", "-"),
            None => format!("{:>10}", "-"),
        };
        Line::from(vec![Span::raw(format!(" {name:<13} ")), Span::styled(text, bold)])
    };
    let band = latest
        .and_then(|reading| reading.band)
        .filter(|_| ok.is_some() && width >= BANDED);
    let banded = |mut line: Line<'static>, ends: Option<[f64; 2]>| {
        if let Some([least, most]) = ends {
            line.push_span(Span::raw(format!(", object unknown: {least:.3} to {most:.3}")));
        }
        line
    };
    let touch = latest.map_or(Touch::Unknown, |reading| reading.touch).word();
    let peak = match monitor.peak_force_n() {
        Some(peak) if wide => format!("{peak:>10.4} N    largest that was ok; k forgets it"),
        Some(peak) => format!("{peak:>10.4} N"),
        None => format!("{:>10}", "-"),
    };
    let shown = if wide {
        format!(" {:<13} {word}", "status")
    } else {
        word.clone()
    };
    let mut lines = vec![
        Line::styled(shown, Style::new().fg(color).add_modifier(Modifier::BOLD)),
        banded(
            value("force", ok.map(|values| values.force_n), 4, "N"),
            band.map(|band| band.force_n),
        ),
        banded(
            value("indentation", ok.map(|values| values.indentation_mm), 4, "mm"),
            band.map(|band| band.indentation_mm),
        ),
        // A warned rise still tells what the transducer reads.
        value(
            "pressure rise",
            latest
                .and_then(|reading| reading.values)
                .map(|values| values.pressure_rise_pa),
            1,
            "Pa",
        ),
        Line::from(format!(" {:<13} {touch:>10}", "touch")),
        Line::from(format!(" {:<13} {peak}", "peak force")),
    ];
    let feedback = |values: LiveValues| values.feedback_force_n;
    if latest
        .and_then(|reading| reading.values)
        .and_then(feedback)
        .is_some()
    {
        lines.insert(3, value("feedback", ok.and_then(feedback), 4, "N"));
    }
    lines
}

/// The stretches of the history in which there is a value.
fn stretches(monitor: &Monitor, plot: Plot) -> Vec<Vec<(f64, f64)>> {
    let mut all = vec![Vec::new()];
    let end = monitor.history().back().map_or(0.0, |point| point.time);
    for HistoryPoint { time, values } in monitor.history() {
        match (values, all.last_mut()) {
            (Some([force, pressure]), Some(stretch)) => stretch.push((
                time - end,
                match plot {
                    Plot::Force => *force,
                    Plot::PressureRise => *pressure,
                },
            )),
            _ => all.push(Vec::new()),
        }
    }
    all.retain(|stretch| !stretch.is_empty());
    all
}

fn draw_chart(frame: &mut Frame<'_>, area: Rect, monitor: &Monitor, plot: Plot) {
    let all = stretches(monitor, plot);
    let largest = all
        .iter()
        .flatten()
        .map(|(_, value)| *value)
        .fold(plot.least_scale(), f64::max);
    let datasets = all
        .iter()
        .map(|stretch| {
            Dataset::default()
                .marker(Marker::Braille)
                .graph_type(GraphType::Line)
                .style(Style::new().fg(Color::Cyan))
                .data(stretch)
        })
        .collect();
    let labels = |values: [f64; 3], decimals: usize| values.map(|value| format!("{value:.decimals$}"));
    let decimals = if plot == Plot::Force { 2 } else { 0 };
    let chart = Chart::new(datasets)
        .block(Block::bordered().title(plot.title()))
        .x_axis(
            Axis::default()
                .bounds([-HISTORY, 0.0])
                .labels(labels([-HISTORY, -0.5 * HISTORY, 0.0], 0)),
        )
        .y_axis(
            Axis::default()
                .bounds([0.0, largest])
                .labels(labels([0.0, 0.5 * largest, largest], decimals)),
        );
    frame.render_widget(chart, area);
}

/// The last lines of the journal, the latest last.
fn latest_lines(monitor: &Monitor, room: usize) -> Vec<Line<'_>> {
    let mut lines: Vec<Line<'_>> = monitor
        .journal()
        .rev()
        .take(room)
        .map(|line| Line::from(format!(" {line}")))
        .collect();
    lines.reverse();
    lines
}

fn draw_journal(frame: &mut Frame<'_>, area: Rect, monitor: &Monitor, context: &ViewContext) {
    let counts = monitor.counts();
    let twice = match counts.out_of_order {
        0 => String::new(),
        count => format!(", {count} out of order"),
    };
    let title = format!(
        " {} reports, {} missing, {} broken{twice}{} ",
        counts.reports,
        counts.missing,
        counts.broken,
        context
            .log
            .as_ref()
            .map_or_else(String::new, |log| format!(", to {log}"))
    );
    let lines = latest_lines(monitor, usize::from(area.height.saturating_sub(2)));
    frame.render_widget(Paragraph::new(lines).block(Block::bordered().title(title)), area);
}
