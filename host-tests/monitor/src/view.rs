//! The terminal: values with their unit, or the reason why there are none; the force over the last seconds; what happened.

use crate::readings::{Connection, HISTORY, Monitor};
use fingertip::status::{Status, Touch};
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Modifier, Style};
use ratatui::symbols::Marker;
use ratatui::text::{Line, Span};
use ratatui::widgets::{Axis, Block, Chart, Dataset, GraphType, Paragraph};
use std::time::Duration;

/// The keys, for the last line.
const KEYS: &str = "t tare   u undo   s save   i info   x self-test   q quit";
/// The least force that the chart reaches to, newtons.
const LEAST_SCALE: f64 = 0.1;

/// What the view says beside the readings.
#[derive(Clone, Debug, Default)]
pub struct ViewContext {
    /// Where the board is.
    pub address: String,
    /// Where rows go, if they do.
    pub log: Option<String>,
}

/// Draws everything; `now` is the time since the start.
pub fn draw(frame: &mut Frame<'_>, monitor: &Monitor, surroundings: &ViewContext, now: Duration) {
    let [title, values, chart, journal, keys] = Layout::vertical([
        Constraint::Length(1),
        Constraint::Length(7),
        Constraint::Min(6),
        Constraint::Length(6),
        Constraint::Length(1),
    ])
    .areas(frame.area());
    frame.render_widget(heading(monitor, surroundings), title);
    frame.render_widget(readings(monitor, now), values);
    draw_chart(frame, chart, monitor);
    draw_journal(frame, journal, monitor, surroundings);
    frame.render_widget(
        Paragraph::new(KEYS).style(Style::new().add_modifier(Modifier::DIM)),
        keys,
    );
}

fn heading(monitor: &Monitor, surroundings: &ViewContext) -> Paragraph<'static> {
    let (words, style) = match monitor.connection() {
        Connection::Connecting => ("connecting".to_owned(), Style::new().fg(Color::Yellow)),
        Connection::Connected => ("connected".to_owned(), Style::new().fg(Color::Green)),
        Connection::Lost(reason) => (
            format!("no connection, trying again: {reason}"),
            Style::new().fg(Color::Red),
        ),
    };
    let bold = Style::new().add_modifier(Modifier::BOLD);
    let mut spans = vec![
        Span::styled("fingertip monitor  ", bold),
        Span::raw(format!("{}  ", surroundings.address)),
        Span::styled(words, style),
    ];
    if let Some(hello) = monitor.hello() {
        let [major, minor, patch] = hello.firmware;
        spans.push(Span::raw(format!(
            "  firmware {major}.{minor}.{patch}  design {:016x}",
            hello.design_hash
        )));
    }
    Paragraph::new(Line::from(spans))
}

fn readings(monitor: &Monitor, now: Duration) -> Paragraph<'static> {
    let latest = monitor.latest(now);
    let status = latest.map(|reading| reading.status);
    let (word, color) = match status {
        None => ("no report".to_owned(), Color::Red),
        Some(status @ Status::Ok) => (status.to_string(), Color::Green),
        Some(status @ Status::Warning(_)) => (status.to_string(), Color::Yellow),
        Some(status @ Status::Fault(_)) => (status.to_string(), Color::Red),
    };
    let ok = latest.and_then(|reading| reading.ok());
    let bold = Style::new().add_modifier(Modifier::BOLD);
    let value = |name: &str, pair: Option<[f64; 2]>, decimals: usize, unit: &str| {
        let text = match pair {
            Some([value, sigma]) => {
                format!("{value:>10.decimals$} {unit:<2}   1-sigma {sigma:.decimals$} {unit}")
            }
            None => format!("{:>10}    not shown: {word}", "-"),
        };
        Line::from(vec![Span::raw(format!(" {name:<15}")), Span::styled(text, bold)])
    };
    let touch = match latest.map(|reading| reading.touch) {
        None | Some(Touch::Unknown) => "unknown",
        Some(Touch::Untouched) => "untouched",
        Some(Touch::Touched) => "touched",
    };
    let lines = vec![
        value("force", ok.map(|values| values.force_n), 4, "N"),
        value("indentation", ok.map(|values| values.indentation_mm), 4, "mm"),
        // A warned rise still says what the transducer reads.
        value(
            "pressure rise",
            latest
                .and_then(|reading| reading.values)
                .map(|values| values.pressure_rise_pa),
            1,
            "Pa",
        ),
        Line::from(format!(" {:<15}{touch:>10}", "touch")),
        Line::from(vec![
            Span::raw(format!(" {:<15}", "status")),
            Span::styled(
                format!("{word:>10}"),
                Style::new().fg(color).add_modifier(Modifier::BOLD),
            ),
        ]),
    ];
    Paragraph::new(lines).block(Block::bordered().title(" now "))
}

/// The stretches of the history in which there is a force.
fn stretches(monitor: &Monitor) -> Vec<Vec<(f64, f64)>> {
    let mut all = vec![Vec::new()];
    let end = monitor.history().back().map_or(0.0, |(time, _)| *time);
    for (time, force) in monitor.history() {
        match (force, all.last_mut()) {
            (Some(force), Some(stretch)) => stretch.push((time - end, *force)),
            _ => all.push(Vec::new()),
        }
    }
    all.retain(|stretch| !stretch.is_empty());
    all
}

fn draw_chart(frame: &mut Frame<'_>, area: Rect, monitor: &Monitor) {
    let all = stretches(monitor);
    let largest = all
        .iter()
        .flatten()
        .map(|(_, force)| *force)
        .fold(LEAST_SCALE, f64::max);
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
    let chart = Chart::new(datasets)
        .block(Block::bordered().title(" force / N over the last seconds, only where it is ok "))
        .x_axis(
            Axis::default()
                .bounds([-HISTORY, 0.0])
                .labels(labels([-HISTORY, -0.5 * HISTORY, 0.0], 0)),
        )
        .y_axis(
            Axis::default()
                .bounds([0.0, largest])
                .labels(labels([0.0, 0.5 * largest, largest], 2)),
        );
    frame.render_widget(chart, area);
}

fn draw_journal(frame: &mut Frame<'_>, area: Rect, monitor: &Monitor, surroundings: &ViewContext) {
    let counts = monitor.counts();
    let title = format!(
        " {} reports, {} missing, {} broken{} ",
        counts.reports,
        counts.missing,
        counts.broken,
        surroundings
            .log
            .as_ref()
            .map_or_else(String::new, |log| format!(", to {log}"))
    );
    let room = usize::from(area.height.saturating_sub(2));
    let mut lines: Vec<Line<'_>> = monitor
        .journal()
        .rev()
        .take(room)
        .map(|line| Line::from(format!(" {line}")))
        .collect();
    lines.reverse();
    frame.render_widget(Paragraph::new(lines).block(Block::bordered().title(title)), area);
}
