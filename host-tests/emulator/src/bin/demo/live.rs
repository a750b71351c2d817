//! The table that grows while the image runs.

use crate::say::say;
use crate::summary::ZEROING;
use emulator::record::Row;
use emulator::scenario::Scenario;
use fingertip::status::Status;

/// Virtual time between two lines, seconds.
const EVERY: f64 = 0.05;

/// The columns' names; their widths are those of [`line`].
const HEAD: [&str; 2] = [
    " time  phase      pressure rise / Pa         force / N         indentation / mm",
    "   ms                 true   reported     true  reported      true   reported  status",
];

/// What stands before the status where there is a feedback actuator.
const FEEDBACK: [&str; 2] = ["   feedback / N", "   true  reported  status"];

/// Which rows are shown.
pub(crate) struct Table {
    scenario: Scenario,
    feels: bool,
    next: f64,
    status: Option<Status>,
}

impl Table {
    /// The table of a run through `scenario`, of a fingertip that has a feedback actuator or none.
    pub(crate) fn new(scenario: Scenario, feels: bool) -> Self {
        Self {
            scenario,
            feels,
            next: 0.0,
            status: None,
        }
    }

    /// What prints the lines of the rows it is given: one every 50 ms, and one at each change of status.
    pub(crate) fn into_printer(mut self) -> impl FnMut(&Row) + Send + 'static {
        for (line, feedback) in HEAD.iter().zip(FEEDBACK) {
            let columns = line.trim_end_matches("status");
            say!(
                "{}",
                if self.feels {
                    format!("{columns}{feedback}")
                } else {
                    (*line).to_owned()
                }
            );
        }
        move |row| {
            let changed = self.status.replace(row.status) != Some(row.status);
            if changed || row.time >= self.next {
                self.next = (row.time / EVERY).floor() * EVERY + EVERY;
                say!("{}", line(row, self.scenario.phase_at(row.time)));
            }
        }
    }
}

fn line(row: &Row, phase: &str) -> String {
    let truth = row.truth;
    let value = |value: Option<f64>, width: usize, decimals: usize| {
        value.map_or_else(
            || format!("{:>width$}", "-"),
            |value| format!("{value:>width$.decimals$}"),
        )
    };
    let reported = row.reported;
    let status = if row.status == ZEROING {
        "zeroing".to_owned()
    } else {
        row.status.to_string()
    };
    let feedback = row.feedback.truth.map_or_else(String::new, |truth| {
        format!("  {truth:>7.4}   {}", value(row.feedback.reported, 7, 4))
    });
    format!(
        "{:>5.0}  {phase:<9} {:>8.1}   {}  {:>7.4}   {}  {:>8.4}   {}{feedback}  {}",
        row.time * 1e3,
        truth.pressure_rise,
        value(reported.map(|contact| contact.pressure_rise), 8, 1),
        truth.force,
        value(reported.map(|contact| contact.force), 7, 4),
        truth.indentation * 1e3,
        value(reported.map(|contact| contact.indentation * 1e3), 8, 4),
        status
    )
}
