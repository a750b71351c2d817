//! Reports as rows: CSV or JSON, each row whole.

use crate::output::whole::WholeRows;
use crate::readings::LiveReading;
use serde_json::{Map, Value};
use std::io;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// The columns. `time_ms` is the board's clock since its reset, `host_time_s` the host's since 1970-01-01 UTC of the same instant;
/// `missing_before` counts the frames that are missing right before the row; `design` is the hash in the board's hello, empty before it. The two of the
/// feedback are empty of a design without such an actuator, the last four of a board that states no band.
pub const COLUMNS: [&str; 18] = [
    "time_ms",
    "status",
    "touch",
    "pressure_rise_pa",
    "force_n",
    "indentation_mm",
    "sigma_pressure_rise_pa",
    "sigma_force_n",
    "sigma_indentation_mm",
    "host_time_s",
    "missing_before",
    "design",
    "feedback_force_n",
    "sigma_feedback_force_n",
    "force_lower_n",
    "force_upper_n",
    "indentation_lower_mm",
    "indentation_upper_mm",
];

/// How rows are written.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Form {
    /// Comma-separated values with a header.
    Csv,
    /// An object a line.
    Json,
}

/// Writes rows.
#[derive(Debug)]
pub struct Writer<W: WholeRows> {
    form: Form,
    to: W,
    /// When the watch began.
    began: SystemTime,
}

/// The six values of a row; empty for a fault. A bound that no frame can carry is infinite.
fn values(reading: &LiveReading) -> [Option<f64>; 6] {
    reading.values.map_or([None; 6], |values| {
        let all = [values.pressure_rise_pa, values.force_n, values.indentation_mm];
        [0, 1, 2, 3, 4, 5].map(|i| Some(all[i % 3][i / 3]))
    })
}

/// The force of the feedback actuator and its deviation; empty for a fault, and of a design without one.
fn feedback(reading: &LiveReading) -> [Option<f64>; 2] {
    let force = reading.values.and_then(|values| values.feedback_force_n);
    force.map_or([None; 2], |pair| pair.map(Some))
}

/// Least and largest force and indentation of an unknown object; empty where no band holds.
fn band(reading: &LiveReading) -> [Option<f64>; 4] {
    reading.band.map_or([None; 4], |band| {
        let [[a, b], [c, d]] = [band.force_n, band.indentation_mm];
        [a, b, c, d].map(Some)
    })
}

/// A number of a row, or nothing.
fn cell(value: Option<f64>) -> String {
    value.map_or_else(String::new, |value| format!("{value:.6}"))
}

/// When a report was measured, since 1970, of a watch that began then.
pub(crate) fn host_time(reading: &LiveReading, began: SystemTime) -> Duration {
    (began + reading.measured)
        .duration_since(UNIX_EPOCH)
        .unwrap_or_default()
}

/// A report as an object: a value that is not there, or is infinite, is null.
pub(crate) fn object(reading: &LiveReading, began: SystemTime) -> Value {
    let mut cells: Vec<Value> = vec![
        (reading.time.0 as f64 * 1e-3).into(),
        reading.status.to_string().into(),
        reading.touch.word().into(),
    ];
    cells.extend(values(reading).map(Value::from));
    cells.push(host_time(reading, began).as_secs_f64().into());
    cells.push(reading.missing_before.into());
    cells.push(reading.design.map(|hash| format!("{hash:016x}")).into());
    cells.extend(feedback(reading).map(Value::from));
    cells.extend(band(reading).map(Value::from));
    let named = COLUMNS.iter().map(|column| (*column).to_owned());
    Value::Object(named.zip(cells).collect::<Map<_, _>>())
}

impl<W: WholeRows> Writer<W> {
    /// A writer of a watch that began then; the header of a CSV goes first.
    ///
    /// # Errors
    /// What the output answers.
    pub fn new(form: Form, mut to: W, began: SystemTime) -> io::Result<Self> {
        if form == Form::Csv {
            to.put(&line(&COLUMNS.map(str::to_owned))?)?;
        }
        Ok(Self { form, to, began })
    }

    /// A report. Values of a fault are empty; those of a warning stand beside its reason.
    ///
    /// # Errors
    /// What the output answers; the row is then not there.
    pub fn write(&mut self, reading: &LiveReading) -> io::Result<()> {
        let row = match self.form {
            Form::Csv => {
                let time = reading.time.0 as f64 * 1e-3;
                let mut cells = vec![
                    format!("{time:.3}"),
                    reading.status.to_string(),
                    reading.touch.word().to_owned(),
                ];
                cells.extend(values(reading).map(cell));
                cells.push(format!("{:.6}", host_time(reading, self.began).as_secs_f64()));
                cells.push(reading.missing_before.to_string());
                cells.push(
                    reading
                        .design
                        .map_or_else(String::new, |hash| format!("{hash:016x}")),
                );
                cells.extend(feedback(reading).map(cell));
                cells.extend(band(reading).map(cell));
                line(&cells)?
            }
            Form::Json => format!("{}\n", object(reading, self.began)).into_bytes(),
        };
        self.to.put(&row)
    }
}

