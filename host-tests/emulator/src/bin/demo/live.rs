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

/// Which rows are shown.
pub(crate) struct Table {
    scenario: Scenario,
    next: f64,
    status: Option<Status>,
}

impl Table {
    /// The table of a run through `scenario`.
    pub(crate) fn new(scenario: Scenario) -> Self {
        Self {
            scenario,
            next: 0.0,
            status: None,
        }
    }

    /// What prints the lines of the rows it is given: one every 50 ms, and one at each change of status.
    pub(crate) fn into_printer(mut self) -> impl FnMut(&Row) + Send + 'static {
        for line in HEAD {
            say!("{line}");
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
    format!(
        "{:>5.0}  {phase:<9} {:>8.1}   {}  {:>7.4}   {}  {:>8.4}   {}  {}",
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
