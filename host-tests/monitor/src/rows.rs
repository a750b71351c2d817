//! Reports as rows: a CSV file while the view runs, CSV or JSON in a pipe.

use crate::readings::LiveReading;
use fingertip::status::Touch;
use std::io::{self, Write};

/// The columns.
pub const COLUMNS: [&str; 9] = [
    "time_ms",
    "status",
    "touch",
    "pressure_rise_pa",
    "force_n",
    "indentation_mm",
    "sigma_pressure_rise_pa",
    "sigma_force_n",
    "sigma_indentation_mm",
];

/// How rows are written.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Form {
    /// Comma-separated values with a header.
    Csv,
    /// An object a line.
    Json,
}

/// Writes rows, each whole and at once.
#[derive(Debug)]
pub struct Writer<W: Write> {
    form: Form,
    to: W,
}

impl<W: Write> Writer<W> {
    /// A writer; the header goes first.
    ///
    /// # Errors
    /// What the output answers.
    pub fn new(form: Form, mut to: W) -> io::Result<Self> {
        if form == Form::Csv {
            line(&mut to, &COLUMNS.map(str::to_owned))?;
        }
        Ok(Self { form, to })
    }

    /// A report. Values of a fault are empty; those of a warning stand beside its reason.
    ///
    /// # Errors
    /// What the output answers.
    pub fn write(&mut self, reading: &LiveReading) -> io::Result<()> {
        let touch = match reading.touch {
            Touch::Unknown => "unknown",
            Touch::Untouched => "untouched",
            Touch::Touched => "touched",
        };
        let values: [Option<f64>; 6] = reading.values.map_or([None; 6], |values| {
            let all = [values.pressure_rise_pa, values.force_n, values.indentation_mm];
            [0, 1, 2, 3, 4, 5].map(|i| Some(all[i % 3][i / 3]))
        });
        let time = reading.time.0 as f64 * 1e-3;
        match self.form {
            Form::Csv => {
                let mut cells = vec![format!("{time:.3}"), reading.status.to_string(), touch.to_owned()];
                cells.extend(
                    values.map(|value| value.map_or_else(String::new, |value| format!("{value:.6}"))),
                );
                line(&mut self.to, &cells)
            }
            Form::Json => {
                let mut object = serde_json::Map::new();
                object.insert(COLUMNS[0].to_owned(), time.into());
                object.insert(COLUMNS[1].to_owned(), reading.status.to_string().into());
                object.insert(COLUMNS[2].to_owned(), touch.into());
                for (column, value) in COLUMNS[3..].iter().zip(values) {
                    object.insert((*column).to_owned(), value.into());
                }
                let mut text = serde_json::Value::Object(object).to_string();
                text.push('\n');
                self.to.write_all(text.as_bytes())?;
                self.to.flush()
            }
        }
    }
}

/// One row in one piece: whoever ends the program leaves no half of one.
fn line(to: &mut impl Write, cells: &[String]) -> io::Result<()> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(cells)?;
    let bytes = writer
        .into_inner()
        .map_err(|error| io::Error::other(error.to_string()))?;
    to.write_all(&bytes)?;
    to.flush()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::readings::LiveValues;
    use fingertip::status::{Fault, Status, Warnings};
    use fingertip::units::Microseconds;

    fn reading(status: Status) -> LiveReading {
        LiveReading {
            time: Microseconds(1_250),
            status,
            values: (!matches!(status, Status::Fault(_))).then_some(LiveValues {
                pressure_rise_pa: [1000.5, 2.0],
                force_n: [1.25, 0.001],
                indentation_mm: [0.75, 0.002],
            }),
            touch: Touch::Touched,
        }
    }

    #[test]
    fn a_fault_has_no_number_and_a_warning_its_reason() {
        let mut text = Vec::new();
        let mut writer = Writer::new(Form::Csv, &mut text).expect("a vector takes everything");
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
        let values = "touched,1000.500000,1.250000,0.750000,2.000000,0.001000,0.002000";
        assert_eq!(lines[1], format!("1.250,ok,{values}"));
        assert_eq!(lines[2], format!("1.250,warning: saturated; clock,{values}"));
        assert_eq!(lines[3], "1.250,fault: sensor open,touched,,,,,,");
    }

    #[test]
    fn json_is_an_object_a_line() {
        let mut text = Vec::new();
        let mut writer = Writer::new(Form::Json, &mut text).expect("a vector takes everything");
        writer
            .write(&reading(Status::Ok))
            .expect("a vector takes everything");
        writer
            .write(&reading(Status::Fault(Fault::Jump)))
            .expect("a vector takes everything");
        let text = String::from_utf8(text).expect("text");
        let lines: Vec<serde_json::Value> = text
            .lines()
            .map(|line| serde_json::from_str(line).expect("JSON"))
            .collect();
        assert_eq!(lines[0]["force_n"], 1.25);
        assert!(lines[1]["force_n"].is_null() && lines[1]["status"] == "fault: jump");
    }
}