/// One row in one piece.
fn line(cells: &[String]) -> io::Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(cells)?;
    writer
        .into_inner()
        .map_err(|error| io::Error::other(error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::readings::{LiveBand, LiveValues};
    use fingertip::status::{Fault, Status, Touch, Warnings};
    use fingertip::units::Microseconds;

    fn reading(status: Status) -> LiveReading {
        LiveReading {
            time: Microseconds(1_250),
            measured: Duration::from_millis(1_500),
            missing_before: 3,
            design: Some(0xab),
            status,
            values: (!matches!(status, Status::Fault(_))).then_some(LiveValues {
                pressure_rise_pa: [1000.5, 2.0],
                force_n: [1.25, f64::INFINITY],
                indentation_mm: [0.75, 0.002],
                feedback_force_n: None,
            }),
            touch: Touch::Touched,
            band: None,
        }
    }

    #[test]
    fn a_fault_has_no_number_and_a_warning_its_reason() {
        let mut text = Vec::new();
        let mut writer = Writer::new(Form::Csv, &mut text, UNIX_EPOCH).expect("a vector takes everything");
        for status in [
            Status::Ok,
            Status::Warning(Warnings::SATURATED.and(Warnings::CLOCK)),
            Status::Fault(Fault::SensorOpen),
        ] {
            writer.write(&reading(status)).expect("a vector takes everything");
        }
        let text = String::from_utf8(text).expect("text");
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], COLUMNS.join(","));
        let values =
            "touched,1000.500000,1.250000,0.750000,2.000000,inf,0.002000,1.500000,3,00000000000000ab,,,,,,";
        assert_eq!(lines[1], format!("1.250,ok,{values}"));
        assert_eq!(lines[2], format!("1.250,warning: saturated; clock,{values}"));
        assert_eq!(
            lines[3],
            "1.250,fault: sensor open,touched,,,,,,,1.500000,3,00000000000000ab,,,,,,"
        );
        let mut felt = reading(Status::Ok);
        felt.values = felt.values.map(|values| LiveValues {
            feedback_force_n: Some([0.445, 0.0018]),
            ..values
        });
        let mut text = Vec::new();
        let mut writer = Writer::new(Form::Csv, &mut text, UNIX_EPOCH).expect("a vector takes everything");
        writer.write(&felt).expect("a vector takes everything");
        let text = String::from_utf8(text).expect("text");
        assert!(
            text.ends_with(",00000000000000ab,0.445000,0.001800,,,,\n"),
            "{text}"
        );
        assert_eq!(object(&felt, UNIX_EPOCH)["feedback_force_n"], 0.445);
        let mut unsure = reading(Status::Ok);
        unsure.band = Some(LiveBand {
            force_n: [0.9, 1.5],
            indentation_mm: [0.7, 1.0],
        });
        let mut text = Vec::new();
        let mut writer = Writer::new(Form::Csv, &mut text, UNIX_EPOCH).expect("a vector takes everything");
        writer.write(&unsure).expect("a vector takes everything");
        let text = String::from_utf8(text).expect("text");
        assert!(
            text.ends_with(",00000000000000ab,,,0.900000,1.500000,0.700000,1.000000\n"),
            "{text}"
        );
        assert_eq!(object(&unsure, UNIX_EPOCH)["force_upper_n"], 1.5);
    }

    #[test]
    fn json_is_an_object_a_line() {
        let mut text = Vec::new();
        let mut writer = Writer::new(Form::Json, &mut text, UNIX_EPOCH).expect("a vector takes everything");
        for status in [Status::Ok, Status::Fault(Fault::Jump)] {
            writer.write(&reading(status)).expect("a vector takes everything");
        }
        let text = String::from_utf8(text).expect("text");
        let lines: Vec<Value> = text
            .lines()
            .map(|line| serde_json::from_str(line).expect("JSON"))
            .collect();
        assert_eq!(lines[0]["force_n"], 1.25);
        assert_eq!(lines[0]["host_time_s"], 1.5);
        assert!(lines[0]["sigma_force_n"].is_null());
        assert!(lines[1]["force_n"].is_null() && lines[1]["status"] == "fault: jump");
    }
}
