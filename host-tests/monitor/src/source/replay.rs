//! A log of this program played again, at its own pace.

use crate::output::rows::COLUMNS;
use crate::readings::{LiveBand, LiveReading, LiveValues};
use fingertip::status::{Fault, Status, Touch, Warnings};
use fingertip::units::Microseconds;
use std::path::Path;
use std::time::Duration;

/// Reports of a CSV log, in its order, each at its time since the first.
#[derive(Debug)]
pub struct Replay {
    rows: std::vec::IntoIter<LiveReading>,
    next: Option<LiveReading>,
    speed: f64,
}

impl Replay {
    /// Reads a log whole, to be played `speed` times as fast as it was written.
    ///
    /// # Errors
    /// A line that names the file, the row and what is wrong with it.
    pub fn open(path: &Path, speed: f64) -> Result<Self, String> {
        let named = |error: String| format!("{}: {error}", path.display());
        let mut reader = csv::Reader::from_path(path).map_err(|error| named(error.to_string()))?;
        let header = reader.headers().map_err(|error| named(error.to_string()))?;
        let place = |column: &str| header.iter().position(|name| name == column);
        let places = COLUMNS.map(place);
        if let Some(missing) = (0..9).find(|&i| places[i].is_none()) {
            return Err(named(format!(
                "no column `{}`; play a file that `designer monitor --csv` wrote",
                COLUMNS[missing]
            )));
        }
        let mut rows = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|error| named(error.to_string()))?;
            let line = record.position().map_or(0, csv::Position::line);
            let cell = |i: usize| places[i].and_then(|place| record.get(place)).unwrap_or_default();
            let reading = read(&cell).map_err(|error| named(format!("line {line}: {error}")))?;
            rows.push(reading);
        }
        let Some(first) = rows.first().map(|reading: &LiveReading| reading.measured) else {
            return Err(named("there is no report in it".to_owned()));
        };
        // A clock that was set back during the log stands still in the play.
        let mut latest = Duration::ZERO;
        for reading in &mut rows {
            latest = latest.max(reading.measured.saturating_sub(first).div_f64(speed));
            reading.measured = latest;
        }
        let mut rows = rows.into_iter();
        Ok(Self {
            next: rows.next(),
            rows,
            speed,
        })
    }

    /// How long after the start the next report is due; nothing at the end.
    pub fn due(&self) -> Option<Duration> {
        self.next.map(|reading| reading.measured)
    }

    /// How many times as fast as it was written it is played.
    pub fn speed(&self) -> f64 {
        self.speed
    }
}

impl Iterator for Replay {
    type Item = LiveReading;

    fn next(&mut self) -> Option<LiveReading> {
        let reading = self.next.take();
        self.next = self.rows.next();
        reading
    }
}

/// A row; `cell` gives the text of a column by its place in [`COLUMNS`].
fn read<'a>(cell: &impl Fn(usize) -> &'a str) -> Result<LiveReading, String> {
    let number = |i: usize| {
        cell(i)
            .parse::<f64>()
            .map_err(|_| format!("`{}` is no number for {}", cell(i), COLUMNS[i]))
    };
    let time_ms = number(0).and_then(|time| {
        (0.0..=1e15)
            .contains(&time)
            .then_some(time)
            .ok_or_else(|| format!("{time} is no time_ms"))
    })?;
    let status = status(cell(1)).ok_or_else(|| format!("`{}` is no status", cell(1)))?;
    let touch = Touch::CODES
        .iter()
        .map(|(touch, _)| *touch)
        .find(|touch| touch.word() == cell(2))
        .ok_or_else(|| format!("`{}` is no touch", cell(2)))?;
    let values = if matches!(status, Status::Fault(_)) {
        None
    } else {
        let pair = |i: usize| Ok::<_, String>([number(i)?, number(i + 3)?]);
        Some(LiveValues {
            pressure_rise_pa: pair(3)?,
            force_n: pair(4)?,
            indentation_mm: pair(5)?,
            // Empty of a design without an actuator; a log of before there were any has no such columns.
            feedback_force_n: if cell(12).is_empty() {
                None
            } else {
                Some([number(12)?, number(13)?])
            },
        })
    };
    let measured = if cell(9).is_empty() {
        // A log of before there was a host's time.
        Duration::from_secs_f64(1e-3 * time_ms)
    } else {
        Duration::try_from_secs_f64(number(9)?).map_err(|_| format!("`{}` is no host_time_s", cell(9)))?
    };
    Ok(LiveReading {
        time: Microseconds((1e3 * time_ms).round() as u64),
        measured,
        missing_before: cell(10).parse().unwrap_or(0),
        design: u64::from_str_radix(cell(11), 16).ok(),
        status,
        values,
        touch,
        // A log of before there was a band has no such columns.
        band: if cell(14).is_empty() {
            None
        } else {
            Some(LiveBand {
                force_n: [number(14)?, number(15)?],
                indentation_mm: [number(16)?, number(17)?],
            })
        },
    })
}

/// A status by its words.
fn status(text: &str) -> Option<Status> {
    if text == "ok" {
        return Some(Status::Ok);
    }
    if let Some(reason) = text.strip_prefix("fault: ") {
        let mut faults = Fault::CODES.iter().map(|(fault, _)| *fault);
        return faults.find(|fault| fault.reason() == reason).map(Status::Fault);
    }
    let mut warnings = Warnings::NONE;
    for word in text.strip_prefix("warning: ")?.split("; ") {
        let mut all = (0..16).filter_map(|bit| Warnings::from_bits(1 << bit));
        warnings = warnings.and(all.find(|one| one.reasons().eq([word]))?);
    }
    Some(Status::Warning(warnings))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_status_is_read_as_it_is_written() {
        let mut all = vec![Status::Ok, Status::Warning(Warnings::ALL)];
        all.extend(Fault::CODES.iter().map(|(fault, _)| Status::Fault(*fault)));
        all.extend(
            (0..16)
                .filter_map(|bit| Warnings::from_bits(1 << bit))
                .map(Status::Warning),
        );
        for one in all {
            assert_eq!(status(&one.to_string()), Some(one));
        }
        for wrong in ["", "OK", "warning: ", "warning: tired", "fault: tired"] {
            assert_eq!(status(wrong), None, "{wrong}");
        }
    }
}
